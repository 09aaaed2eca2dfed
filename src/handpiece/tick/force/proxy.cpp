// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/proxy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "handpiece/base/core/rotation.h"

namespace handpiece::force {
namespace {

using core::Vec3;

constexpr double kSettledMm = 1e-5;  // 5 uN at 0.5 N/mm: what is left is walked in the next ticks
// On a surface that cutting has left. Half-spaces are exact to the square of a step over the bur's diameter there, and
// smoother than the field: a small step is trusted, and looked at in the next tick.
constexpr double kTrustedStepMm = 0.01;
// A bur that lies in its own cavity is held on all sides by half-spaces a micron apart: where they meet jumps by ten.
// So there the proxy slides little farther in a tick than the device moved, and mends no micron by a hop.
constexpr double kFollow = 1.25, kCreepMm = 0.001;
constexpr double kYieldingSlack = 0.2, kFirmSlack = 1e-3;
constexpr double kMinReachMm = 0.04;
constexpr double kLeverMm = 5.0;  // a turn moves points of the head by at most this times the angle
constexpr double kSmallestRadiusMm = 1e-6;
constexpr double kMaxRestoreMm = 0.5;  // of one pass: gaps farther inside are rough
constexpr int kPushOutPasses = 24;
// A half-space met a little way off is believed less and less, as if the bur rolled over an edge: a plane that is
// believed too little is found again by the next pass, one believed too much would hold the bur off for good.
constexpr double kRecallMm = 0.15;
constexpr double kRecallRadiusMm = 0.25;
constexpr double kSameNormal = 0.998;  // 3.6 degrees: the newer replaces the older

Vec3 limited(const Vec3& v, double length) noexcept {
    const double n = v.norm();
    return n > length ? Vec3(v * (length / n)) : v;
}

}  // namespace

/// Constraints at the proxy; the smallest gap among them, or the reach when there is none.
double Proxy::evaluate(contact::Method& method) noexcept {
    const double reach = reachMm_;
    method.constraints(pose_, reach, constraints_);
    ++passes_;
    // The exact depth joins them, so that the bur rests on edges between its points, and rolls over them without
    // notches; and since it names but one of two walls at a time, so do its answers from nearby.
    const contact::Depth depth = method.depth(pose_);
    for (contact::Constraint& c : constraints_)
        c.gapMm += depth.slackMm;
    clearanceMm_ = depth.slackMm - depth.depthMm;
    const bool near = depth.status == contact::Status::ok && clearanceMm_ <= reach;
    const contact::Constraint exact{depth.normal, clearanceMm_, depth.toothPointMm, depth.tissue,
                                    depth.tooth,  depth.piece,  depth.isHeldOnly};
    if (near) {
        // A full set keeps its most important first: the last make room.
        const std::size_t room = contact::kMaxConstraints - 1 - memory_.size();
        if (constraints_.size() > room) constraints_.resize(room);
        constraints_.pushBack(exact);
    }
    gapMm_ = reach;
    for (const contact::Constraint& c : constraints_)
        gapMm_ = std::min(gapMm_, c.gapMm);
    if (near) {
        recall();
        remember(exact);
    } else {
        memory_.clear();
    }
    return gapMm_;
}

/// Adds the half-spaces met nearby, carried along with the bur's point that met them; forgets those met too far away.
void Proxy::recall() noexcept {
    std::size_t kept = 0;
    for (const Memory& m : memory_) {
        contact::Constraint carried = m.constraint;
        carried.pointMm = pose_.apply(m.at.applyInverse(m.constraint.pointMm));
        const Vec3 way = carried.pointMm - m.constraint.pointMm;
        const double closer = carried.normal.dot(way), squared = way.squaredNorm();
        if (squared > kRecallMm * kRecallMm) continue;
        carried.gapMm += closer + (squared - closer * closer) / (2.0 * kRecallRadiusMm);
        constraints_.pushBack(carried);
        memory_[kept++] = m;
    }
    memory_.resize(kept);
}

void Proxy::remember(const contact::Constraint& exact) noexcept {
    std::size_t slot = memory_.size();
    for (std::size_t i = 0; i < memory_.size(); ++i) {
        if (memory_[i].constraint.normal.dot(exact.normal) > kSameNormal) slot = i;
    }
    if (slot == memory_.capacity()) {
        // Full: the one that is farthest from holding the proxy goes.
        const auto gapNow = [&](const Memory& m) {
            return m.constraint.gapMm + m.constraint.normal.dot(pose_.positionMm - m.at.positionMm);
        };
        slot = 0;
        for (std::size_t i = 1; i < memory_.size(); ++i) {
            if (gapNow(memory_[i]) > gapNow(memory_[slot])) slot = i;
        }
    } else if (slot == memory_.size()) {
        memory_.resize(slot + 1);
    }
    memory_[slot] = {exact, pose_};
}

/// Out of the tooth by the shortest way the constraints know, for poses that no path led to.
void Proxy::settleOutside(contact::Method& method) noexcept {
    for (int i = 0; i < kPushOutPasses && evaluate(method) < -settings_.toleranceMm; ++i) {
        pose_.positionMm += limited(project(constraints_, Vec3::Zero()).stepMm, kMaxRestoreMm);
    }
}

void Proxy::start(contact::Method& method, const core::Pose& deviceInTooth) noexcept {
    pose_ = deviceInTooth;
    lastDevice_ = deviceInTooth;
    reachMm_ = 2.0 * settings_.maxStepMm;
    radiusMm_ = settings_.maxStepMm;
    touching_ = false;
    passes_ = 0;
    memory_.clear();
    method.reset();
    // Deep inside only the depth knows the way out.
    for (int i = 0; i < kPushOutPasses; ++i) {
        const contact::Depth d = method.depth(pose_);
        if (d.status == contact::Status::invalidPose || d.depthMm <= settings_.toleranceMm) break;
        pose_.positionMm += d.depthMm * d.normal;
    }
    settleOutside(method);
}

/// A step towards `wanted` when nothing holds it back: as far as the clearance at the proxy proves free.
Vec3 Proxy::freeStep(const Vec3& wanted, const Projection& allowed) const noexcept {
    const double known = 0.5 * reachMm_;
    if (allowed.activeCount > 0 || wanted.norm() <= known) return allowed.stepMm;
    return limited(wanted, std::max(known, clearanceMm_ - settings_.toleranceMm));
}

/// Of a tick: enough for a millisecond's way, and never so few that a corner cannot be settled in.
int Proxy::passesIn(double periodS) const noexcept {
    constexpr double kFullS = 1e-3;
    constexpr int kLeast = 4;
    const double share = settings_.iterations * std::clamp(periodS / kFullS, 0.0, 1.0);
    return std::max(std::min(kLeast, settings_.iterations), static_cast<int>(std::lround(share)));
}

void Proxy::noteWhatHolds(const Projection& allowed) noexcept {
    touching_ = allowed.activeCount > 0;
    double strongest = 0.0, strongestBehind = 0.0, all = 0.0, behind = 0.0;
    Vec3 moment = Vec3::Zero(), push = Vec3::Zero(), cutPush = Vec3::Zero();
    isHeldOnly_ = false;
    for (int j = 0; j < allowed.activeCount; ++j) {
        const contact::Constraint& held = constraints_[allowed.active[j]];
        const double share = allowed.multiplierMm[j];
        if (share > strongest) {
            strongest = share;
            strongestTissue_ = held.tissue;
        }
        all += std::max(share, 0.0);
        push += share * held.normal;
        if (!held.isHeldOnly) cutPush += share * held.normal;
        isHeldOnly_ = isHeldOnly_ || (held.isHeldOnly && share > 0.0);
        if (held.piece == contact::Piece::bur || !(share > 0.0)) continue;
        behind += share;
        moment += share * held.pointMm;
        if (share > strongestBehind) {
            strongestBehind = share;
            strongestBehind_ = held.piece;
        }
    }
    const double pushed = push.norm();
    cutShare_ = pushed > 0.0 ? Vec3(cutPush / pushed) : Vec3(Vec3::Zero());
    behindShare_ = behind > 0.0 ? behind / all : 0.0;
    if (behind > 0.0) behindPointMm_ = moment / behind;
}

void Proxy::update(contact::Method& method, const core::Pose& deviceInTooth, const contact::Depth& depthAtDevice,
                   double periodS) noexcept {
    const Vec3 target = deviceInTooth.positionMm;
    // A bur that hardly moves need not look far around itself; steps that want more reach farther pass by pass.
    const double moved = (target - lastDevice_.positionMm).norm() +
                         kLeverMm * core::angleBetween(deviceInTooth.orientation, lastDevice_.orientation);
    reachMm_ = std::clamp(4.0 * moved, kMinReachMm, 2.0 * settings_.maxStepMm);
    lastDevice_ = deviceInTooth;
    pose_.orientation = deviceInTooth.orientation;
    passes_ = 0;
    // Half-spaces of tissue that may be gone hold nothing back.
    const std::uint64_t version = method.toothVersion();
    if (version != toothVersion_) memory_.clear();
    toothVersion_ = version;
    strongestTissue_ = cases::Tissue::none;
    behindShare_ = 0.0;
    isHeldOnly_ = false;
    // A ball of that radius about the device is free, and the proxy lies in it.
    if (-depthAtDevice.depthMm > (target - pose_.positionMm).norm()) {
        pose_.positionMm = target;
        memory_.clear();
        touching_ = false;
        radiusMm_ = settings_.maxStepMm;
        gapMm_ = -depthAtDevice.depthMm;
        return;
    }
    touching_ = false;
    const bool isCutNear = method.isCutNear(pose_);
    if (!isCutNear) lastRest_.setZero();  // in its cavity the bur trembles from tick to tick, else from pass to pass
    Vec3 safe = pose_.positionMm;
    double safeGap = -std::numeric_limits<double>::infinity();
    bool settled = false;
    const double settledMm = isCutNear ? kTrustedStepMm : kSettledMm;
    const double leastMm = isCutNear ? std::max(moved, kSmallestRadiusMm) : kSmallestRadiusMm;
    double leftMm = isCutNear ? kFollow * moved + kCreepMm : std::numeric_limits<double>::infinity();
    const int passes = passesIn(periodS);
    for (int i = 0; i < passes && !settled; ++i) {
        const double gap = evaluate(method);
        if (gap >= std::min(safeGap, -settings_.toleranceMm)) {
            safe = pose_.positionMm;
            safeGap = gap;
        }
        const Vec3 wanted = target - pose_.positionMm;
        const Projection allowed = project(constraints_, wanted);
        noteWhatHolds(allowed);
        Vec3 step = freeStep(wanted, allowed);
        if (touching_) {
            const double slack = isCutNear ? kYieldingSlack : kFirmSlack;
            const Vec3 restore = gap < 0.0 ? limited(project(constraints_, Vec3::Zero(), slack).stepMm, kMaxRestoreMm)
                                           : Vec3(Vec3::Zero());
            Vec3 rest = step - restore;
            radiusMm_ = rest.dot(lastRest_) < 0.0 ? std::max(0.4 * radiusMm_, leastMm)
                                                  : std::min(2.0 * radiusMm_, settings_.maxStepMm);
            const double known = 0.5 * reachMm_;
            if (rest.norm() > known) reachMm_ = std::min(2.0 * reachMm_, 2.0 * settings_.maxStepMm);
            rest = limited(rest, std::min({radiusMm_, known, leftMm}));
            leftMm -= rest.norm();
            lastRest_ = rest;
            step = restore + rest;
        } else {
            radiusMm_ = settings_.maxStepMm;
            reachMm_ = std::min(2.0 * reachMm_, 2.0 * settings_.maxStepMm);
        }
        pose_.positionMm += step;
        settled = step.norm() < settledMm;
    }
    if (settled) return;
    for (int i = 0; i < 2 && evaluate(method) < -settings_.toleranceMm; ++i) {
        pose_.positionMm += limited(project(constraints_, Vec3::Zero()).stepMm, kMaxRestoreMm);
    }
    if (gapMm_ < -settings_.toleranceMm && evaluate(method) < std::min(safeGap, -settings_.toleranceMm)) {
        pose_.positionMm = safe;
        gapMm_ = safeGap;
    }
}

}  // namespace handpiece::force
