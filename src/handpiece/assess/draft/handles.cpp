// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/draft/handles.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "handpiece/base/core/portable_math.h"

namespace handpiece::draft {
namespace {

using core::Vec2;
using core::Vec3;
using preparation::Laid;
using preparation::Recipe;
using zones::Cavity;
using zones::Outline;

constexpr double kRadPerDeg = std::numbers::pi / 180.0, kStepMm = 0.05, kStepDeg = 0.5;

class Finder {
  public:
    Finder(const cases::Tooth& tooth, const Recipe& recipe, const Laid& laid)
        : tooth_(tooth), recipe_(recipe), laid_(laid) {}

    std::vector<Handle> all() {
        const std::string& id = recipe_.preparation;
        if (id.starts_with("block-"))
            block();
        else if (id == "class-one")
            occlusal(0.0);
        else if (id == "class-two")
            occlusal(sideSign()), proximalBox();
        else if (id == "onlay")
            onlay();
        else if (id == "class-three")
            classThree();
        else if (id == "class-five")
            classFive();
        else if (id == "crown")
            crown();
        else if (id == "access")
            access();
        else if (id == "lesion")
            lesion();
        return std::move(handles_);
    }

  private:
    [[nodiscard]] double number(std::string_view name) const { return recipe_.number(name); }
    [[nodiscard]] double sideSign() const { return recipe_.side == "mesial" ? 1.0 : -1.0; }
    void add(std::string_view name, const Vec3& place, const Vec3& way, double perMm = 1.0, double armMm = 0.0) {
        handles_.push_back({name, place, way.normalized(), perMm, armMm});
    }
    /// Of the cavity's frame.
    void add(const Cavity& cavity, std::string_view name, const Vec3& place, const Vec3& way, double perMm = 1.0,
             double armMm = 0.0) {
        add(name, cavity.inTooth.apply(place), cavity.inTooth.orientation * way, perMm, armMm);
    }
    static Vec3 at(const Vec2& p, double z) { return {p.x(), p.y(), z}; }
    /// The last surface before `from + way * far`, seen from there.
    [[nodiscard]] std::optional<Vec3> outermost(const Vec3& from, const Vec3& way) const {
        constexpr double kOffMm = 40.0;
        const Vec3 eye = from + kOffMm * way;
        const geometry::RayMeeting in = laid_.whole->firstMeeting(eye, -way);
        if (in.triangle == geometry::kNoTriangle) return std::nullopt;
        return eye - in.distanceMm * way;
    }
    [[nodiscard]] Vec3 normalAt(const Vec3& onSurface) const {
        const geometry::NearestPoint near = laid_.whole->nearest(onSurface);
        return laid_.whole->pseudonormal(near.triangle).normalized();
    }
    [[nodiscard]] const cases::Landmark* mark(cases::LandmarkKind kind) const {
        for (const cases::Landmark& one : tooth_.landmarks)
            if (one.kind == kind) return &one;
        return nullptr;
    }

    /// A groove's floor and one of its walls, where no other groove runs into it, as near to `anchor` as may be.
    void groove(const Cavity& cavity, const Vec2& anchor, double wallArmMm) {
        Vec2 foot = Vec2::Zero(), out = Vec2::UnitY();
        double half = 0.0, least = 1e9;
        for (const Outline::Stroke& stroke : cavity.outline.strokes)
            for (std::size_t i = 0; i < std::max<std::size_t>(1, stroke.points.size() - 1); ++i) {
                const Vec2 a = stroke.points[i], b = stroke.points[std::min(i + 1, stroke.points.size() - 1)];
                const Vec2 along = (b - a).norm() > 1e-9 ? Vec2((b - a).normalized()) : Vec2(Vec2::UnitX());
                const int pieces = std::max(1, static_cast<int>((b - a).norm() / 0.1));
                for (int k = 0; k <= pieces; ++k)
                    for (const double sign : {1.0, -1.0}) {
                        const Vec2 p = a + (b - a) * (k / static_cast<double>(pieces));
                        const Vec2 side(-sign * along.y(), sign * along.x());
                        // A groove that runs into it hides its wall.
                        if (cavity.outline.distanceMm(p + stroke.halfWidthMm * side) < -1e-6) continue;
                        const double far = (p - anchor).norm() + (side.y() < 0.0 ? 0.02 : 0.0);
                        if (far < least) least = far, foot = p, out = side, half = stroke.halfWidthMm;
                    }
            }
        if (half <= 0.0) return;
        const double floor = cavity.floor.heightMm;
        add(cavity, "depth_mm", at(foot, floor), -Vec3::UnitZ());
        add(cavity, "width_mm", at(foot + half * out, floor), at(out, 0.0), 2.0);
        if (wallArmMm > 0.0)
            add(cavity, "wall_deg", at(foot + (half + wallArmMm * core::tan(cavity.wallRad)) * out, floor + wallArmMm),
                at(out, 0.0), 1.0, wallArmMm);
    }

    /// `open`: towards its box; 0: it has none.
    void occlusal(double open) {
        const Cavity& cavity = laid_.cavities.front();
        // What does not move with the numbers.
        groove(cavity, laid_.fissureMiddleMm.head<2>(), number("depth_mm"));
        const double way = open == 0.0 ? 1.0 : -open;
        const Vec2* end = nullptr;
        double half = 0.0;
        for (const Outline::Stroke& stroke : cavity.outline.strokes)
            for (const Vec2& p : stroke.points)
                if (end == nullptr || way * p.x() > way * end->x()) end = &p, half = stroke.halfWidthMm;
        if (end != nullptr)
            add(cavity, "ridge_mm", at(*end + Vec2(way * half, 0.0), cavity.floor.heightMm), way * Vec3::UnitX(), -1.0);
    }
    void proximalBox() {
        const Cavity& box = laid_.cavities.back();
        const auto [low, high] = box.outline.bounds();
        const double sign = sideSign(), axial = sign > 0.0 ? low.x() : high.x();
        const double floor = box.floor.heightMm, middle = 0.5 * (low.y() + high.y());
        const double contact = axial + sign * number("axial_mm"), between = 0.5 * (axial + contact);
        add(box, "axial_mm", {axial, middle, floor}, -sign * Vec3::UnitX());
        add(box, "box_width_mm", {between, high.y(), floor}, Vec3::UnitY(), 2.0);
        add(box, "under_contact_mm", {between, middle, floor}, -Vec3::UnitZ());
    }

    void onlay() {
        occlusal(number("axial_mm") > 0.0 ? sideSign() : 0.0);
        if (number("axial_mm") > 0.0)
            proximalBox();
        else
            drawnOutOfContact("axial_mm", sideSign());
        drawnOutOfContact("other_axial_mm", -sideSign());
        caps();
    }
    /// A box, or from where one would be drawn in.
    void drawnOutOfContact(std::string_view name, double sign) {
        for (const cases::Landmark& one : tooth_.landmarks)
            if (one.kind == cases::LandmarkKind::contact && one.name == (sign > 0.0 ? "mesial" : "distal"))
                add(name,
                    one.pointsMm.front() -
                        Vec3(sign * number(name), 0.0, number(name) > 0.0 ? number("under_contact_mm") : 0.0),
                    -sign * Vec3::UnitX());
    }
    /// Straight down from the uncut surface to where the target ends; nothing of it there: the surface.
    [[nodiscard]] Vec3 endUnder(const Vec3& over) const {
        constexpr double kDownStepMm = 0.05, kMostMm = 6.0;
        const double wayMm = laid_.whole->firstMeeting(over, -Vec3::UnitZ()).distanceMm;
        if (!std::isfinite(wayMm)) return over;  // beside the tooth
        const Vec3 top = over - wayMm * Vec3::UnitZ();
        const auto targetAt = [&](double downMm) { return laid_.zones->targetMm(top - downMm * Vec3::UnitZ()); };
        double in = kDownStepMm;
        if (targetAt(in) > 0.0) return top;
        while (in < kMostMm && targetAt(in + kDownStepMm) <= 0.0)
            in += kDownStepMm;
        double out = in + kDownStepMm;
        for (int i = 0; i < 20; ++i) {
            const double middle = 0.5 * (in + out);
            (targetAt(middle) > 0.0 ? out : in) = middle;
        }
        return top - in * Vec3::UnitZ();
    }
    /// What a millimetre down adds to the depth, square to the surface.
    [[nodiscard]] double depthPerMm(const Vec3& place) const {
        geometry::NearestPoint near;
        const double deep = -laid_.whole->signedDistance(place, &near);
        return deep > 0.1 ? (near.pointMm.z() - place.z()) / deep
                          : laid_.whole->pseudonormal(near.triangle).normalized().z();
    }
    [[nodiscard]] bool isAsDeep(const Vec3& place, double deepMm) const {
        constexpr double kAlikeMm = 0.01;
        return std::abs(laid_.whole->signedDistance(place) + deepMm) < kAlikeMm;
    }
    /// On the cusps, and at the margin of one that is capped.
    void caps() {
        const double buccal = tooth_.buccalSign < 0 ? -1.0 : 1.0;
        std::vector<Vec3> tips;
        Vec3 middle = Vec3::Zero();
        for (const cases::Landmark& one : tooth_.landmarks)
            if (one.kind == cases::LandmarkKind::cuspTip)
                tips.push_back(one.pointsMm.front()), middle += one.pointsMm.front();
        if (tips.empty()) return;
        middle /= static_cast<double>(tips.size());
        const double fissureX = laid_.fissureMiddleMm.x();
        bool hasShoulder = false;
        for (std::size_t i = 0; i < preparation::kCapNumbers.size(); ++i) {
            // A premolar's cusp takes both handles, beside each other.
            const Vec3 out(i % 2 == 0 ? 1.0 : -1.0, i < 2 ? buccal : -buccal, 0.0);
            const auto score = [&](const Vec3& tip) {
                return out.y() * (tip - middle).y() + 0.5 * out.x() * (tip - middle).x();
            };
            const Vec3 tip = *std::max_element(tips.begin(), tips.end(),
                                               [&](const Vec3& a, const Vec3& b) { return score(a) < score(b); });
            const double cap = number(preparation::kCapNumbers[i]);
            // A number counts square to the surface, a handle goes straight down.
            constexpr double kInMm = 0.4;  // into the quarter of the crown that goes with the number
            const double x = fissureX + out.x() * std::max(kInMm, out.x() * (tip.x() - fissureX) + 0.3);
            Vec3 place = endUnder(Vec3(x, tip.y(), tip.z() + 10.0));
            // Where a box or the isthmus runs under the tip: beside it, where the target ends as deep as the number.
            constexpr double kAsideStepMm = 0.2, kMostMm = 2.0;
            for (double off = kAsideStepMm; cap > 0.0 && !isAsDeep(place, cap) && off < kMostMm; off += kAsideStepMm)
                for (const Vec2& to :
                     {Vec2(out.x(), 0.0), Vec2(0.0, out.y()), Vec2(out.x(), out.y()), Vec2(0.0, -out.y())}) {
                    const Vec3 other = endUnder(Vec3(x + off * to.x(), tip.y() + off * to.y(), tip.z() + 10.0));
                    if (!isAsDeep(other, cap)) continue;
                    place = other;
                    break;
                }
            add(preparation::kCapNumbers[i], place, -Vec3::UnitZ(), std::max(0.2, depthPerMm(place)));
            if (hasShoulder || (cap <= 0.0 && i + 1 < preparation::kCapNumbers.size())) continue;
            hasShoulder = true;
            double low = 1e9;
            for (const Vec3& t : tips)
                if (out.y() * (t - middle).y() > 0.0) low = std::min(low, t.z());
            const Vec3 way(0.0, out.y(), 0.0);
            if (const auto side = outermost(Vec3(tip.x(), middle.y(), low - cap - number("shoulder_mm")), way))
                add("shoulder_mm", *side, -Vec3::UnitZ());
        }
    }

    /// An outline's corner of a radius, at its inner or upper side.
    void corner(const Cavity& cavity, const Vec2& of, const Vec2& outwards, double z) {
        const double short_ = 1.0 - std::numbers::sqrt2 / 2.0;
        add(cavity, "corner_mm", at(of - short_ * number("corner_mm") * outwards, z), at(-outwards, 0.0),
            1.0 / (std::numbers::sqrt2 - 1.0));
    }
    void classThree() {
        const Cavity& cavity = laid_.cavities.front();
        const auto [low, high] = cavity.outline.bounds();
        const double inner = std::abs(low.x()) < std::abs(high.x()) ? low.x() : high.x(),
                     out = inner > 0.0 ? 1.0 : -1.0;
        const double floor = cavity.floor.heightMm;
        add(cavity, "depth_mm", {0.5 * inner, 0.0, floor}, -Vec3::UnitZ());
        // Its middle lies three tenths of its height under the contact.
        add(cavity, "height_mm", {0.5 * inner, low.y(), floor}, -Vec3::UnitY(), 1.0 / 0.8);
        add(cavity, "axial_mm", {inner, 0.0, floor + 0.5}, out * Vec3::UnitX());  // the floor follows it
        corner(cavity, Vec2(inner, high.y()), Vec2(out, 1.0), floor);
        const Vec3 draw = cavity.inTooth.orientation * Vec3::UnitZ();
        if (const auto labial = outermost(cavity.inTooth.apply({0.5 * inner, 0.0, floor}), -draw))
            add("labial_mm", *labial + number("labial_mm") * draw, draw);
    }
    void classFive() {
        const Cavity& cavity = laid_.cavities.front();
        const Vec2 high = cavity.outline.bounds().second;
        const Vec3 draw = cavity.inTooth.orientation * Vec3::UnitZ();
        // Its walls stand at the surface.
        const auto wall = [&](const Vec2& p) {
            const auto hit = outermost(cavity.inTooth.apply(at(p, 0.0)), draw);
            return hit ? cavity.inTooth.applyInverse(*hit).z() : 0.0;
        };
        const auto edge = [&](std::string_view name, const Vec2& p, const Vec3& way, double perMm) {
            add(cavity, name, at(p, wall(p)), way, perMm);
        };
        edge("width_mm", {high.x(), 0.0}, Vec3::UnitX(), 2.0);
        edge("height_mm", {0.0, high.y()}, Vec3::UnitY(), 1.0);  // the gingival wall stays
        edge("over_cervix_mm", {0.0, -0.5 * number("height_mm")}, Vec3::UnitY(), 1.0);
        corner(cavity, high, Vec2(1.0, 1.0), wall(high));
        if (const auto hit = outermost(cavity.inTooth.apply(Vec3::Zero()), draw)) {
            const Vec3 normal = normalAt(*hit);
            add("axial_mm", *hit - number("axial_mm") * normal, -normal);
        }
    }

    void crown() {
        const cases::Landmark* junction = mark(cases::LandmarkKind::cementoEnamelJunction);
        if (junction == nullptr) return;
        const Vec3 middle = laid_.whole->bounds().centre();
        const double margin = number("margin_mm"), over = number("over_cervix_mm");
        const double taper = 0.5 * number("convergence_deg") * kRadPerDeg;
        const double buccal = tooth_.buccalSign < 0 ? -1.0 : 1.0;
        const auto most = [&](const Vec3& way) {
            return *std::max_element(junction->pointsMm.begin(), junction->pointsMm.end(),
                                     [&](const Vec3& a, const Vec3& b) { return way.dot(a) < way.dot(b); });
        };
        struct Side {
            Vec3 out, onSurface;
        };
        const auto sideAt = [&](const Vec3& p) -> std::optional<Side> {
            const Vec3 from(middle.x(), middle.y(), p.z() + over);
            Vec3 out = p - middle;
            out.z() = 0.0;
            out.normalize();
            const geometry::RayMeeting hit = laid_.whole->firstMeeting(from, out);
            if (hit.triangle == geometry::kNoTriangle) return std::nullopt;
            return Side{out, from + hit.distanceMm * out};
        };
        if (const auto top = outermost(middle, Vec3::UnitZ()))
            add("occlusal_mm", *top - number("occlusal_mm") * Vec3::UnitZ(), -Vec3::UnitZ());
        if (const auto side = sideAt(most(buccal * Vec3::UnitY()))) {
            constexpr double kArmMm = 2.0;
            const Vec3 foot = side->onSurface - margin * side->out;
            add("margin_mm", foot, -side->out);
            add("convergence_deg", foot - kArmMm * core::tan(taper) * side->out + kArmMm * Vec3::UnitZ(), -side->out,
                2.0, kArmMm);
        }
        if (const auto side = sideAt(most(Vec3::UnitX())))
            add("over_cervix_mm", side->onSurface - 0.5 * margin * side->out, Vec3::UnitZ());
    }

    void access() {
        const Cavity& cavity = laid_.cavities.front();
        // The horn or orifice farthest out: the outline stands round it.
        std::vector<Vec2> marks;
        Vec2 middle = Vec2::Zero();
        for (const cases::Landmark& one : tooth_.landmarks)
            if (one.kind == cases::LandmarkKind::orifice || one.kind == cases::LandmarkKind::pulpHorn)
                marks.push_back(one.pointsMm.front().head<2>());
        if (marks.empty()) return;
        for (const Vec2& p : marks)
            middle += p / static_cast<double>(marks.size());
        const Vec2 centre = *std::max_element(marks.begin(), marks.end(), [&](const Vec2& a, const Vec2& b) {
            return (a - middle).squaredNorm() < (b - middle).squaredNorm();
        });
        const Vec2 out = marks.size() > 1 ? Vec2((centre - middle).normalized()) : Vec2(Vec2::UnitX());
        const Vec2 far = centre + number("round_mm") * out;
        const double floor = cavity.floor.heightMm;
        constexpr double kArmMm = 3.0;
        add(cavity, "round_mm", at(far, floor), at(out, 0.0));
        add(cavity, "wall_deg", at(far + kArmMm * core::tan(cavity.wallRad) * out, floor + kArmMm), at(out, 0.0), 1.0,
            kArmMm);
        const cases::Landmark* junction = mark(cases::LandmarkKind::cementoEnamelJunction);
        if (junction == nullptr) return;
        constexpr double kUnderMm = 2.0;
        double cervix = 0.0;
        for (const Vec3& p : junction->pointsMm)
            cervix += p.z() / static_cast<double>(junction->pointsMm.size());
        const double buccal = tooth_.buccalSign < 0 ? -1.0 : 1.0;
        if (const auto root = outermost(at(middle, cervix - kUnderMm), buccal * Vec3::UnitY())) {
            const Vec3 normal = normalAt(*root);
            add("shell_mm", *root - number("shell_mm") * normal, -normal);
        }
    }

    /// Where the carious tissue comes nearest to the pulp.
    void lesion() {
        std::vector<geometry::TriangleTree> pulps;
        for (const cases::Part& part : tooth_.parts)
            if (part.tissue == cases::Tissue::pulp) pulps.emplace_back(part.mesh);
        double least = 1e9;
        Vec3 pulp = Vec3::Zero(), carious = Vec3::Zero();
        for (const cases::Part& part : tooth_.parts) {
            if (!cases::isCarious(part.tissue)) continue;
            for (const Vec3& v : part.mesh.vertices)
                for (const geometry::TriangleTree& tree : pulps) {
                    const double far = tree.signedDistance(v);
                    if (far <= 1e-3 || far >= least) continue;
                    least = far, carious = v, pulp = tree.nearest(v).pointMm;
                }
        }
        if (least > 1e8) return;
        const Vec3 way = (carious - pulp).normalized();
        add("over_pulp_mm", pulp + number("over_pulp_mm") * way, way);
    }

    void block() {
        const Cavity& cavity = laid_.cavities.front();
        const std::string_view kind = std::string_view(recipe_.preparation).substr(6);
        const double floor = cavity.floor.heightMm;
        const auto [low, high] = cavity.outline.bounds();
        const Vec2 middle = laid_.whole->bounds().centre().head<2>();
        if (!cavity.outline.strokes.empty()) {
            groove(cavity, middle, 0.0);
            add(cavity, "length_mm", {high.x(), middle.y(), floor}, Vec3::UnitX(), 2.0);
        } else if (kind == "steps") {
            add(cavity, "depth_mm", at(0.5 * (low + high), floor), -Vec3::UnitZ());
            add(cavity, "width_mm", {0.5 * (low.x() + high.x()), high.y(), floor}, Vec3::UnitY(), 2.0);
            add(cavity, "length_mm", {low.x(), middle.y(), floor}, -Vec3::UnitX(), 2.0);
        } else {
            const double inner = kind == "hollow-circle" ? 0.5 * number("inner_mm") : 0.0;
            const Vec2 aside(0.5 * (inner + high.x() - middle.x()), 0.0);
            add(cavity, "depth_mm", at(middle + aside, floor), -Vec3::UnitZ());
            add(cavity, "diameter_mm", {high.x(), middle.y(), floor}, Vec3::UnitX(), 2.0);
            if (kind == "hollow-circle")
                add(cavity, "inner_mm", {middle.x(), middle.y() + inner, floor}, Vec3::UnitY(), 2.0);
        }
    }

    const cases::Tooth& tooth_;
    const Recipe& recipe_;
    const Laid& laid_;
    std::vector<Handle> handles_;
};

}  // namespace

std::vector<Handle> handlesOf(const cases::Tooth& tooth, const Recipe& recipe, const Laid& laid) {
    return Finder(tooth, recipe, laid).all();
}

double valueOf(const Handle& handle, const Recipe& recipe, double movedMm) {
    const double was = recipe.number(handle.number);
    double value = was + handle.perMm * movedMm, step = kStepMm;
    if (handle.armMm > 0.0) {
        const double rad = core::tan(was / handle.perMm * kRadPerDeg) + movedMm / handle.armMm;
        value = handle.perMm * core::atan2(rad, 1.0) / kRadPerDeg;
        step = kStepDeg;
    }
    // As the number is written: 0.05 times 25 is not 1.25 to the last bit.
    value = std::round(std::round(value / step) * step * 100.0) / 100.0;
    const preparation::Template* of = preparation::findTemplate(recipe.preparation);
    for (const preparation::Parameter& p : of->parameters)
        if (p.name == handle.number) value = std::clamp(value, p.least, p.most);
    return value;
}

}  // namespace handpiece::draft
