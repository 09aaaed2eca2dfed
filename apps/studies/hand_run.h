// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What `handpiece run` does with a simulated hand, by the names of the command line: for it and for other programs.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/model/case/attempt.h"
#include "studies/csv.h"
#include "studies/cut_run.h"
#include "studies/excavation.h"

namespace handpiece::studies {

/// As the options of `handpiece run` of the same names; its help and docs/cli.md say what each is.
struct HandOptions {
    std::string tooth;  ///< as it was named: for the summary, and for the attempt that a cut leaves
    std::string bur = "330";
    double burMmPerUnit = 1.0, voxelUm = 50.0;
    std::optional<CsvTable> path;  ///< instead of `motion`: rows as a file of a motion has them
    std::string motion = "drop", deviceModel = "simulated", hand = "normal", force = "proxy";
    double rateHz = 1000.0, durationS = 0.0, stiffness = 1.0, damping = 1.0, slide = 1.0, speedMmS = 10.0;
    double loadN = 1.0, depthMm = 0.0, delayMs = 0.0, frictionN = 0.26, lengthMm = 0.0;
    std::vector<double> at{0.0, 0.0};
    bool realTime = false, crisp = false, controller = false;
    // Of a cut.
    double pedal = 0.0, isthmusMm = 1.2, heightMm = 2.5, dwellS = 4.0, tremorUm = 0.0;
    double pulpGuardMm = kPulpGuardMm;
    std::uint64_t seed = 1;
    bool fullRemoval = false;
    std::string drive = "turbine", cuttingParameters, abilities, tissues, code;
    std::vector<double> undoAtS, redoAtS, resetAtS;
    // Values that mean something else when nobody gave them.
    bool pedalGiven = false, handGiven = false, speedGiven = false;
};

/// True where the bur turns, so that the tooth is cut.
[[nodiscard]] bool isCut(const HandOptions& options);
/// A name with an extension, or - for standard input.
[[nodiscard]] bool isMotionFile(const std::string& name);
/// Throws core::Error for what is out of range and names there are not.
[[nodiscard]] RunSettings settingsOf(const HandOptions& options);
/// Of a run that only touches: by name or from a file. Throws core::Error.
[[nodiscard]] device::Motion touchMotionOf(const HandOptions& options, const RunSettings& settings,
                                           contact::Method& method, const core::Box& tooth);

/// A tooth on its place under a bur, and what the hand intends to do with it.
struct CutJob {
    cases::Case toothCase;
    std::optional<cases::OpenAttempt> before{};  ///< that it goes on with
    simulation::SimulationSetup station{};
    std::optional<device::Motion> motion{};  ///< none: a person moves the bur
    std::vector<LesionPlan> lesions{};       ///< that an excavation is aimed at
};
/// Of a case, or an attempt that goes on where it was. Puts what the tissues feel like into `settings`, and a rigid
/// hand where none was given. Throws core::Error.
[[nodiscard]] CutJob prepareCut(const HandOptions& options, RunSettings& settings, const tooth::LoadSettings& prepare,
                                bool byPerson, const core::Progress& progress);
/// runCut() of it, with what `options` say of the rest.
[[nodiscard]] CutOutcome runCutJob(const CutJob& job, const HandOptions& options, const RunSettings& settings,
                                   const device::Motion& motion, CutRunOptions listening, Outputs& outputs);
[[nodiscard]] std::vector<LesionOutcome> lesionOutcomes(const CutJob& job);
/// Of its decay that was taken.
[[nodiscard]] double shareOf(const LesionOutcome& outcome);

/// summary.json: what every run tells, and what a cut adds to it.
[[nodiscard]] nlohmann::ordered_json summaryOf(const HandOptions& options, const RunSummary& summary,
                                               const std::string& method, const std::string& device,
                                               const std::string& hand);
void addCut(nlohmann::ordered_json& summary, const HandOptions& options, const CutJob& job, const CutOutcome& outcome,
            const std::vector<LesionOutcome>& lesions);
/// As it is written, with the last line's end.
[[nodiscard]] std::string textOf(const nlohmann::ordered_json& summary);

}  // namespace handpiece::studies
