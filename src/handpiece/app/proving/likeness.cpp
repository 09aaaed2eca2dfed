// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/proving/likeness.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <iterator>
#include <set>

#include "handpiece/base/core/hash.h"
#include "handpiece/record/session/session_reader.h"

namespace handpiece::proving {
namespace {

using Pose = std::array<std::int32_t, 7>;

Pose poseOf(const session::Record& r) {
    return {r.position[0],    r.position[1],    r.position[2], r.orientation[0],
            r.orientation[1], r.orientation[2], r.orientationW};
}

std::uint64_t hashOf(const Pose& pose) {
    core::Hasher hasher;
    for (const std::int32_t one : pose)
        hasher.add(one);
    return hasher.value();
}

}  // namespace

std::vector<std::string> motionSketch(const std::filesystem::path& file) {
    constexpr std::size_t kRead = 10'000, kLeast = 32, kMost = 2048;
    constexpr std::uint64_t kCutsOneIn = 256;
    const session::SessionReader reader(file);
    std::set<std::uint64_t> least;
    core::Hasher stretch;
    std::size_t length = 0;
    Pose last{};
    for (std::uint64_t at = 0; at < reader.size(); at += kRead)
        for (const session::Record& record : reader.records(at, kRead)) {
            const Pose pose = poseOf(record);
            if (pose == last) continue;
            last = pose;
            const std::uint64_t hash = hashOf(pose);
            stretch.add(hash);
            ++length;
            if (hash % kCutsOneIn != 0 && length < kMost) continue;
            if (length >= kLeast) {
                least.insert(stretch.value());
                if (least.size() > kSketch) least.erase(std::prev(least.end()));
            }
            stretch = core::Hasher();
            length = 0;
        }
    std::vector<std::string> sketch;
    for (const std::uint64_t one : least)
        sketch.push_back(fmt::format("{:016x}", one));
    return sketch;
}

}  // namespace handpiece::proving
