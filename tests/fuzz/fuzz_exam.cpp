// SPDX-License-Identifier: Apache-2.0
// Any text as an exam's pack, an entry of a chain, a receipt, a signature must give one that is written as the same
// bytes, or one core::Error.
#include "fuzz_model.h"
#include "handpiece/school/exam/chain.h"
#include "handpiece/school/exam/receipt.h"

namespace exam = handpiece::exam;

namespace {

template <class Read>
void same(const std::uint8_t* data, std::size_t size, Read read) {
    (void)handpiece::fuzz::readText(data, size, [&](std::string_view text) {
        if (exam::toText(read(text)) != text) __builtin_trap();
    });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    same(data, size, [](std::string_view t) { return exam::packFrom(t, "pack"); });
    same(data, size, [](std::string_view t) { return exam::entryFrom(t, "entry"); });
    same(data, size, [](std::string_view t) { return exam::receiptFrom(t, "receipt"); });
    same(data, size, [](std::string_view t) { return exam::signatureFrom(t, "signature"); });
    (void)handpiece::fuzz::readText(data, size, [](std::string_view t) {
        const exam::Signed both = exam::parted(t, "joined");
        if (exam::joined(both) != t) __builtin_trap();
        (void)exam::isSigned(both.text, both.signature, both.signature.key);
    });
    return 0;
}
