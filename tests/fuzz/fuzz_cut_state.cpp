// SPDX-License-Identifier: Apache-2.0
// Any bytes at all must give a state that the tooth can hold and that comes back the same, or one core::Error. The
// bytes are tried as they are and with the checksums set right.
#include <cstdlib>
#include <vector>

#include "fuzz_model.h"

namespace {

using namespace handpiece;

void tryOut(std::span<const std::byte> data, const std::shared_ptr<const tooth::ToothModel>& base) {
    tooth::StateDelta state;
    try {
        state = tooth::decodeState(data, {base});
    } catch (const core::Error&) {
        return;
    }
    const tooth::StateDelta again = tooth::decodeState(tooth::encodeState(state, base->identity), {base});
    if (tooth::stateHash(again) != tooth::stateHash(state)) std::abort();
    tooth::ToothState field(base);
    if (field.restore(state, 0, state.bricks.size()) != state.bricks.size()) std::abort();
    (void)field.volumesMm3();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::shared_ptr<const tooth::ToothModel> base = fuzz::smallTooth();
    const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
    tryOut(bytes, base);
    if (size >= fuzz::kStateHeaderBytes) {
        std::vector<std::byte> sealed(bytes.begin(), bytes.end());
        fuzz::seal(sealed, base->identity);
        tryOut(sealed, base);
    }
    return 0;
}
