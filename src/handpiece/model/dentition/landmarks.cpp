// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/landmarks.h"

#include <algorithm>
#include <numbers>

#include "handpiece/base/core/portable_math.h"

namespace handpiece::dentition {
namespace {
using cases::LandmarkKind;
using core::Vec2;
using core::Vec3;

class Finder {
  public:
    explicit Finder(const Anatomy& anatomy) : a_(anatomy), s_(anatomy.spec()) {}

    std::vector<cases::Landmark> all() {
        occlusal();
        around();
        pulpAndRoots();
        return std::move(marks_);
    }

  private:
    void add(LandmarkKind kind, const std::string& name, std::vector<Vec3> points) {
        const cases::LandmarkShape shape = cases::shapeOf(kind);
        if (points.size() >= shape.least)
            marks_.push_back({kind, name, std::move(points), cases::LandmarkSource::generated});
    }
    /// The surface under a place of the occlusal view.
    bool below(const Vec3& at, Vec3& found) const {
        return a_.surfaceAlong(Vec3(at.x(), at.y(), a_.bounds().max.z()), -Vec3::UnitZ(), found);
    }

    void occlusal() {
        for (const Cusp& c : s_.cusps) {
            if (s_.isEdge && c.name == "incisal edge") continue;
            Vec3 tip;
            if (below(c.tip, tip)) add(LandmarkKind::cuspTip, c.name, {a_.climbed(tip)});
        }
        for (const Hollow& h : s_.hollows) {
            if (h.pit.empty()) continue;
            Vec3 found;
            const bool isOnSide = h.pit == "buccal" || h.pit == "lingual";
            const Vec3 out(0.0, h.centre.y() < 0.0 ? -1.0 : 1.0, 0.0);
            if (isOnSide ? a_.surfaceAlong(h.centre + 4.0 * out, -out, found) : below(h.centre, found))
                add(LandmarkKind::pit, h.pit, {found});
        }
        for (const Groove& g : s_.grooves) {
            if (g.name.empty()) continue;
            std::vector<Vec3> floor;
            for (const Vec3& p : rounded(g.points)) {
                Vec3 found;
                if (below(p, found) && found.z() > g.fromZ) floor.push_back(found);
            }
            add(LandmarkKind::fissure, g.name, std::move(floor));
        }
        std::vector<Vec3> marginal[2];
        for (const Crest& c : s_.crests) {
            if (c.name.empty()) continue;
            std::vector<Vec3> line;
            for (int i = 0; i <= 6; ++i) {
                const double t = i / 6.0, u = 1.0 - t;
                Vec3 found;
                if (below(u * u * c.from + 2.0 * u * t * c.by + t * t * c.to, found)) line.push_back(found);
            }
            if (c.isMarginal) {
                std::vector<Vec3>& whole = marginal[c.name == "distal"];
                whole.insert(whole.end(), line.begin() + (whole.empty() ? 0 : 1), line.end());
            } else {
                add(LandmarkKind::ridge, c.name, std::move(line));
            }
        }
        add(LandmarkKind::marginalRidge, "mesial", std::move(marginal[0]));
        add(LandmarkKind::marginalRidge, "distal", std::move(marginal[1]));
    }

    /// The outermost point of the surface at a height, in a direction from the tooth's axis.
    Vec3 side(const Vec3& out, double z) const {
        Vec3 found(0, 0, z);
        (void)a_.surfaceAlong(Vec3(s_.centreX, 0, z) + a_.bounds().size().head<2>().maxCoeff() * out, -out, found);
        return found;
    }

    /// Where a side stands out farthest: the middle of the heights at which it does so by nearly as much, which fine
    /// waves of the surface move less than the one that is the widest.
    double widestHeight(const Vec3& out, double fromZ, double toZ) const {
        constexpr double kStepMm = 0.25, kAlikeMm = 0.05;
        std::vector<double> wide;
        for (double h = fromZ; h < toZ; h += kStepMm)
            wide.push_back(side(out, h).dot(out));
        if (wide.empty()) return fromZ;
        const double least = *std::max_element(wide.begin(), wide.end()) - kAlikeMm;
        double sum = 0.0, weights = 0.0;
        for (std::size_t i = 0; i < wide.size(); ++i)
            if (const double over = wide[i] - least; over > 0.0) {
                sum += over * (fromZ + kStepMm * static_cast<double>(i));
                weights += over;
            }
        return sum / weights;
    }

    void around() {
        constexpr int kPoints = 48;
        constexpr int kEvenedOver = 4;  // directions to either side
        std::vector<Vec3> contour, junction;
        std::vector<double> heights;
        const double top = a_.highest.z();
        for (int i = 0; i < kPoints; ++i) {
            const double rad = 2.0 * std::numbers::pi * i / kPoints;
            const Vec3 out(core::cos(rad), core::sin(rad), 0.0);
            double z = 0.0;
            for (int step = 0; step < 40; ++step) {
                const double above = a_.aboveCervix(side(out, z));
                z -= 0.7 * above;
                if (std::abs(above) < 1e-7) break;
            }
            junction.push_back(side(out, z));
            heights.push_back(widestHeight(out, z + 0.3, 0.85 * top));
        }
        // Round the tooth it is one even line: what the surface's unevenness and grooves add at a place is none of it.
        for (int i = 0; i < kPoints; ++i) {
            const double rad = 2.0 * std::numbers::pi * i / kPoints;
            double sum = 0.0, weights = 0.0;
            for (int k = -kEvenedOver; k <= kEvenedOver; ++k) {
                const double share = static_cast<double>(k) / (kEvenedOver + 1), weight = (1.0 - share * share);
                sum += weight * heights[static_cast<std::size_t>((i + k + kPoints) % kPoints)];
                weights += weight;
            }
            contour.push_back(side(Vec3(core::cos(rad), core::sin(rad), 0.0), sum / weights));
        }
        add(LandmarkKind::heightOfContour, "", std::move(contour));
        add(LandmarkKind::cementoEnamelJunction, "", std::move(junction));
        add(LandmarkKind::contact, "mesial", {a_.mesialContact});
        add(LandmarkKind::contact, "distal", {a_.distalContact});
        Vec3 apices = Vec3::Zero();
        for (const Root& r : s_.roots)
            apices += r.apex / static_cast<double>(s_.roots.size());
        add(LandmarkKind::longAxis, "", {apices, Vec3(s_.centreX, 0, top)});
        add(LandmarkKind::pathOfInsertion, "", {Vec3(s_.centreX, 0, 0), Vec3(s_.centreX, 0, top)});
    }

    void pulpAndRoots() {
        for (const Horn& h : s_.horns) {
            // From above, where the pulp begins on the horn's axis.
            const Vec3 way = (h.tip - h.base).normalized();
            double inside = 0.0, outside = (h.tip - h.base).norm() + 1.0;
            for (double t = inside; t < outside; t += 0.02)
                if (a_.pulp(h.base + t * way) < 0.0) inside = t;
            outside = inside + 0.02;
            for (int i = 0; i < 40; ++i) {
                const double middle = 0.5 * (inside + outside);
                (a_.pulp(h.base + middle * way) < 0.0 ? inside : outside) = middle;
            }
            if (a_.pulp(h.base + inside * way) < 0.0) add(LandmarkKind::pulpHorn, h.name, {h.base + inside * way});
        }
        for (const Canal& c : s_.canals)
            add(LandmarkKind::orifice, c.name, {c.points.front()});
        for (const Root& r : s_.roots)
            add(LandmarkKind::apex, s_.roots.size() > 1 ? r.name : "", {a_.outermost(-Vec3::UnitZ(), r.apex)});
        // Entrances of the furcations, seen from below: between two roots, on the side away from a third.
        const std::size_t count = s_.roots.size();
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = i + 1; j < count; ++j) {
                const double deep = -s_.trunk;
                const Vec2 one = rootCentre(s_.roots[i], deep / s_.roots[i].apex.z()),
                           two = rootCentre(s_.roots[j], deep / s_.roots[j].apex.z());
                const Vec2 middle = 0.5 * (one + two), across = Vec2(-(two - one).y(), (two - one).x()).normalized();
                for (const double sign : {1.0, -1.0}) {
                    if (count == 3) {
                        const Root& third = s_.roots[3 - i - j];
                        if ((rootCentre(third, deep / third.apex.z()) - middle).dot(sign * across) > 0.0) continue;
                    }
                    const double reach = 0.5 * std::abs(across.x() * (s_.roots[i].half.x() + s_.roots[j].half.x())) +
                                         0.5 * std::abs(across.y() * (s_.roots[i].half.y() + s_.roots[j].half.y()));
                    const Vec2 at = middle + sign * 0.7 * reach * across;
                    Vec3 found;
                    if (!a_.surfaceAlong(Vec3(at.x(), at.y(), a_.bounds().min.z()), Vec3::UnitZ(), found)) continue;
                    const Vec2 way = sign * across;
                    add(LandmarkKind::furcation,
                        std::abs(way.y()) > std::abs(way.x()) ? way.y() < 0.0 ? "buccal" : "lingual"
                        : way.x() > 0.0                       ? "mesial"
                                                              : "distal",
                        {found});
                }
            }
    }

    const Anatomy& a_;
    const Spec& s_;
    std::vector<cases::Landmark> marks_;
};

}  // namespace

std::vector<cases::Landmark> landmarksOf(const Anatomy& anatomy) {
    return Finder(anatomy).all();
}

}  // namespace handpiece::dentition
