// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Whether two recordings are of one motion, though not the same sample for sample: one sample changed, a part cut off,
/// a second put before it. What a teacher should look at, and never a proof.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace handpiece::proving {

/// A motion is cut where its own samples say so, into stretches of some 256 samples; a sketch are the least hashes of
/// these, so many at most (bottom-k sketch: Broder, On the resemblance and containment of documents, 1997).
inline constexpr std::size_t kSketch = 64;

/// Of the samples at which the hand moved, whatever their ticks: 16 digits each, rising; empty where it hardly did.
/// Throws core::Error for a file that cannot be read.
[[nodiscard]] std::vector<std::string> motionSketch(const std::filesystem::path& session);

}  // namespace handpiece::proving
