// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// All that is known of a tooth's surface after a cut. Private to this room.

#include <algorithm>
#include <limits>
#include <span>

#include "handpiece/base/core/simd.h"
#include "handpiece/model/field/sharp_lookup.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/tick/contact/bur_frame.h"

namespace handpiece::contact {

/// The field between its nodes, and the bur where it cut last: nothing of the tooth is in that, so no place in it is
/// nearer to the tooth than to its outline. A rim that has just cut a corner narrower than the voxels is free in it.
/// For one thread.
class KnownSurface {
  public:
    /// Both must outlive this.
    KnownSurface(const field::DistanceField& field, const instrument::Bur& bur, core::SimdLevel level)
        : field_(field), bur_(bur), lookup_(field, level) {}

    [[nodiscard]] const field::DistanceField& field() const noexcept { return field_; }
    [[nodiscard]] field::SharpLookup& lookup() noexcept { return lookup_; }
    /// Signed distance [mm].
    [[nodiscard]] double distance(const core::Vec3& p) noexcept { return std::max(lookup_.distance(p), freeMm(p)); }
    /// The same of a place of which the mixed field says `mixedMm`, where walls meet. A cell mixes no wall nearer than
    /// a place that is known to be free: then that is what is known.
    [[nodiscard]] double distanceAtCrease(const core::Vec3& p, double mixedMm) const noexcept {
        const double free = freeMm(p);
        return free > std::max(mixedMm, -kCreaseFreeMm) ? free : std::max(lookup_.distanceOnce(p), free);
    }
    /// The same of up to field::kSharpPlaces places at once.
    void distances(std::span<const core::Vec3> places, std::span<double> out) noexcept {
        lookup_.distances(places, out);
        for (std::size_t i = 0; i < places.size(); ++i)
            out[i] = std::max(out[i], freeMm(places[i]));
    }
    /// The smooth wall of the field at a place; false where there is none, or the bur is what is known there.
    [[nodiscard]] bool wallAt(const core::Vec3& p, field::SharpLookup::Wall& wall) noexcept {
        return lookup_.wallAt(p, wall) && freeMm(p) <= wall.distanceMm;
    }
    /// The tooth is no nearer, by what the bur has cut last.
    [[nodiscard]] double freeMm(const core::Vec3& p) const noexcept {
        return knowsCut() ? -bur_.signedDistance(cut_.toBur * (p - cut_.tip))
                          : -std::numeric_limits<double>::infinity();
    }
    [[nodiscard]] bool knowsCut() const noexcept { return cutVersion_ == field_.version(); }
    /// Unit normal out of the tooth of the wall that decides at a place where walls meet, told to be `gapMm` off; zero
    /// where no brick is stored.
    [[nodiscard]] core::Vec3 normalAtCrease(const core::Vec3& p, double gapMm) noexcept {
        if (freeMm(p) < gapMm - kSameMm) return lookup_.normal(p);
        const core::Vec3 inBur = cut_.toBur * (p - cut_.tip);
        core::Vec3 slope;
        for (int k = 0; k < 3; ++k) {
            core::Vec3 before = inBur, after = inBur;
            before[k] -= kSameMm;
            after[k] += kSameMm;
            slope[k] = bur_.signedDistance(before) - bur_.signedDistance(after);
        }
        return cut_.toBur.transpose() * slope.normalized();
    }
    void noteCut(const core::Pose& burInTooth) noexcept {
        cut_ = BurFrame(burInTooth);
        cutVersion_ = field_.version();
    }
    void forget() noexcept { cutVersion_ = 0; }

  private:
    static constexpr double kCreaseFreeMm = 0.001;
    static constexpr double kSameMm = 1e-6;

    const field::DistanceField& field_;
    const instrument::Bur& bur_;
    field::SharpLookup lookup_;
    BurFrame cut_;                  ///< where the bur cut last
    std::uint64_t cutVersion_ = 0;  ///< of the field after that
};

}  // namespace handpiece::contact
