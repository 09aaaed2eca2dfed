// SPDX-License-Identifier: Apache-2.0
#include "peers/bullet.h"

#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <vector>

namespace handpiece::bench {
namespace {

btVector3 toBullet(const core::Vec3& v) {
    return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

struct Deepest final : btCollisionWorld::ContactResultCallback {
    double depthMm = kNoContact;
    btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
        depthMm = std::max(depthMm, -static_cast<double>(point.getDistance()));
        return 0;
    }
};

class Bullet final : public Query {
  public:
    explicit Bullet(const PeerInput& input)
        : dispatcher_(&configuration_), world_(&dispatcher_, &broadphase_, &configuration_) {
        for (const core::Vec3& v : input.tooth.vertices)
            vertices_.push_back(toBullet(v));
        for (const geometry::Triangle& t : input.tooth.triangles)
            for (const std::uint32_t corner : t)
                indices_.push_back(static_cast<int>(corner));
        arrays_ = std::make_unique<btTriangleIndexVertexArray>(
            static_cast<int>(input.tooth.triangles.size()), indices_.data(), 3 * static_cast<int>(sizeof(int)),
            static_cast<int>(vertices_.size()), &vertices_[0][0], static_cast<int>(sizeof(btVector3)));
        toothShape_ = std::make_unique<btBvhTriangleMeshShape>(arrays_.get(), true);
        toothShape_->setMargin(0);
        for (const core::Vec3& v : input.bur.vertices)
            burShape_.addPoint(toBullet(v), false);
        burShape_.recalcLocalAabb();
        burShape_.setMargin(0);
        tooth_.setCollisionShape(toothShape_.get());
        bur_.setCollisionShape(&burShape_);
    }
    double depthMm(const core::Pose& burInTooth) override {
        const core::Quat& q = burInTooth.orientation;
        bur_.setWorldTransform(btTransform(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                                        static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w())),
                                           toBullet(burInTooth.positionMm)));
        Deepest deepest;
        world_.contactPairTest(&tooth_, &bur_, deepest);
        return deepest.depthMm > 0.0 ? deepest.depthMm : kNoContact;
    }

  private:
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDbvtBroadphase broadphase_;
    btCollisionWorld world_;
    std::vector<btVector3> vertices_;
    std::vector<int> indices_;
    std::unique_ptr<btTriangleIndexVertexArray> arrays_;
    std::unique_ptr<btBvhTriangleMeshShape> toothShape_;
    btConvexHullShape burShape_;
    btCollisionObject tooth_, bur_;
};

}  // namespace

std::unique_ptr<Query> makeBullet(const PeerInput& input) {
    return std::make_unique<Bullet>(input);
}

}  // namespace handpiece::bench
