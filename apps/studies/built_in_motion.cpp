// SPDX-License-Identifier: Apache-2.0
#include "studies/built_in_motion.h"

#include <fmt/format.h>
#include <algorithm>

#include "handpiece/base/core/error.h"

namespace handpiece::studies {
namespace {

using core::Pose;
using core::Vec3;

constexpr double kTouchMm = 1e-4;
constexpr int kMaxTouchSteps = 2000;
constexpr int kDragSamples = 80;
const Vec3 kDown(0, 0, -1);

double inRange(double value, double low, double high, const char* what) {
    if (!(value >= low && value <= high)) {
        throw core::Error(fmt::format("{} is {}", what, value), "motion", fmt::format("give {} to {}", low, high));
    }
    return value;
}

}  // namespace

std::optional<Pose> firstTouch(contact::Method& method, const Pose& start, const Vec3& direction, double rangeMm) {
    const double length = direction.norm();
    if (!(length > 1e-9) || !start.isValid())
        throw core::Error("no start or no direction to feel along", "first touch");
    const Vec3 along = direction / length;
    method.reset();
    double travelled = 0.0;
    for (int i = 0; i < kMaxTouchSteps && travelled <= rangeMm; ++i) {
        const Pose here{start.positionMm + travelled * along, start.orientation};
        const contact::Depth d = method.depth(here);
        if (d.status == contact::Status::invalidPose) return std::nullopt;
        if (d.depthMm > -kTouchMm) return here;
        travelled += -d.depthMm;
    }
    return std::nullopt;
}

const std::vector<BuiltInMotion>& builtInMotions() {
    static const std::vector<BuiltInMotion> list{
        {"drop", "down onto the tooth and stay"},
        {"press", "down onto the tooth, stay, and up again"},
        {"slide", "down, sideways along x at one height, and up"},
        {"drag", "across cusp and fissure along x, pressed evenly into the surface"},
        {"loop", "down and around a small circle in x and z"},
        {"hold", "stay above the tooth"},
    };
    return list;
}

device::Motion motionByName(std::string_view name, contact::Method& method, const core::Box& toothBounds,
                            const MotionOptions& options) {
    std::string names;
    bool known = false;
    for (const BuiltInMotion& m : builtInMotions()) {
        known = known || m.name == name;
        names += fmt::format("{}{}", names.empty() ? "" : ", ", m.name);
    }
    if (!known)
        throw core::Error(fmt::format("no motion is called \"{}\"", name), "motion",
                          "there are " + names + ", or a CSV file");
    if (toothBounds.isEmpty()) throw core::Error("the tooth has no size", "motion");
    inRange(options.depthMm, 1e-3, 50, "the depth [mm]");
    inRange(options.speedMmS, 1e-3, 1000, "the speed [mm/s]");
    inRange(options.dwellS, 0, 3600, "the dwell [s]");
    inRange(options.clearanceMm, 1e-3, 50, "the clearance [mm]");
    inRange(options.lengthMm, 0, 100, "the length [mm]");
    inRange(options.loopRadiusMm, 1e-3, 10, "the loop's radius [mm]");

    const Vec3 size = toothBounds.size(), centre = toothBounds.centre();
    const double range = size.z() + 2.0;
    const auto feel = [&](double x, double y) {
        return firstTouch(method, {Vec3(x, y, toothBounds.max.z() + 1.0), core::Quat::Identity()}, kDown, range);
    };
    const double x = centre.x() + options.offsetMm.x(), y = centre.y() + options.offsetMm.y();
    const auto touch = feel(x, y);
    if (!touch) {
        throw core::Error(fmt::format("the bur meets no tooth below x = {:.3f}, y = {:.3f} mm", x, y), "motion",
                          "choose a place over the tooth");
    }
    const Pose start{touch->positionMm - options.clearanceMm * kDown, touch->orientation};
    const double distance = options.clearanceMm + options.depthMm;
    const double length = options.lengthMm > 0.0 ? options.lengthMm : 0.6 * size.x();
    if (name == "drop") return device::drop(start, kDown, distance, options.speedMmS, options.dwellS);
    if (name == "press") return device::press(start, kDown, distance, options.speedMmS, options.dwellS);
    if (name == "slide") return device::slide(start, kDown, distance, length * Vec3::UnitX(), options.speedMmS);
    if (name == "hold") return device::hold(start, options.dwellS > 0.0 ? options.dwellS : 1.0);
    if (name == "loop") {
        // Down to the depth first; the circle's topmost point is where it starts.
        const Pose pressed{touch->positionMm + options.depthMm * kDown, touch->orientation};
        std::vector<device::TimedPose> poses =
            device::drop(start, kDown, distance, options.speedMmS, options.dwellS).poses();
        const double begin = poses.back().timeS;
        const device::Motion circle =
            device::closedLoop(pressed, Vec3::UnitZ(), Vec3::UnitX(), options.loopRadiusMm, options.speedMmS, 2);
        for (device::TimedPose p : circle.poses()) {
            if (p.timeS <= 0.0) continue;
            p.timeS += begin;
            poses.push_back(p);
        }
        return device::Motion(std::move(poses));
    }
    std::vector<Vec3> surface;
    for (int i = 0; i <= kDragSamples; ++i) {
        const auto point = feel(x + length * (static_cast<double>(i) / kDragSamples - 0.5), y);
        if (point) surface.push_back(point->positionMm);
    }
    return device::drag(surface, touch->orientation, kDown, options.depthMm, options.clearanceMm, options.speedMmS);
}

double distanceToTouch(contact::Method& method, const core::Pose& start, const core::Vec3& direction, double reachMm) {
    // Conservative advancement: the distance there is can always be gone.
    core::Pose pose = start;
    double gone = 0.0;
    for (int i = 0; i < 1000 && gone < reachMm; ++i) {
        const contact::Depth depth = method.depth(pose);
        if (depth.depthMm >= -1e-7) return gone;
        gone += std::max(-depth.depthMm, 1e-7);
        pose.positionMm = start.positionMm + gone * direction;
    }
    if (gone < reachMm) return gone;
    throw core::Error(fmt::format("the bur meets nothing within {:.1f} mm", reachMm), "motion",
                      "the tooth's crown must point to +z: see docs/user-guide.md");
}

}  // namespace handpiece::studies
