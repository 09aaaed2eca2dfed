// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The field that contact reads: of a tooth that is never cut, or of one that is. Private to this room.

#include <cstdint>

#include "handpiece/model/tooth/cut_field.h"

namespace handpiece::contact {

/// A field as contact reads it: of a tooth that is never cut, or the live one of a tooth that is.
struct LiveField {
    // NOLINTNEXTLINE(google-explicit-constructor)
    LiveField(const field::DistanceField& whole) : field(whole) {}
    // NOLINTNEXTLINE(google-explicit-constructor)
    LiveField(const tooth::CutField& live) : field(live.field()), cut(&live) {}

    /// Nearer than this outside and inside values are distances.
    [[nodiscard]] double outMm() const noexcept {
        return cut != nullptr ? cut->base().bandOutMm : field.settings().bandOutMm;
    }
    [[nodiscard]] double inMm() const noexcept {
        return cut != nullptr ? cut->base().settings.bandMm : field.settings().bandInMm;
    }
    [[nodiscard]] std::uint64_t version() const noexcept { return cut != nullptr ? cut->version() : 1; }

    const field::DistanceField& field;
    const tooth::CutField* cut = nullptr;
};
/// A value beyond this share of what a field holds says no more than "at least".
inline constexpr double kSaturated = 0.98;

}  // namespace handpiece::contact
