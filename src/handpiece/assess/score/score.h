// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What was measured, judged by a rubric: points, bands, critical errors, and where the teacher has to decide.
/// Definitions: docs/formats/rubric.md#the-score.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/assess/measures/measure.h"
#include "handpiece/assess/rubric/rubric.h"

namespace handpiece::score {

/// Under what it was done.
struct Context {
    std::string device;        ///< "pointer", or the driver's name
    double motionScale = 1.0;  ///< millimetres of the hand for one of the bur
};

enum class Standing {
    judged,       ///< its measure was taken
    notMeasured,  ///< it was not: no points, and `reason` says why
    leftOut,      ///< not valid for the device
    voided,       ///< by another criterion that failed
};
[[nodiscard]] std::string_view nameOf(Standing standing);

/// yes, no, or: within the uncertainty of what was measured.
enum class Verdict { no, borderline, yes };

struct CriterionScore {
    std::string id, measure, unit;
    measures::Selection of;
    Standing standing = Standing::judged;
    std::string reason;  ///< of all but judged
    std::optional<double> value;
    double uncertainty = 0.0;                    ///< half-width, 95 %
    std::string band;                            ///< empty: the criterion has none
    std::vector<std::string> possibleBands;      ///< that value +- uncertainty reaches
    std::optional<double> points;                ///< none: shown only, or not judged
    double ownPoints = 0.0;                      ///< those before the factor of completeness
    double leastPoints = 0.0, mostPoints = 0.0;  ///< within the uncertainty
    double maxPoints = 0.0;
    Verdict critical = Verdict::no;
    bool borderline = false;  ///< band or critical condition would change within the uncertainty
    std::vector<measures::Evidence> evidence;
};

struct StepScore {
    std::string id;
    double points = 0.0, maxPoints = 0.0;
    bool isWhole = true;  ///< all that it grades has points
};

struct RuleResult {
    std::string id;
    std::optional<bool> holds;  ///< none: hangs on the uncertainty, or on what was not measured
};

struct CriticalError {
    std::string criterion;
    bool borderline = false;  ///< it may be none
};

/// How far the work is done at all, and by what the points are multiplied for it.
struct Completeness {
    std::string measure, unit;
    measures::Selection of;
    std::optional<double> value;
    std::string reason;        ///< why there is no value: then nothing is taken off, and the teacher decides
    double uncertainty = 0.0;  ///< half-width, 95 %
    double factor = 1.0, leastFactor = 1.0, mostFactor = 1.0;
    std::vector<measures::Evidence> evidence;
};

enum class Passed { yes, no, teacher };
[[nodiscard]] std::string_view nameOf(Passed passed);

struct Assessment {
    std::string rubric, rubricVersion;
    std::uint64_t rubricHash = 0;
    Context context;
    double score = 0.0;                        ///< of the criteria that have points, after the caps of rules
    double maxScore = 0.0;                     ///< of the same criteria
    double wholeScore = 0.0;                   ///< of all that the rubric grades on this device
    double leastScore = 0.0, mostScore = 0.0;  ///< 95 %, errors of the measures taken as independent
    Passed passed = Passed::teacher;
    bool borderline = false;                   ///< `passed` would change within the uncertainty
    std::string why;                           ///< of `passed`, in one sentence
    std::optional<Completeness> completeness;  ///< none: the rubric does not ask
    std::vector<CriticalError> critical;
    std::vector<CriterionScore> criteria;  ///< in the rubric's order
    std::vector<StepScore> steps;
    std::vector<RuleResult> rules;

    [[nodiscard]] double percent() const { return maxScore > 0.0 ? 100.0 * score / maxScore : 0.0; }
    /// Points that are not given because the work is not done.
    [[nodiscard]] double lostUndone() const;
};

/// Pure: same inputs, same bits, at any number of threads. What no measure can have and what is no number counts as not
/// measured. `given`: criteria whose points somebody gave who saw how far the work is done: no factor touches them.
/// Throws core::Error for a rubric that is not sound.
[[nodiscard]] Assessment evaluate(const rubric::Rubric& rubric, std::span<const measures::Measured> measured,
                                  const Context& context, std::span<const std::string> given = {});

// Several attempts at the same: how good, how even, how it went on. Nothing is predicted from them.

/// After each attempt, of it and those before.
struct CurvePoint {
    double percent = 0.0;
    double mean = 0.0;
    std::optional<double> spread;  ///< sample standard deviation; none of a single one
};

struct Attempts {
    std::size_t count = 0;
    double mean = 0.0, least = 0.0, greatest = 0.0;  ///< [%]
    std::optional<double> spread;
    /// Mean of the last half less that of the first, the middle one of an odd number left out; none under four.
    std::optional<double> change;
    std::vector<CurvePoint> curve;  ///< in the order given
};

/// In the order in which they were made. Throws core::Error where they cannot be pooled: other rubrics, devices or
/// motion scales, or one of which not all was measured.
[[nodiscard]] Attempts attempts(std::span<const Assessment> all);

/// On what a scan was registered.
enum class RegisteredOn {
    uncutSurface,   ///< of the tooth itself
    adjacentTeeth,  ///< and what is left uncut of the tooth
    earlierScan,    ///< of the same, that was registered on the tooth
};
/// "uncut-surface", "adjacent-teeth", "earlier-scan", and back.
[[nodiscard]] std::string_view nameOf(RegisteredOn on);
[[nodiscard]] std::optional<RegisteredOn> registeredOnByName(std::string_view name);

/// How a scan of a real preparation lies on the whole tooth.
struct ScanFit {
    double rmsMm = 0.0;     ///< of the surface that was registered on, by area
    double uncutMm2 = 0.0;  ///< of that surface
    double noiseMm = 0.0;   ///< rms that is left when the scanner's noise is taken off
    double cutMm2 = 0.0;    ///< surface that was cut
    double voxelMm = 0.0;   ///< of the field made of it
    RegisteredOn registeredOn = RegisteredOn::uncutSurface;
    double liesMm = 0.0;    ///< standard deviation of where the work lies, from how that surface holds it
    double turnsDeg = 0.0;  ///< and of how it is turned
};

/// Of what a result was made, beside the score.
struct Identity {
    std::string exercise, exerciseHash, caseKey, stateHash;
    std::vector<std::string> sessionHashes;  ///< the chain, in order
    bool proven = false;                     ///< all of it replayed to the same bits
    std::int32_t engineRevision = 0;
    std::optional<ScanFit> scan{};  ///< none: it was cut here
};

/// A score, of what, and how sure that is.
struct Result {
    Assessment assessment;
    Identity identity;
    std::string proof;  ///< in a sentence: that it was cut again to the same tooth, or why not
};

}  // namespace handpiece::score
