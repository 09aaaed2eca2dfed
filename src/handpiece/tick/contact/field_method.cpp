// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/field_method.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/tick/contact/exact/exact_depth.h"
#include "handpiece/tick/contact/exact/off_axis_medial_search.h"
#include "handpiece/tick/contact/exact/outline_search.h"
#include "handpiece/tick/contact/sampled/field_depth.h"
#include "handpiece/tick/contact/sampled/known_surface.h"
#include "handpiece/tick/contact/sampled/surface_sampler.h"

namespace handpiece::contact {

using core::Vec3;

namespace {

constexpr double kNoDirectionMm = 1e-9;
/// Between its nodes the field of a round wall stands in by h^2 / 8 r at most: a bur in its own cavity is given that
/// and half as much again, or bumps of a micron would wedge it. r is taken as half the bur's radius.
constexpr double kSlackShare = 1.5 / 8.0;
constexpr double kMinSlackMm = 0.0015;  // a proxy rests up to a micron inside
constexpr double kApartMm = 1e-9;
constexpr std::size_t kSpineBalls = 8, kMostCover = 24;

class FieldMethod final : public Method {
  public:
    FieldMethod(std::shared_ptr<const tooth::ToothModel> tooth, std::shared_ptr<const tooth::ToothState> cut,
                std::shared_ptr<const instrument::Bur> bur, const FieldMethodSettings& settings)
        : tooth_(std::move(tooth)),
          cut_(std::move(cut)),
          bur_(std::move(bur)),
          settings_(settings),
          live_(cut_ ? cut_->field() : tooth_->field),
          surface_(tooth_->tree, tooth_->field, core::simdLevel()),
          outline_(*bur_, core::simdLevel()),
          axis_(*bur_),
          sheets_(settings_.sheets ? settings_.sheets : makeMedialSheets(*bur_), tooth_->field, core::simdLevel()),
          slackMm_(cut_ ? std::max(kMinSlackMm, kSlackShare * live_.settings().voxelMm * live_.settings().voxelMm /
                                                    (0.5 * bur_->maxRadiusMm()))
                        : 0.0),
          farthestMm_(core::hypot(bur_->lengthMm(), bur_->maxRadiusMm())) {
        if (!settings_.depthOnly || cut_) points_.emplace(live_, *bur_);
        for (const instrument::MedialCurve& curve : bur_->medialAxis()) {
            for (const instrument::MedialBall& ball : curve.balls)
                mostRadiusMm_ = std::max(mostRadiusMm_, ball.radiusMm);
            if (curve.onAxis)
                for (std::size_t i = 0; i < kSpineBalls; ++i)
                    spine_.push_back(curve.balls[i * (curve.balls.size() - 1) / (kSpineBalls - 1)]);
        }
        const double across = bur_->maxRadiusMm();
        const auto count = static_cast<std::size_t>(
            std::clamp(std::ceil(bur_->lengthMm() / across), 1.0, static_cast<double>(kMostCover)));
        const double half = 0.5 * bur_->lengthMm() / static_cast<double>(count);
        for (std::size_t i = 0; i < count; ++i)
            cover_.push_back({0.0, (2.0 * static_cast<double>(i) + 1.0) * half, core::hypot(half, across)});
    }

    [[nodiscard]] const char* name() const noexcept override { return "field"; }

    [[nodiscard]] Depth depth(const core::Pose& burInTooth) noexcept override {
        return depthBeyond(-std::numeric_limits<double>::infinity(), burInTooth);
    }

    [[nodiscard]] Depth depthBeyond(double floorMm, const core::Pose& burInTooth) noexcept override {
        Depth result;
        result.depthMm = -settings_.reachMm;
        if (!burInTooth.isValid()) {
            result.status = Status::invalidPose;
            return result;
        }
        if (isStillFar(burInTooth)) return result;
        clearMm_ = 0.0;
        if (std::isfinite(floorMm))
            if (const double clearMm = clearByField(burInTooth, std::max(0.0, -floorMm)); clearMm >= -floorMm) {
                result.depthMm = std::max(-clearMm, -settings_.reachMm);
                return result;
            }
        if (points_ && (settings_.depthSource == DepthSource::field || isCutNear(burInTooth)))
            depthInField(burInTooth, result);
        else
            depthOfUncut(burInTooth, floorMm, result);
        if (result.status == Status::ok)
            result.tissue = live_.tissueAt(result.toothPointMm - 0.5 * live_.settings().voxelMm * result.normal);
        return result;
    }

    [[nodiscard]] Depth depthUpTo(double enoughMm, const core::Pose& burInTooth) noexcept override {
        if (!burInTooth.isValid()) return depth(burInTooth);
        // Each ball of the bur with its centre in the tooth promises a depth: the field tells at most how deep it is.
        for (const instrument::MedialBall& ball : spine_) {
            const Vec3 centre = burInTooth.apply(Vec3(0.0, 0.0, ball.zMm));
            const double inside = -live_.distance(centre), promised = ball.radiusMm + inside;
            if (!(inside > 0.0 && promised > enoughMm)) continue;
            Depth result;
            result.depthMm = promised;
            result.toothPointMm = centre;
            result.tissue = live_.tissueAt(centre);
            result.status = Status::ok;
            return result;
        }
        return depth(burInTooth);
    }

    void patches(const core::Pose& burInTooth, PatchSet& out) noexcept override {
        if (points_)
            points_->rings.patches(burInTooth, out);
        else
            Method::patches(burInTooth, out);
    }

    Status constraints(const core::Pose& burInTooth, double reachMm, ConstraintSet& out) noexcept override {
        return points_ ? points_->rings.constraints(burInTooth, reachMm, out)
                       : Method::constraints(burInTooth, reachMm, out);
    }

    void bearing(const core::Pose& burInTooth, const Vec3& direction, double leadMm, double leastRadiusMm,
                 Bearing& out) noexcept override {
        if (points_)
            points_->rings.bearing(burInTooth, direction, leadMm, leastRadiusMm, out);
        else
            Method::bearing(burInTooth, direction, leadMm, leastRadiusMm, out);
    }

    void noteCut(const core::Pose& burInTooth) noexcept override {
        if (!cut_) return;
        points_->known.noteCut(burInTooth);
        points_->rings.senseAnew();
    }

    [[nodiscard]] std::uint64_t toothVersion() const noexcept override { return live_.version(); }

    [[nodiscard]] double slackMm() const noexcept override { return slackMm_; }

    [[nodiscard]] bool isCutNear(const core::Pose& burInTooth) const noexcept override {
        return cut_ && burInTooth.isValid() && cut_->isCutNear(boxAround(BurFrame(burInTooth), live_.reach().outMm));
    }

    void reset() noexcept override {
        outline_.reset();
        axis_.reset();
        if (points_) points_->known.forget();
        clearMm_ = 0.0;
    }

  private:
    /// No point of the bur has moved as far as there was room for, beyond the reach. Cutting only makes more room.
    [[nodiscard]] bool isStillFar(const core::Pose& pose) const noexcept {
        if (clearMm_ <= settings_.reachMm) return false;
        return clearMm_ - core::mostMovedMm(farPose_, pose, farthestMm_) > settings_.reachMm;
    }
    void setFar(const core::Pose& pose, double clearMm) noexcept {
        farPose_ = pose;
        clearMm_ = clearMm;
    }

    /// The bur's box, `byMm` wider on every side.
    [[nodiscard]] core::Box boxAround(const BurFrame& frame, double byMm) const noexcept {
        return frame.boxAround(bur_->lengthMm(), bur_->maxRadiusMm(), byMm);
    }

    /// No more than the distance, if that is `enoughMm` by the field alone: a few lookups before any triangle is asked.
    /// Else minus infinity.
    [[nodiscard]] double clearByField(const core::Pose& burInTooth, double enoughMm) const noexcept {
        double clearMm = std::numeric_limits<double>::infinity();
        for (const instrument::MedialBall& ball : cover_) {
            const Vec3 centre = burInTooth.apply(Vec3(0.0, 0.0, ball.zMm));
            clearMm = std::min(clearMm, live_.distance(centre) - surface_.sureMm() - ball.radiusMm);
            if (clearMm < enoughMm) return -std::numeric_limits<double>::infinity();
        }
        return clearMm;
    }

    /// Apart, and by no less than -floorMm.
    [[nodiscard]] bool isApart(const BurFrame& frame, double floorMm) noexcept {
        if (!outline_.isFit()) return false;
        BallDepth best;
        best.depthMm = std::min(floorMm, -kApartMm);
        return outline_.search(surface_, frame, best) == 0.0 && best.triangle == geometry::kNoTriangle;
    }

    /// From the triangles of the uncut tooth. Cutting takes away only: where a cut may change the answer it remains a
    /// bound.
    void depthOfUncut(const core::Pose& burInTooth, double floorMm, Depth& result) noexcept {
        const BurFrame frame(burInTooth);
        // The axis has a bound: where it is all it need only tell what is deeper.
        const bool isAxisAll = !outline_.isFit() && !sheets_.isAny();
        BallDepth best;
        if (isAxisAll) best.depthMm = floorMm;
        if (std::isfinite(floorMm) && !isAxisAll && isApart(frame, floorMm)) {
            result.depthMm = std::max(floorMm, -settings_.reachMm);
            return;
        }
        double mostMm = -std::numeric_limits<double>::infinity();
        // Deeper than its radius no ball is with its centre outside.
        const bool isDeep = sheets_.isDeep(surface_, frame, mostRadiusMm_), outsideKnown = isDeep || outline_.isFit();
        const double largestMm =
            !isDeep && outsideKnown ? outline_.search(surface_, frame, best) : std::numeric_limits<double>::infinity();
        if (!outsideKnown || (axis_.leastRadiusMm() <= largestMm && axis_.mayEnter(surface_, frame)))
            axis_.search(surface_, frame, best, mostMm);
        if (largestMm > 0.0) sheets_.search(surface_, frame, outsideKnown, largestMm, best, mostMm);
        if (isAxisAll && best.triangle == geometry::kNoTriangle && std::isfinite(floorMm)) {
            result.depthMm = std::max(floorMm, -settings_.reachMm);
            return;
        }
        if (!(best.depthMm >= -settings_.reachMm)) {
            setFar(burInTooth, std::isfinite(best.depthMm) ? -best.depthMm : 0.0);
            return;
        }
        result.depthMm = best.depthMm;
        result.unseenMm = std::max(0.0, mostMm - best.depthMm);
        if (best.depthMm < 0.0 && cut_ && isGone(frame, best)) return;
        result.status = Status::ok;
        result.toothPointMm = best.surfaceMm;
        const Vec3 away = best.inside ? Vec3(best.surfaceMm - best.centreMm) : Vec3(best.centreMm - best.surfaceMm);
        const double distance = away.norm();
        result.normal = distance > kNoDirectionMm ? Vec3(away / distance) : surface_.outward(best);
    }

    /// Apart: the point of the uncut tooth that is nearest may have been cut away.
    [[nodiscard]] bool isGone(const BurFrame& frame, const BallDepth& best) const noexcept {
        return cut_->isCutNear({best.surfaceMm, best.surfaceMm}) && cut_->isCutNear(boxAround(frame, -best.depthMm));
    }

    void depthInField(const core::Pose& burInTooth, Depth& result) noexcept {
        // The nearest that the tooth can be to the ball about the bur.
        const Vec3 middle = burInTooth.apply(Vec3(0.0, 0.0, 0.5 * bur_->lengthMm()));
        const double clear = live_.distance(middle) - core::hypot(0.5 * bur_->lengthMm(), bur_->maxRadiusMm());
        if (clear > live_.reach().outMm) {
            result.depthMm = std::max(-clear, -settings_.reachMm);
            setFar(burInTooth, clear);
            return;
        }
        const FieldTouch found = points_->field.search(burInTooth, points_->rings);
        result.slackMm = slackMm_;
        result.depthMm = std::max(found.depthMm, -settings_.reachMm);
        if (!(found.depthMm >= -settings_.reachMm)) {
            result.depthMm = std::max(-points_->field.clearMm(), -settings_.reachMm);
            return;
        }
        result.status = Status::ok;
        result.toothPointMm = found.surfaceMm;
        result.normal = found.normal;
    }

    std::shared_ptr<const tooth::ToothModel> tooth_;
    std::shared_ptr<const tooth::ToothState> cut_;  ///< null: the tooth is never cut
    std::shared_ptr<const instrument::Bur> bur_;
    FieldMethodSettings settings_;
    const field::DistanceField& live_;
    ExactSurface surface_;
    OutlineSearch outline_;
    AxisSearch axis_;
    OffAxisMedialSearch sheets_;
    /// What looks at points of the bur's surface in the field.
    struct Points {
        Points(const field::DistanceField& live, const instrument::Bur& bur)
            : known(live, bur, core::simdLevel()),
              rings(known, bur, core::simdLevel()),
              field(known, bur, core::simdLevel()) {}
        KnownSurface known;
        SurfaceSampler rings;
        FieldDepth field;
    };
    std::optional<Points> points_;
    std::vector<instrument::MedialBall> spine_;  ///< some balls of the bur's axis
    std::vector<instrument::MedialBall> cover_;  ///< balls on the axis in which all of the bur lies
    double slackMm_;                             ///< of the bur in its own cavity
    double farthestMm_, mostRadiusMm_ = 0.0;     ///< of the bur's points from its tip; of its medial balls
    core::Pose farPose_;
    double clearMm_ = 0.0;  ///< distance at farPose_ when that was beyond reach
};

void check(bool isThere, const FieldMethodSettings& settings) {
    if (!isThere) throw core::Error("the field method needs a tooth and a bur");
    if (!(settings.reachMm > 0.0) || !std::isfinite(settings.reachMm))
        throw core::Error("the reach of a contact query must be a positive number of millimetres", "reachMm");
}

}  // namespace

std::shared_ptr<const MedialSheets> makeMedialSheets(const instrument::Bur& bur) {
    return std::make_shared<const MedialSheets>(bur);
}

std::unique_ptr<Method> makeFieldMethod(std::shared_ptr<const tooth::ToothModel> tooth,
                                        std::shared_ptr<const instrument::Bur> bur,
                                        const FieldMethodSettings& settings) {
    check(tooth && bur, settings);
    return std::make_unique<FieldMethod>(std::move(tooth), nullptr, std::move(bur), settings);
}

std::unique_ptr<Method> makeFieldMethod(std::shared_ptr<const tooth::ToothState> tooth,
                                        std::shared_ptr<const instrument::Bur> bur,
                                        const FieldMethodSettings& settings) {
    check(tooth && bur, settings);
    return std::make_unique<FieldMethod>(tooth->modelShared(), std::move(tooth), std::move(bur), settings);
}

}  // namespace handpiece::contact
