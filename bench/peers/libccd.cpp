// SPDX-License-Identifier: Apache-2.0
#include "peers/libccd.h"

#include <ccd/ccd.h>

#include <array>
#include <span>
#include <vector>

#include "handpiece/base/geometry/convex_hull.h"

namespace handpiece::bench {
namespace {

struct Shape {
    std::array<std::vector<double>, 3> coordinates;
    core::Pose pose;
};

Shape makeShape(std::span<const core::Vec3> vertices) {
    Shape shape;
    for (const core::Vec3& v : vertices)
        for (std::size_t axis = 0; axis < 3; ++axis)
            shape.coordinates[axis].push_back(v[static_cast<int>(axis)]);
    return shape;
}

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
    const Shape& shape = *static_cast<const Shape*>(object);
    const core::Vec3 d =
        shape.pose.orientation.conjugate() * core::Vec3(direction->v[0], direction->v[1], direction->v[2]);
    const double *x = shape.coordinates[0].data(), *y = shape.coordinates[1].data(), *z = shape.coordinates[2].data();
    std::size_t best = 0;
    double bestValue = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0, n = shape.coordinates[0].size(); i < n; ++i) {
        const double value = x[i] * d.x() + y[i] * d.y() + z[i] * d.z();
        if (value > bestValue) {
            bestValue = value;
            best = i;
        }
    }
    const core::Vec3 p = shape.pose.apply({x[best], y[best], z[best]});
    ccdVec3Set(out, p.x(), p.y(), p.z());
}

class Libccd final : public Query {
  public:
    Libccd(std::span<const core::Vec3> tooth, std::span<const core::Vec3> bur)
        : tooth_(makeShape(tooth)), bur_(makeShape(bur)) {
        CCD_INIT(&ccd_);
        ccd_.support1 = support;
        ccd_.support2 = support;
        ccd_.max_iterations = 500;
        ccd_.epa_tolerance = 1e-4;
    }
    double depthMm(const core::Pose& burInTooth) override {
        bur_.pose = burInTooth;
        ccd_real_t depth = 0.0;
        ccd_vec3_t direction, position;
        return ccdGJKPenetration(&tooth_, &bur_, &ccd_, &depth, &direction, &position) == 0 ? depth : kNoContact;
    }

  private:
    Shape tooth_, bur_;
    ccd_t ccd_;
};

}  // namespace

std::unique_ptr<Query> makeLibccd(const PeerInput& input, bool hullVerticesOnly) {
    if (!hullVerticesOnly) return std::make_unique<Libccd>(input.tooth.vertices, input.bur.vertices);
    const geometry::ConvexHull tooth(input.tooth), bur(input.bur);
    return std::make_unique<Libccd>(tooth.mesh().vertices, bur.mesh().vertices);
}

}  // namespace handpiece::bench
