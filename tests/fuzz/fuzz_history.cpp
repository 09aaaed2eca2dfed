// SPDX-License-Identifier: Apache-2.0
// Any bytes as the strokes before a session must give a history that can be undone and redone to its ends, or one
// core::Error. They are tried as they are and with the checksums of each stroke set right.
#include <vector>

#include "fuzz_model.h"
#include "handpiece/app/simulation/history_bytes.h"

namespace {

using namespace handpiece;

// A history: magic, three numbers, then each stroke's size and cut state.
constexpr std::size_t kHead = 28;

std::vector<std::byte> sealed(std::span<const std::byte> data, std::uint64_t identity) {
    std::vector<std::byte> out(data.begin(), data.end());
    for (std::size_t at = kHead; at + 8 < out.size();) {
        std::uint64_t size = 0;
        std::memcpy(&size, &out[at], 8);
        if (size < fuzz::kStateHeaderBytes || size > out.size() - at - 8) size = out.size() - at - 8;
        std::memcpy(&out[at], &size, 8);
        at += 8;
        if (size < fuzz::kStateHeaderBytes) break;
        fuzz::seal(std::span(out).subspan(at, size), identity);
        at += size;
    }
    return out;
}

void tryOut(std::span<const std::byte> data, const simulation::SimulationSetup& station) {
    try {
        history::History history = simulation::decodeHistory(data, tooth::StateDelta{}, station, "fuzz");
        while (history.undo()) {
        }
        while (history.redo()) {
        }
        if (history.redoSteps() != 0) __builtin_trap();
    } catch (const core::Error& e) {
        if (e.problem().empty()) __builtin_trap();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const simulation::SimulationSetup station = [] {
        simulation::SimulationSetup made;
        made.tooth = fuzz::smallTooth();
        return made;
    }();
    const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
    tryOut(bytes, station);
    if (size > kHead) tryOut(sealed(bytes, station.tooth->identity), station);
    return 0;
}
