// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/bur.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "handpiece/model/instrument/medial_axis.h"
#include "handpiece/model/instrument/piece.h"
#include "handpiece/model/instrument/shapes.h"

namespace handpiece::instrument {

using core::Vec2;

namespace {

constexpr int kMeshAround = 32;
constexpr double kMeshArcSpacingMm = 0.06;

/// Ends that meet within rounding meet exactly afterwards, so that a corner has one place.
Profile joined(Profile profile) {
    validate(profile);
    for (std::size_t i = 1; i < profile.pieces.size(); ++i)
        profile.pieces[i].from = profile.pieces[i - 1].to;
    profile.pieces.front().from.x() = 0.0;
    profile.pieces.back().to.x() = 0.0;
    return profile;
}

double surfaceSpacing(const Profile& profile) {
    return std::max(kSurfaceSpacingMm, std::sqrt(surfaceAreaMm2(profile) / kMaxSurfacePoints));
}

std::uint32_t pointsAround(double rhoMm, double spacingMm) {
    if (rhoMm < 1e-9) return 1;
    const double needed = std::ceil(2.0 * std::numbers::pi * rhoMm / spacingMm);
    return 8 * std::max(1u, static_cast<std::uint32_t>(std::ceil(needed / 8.0)));
}

std::vector<SurfaceRing> surfaceRings(const Profile& profile, double spacingMm) {
    std::vector<SurfaceRing> rings;
    const auto add = [&](const Vec2& place, Vec2 normal, double bandAreaMm2) {
        if (place.x() < 1e-9) normal = {0.0, normal.y() < 0.0 ? -1.0 : 1.0};
        normal.normalize();
        const std::uint32_t count = pointsAround(place.x(), spacingMm);
        const std::uint32_t first = rings.empty() ? 0 : rings.back().first + rings.back().count;
        rings.push_back({place.y(), place.x(), normal.x(), normal.y(), bandAreaMm2 / count, first, count});
    };
    double pendingArea = 0.0;  // of the last half step before a joint
    Vec2 pendingNormal = Vec2::Zero();
    for (const ProfilePiece& piece : profile.pieces) {
        const int steps = std::max(1, static_cast<int>(std::ceil(lengthMm(piece) / spacingMm - 1e-9)));
        const double half = 0.5 / steps;
        add(piece.from, pendingNormal - inwardNormalAt(piece, 0.0), pendingArea + turnedAreaMm2(piece, 0.0, half));
        for (int i = 1; i < steps; ++i) {
            const double t = static_cast<double>(i) / steps;
            add(pointAt(piece, t), -inwardNormalAt(piece, t), turnedAreaMm2(piece, t - half, t + half));
        }
        pendingArea = turnedAreaMm2(piece, 1.0 - half, 1.0);
        pendingNormal = -inwardNormalAt(piece, 1.0);
    }
    add(profile.pieces.back().to, pendingNormal, pendingArea);
    return rings;
}

}  // namespace

Bur::Bur(std::string name, Profile profile, geometry::TriangleMesh mesh)
    : name_(std::move(name)),
      profile_(joined(std::move(profile))),
      lengthMm_(profile_.lengthMm()),
      maxRadiusMm_(profile_.maxRadiusMm()),
      surfaceSpacingMm_(surfaceSpacing(profile_)),
      medialAxis_(instrument::medialAxis(profile_)),
      rings_(surfaceRings(profile_, surfaceSpacingMm_)),
      mesh_(std::move(mesh)) {}

Bur::Bur(std::string name, Profile profile)
    : Bur(std::move(name), profile, turnedMesh(profile, kMeshAround, kMeshArcSpacingMm)) {}

}  // namespace handpiece::instrument
