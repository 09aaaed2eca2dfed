// SPDX-License-Identifier: Apache-2.0
// Where film and tube go: bitewing and parallel technique.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/model/case/fdi.h"
#include "handpiece/senses/radiograph/radiograph.h"

namespace handpiece::radiograph {
namespace {

using core::Vec3;

constexpr double kSensorMm[2] = {36.0, 26.0};  // size 2
constexpr double kBitewingGapMm = 3.0;         ///< from the lingual side of the teeth to the detector
constexpr double kPeriapicalGapMm = 6.0;       ///< more: the sensor stands where the palate or the floor leaves room
constexpr double kMostGapMm = 15.0;            ///< however far lingual other teeth reach
constexpr double kBeyondApexMm = 2.5;
constexpr double kBelowCuspsMm = 1.0;  ///< the occlusal plane, from the highest cusp
constexpr int kLeast = 16, kMost = 8192;
constexpr double kMostPixels = 4e7;

void require(double value, double least, double most, const char* what, const char* where) {
    if (!(value >= least && value <= most))
        throw core::Error(fmt::format("{} of {:g} is not possible", what, value), where,
                          fmt::format("give {:g} to {:g}", least, most));
}

/// Of any mesh of a tooth, in the case's frame.
template <class Visit>
void eachVertex(const cases::Tooth& tooth, const core::Pose& inCase, const Visit& visit) {
    const auto all = [&](const geometry::TriangleMesh& mesh) {
        for (const Vec3& v : mesh.vertices)
            visit(inCase.apply(v));
    };
    if (!tooth.outer.triangles.empty()) {
        all(tooth.outer);
        return;
    }
    for (const cases::Part& part : tooth.parts)
        all(part.mesh);
}

struct Chosen {
    const cases::Tooth* tooth;
    core::Pose inCase;
};

Chosen choose(const cases::Case& toothCase, int fdi) {
    if (fdi == 0 || fdi == toothCase.fdiNumber) return {&toothCase, {}};
    for (const cases::PlacedTooth& other : toothCase.others)
        if (other.fdiNumber == fdi) return {&other, other.inCase};
    std::string there = toothCase.fdiNumber != 0 ? fmt::format("{}", toothCase.fdiNumber) : "";
    for (const cases::PlacedTooth& other : toothCase.others)
        if (other.fdiNumber != 0) there += fmt::format("{}{}", there.empty() ? "" : ", ", other.fdiNumber);
    throw core::Error(fmt::format("the case has no tooth {}", fdi), "--fdi",
                      there.empty() ? "leave it out: its tooth has no number" : "there are: " + there);
}

}  // namespace

View viewByName(std::string_view name) {
    for (const View view : {View::bitewing, View::periapical})
        if (name == nameOf(view)) return view;
    throw core::Error(fmt::format("there is no view called \"{}\"", name.substr(0, 60)), "--view",
                      "choose bitewing or periapical");
}

std::string_view nameOf(View view) {
    return view == View::bitewing ? "bitewing" : "periapical";
}

void check(const Settings& s) {
    if ((s.width == 0) != (s.height == 0)) throw core::Error("a size needs both sides", "--size", "write 1200x866");
    if (s.width != 0)
        for (const int side : {s.width, s.height})
            if (side < kLeast || side > kMost || static_cast<double>(s.width) * s.height > kMostPixels)
                throw core::Error(
                    fmt::format("a picture of {} x {} pixels is not possible", s.width, s.height), "--size",
                    fmt::format("give {} to {} a side, {:g} million in all", kLeast, kMost, kMostPixels / 1e6));
    require(s.pixelUm, 10.0, 200.0, "a pixel [um]", "--pixel");
    require(s.kv, 50.0, 70.0, "a tube voltage [kV]", "--kv");
    require(s.filtrationMm, 0.0, 10.0, "filtration [mm aluminium]", "filtration");
    require(s.cheekMm, 0.0, 50.0, "a cheek [mm]", "cheek");
    require(s.sourceMm, 100.0, 1000.0, "a distance of the tube [mm]", "--distance");
    require(s.focalSpotMm, 0.0, 3.0, "a focal spot [mm]", "--focal-spot");
    require(s.spotPoints, 1, 64, "a number of points of the focal spot", "focal spot");
    require(s.quanta, 0.0, 1e9, "a number of quanta", "--quanta");
    require(s.blurUm, 0.0, 500.0, "a blur of the detector [um]", "--blur");
}

Projection project(const cases::Case& toothCase, const Settings& settings) {
    check(settings);
    const Chosen chosen = choose(toothCase, settings.fdiNumber);
    const cases::Tooth& tooth = *chosen.tooth;
    core::Box box;  // in its own frame
    eachVertex(tooth, {}, [&](const Vec3& p) { box.extend(p); });
    if (box.isEmpty())
        throw core::Error("the case has no surface that could be imaged", toothCase.name, "give one with an outer.stl");

    // The long axis where it is known; the crown's end of it shows where it leads.
    Vec3 axis = Vec3::UnitZ();
    if (settings.view == View::periapical)
        for (const cases::Landmark& mark : tooth.landmarks)
            if (mark.kind == cases::LandmarkKind::longAxis && mark.pointsMm.size() >= 2) {
                const Vec3 along = mark.pointsMm.back() - mark.pointsMm.front();
                if (along.norm() > 1e-6) axis = along.normalized();
                if (axis.z() < 0.0) axis = -axis;
                // One that lies down would leave no buccal side to come from.
                if (axis.z() < 0.5) axis = Vec3::UnitZ();
                break;
            }
    Vec3 buccal = tooth.buccalSign < 0 ? Vec3(-Vec3::UnitY()) : Vec3(Vec3::UnitY());
    buccal = (buccal - axis * axis.dot(buccal)).normalized();

    // Crowns of upper teeth point down in the picture, as they do in the mouth.
    const Vec3 towardsCrown = chosen.inCase.orientation * axis;
    Projection p;
    p.up = cases::isUpperTooth(tooth.fdiNumber) ? Vec3(-towardsCrown) : towardsCrown;
    const Vec3 normal = chosen.inCase.orientation * buccal;
    p.right = p.up.cross(normal).normalized();
    p.up = normal.cross(p.right).normalized();
    p.pixelMm = settings.pixelUm / 1000.0;
    p.sourceMm = settings.sourceMm;

    // Extent along the axis and across.
    double root = 1e300, crown = -1e300, lingual = 1e300, left = 1e300, right = -1e300;
    eachVertex(tooth, chosen.inCase, [&](const Vec3& v) {
        root = std::min(root, v.dot(towardsCrown));
        crown = std::max(crown, v.dot(towardsCrown));
        left = std::min(left, v.dot(p.right));
        right = std::max(right, v.dot(p.right));
        lingual = std::min(lingual, v.dot(normal));
    });
    // Some of it for the gap, which magnifies.
    const double need = (crown - root + kBeyondApexMm + 0.5) * 1.05;
    const bool isUpright = settings.view == View::periapical && need > kSensorMm[1];
    p.width =
        settings.width != 0 ? settings.width : static_cast<int>(std::lround(kSensorMm[isUpright ? 1 : 0] / p.pixelMm));
    p.height = settings.height != 0 ? settings.height
                                    : static_cast<int>(std::lround(kSensorMm[isUpright ? 0 : 1] / p.pixelMm));

    // Teeth beside it, where the picture shows them, keep the detector off as well.
    const double middle = 0.5 * (left + right), halfMm = 0.5 * p.width * p.pixelMm;
    double nearest = lingual;
    for (const cases::PlacedTooth& other : toothCase.others) {
        core::Box beside;
        eachVertex(other, other.inCase, [&](const Vec3& v) {
            beside.extend({v.dot(p.right), v.dot(p.up), v.dot(normal)});
        });
        if (!beside.isEmpty() && std::abs(beside.centre().x() - middle) < halfMm)
            nearest = std::min(nearest, beside.min.z());
    }
    const double gap = settings.view == View::bitewing ? kBitewingGapMm : kPeriapicalGapMm;
    const double detector = std::max(nearest - gap, lingual - kMostGapMm);

    // Points are placed as they are seen: magnified about the middle.
    const double depth = 0.5 * (lingual + chosen.inCase.apply(box.centre()).dot(normal)) - detector;
    const double magnified = p.sourceMm / (p.sourceMm - depth);
    const double halfHeight = 0.5 * p.height * p.pixelMm / magnified;
    double along = crown - kBelowCuspsMm;
    if (settings.view == View::periapical) {
        // From beyond the apex; a picture with room to spare shows it around the tooth.
        const double spare = std::max(0.0, 2.0 * halfHeight - (crown - root + kBeyondApexMm + 1.0));
        along = root - kBeyondApexMm - 0.5 * spare + halfHeight;
    }
    p.centreMm = middle * p.right + along * towardsCrown + detector * normal;
    return p;
}

}  // namespace handpiece::radiograph
