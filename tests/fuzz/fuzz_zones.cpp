// SPDX-License-Identifier: Apache-2.0
// Any bytes as the zones of recorded work must give a surface that is written, read and written again as the same
// bytes, and a target on a tooth; or one core::Error. They are tried as they are and with their hashes set right.
#include <cmath>
#include <cstring>

#include "fuzz_block.h"
#include "handpiece/assess/preparation/recorded_work.h"
#include "handpiece/base/core/hash.h"

using namespace handpiece;

namespace {

/// Of docs/formats/exercise.md: where the header keeps the payload's size, its hash, and its own.
constexpr std::size_t kBytes = 64, kHash = 72, kHeaderHash = 80, kPayload = 88;

std::uint64_t hashOf(std::span<const std::byte> bytes) {
    core::Hasher hasher;
    hasher.add(bytes);
    return hasher.value();
}

void read(std::span<const std::byte> data) {
    const preparation::RecordedWork work = preparation::decodeZones(data, "fuzz");
    const std::vector<std::byte> once = preparation::encodeZones(work);
    const preparation::RecordedWork again = fuzz::mustRead([&] { return preparation::decodeZones(once, "once"); });
    if (preparation::encodeZones(again) != once || again.hash() != work.hash()) __builtin_trap();
    static const auto whole = std::make_shared<const geometry::TriangleTree>(fuzz::block().outer);
    const zones::TargetFunction target = preparation::recordedTarget(work, work.draw, {0.2, 0.2}, whole);
    for (int i = 0; i <= 8; ++i)
        for (const double aside : {0.0, 4.99}) {
            const zones::PastTarget past = target({0.1 + aside, -0.2, 8.0 - 2.0 * i});
            if (!std::isfinite(past.distanceMm())) __builtin_trap();
        }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto given = std::as_bytes(std::span(data, size));
    std::vector<std::byte> sealed(given.begin(), given.end());
    if (size >= kPayload) {
        const auto put = [&sealed](std::size_t at, std::uint64_t value) {
            std::memcpy(sealed.data() + at, &value, sizeof value);
        };
        put(kBytes, size - kPayload);
        put(kHash, hashOf(given.subspan(kPayload)));
        put(kHeaderHash, hashOf(std::span(sealed).first(kHeaderHash)));
    }
    for (const auto bytes : {given, std::span<const std::byte>(sealed)})
        (void)fuzz::readText(data, size, [&](std::string_view) { read(bytes); });
    return 0;
}
