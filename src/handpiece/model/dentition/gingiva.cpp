// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/gingiva.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/decimate.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/model/dentition/embrasure.h"
#include "handpiece/model/dentition/jaw_line.h"
#include "handpiece/model/dentition/surfaces.h"

namespace handpiece::dentition {
namespace {

using core::Box;
using core::Vec3;
using geometry::TriangleMesh;

/// The gingiva reaches so far into a tooth: the edge of its socket, as jagged as its triangles are large, lies unseen,
/// and its margin is where its own smooth surface meets the tooth.
constexpr double kIntoToothMm = 0.4;
/// Its highest place lies so far inside; farther in it goes down again, or a bur that cuts just over the margin would
/// press what nobody sees.
constexpr double kHighestInsideMm = 0.25, kFallsInside = 1.5;
constexpr double kThinnestSeptumMm = 0.4;  ///< between two roots; thinner bone is left out
constexpr double kWidestSeptum = 2.1;
constexpr double kThinnestGingivaMm = 0.7;  ///< over bone
constexpr double kBaseUnderApexMm = 2.0, kBoneOutOfBaseMm = 1.0;
constexpr double kSteepest = 4.0;  ///< Lipschitz bound of all that follows

/// Thickness of gingiva, and of bone, on a tooth over heights above its junction; negative: how far it is away.
const Profile& collar() {
    static const Profile profile({{-8.0, 2.0},
                                  {-6.0, 1.8},
                                  {-4.0, 1.45},
                                  {-3.0, 1.25},
                                  {-2.0, 1.0},
                                  {-1.0, 0.8},
                                  {0.0, 0.45},
                                  {kMarginOverCervixMm + 0.06, 0.0},
                                  {1.3, -0.55},
                                  {4.0, -2.5}});
    return profile;
}
const Profile& plate() {
    static const Profile profile({{-14.0, 1.6}, {-8.0, 1.1}, {-4.0, 0.7}, {-2.2, 0.45}, {-1.5, 0.0}, {1.5, -3.0}});
    return profile;
}
constexpr double kCollarCap = 2.2, kPlateCap = 1.7;  ///< less than kFarMm less the thickest of each

/// smoothMin that blends less the farther away both are: none where a value is told only as "at least `cap`", so that
/// nothing jumps where a tooth comes into sight.
double blend(double a, double b, double width, double cap) {
    const double share = std::clamp(1.0 - std::max(a, b) / cap, 0.0, 1.0);
    return share > 0.0 ? smoothMin(a, b, width * share) : std::min(a, b);
}

/// A distance from a tooth as the margin of the gingiva takes it: it grows again deep inside. Round where it turns, or
/// the edge would be as jagged as it is sampled, up to where it is seen.
double asMarginTakes(double distanceMm) {
    constexpr double kBend = 0.5 / kHighestInsideMm, kRoundToMm = -kHighestInsideMm * (1.0 + kFallsInside);
    const double bent = std::clamp(distanceMm, kRoundToMm, 0.0);
    return distanceMm + kBend * bent * bent -
           (distanceMm < kRoundToMm ? (1.0 + kFallsInside) * (distanceMm - bent) : 0.0);
}

class Arch {
  public:
    explicit Arch(std::span<const ArchTooth> teeth) {
        standers_.reserve(teeth.size());
        for (const ArchTooth& t : teeth)
            standers_.emplace_back(t);
        up_ = standers_[teeth.size() / 2].axis().z() > 0.0 ? 1.0 : -1.0;
        Vec3 middle = Vec3::Zero();
        for (const Stander& s : standers_)
            middle += s.pose().positionMm / static_cast<double>(standers_.size());
        for (std::size_t i = 1; i < teeth.size(); ++i) {
            const Stander &a = standers_[i - 1], &b = standers_[i];
            const Vec3 contact = gapBetween(a.body(), a.pose(), b.body(), b.pose(), kFarMm).pointMm;
            embrasures_.emplace_back(a, b, contact, contact - middle);
            septumWidths_.push_back(std::clamp(0.7 * roomAtCrestMm(i) + 0.3, 0.8, kWidestSeptum));
        }
        jaw_.emplace(standers_, up_);
        for (const Stander& s : standers_) {
            for (const double z : {s.body().box.min.z(), 0.0})
                base_ = std::min(base_, up_ * s.pose().apply(Vec3(0.0, 0.0, z)).z());
            box_.extend(s.near().min);
            box_.extend(s.near().max);
        }
        base_ -= kBaseUnderApexMm;
        (up_ > 0.0 ? box_.min.z() : box_.max.z()) = up_ * (base_ - 1.0);
    }

    [[nodiscard]] const Box& box() const { return box_; }

    /// Negative inside, as the others.
    [[nodiscard]] double gingiva(const Vec3& p) const {
        const Teeth teeth = look(p);
        return smoothMax(covering(p, teeth), -kIntoToothMm - teeth.nearest, 0.3);
    }

    [[nodiscard]] double bone(const Vec3& p) const {
        const Teeth teeth = look(p);
        // Where a tooth comes into sight a septum is no nearer than what bounds the plate, and fades in from there.
        constexpr double kFadeMm = 0.8;
        double bone = kPlateCap, septum = kPlateCap;
        for (std::size_t i = teeth.first; i < teeth.last; ++i) {
            const Stander::Seen& seen = teeth.seen[i];
            if (seen.distance < kFarMm)
                bone = blend(bone, seen.distance - plate().at(seen.aboveCervix), 2.0, kPlateCap);
            if (i == teeth.first) continue;
            const Stander::Seen& before = teeth.seen[i - 1];
            const double one = seen.distance, two = before.distance;
            if (std::max(one, two) >= kFarMm) continue;
            // The crest between two teeth runs level, from under the one's junction to under the other's.
            const double between = core::hypot(std::max(one, 0.0), std::max(two, 0.0)) / std::numbers::sqrt2 +
                                   0.5 * asMarginTakes(std::min({one, two, 0.0}));
            const double toOne = std::max(one, 0.01), toTwo = std::max(two, 0.01);
            const double above = (toTwo * seen.aboveCervix + toOne * before.aboveCervix) / (toOne + toTwo);
            const double fade = std::max(0.0, (std::max(one, two) - kFarMm) / kFadeMm + 1.0);
            septum = std::min(
                septum, smoothMax(above + kCrestUnderCervixMm, between - septumWidths_[i - 1], 1.0) + fade * kPlateCap);
        }
        bone = smoothMin(bone, septum, 1.0);
        if (jaw_->least(p) < bone + 2.0) bone = smoothMin(bone, jaw_->at(p), 2.0);
        bone = smoothMax(bone, covering(p, teeth) + kThinnestGingivaMm, 0.5);
        bone = smoothMax(bone, base_ - up_ * p.z(), 0.8);
        const double sockets = std::max(teeth.ligament - teeth.nearest,
                                        kThinnestSeptumMm + 2.0 * teeth.ligament - teeth.nearest - teeth.second);
        return smoothMax(bone, sockets, 0.25);
    }

  private:
    static constexpr std::size_t kMostTeeth = 16;
    struct Teeth {
        std::array<Stander::Seen, kMostTeeth> seen;
        std::size_t first = 0, last = 0;  ///< of those in sight, and one behind
        double nearest = kFarMm, second = kFarMm, ligament = kLigamentMm;
    };
    [[nodiscard]] Teeth look(const Vec3& p) const {
        Teeth teeth;
        teeth.first = standers_.size();
        for (std::size_t i = 0; i < standers_.size(); ++i) {
            const Stander& s = standers_[i];
            Stander::Seen& seen = teeth.seen[i] = {kFarMm, 0.0};
            if (((p - s.near().max).array() < 0.0).all() && ((s.near().min - p).array() < 0.0).all()) seen = s.see(p);
            if (seen.distance >= kFarMm) continue;
            teeth.first = std::min(teeth.first, i), teeth.last = i + 1;
            teeth.second = std::min(teeth.second, std::max(teeth.nearest, seen.distance));
            if (seen.distance < teeth.nearest) {
                teeth.nearest = seen.distance;
                const double fromMiddle = std::min(1.0, std::abs(2.0 * seen.aboveCervix / s.rootMm() + 1.0));
                teeth.ligament = kLigamentMm + (kLigamentAtEndsMm - kLigamentMm) * fromMiddle * fromMiddle;
            }
        }
        return teeth;
    }

    /// Gingiva as it would be if the teeth stood in it, not in sockets of it.
    [[nodiscard]] double covering(const Vec3& p, const Teeth& teeth) const {
        double covering = kCollarCap, papilla = kCollarCap;
        std::array<double, kMostTeeth> sheets;
        for (std::size_t i = teeth.first; i < teeth.last; ++i)
            if (const Stander::Seen& seen = teeth.seen[i]; seen.distance < kFarMm)
                covering =
                    blend(covering, asMarginTakes(seen.distance) - collar().at(seen.aboveCervix), 1.6, kCollarCap);
        const std::size_t from = std::max<std::size_t>(1, teeth.first), to = std::min(teeth.last + 1, standers_.size());
        for (std::size_t i = from; i < to; ++i) {
            const double near = std::min(teeth.seen[i - 1].distance, teeth.seen[i].distance);
            sheets[i] = -1e9;
            if (near >= kFarMm) continue;
            const Embrasure::Values between =
                embrasures_[i - 1].at(p, teeth.seen[i - 1].distance, teeth.seen[i].distance);
            papilla = std::min(papilla, between.papilla + 1.4 * kFades * std::max(0.0, near - 3.2));
            sheets[i] = std::min(between.sheets, kCollarCap) - kFades * std::max(0.0, near - 1.5);
        }
        covering = smoothMin(covering, papilla, 0.6);
        for (std::size_t i = from; i < to; ++i)
            covering = smoothMax(covering, sheets[i], 0.25);
        if (jaw_->least(p) - kGingivaThicknessMm < covering + 2.0)
            covering = smoothMin(covering, jaw_->at(p) - kGingivaThicknessMm, 2.0);
        return smoothMax(covering, base_ - up_ * p.z() + kBoneOutOfBaseMm, 0.5);
    }

    /// Least way from tooth i - 1 over to tooth i at the crest's height, by steps from axis to axis.
    [[nodiscard]] double roomAtCrestMm(std::size_t i) const {
        const Stander &a = standers_[i - 1], &b = standers_[i];
        const auto crestOf = [](const Stander& s) -> Vec3 {
            return s.pose().positionMm - kCrestUnderCervixMm * s.axis();
        };
        double least = 2.0 * kFarMm;
        constexpr int kSteps = 200;
        for (int step = 0; step <= kSteps; ++step) {
            const Vec3 p = crestOf(a) + static_cast<double>(step) / kSteps * (crestOf(b) - crestOf(a));
            const double one = a.distance(p), two = b.distance(p);
            if (one > 0.0 && two > 0.0) least = std::min(least, one + two);
        }
        return least;
    }

    static constexpr double kFades = 2.0;  ///< what belongs to two teeth ends where both go out of sight
    std::vector<Stander> standers_;
    std::vector<Embrasure> embrasures_;  ///< before the tooth of the next number
    std::vector<double> septumWidths_;   ///< of the bone's crest between two teeth, towards lip and tongue
    std::optional<JawLine> jaw_;
    Box box_;
    double up_ = 1.0, base_ = 1e9;
};

TriangleMesh solidOf(const Box& box, const geometry::ScalarFunction& f, double spacingMm, std::size_t faces,
                     const core::Progress& progress) {
    geometry::IsosurfaceSettings settings;
    settings.spacingMm = spacingMm;
    settings.lipschitz = kSteepest;
    settings.usualSlope = 1.0;
    settings.relaxations = 0;
    settings.project = false;  // between the nodes: sharp edges are planed off, not folded
    TriangleMesh fine = largestShell(geometry::isosurface(box, f, settings, core::part(progress, 0.0, 0.5)));
    if (fine.triangles.size() <= faces) return fine;
    const double holdMm = 4.0 * spacingMm;
    if (auto thinned = geometry::decimateUncrossed(fine, faces, holdMm, core::part(progress, 0.5, 1.0)))
        return std::move(*thinned);
    return fine;
}

}  // namespace

Periodontium makePeriodontium(std::span<const ArchTooth> teeth, const PeriodontiumOptions& options,
                              const core::Progress& progress) {
    if (teeth.size() > 16) throw core::Error("an arch has 16 teeth at most", "gingiva");
    if (teeth.size() < 2) throw core::Error("an arch needs two teeth", "gingiva");
    const Arch arch(teeth);
    Periodontium made;
    made.gingiva = solidOf(
        arch.box(), [&](const Vec3& p) { return arch.gingiva(p); }, options.spacingMm, options.gingivaFaces,
        core::part(progress, 0.0, 0.6));
    made.bone = solidOf(
        arch.box(), [&](const Vec3& p) { return arch.bone(p); }, options.spacingMm, options.boneFaces,
        core::part(progress, 0.6, 1.0));
    return made;
}

}  // namespace handpiece::dentition
