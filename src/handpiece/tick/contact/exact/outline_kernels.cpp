// SPDX-License-Identifier: Apache-2.0
// Compiled once per instruction set; see cmake/handpiece.cmake.
#include "handpiece/tick/contact/exact/outline_kernels.h"

#include "handpiece/tick/contact/exact/tree_search.h"
#include "handpiece/tick/contact/lanes.h"

namespace handpiece::contact::HANDPIECE_SIMD_NS {
namespace {

constexpr double kTiny = 1e-12, kGapMm = 1e-9;
constexpr int kEdgeSteps = 40;

inline Vector cross(Vector a, Vector b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double lesser(double a, double b) {
    return a < b ? a : b;
}

/// phiB at a place, and its slope.
struct Place {
    Vector at;
    double distance;
    Vector gradient;
};

/// phiB of a convex bur is convex, so a place and the slope there bound it everywhere else. What is looked for is the
/// depth's own place (q of the deepest ball with its centre c outside the tooth): where that lies within a triangle or
/// an edge, the bur's outline faces it. Deeper places within a triangle, on a ridge of phiB, belong to no such ball.
class OutlineQuery {
  public:
    OutlineQuery(const TreeView& tree, const Outline& outline, const double tip[3], const double axis[3],
                 OutlineHit& hit)
        : tree_(tree), outline_(outline), tip_{tip[0], tip[1], tip[2]}, axis_{axis[0], axis[1], axis[2]}, hit_(hit) {}

    [[nodiscard]] float best() const { return static_cast<float>(hit_.distance); }

    [[nodiscard]] Floats bounds(const KernelNode& node) const {
        const AxisBoxes b(node, tip_, axis_);
        const Floats ux = b.rx * b.inverseRho, uy = b.ry * b.inverseRho, uz = b.rz * b.inverseRho;
        Floats bound = splatF(-1e30f);
        for (int i = 0; i < outline_.tangentCount; ++i) {
            const OutlineTangent& t = outline_.tangents[i];
            const Floats gx = t.normalRho * ux + t.normalZ * b.ax, gy = t.normalRho * uy + t.normalZ * b.ay,
                         gz = t.normalRho * uz + t.normalZ * b.az;
            bound = mostF(bound, t.normalRho * b.rho + t.normalZ * b.z - t.offset -
                                     (absolute(gx) * b.hx + absolute(gy) * b.hy + absolute(gz) * b.hz));
        }
        return bound - kBoundSlackMm;
    }

    void evaluate(const std::uint32_t* ids, int count) {
        float bound[8];
        boundsOf(ids, count, bound);
        for (int i = 0; i < count; ++i)
            if (bound[i] < best()) evaluate(ids[i]);
    }

  private:
    /// As of boxes, with the triangles' own corners.
    void boundsOf(const std::uint32_t* ids, int count, float (&bounds)[8]) const {
        const float ax = static_cast<float>(axis_.x), ay = static_cast<float>(axis_.y),
                    az = static_cast<float>(axis_.z);
        Floats x[3], y[3], z[3];
        for (int lane = 0; lane < 8; ++lane) {
            const KernelTriangle& t = tree_.triangles[ids[lane < count ? lane : 0]];
            const double cx = t.a[0] - tip_.x, cy = t.a[1] - tip_.y, cz = t.a[2] - tip_.z;
            x[0][lane] = static_cast<float>(cx);
            y[0][lane] = static_cast<float>(cy);
            z[0][lane] = static_cast<float>(cz);
            x[1][lane] = static_cast<float>(cx + t.ab[0]);
            y[1][lane] = static_cast<float>(cy + t.ab[1]);
            z[1][lane] = static_cast<float>(cz + t.ab[2]);
            x[2][lane] = static_cast<float>(cx + t.ac[0]);
            y[2][lane] = static_cast<float>(cy + t.ac[1]);
            z[2][lane] = static_cast<float>(cz + t.ac[2]);
        }
        Floats along[3], out[3];
        for (int k = 0; k < 3; ++k)
            along[k] = x[k] * ax + y[k] * ay + z[k] * az;
        // Any direction across the axis bounds rho; that of the middle is a good one.
        const Floats mx = x[0] + x[1] + x[2], my = y[0] + y[1] + y[2], mz = z[0] + z[1] + z[2];
        const Floats m = along[0] + along[1] + along[2], rx = mx - m * ax, ry = my - m * ay, rz = mz - m * az;
        const Floats inverse = 1.0f / mostF(rootF(rx * rx + ry * ry + rz * rz), splatF(1e-12f));
        for (int k = 0; k < 3; ++k)
            out[k] = (rx * x[k] + ry * y[k] + rz * z[k]) * inverse;
        Floats bound = splatF(-1e30f);
        for (int i = 0; i < outline_.tangentCount; ++i) {
            const OutlineTangent& t = outline_.tangents[i];
            bound = mostF(bound, leastF(leastF(t.normalRho * out[0] + t.normalZ * along[0],
                                               t.normalRho * out[1] + t.normalZ * along[1]),
                                        t.normalRho * out[2] + t.normalZ * along[2]) -
                                     t.offset);
        }
        bound -= splatF(kBoundSlackMm);
        __builtin_memcpy(bounds, &bound, sizeof bounds);
    }

    void evaluate(std::uint32_t triangle) {
        const KernelTriangle& t = tree_.triangles[triangle];
        const Vector a{t.a[0], t.a[1], t.a[2]}, ab{t.ab[0], t.ab[1], t.ab[2]}, ac{t.ac[0], t.ac[1], t.ac[2]};
        const Vector b = a + ab, c = a + ac;
        const auto bound = [&](const Place& p) {
            const double toA = dot(p.gradient, a - p.at), toB = dot(p.gradient, b - p.at),
                         toC = dot(p.gradient, c - p.at);
            return p.distance + lesser(toA, lesser(toB, toC));
        };
        const Place middle = placeAt(a + (1.0 / 3.0) * (ab + ac));
        if (bound(middle) >= hit_.distance) return;
        take(middle, triangle);
        const Place corners[3] = {placeAt(a), placeAt(b), placeAt(c)};
        double least = -1e300;
        for (const Place& corner : corners) {
            take(corner, triangle);
            const double here = bound(corner);
            if (here > least) least = here;
        }
        if (least >= hit_.distance - kGapMm) return;
        for (int i = 0; i < 3; ++i)
            walkEdge(corners[i], corners[(i + 1) % 3], triangle);
        if (t.thin == 0) touchFace(a, ab, ac, triangle);
    }

    void take(const Place& place, std::uint32_t triangle) {
        if (!(place.distance < hit_.distance)) return;
        const Vector inwards = -1.0 * place.gradient;
        hit_ = {place.distance, {place.at.x, place.at.y, place.at.z}, {inwards.x, inwards.y, inwards.z}, triangle};
    }

    /// The least along an edge, between the tangents at both sides of it.
    void walkEdge(Place low, Place high, std::uint32_t triangle) {
        const Vector along = high.at - low.at;
        double from = 0.0, to = 1.0;
        for (int step = 0; step < kEdgeSteps; ++step) {
            const double falls = dot(low.gradient, along), rises = dot(high.gradient, along);
            if (falls >= 0.0 || rises <= 0.0) return;  // lowest at an end
            // Where the tangents meet.
            const double reach = to - from;
            const double t = (high.distance - low.distance - rises * reach) / (falls - rises);
            if (low.distance + falls * t >= hit_.distance - kGapMm) return;
            if (!(t > 0.0 && t < reach)) return;
            const Vector start = low.at;
            const Place next = placeAt(start + (t / reach) * (high.at - start));
            take(next, triangle);
            if (dot(next.gradient, along) < 0.0) {
                low = next;
                from += t;
            } else {
                high = next;
                to = from + t;
            }
        }
    }

    /// Within the triangle: over its place lies the bur's farthest point into the tooth, against the triangle's normal.
    void touchFace(Vector a, Vector ab, Vector ac, std::uint32_t triangle) {
        const Vector n = cross(ab, ac);
        const double size2 = dot(n, n);
        if (size2 <= 0.0) return;
        const Vector down = (-1.0 / __builtin_sqrt(size2)) * n;
        const double downZ = dot(down, axis_);
        Vector radial = down - downZ * axis_;
        const double downRho = __builtin_sqrt(dot(radial, radial));
        double rho = 0.0, z = 0.0;
        support(downRho, downZ, rho, z);
        if (downRho > kTiny) {
            radial = (1.0 / downRho) * radial;
        } else {  // a flat end over it: any of its points, best one over the triangle
            const Vector w = a + (1.0 / 3.0) * (ab + ac) - tip_;
            const Vector out = w - dot(w, axis_) * axis_;
            const double away = __builtin_sqrt(dot(out, out));
            radial = (1.0 / (away > kTiny ? away : kTiny)) * out;
            rho = lesser(rho, away);
        }
        const Vector p = tip_ + rho * radial + z * axis_, w = p - a;
        const Vector q = p - (dot(n, w) / size2) * n, v = q - a;
        const double ab2 = dot(ab, ab), ac2 = dot(ac, ac), abac = dot(ab, ac), d1 = dot(ab, v), d2 = dot(ac, v);
        const double s = ac2 * d1 - abac * d2, t = ab2 * d2 - abac * d1;
        if (s > 0.0 && t > 0.0 && s + t < size2) take(placeAt(q), triangle);
    }

    /// The outline's farthest point along a direction.
    void support(double alongRho, double alongZ, double& rho, double& z) const {
        double most = -1e300;
        const auto offer = [&](double r, double h) {
            const double value = alongRho * r + alongZ * h;
            if (value > most || (value == most && r > rho)) {
                most = value;
                rho = r;
                z = h;
            }
        };
        for (int i = 0; i < outline_.pieceCount; ++i) {
            const OutlinePiece& p = outline_.pieces[i];
            offer(p.to[0], p.to[1]);
            offer(p.from[0], p.from[1]);
            if (p.radius > 0.0 && isBetween(p, alongRho, alongZ))
                offer(p.centre[0] + p.radius * alongRho, p.centre[1] + p.radius * alongZ);
        }
    }

    /// Whether a direction from the arc's centre meets the arc, which turns by less than half a circle.
    static bool isBetween(const OutlinePiece& p, double rho, double z) {
        return p.normalFrom[0] * z - p.normalFrom[1] * rho >= 0.0 && rho * p.normalTo[1] - z * p.normalTo[0] >= 0.0;
    }

    [[nodiscard]] Place placeAt(Vector at) const {
        const Vector w = at - tip_;
        const double z = dot(w, axis_);
        const Vector radial = w - z * axis_;
        const double rho = __builtin_sqrt(dot(radial, radial));
        double best = 1e300, normalRho = 0.0, normalZ = 1.0;
        bool outside = false;
        const auto beyond = [&](const double(&from)[2], const double(&normal)[2]) {
            return normal[0] * (rho - from[0]) + normal[1] * (z - from[1]) > 0.0;
        };
        const auto offer = [&](double distance, double alongRho, double alongZ) {
            if (!(distance < best)) return;
            best = distance;
            normalRho = alongRho;
            normalZ = alongZ;
        };
        const auto offerCorner = [&](const double(&corner)[2], const double(&normal)[2]) {
            const double dr = rho - corner[0], dz = z - corner[1], distance = __builtin_sqrt(dr * dr + dz * dz);
            if (distance > kTiny)
                offer(distance, dr / distance, dz / distance);
            else
                offer(distance, normal[0], normal[1]);
        };
        for (int i = 0; i < outline_.pieceCount; ++i) {
            const OutlinePiece& p = outline_.pieces[i];
            outside = outside || beyond(p.from, p.normalFrom) || beyond(p.to, p.normalTo);
            if (p.radius > 0.0) {
                const double dr = rho - p.centre[0], dz = z - p.centre[1], d = __builtin_sqrt(dr * dr + dz * dz);
                if (d > kTiny && isBetween(p, dr, dz)) {
                    outside = outside || d > p.radius;
                    offer(d > p.radius ? d - p.radius : p.radius - d, dr / d, dz / d);
                    continue;
                }
            } else {
                const double er = p.to[0] - p.from[0], ez = p.to[1] - p.from[1];
                const double dr = rho - p.from[0], dz = z - p.from[1];
                const double along = dr * er + dz * ez;
                if (along >= 0.0 && along <= er * er + ez * ez) {  // its end on the axis belongs to it
                    const double d = p.normalFrom[0] * dr + p.normalFrom[1] * dz;
                    offer(d < 0.0 ? -d : d, p.normalFrom[0], p.normalFrom[1]);
                    continue;
                }
            }
            offerCorner(p.from, p.normalFrom);
            offerCorner(p.to, p.normalTo);
        }
        // On the axis the slopes all around it cancel.
        const double alongRho = rho > kTiny ? normalRho / rho : 0.0;
        return {at, outside ? best : -best, alongRho * radial + normalZ * axis_};
    }

    const TreeView& tree_;
    const Outline& outline_;
    Vector tip_, axis_;
    OutlineHit& hit_;
};

void search(const TreeView& tree, const Outline& outline, const double tip[3], const double axis[3],
            OutlineHit& hit) noexcept {
    const std::uint32_t seed = hit.triangle;
    hit.triangle = SurfaceHit::kNone;
    OutlineQuery query(tree, outline, tip, axis, hit);
    contact::search(tree, seed, query);
}

}  // namespace

NearestToOutline nearestToOutline() noexcept {
    return search;
}

}  // namespace handpiece::contact::HANDPIECE_SIMD_NS
