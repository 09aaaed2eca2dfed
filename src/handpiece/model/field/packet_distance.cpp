// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/packet_distance.h"

#include <algorithm>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/simd.h"

namespace handpiece::field {

using core::Vec3;
using geometry::TreeTriangle;

FlatTriangle flattened(const TreeTriangle& t) {
    const Vec3 a(t.a[0], t.a[1], t.a[2]), ab(t.ab[0], t.ab[1], t.ab[2]), ac(t.ac[0], t.ac[1], t.ac[2]);
    // Corner i of the frame's triangle is corner (first + i) % 3 of the mesh's; edge 0 the longest.
    const Vec3 corner[3] = {Vec3::Zero(), ab, ac};
    int first = 0;
    double longest = -1.0;
    for (int e = 0; e < 3; ++e) {
        const double length = (corner[(e + 1) % 3] - corner[e]).squaredNorm();
        if (length > longest) {
            longest = length;
            first = e;
        }
    }
    const Vec3 o = corner[first], p = corner[(first + 1) % 3] - o, q = corner[(first + 2) % 3] - o;
    const double length = std::sqrt(longest);
    const Vec3 x = length > 0.0 ? Vec3(p / length) : Vec3::UnitX();
    const Vec3 up = q - x * x.dot(q);
    const double height = up.norm();
    const bool flat = !(height > 1e-12 * length) || height == 0.0;
    const Vec3 y = flat ? x.unitOrthogonal() : Vec3((up / height - x * x.dot(up / height)).normalized());
    const Vec3 n = x.cross(y);
    FlatTriangle out{};
    for (int k = 0; k < 3; ++k) {
        out.origin[k] = a[k] + o[k];
        out.x[k] = static_cast<float>(x[k]);
        out.y[k] = static_cast<float>(y[k]);
        out.n[k] = static_cast<float>(n[k]);
    }
    out.length = static_cast<float>(length);
    out.cx = static_cast<float>(x.dot(q));
    out.cy = flat ? 0.0f : static_cast<float>(height);
    const auto inverse = [](float dx, float dy) {
        const float square = dx * dx + dy * dy, reciprocal = 1.0f / square;
        return square > 0.0f && std::isfinite(reciprocal) ? reciprocal : 0.0f;
    };
    out.inverseBc2 = inverse(out.cx - out.length, out.cy);
    out.inverseCa2 = inverse(out.cx, out.cy);
    return out;
}

PacketDistance::PacketDistance(const geometry::TriangleTree& tree)
    : tree_(tree),
      kernel_(HANDPIECE_AT_SIMD_LEVEL(core::simdLevel(), nearestOfPacket)),
      flat_(tree.triangles().size()) {
    core::parallelFor(flat_.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            flat_[i] = flattened(tree.triangles()[i]);
    });
}

float distanceTo(const geometry::TriangleTree& tree, std::uint32_t triangle, const Vec3& p) {
    const geometry::NearestPoint n = tree.nearestOn(triangle, p);
    return static_cast<float>(tree.side(p, n) * n.distanceMm);
}

std::uint32_t PacketDistance::distances(const Vec3* points, int count, std::uint32_t seed, float* out,
                                        std::uint32_t* triangles) const {
    core::Box box;
    for (int i = 0; i < count; ++i)
        box.extend(points[i]);
    PointPacket packet;
    const Vec3 centre = box.centre();
    for (int k = 0; k < 3; ++k) {
        packet.centre[k] = centre[k];
        packet.halfSize[k] = static_cast<float>(0.5 * (box.max[k] - box.min[k]));
        for (int i = 0; i < kPacket; ++i)
            packet.offset[k][i] = static_cast<float>(points[i < count ? i : 0][k] - centre[k]);
    }
    std::uint32_t nearest[kPacket];
    kernel_(tree_.nodes().data(), flat_.data(), packet, seed, nearest);
    for (int i = 0; i < count; ++i)
        out[i] = distanceTo(tree_, nearest[i], points[i]);
    if (triangles != nullptr) std::copy_n(nearest, count, triangles);
    return nearest[0];
}

}  // namespace handpiece::field
