// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/cutting/cutter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/tick/cutting/sweeper.h"

namespace handpiece::cutting {

using core::Vec3;

namespace {

/// The cutter's lead over the proxy that is carried to the next tick; a sharp rim needs most of it.
constexpr double kMaxLeadVoxels = 1.0;

/// What the bearing's tissues say together, each with the weight 1 / K.
struct Resistance {
    double areaPerK = 0.0, resistancePerK = 0.0;
    Vec3 tangentPerK = Vec3::Zero();
    bool held = false;  ///< by something that cannot be cut: that alone counts, with the weight 1
};

/// A tooth with what sweeps it.
struct Swept {
    Swept(CutTooth tooth, const instrument::Bur& bur)
        : field(std::move(tooth.field)),
          sweeper(*field, bur, core::simdLevel()),
          reach(core::Vec3(bur.maxRadiusMm(), bur.maxRadiusMm(), bur.lengthMm()).norm() + kNearMm),
          bounds(field->model().outer.bounds()),
          sceneInTooth(tooth.inScene.inverse()),
          turns(tooth.inScene.positionMm != Vec3::Zero() ||
                tooth.inScene.orientation.coeffs() != core::Quat::Identity().coeffs()) {}

    void sweepTo(const core::Pose& cutterInScene, CutResult& result) noexcept {
        core::Pose cutter = cutterInScene;
        if (turns) {
            // Far off there is nothing to sweep, nor on the way from there: the bur comes by steps.
            cutter = sceneInTooth * cutterInScene;
            const Vec3 out = (cutter.positionMm - bounds.max).cwiseMax(bounds.min - cutter.positionMm).cwiseMax(0.0);
            if (out.norm() > reach) {
                if (sweeper.hasPose()) sweeper.settle();
                return;
            }
        }
        const Sweeper::Outcome outcome = sweeper.sweepTo(cutter);
        for (std::size_t t = 0; t < outcome.removedMm3.size(); ++t)
            result.removedMm3[t] += outcome.removedMm3[t];
        result.changedBricks += outcome.changedBricks;
    }

    static constexpr double kNearMm = 1.0;
    std::shared_ptr<tooth::ToothState> field;
    Sweeper sweeper;
    double reach;  // of the bur from its tip, and room
    core::Box bounds;
    core::Pose sceneInTooth;
    bool turns;
};

}  // namespace

struct Cutter::State {
    State(std::vector<CutTooth> cutTeeth, std::shared_ptr<const instrument::Bur> theBur,
          const instrument::CuttingParameters& theCuttingParameters, const cases::TissueTable& tissues,
          const Settings& theSettings)
        : bur(std::move(theBur)),
          cuttingParameters(theCuttingParameters),
          settings(theSettings),
          leastRadiusMm(cuttingParameters.centreRadius * bur->maxRadiusMm()),
          mostLeadMm(kMaxLeadVoxels * finestVoxelMm(cutTeeth)) {
        teeth.reserve(cutTeeth.size());
        for (CutTooth& tooth : cutTeeth)
            teeth.push_back(std::make_unique<Swept>(std::move(tooth), *bur));
        for (std::size_t t = 0; t < cases::kTissueCount; ++t)
            cuttingMm2PerN[t] = cuttingParameters.cutting * tissues.rows[t].cuttingMm2PerN;
    }

    [[nodiscard]] static double finestVoxelMm(const std::vector<CutTooth>& teeth) {
        if (teeth.empty()) throw core::Error("there is no tooth to cut", "cutter", "give one");
        double finest = teeth.front().field->field().settings().voxelMm;
        for (const CutTooth& tooth : teeth)
            finest = std::min(finest, tooth.field->field().settings().voxelMm);
        return finest;
    }
    [[nodiscard]] Resistance resistanceOf(const contact::Bearing& told) const noexcept {
        Resistance sum;
        for (std::size_t t = 0; t < cases::kTissueCount; ++t)
            sum.held = sum.held || (cuttingMm2PerN[t] <= 0.0 && told.resistanceMm[t] > 0.0);
        for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
            const bool canBeCut = cuttingMm2PerN[t] > 0.0;
            if (sum.held == canBeCut) continue;
            const double weight = canBeCut ? 1.0 / cuttingMm2PerN[t] : 1.0;
            sum.areaPerK += weight * told.areaMm2[t];
            sum.resistancePerK += weight * told.resistanceMm[t];
            sum.tangentPerK += weight * told.tangentMm[t];
        }
        return sum;
    }
    void sweepTo(const core::Pose& cutter) noexcept {
        for (const std::unique_ptr<Swept>& tooth : teeth)
            tooth->sweepTo(cutter, result);
        sweptTo = result.cutterInTooth = cutter;
    }
    void stop() noexcept {
        for (const std::unique_ptr<Swept>& tooth : teeth)
            tooth->sweeper.settle();
    }
    void cutUnderLoad(contact::Method& method, const CutInput& input, double loadN) noexcept {
        const Vec3 direction = input.loadN / loadN;
        const Vec3 proxy = input.proxyInTooth.positionMm;
        // The cutter goes on from where it was: ahead of the proxy by what the field has not let through yet, or behind
        // it by what the field lets through too early. Else the proxy's microns would be cut for nothing, tick by tick.
        Vec3 offset = Vec3::Zero();
        const double slackMm = method.slackMm();
        if (hasCutter && (cutterMm - proxy).norm() <= 2.0 * mostLeadMm) {
            const Vec3 from = cutterMm - proxy;
            const double along = from.dot(direction);
            Vec3 across = from - along * direction;
            const double wide = across.norm();
            if (wide > slackMm) across *= slackMm / wide;
            offset = std::clamp(along, -slackMm, mostLeadMm) * direction + across;
        }
        const double lead = offset.dot(direction);
        hasCutter = true;
        cutterMm = proxy + offset;
        method.bearing(input.proxyInTooth, direction, lead, leastRadiusMm, bearing);
        const Resistance against = resistanceOf(bearing);
        if (against.resistancePerK > 0.0) {
            const double grip = cuttingParameters.frictionCutting * loadN / against.resistancePerK;
            result.loadTorqueNmm = grip * against.areaPerK;
            if (input.speedRadS > 0.0) result.tangentialN = -grip * against.tangentPerK;
        }
        if (!(input.speedRadS > 0.0)) {
            stop();
            return;
        }
        double feed = 0.0;
        if (against.resistancePerK > 0.0 && !against.held) {
            const double most =
                cuttingParameters.chipMm * cuttingParameters.edges * input.speedRadS / (2.0 * std::numbers::pi);
            feed =
                std::min(std::min(loadN, cuttingParameters.loadCapN) * input.speedRadS / against.resistancePerK, most);
        }
        result.feedMmS = feed;
        if (!(feed > 0.0)) {
            stop();
            return;
        }
        cutterMm += feed * input.periodS * direction;
        core::Pose cutter = input.proxyInTooth;
        cutter.positionMm = cutterMm;
        sweepTo(cutter);
        method.noteCut(cutter);
    }

    std::shared_ptr<const instrument::Bur> bur;
    instrument::CuttingParameters cuttingParameters;
    Settings settings;
    std::vector<std::unique_ptr<Swept>> teeth;
    core::Pose sweptTo;
    double leastRadiusMm, mostLeadMm;
    Vec3 cutterMm = Vec3::Zero();  // where the cutter was when it last cut
    bool hasCutter = false;
    std::array<double, cases::kTissueCount> cuttingMm2PerN{};
    contact::Bearing bearing;
    CutResult result;
};

Cutter::Cutter(std::shared_ptr<tooth::ToothState> field, std::shared_ptr<const instrument::Bur> bur,
               const instrument::CuttingParameters& cuttingParameters, const cases::TissueTable& tissues,
               const Settings& settings)
    : Cutter(std::vector<CutTooth>{{std::move(field), {}}}, std::move(bur), cuttingParameters, tissues, settings) {}

Cutter::Cutter(std::vector<CutTooth> teeth, std::shared_ptr<const instrument::Bur> bur,
               const instrument::CuttingParameters& cuttingParameters, const cases::TissueTable& tissues,
               const Settings& settings)
    : state_(std::make_unique<State>(std::move(teeth), std::move(bur), cuttingParameters, tissues, settings)) {
    const auto notBelowZero = [&](double value, const char* what) {
        if (std::isfinite(value) && value >= 0.0) return;
        throw core::Error(std::string(what) + " is not a number of zero or more",
                          "cutting ability " + cuttingParameters.name, "correct the ability");
    };
    notBelowZero(cuttingParameters.cutting, "cutting");
    notBelowZero(cuttingParameters.loadCapN, "load cap");
    notBelowZero(cuttingParameters.frictionCutting, "friction");
    notBelowZero(cuttingParameters.chipMm, "chip");
    notBelowZero(cuttingParameters.edges, "number of edges");
    notBelowZero(cuttingParameters.centreRadius, "centre radius");
}

Cutter::~Cutter() = default;

const CutResult& Cutter::cut(contact::Method& method, const CutInput& input) noexcept {
    State& s = *state_;
    s.result = {};
    s.result.cutterInTooth = input.proxyInTooth;
    if (s.settings.fullRemoval) {
        if (input.speedRadS > 0.0 && input.deviceInTooth.isValid())
            s.sweepTo(input.deviceInTooth);
        else
            s.stop();
        return s.result;
    }
    const double loadN = input.loadN.norm();
    if (loadN > 0.0 && std::isfinite(loadN) && input.proxyInTooth.isValid())
        s.cutUnderLoad(method, input, loadN);
    else
        s.stop();
    return s.result;
}

const CutResult& Cutter::rest() noexcept {
    State& s = *state_;
    s.result = {};
    s.result.cutterInTooth = s.sweptTo;
    s.stop();
    return s.result;
}

std::size_t Cutter::toothCount() const noexcept {
    return state_->teeth.size();
}

tooth::ToothState& Cutter::field(std::size_t tooth) noexcept {
    return *state_->teeth[tooth]->field;
}

const tooth::ToothState& Cutter::field(std::size_t tooth) const noexcept {
    return *state_->teeth[tooth]->field;
}

tooth::ToothState* Cutter::fieldOf(std::uint16_t toothNumber) noexcept {
    for (const std::unique_ptr<Swept>& tooth : state_->teeth)
        if (tooth->field->toothNumber() == toothNumber) return tooth->field.get();
    return nullptr;
}

double Cutter::largestRadiusMm() const noexcept {
    return state_->bur->maxRadiusMm();
}

}  // namespace handpiece::cutting
