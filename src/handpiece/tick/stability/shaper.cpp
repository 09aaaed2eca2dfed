// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/stability/shaper.h"

#include <fmt/format.h>

#include <cmath>

#include "handpiece/base/core/error.h"

namespace handpiece::stability {
namespace {

using core::Vec3;

constexpr double kMaxScale = 2.0, kPeriodWithoutS = 1e-3;

PassivityController::Device deviceOf(const ShaperSettings& s) noexcept {
    return {s.encoderStepMm, s.delayS, s.massKg, s.stiffnessNPerMm};
}

}  // namespace

void validate(const ShaperSettings& s) {
    const auto require = [](bool good, const char* what, double value) {
        if (!good || !std::isfinite(value))
            throw core::Error(fmt::format("{} is {}", what, value), "shaping of the force", "correct it");
    };
    require(s.forceScale >= 0.0 && s.forceScale <= kMaxScale, "the force scale (0 to 2)", s.forceScale);
    require(s.maxForceN > 0.0 && s.maxForceN <= 1000.0, "the largest force [N]", s.maxForceN);
    require(s.continuousForceN > 0.0 && s.continuousForceN <= 1000.0, "the continuous force [N]", s.continuousForceN);
    require(s.thermalTauS > 0.0, "the motors' time constant [s]", s.thermalTauS);
    require(s.frictionN >= 0.0 && s.frictionN <= 100.0, "the arm's friction [N]", s.frictionN);
    require(s.frictionShare >= 0.0 && s.frictionShare < 1.0, "the share of friction given back (0 to less than 1)",
            s.frictionShare);
    require(s.encoderStepMm >= 0.0 && s.encoderStepMm <= 10.0, "the encoder step [mm]", s.encoderStepMm);
    require(s.stiffnessNPerMm > 0.0, "the largest stiffness [N/mm]", s.stiffnessNPerMm);
    require(s.dampingNSPerMm >= 0.0, "the largest damping [N s/mm]", s.dampingNSPerMm);
    require(s.delayS >= 0.0 && s.delayS <= PassivityController::kMaxDelayS, "the delay [s] (0 to 0.01)", s.delayS);
    require(s.massKg > 0.0 && s.massKg <= 100.0, "the arm's mass [kg]", s.massKg);
}

void limitTo(const device::Capability& c, ShaperSettings& s) {
    s.maxForceN = c.maxForceN;
    s.continuousForceN = c.continuousForceN;
    s.encoderStepMm = c.encoderStepMm;
    s.stiffnessNPerMm = c.maxStiffnessNPerMm;
    s.dampingNSPerMm = c.maxDampingNSPerMm;
}

Shaper::Shaper(const ShaperSettings& settings) noexcept : settings_(settings) {
    setSettings(settings);
}

void Shaper::setSettings(const ShaperSettings& s) noexcept {
    settings_ = s;
    friction_.set(s.frictionN, s.frictionShare, s.encoderStepMm);
    thermal_.set(s.maxForceN, s.continuousForceN, s.thermalTauS);
    controller_.set(deviceOf(s));
}

Vec3 Shaper::shape(const Vec3& positionMm, const Vec3& wantedN, double periodS, bool fresh) noexcept {
    if (!(periodS > 0.0) || !std::isfinite(periodS)) {
        fresh = true;
        periodS = kPeriodWithoutS;
    }
    const bool known = positionMm.allFinite();
    Vec3 force = wantedN.allFinite() && known ? Vec3(settings_.forceScale * wantedN) : Vec3(Vec3::Zero());
    if (known) {
        const Vec3 given = friction_.force(positionMm, periodS, fresh);
        if (settings_.frictionCompensation) force += given;
    }
    const double scale = settings_.thermalBudget ? thermal_.scale() : 1.0;
    force *= scale;
    const double size = force.norm();
    if (size > settings_.maxForceN) force *= settings_.maxForceN / size;

    const PassivityController::Outcome outcome =
        controller_.pass(positionMm, force, periodS, fresh || !known, settings_.passivityController);
    thermal_.spend(outcome.forceN.norm(), periodS);
    status_.energyNmm = -controller_.storedNmm();
    status_.heat = thermal_.heat();
    status_.dissipatedNmm += outcome.withheldNmm;
    status_.engaged += outcome.changed;
    status_.thermalScale = static_cast<float>(scale);
    return outcome.forceN;
}

}  // namespace handpiece::stability
