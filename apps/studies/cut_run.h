// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One run that cuts: trace, session, plots, and the tooth that is left.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/app/simulation/cut_session.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "studies/run_job.h"
#include "studies/run_output.h"

namespace handpiece::studies {

struct CutRunOptions {
    std::string code;                                             ///< typed by the student; may be empty
    double elapsedS = 0.0;                                        ///< before, of an attempt that goes on
    std::filesystem::path casePath;                               ///< for the attempt
    std::vector<double> undoAtS, redoAtS, resetAtS;               ///< each as soon as no stroke is under way
    std::function<void(const messages::HapticSample&)> listener;  ///< hears each sample, in order; may be empty
    core::Progress progress{};  ///< told instead of a bar on stderr; false: core::Error, the session stays
    bool surfaces = true;       ///< writes cut.stl and cut/, which takes longer than the cut itself
};

struct CutOutcome {
    RunSummary summary;
    std::uint64_t stateHash = 0;
    tooth::TissueVolumes leftMm3{};
    std::vector<simulation::NickedTooth> nicked{};  ///< beside the tooth worked on
    session::RecorderStatus recording;
    std::size_t undoSteps = 0;             ///< strokes that could still be undone
    std::size_t undone = 0;                ///< steps taken back or forth
    double cutMeshMm3 = 0.0;               ///< volume of cut.stl
    std::optional<double> leftOverPulpMm;  ///< at the thinnest place that was cut; none without a pulp or a cut
    std::vector<std::string> files;
};

/// Runs the motion on the station and writes trace.csv, session.h5, the plots, cut.stl, cut/ and attempt/ into
/// `outputs`.
[[nodiscard]] CutOutcome runCut(const simulation::SimulationSetup& station, const cases::Case& toothCase,
                                const RunSettings& settings, const device::Motion& motion, const CutRunOptions& options,
                                Outputs& outputs);

/// The motion with the pedal at `pedal` all the way and let go at its end.
[[nodiscard]] device::Motion withPedal(const device::Motion& motion, double pedal);
/// The motion of a hand that trembles: 8 to 12 Hz, root mean square `amplitudeMm` along each axis; the same for the
/// same seed. Physiological tremor lies in that band [R].
[[nodiscard]] device::Motion withTremor(const device::Motion& motion, double amplitudeMm, std::uint64_t seed);
/// Waves of a band of frequencies, root mean square `amplitudeMm` along each axis.
struct Band {
    double amplitudeMm, lowHz, highHz;
};
/// The motion with all of the bands on it, at times no more than `stepS` apart.
[[nodiscard]] device::Motion withNoise(const device::Motion& motion, const std::vector<Band>& bands, double stepS,
                                       std::uint64_t seed);

}  // namespace handpiece::studies
