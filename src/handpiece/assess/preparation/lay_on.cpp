// SPDX-License-Identifier: Apache-2.0
// Templates laid onto a tooth. A cavity's frame has its +z along the path of draw; its floor is where the outline
// stands.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "handpiece/assess/preparation/zone_surfaces.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"

namespace handpiece::preparation {
namespace {

using cases::LandmarkKind;
using core::Vec2;
using core::Vec3;
using zones::Cavity;
using zones::Floor;
using zones::Outline;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
using zones::kFarMm;
/// How far targets go on into the air.
constexpr double kAboveMm = 12.0;

/// How far the tooth goes on from a place inside it, in a direction; 0 from outside.
double insideOf(const geometry::TriangleTree& tree, const Vec3& from, const Vec3& way) {
    if (tree.signedDistance(from) >= 0.0) return 0.0;
    const geometry::RayMeeting out = tree.firstMeeting(from, way);
    return out.triangle == geometry::kNoTriangle ? 0.0 : out.distanceMm;
}

class Site {
  public:
    Site(const cases::Tooth& tooth, const Recipe& recipe, std::shared_ptr<const geometry::TriangleTree> whole)
        : tooth_(tooth),
          recipe_(recipe),
          tree_(whole ? std::move(whole) : std::make_shared<const geometry::TriangleTree>(surfaceOf(tooth))) {}

    Laid laid() {
        Laid laid;
        laid.whole = tree_;
        core::Box box;
        zones::TargetFunction target;
        const std::string& id = recipe_.preparation;
        if (id == "lesion") {
            target = lesion(box);
        } else if (id == "crown") {
            target = crown(box);
        } else if (id == "onlay") {
            target = onlay(box);
            laid.cavities = cavities_;
        } else if (id == kRecordedTemplate) {
            target = recorded(box, laid.draw);
        } else if (id == kPaintedTemplate) {
            Painting painting =
                paintedTarget(recipe_.strokes, number("depth_mm"), recipe_.leeway, tooth_.surface(), tree_);
            target = std::move(painting.target), box = painting.box;
            laid.draw = recipe_.draw.value_or(painting.draw);
        } else {
            if (id.starts_with("block-"))
                block();
            else if (id == "class-one")
                classOne(0.0, 0.0);
            else if (id == "class-two")
                classOne(sideSign(), 0.0), box_(recipe_.side, number("axial_mm"));
            else if (id == "class-three")
                classThree();
            else if (id == "class-five")
                classFive();
            else
                access();
            laid.cavities = cavities_;
            laid.draw = cavities_.front().inTooth.orientation * Vec3::UnitZ();
            box = zones::boundsOf(cavities_, kAboveMm);
            target = zones::targetOf(cavities_, tree_.get());
            // The function asks the tree for as long as it lives.
            target = [target, tree = tree_](const Vec3& p) { return target(p); };
        }
        // Beyond the tooth there is nothing to take.
        const core::Box& whole = tree_->bounds();
        box.min = box.min.cwiseMax(whole.min), box.max = box.max.cwiseMin(whole.max);
        if (box.isEmpty()) fail("the preparation lies outside the tooth", "give other sizes", "lay-outside");
        laid.zones = std::make_shared<zones::Zones>(std::move(target), box, recipe_.leeway, guarded());
        laid.fissureMiddleMm = fissureMiddleMm_;
        return laid;
    }

  private:
    /// `id`: by which a window says it in its language, with what varies.
    [[noreturn]] void fail(const std::string& what, const std::string& remedy, std::string id) const {
        throw core::Error(fmt::format("{}: {}", recipe_.preparation, what),
                          tooth_.name.empty() ? "the tooth" : tooth_.name, remedy)
            .as(std::move(id));
    }
    static const geometry::TriangleMesh& surfaceOf(const cases::Tooth& tooth) {
        if (tooth.surface().triangles.empty())
            throw core::Error("the tooth has no surface as a whole", tooth.name,
                              "name outer.stl in case.toml: the whole tooth as one closed surface")
                .as("lay-no-surface");
        return tooth.surface();
    }
    [[nodiscard]] double number(std::string_view name) const { return recipe_.number(name); }
    /// Of a template that recorded work or a painting is like: as usual.
    [[nodiscard]] double numberOfKind(std::string_view name) const {
        if (recipe_.like.empty()) return number(name);
        Recipe usual;
        usual.preparation = recipe_.like;
        return usual.number(name);
    }

    [[nodiscard]] std::vector<const cases::Landmark*> marks(LandmarkKind kind) const {
        std::vector<const cases::Landmark*> found;
        for (const cases::Landmark& mark : tooth_.landmarks)
            if (mark.kind == kind) found.push_back(&mark);
        return found;
    }
    [[nodiscard]] std::vector<const cases::Landmark*> need(LandmarkKind kind) const {
        auto found = marks(kind);
        if (found.empty())
            fail(fmt::format("the tooth has no landmark \"{}\"", cases::kLandmarkKinds[static_cast<std::size_t>(kind)]),
                 "find or set it in the window (Ctrl+J), or handpiece case landmarks --find",
                 "lay-no-" + std::string(cases::kLandmarkKinds[static_cast<std::size_t>(kind)]));
        return found;
    }
    [[nodiscard]] Vec3 contact(const std::string& side) const {
        for (const cases::Landmark* mark : need(LandmarkKind::contact))
            if (mark->name == side) return mark->pointsMm.front();
        fail(fmt::format("the tooth has no {} contact", side), "set it in the window (Ctrl+Shift+J)",
             "lay-no-contact-" + side);
    }
    /// +1 where buccal is +y.
    [[nodiscard]] double buccal() const {
        if (tooth_.buccalSign == 0)
            fail("the case does not say which side is buccal", "add buccal = \"+y\" or \"-y\"", "lay-no-buccal");
        return tooth_.buccalSign;
    }
    [[nodiscard]] double inside(const Vec3& from, const Vec3& way) const { return insideOf(*tree_, from, way); }
    /// So far inside the tooth at least, upwards: by the side on which the first surface over it is met.
    [[nodiscard]] bool isUnder(const Vec3& p, double leastMm) const {
        const geometry::RayMeeting over = tree_->firstMeeting(p, Vec3::UnitZ());
        return over.triangle != geometry::kNoTriangle && over.distanceMm >= leastMm &&
               tree_->pseudonormal(over.triangle).z() > 0.0;
    }
    /// How far off the tooth ends for good, in a direction; negative where it does not lie that way.
    [[nodiscard]] double outermost(const Vec3& from, const Vec3& way) const {
        constexpr double kOffMm = 40.0;
        const geometry::RayMeeting in = tree_->firstMeeting(from + kOffMm * way, -way);
        return in.triangle == geometry::kNoTriangle ? -kOffMm : kOffMm - in.distanceMm;
    }

    // ------------------------------------------------------------------ cavities

    void block() {
        const std::string_view kind = std::string_view(recipe_.preparation).substr(6);
        const double top = tree_->bounds().max.z(), depth = number("depth_mm");
        const core::Box& whole = tree_->bounds();
        const Vec2 middle = whole.centre().head<2>();
        const auto add = [&](Outline outline, double deep) {
            cavities_.push_back({{}, std::move(outline), {Floor::Kind::flat, top - deep, 0.0}, 0.0});
        };
        const auto groove = [&](const Vec2& way) {
            const double half = 0.5 * (number("length_mm") - number("width_mm"));
            if (half < 0.0) fail("it is wider than long", "give a greater length", "lay-wider");
            return Outline::Stroke{{middle - half * way, middle + half * way}, 0.5 * number("width_mm")};
        };
        Outline outline;
        if (kind == "line" || kind == "channel") {
            outline.strokes = {groove(Vec2::UnitX())};
        } else if (kind == "cross") {
            outline.strokes = {groove(Vec2::UnitX()), groove(Vec2::UnitY())};
        } else if (kind == "circle") {
            outline.areas = {zones::circle(middle, 0.5 * number("diameter_mm"))};
        } else if (kind == "hollow-circle") {
            if (number("inner_mm") >= number("diameter_mm"))
                fail("the island is as wide as the figure", "make it less", "lay-island");
            outline.areas = {zones::circle(middle, 0.5 * number("diameter_mm"))};
            outline.holes = {zones::circle(middle, 0.5 * number("inner_mm"))};
        } else if (kind == "d-circle") {
            outline.areas = {
                zones::arc(middle, 0.5 * number("diameter_mm"), -0.5 * std::numbers::pi, 0.5 * std::numbers::pi)};
        } else {
            const double third = number("length_mm") / 3.0, half = 0.5 * number("width_mm");
            for (int i = 0; i < 3; ++i) {
                const double from = middle.x() + (i - 1.5) * third, to = from + third;
                Outline step;
                step.areas = {{Vec2(from, middle.y() - half), Vec2(to, middle.y() - half), Vec2(to, middle.y() + half),
                               Vec2(from, middle.y() + half)}};
                add(std::move(step), (i + 1) * depth);
            }
            return;
        }
        add(std::move(outline), depth);
    }

    /// +1 where the box is mesial.
    [[nodiscard]] double sideSign() const { return recipe_.side == "mesial" ? 1.0 : -1.0; }
    /// Along the fissures, as far as ridges and walls keep their thickness at the floor; not on the sides of boxes, by
    /// the signs of their x; 0: none.
    void classOne(double open, double alsoOpen) {
        const double half = 0.5 * number("width_mm"), ridge = number("ridge_mm");
        const auto fissures = need(LandmarkKind::fissure);
        findFissureMiddle(fissures);
        const double floor = fissureMiddleMm_.z() - number("depth_mm");
        // At the floor all round; towards the marginal ridges, which get thinner towards their crests, as high as the
        // wall stands.
        const double flare = core::tan(number("wall_deg") * kRadPerDeg);
        const auto isRoom = [&](const Vec3& p) {
            constexpr int kWays = 48;
            constexpr double kStepMm = 0.25, kUnderSurfaceMm = 0.2;
            for (int i = 0; i < kWays; ++i) {
                const double rad = 2.0 * std::numbers::pi * i / kWays;
                const Vec3 way(core::cos(rad), core::sin(rad), 0.0);
                // Towards the box the ridge goes.
                if (open * way.x() > 0.7 || alsoOpen * way.x() > 0.7) continue;
                for (double up = 0.0;; up += kStepMm) {
                    const Vec3 at(p.x(), p.y(), floor + up);
                    const double wall = half + up * flare;
                    if (up > 0.0 && (std::abs(way.x()) < 0.7 || !isUnder(at + wall * way, kUnderSurfaceMm))) break;
                    if (outermost(at, way) < ridge + wall) return false;
                }
            }
            return true;
        };
        Outline outline;
        for (const cases::Landmark* fissure : fissures) {
            std::vector<Vec2> run;
            const auto end = [&] {
                if (!run.empty()) outline.strokes.push_back({std::move(run), half});
                run.clear();
            };
            for (std::size_t i = 0; i + 1 < fissure->pointsMm.size(); ++i) {
                const Vec3 &a = fissure->pointsMm[i], &b = fissure->pointsMm[i + 1];
                const int pieces = std::max(1, static_cast<int>(std::ceil((b - a).norm() / 0.05)));
                for (int k = i == 0 ? 0 : 1; k <= pieces; ++k) {
                    const Vec3 p = a + (b - a) * (static_cast<double>(k) / pieces);
                    if (isOnTop(p) && isRoom(p))
                        run.push_back(p.head<2>());
                    else
                        end();
                }
            }
            end();
        }
        if (outline.isEmpty())
            fail("there is no room along the fissures", "give a thinner ridge, or a lesser width or depth",
                 "lay-no-room");
        cavities_.push_back({{}, std::move(outline), {Floor::Kind::flat, floor, 0.0}, number("wall_deg") * kRadPerDeg});
    }
    void findFissureMiddle(std::span<const cases::Landmark* const> fissures) {
        Vec3 sum = Vec3::Zero();
        std::size_t count = 0;
        for (const cases::Landmark* fissure : fissures)
            for (const Vec3& p : fissure->pointsMm)
                if (isOnTop(p)) sum += p, ++count;
        if (count == 0)
            fail("no fissure lies on the occlusal surface", "set it in the window (Ctrl+Shift+J)", "lay-fissure-off");
        fissureMiddleMm_ = sum / static_cast<double>(count);
    }
    /// Fissures run over onto the sides; those are not followed.
    [[nodiscard]] bool isOnTop(const Vec3& p) const {
        const geometry::NearestPoint near = tree_->nearest(p);
        return near.triangle != geometry::kNoTriangle && tree_->pseudonormal(near.triangle).z() > 0.35f;
    }

    /// The proximal box of a class II, and the way to it.
    void box_(const std::string& side, double axialMm) {
        const double sign = side == "mesial" ? 1.0 : -1.0;
        const Vec3 at = contact(side);
        const double half = 0.5 * number("box_width_mm"), wall = number("wall_deg") * kRadPerDeg;
        const double axial = at.x() - sign * axialMm, beyond = at.x() + sign * 3.0;
        const auto rectangle = [](double x0, double x1, double y0, double y1) {
            return std::vector<Vec2>{
                {std::min(x0, x1), y0}, {std::max(x0, x1), y0}, {std::max(x0, x1), y1}, {std::min(x0, x1), y1}};
        };
        const Cavity occlusal = cavities_.front();
        // From the end of the occlusal part, on its floor, into the box.
        double end = -sign * kFarMm, along = at.y();
        for (const Outline::Stroke& stroke : occlusal.outline.strokes)
            for (const Vec2& p : stroke.points)
                if (sign * p.x() > sign * end) end = p.x(), along = p.y();
        if (sign * end < sign * axial) {
            Outline way;
            way.strokes = {{{Vec2(end, along), Vec2(axial, at.y())}, 0.5 * number("width_mm")}};
            cavities_.push_back({{}, std::move(way), occlusal.floor, wall});
        }
        Outline outline;
        outline.areas = {rectangle(axial, beyond, at.y() - half, at.y() + half)};
        cavities_.push_back(
            {{}, std::move(outline), {Floor::Kind::flat, at.z() - number("under_contact_mm"), 0.0}, wall});
    }

    void classThree() {
        const double sign = recipe_.side == "mesial" ? 1.0 : -1.0;
        // Caries of that kind begins under the contact.
        const Vec3 at = contact(recipe_.side) - 0.3 * number("height_mm") * Vec3::UnitZ();
        // Out to the palatal (lingual) side: x mesial stays, y of the frame is up.
        const Vec3 draw(0.0, -buccal(), 0.0), up = Vec3::UnitZ();
        const core::Pose pose = facing(draw, up, at);
        const double half = 0.5 * number("height_mm"), corner = std::min(number("corner_mm"), 0.99 * half);
        const Vec3 mesial = pose.orientation.conjugate() * (sign * Vec3::UnitX());
        const double inwards = mesial.x() > 0.0 ? 1.0 : -1.0;
        Outline outline;
        outline.areas = {roundRectangle(Vec2(inwards * (1.5 - 0.5 * number("axial_mm")), 0.0),
                                        Vec2(0.5 * number("axial_mm") + 1.5, half), corner)};
        // Depth counts from the palatal surface beside the contact.
        const Vec3 within = at - sign * Vec3::UnitX() * (0.5 * number("axial_mm"));
        const double toSurface = inside(within, draw);
        if (!(toSurface > 0.0))
            fail("the contact does not lie on the tooth", "set it in the window (Ctrl+Shift+J)", "lay-contact-off");
        cavities_.push_back({pose, std::move(outline), {Floor::Kind::flat, toSurface - number("depth_mm"), 0.0}, 0.0});
    }

    struct Curve {
        double level, slope, bend;
        [[nodiscard]] double at(double x) const { return level + x * (slope + x * bend); }
    };
    /// A parabola through the junction on both sides of `middle`, lifted until it is nowhere less than "over_cervix_mm"
    /// over it: the gingiva's margin follows the junction, and so does the gingival wall.
    [[nodiscard]] Curve besideJunction(const cases::Landmark& junction, double side, const Vec3& middle,
                                       double halfWidth) const {
        constexpr double kBeyondMm = 0.5;
        constexpr std::size_t kFewest = 5;
        std::vector<Vec2> places;
        for (const Vec3& p : junction.pointsMm)
            if (side * p.y() > 0.0 && std::abs(p.x() - middle.x()) <= halfWidth + kBeyondMm)
                places.emplace_back(p.x() - middle.x(), p.z());
        Curve curve{0.0, 0.0, 0.0};
        if (places.size() >= kFewest) {
            core::Mat3 square = core::Mat3::Zero();
            Vec3 right = Vec3::Zero();
            for (const Vec2& p : places) {
                const Vec3 row(1.0, p.x(), p.x() * p.x());
                square += row * row.transpose(), right += p.y() * row;
            }
            const Vec3 fit = square.ldlt().solve(right);
            curve = {fit[0], fit[1], std::max(fit[2], 0.0)};
        }
        double lift = middle.z() - curve.at(0.0);
        for (const Vec2& p : places)
            if (std::abs(p.x()) <= halfWidth) lift = std::max(lift, p.y() - curve.at(p.x()));
        curve.level += lift + number("over_cervix_mm");
        return curve;
    }
    /// Outline between a curve below and a level line at `half`, its corners rounded.
    [[nodiscard]] std::vector<Vec2> onCurve(const Curve& below, double halfWidth, double half) const {
        constexpr double kLeastMm = 0.2, kStepMm = 0.05, kQuarter = 0.5 * std::numbers::pi;
        const auto normal = [&](double x) { return Vec2(-below.slope - 2.0 * x * below.bend, 1.0).normalized(); };
        struct Corners {
            double x, lower, upper;  ///< where the lower one rests on the curve; radii
            Vec2 centre;             ///< of the lower one
        };
        const auto cornersAt = [&](double side) -> Corners {
            const double wall = half - below.at(side * halfWidth);
            if (wall < kLeastMm)
                fail("the cemento-enamel junction rises so far beside the cavity that no height is left there",
                     "make it narrower or higher", "lay-junction-steep");
            const double asked = std::min(number("corner_mm"), 0.98 * halfWidth);
            Corners c{0.0, std::min(asked, 0.49 * wall), 0.0, Vec2::Zero()};
            if (below.bend > 0.0) c.lower = std::min(c.lower, 0.45 / below.bend);  // the curve's own is 1 / 2 bend
            double in = 0.0, out = side * halfWidth;
            for (int i = 0; i < 60; ++i) {
                c.x = 0.5 * (in + out);
                c.centre = Vec2(c.x, below.at(c.x)) + c.lower * normal(c.x);
                (side * c.centre.x() < halfWidth - c.lower ? in : out) = c.x;
            }
            c.upper = std::min(asked, half - c.centre.y());
            return c;
        };
        const Corners left = cornersAt(-1.0), right = cornersAt(1.0);
        std::vector<Vec2> points;
        const auto round = [&](const Vec2& centre, double radius, double fromRad, double toRad) {
            for (const Vec2& p : zones::arc(centre, radius, fromRad, toRad))
                points.push_back(p);
        };
        const auto downRad = [&](double x) { return core::atan2(-normal(x).y(), -normal(x).x()); };
        const int steps = std::max(1, static_cast<int>(std::ceil((right.x - left.x) / kStepMm)));
        for (int i = 0; i <= steps; ++i) {
            const double x = left.x + (right.x - left.x) * i / steps;
            points.emplace_back(x, below.at(x));
        }
        round(right.centre, right.lower, downRad(right.x), 0.0);
        round({halfWidth - right.upper, half - right.upper}, right.upper, 0.0, kQuarter);
        round({left.upper - halfWidth, half - left.upper}, left.upper, kQuarter, 2.0 * kQuarter);
        round(left.centre, left.lower, -2.0 * kQuarter, downRad(left.x));
        return points;
    }
    void classFive() {
        const double sign = buccal();
        const Vec3 draw(0.0, sign, 0.0);
        const auto junction = need(LandmarkKind::cementoEnamelJunction).front();
        // Its lowest place on that side, in the middle.
        const double middle = tree_->bounds().centre().x();
        const Vec3* cervix = nullptr;
        for (const Vec3& p : junction->pointsMm)
            if (sign * p.y() > 0.0 && (cervix == nullptr || std::abs(p.x() - middle) < std::abs(cervix->x() - middle)))
                cervix = &p;
        if (cervix == nullptr)
            fail("the cemento-enamel junction does not reach the buccal side", "set it anew", "lay-junction-short");
        const double halfWidth = 0.5 * number("width_mm"), half = 0.5 * number("height_mm");
        const Curve wall = besideJunction(*junction, sign, *cervix, halfWidth);
        const Vec3 at(cervix->x(), cervix->y(), wall.at(0.0) + half);
        Outline outline;
        // The frame's +x goes towards -x on the +y side.
        outline.areas = {onCurve({wall.level - at.z(), -sign * wall.slope, wall.bend}, halfWidth, half)};
        // Not as deep as the tooth's other side.
        cavities_.push_back({facing(draw, Vec3::UnitZ(), at),
                             std::move(outline),
                             {Floor::Kind::near, -number("axial_mm") - 1.5, number("axial_mm")},
                             0.0});
    }

    void access() {
        Outline outline;
        std::vector<Vec2> points;
        double floor = 0.0;
        const auto orifices = need(LandmarkKind::orifice);
        const double round = number("round_mm");
        for (const cases::Landmark* orifice : orifices) {
            floor += orifice->pointsMm.front().z() / static_cast<double>(orifices.size());
            for (const Vec2& p : zones::circle(orifice->pointsMm.front().head<2>(), round))
                points.push_back(p);
        }
        for (const cases::Landmark* horn : marks(LandmarkKind::pulpHorn))
            for (const Vec2& p : zones::circle(horn->pointsMm.front().head<2>(), round))
                points.push_back(p);
        outline.areas = {zones::convexOutline(std::move(points))};
        cavities_.push_back({{}, std::move(outline), {Floor::Kind::flat, floor, 0.0}, number("wall_deg") * kRadPerDeg});
    }

    /// A frame at a place whose +z is `out` and whose +y is `up` as far as that goes.
    static core::Pose facing(const Vec3& out, const Vec3& up, const Vec3& at) {
        core::Mat3 axes;
        axes.col(2) = out.normalized();
        axes.col(0) = up.cross(axes.col(2)).normalized();
        axes.col(1) = axes.col(2).cross(axes.col(0));
        return {at, core::Quat(axes).normalized()};
    }
    static std::vector<Vec2> roundRectangle(const Vec2& middle, const Vec2& half, double corner) {
        std::vector<Vec2> points;
        for (int i = 0; i < 4; ++i) {
            const Vec2 sign(i == 0 || i == 3 ? 1.0 : -1.0, i < 2 ? 1.0 : -1.0);
            const Vec2 centre = middle + sign.cwiseProduct(half - Vec2::Constant(corner));
            const double from = 0.5 * std::numbers::pi * i;
            for (const Vec2& p : zones::arc(centre, corner, from, from + 0.5 * std::numbers::pi))
                points.push_back(p);
        }
        return points;
    }

    // ------------------------------------------------------------------ what is no cavity

    /// Outside of a core: its outline at the margin, less the margin's width, tapers towards occlusal and ends under
    /// the uncut top.
    zones::TargetFunction crown(core::Box& box) {
        const auto junction = need(LandmarkKind::cementoEnamelJunction).front();
        const double margin = number("margin_mm");
        // A margin that follows the junction: its height by the angle about the middle.
        const Vec3 middle = tree_->bounds().centre();
        struct Place {
            double rad, heightMm;
            Vec2 at;
        };
        std::vector<Place> ring;
        for (const Vec3& p : junction->pointsMm) {
            const double height = p.z() + number("over_cervix_mm");
            const Vec2 way = (p - middle).head<2>().normalized();
            const Vec3 from(middle.x(), middle.y(), height);
            const double out = inside(from, Vec3(way.x(), way.y(), 0.0));
            if (!(out > margin))
                fail("the margin does not lie on the tooth", "give another height over the cervix", "lay-margin-off");
            ring.push_back({core::atan2(way.y(), way.x()), height, middle.head<2>() + (out - margin) * way});
        }
        std::sort(ring.begin(), ring.end(), [](const Place& a, const Place& b) { return a.rad < b.rad; });
        Outline core_;
        core_.areas.emplace_back();
        double low = kFarMm;
        for (const Place& place : ring)
            core_.areas.front().push_back(place.at), low = std::min(low, place.heightMm);
        const double taper = 0.5 * number("convergence_deg") * kRadPerDeg, occlusal = number("occlusal_mm");
        const double tangent = core::tan(taper), cosine = core::cos(taper);
        box = tree_->bounds();
        box.min.z() = low;
        return [ring = std::move(ring), outline = std::move(core_), tangent, cosine, occlusal, middle,
                tree = tree_](const Vec3& p) {
            // The margin's height here, between its places.
            const Vec2 way = (p - middle).head<2>();
            const double rad = core::atan2(way.y(), way.x());
            const auto next = std::lower_bound(ring.begin(), ring.end(), rad,
                                               [](const Place& place, double r) { return place.rad < r; });
            const Place &b = next == ring.end() ? ring.front() : *next,
                        &a = next == ring.begin() ? ring.back() : *(next - 1);
            double span = b.rad - a.rad, share = rad - a.rad;
            if (span <= 0.0) span += 2.0 * std::numbers::pi;
            if (share < 0.0) share += 2.0 * std::numbers::pi;
            const double height = a.heightMm + (b.heightMm - a.heightMm) * std::clamp(share / span, 0.0, 1.0);
            // Into the core: through its side, or through its top.
            const double side = -(outline.distanceMm(way + middle.head<2>()) + (p.z() - height) * tangent) * cosine;
            const double top = insideOf(*tree, p, Vec3::UnitZ()) - occlusal;
            return zones::PastTarget{std::min(side, top), height - p.z()};
        };
    }

    /// The cavity of a class II, and off the capped cusps as much as each asks for, square to the uncut surface, down
    /// to a shoulder on their outer side. A quarter of the crown goes with each: premolars have one cusp for two.
    /// Boxes on one side, on both or on none.
    zones::TargetFunction onlay(core::Box& box) {
        // The box at its side is the last of the cavities.
        const double here = number("axial_mm"), there = number("other_axial_mm"), sign = sideSign();
        classOne(here > 0.0 ? sign : 0.0, there > 0.0 ? -sign : 0.0);
        if (there > 0.0) box_(sign > 0.0 ? "distal" : "mesial", there);
        if (here > 0.0) box_(recipe_.side, here);
        box = zones::boundsOf(cavities_, kAboveMm);
        const double side = buccal();
        const Vec2 middle = fissureMiddleMm_.head<2>();
        struct Quarter {
            Vec2 out;  ///< signs of x and y
            double capMm, lowMm;
        };
        std::array<Quarter, 4> quarters{};
        const auto cusps = need(LandmarkKind::cuspTip);
        for (std::size_t i = 0; i < quarters.size(); ++i) {
            Quarter& q = quarters[i];
            q.out = Vec2(i % 2 == 0 ? 1.0 : -1.0, i < 2 ? side : -side);
            q.capMm = number(kCapNumbers[i]);
            if (!(q.capMm > 0.0)) continue;
            // The lowest cusp of that side: the shoulder runs on from one to the next.
            double tip = kFarMm;
            for (const cases::Landmark* cusp : cusps)
                if (q.out.y() * (cusp->pointsMm.front().y() - middle.y()) > 0.0)
                    tip = std::min(tip, cusp->pointsMm.front().z());
            if (tip == kFarMm)
                fail("there is no cusp on the side that is to be capped", "set its tip in the window (Ctrl+Shift+J)",
                     "lay-no-cusp-tip");
            q.lowMm = tip - q.capMm - number("shoulder_mm");
            for (const cases::Landmark* junction : marks(LandmarkKind::cementoEnamelJunction))
                for (const Vec3& p : junction->pointsMm)
                    if (Vec2(q.out.cwiseProduct(p.head<2>() - middle)).minCoeff() > 0.0 && p.z() >= q.lowMm)
                        fail("the margin of a capped cusp would lie under the cemento-enamel junction",
                             "take less off the cusp, or make the shoulder lower", "lay-margin-low");
            const core::Box& whole = tree_->bounds();
            box.extend(Vec3(whole.min.x(), whole.min.y(), q.lowMm));
            box.extend(whole.max);
        }
        return [cavity = zones::targetOf(cavities_, tree_.get()), quarters, middle, tree = tree_](const Vec3& p) {
            zones::PastTarget past = cavity(p);
            const Vec2 off = p.head<2>() - middle;
            const auto isIn = [&](const Quarter& q) {
                return q.out.x() * off.x() >= 0.0 && q.out.y() * off.y() >= 0.0;
            };
            const auto awayFrom = [&](const Quarter& q) {
                return Vec2(-q.out.cwiseProduct(off)).cwiseMax(Vec2::Zero()).norm();
            };
            // Into the quarters that are capped, as far as one that is not.
            const Quarter* nearest = nullptr;
            double aside = kFarMm;
            for (const Quarter& q : quarters) {
                if (!(q.capMm > 0.0)) continue;
                if (const double away = isIn(q) ? 0.0 : awayFrom(q); away < aside) aside = away, nearest = &q;
            }
            if (nearest == nullptr) return past;
            if (!(aside > 0.0)) {
                aside = -kFarMm;
                for (const Quarter& q : quarters)
                    if (!(q.capMm > 0.0)) aside = std::max(aside, -awayFrom(q));
            }
            const zones::PastTarget cap{std::max(aside, nearest->lowMm - p.z()),
                                        depthUnderEquator(*tree, p) - nearest->capMm};
            return cap.distanceMm() < past.distanceMm() ? cap : past;
        };
    }

    /// How deep a place lies under the surface; under the tooth's height of contour as deep as the deepest above it:
    /// what is left there, equally thick all round, would hang over what is gone.
    static double depthUnderEquator(const geometry::TriangleTree& tree, Vec3 p) {
        constexpr double kStepMm = 0.1;
        geometry::NearestPoint near;
        double deepest = -tree.signedDistance(p, &near);
        while (deepest > 0.0 && near.pointMm.z() < p.z()) {
            p.z() += kStepMm;
            const double here = -tree.signedDistance(p, &near);
            if (here <= deepest) break;
            deepest = here;
        }
        return deepest;
    }

    zones::TargetFunction recorded(core::Box& box, Vec3& draw) {
        if (!recipe_.recorded || recipe_.recorded->hash() != recipe_.recordedHash)
            fail("the work that was recorded is not there, or is another", "name the exercise's own folder or file",
                 "lay-no-recorded");
        box = recipe_.recorded->surface.bounds();
        draw = recipe_.draw.value_or(recipe_.recorded->draw);
        return recordedTarget(*recipe_.recorded, draw, recipe_.leeway, tree_);
    }

    zones::TargetFunction lesion(core::Box& box) {
        std::vector<std::shared_ptr<geometry::TriangleTree>> carious;
        for (const cases::Part& part : tooth_.parts)
            if (cases::isCarious(part.tissue)) {
                carious.push_back(std::make_shared<geometry::TriangleTree>(part.mesh));
                const core::Box& bounds = carious.back()->bounds();
                box.extend(bounds.min), box.extend(bounds.max);
            }
        if (carious.empty())
            fail("the tooth has no carious tissue", "make it with --lesion, or choose another task", "lay-no-caries");
        const auto pulp = pulpMm();
        // The caries ends where the tooth does: a place on its surface, or just over it, belongs to what lies under it.
        return [carious = std::move(carious), pulp, over = number("over_pulp_mm"), tree = tree_](Vec3 p) {
            constexpr double kSkinMm = 0.1, kOverMm = 0.3;
            if (const geometry::NearestPoint on = tree->nearest(p, kOverMm);
                on.triangle != geometry::kNoTriangle && on.distanceMm * tree->side(p, on) > -kSkinMm)
                p = on.pointMm - kSkinMm * tree->pseudonormal(on.triangle, on.feature);
            double least = kFarMm;
            for (const auto& caries : carious)
                least = std::min(least, caries->signedDistance(p));
            if (pulp) least = std::max(least, over - pulp(p));
            return zones::PastTarget{least, -kFarMm};
        };
    }

    /// Signed distance to the pulp; none where the case has none.
    [[nodiscard]] geometry::ScalarFunction pulpMm() const {
        std::vector<std::shared_ptr<geometry::TriangleTree>> trees;
        for (const cases::Part& part : tooth_.parts)
            if (part.tissue == cases::Tissue::pulp)
                trees.push_back(std::make_shared<geometry::TriangleTree>(part.mesh));
        if (trees.empty()) return {};
        return [trees](const Vec3& p) {
            double least = kFarMm;
            for (const auto& tree : trees)
                least = std::min(least, tree->signedDistance(p));
            return least;
        };
    }
    /// What must stay: the pulp and what lies round it. Of an access, that takes the pulp: what keeps root and
    /// furcation whole. Of a class III from palatal the labial surface too.
    [[nodiscard]] geometry::ScalarFunction guarded() const {
        if (recipe_.kind() == "access") return rootShell();
        auto pulp = pulpMm();
        geometry::ScalarFunction kept;
        if (pulp) kept = [pulp, round = recipe_.pulpMm](const Vec3& p) { return pulp(p) - round; };
        if (recipe_.kind() != "class-three") return kept;
        return
            [kept, labial = labialShell()](const Vec3& p) { return kept ? std::min(kept(p), labial(p)) : labial(p); };
    }
    /// All that lies within `shell_mm` of the outer surface below the cemento-enamel junction.
    [[nodiscard]] geometry::ScalarFunction rootShell() const {
        double cervixMm = 0.0;
        const auto junction = need(LandmarkKind::cementoEnamelJunction).front();
        for (const Vec3& p : junction->pointsMm)
            cervixMm += p.z() / static_cast<double>(junction->pointsMm.size());
        return [tree = tree_, cervixMm, thick = numberOfKind("shell_mm")](const Vec3& p) {
            return std::max(-tree->signedDistance(p) - thick, p.z() - cervixMm);
        };
    }
    /// All that lies within `labial_mm` of a surface that faces labially, along that way.
    [[nodiscard]] geometry::ScalarFunction labialShell() const {
        const Vec3 way(0.0, buccal(), 0.0);
        return [tree = tree_, way, thick = numberOfKind("labial_mm")](const Vec3& p) {
            const double depthMm = -tree->signedDistance(p);
            if (depthMm > thick) return depthMm - thick;  // no less far along any way
            constexpr double kBackMm = 0.2;               // nodes just outside stand for tooth too
            const geometry::RayMeeting out = tree->firstMeeting(p - kBackMm * way, way);
            if (out.triangle == geometry::kNoTriangle) return kFarMm;
            constexpr double kFaces = 0.7;
            if (way.y() * tree->pseudonormal(out.triangle).y() < kFaces) return kFarMm;
            return out.distanceMm - kBackMm - thick;
        };
    }

    const cases::Tooth& tooth_;
    const Recipe& recipe_;
    std::shared_ptr<const geometry::TriangleTree> tree_;
    std::vector<Cavity> cavities_;
    Vec3 fissureMiddleMm_ = Vec3::Zero();
};

}  // namespace

Laid layOn(const cases::Tooth& tooth, const Recipe& recipe) {
    return layOn(tooth, recipe, nullptr);
}

Laid layOn(const cases::Tooth& tooth, const Recipe& recipe, std::shared_ptr<const geometry::TriangleTree> whole) {
    if (findTemplate(recipe.preparation) == nullptr)
        throw core::Error(fmt::format("there is no preparation \"{}\"", recipe.preparation), "preparation", "");
    return Site(tooth, recipe, std::move(whole)).laid();
}

}  // namespace handpiece::preparation
