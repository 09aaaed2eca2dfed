// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/stability/passivity_controller.h"

#include <algorithm>
#include <cmath>

#include "handpiece/tick/device/units.h"

namespace handpiece::stability {
namespace {

using core::Vec3;

/// 1 N s^2/mm is 1000 kg.
using device::kKgPerUnit;
/// Of step/2 TV(F); the rest covers what the tracker does not see.
constexpr double kBudgetShare = 0.5;
constexpr double kHandVelocityTauS = 0.002;
/// A force that has stood for so long is held against by the hand.
constexpr double kHeldTauS = 0.04;
constexpr double kNoForceN2 = 1e-12;
/// The least that a hand adds to the arm's mass.
constexpr double kHandKg = 0.01;
/// From no force to all of it, after the tank was empty: no click.
constexpr double kRiseS = 0.005;
/// Of the largest stiffness: softer than any tissue that is rendered. No spring of that stiffness holds more energy.
constexpr double kSoftestShare = 0.02;
constexpr double kUsualPeriodS = 1e-3, kMinPeriodS = 1e-5;
constexpr int kHalvings = 14;
constexpr std::size_t kMaxCatchUp = 16;

}  // namespace

void PassivityController::set(const Device& device) noexcept {
    device_ = device;
    if (periodS_ > 0.0) {
        const double period = periodS_;
        periodS_ = 0.0;
        takePeriod(period);
    }
}

void PassivityController::takePeriod(double periodS) noexcept {
    if (periodS_ > 0.0 && periodS > 0.99 * periodS_) return;  // the same, or late by whole periods
    periodS_ = periodS;
    const double least = storedNmm();
    lags_ = std::min(kMaxLags, static_cast<std::size_t>(std::ceil(device_.delayS / periodS_ - 1e-6)) + 1);
    stored_.fill(std::min(0.0, least));
}

void PassivityController::restart(const Vec3& positionMm) noexcept {
    position_ = positionMm;
    velocity_.setZero();
    moved_.setZero();
    held_ = sent(0);
    ahead_.setConstant(0.5 * device_.encoderStepMm);
    behind_ = ahead_;
    for (std::size_t h = 0; h < lags_; ++h)
        stored_[h] = std::min(stored_[h], 0.0);
    started_ = true;
}

void PassivityController::push(const Vec3& force) noexcept {
    const Vec3 last = sent(0);
    head_ = (head_ + 1) & (kRing - 1);
    sent_[head_] = force;
    change_[head_] = (force - last).norm();
    quiet_ = force.isZero(0.0) && lastWanted_.isZero(0.0) ? std::min(quiet_ + 1, kRing) : 0;
}

/// A tracker that believes its own velocity as long as the encoder's step allows it.
void PassivityController::advance(const Vec3& readMm) noexcept {
    const double half = 0.5 * device_.encoderStepMm;
    const double gain = periodS_ / (kHandVelocityTauS + periodS_);
    const Vec3 last = position_;
    // What the hand holds against for long moves nothing: only a force that is new does.
    const Vec3& acting = sent(lags_ - 1);
    held_ += periodS_ / (kHeldTauS + periodS_) * (acting - held_);
    Vec3 unheld = acting - held_;
    // But a force that falls does not pull: most often the hand gives way first, and faster than its force tells.
    const double along = unheld.dot(held_), square = held_.squaredNorm();
    if (along < 0.0 && square > kNoForceN2) unheld -= along / square * held_;
    const Vec3 push = kKgPerUnit / (device_.massKg + kHandKg) * unheld;
    velocity_ += periodS_ * push;
    for (int k = 0; k < 3; ++k) {
        const double expected = position_[k] + periodS_ * (velocity_[k] - 0.5 * periodS_ * push[k]);
        const double known = std::clamp(expected, readMm[k] - half, readMm[k] + half);
        velocity_[k] += gain * (known - expected) / periodS_;
        position_[k] = known;
        ahead_[k] = readMm[k] + half - known;
        behind_[k] = known - (readMm[k] - half);
    }
    moved_ = position_ - last;
}

/// What the forces that acted over the last period have done.
void PassivityController::settle() noexcept {
    const double spring = 0.5 / (kSoftestShare * device_.stiffnessNPerMm);
    for (std::size_t h = 0; h < lags_; ++h) {
        const std::size_t at = (head_ - h) & (kRing - 1);
        stored_[h] += kBudgetShare * 0.5 * device_.encoderStepMm * change_[at] - sent_[at].dot(moved_);
        // What was taken in by cutting and rubbing is gone: only what a spring could give back stays.
        const double most = std::max(sent_[at].squaredNorm(), lastWanted_.squaredNorm());
        stored_[h] = std::min(stored_[h], spring * most + device_.encoderStepMm * change_[at]);
    }
    // Out of contact nothing is left over for the next.
    if (quiet_ > lags_ + 1)
        for (std::size_t h = 0; h < lags_; ++h)
            stored_[h] = std::min(stored_[h], 0.0);
}

double PassivityController::share(const Vec3& wantedN) const noexcept {
    if (wantedN.isZero(0.0)) return 1.0;
    const double perMass = 0.5 * kKgPerUnit / device_.massKg, budget = kBudgetShare * 0.5 * device_.encoderStepMm;
    const Vec3 last = sent(0);
    double share = 1.0;
    Vec3 pending = Vec3::Zero();
    double variation = 0.0;
    for (std::size_t h = 0; h < lags_; ++h) {
        if (h > 0) {
            const std::size_t at = (head_ - (h - 1)) & (kRing - 1);
            pending += periodS_ * sent_[at];
            variation += change_[at];
        }
        // The arm may be anywhere within the encoder's step: as far along the force that acts as that allows.
        double hidden = 0.0;
        const Vec3& acting = sent(h);
        for (int k = 0; k < 3; ++k)
            hidden += acting[k] > 0.0 ? acting[k] * ahead_[k] : -acting[k] * behind_[k];
        // In debt the new force's own change buys nothing: one that flickers would pay for itself, tick by tick.
        const double perChange = stored_[h] < 0.0 ? 0.0 : budget;
        const auto left = [&](double s) {
            const Vec3 impulse = pending + s * periodS_ * wantedN;
            return stored_[h] + budget * variation + perChange * (s * wantedN - last).norm() - velocity_.dot(impulse) -
                   perMass * impulse.squaredNorm() - hidden;
        };
        // In debt, a force is let through that makes it no worse: so the hand can pay by pressing on.
        const double least = std::min(
            0.0, stored_[h] + budget * variation - velocity_.dot(pending) - perMass * pending.squaredNorm() - hidden);
        if (left(share) >= least) continue;
        double low = 0.0, high = share;
        for (int i = 0; i < kHalvings; ++i) {
            const double middle = 0.5 * (low + high);
            (left(middle) >= least ? low : high) = middle;
        }
        share = low;
    }
    return share;
}

PassivityController::Outcome PassivityController::pass(const Vec3& positionMm, const Vec3& wantedN, double periodS,
                                                       bool fresh, bool active) noexcept {
    if (!(periodS >= kMinPeriodS)) periodS = periodS_ > 0.0 ? periodS_ : kUsualPeriodS;
    takePeriod(periodS);
    Outcome outcome;
    const double late = periodS / periodS_;
    if (fresh || !started_ || late > static_cast<double>(kMaxCatchUp)) {
        restart(positionMm.allFinite() ? positionMm : position_);
    } else {
        // A tick that came late: the last force went on acting for all of it.
        const auto periods = std::max<std::size_t>(static_cast<std::size_t>(std::lround(late)), 1);
        const Vec3 from = position_;
        for (std::size_t i = 0; i < periods; ++i) {
            if (i > 0) push(sent(0));
            advance(positionMm);
            settle();
        }
        outcome.withheldNmm = std::max(0.0, (lastWanted_ - sent(0)).dot(position_ - from));
    }
    double share = active ? this->share(wantedN) : 1.0;
    if (active) share = std::min(share, lastShare_ + periodS / kRiseS);
    lastShare_ = share;
    outcome.forceN = share < 1.0 ? Vec3(share * wantedN) : wantedN;
    outcome.changed = share < 1.0;
    lastWanted_ = wantedN;
    push(outcome.forceN);
    return outcome;
}

double PassivityController::storedNmm() const noexcept {
    return *std::min_element(stored_.begin(), stored_.begin() + static_cast<std::ptrdiff_t>(lags_));
}

}  // namespace handpiece::stability
