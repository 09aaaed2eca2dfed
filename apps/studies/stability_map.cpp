// SPDX-License-Identifier: Apache-2.0
#include "studies/stability_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/instrument/turbine.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/contact/mouth_method.h"
#include "handpiece/tick/loop/loop_run.h"
#include "studies/built_in_motion.h"
#include "studies/plane_method.h"
#include "studies/shaped_device.h"

namespace handpiece::studies {
namespace {

using core::Vec3;

constexpr std::size_t kMolarFaces = 10000;
constexpr double kAboveMm = 0.5, kFastMmS = 60.0, kSlowMmS = 15.0;
constexpr double kRestS = 0.4;    // force and ripple are judged over this, at the end of the rest
constexpr double kSettleS = 0.3;  // before it
constexpr double kPullMm = 0.3;   // sideways, in the fissure
constexpr double kCrownMm = 8.0;  // no deeper into the molar: a softer tissue is met with less load
constexpr double kRoundingNmm = 1e-9;

/// The starter molar in one tissue at a time, a bur, and where it meets cusp, fissure and a second such molar beside.
class Molar {
  public:
    explicit Molar(const core::Progress& progress)
        : bur_(std::make_shared<const instrument::Bur>(instrument::makeBur("cylinder-round:1.0x4.0"))), felt_(bur_) {
        cases::Case molar;
        molar.name = "molar";
        molar.outer =
            starter::makeOuter(starter::ToothKind::lowerFirstMolar, kMolarFaces, core::part(progress, 0, 0.3));
        molar.parts.push_back({"enamel", cases::Tissue::enamel, 0, molar.outer});
        tooth::LoadSettings settings;
        settings.useCache = false;
        molar_ = tooth::loadModel(molar, settings, core::part(progress, 0.3, 1.0));
        findPlaces();
        findSecond();
    }
    void use(cases::Tissue tissue) {
        base_ = tooth::withTissues(*molar_, field::TissueMap::uniform(molar_->field, tissue));
        uncut_ = std::make_shared<const tooth::ToothState>(base_);
    }
    [[nodiscard]] loop::Work work(LoopMotion motion) const {
        if (motion == LoopMotion::between) return {besideAnother(uncut_, beside_), nullptr};
        if (motion == LoopMotion::head) return {besideAnother(uncut_, underHead_), nullptr};
        if (motion != LoopMotion::cut) return {contact::makeFieldMethod(uncut_, bur_), nullptr};
        const auto field = std::make_shared<tooth::ToothState>(base_);
        return {contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(field), bur_),
                std::make_unique<cutting::Cutter>(field, bur_, instrument::CuttingParameters{}, cases::builtInTissues(),
                                                  cutting::Cutter::Settings{})};
    }
    /// Where the bur first touches.
    [[nodiscard]] const Vec3& place(LoopMotion motion) const {
        return motion == LoopMotion::wedge ? fissure_ : motion == LoopMotion::between ? between_ : cusp_;
    }

  private:
    /// The molar and a second one there, felt by bur and handpiece.
    template <class Tooth>
    [[nodiscard]] std::unique_ptr<contact::Method> besideAnother(const Tooth& tooth, const Vec3& there) const {
        std::vector<contact::PlacedMethod> placed;
        felt_.place(tooth, {}, placed);
        felt_.place(tooth, {{there, core::Quat::Identity()}, 1}, placed);
        return contact::makeMouthMethod(std::move(placed));
    }
    /// Beside the molar: in contact with it, and so high that the head comes to rest on it with the bur on the cusp.
    void findSecond() {
        const core::Box box = molar_->outer.bounds();
        beside_ = Vec3(box.size().x(), 0.0, 0.0);
        const auto both = besideAnother(molar_, beside_);
        const auto touch =
            firstTouch(*both, {Vec3(box.max.x(), box.centre().y(), box.max.z() + 1.0), core::Quat::Identity()},
                       -Vec3::UnitZ(), box.size().z());
        if (!touch) throw core::Error("the bur finds no place between two teeth", "stability map");
        between_ = touch->positionMm;
        // Clear of bur and shank, under the head.
        constexpr double kClearMm = 1.2;
        underHead_ = Vec3(cusp_.x() - box.min.x() + kClearMm, 0.0, 0.0);
        for (const instrument::BodyPiece& piece : instrument::bodyPieces(*bur_)) {
            if (piece.part != contact::Piece::head) continue;
            const auto head = contact::makeFieldMethod(molar_, piece.solid);
            for (int i = 0; i < 30; ++i) {
                const core::Pose at = core::Pose{cusp_ - underHead_, core::Quat::Identity()} * piece.inBur;
                underHead_.z() -= head->depth(at).depthMm;
            }
        }
    }

    /// The highest place that the bur rests at, and the lowest between the cusps on the way across the middle.
    void findPlaces() {
        const auto method = contact::makeFieldMethod(molar_, bur_);
        const core::Box box = molar_->outer.bounds();
        const Vec3 middle = box.centre();
        double highest = -std::numeric_limits<double>::infinity(), lowest = -highest;
        for (int i = -20; i <= 20; ++i)
            for (int j = -10; j <= 10; ++j) {
                const double x = middle.x() + 0.012 * j * box.size().x(), y = middle.y() + 0.017 * i * box.size().y();
                const auto touch = firstTouch(*method, {Vec3(x, y, box.max.z() + 1.0), core::Quat::Identity()},
                                              -Vec3::UnitZ(), box.size().z());
                if (!touch) continue;
                if (touch->positionMm.z() > highest) {
                    highest = touch->positionMm.z();
                    cusp_ = touch->positionMm;
                }
                const bool between = std::abs(i) <= 8;
                if (between && touch->positionMm.z() < lowest) {
                    lowest = touch->positionMm.z();
                    fissure_ = touch->positionMm;
                }
            }
    }

    std::shared_ptr<const instrument::Bur> bur_;
    contact::FeltInstrument felt_;
    std::shared_ptr<const tooth::ToothModel> molar_;
    std::shared_ptr<const tooth::ToothModel> base_;
    std::shared_ptr<const tooth::ToothState> uncut_;
    Vec3 cusp_ = Vec3::Zero(), fissure_ = Vec3::Zero(), between_ = Vec3::Zero();
    Vec3 beside_ = Vec3::Zero(), underHead_ = Vec3::Zero();  ///< of a second molar
};

/// What the hand intends, and when it rests.
struct Path {
    device::Motion motion;
    double restFromS, restToS;
    Vec3 in;
};

class PathMaker {
  public:
    PathMaker(const Vec3& start, double pedal) : pedal_(pedal), at_(start) { add(); }
    void go(const Vec3& to, double speedMmS) {
        time_ += std::max(1e-3, (to - at_).norm() / speedMmS);
        at_ = to;
        add();
    }
    void stay(double seconds) {
        time_ += seconds;
        add();
    }
    [[nodiscard]] double timeS() const { return time_; }
    [[nodiscard]] device::Motion finish() const { return device::Motion(poses_); }

  private:
    void add() { poses_.push_back({time_, {at_, core::Quat::Identity()}, pedal_}); }
    double pedal_, time_ = 0.0;
    Vec3 at_;
    std::vector<device::TimedPose> poses_;
};

/// In quickly, rest, what the motion is about, and out quickly: what was taken in is there to be given back.
Path pathOf(const StabilityRow& row, const device::Hand& hand, const Molar* molar, double loadN) {
    // Hand and tooth are two springs in series: this far in they meet at the load.
    const double most = row.motion == LoopMotion::touch ? std::numeric_limits<double>::infinity() : kCrownMm;
    const double depth = loadN / hand.stiffnessNPerMm + std::min(loadN / row.stiffnessNPerMm, most);
    const Vec3 touch = row.motion == LoopMotion::touch ? Vec3(Vec3::Zero()) : molar->place(row.motion);
    const Vec3 above = touch + kAboveMm * Vec3::UnitZ(), pressed = touch - depth * Vec3::UnitZ();
    PathMaker hands(above, row.motion == LoopMotion::cut ? 1.0 : 0.0);
    hands.go(pressed, kFastMmS);
    hands.stay(kSettleS + kRestS);
    const double rested = hands.timeS();
    Vec3 last = pressed;
    if (row.motion == LoopMotion::slide || row.motion == LoopMotion::cut) {
        last = pressed + Vec3(1.5, -1.5, 0.0);
        hands.go(last, kSlowMmS);
    } else if (row.motion != LoopMotion::touch) {
        // As far as the hand's own spring must give for a quarter of the load, both ways.
        const Vec3 pull(0.0, kPullMm + 0.25 * loadN / hand.stiffnessNPerMm, 0.0);
        hands.go(pressed + pull, kFastMmS);
        hands.go(pressed - pull, kFastMmS);
        hands.go(pressed, kFastMmS);
    }
    hands.go(last + (touch - pressed) + kAboveMm * Vec3::UnitZ(), kFastMmS);
    hands.stay(0.05);
    return {hands.finish(), rested - kRestS, rested, -Vec3::UnitZ()};
}

StabilityRow::Outcome simulate(const StabilitySweep& sweep, const StabilityRow& row, const device::Hand& hand,
                               const Molar* molar, bool controlled) {
    device::SimulatedDeviceSettings settings;
    settings.capability = sweep.capability;
    settings.capability.maxStiffnessNPerMm = row.limitNPerMm;
    settings.frictionN = row.frictionN;
    settings.delayS = row.delayS;
    settings.hand = hand;
    Path path = pathOf(row, hand, molar, sweep.loadN);
    const double duration = path.motion.durationS();
    auto owned = std::make_unique<device::SimulatedDevice>(settings, std::move(path.motion));
    const device::SimulatedDevice& arm = *owned;
    stability::ShaperSettings shaping = shaperSettingsFor(settings.capability);
    shaping.passivityController = controlled;
    shaping.thermalBudget = false;
    shaping.delayS = sweep.assumedDelayS >= 0.0 ? sweep.assumedDelayS : row.delayS;
    shaping.massKg = settings.massKg;
    auto shaped = std::make_unique<ShapedDevice>(std::move(owned), shaping);
    const ShapedDevice& sent = *shaped;

    force::Parameters parameters = force::defaultParameters();
    if (!sweep.turbineForce) parameters.cuttingForceMultiplier = 0.0;
    loop::LoopSettings loopSettings;
    loopSettings.rateHz = row.rateHz;
    loopSettings.queueCapacity = 16;
    loop::Work work = row.motion == LoopMotion::touch ? loop::Work{std::make_unique<PlaneMethod>(row.tissue), nullptr}
                                                      : molar->work(row.motion);
    loop::HapticLoop loop(loopSettings, std::move(shaped), std::move(work), parameters);

    const double period = loop.periodS(), delta = settings.capability.encoderStepMm;
    const auto activity = [&](double k) { return std::max(0.0, k * (0.5 * period + row.delayS) - row.dampingNSPerMm); };
    const double rendered = activity(row.stiffnessNPerMm),
                 strict = activity(std::min(row.stiffnessNPerMm, sweep.capability.maxStiffnessNPerMm));
    StabilityRow::Outcome outcome;
    outcome.marginNmm = outcome.renderedMarginNmm = std::numeric_limits<double>::infinity();
    double motionSum = 0.0, low = std::numeric_limits<double>::infinity(), high = -low, restSum = 0.0, steps = 0.0;
    std::uint64_t rested = 0;
    const Vec3 start = arm.truePositionMm();
    Vec3 last = start, lastForce = Vec3::Zero();
    (void)runSimulated(loop, duration, [&](const messages::HapticSample& s) {
        const Vec3 x = arm.truePositionMm();
        motionSum += (x - last).squaredNorm() / period;
        last = x;
        const Vec3& force = sent.sentN();
        steps += (force - lastForce).squaredNorm();
        outcome.ticks += !force.isZero(0.0);
        lastForce = force;
        outcome.removedMm3 = s.removedMm3[static_cast<std::size_t>(row.tissue)];
        if (arm.forceVariationN() == 0.0) return;  // not touched yet
        const double kept = 0.5 * delta * arm.forceVariationN() - arm.appliedWorkNmm();
        outcome.marginNmm = std::min(outcome.marginNmm, kept + strict * motionSum);
        outcome.renderedMarginNmm = std::min(outcome.renderedMarginNmm, kept + rendered * motionSum);
        outcome.deepestMm = std::max(outcome.deepestMm, path.in.dot(x - start) - kAboveMm);
        if (s.timeS >= path.restFromS && s.timeS < path.restToS) {
            const double size = force.norm();
            low = std::min(low, size);
            high = std::max(high, size);
            restSum += size;
            ++rested;
        }
    });
    outcome.holds = outcome.marginNmm >= -kRoundingNmm;
    outcome.rippleN = high > low ? high - low : 0.0;
    outcome.restN = rested > 0 ? restSum / static_cast<double>(rested) : 0.0;
    outcome.stepN = outcome.ticks > 0 ? std::sqrt(steps / static_cast<double>(outcome.ticks)) : 0.0;
    outcome.engaged = sent.status().engaged;
    return outcome;
}

}  // namespace

std::string_view nameOf(LoopMotion motion) {
    switch (motion) {
        case LoopMotion::touch:
            return "touch";
        case LoopMotion::slide:
            return "slide";
        case LoopMotion::cut:
            return "cut";
        case LoopMotion::wedge:
            return "wedge";
        case LoopMotion::between:
            return "between";
        case LoopMotion::head:
            return "head";
    }
    return "";
}

StabilitySweep quickStabilitySweep() {
    StabilitySweep sweep;
    sweep.stiffnessNPerMm = {0.5, 5};
    sweep.frictionN = {0.05};
    sweep.delayS = {0.003};
    sweep.rateHz = {1000, 4000};
    sweep.tissues = {cases::Tissue::enamel, cases::Tissue::caries};
    sweep.molarRateHz = {1000};
    return sweep;
}

std::vector<StabilityRow> stabilityMap(const StabilitySweep& sweep, const core::Progress& progress) {
    const force::Parameters feel = force::defaultParameters();
    const bool molarNeeded =
        std::any_of(sweep.motions.begin(), sweep.motions.end(), [](LoopMotion m) { return m != LoopMotion::touch; });
    std::optional<Molar> molar;
    if (molarNeeded) molar.emplace(core::part(progress, 0.0, 0.02));

    std::vector<StabilityRow> rows;
    std::vector<const device::Hand*> hands;
    for (const LoopMotion motion : sweep.motions)
        for (const cases::Tissue tissue : sweep.tissues)
            for (const double limit : sweep.stiffnessNPerMm)
                for (const double rate : motion == LoopMotion::touch ? sweep.rateHz : sweep.molarRateHz)
                    for (const device::Hand& hand : sweep.hands)
                        for (const double friction :
                             motion == LoopMotion::touch ? sweep.frictionN : sweep.molarFrictionN)
                            for (const double delay : sweep.delayS) {
                                const force::TissueFeel& f = feel.tissues[static_cast<std::size_t>(tissue)];
                                StabilityRow row;
                                row.motion = motion;
                                row.tissue = tissue;
                                row.limitNPerMm = limit;
                                row.stiffnessNPerMm = f.stiffnessFraction * limit;
                                row.dampingNSPerMm = std::min(f.dampingNSPerMm, sweep.capability.maxDampingNSPerMm);
                                row.hand = hand.name;
                                row.frictionN = friction;
                                row.delayS = delay;
                                row.rateHz = rate;
                                if (!(row.stiffnessNPerMm > 0.0))
                                    throw core::Error("a tissue without stiffness cannot be pressed",
                                                      std::string(cases::properties(tissue).name),
                                                      "leave it out of the sweep");
                                rows.push_back(row);
                                hands.push_back(&hand);
                            }
    if (rows.empty()) throw core::Error("there is nothing to sweep over", "stability map");

    // Tissue by tissue, so that one field is held at a time; by how long a loop takes, for the progress.
    const auto cost = [](const StabilityRow& r) { return (r.motion == LoopMotion::touch ? 1.0 : 15.0) * r.rateHz; };
    const double all = std::accumulate(rows.begin(), rows.end(), 0.0,
                                       [&](double sum, const StabilityRow& r) { return sum + cost(r); });
    std::atomic<double> done{0.0};
    for (const cases::Tissue tissue : sweep.tissues) {
        if (molar) molar->use(tissue);
        std::vector<std::size_t> these;
        for (std::size_t i = 0; i < rows.size(); ++i)
            if (rows[i].tissue == tissue) these.push_back(i);
        core::parallelFor(these.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t j = begin; j < end; ++j) {
                StabilityRow& row = rows[these[j]];
                const device::Hand& hand = *hands[these[j]];
                const Molar* tooth = molar ? &*molar : nullptr;
                row.off = simulate(sweep, row, hand, tooth, false);
                row.on = simulate(sweep, row, hand, tooth, true);
                const double sum = done.fetch_add(cost(row)) + cost(row);
                core::report(progress, 0.02 + 0.98 * sum / all);
            }
        });
    }
    return rows;
}

std::string stabilityCsv(const std::vector<StabilityRow>& rows) {
    std::string csv =
        "motion,tissue,enamel_stiffness_n_mm,stiffness_n_mm,damping_n_s_mm,hand,friction_n,delay_ms,rate_hz";
    for (const char* which : {"off", "on"})
        fmt::format_to(std::back_inserter(csv),
                       ",{0}_holds,{0}_margin_n_mm,{0}_margin_as_rendered_n_mm,{0}_ripple_n,{0}_rest_n,{0}_step_n,"
                       "{0}_deepest_mm,{0}_removed_mm3,{0}_engaged,{0}_ticks",
                       which);
    csv += "\n";
    for (const StabilityRow& r : rows) {
        fmt::format_to(std::back_inserter(csv), "{},{},{},{:.6g},{},{},{},{},{}", nameOf(r.motion),
                       cases::properties(r.tissue).name, r.limitNPerMm, r.stiffnessNPerMm, r.dampingNSPerMm, r.hand,
                       r.frictionN, 1e3 * r.delayS, r.rateHz);
        for (const StabilityRow::Outcome* o : {&r.off, &r.on})
            fmt::format_to(std::back_inserter(csv), ",{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{},{}",
                           o->holds ? 1 : 0, o->marginNmm, o->renderedMarginNmm, o->rippleN, o->restN, o->stepN,
                           o->deepestMm, o->removedMm3, o->engaged, o->ticks);
        csv += "\n";
    }
    return csv;
}

}  // namespace handpiece::studies
