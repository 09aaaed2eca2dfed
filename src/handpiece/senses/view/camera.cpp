// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "handpiece/base/core/error.h"
#include "handpiece/model/case/fdi.h"
#include "handpiece/senses/view/occlusal.h"

namespace handpiece::view {

using core::Vec2;
using core::Vec3;

namespace {

constexpr double kNearestMm = 4.0, kFarthestMm = 400.0;
constexpr double kMargin = 0.93;  // share of the picture that a fitted box fills in the tighter direction

/// Half of the picture at distance 1.
Vec2 halfExtent(const Camera& camera, const Viewport& viewport) {
    const double y = std::tan(0.5 * camera.fieldOfViewRad);
    return {y * viewport.width / viewport.height, y};
}

std::array<Vec3, 8> cornersOf(const core::Box& box) {
    std::array<Vec3, 8> corners;
    for (int i = 0; i < 8; ++i)
        corners[static_cast<std::size_t>(i)] = {(i & 1 ? box.max : box.min).x(), (i & 2 ? box.max : box.min).y(),
                                                (i & 4 ? box.max : box.min).z()};
    return corners;
}

}  // namespace

Ray rayThrough(const Camera& camera, const Viewport& viewport, const Vec2& pixel) {
    const Vec2 half = halfExtent(camera, viewport);
    const double x = (2.0 * pixel.x() / viewport.width - 1.0) * half.x();
    const double y = (1.0 - 2.0 * pixel.y() / viewport.height) * half.y();
    return {camera.eyeMm, (camera.forward() + x * camera.right() + y * camera.upward()).normalized()};
}

std::optional<Vec2> pixelOf(const Camera& camera, const Viewport& viewport, const Vec3& pointMm) {
    const Vec3 p = pointMm - camera.eyeMm;
    const double depth = p.dot(camera.forward());
    if (!(depth > 1e-9)) return std::nullopt;
    const Vec2 half = halfExtent(camera, viewport);
    const double x = p.dot(camera.right()) / (depth * half.x()), y = p.dot(camera.upward()) / (depth * half.y());
    if (!(std::abs(x) <= 1.0 && std::abs(y) <= 1.0)) return std::nullopt;
    return Vec2(0.5 * (1.0 + x) * viewport.width, 0.5 * (1.0 - y) * viewport.height);
}

double mmPerPixel(const Camera& camera, const Viewport& viewport, const Vec3& pointMm) {
    const double depth = (pointMm - camera.eyeMm).dot(camera.forward());
    return 2.0 * depth * std::tan(0.5 * camera.fieldOfViewRad) / viewport.height;
}

Camera orbited(const Camera& camera, double rightRad, double upRad) {
    const double angle = std::hypot(rightRad, upRad);
    if (!(angle > 0.0)) return camera;
    // The eye goes the other way round than what it looks at; turns are seen the other way round in a mirror.
    const double way = camera.mirrored ? -1.0 : 1.0;
    const Vec3 axis = way * (-rightRad * camera.upward() + upRad * camera.right()) / angle;
    const Eigen::AngleAxisd turn(angle, axis);
    Camera out = camera;
    out.eyeMm = camera.targetMm + turn * (camera.eyeMm - camera.targetMm);
    out.up = (turn * camera.upward()).normalized();
    return out;
}

Camera panned(const Camera& camera, const Viewport& viewport, const Vec2& pixels) {
    const double mm = mmPerPixel(camera, viewport, camera.targetMm);
    const Vec3 shift = mm * (-pixels.x() * camera.right() + pixels.y() * camera.upward());
    Camera out = camera;
    out.eyeMm += shift;
    out.targetMm += shift;
    return out;
}

Camera zoomed(const Camera& camera, const Viewport& viewport, const Vec2& pixel, double factor,
              const std::optional<Vec3>& pointMm) {
    const double distance = camera.distanceMm();
    // An eye that is outside of the limits already is not pulled in by a zoom the other way.
    const double nearest = std::min(kNearestMm, distance), farthest = std::max(kFarthestMm, distance);
    const double scale = std::clamp(distance / factor, nearest, farthest) / distance;
    Vec3 still;
    if (pointMm) {
        still = *pointMm;
    } else {
        const Ray ray = rayThrough(camera, viewport, pixel);
        still = ray.originMm + distance / ray.direction.dot(camera.forward()) * ray.direction;
    }
    // About that point eye and target shrink alike: it stays on its line of sight, and the direction stays.
    Camera out = camera;
    out.eyeMm = still + scale * (camera.eyeMm - still);
    out.targetMm = still + scale * (camera.targetMm - still);
    return out;
}

const std::vector<std::pair<StandardView, std::string_view>>& standardViews() {
    static const std::vector<std::pair<StandardView, std::string_view>> views{
        {StandardView::occlusal, "occlusal"}, {StandardView::buccal, "buccal"}, {StandardView::lingual, "lingual"},
        {StandardView::mesial, "mesial"},     {StandardView::distal, "distal"}, {StandardView::oblique, "oblique"}};
    return views;
}

StandardView viewByName(std::string_view name) {
    std::string known;
    for (const auto& [view, knownName] : standardViews()) {
        if (name == knownName) return view;
        known += (known.empty() ? "" : ", ") + std::string(knownName);
    }
    throw core::Error("there is no view of this name", std::string(name), "there are: " + known);
}

Standing standingOf(int fdiNumber, int buccalSign) {
    return {buccalSign, cases::isUpperTooth(fdiNumber)};
}

Camera standardView(StandardView view, const core::Box& bounds, const Standing& standing, const Viewport& viewport) {
    const double buccal = standing.buccalSign < 0 ? -1.0 : 1.0;
    Vec3 from = Vec3::UnitZ(), up = standing.up();
    switch (view) {
        case StandardView::occlusal:
            up = occlusalUp(standing);
            break;
        case StandardView::buccal:
            from = {0.0, buccal, 0.0};
            break;
        case StandardView::lingual:
            from = {0.0, -buccal, 0.0};
            break;
        case StandardView::mesial:
            from = {1.0, 0.0, 0.0};
            break;
        case StandardView::distal:
            from = {-1.0, 0.0, 0.0};
            break;
        case StandardView::oblique:
            from = {0.42, 0.62 * buccal, 0.66};
            break;
    }
    Camera camera;
    camera.targetMm = bounds.isEmpty() ? Vec3::Zero() : bounds.centre();
    camera.eyeMm = camera.targetMm + from.normalized() * camera.distanceMm();
    camera.up = up;
    return fitted(camera, bounds, viewport);
}

Camera fitted(const Camera& camera, const core::Box& bounds, const Viewport& viewport) {
    if (bounds.isEmpty()) return camera;
    const Vec3 forward = camera.forward(), right = camera.right(), upward = camera.upward(), centre = bounds.centre();
    const Vec2 half = kMargin * halfExtent(camera, viewport);
    std::array<Vec3, 8> corners = cornersOf(bounds);
    for (Vec3& p : corners)
        p = Vec3((p - centre).dot(right), (p - centre).dot(upward), (p - centre).dot(forward));
    // Each corner bounds how far the eye must be back and aside; the two tightest touch both edges of the picture.
    double distance = kNearestMm;
    for (int axis = 0; axis < 2; ++axis) {
        double above = -1e300, below = -1e300;
        for (const Vec3& p : corners) {
            above = std::max(above, p[axis] - p.z() * half[axis]);
            below = std::max(below, -p[axis] - p.z() * half[axis]);
        }
        distance = std::max(distance, (above + below) / (2.0 * half[axis]));
    }
    // In the other direction there is room: the same on both sides, which moving the eye aside balances.
    Vec2 aside = Vec2::Zero();
    for (int axis = 0; axis < 2; ++axis) {
        double low = 1e300, high = -1e300;
        for (const Vec3& p : corners) {
            low = std::min(low, p[axis]);
            high = std::max(high, p[axis]);
        }
        for (int i = 0; i < 60; ++i) {
            aside[axis] = 0.5 * (low + high);
            double least = 1e300, most = -1e300;
            for (const Vec3& p : corners) {
                const double seen = (p[axis] - aside[axis]) / (p.z() + distance);
                least = std::min(least, seen);
                most = std::max(most, seen);
            }
            (least + most > 0.0 ? low : high) = aside[axis];
        }
    }
    Camera out = camera;
    out.targetMm = centre + aside.x() * right + aside.y() * upward;
    out.eyeMm = out.targetMm - distance * forward;
    out.up = upward;
    return out;
}

}  // namespace handpiece::view
