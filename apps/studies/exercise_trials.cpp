// SPDX-License-Identifier: Apache-2.0
#include "studies/exercise_trials.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/course/finished_work.h"
#include "handpiece/app/course/shipped_exercises.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/tick/device/capability.h"
#include "studies/cut_run.h"
#include "studies/excavation.h"
#include "studies/scripted_hand.h"
#include "studies/watching_hand.h"

namespace handpiece::studies {
namespace {

namespace fs = std::filesystem;
using cases::LandmarkKind;
using core::Vec3;
using Json = nlohmann::ordered_json;

constexpr double kEnoughMm = 1e-9;

/// An exercise with all that its trials need.
struct Ready {
    tasks::Task task;
    rubric::Rubric rubric;
    simulation::SimulationSetup station;
    preparation::Laid laid;
    std::function<double(const Vec3&)> othersMm;  ///< to teeth beside it that can be cut
    instrument::Instrument instrument;
    PlanOptions hand;
    device::Motion well = device::Motion({{0.0, {}, 0.0}});

    [[nodiscard]] const cases::Landmark& mark(LandmarkKind kind, const std::string& name = {}) const {
        for (const cases::Landmark& m : task.toothCase.landmarks)
            if (m.kind == kind && (name.empty() || m.name == name)) return m;
        throw core::Error("the tooth lacks a landmark", task.id, "set it");
    }
    [[nodiscard]] Vec3 buccal() const { return {0.0, static_cast<double>(task.toothCase.buccalSign), 0.0}; }
    /// As the same hand would cut another preparation.
    [[nodiscard]] device::Motion other(const std::map<std::string, double, std::less<>>& numbers,
                                       bool heedsOthers = true) const {
        preparation::Recipe recipe = *task.preparation;
        for (const auto& [name, value] : numbers)
            recipe.numbers[name] = value;
        const preparation::Laid laidOtherwise = preparation::layOn(task.toothCase, recipe);
        return planPreparation(handSceneOf(laidOtherwise, heedsOthers ? othersMm : nullptr), *instrument.bur, hand);
    }
    /// The middle of the pulp, or of its part that lies nearest to a place.
    [[nodiscard]] Vec3 pulpNear(const Vec3& place) const {
        Vec3 best = Vec3::Zero();
        double least = std::numeric_limits<double>::infinity();
        for (const cases::Part& part : task.toothCase.parts)
            if (part.tissue == cases::Tissue::pulp)
                for (const Vec3& v : part.mesh.vertices)
                    if ((v - place).squaredNorm() < least) least = (v - place).squaredNorm(), best = v;
        return best;
    }
};
using Plan = std::function<device::Motion(const Ready&)>;
struct Mistake {
    const char *name, *criterion;
    Plan plan;
    bool needsLoop = false;  ///< what a hand feels tells it
};
/// How a scripted hand does one of course::shippedExercises().
struct Spec {
    const char* id;
    std::vector<Mistake> mistakes;
    const char* bur = "";  ///< empty: the exercise's own
    bool isExcavated = false;
    double cellMm = 0.1;
};

/// Way through a lesion, as `handpiece run --motion excavate`; `pulpGuardMm` 0: heedless.
device::Motion excavation(const Ready& r, double depthMm, double pulpGuardMm) {
    const CuttingScene scene = [&] {
        CuttingScene s = excavationScene(r.station, r.task.toothCase);
        return s;
    }();
    CuttingOptions options;
    options.depthMm = depthMm;
    options.pulpGuardMm = pulpGuardMm;
    return planExcavation(scene, options).motion;
}

Mistake deeper(const char* name, const char* criterion, std::map<std::string, double, std::less<>> numbers) {
    return {name, criterion, [numbers = std::move(numbers)](const Ready& r) { return r.other(numbers); }};
}
Mistake intoPulp() {
    return {"bur driven into the pulp", "pulp-exposed", [](const Ready& r) {
                const Vec3 floor = r.laid.zones->box().centre();
                return withPlunge(r.well, r.pulpNear(floor), r.laid.draw, 0.3);
            }};
}
/// Pressed into the nearest of the gingiva, pedal down.
Mistake intoGingiva() {
    return {"bur pressed into the gingiva", "gingiva",
            [](const Ready& r) {
                const Vec3 middle = r.laid.zones->box().centre();
                Vec3 nearest = Vec3::Zero();
                double least = std::numeric_limits<double>::infinity();
                for (const cases::Part& part : r.task.toothCase.scenery)
                    if (part.tissue == cases::Tissue::gum)
                        for (const Vec3& v : part.mesh.vertices)
                            if (const double off = (v - middle).squaredNorm(); off < least) least = off, nearest = v;
                return withPlunge(r.well, nearest, r.laid.draw, 0.3);
            },
            true};
}
/// Along the shank, sideways through the contact's neighbour by 0.3 mm.
Mistake nicked(const char* side) {
    return {"adjacent tooth nicked 0.3 mm", "adjacent", [side](const Ready& r) {
                const Vec3 contact = r.mark(LandmarkKind::contact, side).pointsMm.front();
                const Vec3 out = (std::string_view(side) == "mesial" ? 1.0 : -1.0) * Vec3::UnitX();
                // As far into it as the bur's side has to go.
                const double radius = r.instrument.bur->maxRadiusMm();
                double off = -radius;
                while (r.othersMm(contact + (off + radius) * out) > -0.3 && off < 3.0)
                    off += 0.02;
                const Vec3 at = contact + off * out - 0.5 * r.instrument.bur->lengthMm() * r.laid.draw;
                return withPlunge(r.well, at, r.laid.draw, 0.0);
            }};
}

/// From the end of the occlusal part on towards the ridge, by plunge beside plunge.
Mistake ridgeThinned(const char* name, const char* criterion, double sign) {
    return {name, criterion, [sign](const Ready& r) {
                constexpr double kLeftMm = 0.6, kStepMm = 0.2;
                const zones::Cavity& cavity = r.laid.cavities.front();
                Vec3 end(-sign * 1e3, 0.0, cavity.floor.heightMm);
                for (const zones::Outline::Stroke& stroke : cavity.outline.strokes)
                    for (const core::Vec2& p : stroke.points)
                        if (sign * p.x() > sign * end.x()) end.head<2>() = p;
                const Vec3 out = sign * Vec3::UnitX();
                const double toOutsideMm = 40.0 - r.laid.whole->firstMeeting(end + 40.0 * out, -out).distanceMm;
                const double lastMm = toOutsideMm - kLeftMm - r.instrument.bur->maxRadiusMm();
                device::Motion motion = r.well;
                for (double way = 0.0; way < lastMm + kStepMm; way += kStepMm)
                    motion = withPlunge(motion, end + std::min(way, lastMm) * out, r.laid.draw, 0.0);
                return motion;
            }};
}

std::vector<Spec> specs() {
    std::vector<Spec> all;
    all.push_back({"block-channel",
                   {deeper("0.7 mm too deep", "container", {{"depth_mm", 2.2}}),
                    deeper("0.8 mm too wide", "container", {{"width_mm", 2.0}})}});
    all.push_back({"block-cross-mirror", {deeper("0.9 mm too deep", "container", {{"depth_mm", 2.4}})}});
    all.push_back({"block-caries", {{"floor breached", "floor-breached", [](const Ready& r) {
                                         return withPlunge(r.well, {0.0, 0.0, -3.0}, Vec3::UnitZ(), 0.8);
                                     }}}});
    all.push_back({"46-class-i",
                   {deeper("floor 1.5 mm too deep", "depth", {{"depth_mm", 3.0}}),
                    ridgeThinned("mesial ridge thinned to 0.6 mm", "ridge-mesial", 1.0),
                    ridgeThinned("distal ridge thinned to 0.6 mm", "ridge-distal", -1.0), intoPulp()}});
    all.push_back(
        {"46-deep-lesion",
         {{"left off 1.2 mm deep", "soft-periphery", [](const Ready& r) { return excavation(r, 1.2, kPulpGuardMm); }},
          {"followed into the pulp", "pulp-exposed",
           [](const Ready& r) {
               const Vec3 lowest = r.laid.zones->box().centre() - 0.5 * r.laid.zones->box().size().z() * Vec3::UnitZ();
               return withPlunge(r.well, r.pulpNear(lowest), Vec3::UnitZ(), 0.3);
           }}},
         "round-2",
         true});
    all.push_back({"46-class-ii-mo", {nicked("mesial"), intoPulp()}});
    // Thinner than the 330, which does not reach the corner between axial wall and adjacent tooth.
    all.push_back({"11-class-iii",
                   {nicked("mesial"),
                    intoPulp(),
                    {"perforated labially", "labial-perforation",
                     [](const Ready& r) {
                         const Vec3 middle = r.laid.zones->box().centre();
                         const geometry::RayMeeting out =
                             r.laid.whole->firstMeeting(middle + 20.0 * r.buccal(), -r.buccal());
                         return withPlunge(r.well, middle + (20.0 - out.distanceMm) * r.buccal(), r.laid.draw, 0.3);
                     }}},
                   "cylinder-flat:0.6x4.0"});
    all.push_back({"33-class-v", {intoPulp(), intoGingiva()}});
    // A slim bur: 856-012 is wider than the chamfer's way between the teeth.
    all.push_back({"46-crown",
                   {nicked("mesial"),
                    intoPulp(),
                    {"undercut", "undercut",
                     [](const Ready& r) {
                         // The bur lies over by 20 degrees, its tip inwards, on the buccal wall.
                         const Vec3 out = r.buccal();
                         const core::Box& box = r.laid.zones->box();
                         const Vec3 low(box.centre().x(), box.centre().y(), box.min.z() + 1.2);
                         double off = 0.0;
                         while (r.laid.zones->targetMm(low + off * out) > 0.0 && off < 10.0)
                             off += 0.02;
                         const Vec3 draw = (core::rotationAbout(Vec3::UnitX(), (out.y() > 0.0 ? -1.0 : 1.0) * 20.0 *
                                                                                   std::numbers::pi / 180.0) *
                                            Vec3::UnitZ());
                         return withPlunge(r.well, low + (off - 0.3) * out, draw, 0.0);
                     }}},
                   "taper-round:1.0x7.0",
                   false,
                   0.15});
    // One bur all the way down: the exercise's own are changed on the way.
    all.push_back({"46-access",
                   {{"perforated into the furcation", "perforation",
                     [](const Ready& r) {
                         return withPlunge(r.well, r.mark(LandmarkKind::furcation).pointsMm.front(), r.laid.draw, 0.3);
                     }},
                    {"an orifice missed", "orifices",
                     [](const Ready& r) {
                         // All but what lies round one of them.
                         HandScene scene = handSceneOf(r.laid, nullptr);
                         const Vec3 missed = r.mark(LandmarkKind::orifice).pointsMm.front();
                         scene.asideMm = [in = scene.asideMm, missed](const Vec3& p) {
                             return std::max(in(p), 1.2 - core::hypot(p.x() - missed.x(), p.y() - missed.y()));
                         };
                         return planPreparation(scene, *r.instrument.bur, r.hand);
                     }}},
                   "cylinder-round:1.0x9.0"});
    return all;
}

Ready readyOf(const Spec& spec, const TrialOptions& o, const core::Progress& progress) {
    Ready r;
    r.task = course::makeShipped(spec.id, o.out / "teeth", core::part(progress, 0.0, 0.6), o.faces).task;
    r.task.voxelMm = o.voxelMm;
    r.rubric = course::rubricOf(r.task);
    r.instrument = instrument::makeInstrument(*spec.bur ? spec.bur : r.task.toothCase.exercise->bur);
    r.hand.cellMm = spec.cellMm;
    simulation::SimulationSettings settings;
    settings.field = simulation::fieldSettingsAt(o.voxelMm);
    settings.bur = r.instrument.bur;
    settings.cuttingParameters = r.instrument.cuttingParameters;
    settings.drive = instrument::driveByName("turbine");
    settings.tissues = r.task.toothCase.tissues;
    settings.capability = device::capabilityByName("simulated");
    settings.parameters.tissues = force::defaultParameters(settings.tissues).tissues;
    r.station = simulation::makeSimulation(r.task.toothCase, settings, true, core::part(progress, 0.6, 0.9));
    r.laid = preparation::layOn(r.task.toothCase, *r.task.preparation);
    tasks::writeTask(r.task, o.out / "exercises" / r.task.id);
    std::vector<std::pair<std::shared_ptr<const tooth::ToothModel>, core::Pose>> beside;
    for (const simulation::StandingTooth& other : r.station.others)
        if (other.field) beside.emplace_back(other.model, other.inCase);
    if (!beside.empty())
        r.othersMm = [beside](const Vec3& p) {
            double least = std::numeric_limits<double>::infinity();
            for (const auto& [model, inCase] : beside) {
                const Vec3 q = inCase.applyInverse(p);
                const core::Box& box = model->tree.bounds();
                const double off = (q - box.max).cwiseMax(box.min - q).cwiseMax(0.0).norm();
                least = std::min(least, off > 2.0 ? off : model->tree.signedDistance(q));
            }
            return least;
        };
    r.well = spec.isExcavated ? excavation(r, 0.0, kPulpGuardMm)
                              : planPreparation(handSceneOf(r.laid, r.othersMm), *r.instrument.bur, r.hand);
    core::report(progress, 1.0);
    return r;
}

TrialScore judged(const Ready& r, const assessment::Work& work) {
    const assessment::Result result = assessment::scoreWork(work, r.task, r.rubric);
    const score::Assessment& a = result.assessment;
    TrialScore t;
    t.score = a.score, t.maxScore = a.maxScore, t.wholeScore = a.wholeScore, t.mostScore = a.mostScore;
    t.passed = score::nameOf(a.passed);
    t.json = assessment::resultJson(a, result.identity);
    for (const score::CriterionScore& c : a.criteria) {
        if (c.standing == score::Standing::judged && c.mostPoints < c.maxPoints - kEnoughMm)
            t.shortOf.push_back(fmt::format("{} {:.3g} {} ({:.1f} of {:.1f})", c.id, *c.value, c.unit,
                                            c.points.value_or(0.0), c.maxPoints));
        const rubric::Criterion* criterion = r.rubric.criterion(c.id);
        if (c.standing == score::Standing::notMeasured && criterion != nullptr &&
            (c.maxPoints > 0.0 || criterion->critical))
            t.notMeasured.push_back(c.id);
    }
    for (const score::CriticalError& error : a.critical) {
        const auto c = std::find_if(a.criteria.begin(), a.criteria.end(),
                                    [&](const score::CriterionScore& one) { return one.id == error.criterion; });
        t.critical.push_back(error.criterion);
        t.criticalSaid.push_back(fmt::format("{} {:.3g} {}", c->id, c->value.value_or(0.0), c->unit));
    }
    t.isFull = t.maxScore > 0.0 && t.shortOf.empty();
    return t;
}

/// As an attempt that `handpiece score` reads, beside its exercise.
void keep(const Ready& r, const TrialOptions& o, const assessment::Work& work, std::string name) {
    for (char& c : name)
        if (c == ' ') c = '-';
    cases::Attempt attempt;
    attempt.caseFile = fs::absolute(o.out / "exercises" / r.task.id / "case");
    attempt.caseKey = cases::contentKey(r.task.toothCase);
    attempt.caseName = r.task.toothCase.name;
    attempt.state = tooth::encodeState(work.state, r.station.identity());
    attempt.voxelMm = o.voxelMm;
    attempt.removedMm3 = work.state.removedMm3.own;
    attempt.bur = r.instrument.bur->name();
    attempt.cuttingParameters = r.instrument.cuttingParameters.name;
    attempt.drive = r.station.settings.drive.name;
    cases::writeAttempt(attempt, o.out / "works" / r.task.id / name);
}

TrialScore sweptAndJudged(Ready& r, const TrialOptions& o, const device::Motion& motion, const std::string& name = {}) {
    r.station.renewFields();
    sweep(r.station, motion);
    assessment::Work work;
    work.teeth = r.station.teeth();
    work.state = r.station.state();
    if (!name.empty()) keep(r, o, work, name);
    return judged(r, work);
}

/// A hand that waits for its turbine takes so many times as long at most.
constexpr double kMostWaiting = 30.0;

/// At 1 kHz with contact, force and load, recorded, and cut again from the record.
TrialScore atTheArm(Ready& r, const TrialOptions& o, const device::Motion& motion, const char* name,
                    std::string& proof) {
    r.station.renewFields();
    RunSettings settings;
    settings.device.capability = r.station.settings.capability;
    auto hand = std::make_unique<WatchingHand>(r.station.settings.capability, motion);
    settings.isDone = [&hand = *hand] { return hand.isDone(); };
    settings.takeDevice = [&hand] { return std::move(hand); };
    settings.durationS = kMostWaiting * motion.durationS();
    settings.drive = r.station.settings.drive;
    settings.parameters = r.station.settings.parameters;
    const fs::path folder = o.out / "sessions" / r.task.id / name;
    Outputs outputs(folder);
    CutRunOptions options;
    options.casePath = o.out;
    (void)runCut(r.station, r.task.toothCase, settings, motion, options, outputs);
    outputs.keep();
    const assessment::Work work = assessment::readWork(folder / "session.h5", r.task);
    proof = work.proof;
    return judged(r, work);
}

TrialScore idealOf(const Ready& r, const TrialOptions& o) {
    assessment::Work work;
    work.teeth = r.station.teeth();
    work.state = zones::idealState(*r.laid.zones, r.station.tooth);
    keep(r, o, work, "ideal");
    return judged(r, work);
}

/// From steady to shaky; a judgement, chosen before any was tried.
constexpr std::array<double, 5> kTremorMm = {0.02, 0.05, 0.1, 0.2, 0.4};
constexpr std::array<int, 3> kSteadinessOf = {1, 2, 4};

Json toJson(const TrialScore& t) {
    return {{"score", t.score},
            {"max_score", t.maxScore},
            {"whole_score", t.wholeScore},
            {"full_within_the_borderline", t.isFull},
            {"passed", t.passed},
            {"short_of", t.shortOf},
            {"not_measured", t.notMeasured},
            {"critical", t.critical}};
}

std::string listed(const std::vector<std::string>& all) {
    return all.empty() ? "none" : fmt::format("{}", fmt::join(all, ", "));
}

}  // namespace

double HandTrials::mean() const {
    double sum = 0.0;
    for (const double p : percent)
        sum += p;
    return percent.empty() ? 0.0 : sum / static_cast<double>(percent.size());
}

double areaUnderCurve(const std::vector<double>& greater, const std::vector<double>& less) {
    double won = 0.0;
    for (const double a : greater)
        for (const double b : less)
            won += a > b ? 1.0 : a == b ? 0.5 : 0.0;
    const auto pairs = static_cast<double>(greater.size() * less.size());
    return pairs > 0.0 ? won / pairs : 0.5;
}

std::vector<ExerciseTrials> tryExercises(const TrialOptions& o, const core::Progress& progress) {
    std::vector<Spec> chosen = specs();
    for (const std::size_t number : o.exercises)
        if (number < 1 || number > chosen.size())
            throw core::Error(fmt::format("there is no exercise {}", number), "--only", "give 1 to 10");
    const auto numberOf = [](const Spec& spec) { return course::shippedExercise(spec.id).number; };
    core::prepareOutputFolder(o.out);
    std::erase_if(chosen, [&](const Spec& spec) {
        return !o.exercises.empty() && std::find(o.exercises.begin(), o.exercises.end(),
                                                 static_cast<std::size_t>(numberOf(spec))) == o.exercises.end();
    });
    std::vector<ExerciseTrials> all;
    for (const Spec& spec : chosen) {
        const double done = static_cast<double>(all.size()), each = 1.0 / static_cast<double>(chosen.size());
        const core::Progress own = core::part(progress, done * each, (done + 1.0) * each);
        Ready r = readyOf(spec, o, core::part(own, 0.0, 0.3));
        ExerciseTrials trials;
        trials.number = numberOf(spec), trials.id = spec.id, trials.bur = r.instrument.bur->name();
        trials.ideal = idealOf(r, o);
        trials.handS = r.well.durationS();
        for (std::size_t i = 1; i < r.well.poses().size(); ++i)
            trials.wayMm +=
                (r.well.poses()[i].burInTooth.positionMm - r.well.poses()[i - 1].burInTooth.positionMm).norm();
        trials.doneWell =
            o.atTheArm ? atTheArm(r, o, r.well, "done-well", trials.proof) : sweptAndJudged(r, o, r.well, "done well");
        core::report(own, 0.4);
        if (o.withErrors)
            for (const Mistake& mistake : spec.mistakes) {
                if (mistake.needsLoop && !o.atTheArm) continue;
                std::string proof;
                const TrialScore t = mistake.needsLoop ? atTheArm(r, o, mistake.plan(r), mistake.criterion, proof)
                                                       : sweptAndJudged(r, o, mistake.plan(r), mistake.name);
                ErrorOnPurpose error{mistake.name, mistake.criterion, false, true, {}};
                for (const std::string& id : t.critical)
                    if (id == mistake.criterion)
                        error.isFound = true;
                    else
                        error.others.push_back(id);
                error.isMeasured =
                    std::find(t.notMeasured.begin(), t.notMeasured.end(), mistake.criterion) == t.notMeasured.end();
                trials.errors.push_back(std::move(error));
            }
        core::report(own, 0.5);
        if (o.trials > 0 &&
            std::find(kSteadinessOf.begin(), kSteadinessOf.end(), trials.number) != kSteadinessOf.end()) {
            for (const double tremor : kTremorMm) {
                HandTrials hand{tremor, tremor, {}, 0};
                for (int i = 0; i < o.trials; ++i) {
                    const std::uint64_t seed = o.seed * 1000000 + static_cast<std::uint64_t>(trials.number) * 10000 +
                                               trials.hands.size() * 1000 + static_cast<std::uint64_t>(i);
                    const TrialScore t = sweptAndJudged(r, o, withUnsteadiness(r.well, {tremor, tremor}, seed));
                    hand.percent.push_back(t.percent());
                    hand.critical += !t.critical.empty();
                }
                trials.hands.push_back(std::move(hand));
                core::report(own, 0.5 + 0.5 * static_cast<double>(trials.hands.size()) / kTremorMm.size());
            }
            trials.auc = areaUnderCurve(trials.hands.front().percent, trials.hands.back().percent);
            trials.isOrdered = true;
            for (std::size_t i = 1; i < trials.hands.size(); ++i)
                trials.isOrdered = trials.isOrdered && trials.hands[i].mean() <= trials.hands[i - 1].mean();
        }
        all.push_back(std::move(trials));
    }
    core::report(progress, 1.0);
    return all;
}

std::string trialsJson(const TrialOptions& o, const std::vector<ExerciseTrials>& all) {
    Json json{{"schema", "handpiece-exercise-trials-1"},
              {"voxel_um", 1e3 * o.voxelMm},
              {"faces", o.faces},
              {"seed", o.seed},
              {"trials", o.trials},
              {"done_well_by", o.atTheArm ? "the loop at 1 kHz" : "sweeping alone"},
              {"exercises", Json::array()}};
    for (const ExerciseTrials& t : all) {
        Json one{{"number", t.number},
                 {"id", t.id},
                 {"bur", t.bur},
                 {"hand_s", t.handS},
                 {"way_mm", t.wayMm},
                 {"ideal", toJson(t.ideal)},
                 {"done_well", toJson(t.doneWell)},
                 {"errors", Json::array()}};
        if (o.atTheArm) one["proof"] = t.proof;
        for (const ErrorOnPurpose& e : t.errors)
            one["errors"].push_back({{"name", e.name},
                                     {"criterion", e.criterion},
                                     {"found", e.isFound},
                                     {"measured", e.isMeasured},
                                     {"others", e.others}});
        if (!t.hands.empty()) {
            one["auc"] = t.auc;
            one["ordered"] = t.isOrdered;
            for (const HandTrials& h : t.hands)
                one["hands"].push_back({{"tremor_mm", h.tremorMm},
                                        {"drift_mm", h.driftMm},
                                        {"mean_percent", h.mean()},
                                        {"critical", h.critical},
                                        {"percent", h.percent}});
        }
        json["exercises"].push_back(std::move(one));
    }
    return json.dump(2) + "\n";
}

std::string trialsText(const TrialOptions& o, const std::vector<ExerciseTrials>& all) {
    std::string text = fmt::format(
        "Voxel {:.0f} um, teeth of {} faces, seed {}; done well by {}, errors and unsteady hands by sweeping alone.\n\n"
        "| exercise | ideal | done well | not measured | errors on purpose |\n|---|---|---|---|---|\n",
        1e3 * o.voxelMm, o.faces, o.seed, o.atTheArm ? "the loop at 1 kHz" : "sweeping alone");
    const auto points = [](const TrialScore& t) {
        return fmt::format("{:.1f} of {:.1f}{}{}", t.score, t.maxScore, t.isFull ? ", full" : ": " + listed(t.shortOf),
                           t.critical.empty() ? "" : "; critical: " + listed(t.criticalSaid));
    };
    for (const ExerciseTrials& t : all) {
        std::string errors;
        for (const ErrorOnPurpose& e : t.errors)
            errors += fmt::format("{}{}: {}{}", errors.empty() ? "" : "; ", e.name,
                                  e.isFound      ? "found"
                                  : e.isMeasured ? "NOT FOUND"
                                                 : "its measure is not taken",
                                  e.others.empty() ? "" : " (and " + listed(e.others) + ")");
        text += fmt::format("| {} {}, {} | {} | {} | {} | {} |\n", t.number, t.id, t.bur, points(t.ideal),
                            points(t.doneWell), listed(t.ideal.notMeasured), errors.empty() ? "-" : errors);
    }
    for (const ExerciseTrials& t : all) {
        if (t.hands.empty()) continue;
        text += fmt::format(
            "\n{} {}, {} trials a hand: steady against shaky AUC {:.3f}, {}\n\n| tremor and drift, mm | "
            "mean % | least | greatest | with a critical error |\n|---|---|---|---|---|\n",
            t.number, t.id, o.trials, t.auc, t.isOrdered ? "means in order" : "MEANS NOT IN ORDER");
        for (const HandTrials& h : t.hands)
            text += fmt::format("| {:.2f} | {:.1f} | {:.1f} | {:.1f} | {} |\n", h.tremorMm, h.mean(),
                                *std::min_element(h.percent.begin(), h.percent.end()),
                                *std::max_element(h.percent.begin(), h.percent.end()), h.critical);
    }
    return text;
}

}  // namespace handpiece::studies
