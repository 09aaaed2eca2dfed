// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/hull/hull_method.h"

#include "handpiece/base/geometry/convex_hull.h"
#include "handpiece/base/geometry/epa.h"
#include "handpiece/base/geometry/gjk.h"

namespace handpiece::contact {
namespace {

class HullMethod final : public Method {
  public:
    HullMethod(const geometry::TriangleMesh& tooth, const geometry::TriangleMesh& bur, cases::Tissue tissue)
        : tooth_(tooth), bur_(bur), tissue_(tissue) {}

    [[nodiscard]] const char* name() const noexcept override { return "hull"; }

    [[nodiscard]] Depth depth(const core::Pose& burInTooth) noexcept override {
        Depth result;
        if (!burInTooth.isValid()) {
            result.status = Status::invalidPose;
            return result;
        }
        const geometry::HullPair pair(tooth_, bur_, burInTooth);
        const geometry::Separation apart = geometry::separation(pair, seed_);
        result.tissue = tissue_;
        result.status = apart.converged ? Status::ok : Status::truncated;
        if (!apart.overlapping) {
            result.depthMm = -apart.distanceMm;
            result.normal = apart.direction;
            result.toothPointMm = apart.pointOnA;
            return result;
        }
        const geometry::Penetration inside = solver_.penetration(pair, apart.simplex);
        result.depthMm = inside.depthMm;
        result.normal = inside.normal;
        result.toothPointMm = inside.pointOnA;
        if (!inside.converged) result.status = Status::truncated;
        return result;
    }

    void reset() noexcept override {
        seed_ = {};
        solver_.reset();
    }

  private:
    geometry::ConvexHull tooth_, bur_;
    cases::Tissue tissue_;
    geometry::SimplexSeed seed_;
    geometry::PenetrationSolver solver_;
};

}  // namespace

std::unique_ptr<Method> makeHullMethod(const geometry::TriangleMesh& tooth, const geometry::TriangleMesh& bur,
                                       cases::Tissue tissue) {
    return std::make_unique<HullMethod>(tooth, bur, tissue);
}

}  // namespace handpiece::contact
