// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/force_model.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "handpiece/base/core/portable_math.h"

namespace handpiece::force {
namespace {

using core::Vec3;

constexpr double kDeepStartMm = 0.1;       // a bur that starts deeper than this gets its force faded in
constexpr double kSurelyInMm = 0.3;        // of a bur that waits until it is clear
constexpr double kShareTauS = 0.01;        // with which the feel of a cut surface follows its tissues
constexpr double kTangentialTauS = 0.003;  // of the turning bur's sideways force: it swings round with the wall
constexpr double kShallowMm = 1e-9;        // below it a direction cannot be told

}  // namespace

ForceModel::ForceModel(const Limits& limits, const Parameters& parameters)
    : limits_(limits), parameters_(parameters), laws_(makeLaws()), proxy_(parameters.proxy) {
    validate(parameters);
    law_ = laws_.at(static_cast<std::size_t>(parameters.law)).get();
}

void ForceModel::setParameters(const Parameters& parameters) noexcept {
    parameters_ = parameters;
    proxy_.setSettings(parameters.proxy);
    ForceLaw* const law = laws_[std::min(static_cast<std::size_t>(parameters.law), laws_.size() - 1)].get();
    if (law != law_) law->reset();
    law_ = law;
}

const Touch& ForceModel::feel(contact::Method& method, const core::Pose& read, bool lost, double periodS) noexcept {
    const bool passesGingiva = std::exchange(passesGingiva_, false);
    guard_.look(read, lost, periodS, parameters_.fadeInS);
    if (guard_.faulted()) return touch_;
    touch_.deviceInTooth = guard_.pose();
    touch_.depth = waiting_ ? method.depthUpTo(kSurelyInMm, touch_.deviceInTooth) : method.depth(touch_.deviceInTooth);
    if (waiting_ && touch_.depth.depthMm <= 0.0) waiting_ = false;
    const bool released = wasWaiting_ && !waiting_;
    const bool fresh = guard_.startsAnew() || released;
    wasWaiting_ = waiting_;
    touch_.proxyInTooth = touch_.deviceInTooth;
    touch_.touching = touch_.depth.depthMm > 0.0;
    touch_.tissue = touch_.touching ? touch_.depth.tissue : cases::Tissue::none;
    touch_.tooth = touch_.depth.tooth;
    touch_.neighbour = 0;
    touch_.passes = 0;
    touch_.behindShare = 0.0;
    touch_.isHeldOnly = false;
    touch_.behind = contact::Piece::bur;
    touch_.patches = contact::PatchSet{};
    touch_.soft.clear();
    if (fresh && (released || touch_.depth.depthMm > kDeepStartMm)) guard_.fadeIn();
    updateVelocity(touch_.deviceInTooth.positionMm, fresh, periodS);
    if (fresh) law_->reset();
    if (waiting_) {
        proxy_.follow(touch_.deviceInTooth);
        touch_.touching = false;
        touch_.tissue = cases::Tissue::none;
        return touch_;
    }
    if (!law_->usesProxy()) {
        proxy_.follow(touch_.deviceInTooth);
        return touch_;
    }
    if (fresh) proxy_.start(method, touch_.deviceInTooth);
    proxy_.update(method, touch_.deviceInTooth, touch_.depth, periodS);
    touch_.proxyInTooth = proxy_.pose();
    touch_.touching = proxy_.touching();
    touch_.passes = proxy_.passes();
    if (!passesGingiva) method.yielding(touch_.proxyInTooth, touch_.soft);
    touch_.tissue = proxy_.strongestTissue();
    if (touch_.touching && proxy_.isHeldOnly()) {
        touch_.isHeldOnly = true;
        touch_.cutShare = proxy_.cutShare();
        touch_.behindShare = proxy_.behindShare();
        touch_.behindPointMm = proxy_.behindPointMm();
        touch_.behind = proxy_.strongestBehind();
    }
    if (touch_.touching) {
        method.patches(touch_.proxyInTooth, touch_.patches);
        smoothShares(method.isCutNear(touch_.proxyInTooth), periodS);
        if (!touch_.patches.patches.empty()) touch_.tooth = touch_.patches.patches[0].tooth;  // bears most
        for (const contact::Patch& patch : touch_.patches.patches)
            if (touch_.neighbour == 0) touch_.neighbour = patch.tooth;
        double most = 0.0;
        for (std::size_t i = 0; i < cases::kTissueCount; ++i) {
            if (touch_.patches.tissueShare[i] > most) {
                most = touch_.patches.tissueShare[i];
                touch_.tissue = static_cast<cases::Tissue>(i);
            }
        }
    }
    return touch_;
}

void ForceModel::smoothShares(bool isCutNear, double periodS) noexcept {
    // In its own cavity a whole ring of the bur comes from one tissue into another at once.
    std::array<double, cases::kTissueCount>& shares = touch_.patches.tissueShare;
    if (isCutNear && wasTouching_) {
        const double news = periodS / (kShareTauS + periodS);
        for (std::size_t i = 0; i < cases::kTissueCount; ++i)
            shares[i] = lastShares_[i] + news * (shares[i] - lastShares_[i]);
    }
    lastShares_ = shares;
}

void ForceModel::updateVelocity(const Vec3& positionMm, bool fresh, double periodS) noexcept {
    if (fresh) {
        velocityMmS_.setZero();
    } else {
        const Vec3 raw = (positionMm - lastPositionMm_) / periodS;
        velocityMmS_ += periodS / (parameters_.velocityTauS + periodS) * (raw - velocityMmS_);
    }
    lastPositionMm_ = positionMm;
}

Vec3 ForceModel::frictionForce(const Touch& touch, const Vec3& pressN, const Turning& turning) noexcept {
    const Vec3 proxy = touch.proxyInTooth.positionMm;
    const Vec3 moved = wasTouching_ ? Vec3(proxy - lastProxyMm_) : Vec3(Vec3::Zero());
    lastProxyMm_ = proxy;
    const double press = pressN.norm();
    wasTouching_ = touch.touching && press > 0.0;
    const KelvinVoigt kv = couplingOf(inputOf(touch));
    if (!wasTouching_ || kv.stiffnessNPerMm <= 0.0) {
        bristleMm_.setZero();
        return Vec3::Zero();
    }
    const Vec3 normal = pressN / press;
    const auto alongSurface = [&](const Vec3& v) { return Vec3(v - normal * normal.dot(v)); };
    // Friction points against the slip of surface on surface: of a turning bur the hand's share of that is small.
    const double slide = alongSurface(velocityMmS_).norm();
    const double share = turning.surfaceSpeedMmS > 0.0 ? slide / core::hypot(slide, turning.surfaceSpeedMmS) : 1.0;
    const double limit = parameters_.frictionMultiplier * kv.friction * share * press / kv.stiffnessNPerMm;
    bristleMm_ = alongSurface(bristleMm_ + moved);
    const double length = bristleMm_.norm();
    if (length > limit) bristleMm_ *= limit / length;
    return -kv.stiffnessNPerMm * bristleMm_;
}

Vec3 ForceModel::softN(const contact::SoftTouch& soft) const noexcept {
    const TissueFeel& feel = parameters_.tissues[static_cast<std::size_t>(soft.tissue)];
    const double k =
        std::min(1.0, feel.stiffnessFraction * parameters_.stiffnessMultiplier) * limits_.maxStiffnessNPerMm;
    const double b = std::min(feel.dampingNSPerMm * parameters_.dampingMultiplier, limits_.maxDampingNSPerMm);
    // It pushes and never pulls.
    return std::max(0.0, k * soft.depthMm - b * velocityMmS_.dot(soft.normal)) * soft.normal;
}

Vec3 ForceModel::torqueAboutGrip(const Touch& touch, const Vec3& forceN) const noexcept {
    const Vec3 grip = touch.proxyInTooth.apply(parameters_.gripMm);
    if (touch.behindShare > 0.0) {
        Touch ofBur = touch;
        ofBur.behindShare = 0.0;
        const Vec3 behindN = touch.behindShare * forceN;
        const Vec3 behindNmm = (touch.behindPointMm - grip).cross(behindN);
        return touch.behindShare < 1.0 ? Vec3(behindNmm + torqueAboutGrip(ofBur, forceN - behindN)) : behindNmm;
    }
    if (touch.patches.patches.empty()) {
        return touch.touching ? Vec3((touch.depth.toothPointMm - grip).cross(forceN)) : Vec3(Vec3::Zero());
    }
    // Each patch pushes along its normal by its share of the pressure; what that does not explain of the force acts at
    // all of them, so that the patches' forces add up to the force and change as smoothly as the shares.
    Vec3 mean = Vec3::Zero();
    for (const contact::Patch& p : touch.patches.patches)
        mean += p.pressureShare * p.normal;
    const double scale = forceN.dot(mean) / std::max(mean.squaredNorm(), 0.01);
    const Vec3 rest = forceN - scale * mean;
    Vec3 torque = Vec3::Zero();
    for (const contact::Patch& p : touch.patches.patches) {
        torque += (p.centreMm - grip).cross(p.pressureShare * (scale * p.normal + rest));
    }
    return torque;
}

/// Of what yields by itself, of the rest as the teeth hold it.
Vec3 ForceModel::torqueOf(const Touch& touch) const noexcept {
    if (touch.soft.empty()) return torqueAboutGrip(touch, command_.forceN);
    const double gain = guard_.gain();
    const Vec3 grip = touch.proxyInTooth.apply(parameters_.gripMm);
    Vec3 torque = torqueAboutGrip(touch, command_.forceN - gain * softN_);
    for (const contact::SoftTouch& soft : touch.soft)
        torque += (soft.pointMm - grip).cross(gain * softN(soft));
    return torque;
}

const ForceCommand& ForceModel::compute(const Touch& touch, double periodS, const Turning& turning) noexcept {
    const Vec3 last = command_.forceN;
    Vec3 wanted = Vec3::Zero();
    softN_.setZero();
    command_.forceLimited = command_.slopeLimited = false;
    command_.loadN.setZero();
    command_.bearingN.setZero();
    if (guard_.faulted()) {
        if (!wasFaulted_) heldForceN_ = last;
        wanted = guard_.gain() * heldForceN_;
        bristleMm_.setZero();
        tangentialN_.setZero();
    } else if (waiting_) {
        bristleMm_.setZero();
        tangentialN_.setZero();
    } else {
        wanted = law_->pushN(inputOf(touch));
        if (!wanted.allFinite()) wanted.setZero();
        const double press = wanted.norm();
        command_.loadN = -guard_.gain() * std::min(1.0, limits_.maxForceN / std::max(press, kShallowMm)) * wanted;
        command_.bearingN = command_.loadN;
        // What bears on the shank, the head or a tooth that is not cut does not press the bur into what is.
        if (touch.isHeldOnly) command_.loadN = -command_.loadN.norm() * touch.cutShare;
        if (law_->usesProxy()) wanted += frictionForce(touch, wanted, turning);
        tangentialN_ =
            touch.touching
                ? Vec3(tangentialN_ + periodS / (kTangentialTauS + periodS) * (turning.tangentialN - tangentialN_))
                : Vec3(Vec3::Zero());
        wanted += parameters_.cuttingForceMultiplier * tangentialN_;
        for (const contact::SoftTouch& soft : touch.soft)
            softN_ += softN(soft);
        if (!touch.soft.empty()) {
            wanted += softN_;
            command_.bearingN -= guard_.gain() * softN_;
        }
        const double size = wanted.norm();
        command_.forceLimited = size > limits_.maxForceN;
        if (command_.forceLimited) wanted *= limits_.maxForceN / size;
        wanted *= guard_.gain();
    }
    wasFaulted_ = guard_.faulted();
    const Vec3 change = wanted - last;
    const double most = limits_.maxForceSlopeNPerS * periodS;
    command_.slopeLimited = change.norm() > most;
    command_.forceN = command_.slopeLimited ? Vec3(last + change * (most / change.norm())) : wanted;
    command_.fullTorqueNmm = guard_.faulted() ? Vec3(Vec3::Zero()) : torqueOf(touch);
    const double torque = command_.fullTorqueNmm.norm();
    command_.torqueNmm = torque > limits_.maxTorqueNmm ? Vec3(command_.fullTorqueNmm * (limits_.maxTorqueNmm / torque))
                                                       : command_.fullTorqueNmm;
    return command_;
}

}  // namespace handpiece::force
