// SPDX-License-Identifier: Apache-2.0
#include "peers/fcl.h"

#include <fcl/fcl.h>

#include <algorithm>
#include <vector>

namespace handpiece::bench {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<Model> makeModel(const geometry::TriangleMesh& mesh) {
    std::vector<fcl::Triangle> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const geometry::Triangle& t : mesh.triangles)
        triangles.emplace_back(t[0], t[1], t[2]);
    auto model = std::make_shared<Model>();
    model->beginModel(static_cast<int>(mesh.triangles.size()), static_cast<int>(mesh.vertices.size()));
    model->addSubModel(mesh.vertices, triangles);
    model->endModel();
    return model;
}

class Fcl final : public Query {
  public:
    explicit Fcl(const PeerInput& input) : tooth_(makeModel(input.tooth)), bur_(makeModel(input.bur)) {}
    double depthMm(const core::Pose& burInTooth) override {
        fcl::Transform3d pose = fcl::Transform3d::Identity();
        pose.linear() = burInTooth.orientation.toRotationMatrix();
        pose.translation() = burInTooth.positionMm;
        const fcl::CollisionRequestd request(100000, true);
        fcl::CollisionResultd result;
        fcl::collide(tooth_.get(), fcl::Transform3d::Identity(), bur_.get(), pose, request, result);
        double depth = kNoContact;
        for (std::size_t i = 0; i < result.numContacts(); ++i)
            depth = std::max(depth, std::abs(result.getContact(i).penetration_depth));
        return depth;
    }

  private:
    std::shared_ptr<Model> tooth_, bur_;
};

}  // namespace

std::unique_ptr<Query> makeFcl(const PeerInput& input) {
    return std::make_unique<Fcl>(input);
}

}  // namespace handpiece::bench
