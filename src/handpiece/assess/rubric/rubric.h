// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How a piece of work is judged, as data: criteria on measures, with points, bands, critical errors and rules. The
/// file is docs/formats/rubric.md.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/assess/measures/measure.h"
#include "handpiece/model/case/exercise.h"

namespace handpiece::rubric {

using cases::Texts;

/// Where the figures come from.
enum class Status {
    published,  ///< as published
    adapted,    ///< from something published, changed: the source says how
    proposal,   ///< of the project, unvalidated
};
[[nodiscard]] std::string_view nameOf(Status status);

/// A verdict in a word, for all criteria alike; listed from best to worst.
struct BandName {
    std::string id;
    Texts title;
};

/// The values that come to a band: a closed interval. Where two touch, the first that is listed has the value.
struct Band {
    std::string id;                  ///< of Rubric::bands
    std::optional<double> from, to;  ///< none: open
    std::optional<double> points;    ///< 0 to 100; none: the knots give them
    int line = 0;
};

/// Of a curve of straight pieces, held at its ends.
struct Knot {
    double value = 0.0, points = 0.0;  ///< points: 0 to 100, of a Completeness the factor, 0 to 1
    friend bool operator==(const Knot&, const Knot&) = default;
};

/// Values that are a critical error, whatever else is good.
struct Critical {
    std::optional<double> below, above;
    Texts title;
    int line = 0;
};

struct Criterion {
    std::string id, measure, unit;
    measures::Selection of;
    double weight = 0.0;  ///< points that it gives at most; 0: shown, not graded
    std::vector<Knot> knots;
    std::vector<Band> bands;
    std::optional<Critical> critical;
    std::vector<std::string> devices;   ///< for which it is valid; empty: all
    std::vector<std::string> excludes;  ///< criteria that are void where this one is a critical error or has no points
    Texts title, words, leavesOut;
    std::optional<Status> status;  ///< none: the rubric's
    std::string source;
    int line = 0;

    [[nodiscard]] bool isGraded() const noexcept { return weight != 0.0; }
};

/// One thing that a rule asks for.
struct Condition {
    std::vector<std::string> bands;           ///< counts criteria in any of these bands ...
    std::vector<std::string> of;              ///< ... among these; empty: all that have bands
    std::optional<std::int64_t> least, most;  ///< how many
    std::string rule;                         ///< or: that another rule holds
};

/// Holds when all its conditions do.
struct Rule {
    std::string id;
    Texts title;
    std::vector<Condition> needs;
    bool required = false;             ///< to pass
    std::optional<double> elseAtMost;  ///< where it does not hold, the score is at most this [% of the greatest]
    std::string source;
    int line = 0;
};

/// Criteria that belong together, in the order of the work.
struct Step {
    std::string id;
    Texts title;
    std::vector<std::string> criteria;
    int line = 0;
};

/// How much must be done for what was done to count in full: all points are multiplied by its factor.
struct Completeness {
    std::string measure, unit;  ///< of the tooth
    measures::Selection of;
    std::vector<Knot> knots;  ///< [value, factor], never falling, the last 1
    Texts title, words;
    std::string source;
    int line = 0;
};

struct Rubric {
    std::string id, version;
    Texts title, words;
    Status status = Status::proposal;
    std::string source;
    std::optional<double> totalWeight;  ///< what the weights must sum to, where the file states it
    std::optional<double> passMark;     ///< [% of the greatest score]
    std::optional<Completeness> completeness;
    std::vector<BandName> bands;
    std::vector<Step> steps;
    std::vector<Criterion> criteria;
    std::vector<Rule> rules;
    std::string where;  ///< names the file in messages

    [[nodiscard]] const Criterion* criterion(std::string_view name) const;
};

/// The most of anything that a file may hold.
inline constexpr std::size_t kMaxBytes = 1 << 18, kMaxCriteria = 200, kMaxPieces = 64, kMaxRules = 64,
                             kMaxTextBytes = 4000;

/// Throws core::Error with the line for what is no rubric at all: no TOML, unknown keys, wrong types, hostile sizes.
/// Whether it makes sense, check() says.
[[nodiscard]] Rubric parseRubric(std::string_view text, const std::string& where);
[[nodiscard]] Rubric readRubric(const std::filesystem::path& file);
/// One that comes with the program, or a file.
[[nodiscard]] Rubric rubricByNameOrFile(const std::string& nameOrFile);

enum class Severity {
    error,    ///< cannot be used
    warning,  ///< can, and is probably not what was meant
    remark,
};
struct Finding {
    Severity severity = Severity::error;
    std::string where;  ///< "file:line: criterion id", as far as known
    std::string problem, remedy;
    std::string criterion{};  ///< the id of the one it is about; empty: the whole, a step, a rule
};
/// All that is wrong with it, in the order of the file.
[[nodiscard]] std::vector<Finding> check(const Rubric& rubric);
/// Throws core::Error with the first error that check() finds.
void requireSound(const Rubric& rubric);

/// Changes when a score or a verdict could: not with comments, the spelling of numbers, words, titles and sources.
[[nodiscard]] std::uint64_t hashOf(const Rubric& rubric);
/// What is hashed: one line each for all that decides.
[[nodiscard]] std::string canonicalText(const Rubric& rubric);
/// 16 hexadecimal digits.
[[nodiscard]] std::string hashText(std::uint64_t hash);

/// What `after` changes, one sentence each, what decides first. Empty when they mean the same and say the same.
[[nodiscard]] std::vector<std::string> differences(const Rubric& before, const Rubric& after);
/// The rubric in plain words.
[[nodiscard]] std::string describe(const Rubric& rubric, std::string_view language);

/// As a file of the format: parseRubric() gives back the same rubric, lines and `where` apart; comments are lost.
[[nodiscard]] std::string rubricToml(const Rubric& rubric);

/// Of those that come with the program, sorted.
[[nodiscard]] std::vector<std::string> shippedRubrics();
/// The name of the one made for a preparation ("class-one"); empty: there is none.
[[nodiscard]] std::string_view shippedFor(std::string_view preparation);
/// Its text, with mesial and distal changed over where `side` is the other than it was made for; empty: there is none.
[[nodiscard]] std::string shippedTextFor(std::string_view preparation, std::string_view side,
                                         std::span<const std::string_view> notAsked = {});
/// Throws core::Error naming them.
[[nodiscard]] Rubric shippedRubric(std::string_view name);
/// The file as it is; throws alike.
[[nodiscard]] std::string_view shippedRubricText(std::string_view name);

/// The band that has the value; null when none has.
[[nodiscard]] const Band* bandOf(const Criterion& criterion, double value);
/// Points of a value, 0 to 100; none where the criterion has none for it.
[[nodiscard]] std::optional<double> pointsOf(const Criterion& criterion, double value);
/// By which points are multiplied, 0 to 1.
[[nodiscard]] double factorOf(const Completeness& completeness, double value);

}  // namespace handpiece::rubric
