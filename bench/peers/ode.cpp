// SPDX-License-Identifier: Apache-2.0
#include "peers/ode.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <vector>

namespace handpiece::bench {
namespace {

class Ode final : public Query {
  public:
    explicit Ode(const PeerInput& input)
        : halfSegmentMm_(0.5 * (input.burLengthMm - input.burRadiusMm)), radiusMm_(input.burRadiusMm) {
        dInitODE();
        for (const core::Vec3& v : input.tooth.vertices)
            vertices_.insert(vertices_.end(), {v.x(), v.y(), v.z()});
        for (const geometry::Triangle& t : input.tooth.triangles)
            indices_.insert(indices_.end(), {t[0], t[1], t[2]});
        data_ = dGeomTriMeshDataCreate();
        dGeomTriMeshDataBuildDouble(data_, vertices_.data(), 3 * sizeof(double), static_cast<int>(vertices_.size() / 3),
                                    indices_.data(), static_cast<int>(indices_.size()), 3 * sizeof(dTriIndex));
        tooth_ = dCreateTriMesh(nullptr, data_, nullptr, nullptr, nullptr);
        // The round tip is the capsule's lower cap; its upper one stands above the flat top, clear of the tooth.
        bur_ = dCreateCapsule(nullptr, radiusMm_, 2.0 * halfSegmentMm_);
    }
    ~Ode() override {
        dGeomDestroy(bur_);
        dGeomDestroy(tooth_);
        dGeomTriMeshDataDestroy(data_);
        dCloseODE();
    }
    Ode(const Ode&) = delete;
    Ode& operator=(const Ode&) = delete;

    double depthMm(const core::Pose& burInTooth) override {
        const core::Vec3 centre = burInTooth.apply({0, 0, radiusMm_ + halfSegmentMm_});
        dGeomSetPosition(bur_, centre.x(), centre.y(), centre.z());
        const core::Quat& q = burInTooth.orientation;
        const dQuaternion turn = {q.w(), q.x(), q.y(), q.z()};
        dGeomSetQuaternion(bur_, turn);
        const int count =
            dCollide(tooth_, bur_, static_cast<int>(contacts_.size()), contacts_.data(), sizeof(dContactGeom));
        double depth = kNoContact;
        for (int i = 0; i < count; ++i)
            depth = std::max(depth, static_cast<double>(contacts_[static_cast<std::size_t>(i)].depth));
        return depth;
    }

  private:
    double halfSegmentMm_, radiusMm_;
    std::vector<double> vertices_;
    std::vector<dTriIndex> indices_;
    std::array<dContactGeom, 1024> contacts_;
    dTriMeshDataID data_;
    dGeomID tooth_, bur_;
};

}  // namespace

std::unique_ptr<Query> makeOde(const PeerInput& input) {
    return std::make_unique<Ode>(input);
}

}  // namespace handpiece::bench
