// SPDX-License-Identifier: Apache-2.0
#include "peers/embree.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "handpiece/base/core/simd.h"

namespace handpiece::bench {
namespace {

using core::Vec3;

/// Nearest point of a triangle (Ericson 2005, 5.1.5); `feature` 0 face, 1..3 corner, 4..6 edge ab, bc, ca.
Vec3 nearestOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, int& feature) {
    const Vec3 ab = b - a, ac = c - a, ap = p - a;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return feature = 1, a;
    const Vec3 bp = p - b;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return feature = 2, b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return feature = 4, a + d1 / (d1 - d3) * ab;
    const Vec3 cp = p - c;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return feature = 3, c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return feature = 6, a + d2 / (d2 - d6) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return feature = 5, b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    const double sum = va + vb + vc;
    return feature = 0, a + vb / sum * ab + vc / sum * ac;
}

struct Found {
    const geometry::TriangleMesh* mesh;
    Vec3 point;  ///< asked about
    Vec3 nearest;
    double distance2;
    unsigned triangle;
    int feature;
};

bool visit(RTCPointQueryFunctionArguments* arguments) {
    Found& found = *static_cast<Found*>(arguments->userPtr);
    const geometry::Triangle& t = found.mesh->triangles[arguments->primID];
    const auto& v = found.mesh->vertices;
    int feature = 0;
    const Vec3 q = nearestOnTriangle(found.point, v[t[0]], v[t[1]], v[t[2]], feature);
    const double distance2 = (q - found.point).squaredNorm();
    if (distance2 >= found.distance2) return false;
    found.distance2 = distance2;
    found.nearest = q;
    found.triangle = arguments->primID;
    found.feature = feature;
    arguments->query->radius = static_cast<float>(std::sqrt(distance2) * (1.0 + 1e-6));
    return true;
}

class Embree final : public Query {
  public:
    explicit Embree(const PeerInput& input) : mesh_(input.tooth), bur_(input.bur.vertices) {
        // Held to the instruction set that we are held to.
        const core::SimdLevel level = core::simdLevel();
        device_ = rtcNewDevice(level == core::SimdLevel::avx512 ? nullptr
                               : level == core::SimdLevel::avx2 ? "isa=avx2"
                                                                : "isa=sse2");
        scene_ = rtcNewScene(device_);
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                              3 * sizeof(float), mesh_.vertices.size()));
        for (const Vec3& p : mesh_.vertices)
            for (int axis = 0; axis < 3; ++axis)
                *v++ = static_cast<float>(p[axis]);
        auto* t = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 3 * sizeof(unsigned), mesh_.triangles.size()));
        for (const geometry::Triangle& triangle : mesh_.triangles)
            for (const std::uint32_t corner : triangle)
                *t++ = corner;
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
        buildPseudonormals();
    }
    ~Embree() override {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    Embree(const Embree&) = delete;
    Embree& operator=(const Embree&) = delete;

    double depthMm(const core::Pose& burInTooth) override {
        double depth = kNoContact;
        for (const Vec3& v : bur_)
            depth = std::max(depth, -signedDistance(burInTooth.apply(v)));
        return depth;
    }

  private:
    double signedDistance(const Vec3& p) const {
        Found found{&mesh_, p, Vec3::Zero(), std::numeric_limits<double>::infinity(), 0, 0};
        RTCPointQuery query;
        query.x = static_cast<float>(p.x());
        query.y = static_cast<float>(p.y());
        query.z = static_cast<float>(p.z());
        query.time = 0.0f;
        query.radius = std::numeric_limits<float>::infinity();
        RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        rtcPointQuery(scene_, &query, &context, visit, &found);
        const geometry::Triangle& t = mesh_.triangles[found.triangle];
        const auto corner = static_cast<std::size_t>(found.feature);
        const Vec3& normal = found.feature == 0   ? faceNormals_[found.triangle]
                             : found.feature <= 3 ? vertexNormals_[t[corner - 1]]
                                                  : edgeNormals_[found.triangle][corner - 4];
        return std::copysign(std::sqrt(found.distance2), normal.dot(p - found.nearest));
    }
    // Baerentzen & Aanaes 2005.
    void buildPseudonormals() {
        vertexNormals_.assign(mesh_.vertices.size(), Vec3::Zero());
        edgeNormals_.resize(mesh_.triangles.size());
        std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3> edges;
        for (const geometry::Triangle& t : mesh_.triangles) {
            const auto& v = mesh_.vertices;
            const Vec3 n = (v[t[1]] - v[t[0]]).cross(v[t[2]] - v[t[0]]).normalized();
            faceNormals_.push_back(n);
            for (std::size_t i = 0; i < 3; ++i) {
                const Vec3 e = v[t[(i + 1) % 3]] - v[t[i]], f = v[t[(i + 2) % 3]] - v[t[i]];
                vertexNormals_[t[i]] += std::atan2(e.cross(f).norm(), e.dot(f)) * n;
                edges.try_emplace(std::minmax(t[i], t[(i + 1) % 3]), Vec3::Zero()).first->second += n;
            }
        }
        for (std::size_t k = 0; k < mesh_.triangles.size(); ++k)
            for (std::size_t i = 0; i < 3; ++i)
                edgeNormals_[k][i] = edges.at(std::minmax(mesh_.triangles[k][i], mesh_.triangles[k][(i + 1) % 3]));
    }

    const geometry::TriangleMesh& mesh_;
    std::vector<Vec3> bur_;
    std::vector<Vec3> faceNormals_, vertexNormals_;
    std::vector<std::array<Vec3, 3>> edgeNormals_;
    RTCDevice device_;
    RTCScene scene_;
};

}  // namespace

std::unique_ptr<Query> makeEmbree(const PeerInput& input) {
    return std::make_unique<Embree>(input);
}

}  // namespace handpiece::bench
