// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/field_method.h"

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/tick/contact/exact_depth.h"
#include "handpiece/tick/contact/field_depth.h"
#include "handpiece/tick/contact/ring_sensor.h"
#include "handpiece/tick/contact/sheet_search.h"

namespace handpiece::contact {

using core::Vec3;

namespace {

constexpr double kNoDirectionMm = 1e-9;

class FieldMethod final : public Method {
  public:
    FieldMethod(std::shared_ptr<const tooth::Tooth> tooth, std::shared_ptr<const instrument::Bur> bur,
                const FieldMethodSettings& settings)
        : tooth_(std::move(tooth)),
          bur_(std::move(bur)),
          settings_(settings),
          surface_(tooth_->tree, tooth_->field, core::simdLevel(), settings.depthSource == DepthSource::field),
          axis_(*bur_),
          sheets_(*bur_, tooth_->field, core::simdLevel()),
          rings_(tooth_->field, *bur_, core::simdLevel()),
          field_(tooth_->field, *bur_),
          farthestMm_(std::hypot(bur_->lengthMm(), bur_->maxRadiusMm())) {}

    [[nodiscard]] const char* name() const noexcept override { return "field"; }

    [[nodiscard]] Depth depth(const core::Pose& burInTooth) noexcept override {
        Depth result;
        result.depthMm = -settings_.reachMm;
        if (!burInTooth.isValid()) {
            result.status = Status::invalidPose;
            return result;
        }
        if (isStillFar(burInTooth)) return result;
        BallDepth best;
        if (settings_.depthSource == DepthSource::field) {
            rings_.constraints(burInTooth, tooth_->field.settings().bandOutMm, touching_);
            field_.search(burInTooth, touching_, best);
        } else {
            axis_.search(surface_, burInTooth, best);
        }
        sheets_.search(surface_, burInTooth, best);
        if (!(best.depthMm >= -settings_.reachMm)) {
            farPose_ = burInTooth;
            // The field alone sees nothing beyond its band, and promises nothing about it.
            clearMm_ = std::isfinite(best.depthMm) ? -best.depthMm : 0.0;
            return result;
        }
        clearMm_ = 0.0;
        result.status = Status::ok;
        result.depthMm = best.depthMm;
        result.toothPointMm = best.surfaceMm;
        const Vec3 away = best.inside ? Vec3(best.surfaceMm - best.centreMm) : Vec3(best.centreMm - best.surfaceMm);
        const double distance = away.norm();
        result.normal = distance > kNoDirectionMm ? Vec3(away / distance) : surface_.outward(best);
        result.tissue = tooth_->field.tissueAt(best.surfaceMm - 0.5 * tooth_->field.settings().voxelMm * result.normal);
        return result;
    }

    void patches(const core::Pose& burInTooth, PatchSet& out) noexcept override { rings_.patches(burInTooth, out); }

    Status constraints(const core::Pose& burInTooth, double reachMm, ConstraintSet& out) noexcept override {
        return rings_.constraints(burInTooth, reachMm, out);
    }

    void reset() noexcept override {
        axis_.reset();
        clearMm_ = 0.0;
    }

  private:
    /// No point of the bur has moved as far as there was room for, beyond the reach.
    [[nodiscard]] bool isStillFar(const core::Pose& pose) const noexcept {
        if (clearMm_ <= settings_.reachMm) return false;
        const double cosine = pose.orientation.coeffs().dot(farPose_.orientation.coeffs());
        const double turn = 2.0 * std::sqrt(std::max(0.0, 1.0 - cosine * cosine));  // chord of a unit arm
        const double moved = (pose.positionMm - farPose_.positionMm).norm() + turn * farthestMm_;
        return clearMm_ - moved > settings_.reachMm;
    }

    std::shared_ptr<const tooth::Tooth> tooth_;
    std::shared_ptr<const instrument::Bur> bur_;
    FieldMethodSettings settings_;
    ExactSurface surface_;
    AxisSearch axis_;
    SheetSearch sheets_;
    RingSensor rings_;
    FieldDepth field_;
    ConstraintSet touching_;
    double farthestMm_;
    core::Pose farPose_;
    double clearMm_ = 0.0;  ///< distance at farPose_ when that was beyond reach
};

}  // namespace

std::unique_ptr<Method> makeFieldMethod(std::shared_ptr<const tooth::Tooth> tooth,
                                        std::shared_ptr<const instrument::Bur> bur,
                                        const FieldMethodSettings& settings) {
    if (!tooth || !bur) throw core::Error("the field method needs a tooth and a bur");
    if (!(settings.reachMm > 0.0) || !std::isfinite(settings.reachMm))
        throw core::Error("the reach of a contact query must be a positive number of millimetres", "reachMm");
    return std::make_unique<FieldMethod>(std::move(tooth), std::move(bur), settings);
}

}  // namespace handpiece::contact
