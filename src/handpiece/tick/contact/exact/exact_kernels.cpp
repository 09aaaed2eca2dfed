// SPDX-License-Identifier: Apache-2.0
// Compiled once per instruction set; see cmake/handpiece.cmake.
#include "handpiece/tick/contact/exact/exact_kernels.h"

#include "handpiece/tick/contact/exact/tree_search.h"
#include "handpiece/tick/contact/lanes.h"

namespace handpiece::contact::HANDPIECE_SIMD_NS {
namespace {

constexpr double kSmall = 1e-300;

inline Vector vectorOf(const double (&v)[3]) {
    return {v[0], v[1], v[2]};
}

/// Triangles side by side, as many as a register holds doubles; lanes beyond `count` repeat the first.
struct Packet {
    Doubles a[3], ab[3], ac[3];

    Packet(const KernelTriangle* triangles, const std::uint32_t* ids, int count) {
        const KernelTriangle* t[kDoubleLanes];
        for (int lane = 0; lane < kDoubleLanes; ++lane)
            t[lane] = &triangles[ids[lane < count ? lane : 0]];
        for (int k = 0; k < 3; ++k) {
            a[k] = gather([&](int lane) { return t[lane]->a[k]; });
            ab[k] = gather([&](int lane) { return t[lane]->ab[k]; });
            ac[k] = gather([&](int lane) { return t[lane]->ac[k]; });
        }
    }
};

inline Doubles dot(const Doubles (&u)[3], const Doubles (&v)[3]) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}
inline Doubles dot(const Doubles (&u)[3], Vector v) {
    return u[0] * v.x + u[1] * v.y + u[2] * v.z;
}
inline Doubles inverse(Doubles x) {
    return 1.0 / most(x, splat(kSmall));
}

/// Inner products of the packet's triangles that every query needs.
struct Shape {
    Doubles ab2, ac2, abac, bc2, inverseAb2, inverseAc2, inverseBc2, det;
    Doubles n[3], inverseN2;

    explicit Shape(const Packet& p) {
        ab2 = dot(p.ab, p.ab);
        ac2 = dot(p.ac, p.ac);
        abac = dot(p.ab, p.ac);
        bc2 = most(ab2 - 2.0 * abac + ac2, splat(0.0));
        inverseAb2 = inverse(ab2);
        inverseAc2 = inverse(ac2);
        inverseBc2 = inverse(bc2);
        det = ab2 * ac2 - abac * abac;
        n[0] = p.ab[1] * p.ac[2] - p.ab[2] * p.ac[1];
        n[1] = p.ab[2] * p.ac[0] - p.ab[0] * p.ac[2];
        n[2] = p.ab[0] * p.ac[1] - p.ab[1] * p.ac[0];
        inverseN2 = inverse(dot(n, n));
    }
    /// Squared distance of a point given by its products with the triangle: d1, d2 with the edges, pp its own, height
    /// with n; `half` becomes half the derivative of that along a direction whose products are h1, h2, hp, hn.
    inline Doubles distance2(Doubles d1, Doubles d2, Doubles pp, Doubles height, Doubles h1, Doubles h2, Doubles hp,
                             Doubles hn, Doubles& half) const {
        const Doubles zero = splat(0.0), one = splat(1.0);
        const Doubles t1 = clampTo(d1 * inverseAb2, zero, one);
        const Doubles t2 = clampTo(d2 * inverseAc2, zero, one);
        const Doubles db = d2 - d1 - abac + ab2;
        const Doubles t3 = clampTo(db * inverseBc2, zero, one);
        Doubles best = pp - t1 * (2.0 * d1 - t1 * ab2);
        half = hp - t1 * h1;
        const Doubles onAc = pp - t2 * (2.0 * d2 - t2 * ac2);
        half = choose(onAc < best, hp - t2 * h2, half);
        best = least(best, onAc);
        const Doubles onBc = pp - 2.0 * d1 + ab2 - t3 * (2.0 * db - t3 * bc2);
        half = choose(onBc < best, hp - h1 - t3 * (h2 - h1), half);
        best = least(best, onBc);
        const Doubles v = ac2 * d1 - abac * d2, w = ab2 * d2 - abac * d1;
        const Longs inside = (v > zero) & (w > zero) & (v + w < det);
        half = choose(inside, height * hn * inverseN2, half);
        return choose(inside, height * height * inverseN2, best);
    }
};

/// Ericson 2005, 5.1.5, in double on one triangle: the exact last word on the winner of a packet.
Vector closestPoint(const KernelTriangle& t, Vector p, std::uint8_t& feature) {
    const Vector a = vectorOf(t.a), ab = vectorOf(t.ab), ac = vectorOf(t.ac), ap = p - a;
    const double ab2 = dot(ab, ab), ac2 = dot(ac, ac), abac = dot(ab, ac), d1 = dot(ab, ap), d2 = dot(ac, ap);
    const double det = ab2 * ac2 - abac * abac, v = ac2 * d1 - abac * d2, w = ab2 * d2 - abac * d1;
    if (v > 0.0 && w > 0.0 && v + w < det && t.thin == 0) {
        feature = 0;
        return a + (v / det) * ab + (w / det) * ac;
    }
    const Vector bc = ac - ab, froms[3] = {a, a + ab, a + ac};
    const Vector alongs[3] = {ab, bc, -1.0 * ac};
    double best = 1e300;
    Vector point = a;
    for (int e = 0; e < 3; ++e) {
        const double length2 = dot(alongs[e], alongs[e]);
        double at = length2 > 0.0 ? dot(p - froms[e], alongs[e]) / length2 : 0.0;
        at = at < 0.0 ? 0.0 : at > 1.0 ? 1.0 : at;
        const Vector q = at == 1.0 ? froms[(e + 1) % 3] : froms[e] + at * alongs[e];
        const double d = dot(p - q, p - q);
        if (d < best) {
            best = d;
            point = q;
            feature = static_cast<std::uint8_t>(at == 0.0 ? 4 + e : at == 1.0 ? 4 + (e + 1) % 3 : 1 + e);
        }
    }
    return point;
}

class RunQuery {
  public:
    RunQuery(const TreeView& tree, const AxisRun& run, const double tip[3], const double axis[3], SurfaceHit& hit)
        : tree_(tree), run_(run), tip_{tip[0], tip[1], tip[2]}, axis_{axis[0], axis[1], axis[2]}, hit_(hit) {
        low_ = static_cast<float>(run.z[0]);
        high_ = static_cast<float>(run.z[run.count - 1]);
    }
    [[nodiscard]] float best() const { return static_cast<float>(hit_.value); }

    [[nodiscard]] Floats bounds(const KernelNode& node) const {
        const AxisBoxes b(node, tip_, axis_);
        const Floats half = b.hx * __builtin_fabsf(b.ax) + b.hy * __builtin_fabsf(b.ay) + b.hz * __builtin_fabsf(b.az);
        const Floats gap = mostF(mostF(low_ - (b.z + half), (b.z - half) - high_), Floats{});
        const Floats across = (absolute(b.rx) * b.hx + absolute(b.ry) * b.hy + absolute(b.rz) * b.hz) * b.inverseRho;
        const Floats away = mostF(b.rho - across, Floats{});
        Floats bound = rootF(gap * gap + away * away) - run_.maxRadius;
        for (int i = 0; i < run_.lines; ++i) {
            const float slope = run_.lineSlope[i];
            const Floats line =
                away * run_.lineCosine[i] - run_.lineRadius[i] - slope * b.z - __builtin_fabsf(slope) * half;
            bound = mostF(bound, line);
        }
        return bound - kBoundSlackMm;
    }

    void evaluate(const std::uint32_t* ids, int count) {
        double value[8], at[8], radius[8];
        for (int first = 0; first < count; first += kDoubleLanes) {
            const Packet packet(tree_.triangles, ids + first, count - first);
            Doubles bestS, itsRadius = splat(run_.radius[0]);
            const Doubles best = run_.constant ? leastOfConstant(packet, bestS) : leastOfAny(packet, bestS, itsRadius);
            __builtin_memcpy(value + first, &best, sizeof best);
            __builtin_memcpy(at + first, &bestS, sizeof bestS);
            __builtin_memcpy(radius + first, &itsRadius, sizeof itsRadius);
        }
        int lane = 0;
        for (int i = 1; i < count; ++i)
            if (value[i] < value[lane]) lane = i;
        if (run_.constant) {
            const double limit = hit_.value + run_.radius[0] + 1e-9;
            if (limit <= 0.0 || value[lane] >= limit * limit) return;
        } else if (value[lane] >= hit_.value + 1e-9) {
            return;
        }
        take(ids[lane], at[lane], radius[lane]);
    }

  private:
    /// Every product of a triangle with p(s) = tip + s axis is linear in s.
    struct Products {
        Doubles a0, a1, b0, b1, c0, c1, n0, n1;  ///< with ab, with ac, with itself and the axis, with the normal

        Products(const Packet& packet, const Shape& shape, Vector tip, Vector axis) {
            const Doubles w[3] = {tip.x - packet.a[0], tip.y - packet.a[1], tip.z - packet.a[2]};
            a0 = dot(packet.ab, w);
            a1 = dot(packet.ab, axis);
            b0 = dot(packet.ac, w);
            b1 = dot(packet.ac, axis);
            c0 = dot(w, w);
            c1 = dot(w, axis);
            n0 = dot(shape.n, w);
            n1 = dot(shape.n, axis);
        }
        /// Squared distance from p(s) to the triangle, and half its derivative.
        [[nodiscard]] Doubles distance2(const Shape& shape, Doubles s, Doubles& half) const {
            return shape.distance2(a0 + s * a1, b0 + s * b1, c0 + s * (2.0 * c1 + s), n0 + s * n1, a1, b1, c1 + s, n1,
                                   half);
        }
        /// Where the axis meets the plane, and whether that is in the triangle.
        [[nodiscard]] Longs crossing(const Shape& shape, Doubles& s) const {
            const Doubles zero = splat(0.0);
            s = -n0 / choose(n1 == zero, splat(kSmall), n1);
            const Doubles d1 = a0 + s * a1, d2 = b0 + s * b1;
            const Doubles v = shape.ac2 * d1 - shape.abac * d2, w = shape.ab2 * d2 - shape.abac * d1;
            return (v >= zero) & (w >= zero) & (v + w <= shape.det) & (shape.det > zero);
        }
    };

    /// Squared distances, and where on the axis.
    [[nodiscard]] Doubles leastOfConstant(const Packet& packet, Doubles& bestS) const {
        const Shape shape(packet);
        const Products p(packet, shape, tip_, axis_);
        const Doubles zero = splat(0.0), one = splat(1.0), s0 = splat(run_.z[0]), s1 = splat(run_.z[run_.count - 1]);
        Doubles half, best = p.distance2(shape, s0, half);
        bestS = s0;
        const auto offer = [&](Longs valid, Doubles value, Doubles s) {
            const Longs better = valid & (value < best);
            best = choose(better, value, best);
            bestS = choose(better, s, bestS);
        };
        const Longs all = zero == zero;
        offer(all, p.distance2(shape, s1, half), s1);
        const auto corner = [&](Doubles c0, Doubles c1) {
            const Doubles s = clampTo(-c1, s0, s1);
            offer(all, c0 + s * (2.0 * c1 + s), s);
        };
        const Doubles c0b = p.c0 - 2.0 * p.a0 + shape.ab2, c1b = p.c1 - p.a1;
        corner(p.c0, p.c1);
        corner(c0b, c1b);
        corner(p.c0 - 2.0 * p.b0 + shape.ac2, p.c1 - p.b1);
        const auto edge = [&](Doubles e0, Doubles e1, Doubles inverseE2, Doubles c0, Doubles c1) {
            const Doubles alpha = 1.0 - e1 * e1 * inverseE2, beta = c1 - e0 * e1 * inverseE2;
            const Doubles s = -beta / most(alpha, splat(1e-12)), t = (e0 + s * e1) * inverseE2;
            const Longs valid = (alpha > 1e-10) & (s > s0) & (s < s1) & (t > zero) & (t < one);
            offer(valid, most(c0 - e0 * e0 * inverseE2 + beta * s, zero), s);
        };
        edge(p.a0, p.a1, shape.inverseAb2, p.c0, p.c1);
        edge(p.b0, p.b1, shape.inverseAc2, p.c0, p.c1);
        edge(p.b0 - p.a0 - shape.abac + shape.ab2, p.b1 - p.a1, shape.inverseBc2, c0b, c1b);
        Doubles s;
        const Longs crosses = p.crossing(shape, s);
        offer(crosses & (s >= s0) & (s <= s1), zero, s);
        return best;
    }

    /// The products lose digits far from the corner: what is reported is measured once more.
    void take(std::uint32_t triangle, double s, double radius) {
        const Vector p = tip_ + s * axis_;
        std::uint8_t feature = 0;
        const Vector q = closestPoint(tree_.triangles[triangle], p, feature);
        const double value = __builtin_sqrt(dot(p - q, p - q)) - radius;
        if (value < hit_.value) hit_ = {value, s, {q.x, q.y, q.z}, triangle, feature};
    }
    /// Distances less the radius, and where on the axis.
    [[nodiscard]] Doubles leastOfAny(const Packet& packet, Doubles& bestS, Doubles& itsRadius) const {
        const Shape shape(packet);
        const Products p(packet, shape, tip_, axis_);
        const Doubles a0 = p.a0, a1 = p.a1, b0 = p.b0, b1 = p.b1, c0 = p.c0, c1 = p.c1;
        const Doubles zero = splat(0.0), one = splat(1.0);
        Doubles half;
        const auto squared = [&](Doubles s) { return p.distance2(shape, s, half); };
        std::int32_t low[kDoubleLanes] = {}, high[kDoubleLanes];
        for (std::int32_t& piece : high)
            piece = run_.count - 1;
        // The distance to a triangle less the radius is convex along the run: halve until one piece is left.
        for (int left = run_.count - 1; left > 1; left = (left + 1) / 2) {
            const Doubles s = gather([&](int i) { return run_.z[(low[i] + high[i]) / 2]; });
            const Doubles before = gather([&](int i) {
                const int middle = (low[i] + high[i]) / 2;
                return run_.slope[middle > 0 ? middle - 1 : 0];
            });
            const Doubles d = root(squared(s));
            const unsigned rising = bitsOfLongs(half > before * d);
            for (int i = 0; i < kDoubleLanes; ++i) {
                const int middle = (low[i] + high[i]) / 2;
                const bool isOpen = high[i] - low[i] > 1, isRising = (rising >> i & 1u) != 0;
                high[i] = isOpen && isRising ? middle : high[i];
                low[i] = isOpen && !isRising ? middle : low[i];
            }
        }
        const Doubles s0 = gather([&](int i) { return run_.z[low[i]]; }),
                      s1 = gather([&](int i) { return run_.z[high[i]]; }),
                      slope = gather([&](int i) { return run_.slope[low[i]]; });
        // So that the radius is radius0 + slope s.
        const Doubles radius0 = gather([&](int i) { return run_.radius[low[i]]; }) - slope * s0;
        const Doubles lessSlope2 = most(1.0 - slope * slope, splat(1e-12)), tangent = slope / root(lessSlope2);

        Doubles best = root(squared(s0)) - radius0 - slope * s0;
        bestS = s0;
        const auto offer = [&](Longs valid, Doubles value, Doubles s) {
            const Longs better = valid & (value < best);
            best = choose(better, value, best);
            bestS = choose(better, s, bestS);
        };
        const Longs all = zero == zero;
        offer(all, root(squared(s1)) - radius0 - slope * s1, s1);
        const auto corner = [&](Doubles c0v, Doubles c1v) {
            const Doubles rho2 = most(c0v - c1v * c1v, zero);
            const Doubles s = clampTo(root(rho2) * tangent - c1v, s0, s1), dz = s + c1v;
            offer(all, root(rho2 + dz * dz) - radius0 - slope * s, s);
        };
        const Doubles c0b = c0 - 2.0 * a0 + shape.ab2, c1b = c1 - a1, c0c = c0 - 2.0 * b0 + shape.ac2, c1c = c1 - b1;
        corner(c0, c1);
        corner(c0b, c1b);
        corner(c0c, c1c);
        const auto edge = [&](Doubles e0, Doubles e1, Doubles inverseE2, Doubles c0v, Doubles c1v) {
            const Doubles alpha = 1.0 - e1 * e1 * inverseE2, beta = c1v - e0 * e1 * inverseE2;
            const Doubles excess = alpha - slope * slope, safeAlpha = most(alpha, splat(1e-12));
            const Doubles middle = -beta / safeAlpha;
            const Doubles d2 = most(c0v - e0 * e0 * inverseE2 + beta * middle, zero);
            const Doubles shift = slope * root(d2 / most(safeAlpha * excess, splat(1e-24)));
            const Doubles s = middle + shift, t = (e0 + s * e1) * inverseE2;
            const Longs valid = (excess > 1e-10) & (s > s0) & (s < s1) & (t > zero) & (t < one);
            offer(valid, root(d2 + alpha * shift * shift) - radius0 - slope * s, s);
        };
        edge(a0, a1, shape.inverseAb2, c0, c1);
        edge(b0, b1, shape.inverseAc2, c0, c1);
        edge(b0 - a0 - shape.abac + shape.ab2, b1 - a1, shape.inverseBc2, c0b, c1b);
        Doubles crossingS;
        const Longs crosses = p.crossing(shape, crossingS);
        offer(crosses & (crossingS >= s0) & (crossingS <= s1), -radius0 - slope * crossingS, crossingS);
        itsRadius = radius0 + slope * bestS;
        return best;
    }

    const TreeView& tree_;
    const AxisRun& run_;
    Vector tip_, axis_;
    float low_, high_;
    SurfaceHit& hit_;
};

class PointQuery {
  public:
    PointQuery(const TreeView& tree, const double point[3], SurfaceHit& hit)
        : tree_(tree), p_{point[0], point[1], point[2]}, hit_(hit) {}
    [[nodiscard]] float best() const { return static_cast<float>(hit_.value); }

    [[nodiscard]] Floats bounds(const KernelNode& node) const {
        const float x = static_cast<float>(p_.x), y = static_cast<float>(p_.y), z = static_cast<float>(p_.z);
        const Floats dx = mostF(mostF(loadFloats(node.minX) - x, x - loadFloats(node.maxX)), Floats{});
        const Floats dy = mostF(mostF(loadFloats(node.minY) - y, y - loadFloats(node.maxY)), Floats{});
        const Floats dz = mostF(mostF(loadFloats(node.minZ) - z, z - loadFloats(node.maxZ)), Floats{});
        return rootF(dx * dx + dy * dy + dz * dz) - kBoundSlackMm;
    }

    void evaluate(const std::uint32_t* ids, int count) {
        double d2[8] = {};
        for (int first = 0; first < count; first += kDoubleLanes) {
            const Packet packet(tree_.triangles, ids + first, count - first);
            const Shape shape(packet);
            const Doubles w[3] = {p_.x - packet.a[0], p_.y - packet.a[1], p_.z - packet.a[2]}, zero{};
            Doubles half;
            const Doubles found = shape.distance2(dot(packet.ab, w), dot(packet.ac, w), dot(w, w), dot(shape.n, w),
                                                  zero, zero, zero, zero, half);
            __builtin_memcpy(d2 + first, &found, sizeof found);
        }
        int lane = 0;
        for (int i = 1; i < count; ++i)
            if (d2[i] < d2[lane]) lane = i;
        const double limit = hit_.value + 1e-9;
        if (d2[lane] >= limit * limit) return;
        std::uint8_t feature = 0;
        const Vector q = closestPoint(tree_.triangles[ids[lane]], p_, feature);
        const double value = __builtin_sqrt(dot(p_ - q, p_ - q));
        if (value < hit_.value) hit_ = {value, 0.0, {q.x, q.y, q.z}, ids[lane], feature};
    }

  private:
    const TreeView& tree_;
    Vector p_;
    SurfaceHit& hit_;
};

void nearestToRun(const TreeView& tree, const AxisRun& run, const double tip[3], const double axis[3],
                  SurfaceHit& hit) noexcept {
    const std::uint32_t seed = hit.triangle;
    hit.triangle = SurfaceHit::kNone;
    RunQuery query(tree, run, tip, axis, hit);
    search(tree, seed, query);
}

void closestOnTriangle(const KernelTriangle& triangle, const double point[3], double closest[3]) noexcept {
    std::uint8_t feature = 0;
    const Vector q = closestPoint(triangle, {point[0], point[1], point[2]}, feature);
    closest[0] = q.x;
    closest[1] = q.y;
    closest[2] = q.z;
}

void nearestToPoint(const TreeView& tree, const double point[3], SurfaceHit& hit) noexcept {
    const std::uint32_t seed = hit.triangle;
    hit.triangle = SurfaceHit::kNone;
    PointQuery query(tree, point, hit);
    search(tree, seed, query);
}

}  // namespace

ExactKernels exactKernels() noexcept {
    return {nearestToRun, closestOnTriangle, nearestToPoint};
}

}  // namespace handpiece::contact::HANDPIECE_SIMD_NS
