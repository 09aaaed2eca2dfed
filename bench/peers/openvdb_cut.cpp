// SPDX-License-Identifier: Apache-2.0
#include <openvdb/openvdb.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetMeasure.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "peers/cut_peer.h"

namespace handpiece::bench {
namespace {

openvdb::FloatGrid::Ptr levelSet(const geometry::TriangleMesh& mesh, const core::Pose& pose, double voxelMm,
                                 double outVoxels, double inVoxels) {
    std::vector<openvdb::Vec3s> points;
    points.reserve(mesh.vertices.size());
    for (const core::Vec3& v : mesh.vertices) {
        const core::Vec3 p = pose.apply(v) / voxelMm;
        points.emplace_back(p.x(), p.y(), p.z());
    }
    std::vector<openvdb::Vec3I> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const geometry::Triangle& t : mesh.triangles)
        triangles.emplace_back(t[0], t[1], t[2]);
    const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(points, triangles);
    return openvdb::tools::meshToVolume<openvdb::FloatGrid>(
        adapter, *openvdb::math::Transform::createLinearTransform(voxelMm), static_cast<float>(outVoxels),
        static_cast<float>(inVoxels));
}

class OpenvdbCut : public CutPeer {
  public:
    OpenvdbCut(const PeerInput& input, double voxelMm, double outVoxels, double inVoxels)
        : voxelMm_(voxelMm), burMesh_(input.bur) {
        openvdb::initialize();
        grid_ = levelSet(input.tooth, {}, voxelMm, outVoxels, inVoxels);
    }
    double volumeMm3() const override { return openvdb::tools::levelSetVolume(*grid_); }

  protected:
    double depthMm(const core::Pose& pose) const {
        const auto accessor = grid_->getConstAccessor();
        double depth = kNoContact;
        for (const core::Vec3& v : burMesh_.vertices) {
            const core::Vec3 p = pose.apply(v) / voxelMm_;
            depth = std::max(depth, -static_cast<double>(openvdb::tools::BoxSampler::sample(
                                        accessor, openvdb::Vec3d(p.x(), p.y(), p.z()))));
        }
        return depth;
    }
    double voxelMm_;
    geometry::TriangleMesh burMesh_;
    openvdb::FloatGrid::Ptr grid_;
};

class InPlace final : public OpenvdbCut {
  public:
    InPlace(const PeerInput& input, const instrument::Bur& bur, double voxelMm, double bandOutMm, double bandMm)
        : OpenvdbCut(input, voxelMm, bandOutMm / voxelMm, bandMm / voxelMm),
          bur_(bur),
          bandOutMm_(bandOutMm),
          bandMm_(bandMm) {}
    double cutMm(const core::Pose& pose) override {
        const double depth = depthMm(pose);
        const core::Vec3 axis = pose.orientation * core::Vec3::UnitZ();
        int low[3], high[3];
        for (int k = 0; k < 3; ++k) {
            const double side = bur_.maxRadiusMm() * std::sqrt(std::max(0.0, 1.0 - axis[k] * axis[k])) + bandMm_;
            const double tip = pose.positionMm[k], top = tip + bur_.lengthMm() * axis[k];
            low[k] = static_cast<int>(std::floor((std::min(tip, top) - side) / voxelMm_));
            high[k] = static_cast<int>(std::ceil((std::max(tip, top) + side) / voxelMm_));
        }
        auto accessor = grid_->getAccessor();
        for (int x = low[0]; x <= high[0]; ++x)
            for (int y = low[1]; y <= high[1]; ++y)
                for (int z = low[2]; z <= high[2]; ++z) {
                    const openvdb::Coord at(x, y, z);
                    const float before = accessor.getValue(at);
                    if (before >= static_cast<float>(bandOutMm_)) continue;
                    const core::Vec3 p = voxelMm_ * core::Vec3(x, y, z);
                    const auto reached =
                        static_cast<float>(std::min(-bur_.signedDistance(pose.applyInverse(p)), bandOutMm_));
                    if (reached > before) accessor.setValue(at, reached);
                }
        return depth;
    }

  private:
    instrument::Bur bur_;
    double bandOutMm_, bandMm_;
};

class Csg final : public OpenvdbCut {
  public:
    // csgDifference wants both sides of one width.
    Csg(const PeerInput& input, double voxelMm, double bandOutMm, double bandMm)
        : OpenvdbCut(input, voxelMm, std::max(bandOutMm, bandMm) / voxelMm, std::max(bandOutMm, bandMm) / voxelMm),
          widthVoxels_(std::max(bandOutMm, bandMm) / voxelMm) {}
    double cutMm(const core::Pose& pose) override {
        const double depth = depthMm(pose);
        const openvdb::FloatGrid::Ptr bur = levelSet(burMesh_, pose, voxelMm_, widthVoxels_, widthVoxels_);
        openvdb::tools::csgDifference(*grid_, *bur);
        return depth;
    }

  private:
    double widthVoxels_;
};

}  // namespace

std::unique_ptr<CutPeer> makeOpenvdbInPlace(const PeerInput& input, const instrument::Bur& bur, double voxelMm,
                                            double bandOutMm, double bandMm) {
    return std::make_unique<InPlace>(input, bur, voxelMm, bandOutMm, bandMm);
}

std::unique_ptr<CutPeer> makeOpenvdbCsg(const PeerInput& input, double voxelMm, double bandOutMm, double bandMm) {
    return std::make_unique<Csg>(input, voxelMm, bandOutMm, bandMm);
}

}  // namespace handpiece::bench
