// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/turbine.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::instrument {

using core::Vec3;
using geometry::TriangleMesh;

namespace {

// Outer sizes of a standard-head turbine [R]; the handle is drawn a third shorter than life.
constexpr double kHeadRadius = 5.2, kHeadHeight = 12.6;
constexpr double kNeckHeight = 6.4;   // of its axis above the head's lower face
constexpr double kNeckLength = 14.0;  // straight, from the head's axis
constexpr double kBendRadius = 45.0, kBendRad = 20.0 * std::numbers::pi / 180.0;
constexpr double kHandleEnd = 98.0;  // along the axis of neck and handle
// A friction-grip shank of 1.6 mm [ISO 1797, R] behind a neck, as it is drawn.
constexpr double kShankRadius = 0.8, kShankNeck = 0.45, kShankWidens = 3.5;
constexpr double kBlunt = 0.02;  // of a convex piece's outline
constexpr int kAround = 48, kSmallAround = 12;
constexpr int kGripRows = 17, kGripAround = 28;
constexpr double kGripStart = 46.0, kGripEnd = 72.0;

/// A place and a direction; `side` and `up` complete the right hand.
struct Frame {
    Vec3 place, along, side, up;
};

Frame upright(const Vec3& place) {
    return {place, Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY()};
}

/// The axis of neck and handle at arc length s: straight out of the head, a bend, straight on.
Frame handleAt(const Vec3& start, double s) {
    const double turned = std::clamp((s - kNeckLength) / kBendRadius, 0.0, kBendRad);
    const Vec3 along(core::cos(turned), 0.0, core::sin(turned));
    Vec3 place = start + Vec3(std::min(s, kNeckLength), 0.0, 0.0);
    place += kBendRadius * Vec3(core::sin(turned), 0.0, 1.0 - core::cos(turned));
    place += std::max(0.0, s - kNeckLength - kBendRadius * kBendRad) * along;
    return {place, along, Vec3::UnitY(), along.cross(Vec3::UnitY())};
}

/// A ring of a tube: where along its axis, how wide.
struct Station {
    double along, radius;
};

/// A closed tube through stations, ends closed by a fan on the axis.
template <class FrameAt>
void addTube(TriangleMesh& mesh, const std::vector<Station>& stations, int around, const FrameAt& frameAt) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size()), n = static_cast<std::uint32_t>(around);
    const auto rings = static_cast<std::uint32_t>(stations.size());
    for (const Station& station : stations) {
        const Frame f = frameAt(station.along);
        for (std::uint32_t j = 0; j < n; ++j) {
            const double angle = 2.0 * std::numbers::pi * j / n;
            mesh.vertices.push_back(f.place + station.radius * (core::cos(angle) * f.side + core::sin(angle) * f.up));
        }
    }
    const auto bottom = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(frameAt(stations.front().along).place);
    mesh.vertices.push_back(frameAt(stations.back().along).place);
    const auto at = [&](std::uint32_t ring, std::uint32_t j) { return first + ring * n + j % n; };
    for (std::uint32_t j = 0; j < n; ++j) {
        mesh.triangles.push_back({bottom, at(0, j + 1), at(0, j)});
        for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
            mesh.triangles.push_back({at(ring, j), at(ring, j + 1), at(ring + 1, j + 1)});
            mesh.triangles.push_back({at(ring, j), at(ring + 1, j + 1), at(ring + 1, j)});
        }
        mesh.triangles.push_back({at(rings - 1, j), at(rings - 1, j + 1), bottom + 1});
    }
}

/// Stations along a quarter of an ellipse, from (a, ra) upright to (b, rb) level: a rounded edge.
void addRounding(std::vector<Station>& stations, double a, double ra, double b, double rb, int steps) {
    for (int i = 0; i <= steps; ++i) {
        const double angle = 0.5 * std::numbers::pi * i / steps;
        stations.push_back({a + (b - a) * core::sin(angle), rb + (ra - rb) * core::cos(angle)});
    }
}

double handleRadius(double s) {
    // Slender neck behind the head, full at the grip, a little thinner at the coupling.
    const auto blend = [](double from, double to, double u) {
        u = std::clamp(u, 0.0, 1.0);
        return from + (to - from) * u * u * (3.0 - 2.0 * u);
    };
    if (s < 38.0) return blend(3.4, 5.6, (s - 8.0) / 30.0);
    return s < 80.0 ? blend(5.6, 6.6, (s - 38.0) / 14.0) : blend(6.6, 5.9, (s - 80.0) / 18.0);
}

/// A groove turned into the handle: down, along its floor, up again.
void addGroove(std::vector<Station>& stations, double at) {
    constexpr double kWidth = 0.5, kDepth = 0.25, kFlank = 0.08;
    for (const auto& [along, depth] : {std::pair{0.0, 0.0}, {kFlank, kDepth}, {kWidth - kFlank, kDepth}, {kWidth, 0.0}})
        stations.push_back({at + along, handleRadius(at + along) - depth});
}

std::vector<Station> handleStations() {
    std::vector<Station> stations;
    for (int i = 0; i < 30; ++i)
        stations.push_back({2.0 + 1.2 * i, handleRadius(2.0 + 1.2 * i)});  // to 36.8
    for (int i = 0; i < 5; ++i)
        addGroove(stations, 38.0 + 1.2 * i);  // to 43.3
    for (int i = 0; i < 14; ++i)
        stations.push_back({45.0 + 2.1 * i, handleRadius(45.0 + 2.1 * i)});  // to 72.3
    for (int i = 0; i < 10; ++i)
        addGroove(stations, 75.0 + 1.2 * i);  // to 86.3
    for (int i = 0; i < 4; ++i)
        stations.push_back({88.0 + 3.3 * i, handleRadius(88.0 + 3.3 * i)});
    return stations;
}

/// One raised point of the grip: a four-sided pyramid whose foot is sunk into the handle.
void addGripPoint(TriangleMesh& mesh, const Vec3& place, const Vec3& out, const Vec3& along) {
    constexpr double kHalfWidth = 0.42, kHeight = 0.3, kFoot = 0.35, kSunk = 0.06;
    const Vec3 across = out.cross(along), base = place - kSunk * out;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(place + kHeight * out);
    for (const Vec3& corner : {Vec3(along), Vec3(across), Vec3(-along), Vec3(-across)})
        mesh.vertices.push_back(base + kHalfWidth * corner);
    mesh.vertices.push_back(place - kFoot * out);
    for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t a = first + 1 + k, b = first + 1 + (k + 1) % 4;
        mesh.triangles.push_back({first, a, b});
        mesh.triangles.push_back({first + 5, b, a});
    }
}

std::vector<Station> headStations() {
    std::vector<Station> head;
    addRounding(head, 2.2, 3.0, 0.0, 2.4, 4);
    std::reverse(head.begin(), head.end());
    for (int i = 0; i <= 8; ++i)
        head.push_back({2.6 + 0.9 * i, kHeadRadius - 0.9 * core::pow(1.0 - i / 8.0, 2.0)});
    addRounding(head, 10.4, kHeadRadius, kHeadHeight, 4.2, 11);
    return head;
}

std::vector<Station> buttonStations() {
    std::vector<Station> button{{-0.4, 3.6}, {0.6, 3.6}, {0.8, 3.5}};
    addRounding(button, 0.9, 3.3, 1.5, 0.6, 8);
    return button;
}

/// The convex hull of stations turned about their axis, from its lowest point at z = 0.
std::shared_ptr<const Bur> hullOf(const char* name, std::vector<Station> stations, double& lowest) {
    std::sort(stations.begin(), stations.end(), [](const Station& a, const Station& b) {
        return a.along != b.along ? a.along < b.along : a.radius > b.radius;
    });
    std::vector<core::Vec2> hull;  // of (radius, along), upwards: the outer chain
    for (const Station& s : stations) {
        const core::Vec2 p(s.radius, s.along);
        if (!hull.empty() && p.y() == hull.back().y()) continue;
        while (hull.size() > 1) {
            const core::Vec2 u = hull.back() - hull[hull.size() - 2], v = p - hull.back();
            if (u.x() * v.y() - u.y() * v.x() > 0.0) break;
            hull.pop_back();
        }
        hull.push_back(p);
    }
    // Corners that hardly stand out go: each is a sheet of the medial axis.
    for (std::size_t i = 1; i + 1 < hull.size();) {
        const core::Vec2 chord = (hull[i + 1] - hull[i - 1]).normalized(), to = hull[i] - hull[i - 1];
        if (std::abs(chord.x() * to.y() - chord.y() * to.x()) < kBlunt)
            hull.erase(hull.begin() + static_cast<std::ptrdiff_t>(i));
        else
            ++i;
    }
    lowest = hull.front().y();
    Profile profile;
    core::Vec2 last(0.0, 0.0);
    hull.emplace_back(0.0, hull.back().y());
    for (core::Vec2 p : hull) {
        p.y() -= lowest;
        if ((p - last).norm() > 0.0) profile.pieces.push_back({last, p});
        last = p;
    }
    return std::make_shared<const Bur>(name, std::move(profile));
}

/// The turn that brings z to a direction.
core::Quat turnTo(const Vec3& along) {
    const Vec3 z = Vec3::UnitZ();
    const core::Quat turn(1.0 + z.dot(along), z.cross(along).x(), z.cross(along).y(), z.cross(along).z());
    return turn.normalized();  // none of them points down
}

}  // namespace

TriangleMesh turbineMesh(double burReachMm) {
    if (!std::isfinite(burReachMm))
        throw core::Error("the bur must stand a finite length out of the head", std::to_string(burReachMm));
    TriangleMesh mesh;
    const auto above = [&](double bottom) {
        return [=](double along) { return upright({0.0, 0.0, burReachMm + bottom + along}); };
    };

    const std::vector<Station> head = headStations();
    addTube(mesh, head, kAround, above(0.0));

    const std::vector<Station> button = buttonStations();
    addTube(mesh, button, kAround, above(kHeadHeight));

    addTube(mesh, {{-0.9, 1.2}, {-0.8, 1.3}, {-0.5, 1.4}, {-0.3, 1.4}, {-0.2, 1.6}, {0.5, 1.6}}, kAround, above(0.0));

    const Vec3 neck(0.0, 0.0, burReachMm + kNeckHeight);
    const auto onHandle = [&](double s) { return handleAt(neck, s); };
    addTube(mesh, handleStations(), kAround, onHandle);

    std::vector<Station> coupling{{kHandleEnd - 0.8, 5.2}, {kHandleEnd - 0.6, 5.5}};
    for (int i = 0; i < 3; ++i)
        for (const Station& s : {Station{0.0, 5.5}, {0.1, 5.2}, {0.5, 5.2}, {0.6, 5.5}})
            coupling.push_back({kHandleEnd + 1.0 * i + s.along, s.radius});
    addTube(mesh, coupling, kAround, onHandle);
    std::vector<Station> connector;
    for (int i = 0; i < 9; ++i)
        connector.push_back({kHandleEnd + 2.2 + i, i % 2 == 0 ? 4.2 : 4.5});
    connector.push_back({kHandleEnd + 11.0, 3.9});
    addTube(mesh, connector, kAround, onHandle);

    // Three spray ports round the bur, and the light between them and the neck.
    for (const double turn : {0.5, 1.0, 1.5}) {
        const double angle = std::numbers::pi * turn;
        const Vec3 foot(2.3 * core::cos(angle), 2.3 * core::sin(angle), burReachMm - 0.12);
        addTube(mesh, {{0.0, 0.3}, {0.6, 0.35}}, kSmallAround,
                [&](double along) { return upright(foot + along * Vec3::UnitZ()); });
    }
    addTube(mesh, {{0.0, 0.8}, {1.2, 0.9}}, kSmallAround, [&](double along) {
        return upright({4.6, 0.0, burReachMm + 2.4 + along});
    });

    for (int row = 0; row < kGripRows; ++row) {
        const double s = kGripStart + (kGripEnd - kGripStart) * row / (kGripRows - 1);
        const Frame f = handleAt(neck, s);
        for (int j = 0; j < kGripAround; ++j) {
            const double angle = 2.0 * std::numbers::pi * (j + 0.5 * (row % 2)) / kGripAround;
            const Vec3 out = core::cos(angle) * f.side + core::sin(angle) * f.up;
            addGripPoint(mesh, f.place + handleRadius(s) * out, out, f.along);
        }
    }
    return mesh;
}

std::vector<BodyPiece> bodyPieces(const Bur& bur, double burReachMm) {
    if (!std::isfinite(burReachMm))
        throw core::Error("the bur must stand a finite length out of the head", std::to_string(burReachMm));
    std::vector<BodyPiece> pieces;
    double lowest = 0.0;
    if (const double top = bur.lengthMm(); top < burReachMm - 0.1) {
        const double wide = std::min(top + kShankWidens, burReachMm);
        double radius = 0.0;  // of the bur's upper end
        for (const ProfilePiece& piece : bur.profile().pieces)
            for (const core::Vec2& p : {piece.from, piece.to})
                if (p.y() > top - 0.05) radius = std::max(radius, p.x());
        std::vector<Station> shank{{top, std::min(radius, kShankNeck)}, {wide, kShankRadius}};
        if (wide < burReachMm) shank.push_back({burReachMm, kShankRadius});
        auto solid = hullOf("shank", std::move(shank), lowest);
        pieces.push_back({std::move(solid), {Vec3(0.0, 0.0, lowest), core::Quat::Identity()}, BodyPart::shank});
    }
    std::vector<Station> head = headStations();
    for (const Station& s : buttonStations())
        head.push_back({kHeadHeight + s.along, s.radius});
    auto solid = hullOf("head", std::move(head), lowest);
    pieces.push_back({std::move(solid), {Vec3(0.0, 0.0, burReachMm + lowest), core::Quat::Identity()}, BodyPart::head});
    // Neck and handle: chords of their axis, short where it bends.
    const Vec3 neck(0.0, 0.0, burReachMm + kNeckHeight);
    constexpr double kBends = kBendRadius * kBendRad;
    const double ends[] = {
        2.0,       kNeckLength, kNeckLength + kBends / 3.0, kNeckLength + 2.0 * kBends / 3.0, kNeckLength + kBends,
        kHandleEnd};
    for (int i = 0; i < 5; ++i) {
        const Vec3 from = handleAt(neck, ends[i]).place,
                   along = (handleAt(neck, ends[i + 1]).place - from).normalized();
        std::vector<Station> stations;
        constexpr int kSteps = 24;
        for (int k = 0; k <= kSteps; ++k) {
            const double s = ends[i] + (ends[i + 1] - ends[i]) * k / kSteps;
            stations.push_back({(handleAt(neck, s).place - from).dot(along), handleRadius(s)});
        }
        auto tube = hullOf("handle", std::move(stations), lowest);
        pieces.push_back({std::move(tube), {from + lowest * along, turnTo(along)}, BodyPart::handle});
    }
    return pieces;
}

}  // namespace handpiece::instrument
