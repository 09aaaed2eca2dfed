// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/landmarks/find_landmarks.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "handpiece/base/core/portable_math.h"
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
constexpr double kPitProminenceMm = 0.03, kPitReachMm = 0.9;
constexpr double kApexProminenceMm = 0.5, kApexReachMm = 3.0;
constexpr double kDeepMm = 100.0;  ///< no tooth is as high
/// Within so much of a cusp a place moves with it; farther from all than that it stays.
constexpr double kCuspMm = 0.5, kOwnPlaceMm = 4.0;
constexpr double kContactReachMm = 1.8;  ///< up and down

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

/// About z.
geometry::TriangleMesh turned(geometry::TriangleMesh mesh, double rad) {
    const double c = core::cos(rad), s = core::sin(rad);
    for (Vec3& v : mesh.vertices)
        v = Vec3(c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z());
    return mesh;
}

class Finder {
  public:
    Finder(const cases::Tooth& tooth, const std::vector<geometry::TriangleMesh>& adjacent)
        : tooth_(tooth),
          outer_(tooth.surface()),
          adjacent_(adjacent.begin(), adjacent.end()),
          tree_(outer_),
          crown_(crownOf(outer_)) {
        expected_ = expectedLandmarks(tooth.fdiNumber);
        if (expected_.empty()) return;
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
        core::report(progress, 0.1);
        lines();
        pits();
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
        apicesAndAxes();
        core::report(progress, 1.0);
        return std::move(found_);
    }

  private:
    void add(LandmarkKind kind, const std::string& name, std::vector<Vec3> points) {
        if (points.size() >= cases::shapeOf(kind).least)
            found_.push_back({kind, name, std::move(points), cases::LandmarkSource::found});
    }

    /// Grooves and ridges, where the cusps found say that the average ones are to be looked for.
    void lines() {
        const Relief relief(outer_, kBlurMm);
        for (const Landmark& mark : expected_) {
            const bool isGroove = mark.kind == LandmarkKind::fissure;
            if (!isGroove && mark.kind != LandmarkKind::marginalRidge && mark.kind != LandmarkKind::ridge) continue;
            // Of several that share a name, as the pieces of an incisal edge do, one is not told from the other.
            if (std::count_if(expected_.begin(), expected_.end(), [&](const Landmark& other) {
                    return other.kind == mark.kind && other.name == mark.name;
                }) > 1)
                continue;
            std::vector<Vec2> about;
            for (const Vec3& p : mark.pointsMm)
                about.push_back(withCusps(p.head<2>()));
            std::vector<Vec3> points;
            for (const Vec2& p : lineAlong(relief, about, isGroove ? LineOf::valley : LineOf::crest))
                if (const auto on = under(p)) points.push_back(*on);
            add(mark.kind, mark.name, std::move(points));
        }
    }

    /// Deepest places seen from above; those of the sides are not.
    void pits() {
        const Relief relief(outer_, kBlurMm);
        std::vector<const Landmark*> marks;
        std::vector<Vec2> expected, places;
        for (const Landmark& mark : expected_)
            if (mark.kind == LandmarkKind::pit && mark.name != "buccal" && mark.name != "lingual") {
                marks.push_back(&mark);
                expected.push_back(withCusps(mark.pointsMm.front().head<2>()));
            }
        if (marks.empty()) return;
        for (const Vec3& low : relief.hollows(kPitProminenceMm))
            if (low.z() > 0.25 * crown_.max.z()) places.emplace_back(low.head<2>());
        // The nearest to where they are expected: of fine grooves there are many.
        std::sort(places.begin(), places.end(), [&](const Vec2& a, const Vec2& b) {
            const auto away = [&](const Vec2& p) {
                double least = std::numeric_limits<double>::infinity();
                for (const Vec2& e : expected)
                    least = std::min(least, (e - p).norm());
                return least;
            };
            return away(a) < away(b);
        });
        places.resize(std::min(places.size(), kMostPeaks));
        const std::vector<int> which = paired(expected, places, kPitReachMm);
        for (std::size_t e = 0; e < marks.size(); ++e)
            if (which[e] >= 0)
                if (const auto on = under(places[static_cast<std::size_t>(which[e])]))
                    add(LandmarkKind::pit, marks[e]->name, {*on});
    }

    /// Tips of the roots, and with all of them the axes. Long axis: from the middle of the apices to that of the crown
    /// at its top, as the generator has it; the path of insertion goes along it.
    void apicesAndAxes() {
        geometry::TriangleMesh below = outer_;
        for (Vec3& v : below.vertices)
            v.z() = -v.z();
        for (geometry::Triangle& t : below.triangles)
            std::swap(t[1], t[2]);  // faces stay faces
        const std::size_t before = found_.size();
        peaks(LandmarkKind::apex, below, kApexProminenceMm, kApexReachMm);
        Vec3 middle = Vec3::Zero();
        double count = 0.0;
        for (std::size_t i = before; i < found_.size(); ++i) {
            middle += found_[i].pointsMm.front();
            ++count;
        }
        const auto isApex = [](const Landmark& mark) { return mark.kind == LandmarkKind::apex; };
        if (count < 1.0 || count < static_cast<double>(std::count_if(expected_.begin(), expected_.end(), isApex)))
            return;
        middle /= count;
        const Vec3 top(crown_.centre().x(), crown_.centre().y(), crown_.max.z());
        const Vec3 way = (top - middle).normalized();
        if (!(way.z() > 0.5)) return;
        add(LandmarkKind::longAxis, "", {middle, top});
        add(LandmarkKind::pathOfInsertion, "", {top - way * (top.z() / way.z()), top});
    }

    /// The surface under a place of the occlusal view.
    std::optional<Vec3> under(const Vec2& p) const {
        const Vec3 from(p.x(), p.y(), crown_.max.z() + 1.0);
        const geometry::RayMeeting met = tree_.firstMeeting(from, -Vec3::UnitZ(), kDeepMm);
        if (met.triangle == geometry::kNoTriangle) return std::nullopt;
        return Vec3(from - met.distanceMm * Vec3::UnitZ());
    }

    /// Where a place of the average tooth lies on this one, by the cusps around it.
    Vec2 withCusps(const Vec2& p) const {
        Vec2 sum = Vec2::Zero();
        double weights = 1.0 / (kOwnPlaceMm * kOwnPlaceMm);
        for (const auto& [from, to] : moved_) {
            const double weight = 1.0 / ((p - from).squaredNorm() + kCuspMm * kCuspMm);
            sum += weight * (to - from);
            weights += weight;
        }
        return p + sum / weights;
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
                Vec3 place = peaks[static_cast<std::size_t>(which[e])];
                if (kind == LandmarkKind::cuspTip) moved_.emplace_back(expected[e], place.head<2>());
                if (kind == LandmarkKind::apex) place.z() = -place.z();  // seen from below
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
    std::vector<std::pair<Vec2, Vec2>> moved_;  ///< cusps, from where they are expected to where they are
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

double turnOfCrown(const cases::Tooth& tooth) {
    if (!cases::isPermanentTooth(tooth.fdiNumber) || tooth.surface().triangles.empty()) return 0.0;
    return turnOf(tooth.fdiNumber, tooth.surface()).rad;
}

std::vector<Landmark> findLandmarks(const cases::Tooth& tooth, const std::vector<geometry::TriangleMesh>& adjacent,
                                    const core::Progress& progress) {
    if (tooth.surface().triangles.empty()) return {};
    const double rad = turnOfCrown(tooth);
    core::report(progress, 0.3);
    if (rad == 0.0) return Finder(tooth, adjacent).all(core::part(progress, 0.3, 1.0));
    // Looked for as it should stand, and put back.
    cases::Tooth standing;
    standing.fdiNumber = tooth.fdiNumber;
    standing.outer = turned(tooth.surface(), -rad);
    for (const cases::Part& part : tooth.parts)
        if (part.tissue == cases::Tissue::dentine || part.tissue == cases::Tissue::pulp) {
            standing.parts.push_back(part);
            standing.parts.back().mesh = turned(part.mesh, -rad);
        }
    std::vector<geometry::TriangleMesh> beside;
    for (const geometry::TriangleMesh& mesh : adjacent)
        beside.push_back(turned(mesh, -rad));
    std::vector<Landmark> found = Finder(standing, beside).all(core::part(progress, 0.3, 1.0));
    for (Landmark& mark : found) {
        geometry::TriangleMesh points;
        points.vertices = std::move(mark.pointsMm);
        mark.pointsMm = turned(std::move(points), rad).vertices;
    }
    return found;
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

std::vector<Landmark> expectedLandmarks(int fdiNumber) {
    if (!cases::isPermanentTooth(fdiNumber)) return {};
    return dentition::ToothForm(fdiNumber, {0, kAverageAgeYears}).landmarks();
}

std::vector<Landmark> lackedLandmarks(const std::vector<Landmark>& expected, const std::vector<Landmark>& own) {
    std::vector<Landmark> lacked;
    std::copy_if(expected.begin(), expected.end(), std::back_inserter(lacked), [&](const Landmark& e) {
        return std::none_of(own.begin(), own.end(),
                            [&](const Landmark& o) { return o.kind == e.kind && o.name == e.name; });
    });
    return lacked;
}

}  // namespace handpiece::landmarks
