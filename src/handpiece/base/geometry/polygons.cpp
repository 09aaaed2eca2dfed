// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/polygons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

namespace handpiece::geometry::formats {
namespace {

using Point = std::array<double, 2>;

/// Twice the signed area.
double area(const Point& a, const Point& b, const Point& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Turned so that it goes round to the left; empty where it has no area.
std::vector<Point> flattened(const TriangleMesh& mesh, std::span<const std::uint32_t> corners) {
    core::Vec3 normal = core::Vec3::Zero();
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const core::Vec3 &a = mesh.vertices[corners[i]], &b = mesh.vertices[corners[(i + 1) % corners.size()]];
        normal += core::Vec3((a.y() - b.y()) * (a.z() + b.z()), (a.z() - b.z()) * (a.x() + b.x()),
                             (a.x() - b.x()) * (a.y() + b.y()));
    }
    int axis = 0;
    for (int k = 1; k < 3; ++k)
        if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
    if (!(std::abs(normal[axis]) > 0.0)) return {};
    const int first = normal[axis] > 0.0 ? (axis + 1) % 3 : (axis + 2) % 3,
              second = normal[axis] > 0.0 ? (axis + 2) % 3 : (axis + 1) % 3;
    std::vector<Point> points;
    points.reserve(corners.size());
    for (const std::uint32_t corner : corners)
        points.push_back({mesh.vertices[corner][first], mesh.vertices[corner][second]});
    return points;
}

bool isInside(const Point& p, const Point& a, const Point& b, const Point& c) {
    return area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0;
}

/// Steps that may be taken: a polygon's own first, then those that all of a file have in common.
class Steps {
  public:
    explicit Steps(std::uint64_t common) : common_(common) {}
    void begin(std::uint64_t own) { own_ = own, isSpent_ = false; }
    /// False when they do not do, and from then on to the next begin().
    bool take(std::uint64_t steps) {
        const std::uint64_t own = std::min(own_, steps), rest = steps - own;
        own_ -= own;
        isSpent_ = isSpent_ || rest > common_;
        common_ -= isSpent_ ? 0 : rest;
        return !isSpent_;
    }
    [[nodiscard]] bool isSpent() const { return isSpent_; }

  private:
    std::uint64_t common_, own_ = 0;
    bool isSpent_ = false;
};

/// About as many cells as there are points, over their box.
class Cells {
  public:
    explicit Cells(const std::vector<Point>& points)
        : side_(std::max<std::size_t>(1, static_cast<std::size_t>(std::sqrt(static_cast<double>(points.size()))))) {
        Point high = low_ = points.front();
        for (const Point& p : points)
            for (std::size_t k = 0; k < 2; ++k)
                low_[k] = std::min(low_[k], p[k]), high[k] = std::max(high[k], p[k]);
        for (std::size_t k = 0; k < 2; ++k) {
            const double perMm = static_cast<double>(side_) / (high[k] - low_[k]);
            perMm_[k] = std::isfinite(perMm) ? perMm : 0.0;
        }
    }
    [[nodiscard]] std::size_t count() const { return side_ * side_; }
    [[nodiscard]] std::size_t of(const Point& p) const {
        const Point at = placed(p);
        return stepOf(at[1]) * side_ + stepOf(at[0]);
    }
    /// body(cell) for those that a triangle reaches, as long as it says true; a line is a triangle of two corners.
    template <class Body>
    bool along(const std::array<Point, 3>& corners, const Body& body) const {
        constexpr double kRounding = 1e-6;  // of a cell, far beyond what is lost by it
        std::array<Point, 3> at;
        std::transform(corners.begin(), corners.end(), at.begin(), [this](const Point& p) { return placed(p); });
        const auto [low, high] = std::minmax({at[0][1], at[1][1], at[2][1]});
        for (std::size_t row = stepOf(low - kRounding); row <= stepOf(high + kRounding); ++row) {
            const double from = static_cast<double>(row) - kRounding, to = static_cast<double>(row + 1) + kRounding;
            double left = static_cast<double>(side_), right = 0.0;
            for (std::size_t k = 0; k < 3; ++k) {
                const Point &a = at[k], &b = at[(k + 1) % 3];
                if (std::max(a[1], b[1]) < from || std::min(a[1], b[1]) > to) continue;
                const double rise = b[1] - a[1];
                for (const double edge : {from, to}) {
                    const double part = rise != 0.0 ? std::clamp((edge - a[1]) / rise, 0.0, 1.0) : edge == from;
                    const double x = a[0] + part * (b[0] - a[0]);
                    left = std::min(left, x), right = std::max(right, x);
                }
            }
            for (std::size_t column = stepOf(left - kRounding); column <= stepOf(right + kRounding); ++column)
                if (!body(row * side_ + column)) return false;
        }
        return true;
    }

  private:
    [[nodiscard]] Point placed(const Point& p) const {
        return {(p[0] - low_[0]) * perMm_[0], (p[1] - low_[1]) * perMm_[1]};
    }
    [[nodiscard]] std::size_t stepOf(double x) const {
        return static_cast<std::size_t>(std::clamp(x, 0.0, static_cast<double>(side_ - 1)));
    }

    std::size_t side_;
    Point low_, perMm_{};
};

/// Lists of numbers, one a cell, in one piece.
struct Lists {
    std::vector<std::uint32_t> starts, numbers;

    /// each(take) calls take(cell, number) for all, twice the same.
    template <class Each>
    Lists(std::size_t cells, const Each& each) : starts(cells + 1, 0) {
        each([this](std::size_t cell, std::uint32_t) { ++starts[cell + 1]; });
        for (std::size_t c = 0; c < cells; ++c)
            starts[c + 1] += starts[c];
        numbers.resize(starts.back());
        std::vector<std::uint32_t> ends(starts.begin(), starts.end() - 1);
        each([&](std::size_t cell, std::uint32_t number) { numbers[ends[cell]++] = number; });
    }
};

/// Nothing where the steps do not do.
std::optional<bool> crossesItself(const std::vector<Point>& points, const Cells& cells, Steps& steps) {
    const std::size_t count = points.size();
    const auto endOf = [&](std::size_t i) -> const Point& { return points[i + 1 == count ? 0 : i + 1]; };
    const auto edges = [&](const auto& body) {
        for (std::uint32_t i = 0; i < count; ++i)
            if (!cells.along({points[i], endOf(i), endOf(i)}, [&](std::size_t cell) { return body(cell, i); }))
                return false;
        return true;
    };
    // What it takes is known before it is done, or any room taken for it.
    constexpr std::uint64_t kRoom = 16;
    std::vector<std::uint32_t> held(cells.count(), 0);
    if (!edges([&](std::size_t cell, std::uint32_t) { return steps.take(kRoom + held[cell]++); })) return std::nullopt;
    const Lists lists(cells.count(), [&](const auto& take) {
        edges([&](std::size_t cell, std::uint32_t i) { return take(cell, i), true; });
    });
    const auto isBetween = [](double a, double b) { return (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0); };
    for (std::size_t cell = 0; cell < cells.count(); ++cell)
        for (std::uint32_t m = lists.starts[cell]; m < lists.starts[cell + 1]; ++m)
            for (std::uint32_t n = m + 1; n < lists.starts[cell + 1]; ++n) {
                const std::size_t i = lists.numbers[m], j = lists.numbers[n];
                const Point &a = points[i], &b = endOf(i), &c = points[j], &d = endOf(j);
                if (isBetween(area(a, b, c), area(a, b, d)) && isBetween(area(c, d, a), area(c, d, b))) return true;
            }
    return false;
}

/// Cuts off ears one after the other, all round and not as a fan about one corner. What was looked at and is no ear is
/// looked at again only when its neighbours change, or the corner that lay in it goes.
class Ears {
  public:
    Ears(const std::vector<Point>& points, const Cells& cells, Steps& steps)
        : points_(points),
          cells_(cells),
          steps_(steps),
          before_(points.size()),
          after_(points.size()),
          turns_(points.size()),
          isCut_(points.size(), false),
          lists_(cells.count(),
                 [&](const auto& take) {
                     for (std::uint32_t i = 0; i < points.size(); ++i)
                         take(cells.of(points[i]), i);
                 }),
          ends_(lists_.starts.begin() + 1, lists_.starts.end()),
          heldUp_(points.size()) {
        const auto count = static_cast<std::uint32_t>(points.size());
        for (std::uint32_t i = 0; i < count; ++i)
            before_[i] = (i + count - 1) % count, after_[i] = (i + 1) % count;
        for (std::uint32_t i = 0; i < count; ++i)
            look(i);
    }

    /// Corners by their place in the polygon; empty where there are none, as in one that crosses itself, or where the
    /// steps do not do.
    std::vector<std::array<std::uint32_t, 3>> all() {
        std::uint32_t at = 0;
        for (std::size_t left = points_.size(); left > 3; --left) {
            std::optional<std::uint32_t> ear;
            while (!ear && !maybe_.empty() && !steps_.isSpent()) {
                const std::uint32_t next = from(maybe_, at);
                if (isEar(next))
                    ear = next;
                else
                    maybe_.erase(next);
            }
            // What is straight, or of no area, is no ear and must go all the same.
            const bool isFlat = !ear;
            if (isFlat && (flat_.empty() || steps_.isSpent())) return {};
            const std::uint32_t gone = isFlat ? from(flat_, at) : *ear;
            cut(gone);
            at = isFlat ? after_[gone] : after_[after_[gone]];
        }
        cut_.push_back({before_[at], at, after_[at]});
        return std::move(cut_);
    }

  private:
    using Corners = std::set<std::uint32_t>;

    /// The first of them on the way round.
    static std::uint32_t from(const Corners& corners, std::uint32_t at) {
        const auto found = corners.lower_bound(at);
        return found != corners.end() ? *found : *corners.begin();
    }
    void look(std::uint32_t i) {
        const double turn = area(points_[before_[i]], points_[i], points_[after_[i]]);
        turns_[i] = turn;
        if (turn == 0.0)
            flat_.insert(i);
        else
            flat_.erase(i);
        if (turn > 0.0) {
            maybe_.insert(i);
            release(i);
        } else {
            maybe_.erase(i);
        }
    }
    /// What it lay in may be an ear now.
    void release(std::uint32_t i) {
        for (const std::uint32_t other : std::exchange(heldUp_[i], {}))
            if (!isCut_[other] && turns_[other] > 0.0) maybe_.insert(other);
    }
    bool isEar(std::uint32_t i) {
        const std::uint32_t a = before_[i], c = after_[i];
        const Point &p = points_[a], &q = points_[i], &r = points_[c];
        return cells_.along({p, q, r}, [&](std::size_t cell) {
            if (!steps_.take(1 + ends_[cell] - lists_.starts[cell])) return false;
            for (std::uint32_t n = lists_.starts[cell]; n < ends_[cell]; ++n) {
                const std::uint32_t other = lists_.numbers[n];
                if (turns_[other] > 0.0 || other == a || other == i || other == c) continue;
                const Point& o = points_[other];
                if (o == p || o == q || o == r || !isInside(o, p, q, r)) continue;
                heldUp_[other].push_back(i);
                return false;
            }
            return true;
        });
    }
    void cut(std::uint32_t i) {
        cut_.push_back({before_[i], i, after_[i]});
        after_[before_[i]] = after_[i], before_[after_[i]] = before_[i];
        isCut_[i] = true;
        maybe_.erase(i);
        flat_.erase(i);
        const std::size_t cell = cells_.of(points_[i]);
        const auto first = lists_.numbers.begin() + lists_.starts[cell], last = lists_.numbers.begin() + --ends_[cell];
        *std::find(first, last, i) = *last;
        release(i);
        look(before_[i]);
        look(after_[i]);
    }

    const std::vector<Point>& points_;
    const Cells& cells_;
    Steps& steps_;
    std::vector<std::uint32_t> before_, after_;
    std::vector<double> turns_;
    std::vector<bool> isCut_;
    Lists lists_;                                     ///< of the corners that are left
    std::vector<std::uint32_t> ends_;                 ///< of each cell's list
    std::vector<std::vector<std::uint32_t>> heldUp_;  ///< by corner: those that are no ear because it lies in them
    Corners maybe_, flat_;                            ///< may be ears; are straight
    std::vector<std::array<std::uint32_t, 3>> cut_;
};

}  // namespace

void Polygons::add(std::vector<Triangle>& triangles, std::span<const std::uint32_t> corners) {
    if (corners.size() > 3) {
        polygons_.push_back({triangles.size(), corners_.size(), corners.size()});
        corners_.insert(corners_.end(), corners.begin(), corners.end());
    }
    for (std::size_t i = 2; i < corners.size(); ++i)
        triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

Polygons::Left Polygons::settle(TriangleMesh& mesh) const {
    // A second or two; and of a corner many times what an outline of short edges takes.
    constexpr std::uint64_t kSteps = 400'000'000, kStepsPerCorner = 400;
    Steps steps(kSteps);
    Left left;
    for (const Polygon& one : polygons_) {
        const std::span<const std::uint32_t> corners(corners_.data() + one.corner, one.count);
        const std::vector<Point> points = flattened(mesh, corners);
        if (points.empty()) continue;
        // A fan whose triangles all go round as the polygon does covers it, and nothing else. What is straight but for
        // the last digits is no dent.
        constexpr double kStraight = 1e-9;
        double least = 0.0, whole = 0.0;
        for (std::size_t i = 2; i < one.count; ++i) {
            const double piece = area(points[0], points[i - 1], points[i]);
            least = std::min(least, piece), whole += piece;
        }
        if (least >= -kStraight * whole) continue;
        steps.begin(kStepsPerCorner * one.count);
        const Cells cells(points);
        const std::optional<bool> isCrossing = crossesItself(points, cells, steps);
        const auto cut =
            isCrossing == false ? Ears(points, cells, steps).all() : std::vector<std::array<std::uint32_t, 3>>();
        if (cut.empty()) {
            ++(steps.isSpent() ? left.tangled : left.crossing);
            continue;
        }
        for (std::size_t i = 0; i < cut.size(); ++i)
            mesh.triangles[one.triangle + i] = {corners[cut[i][0]], corners[cut[i][1]], corners[cut[i][2]]};
    }
    return left;
}

}  // namespace handpiece::geometry::formats
