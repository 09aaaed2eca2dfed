// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <nlohmann/json.hpp>

#include "handpiece/base/core/error.h"
#include "python/bind.h"
#include "python/long_work.h"
#include "python/own_method.h"
#include "python/samples.h"
#include "studies/hand_run.h"

namespace handpiece::python {
namespace {

using Samples = std::vector<messages::HapticSample>;

/// Every so many ticks a run is told about.
constexpr std::uint64_t kTellTicks = 256;

/// Options by their names in handpiece.run; None: as it is. Throws TypeError for a value of another kind.
class Options {
  public:
    explicit Options(const py::dict& given) : given_(given) {}

    template <class T>
    bool take(const char* name, T& value) const {
        if (!given_.contains(name)) return false;
        const py::object object = given_[name];
        if (object.is_none()) return false;
        try {
            value = object.cast<T>();
        } catch (const py::cast_error&) {
            throw py::type_error(fmt::format("run: {} cannot be {}", name, std::string(py::repr(object))));
        }
        return true;
    }

  private:
    const py::dict& given_;
};

studies::HandOptions handOptionsOf(const py::dict& given) {
    studies::HandOptions o;
    const Options options(given);
    double voxelMm = 0.05;
    options.take("tooth", o.tooth);
    options.take("bur", o.bur);
    options.take("voxel_mm", voxelMm);
    options.take("device_model", o.deviceModel);
    o.handGiven = options.take("hand", o.hand);
    options.take("force", o.force);
    options.take("rate_hz", o.rateHz);
    options.take("duration_s", o.durationS);
    options.take("stiffness", o.stiffness);
    options.take("damping", o.damping);
    options.take("slide_friction", o.slide);
    o.speedGiven = options.take("speed_mm_s", o.speedMmS);
    options.take("load_n", o.loadN);
    options.take("depth_mm", o.depthMm);
    options.take("delay_ms", o.delayMs);
    options.take("friction_n", o.frictionN);
    options.take("length_mm", o.lengthMm);
    options.take("at_mm", o.at);
    o.pedalGiven = options.take("pedal", o.pedal);
    options.take("full_removal", o.fullRemoval);
    options.take("drive", o.drive);
    options.take("ability", o.cuttingParameters);
    options.take("abilities", o.abilities);
    options.take("tissues", o.tissues);
    options.take("isthmus_mm", o.isthmusMm);
    options.take("height_mm", o.heightMm);
    options.take("pulp_guard_mm", o.pulpGuardMm);
    options.take("dwell_s", o.dwellS);
    options.take("tremor_um", o.tremorUm);
    options.take("seed", o.seed);
    options.take("code", o.code);
    options.take("undo_at_s", o.undoAtS);
    options.take("redo_at_s", o.redoAtS);
    options.take("reset_at_s", o.resetAtS);
    o.voxelUm = 1e3 * voxelMm;
    const auto require = [](bool isRight, const char* name, const char* what) {
        if (!isRight) throw core::Error("out of range", name, std::string("give ") + what);
    };
    require(voxelMm >= 0.01 && voxelMm <= 0.4, "voxel_mm", "0.01 to 0.4 mm");
    require(o.loadN > 0.0, "load_n", "more than 0 N");
    require(o.depthMm >= 0.0, "depth_mm", "0 mm or more");
    require(o.at.size() == 2, "at_mm", "two numbers, x and y [mm]");
    require(o.pedal >= 0.0 && o.pedal <= 1.0, "pedal", "0 to 1");
    require(o.tremorUm >= 0.0 && o.tremorUm <= 1000.0, "tremor_um", "0 to 1000 um");
    const py::object motion = given["motion"];
    if (py::isinstance<py::str>(motion) || py::hasattr(motion, "__fspath__")) {
        o.motion = pathFrom(motion);
        return o;
    }
    const auto rows = numbersFrom(motion, "motion");
    if (rows.ndim() != 2 || rows.shape(1) != 8)
        throw py::value_error("motion must be a name, a file, or an array (n, 8): t [s], x, y, z [mm], qw, qx, qy, qz");
    o.path.emplace();
    o.path->source = "motion";
    for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
        o.path->rows.emplace_back(rows.data(i, 0), rows.data(i, 0) + 8);
        o.path->lines.push_back(static_cast<std::size_t>(i));
        for (const double number : o.path->rows.back())
            if (!std::isfinite(number)) throw py::value_error(fmt::format("motion[{}] is not finite", i));
    }
    return o;
}

/// What came of a run: what it told, and every sample of it.
struct Outcome {
    std::string summary;
    std::shared_ptr<Samples> samples = std::make_shared<Samples>();
};

tooth::LoadSettings prepareSettings(const studies::HandOptions& o, bool cache) {
    tooth::LoadSettings settings;
    settings.field = simulation::fieldSettingsAt(o.voxelUm * 1e-3);
    settings.useCache = cache;
    return settings;
}

Outcome cut(const studies::HandOptions& o, studies::RunSettings settings, const std::string& out, bool cache,
            bool surfaces, const core::Progress& progress) {
    Outcome outcome;
    studies::Outputs outputs(out);
    const studies::CutJob job =
        studies::prepareCut(o, settings, prepareSettings(o, cache), false, core::part(progress, 0.0, 0.3));
    studies::CutRunOptions listening;
    listening.listener = [&](const messages::HapticSample& s) { outcome.samples->push_back(s); };
    listening.progress = core::part(progress, 0.3, 1.0);
    listening.surfaces = surfaces;
    const studies::CutOutcome done = studies::runCutJob(job, o, settings, *job.motion, listening, outputs);
    nlohmann::ordered_json json =
        studies::summaryOf(o, done.summary, "field", "simulated", settings.device.rigidHand ? "rigid" : o.hand);
    studies::addCut(json, o, job, done, studies::lesionOutcomes(job));
    outcome.summary = studies::textOf(json);
    outputs.write("summary.json", outcome.summary);
    outputs.keep();
    return outcome;
}

using MakeMethod = std::function<std::unique_ptr<contact::Method>(std::shared_ptr<const tooth::ToothModel>,
                                                                  std::shared_ptr<const instrument::Bur>)>;

Outcome touch(const studies::HandOptions& o, const studies::RunSettings& settings, const std::string& out, bool cache,
              const MakeMethod& make, const core::Progress& progress) {
    Outcome outcome;
    studies::Outputs outputs(out);
    const auto tooth =
        tooth::loadModel(cases::readCase(o.tooth), prepareSettings(o, cache), core::part(progress, 0.0, 0.5));
    auto method = make(tooth, instrument::makeInstrument(o.bur, {}, {}, o.burMmPerUnit).bur);
    const std::string name = method->name();
    const device::Motion motion = studies::touchMotionOf(o, settings, *method, tooth->outer.bounds());
    const double duration = o.durationS > 0.0 ? o.durationS : motion.durationS();
    studies::RunTrace trace(outputs.path("trace.csv").string(), duration);
    const core::Progress told = core::part(progress, 0.5, 1.0);
    const studies::RunSummary summary =
        studies::runLoop(settings, motion, std::move(method), [&](const messages::HapticSample& s) {
            trace.take(s);
            outcome.samples->push_back(s);
            if (s.tick % kTellTicks == 0) core::report(told, s.timeS / duration);
        });
    trace.finish(outputs, settings.device.capability.maxForceN, false);
    outcome.summary = studies::textOf(studies::summaryOf(o, summary, name, "simulated", o.hand));
    outputs.write("summary.json", outcome.summary);
    outputs.keep();
    return outcome;
}

py::tuple runHand(const py::dict& given, const py::object& method, const std::string& out, bool cache, bool surfaces,
                  const py::object& progress) {
    const studies::HandOptions o = handOptionsOf(given);
    studies::RunSettings settings = studies::settingsOf(o);
    const bool isOwn = !py::isinstance<py::str>(method);
    const std::string name = isOwn ? nameOfOwn(method) : method.cast<std::string>();
    const auto problem = std::make_shared<OwnProblem>();
    MakeMethod make;
    if (isOwn) {
        // Made here, with Python's lock.
        auto own = std::make_shared<std::unique_ptr<contact::Method>>(makeOwnMethod(method, true, problem));
        make = [own](auto, auto) { return std::move(*own); };
    } else {
        requireMethod(name);
        make = [name](const auto& tooth, const auto& bur) { return makeMethod(name, tooth, bur); };
    }
    const bool cuts = studies::isCut(o);
    if (cuts && name != "field")
        throw core::Error(fmt::format("the method \"{}\" knows no tooth that changes", name), "method",
                          "cut with field");
    LongWork work(progress);
    Outcome outcome;
    try {
        outcome = work.run([&] {
            return cuts ? cut(o, settings, out, cache, surfaces, work.listener())
                        : touch(o, settings, out, cache, make, work.listener());
        });
    } catch (const core::Error&) {
        problem->rethrow();  // what Python threw comes first
        throw;
    }
    problem->rethrow();
    return py::make_tuple(fromJson(outcome.summary),
                          samplesOf(std::shared_ptr<const Samples>(std::move(outcome.samples))));
}

}  // namespace

void bindRun(py::module_& module) {
    module.def("run_hand", &runHand, py::arg("options"), py::arg("method"), py::arg("out"), py::arg("cache"),
               py::arg("surfaces"), py::arg("progress"), "What handpiece.run does; call that.");
    py::list motions;
    for (const std::vector<studies::BuiltInMotion>* all : {&studies::builtInMotions(), &studies::cuttingMotions()})
        for (const studies::BuiltInMotion& motion : *all)
            motions.append(std::string(motion.name));
    module.attr("MOTIONS") = py::tuple(motions);
}

}  // namespace handpiece::python
