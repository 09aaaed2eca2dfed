// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/landmarks/find_landmarks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "handpiece/model/case/fdi.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "handpiece/scan/landmarks/finder.h"
#include "handpiece/scan/landmarks/relief.h"

namespace handpiece::landmarks {
namespace {
using cases::Landmark;
using cases::LandmarkKind;
using core::Vec2;
using core::Vec3;

constexpr double kBlurMm = 0.15;
/// A cusp worn lower than this above its saddles cannot be told from noise.
constexpr double kTipProminenceMm = 0.1, kTipReachMm = 1.8;
constexpr double kHornProminenceMm = 0.1, kHornReachMm = 1.2, kHornWideMm = 0.3;
/// All pairings are tried: of a rough surface's peaks only the highest.
constexpr std::size_t kMostPeaks = 16;
constexpr double kContactReachMm = 1.8;  ///< up and down
constexpr double kAverageAgeYears = 25.0;

/// Of the crown's upper three quarters, from the neck at z = 0 to the highest point.
core::Box crownOf(const geometry::TriangleMesh& mesh) {
    double top = 0.0;
    for (const Vec3& v : mesh.vertices)
        top = std::max(top, v.z());
    core::Box box;
    for (const Vec3& v : mesh.vertices)
        if (v.z() >= 0.25 * top) box.extend(v);
    return box;
}

/// The highest vertex about a place: horns are thinner than what the relief is blurred over.
Vec3 topNear(const geometry::TriangleMesh& mesh, const Vec3& place) {
    Vec3 top = place;
    top.z() = -std::numeric_limits<double>::infinity();
    for (const Vec3& v : mesh.vertices)
        if ((v - place).head<2>().norm() < kHornWideMm && v.z() > top.z()) top = v;
    return top;
}

class Finder {
  public:
    Finder(const cases::Tooth& tooth, const std::vector<geometry::TriangleMesh>& adjacent)
        : tooth_(tooth),
          outer_(tooth.surface()),
          adjacent_(adjacent.begin(), adjacent.end()),
          tree_(outer_),
          crown_(crownOf(outer_)) {
        if (!cases::isPermanentTooth(tooth.fdiNumber)) return;
        expected_ = dentition::ToothForm(tooth.fdiNumber, {0, kAverageAgeYears}).landmarks();
        // The average tooth has its extents at its height of contour, and its top on its axis.
        core::Box box;
        double top = 0.0;
        for (const Landmark& mark : expected_) {
            if (mark.kind == LandmarkKind::heightOfContour)
                for (const Vec3& p : mark.pointsMm)
                    box.extend(p);
            if (mark.kind == LandmarkKind::longAxis) top = mark.pointsMm.back().z();
        }
        const Vec2 size = crown_.size().head<2>().cwiseQuotient(box.size().head<2>());
        const Vec3 scale(size.x(), size.y(), crown_.max.z() / top);
        for (Landmark& mark : expected_)
            for (Vec3& p : mark.pointsMm) {
                p = p.cwiseProduct(scale);
                p.head<2>() += crown_.centre().head<2>() - box.centre().head<2>().cwiseProduct(size);
            }
    }

    std::vector<Landmark> all(const core::Progress& progress) {
        const double top = crown_.max.z();
        peaks(LandmarkKind::cuspTip, outer_, kTipProminenceMm, kTipReachMm);
        core::report(progress, 0.2);
        for (const cases::Part& part : tooth_.parts)
            if (part.tissue == cases::Tissue::pulp)
                peaks(LandmarkKind::pulpHorn, part.mesh, kHornProminenceMm, kHornReachMm);
        core::report(progress, 0.3);
        const Around around(tree_, crown_.centre().head<2>());
        add(LandmarkKind::heightOfContour, "", heightOfContour(around, 0.1 * top, 0.9 * top));
        core::report(progress, 0.5);
        for (const cases::Part& part : tooth_.parts)
            if (part.tissue == cases::Tissue::dentine)
                add(LandmarkKind::cementoEnamelJunction, "",
                    cementoEnamelJunction(around, geometry::TriangleTree(part.mesh), 0.6 * top));
        core::report(progress, 0.8);
        for (const Landmark& mark : expected_)
            if (mark.kind == LandmarkKind::contact)
                if (const auto p = contactOn(outer_, Vec3(mark.name == "distal" ? -1.0 : 1.0, 0.0, 0.0),
                                             mark.pointsMm.front().z() - kContactReachMm,
                                             mark.pointsMm.front().z() + kContactReachMm, adjacent_))
                    add(LandmarkKind::contact, mark.name, {tree_.nearest(*p).pointMm});
        core::report(progress, 1.0);
        return std::move(found_);
    }

  private:
    void add(LandmarkKind kind, const std::string& name, std::vector<Vec3> points) {
        if (points.size() >= cases::shapeOf(kind).least)
            found_.push_back({kind, name, std::move(points), cases::LandmarkSource::found});
    }

    /// Of a surface seen from above, those near to where the average tooth has them.
    void peaks(LandmarkKind kind, const geometry::TriangleMesh& mesh, double prominenceMm, double reachMm) {
        std::vector<const Landmark*> marks;
        std::vector<Vec2> expected, places;
        for (const Landmark& mark : expected_)
            if (mark.kind == kind) {
                marks.push_back(&mark);
                expected.emplace_back(mark.pointsMm.front().head<2>());
            }
        if (marks.empty()) return;
        std::vector<Vec3> peaks = Relief(mesh, kBlurMm).peaks(prominenceMm);
        peaks.resize(std::min(peaks.size(), kMostPeaks));
        for (const Vec3& peak : peaks)
            places.emplace_back(peak.head<2>());
        const std::vector<int> which = paired(expected, places, reachMm);
        for (std::size_t e = 0; e < marks.size(); ++e)
            if (which[e] >= 0) {
                const Vec3& place = peaks[static_cast<std::size_t>(which[e])];
                add(kind, marks[e]->name,
                    {kind == LandmarkKind::pulpHorn ? topNear(mesh, place) : tree_.nearest(place).pointMm});
            }
    }

    const cases::Tooth& tooth_;
    const geometry::TriangleMesh& outer_;
    std::vector<geometry::TriangleTree> adjacent_;
    geometry::TriangleTree tree_;
    core::Box crown_;
    std::vector<Landmark> expected_, found_;
};

}  // namespace

std::vector<int> paired(const std::vector<Vec2>& expected, const std::vector<Vec2>& found, double reachMm) {
    // Every pairing is tried: a tooth has a handful of them. One that is left out costs more than any that is far.
    std::vector<int> best(expected.size(), -1), now = best;
    double least = std::numeric_limits<double>::infinity();
    std::vector<bool> isTaken(found.size(), false);
    const auto go = [&](const auto& self, std::size_t e, double cost) -> void {
        if (cost >= least) return;
        if (e == expected.size()) {
            least = cost;
            best = now;
            return;
        }
        for (std::size_t f = 0; f < found.size(); ++f) {
            const double square = (found[f] - expected[e]).squaredNorm();
            if (isTaken[f] || square > reachMm * reachMm) continue;
            isTaken[f] = true;
            now[e] = static_cast<int>(f);
            self(self, e + 1, cost + square);
            isTaken[f] = false;
        }
        now[e] = -1;
        self(self, e + 1, cost + 2.0 * reachMm * reachMm);
    };
    go(go, 0, 0.0);
    return best;
}

std::vector<Landmark> findLandmarks(const cases::Tooth& tooth, const std::vector<geometry::TriangleMesh>& adjacent,
                                    const core::Progress& progress) {
    if (tooth.surface().triangles.empty()) return {};
    return Finder(tooth, adjacent).all(progress);
}

std::vector<Landmark> findLandmarks(const cases::Case& toothCase, const core::Progress& progress) {
    std::vector<geometry::TriangleMesh> adjacent;
    for (const cases::PlacedTooth& other : toothCase.others) {
        if (cases::areAdjacentTeeth(toothCase.fdiNumber, other.fdiNumber))
            adjacent.push_back(geometry::transformed(other.surface(), other.inCase));
    }
    return findLandmarks(toothCase, adjacent, progress);
}

std::vector<Landmark> withFound(const std::vector<Landmark>& own, const std::vector<Landmark>& found) {
    std::vector<Landmark> all;
    std::copy_if(own.begin(), own.end(), std::back_inserter(all),
                 [](const Landmark& mark) { return mark.source != cases::LandmarkSource::found; });
    const auto kept = static_cast<std::ptrdiff_t>(all.size());
    for (const Landmark& mark : found)
        if (std::none_of(all.begin(), all.begin() + kept,
                         [&](const Landmark& k) { return k.kind == mark.kind && k.name == mark.name; }))
            all.push_back(mark);
    return all;
}

}  // namespace handpiece::landmarks
