// SPDX-License-Identifier: Apache-2.0
#include "peers/openvdb.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <vector>

namespace handpiece::bench {
namespace {

constexpr double kVoxelMm = 0.05;
constexpr float kOutsideVoxels = 4.0f, kInsideVoxels = 12.0f;  // 0.6 mm inside

class Openvdb final : public Query {
  public:
    explicit Openvdb(const PeerInput& input)
        : bur_(input.bur.vertices), grid_(makeGrid(input.tooth)), accessor_(grid_->getConstAccessor()) {}
    double depthMm(const core::Pose& burInTooth) override {
        double depth = kNoContact;
        for (const core::Vec3& v : bur_) {
            const core::Vec3 p = burInTooth.apply(v) / kVoxelMm;
            const float distance = openvdb::tools::BoxSampler::sample(accessor_, openvdb::Vec3d(p.x(), p.y(), p.z()));
            depth = std::max(depth, -static_cast<double>(distance));
        }
        // Beyond the band the value is the band's width, not a distance.
        return depth > -0.9 * kOutsideVoxels * kVoxelMm ? depth : kNoContact;
    }

  private:
    static openvdb::FloatGrid::Ptr makeGrid(const geometry::TriangleMesh& mesh) {
        openvdb::initialize();
        std::vector<openvdb::Vec3s> points;
        for (const core::Vec3& v : mesh.vertices)
            points.emplace_back(v.x() / kVoxelMm, v.y() / kVoxelMm, v.z() / kVoxelMm);
        std::vector<openvdb::Vec3I> triangles;
        for (const geometry::Triangle& t : mesh.triangles)
            triangles.emplace_back(t[0], t[1], t[2]);
        const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(points, triangles);
        return openvdb::tools::meshToVolume<openvdb::FloatGrid>(
            adapter, *openvdb::math::Transform::createLinearTransform(kVoxelMm), kOutsideVoxels, kInsideVoxels);
    }
    std::vector<core::Vec3> bur_;
    openvdb::FloatGrid::Ptr grid_;
    openvdb::FloatGrid::ConstAccessor accessor_;
};

}  // namespace

std::unique_ptr<Query> makeOpenvdb(const PeerInput& input) {
    return std::make_unique<Openvdb>(input);
}

}  // namespace handpiece::bench
