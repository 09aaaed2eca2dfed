// SPDX-License-Identifier: Apache-2.0
#include "assess/measures/trials.h"

#include "support/small_molar.h"

namespace handpiece::measures::test {
namespace {

using handpiece::test::uniform;

const Vec3 kLow(-3, -2.2, -4.5), kHigh(3, 2.2, 0);
constexpr double kPulpMm = 0.5, kBallMm = 2.5;     // radii
constexpr double kBarrelMm = 4.5, kStumpMm = 4.2;  // of the cylinders of class V and crown
constexpr double kStumpTop = 4.0;
constexpr double kRidgeUnderMm = 0.2;  // where the ridge's measure begins

geometry::TriangleMesh ballMesh(double radiusMm) {
    constexpr std::uint32_t kAround = 128, kUp = 64;
    geometry::TriangleMesh mesh;
    mesh.vertices.emplace_back(0, 0, -radiusMm);
    for (std::uint32_t j = 1; j < kUp; ++j)
        for (std::uint32_t i = 0; i < kAround; ++i) {
            const double a = 2.0 * std::numbers::pi * i / kAround, b = std::numbers::pi * (double(j) / kUp - 0.5);
            mesh.vertices.push_back(radiusMm * Vec3(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)));
        }
    mesh.vertices.emplace_back(0, 0, radiusMm);
    const auto at = [](std::uint32_t i, std::uint32_t j) { return 1 + i % kAround + kAround * (j - 1); };
    const auto top = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    for (std::uint32_t i = 0; i < kAround; ++i) {
        mesh.triangles.push_back({0, at(i + 1, 1), at(i, 1)});
        for (std::uint32_t j = 1; j + 1 < kUp; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
        mesh.triangles.push_back({at(i, kUp - 1), at(i + 1, kUp - 1), top});
    }
    return mesh;
}

/// Where a function of one number turns from negative at `low` to positive at `high`.
double zeroOf(const std::function<double(double)>& f, double low, double high) {
    for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (low + high);
        (f(middle) < 0.0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// How far a shape reaches along x and y at a height.
std::pair<Vec2, Vec2> reach(const Shape& shape, double z, const Vec2& inside) {
    Vec2 low = inside, high = inside;
    for (int i = 0; i < 1440; ++i) {
        const Vec2 way(std::cos(i * std::numbers::pi / 720), std::sin(i * std::numbers::pi / 720));
        const double r = zeroOf(
            [&](double t) { return shape(Vec3(inside.x() + t * way.x(), inside.y() + t * way.y(), z)); }, 0.0, 6.0);
        low = low.cwiseMin(inside + r * way);
        high = high.cwiseMax(inside + r * way);
    }
    return {low, high};
}

/// Places of a cavity's floor between its rounded corners, in its own frame.
std::vector<Vec3> flatOf(const BoxCavity& box, const RoundedSolid& solid) {
    std::vector<Vec3> places;
    constexpr int kPieces = 80;
    for (int j = 0; j < kPieces; ++j)
        for (int i = 0; i < kPieces; ++i) {
            const double s = (i + 0.5) / kPieces, t = (j + 0.5) / kPieces;
            places.push_back((1 - s) * (1 - t) * solid.corner(0) + s * (1 - t) * solid.corner(1) +
                             (1 - s) * t * solid.corner(2) + s * t * solid.corner(3) -
                             box.radiusMm * box.floorNormal());
        }
    return places;
}

double medianIn(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0.0 : values[values.size() / 2];
}

}  // namespace

std::vector<Measured> Trial::take(const std::vector<Request>& requests) const {
    Preparation p;
    p.whole = body.model;
    p.cut = cut.get();
    p.axes = axes;
    p.landmarks = landmarks;
    p.form = form;
    p.gingiva = gingiva.get();
    const Preparation::Other other[] = {{neighbour.model, neighbourCut.get(), neighbourInTooth, 45}};
    if (neighbourCut) p.others = other;
    return measure(p, requests);
}

std::vector<Measured> Trial::judge(Table& table, std::vector<Request> more) const {
    std::vector<Request> requests;
    for (const Truth& truth : truths)
        requests.push_back(truth.request);
    requests.insert(requests.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
    std::vector<Measured> got = take(requests);
    for (std::size_t i = 0; i < truths.size(); ++i) {
        Errors& errors = table[truths[i].row];
        errors.add(got[i], truths[i].value);
        if (!got[i].value) continue;
        errors.error.back() *= truths[i].scale;
        errors.stated.back() *= truths[i].scale;
    }
    return got;
}

const char* Trial::rubric() const {
    switch (kind) {
        case Kind::classTwo:
            return "46-class-ii-mo";
        case Kind::classThree:
            return "11-class-iii";
        case Kind::classFive:
            return "33-class-v";
        case Kind::crown:
            return "46-crown";
        default:
            return "46-class-i";
    }
}

double Lab::any(double low, double high) {
    return uniform(random_, low, high);
}

Marks Lab::marks() {
    Marks marks;
    marks.amplitudeMm = any(0.0, 1.0) < 0.5 ? any(0.001, 0.008) : 0.0;
    marks.waveMm = any(0.35, 0.5);
    for (double& phase : marks.phase)
        phase = any(0.0, 6.28);
    return marks;
}

void Lab::setNeighbour(Trial& trial, double gapMm, double heightMm, double nickMm) {
    if (!ball_) ball_ = bodyOf(ballMesh(kBallMm), randomPose(random_), voxelMm_);
    trial.neighbour = *ball_;
    // Its middle stands gap and radius beside the block's mesial side.
    const core::Pose inBody{Vec3(kHigh.x() + gapMm + kBallMm, 0, heightMm), core::Quat::Identity()};
    trial.neighbourInTooth = trial.body.inGrid * inBody * ball_->inGrid.inverse();
    constexpr double kBurMm = 0.65;
    trial.neighbourCut =
        nickMm > 0.0
            ? carved(*ball_, [=](const Vec3& q) { return (q + Vec3(kBallMm + kBurMm - nickMm, 0, 0)).norm() - kBurMm; })
            : std::make_unique<tooth::ToothMirror>(ball_->model);
}

Trial Lab::make(Kind kind, bool withVolumes) {
    switch (kind) {
        case Kind::classThree:
            return classThree();
        case Kind::classFive:
            return classFive(withVolumes);
        case Kind::crown:
            return crown(withVolumes);
        case Kind::molar:
            return molar();
        default:
            return cavity(kind, {}, withVolumes);
    }
}
Trial Lab::makeRight(Kind kind, Fault fault) {
    return cavity(kind, fault, false);
}

Trial Lab::cavity(Kind kind, std::optional<Fault> fault, bool withVolumes) {
    if (!block_) block_ = bodyOf(boxMesh(kLow, kHigh), randomPose(random_), voxelMm_);
    const bool isTwo = kind == Kind::classTwo;
    Trial trial;
    trial.kind = kind;
    BoxCavity box;
    if (fault) {
        trial.askedDepthMm = any(1.5, 1.9);
        box.depthMm = trial.askedDepthMm + any(-0.1, 0.1);
        if (fault == Fault::overDeep) box.depthMm = trial.askedDepthMm + 0.3;
    } else {
        box.depthMm = any(1.2, 2.2);
    }
    box.lengthMm = any(2.0, fault ? 2.8 : 3.2);
    box.widthMm = any(1.1, isTwo ? 1.5 : 2.0);
    box.radiusMm = any(0.05, 0.3);
    for (double& angle : box.angleDeg)
        angle = fault ? any(1.0, 8.0) : any(-1.0, 12.0);
    box.tiltDeg = isTwo ? 0.0 : any(0.0, fault ? 2.0 : 5.0);
    box.tiltAzimuthRad = any(0.0, 6.28);
    const int wall = isTwo ? 0 : static_cast<int>(any(0.0, 3.999));  // that the fault is in
    if (fault ? fault == Fault::undercut : any(0.0, 1.0) < 0.3) box.angleDeg[wall] = fault ? -8.0 : any(-8.0, -5.0);
    // Where its walls at -x and +x come nearest to the outside, from its own middle.
    const auto nearest = [&](int side) {
        const RoundedSolid solid = box.solid();
        double x = box.wallAt(side, -kRidgeUnderMm);
        for (int corner = 0; corner < 4; ++corner)  // of the floor
            if ((corner & 1) == side) x = std::max(x, std::abs(solid.corner(corner).x()) + box.radiusMm);
        return x;
    };
    double shift = fault ? any(-0.05, 0.05) : any(-0.3, 0.3);
    double axial = any(1.0, 1.6), boxDepth = box.depthMm + any(0.7, 1.2), boxWidth = box.widthMm + any(0.6, 1.0);
    double boxAngle[2] = {any(0.0, 4.0), any(0.0, 4.0)};
    if (isTwo) {
        // From its distal wall to well inside the proximal box.
        box.angleDeg[1] = 0.0;
        const double distal = any(fault ? -1.5 : -1.7, -1.1), mesial = kHigh.x() - axial + 0.6;
        box.lengthMm = mesial - distal;
        shift = 0.5 * (mesial + distal);
    }
    RoundedSolid occlusal = box.solid();
    if (fault == Fault::thinRidge)
        shift =
            isTwo ? kLow.x() + 0.9 + nearest(0) : (wall % 2 == 0 ? -1.0 : 1.0) * (kHigh.x() - 0.9 - nearest(wall % 2));
    if (fault == Fault::thinRidge && isTwo) {
        // As far as before towards mesial.
        const double mesial = kHigh.x() - axial + 0.6, distal = kLow.x() + 0.9 + nearest(0) - 0.5 * box.lengthMm;
        const double longer = mesial - distal;
        box.lengthMm = longer;
        occlusal = box.solid();
        shift = 0.5 * (mesial + distal);
    }
    BoxCavity proximal;
    proximal.depthMm = boxDepth;
    proximal.radiusMm = box.radiusMm;
    proximal.widthMm = boxWidth;
    proximal.lengthMm = 2.0 + axial;
    proximal.angleDeg[0] = proximal.angleDeg[1] = 0.0;
    proximal.angleDeg[2] = boxAngle[0];
    proximal.angleDeg[3] = boxAngle[1];
    const double proximalShift = kHigh.x() - axial + 0.5 * proximal.lengthMm;
    Marks all = marks(), rough = all;
    rough.amplitudeMm = fault == Fault::roughWall ? 0.025 : 0.0;
    rough.waveMm = 0.38;
    const double wallX[2] = {shift - 0.5 * box.lengthMm, shift + 0.5 * box.lengthMm};
    const Shape smooth = [=, proximalSolid = proximal.solid()](const Vec3& p) {
        const double a = occlusal(p - shift * Vec3::UnitX());
        return isTwo ? std::min(a, proximalSolid(p - proximalShift * Vec3::UnitX())) : a;
    };
    const Shape shape = [=](const Vec3& p) {
        // Rough near the foot of one wall and everywhere over it.
        double share = 0.0;
        if (rough.amplitudeMm > 0.0) {
            const double beyond = wall < 2 ? (wall == 0 ? wallX[0] - p.x() : p.x() - wallX[1])
                                           : (wall == 2 ? -p.y() : p.y()) - 0.5 * box.widthMm;
            share = std::clamp((beyond + 0.25) / 0.1, 0.0, 1.0);
        }
        return smooth(p) + all(p) + share * rough(p);
    };
    // A pulp under the floor's middle.
    double over = fault ? any(0.65, 1.2) : any(0.3, 1.2);
    if (fault == Fault::nearPulp) over = 0.4;
    const Vec2 pulpXy(isTwo ? 0.5 * (wallX[0] + kHigh.x() - axial - 0.6) : shift, any(-0.2, 0.2));
    const double pulpZ = -zeroOf([&](double z) { return smooth(Vec3(pulpXy.x(), pulpXy.y(), -z)) - kPulpMm - over; },
                                 0.5 * box.depthMm, 6.0);
    const Vec3 pulp(pulpXy.x(), pulpXy.y(), pulpZ);
    const core::Pose inGrid = block_->inGrid;
    const field::TissueMap::PartFunction parts[] = {
        {[=](const Vec3& p) { return (inGrid.applyInverse(p) - pulp).norm() - kPulpMm; }, cases::Tissue::pulp, 1}};
    trial.body = {tooth::withTissues(*block_->model, field::TissueMap::fromFunctions(block_->model->field, parts,
                                                                                     cases::Tissue::dentine)),
                  inGrid};
    trial.axes = trial.body.axes();
    for (const double y : {kLow.y(), kHigh.y()})
        trial.landmarks.push_back(
            {cases::LandmarkKind::cuspTip, y > 0.0 ? "mesiobuccal" : "mesiolingual", {inGrid.apply(Vec3(0.3, y, 0))}});
    const double gap = isTwo ? any(0.05, 0.5) : 0.3;
    double nick = fault ? (any(0.0, 1.0) < 0.2 ? any(0.0, 0.05) : 0.0) : (any(0.0, 1.0) < 0.3 ? any(0.05, 0.3) : 0.0);
    if (fault == Fault::nickedNeighbour) nick = any(0.15, 0.3);
    const double ballZ = -0.5 * boxDepth;
    setNeighbour(trial, gap, ballZ, nick);
    trial.cut = carved(trial.body, shape);
    if (fault) return trial;

    // What is known of it.
    const bool isSmooth = all.amplitudeMm == 0.0;
    const auto add = [&](const char* what, Selection of, double value, std::string row, double scale = 1.0) {
        trial.truths.push_back({{what, std::move(of)}, value, std::move(row), scale});
    };
    const double half = -0.5 * box.depthMm;
    add("floor-depth", {}, box.depthMm, "floor-depth mm");
    // The block's sides may be nearer than its top.
    std::vector<double> shortest;
    for (const Vec3& p : flatOf(box, occlusal))
        if (const double x = p.x() + shift; !isTwo || x < kHigh.x() - axial)
            shortest.push_back(std::min({-p.z(), kHigh.y() - std::abs(p.y()), kHigh.x() - std::abs(x)}));
    add("floor-depth-shortest", {}, medianIn(shortest), "floor-depth-shortest mm");
    add("floor-tilt", {}, box.tiltDeg, "floor-tilt deg");
    if (isSmooth) add("floor-flatness", {}, 0.0, "floor-flatness mm");
    add("isthmus", side("", "median"), box.wallAt(2, half) + box.wallAt(3, half), "isthmus mm");
    // Of the narrowest place: marks make one.
    if (isSmooth)
        add("isthmus-share", {}, 100.0 * (box.wallAt(2, half) + box.wallAt(3, half)) / (kHigh.y() - kLow.y()),
            "isthmus-share %");
    const double foot = box.wallAt(0, -box.depthMm);
    add("wall-height", side("distal"), -box.floorZ(-foot, 0), "wall-height mm");
    add("wall-angle", side("distal"), box.angleDeg[0], "wall-angle deg");
    add("wall-angle", side("buccal"), box.angleDeg[3], "wall-angle deg");
    add("wall-angle", side("lingual"), box.angleDeg[2], "wall-angle deg");
    if (isSmooth) add("marginal-ridge-left", side("distal"), shift - nearest(0) - kLow.x(), "marginal-ridge-left mm");
    add("cavosurface-angle", side("distal"), 90.0 + box.angleDeg[0], "cavosurface-angle deg");
    add("roughness", {}, 1000.0 * all.rmsMm(), "roughness um");
    add("roughness", side("distal"), 1000.0 * all.rmsMm(), "roughness um");
    if (withVolumes) {
        const double removed = volumeIn(shape, Vec3(kLow.x(), kLow.y(), -boxDepth - 0.4), kHigh);
        add("removed", {}, removed, "removed %", 100.0 / removed);
        add("removed-share", {}, 100.0 * removed / ((kHigh - kLow).prod()), "removed-share %");
    }
    if (isSmooth) {
        add("remaining-dentine", {}, smooth(pulp) - kPulpMm, "remaining-dentine mm");
        const auto [low, high] = reach(shape, 0.0, Vec2(isTwo ? kHigh.x() - axial - 0.3 : shift, 0));
        if (!isTwo) {
            add("outline-extent", side("mesial"), high.x() - low.x(), "outline-extent mm");
            add("outline-extent", side("lingual"), high.y() - low.y(), "outline-extent mm");
        }
    }
    // Of a wall beside one that is undercut the corner may be, too.
    const bool isAnyUndercut = *std::min_element(std::begin(box.angleDeg), std::end(box.angleDeg)) < 0.0;
    for (int i = 0; i < 4; ++i) {
        if (isTwo && i == 1) continue;
        // The rounded corner's outermost place against the wall at the top; small ones are near the limit.
        const double t = box.angleDeg[i] * kRad;
        const double deep =
            box.wallAt(i, -box.depthMm + box.radiusMm) - box.radiusMm / std::cos(t) + box.radiusMm - box.wallAt(i, 0.0);
        constexpr const char* kSideOf[] = {"distal", "mesial", "lingual", "buccal"};
        if (isSmooth && box.tiltDeg < 2.0 && deep > 0.08)
            add("undercut-depth", side(kSideOf[i]), deep, "undercut-depth mm");
        if (!isAnyUndercut) add("undercut-depth", side(kSideOf[i]), 0.0, "undercut-depth, none mm");
    }
    add("adjacent-depth", {}, nick, nick > 0.0 ? "adjacent-depth mm" : "adjacent-depth, untouched mm");
    if (!isTwo) {
        add("marginal-ridge-left", side("mesial"), kHigh.x() - shift - nearest(1), "marginal-ridge-left mm");
        if (!isSmooth) trial.truths.pop_back();
        add("wall-angle", side("mesial"), box.angleDeg[1], "wall-angle deg");
        add("wall-height", side("buccal"), -box.floorZ(0, box.wallAt(3, -box.depthMm)), "wall-height mm");
        return trial;
    }
    add("floor-depth", side("gingival"), boxDepth, "floor-depth mm");
    add("axial-depth", side("mesial"), axial, "axial-depth mm");
    if (isSmooth) {
        add("outline-extent", side("mesial"), kHigh.x() - (shift - box.wallAt(0, 0.0)), "outline-extent mm");
        add("outline-extent", side("gingival"), boxDepth, "outline-extent mm");
        // Round the outline on the mesial side, from its middle.
        const Vec3 centre(kHigh.x() + gap + kBallMm, 0, ballZ), inside(kHigh.x(), 0, -0.5 * boxDepth);
        double least = 1e9;
        for (int i = 0; i < 2880; ++i) {
            const Vec3 way(0, std::cos(i * std::numbers::pi / 1440), std::sin(i * std::numbers::pi / 1440));
            const Vec3 p = inside + zeroOf([&](double r) { return smooth(inside + r * way); }, 0.0, 6.0) * way;
            if (p.z() < 0.0) least = std::min(least, (p - centre).norm() - kBallMm);
        }
        add("proximal-clearance", side("mesial"), least, "proximal-clearance mm");
    }
    return trial;
}

Trial Lab::classThree() {
    if (!block_) block_ = bodyOf(boxMesh(kLow, kHigh), randomPose(random_), voxelMm_);
    Trial trial;
    trial.kind = Kind::classThree;
    trial.body = *block_;
    const core::Quat& q = block_->inGrid.orientation;
    // From the palatal side: +z of the body is palatal, +y incisal.
    trial.axes = {q * Vec3::UnitZ(), q * Vec3::UnitY(), q * Vec3::UnitX(), q * -Vec3::UnitZ()};
    BoxCavity box;
    const double axial = any(0.8, 1.5);
    box.lengthMm = 2.0 + axial;
    box.widthMm = any(1.8, 3.0);
    box.depthMm = any(1.2, 2.2);
    box.radiusMm = any(0.05, 0.3);
    box.angleDeg[0] = box.angleDeg[1] = 0.0;
    for (int i : {2, 3})
        box.angleDeg[i] = any(0.0, 5.0);
    const Marks all = marks();
    const double shift = kHigh.x() - axial + 0.5 * box.lengthMm;
    const Shape shape = [=, solid = box.solid()](const Vec3& p) { return solid(p - shift * Vec3::UnitX()) + all(p); };
    setNeighbour(trial, any(0.05, 0.5), -0.5 * box.depthMm, 0.0);
    trial.cut = carved(trial.body, shape);
    const bool isSmooth = all.amplitudeMm == 0.0;
    const auto add = [&](const char* what, Selection of, double value, std::string row) {
        trial.truths.push_back({{what, std::move(of)}, value, std::move(row)});
    };
    add("axial-depth", {}, axial, "axial-depth mm");
    add("floor-depth", {}, box.depthMm, "floor-depth mm");
    add("wall-angle", side("occlusal"), box.angleDeg[3], "wall-angle deg");
    add("wall-angle", side("gingival"), box.angleDeg[2], "wall-angle deg");
    add("wall-height", side("gingival"), box.depthMm, "wall-height mm");
    if (isSmooth) {
        add("outline-extent", side("gingival"), box.wallAt(2, 0.0) + box.wallAt(3, 0.0), "outline-extent mm");
        add("outline-extent", side("buccal"), box.depthMm, "outline-extent mm");
    }
    return trial;
}

Trial Lab::classFive(bool withVolumes) {
    if (!barrel_) {
        // Its top line is z = 0, its axis along y.
        const core::Pose lie{Vec3(0, 0, -kBarrelMm),
                             core::Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX()))};
        barrel_ = bodyOf(geometry::transformed(cylinderMesh(kBarrelMm, -3.5, 3.5), lie), randomPose(random_), voxelMm_);
    }
    Trial trial;
    trial.kind = Kind::classFive;
    trial.body = *barrel_;
    const core::Quat& q = barrel_->inGrid.orientation;
    trial.axes = {q * Vec3::UnitZ(), q * Vec3::UnitY(), q * Vec3::UnitX(), q * Vec3::UnitZ()};
    const double width = any(2.8, 5.2), height = any(1.6, 3.4), deep = any(0.6, 1.5), corner = any(0.2, 0.7);
    const Marks all = marks();
    const auto outline = [=](double x, double y) {
        const double a = std::abs(x) - 0.5 * width + corner, b = std::abs(y) - 0.5 * height + corner;
        return std::hypot(std::max(a, 0.0), std::max(b, 0.0)) + std::min(std::max(a, b), 0.0) - corner;
    };
    trial.cut = carved(trial.body, [=](const Vec3& p) {
        return bothOf(std::max(outline(p.x(), p.y()), -p.z() - kBarrelMm),
                      kBarrelMm - deep - std::hypot(p.x(), p.z() + kBarrelMm)) +
               all(p);
    });
    const bool isSmooth = all.amplitudeMm == 0.0;
    const auto add = [&](const char* what, Selection of, double value, std::string row, double scale = 1.0) {
        trial.truths.push_back({{what, std::move(of)}, value, std::move(row), scale});
    };
    add("axial-depth", {}, deep, "axial-depth mm");
    add("axial-depth", side("buccal"), deep, "axial-depth mm");
    add("floor-depth-shortest", {}, deep, "floor-depth-shortest mm");
    for (const char* name : {"mesial", "distal", "occlusal", "gingival"})
        add("wall-angle", side(name), 0.0, "wall-angle deg");
    if (isSmooth) {
        add("outline-extent", side("mesial"), width, "outline-extent mm");
        add("outline-extent", side("gingival"), height, "outline-extent mm");
        if (withVolumes) {
            double removed = 0.0;
            constexpr double kCell = 0.005;
            for (double y = -0.5 * height - kCell; y < 0.5 * height + kCell; y += kCell)
                for (double x = -0.5 * width - kCell; x < 0.5 * width + kCell; x += kCell)
                    removed += std::clamp(0.5 - outline(x, y) / kCell, 0.0, 1.0) *
                               (std::sqrt(kBarrelMm * kBarrelMm - x * x) -
                                std::sqrt((kBarrelMm - deep) * (kBarrelMm - deep) - x * x));
            removed *= kCell * kCell;
            add("removed", {}, removed, "removed %", 100.0 / removed);
        }
    }
    return trial;
}

Trial Lab::crown(bool withVolumes) {
    if (!stump_) stump_ = bodyOf(cylinderMesh(kStumpMm, -2.0, kStumpTop), randomPose(random_), voxelMm_);
    Trial trial;
    trial.kind = Kind::crown;
    trial.body = *stump_;
    trial.axes = stump_->axes();
    Cone cone;
    cone.outerMm = kStumpMm;
    cone.topMm = kStumpTop;
    cone.halfDeg = any(1.0, 10.0);
    cone.widthMm = any(0.5, 1.0);
    cone.occlusalMm = any(0.8, 1.8);
    cone.chamferMm = any(0.1, 0.45);
    cone.edgeMm = any(0.05, 0.25);
    cone.tiltDeg = any(0.0, 1.0) < 0.5 ? any(2.0, 8.0) : 0.0;
    const Marks all = marks();
    trial.cut = carved(trial.body, [=](const Vec3& p) { return cone(p) + all(p); });
    const double gingiva = any(-1.0, -0.1);
    trial.gingiva = std::make_shared<geometry::TriangleTree>(
        geometry::transformed(cylinderMesh(kStumpMm + 3.0, -8.0, gingiva), stump_->inGrid));
    for (const double y : {-1.0, 1.0})
        trial.landmarks.push_back({cases::LandmarkKind::cuspTip,
                                   y > 0.0 ? "mesiobuccal" : "mesiolingual",
                                   {stump_->inGrid.apply(Vec3(0.8, y, kStumpTop))}});
    const bool isSmooth = all.amplitudeMm == 0.0;
    const auto add = [&](const char* what, Selection of, double value, std::string row, double scale = 1.0) {
        trial.truths.push_back({{what, std::move(of)}, value, std::move(row), scale});
    };
    add("occlusal-convergence", {}, 2.0 * cone.halfDeg, "occlusal-convergence deg");
    add("occlusal-convergence", side("mesial"), 2.0 * cone.halfDeg, "occlusal-convergence deg");
    add("margin-width", {}, cone.widthMm, "margin-width mm");
    add("margin-width", side("buccal"), cone.widthMm, "margin-width mm");
    add("margin-continuity", {}, 100.0, "margin-continuity %");
    add("margin-height", {}, -gingiva, "margin-height mm");
    add("margin-height", side("distal"), -gingiva, "margin-height mm");
    add("reduction", side("mesiobuccal"), kStumpTop - cone.occlusalZ(1.0), "reduction mm");
    add("reduction", side("mesiolingual"), kStumpTop - cone.occlusalZ(-1.0), "reduction mm");
    add("wall-angle", {}, cone.halfDeg, "wall-angle, crown deg");
    add("undercut-depth", {}, 0.0, "undercut-depth, none mm");
    if (cone.tiltDeg == 0.0) {
        add("reduction", side("occlusal"), cone.occlusalMm, "reduction mm");
        // The wall ends where the edge's round turns by 45 degrees.
        if (isSmooth)
            add("wall-height", {}, cone.topMm - cone.occlusalMm - cone.edgeMm * (1.0 - std::sqrt(0.5)),
                "wall-height, crown mm");
        if (withVolumes && isSmooth) {
            double removed = 0.0;
            constexpr double kCell = 0.01;
            for (double z = 0.5 * kCell; z < kStumpTop; z += kCell)
                for (double r = 0.5 * kCell; r < kStumpMm; r += kCell)
                    removed += 2.0 * std::numbers::pi * r * std::clamp(0.5 - cone(Vec3(r, 0, z)) / kCell, 0.0, 1.0);
            removed *= kCell * kCell;
            add("removed", {}, removed, "removed %", 100.0 / removed);
        }
    }
    return trial;
}

Trial Lab::molar() {
    if (!molar_) {
        const auto upright = handpiece::test::smallMolar(0.2);
        molar_ = bodyOf(upright->outer, randomPose(random_), voxelMm_);
    }
    Trial trial;
    trial.kind = Kind::molar;
    trial.body = *molar_;
    trial.axes = molar_->axes();
    const geometry::TriangleTree& tree = molar_->model->tree;
    const Vec3 up = molar_->inGrid.orientation * Vec3::UnitZ();
    const auto topOf = [&](double x, double y) {
        return 20.0 - tree.firstMeeting(molar_->inGrid.apply(Vec3(x, y, 20.0)), -up).distanceMm;
    };
    BoxCavity box;
    box.depthMm = any(1.2, 2.0);
    box.lengthMm = any(2.4, 3.6);
    box.widthMm = any(1.1, 1.6);
    box.radiusMm = any(0.05, 0.3);
    for (double& angle : box.angleDeg)
        angle = any(0.0, 10.0);
    box.tiltDeg = any(0.0, 4.0);
    box.tiltAzimuthRad = any(0.0, 6.28);
    const Vec3 at(any(-0.4, 0.4), any(-0.3, 0.3), 0.0);
    const Vec3 hang(at.x(), at.y(), topOf(at.x(), at.y()));
    const Marks all = marks();
    const auto solid = box.solid();
    trial.cut = carved(trial.body, [=](const Vec3& p) { return solid(p - hang) + all(p); });
    const bool isSmooth = all.amplitudeMm == 0.0;
    const auto add = [&](const char* what, Selection of, double value, std::string row) {
        trial.truths.push_back({{what, std::move(of)}, value, std::move(row)});
    };
    // Over the floor, out of its corners, against the uncut triangles.
    std::vector<double> along, shortest;
    for (const Vec3& place : flatOf(box, solid)) {
        const Vec3 p = hang + place;
        along.push_back(topOf(p.x(), p.y()) - p.z());
        shortest.push_back(-tree.signedDistance(molar_->inGrid.apply(p)));
    }
    add("floor-depth", {}, medianIn(along), "floor-depth, molar mm");
    add("floor-depth-shortest", {}, medianIn(shortest), "floor-depth-shortest, molar mm");
    add("floor-tilt", {}, box.tiltDeg, "floor-tilt deg");
    if (isSmooth) add("floor-flatness", {}, 0.0, "floor-flatness mm");
    add("roughness", {}, 1000.0 * all.rmsMm(), "roughness um");
    constexpr const char* kSideOf[] = {"distal", "mesial", "lingual", "buccal"};
    for (int i = 0; i < 4; ++i) {
        add("wall-angle", side(kSideOf[i]), box.angleDeg[i], "wall-angle deg");
        // Up the wall's plane to the uncut surface, all along its straight part: 0.2 mm beside the corners, which begin
        // where their round has turned by 15 degrees, is left out.
        std::vector<double> heights;
        // At the height where a wall is told from a corner the walls beside it have opened.
        const auto endAt = [&](int beside) {
            const double half = 0.5 * (i < 2 ? box.widthMm : box.lengthMm);
            const double opened = std::tan(box.angleDeg[beside] * kRad) * 0.6 * box.depthMm;
            return half - std::max(0.29 * box.radiusMm, 0.74 * box.radiusMm - opened) - 0.2;
        };
        for (double v = -endAt(i < 2 ? 2 : 0); v <= endAt(i < 2 ? 3 : 1); v += 0.02) {
            const double foot = 0.5 * (i < 2 ? box.lengthMm : box.widthMm), sign = i % 2 == 0 ? -1.0 : 1.0;
            const double floorZ = i < 2 ? box.floorZ(sign * foot, v) : box.floorZ(v, sign * foot);
            const double z = zeroOf(
                [&](double height) {
                    const double off = sign * box.wallAt(i, height);
                    const Vec3 p = hang + (i < 2 ? Vec3(off, v, height) : Vec3(v, off, height));
                    return tree.signedDistance(molar_->inGrid.apply(p));
                },
                floorZ + 0.3, 3.0);
            heights.push_back(z - floorZ);
        }
        add("wall-height", side(kSideOf[i]), medianIn(heights), "wall-height, molar mm");
    }
    return trial;
}

std::array<Finding, kFaults> findings(const Trial& trial) {
    const auto got = trial.take({{"floor-depth", {}},
                                 {"undercut-depth", {}},
                                 {"marginal-ridge-left", side("mesial")},
                                 {"marginal-ridge-left", side("distal")},
                                 {"adjacent-depth", {}},
                                 {"remaining-dentine", {}},
                                 {"roughness", {}},
                                 {"roughness", side("mesial")},
                                 {"roughness", side("distal")},
                                 {"roughness", side("buccal")},
                                 {"roughness", side("lingual")}});
    std::array<Finding, kFaults> found{};
    const auto see = [&](Fault fault, std::size_t i, double limit, bool isAbove) {
        Finding& f = found[static_cast<std::size_t>(fault)];
        f.said += (f.said.empty() ? "" : ", ") + got[i].of.side + " " +
                  (got[i].value ? std::to_string(*got[i].value) : got[i].reason);
        if (!got[i].value) return;
        const double value = *got[i].value;
        f.isFound = f.isFound || (isAbove ? value > limit : value < limit);
        f.isBorderline = f.isBorderline || std::abs(value - limit) < got[i].uncertainty;
    };
    see(Fault::overDeep, 0, trial.askedDepthMm + 0.2, true);
    see(Fault::undercut, 1, 0.02, true);
    see(Fault::thinRidge, 2, 1.0, false);
    see(Fault::thinRidge, 3, 1.0, false);
    see(Fault::nickedNeighbour, 4, 0.1, true);
    see(Fault::nearPulp, 5, 0.5, false);
    for (std::size_t i = 6; i < got.size(); ++i)
        see(Fault::roughWall, i, 9.0, true);
    return found;
}

}  // namespace handpiece::measures::test
