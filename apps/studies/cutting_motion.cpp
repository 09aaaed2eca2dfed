// SPDX-License-Identifier: Apache-2.0
#include "studies/cutting_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "studies/excavation.h"

namespace handpiece::studies {
namespace {

using core::Pose;
using core::Vec3;

constexpr double kSpinUpS = 0.8;  // above the tooth, before the cut
constexpr double kLayerMm = 0.3;  // of depth between two strokes
constexpr double kPlungeFeed = 1.0 / 3.0;
constexpr double kWithdrawMmS = 10.0;
constexpr int kFinalStrokes = 4, kFinalLaps = 2;
constexpr int kShoulderAngles = 72;
const Vec3 kDown(0, 0, -1);

void require(double value, double low, double high, const char* what) {
    if (!(value >= low && value <= high))
        throw core::Error(fmt::format("{} is {}", what, value), "motion", fmt::format("give {} to {}", low, high));
}

/// Poses one after the other, shank up.
class Hand {
  public:
    Hand(const Vec3& start, double pedal) : pedal_(pedal) {
        poses_.push_back({0.0, {start, core::Quat::Identity()}, pedal});
        stay(kSpinUpS);
    }
    void stay(double seconds) {
        if (seconds > 0.0) poses_.push_back({poses_.back().timeS + seconds, poses_.back().burInTooth, pedal_});
    }
    void go(const Vec3& to, double speedMmS) {
        const double way = (to - poses_.back().burInTooth.positionMm).norm();
        if (way < 1e-9) return;
        poses_.push_back({poses_.back().timeS + way / speedMmS, {to, core::Quat::Identity()}, pedal_});
    }
    /// Out of the tooth to `to`, then the foot leaves the pedal.
    [[nodiscard]] device::Motion finish(const Vec3& to) {
        go(to, kWithdrawMmS);
        device::TimedPose last = poses_.back();
        last.pedal = 0.0;
        last.timeS += 0.001;
        poses_.push_back(last);
        last.timeS += 0.2;
        poses_.push_back(last);
        return device::Motion(std::move(poses_));
    }

  private:
    double pedal_;
    std::vector<device::TimedPose> poses_;
};

Vec3 touchFrom(contact::Method& method, const Vec3& start, const Vec3& direction, double rangeMm) {
    const auto touch = firstTouch(method, {start, core::Quat::Identity()}, direction, rangeMm);
    if (!touch)
        throw core::Error(
            fmt::format("the bur meets no tooth from ({:.3f}, {:.3f}, {:.3f}) mm", start.x(), start.y(), start.z()),
            "motion", "choose a place over the tooth");
    return touch->positionMm;
}

device::Motion plunge(const Vec3& touch, double depthMm, const CuttingOptions& o) {
    const Vec3 above = touch - o.clearanceMm * kDown;
    Hand hand(above, o.pedal);
    hand.go(touch + depthMm * kDown, kPlungeFeed * o.feedMmS);
    hand.stay(o.dwellS);
    return hand.finish(above);
}

/// Strokes to and fro along x, round the outline of the cavity, deeper each time.
device::Motion classOne(const Vec3& touch, const CuttingScene& scene, double depthMm, const CuttingOptions& o) {
    const double length = o.lengthMm > 0.0 ? o.lengthMm : 4.0, width = 2.0 * scene.burRadiusMm;
    if (width > std::min(o.isthmusMm, length))
        throw core::Error(
            fmt::format("a bur {:.2f} mm wide cannot cut a cavity {:.2f} by {:.2f} mm", width, length, o.isthmusMm),
            "class-one", "take a thinner bur or a wider isthmus");
    const double x = 0.5 * (length - width), y = 0.5 * (o.isthmusMm - width);
    const Vec3 above = touch - o.clearanceMm * kDown;
    Hand hand(above, o.pedal);
    const auto round = [&](double depth) {
        const Vec3 floor = touch + depth * kDown;
        hand.go(floor + Vec3(-x, -y, 0), o.feedMmS);
        hand.go(floor + Vec3(x, -y, 0), o.feedMmS);
        hand.go(floor + Vec3(x, y, 0), o.feedMmS);
        hand.go(floor + Vec3(-x, y, 0), o.feedMmS);
        hand.go(floor + Vec3(-x, 0, 0), o.feedMmS);
        hand.go(floor + Vec3(x, 0, 0), o.feedMmS);
    };
    const int layers = static_cast<int>(std::ceil(depthMm / kLayerMm));
    for (int i = 1; i <= layers; ++i) {
        hand.go(touch + depthMm * i / layers * kDown, kPlungeFeed * o.feedMmS);
        round(depthMm * i / layers);
    }
    for (int i = 0; i < kFinalStrokes; ++i)
        round(depthMm);
    hand.go(touch + depthMm * kDown, o.feedMmS);
    hand.stay(o.dwellS);
    return hand.finish(above);
}

/// Laps round the crown at one height, farther in each time.
device::Motion crownShoulder(contact::Method& method, const CuttingScene& scene, double depthMm,
                             const CuttingOptions& o) {
    const Vec3 size = scene.toothBounds.size(), middle = scene.toothBounds.centre();
    const double far = 0.5 * core::hypot(size.x(), size.y()) + scene.burRadiusMm + 1.0;
    std::vector<Vec3> touch, inward;
    for (int i = 0; i < kShoulderAngles; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kShoulderAngles;
        inward.emplace_back(-core::cos(angle), -core::sin(angle), 0.0);
        const Vec3 start(middle.x() - far * inward.back().x(), middle.y() - far * inward.back().y(), o.heightMm);
        touch.push_back(touchFrom(method, start, inward.back(), 2.0 * far));
    }
    const Vec3 outside = touch.front() - o.clearanceMm * inward.front();
    Hand hand(outside, o.pedal);
    const auto lap = [&](double depth) {
        for (std::size_t i = 0; i <= touch.size(); ++i) {
            const std::size_t at = i % touch.size();
            hand.go(touch[at] + depth * inward[at], o.feedMmS);
        }
    };
    const int layers = static_cast<int>(std::ceil(depthMm / kLayerMm));
    for (int i = 1; i <= layers; ++i)
        lap(depthMm * i / layers);
    for (int i = 0; i < kFinalLaps; ++i)
        lap(depthMm);
    hand.stay(o.dwellS);
    return hand.finish(outside);
}

}  // namespace

const std::vector<BuiltInMotion>& cuttingMotions() {
    static const std::vector<BuiltInMotion> list{
        {"plunge", "straight down into the tooth, stay, and out"},
        {"class-one", "a class I cavity: strokes along the central fissure, deeper each time"},
        {"crown-shoulder", "laps round the crown, farther in each time"},
        {"excavate", "through the carious tissue, lesion by lesion and layer by layer, not into the pulp"},
    };
    return list;
}

void validate(const CuttingOptions& o) {
    require(o.pedal, 0, 1, "the pedal");
    require(o.depthMm, 0, 20, "the depth [mm]");
    require(o.lengthMm, 0, 30, "the length [mm]");
    require(o.isthmusMm, 0.1, 20, "the isthmus [mm]");
    require(o.heightMm, -50, 50, "the height [mm]");
    require(o.feedMmS, 1e-3, 1000, "the feed [mm/s]");
    require(o.dwellS, 0, 3600, "the dwell [s]");
    require(o.clearanceMm, 1e-3, 50, "the clearance [mm]");
    require(o.pulpGuardMm, 0, 5, "the way to the pulp [mm]");
}

device::Motion cuttingMotionByName(std::string_view name, contact::Method& method, const CuttingScene& scene,
                                   const CuttingOptions& o) {
    std::string names;
    for (const BuiltInMotion& m : cuttingMotions())
        names += fmt::format("{}{}", names.empty() ? "" : ", ", m.name);
    if (std::none_of(cuttingMotions().begin(), cuttingMotions().end(), [&](const auto& m) { return m.name == name; }))
        throw core::Error(fmt::format("no cut is called \"{}\"", name), "motion", "there are " + names);
    if (scene.toothBounds.isEmpty()) throw core::Error("the tooth has no size", "motion");
    validate(o);

    require(scene.burRadiusMm, 1e-3, 20, "the bur's radius [mm]");

    const double depth = o.depthMm > 0.0 ? o.depthMm : name == "crown-shoulder" ? 1.0 : 1.5;
    if (name == "crown-shoulder") return crownShoulder(method, scene, depth, o);
    if (name == "excavate") return planExcavation(scene, o).motion;
    const Vec3 aim = scene.toothBounds.centre();
    const Vec3 start(aim.x() + o.offsetMm.x(), aim.y() + o.offsetMm.y(), scene.toothBounds.max.z() + 1.0);
    const Vec3 touch = touchFrom(method, start, kDown, scene.toothBounds.size().z() + 2.0);
    if (name == "plunge") return plunge(touch, depth, o);
    return classOne(touch, scene, depth, o);
}

}  // namespace handpiece::studies
