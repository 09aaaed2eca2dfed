// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What can be measured of a preparation and of the hand that made it: the kinds, and a value with how sure it is.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/vec.h"

namespace handpiece::measures {

/// What a measure is taken of. The tooth's are equal from a session, an attempt and a replay; the hand's need samples.
enum class Subject { tooth, hand };

/// What of a tooth a measure asks for, beside its kind; each kind says which of them it takes (MeasureKind::takes).
enum class Selector : unsigned { zone = 1, tissue = 2, side = 4, statistic = 8, limit = 16 };

/// Narrows a measure down. Empty: all of it.
struct Selection {
    std::string zone;             ///< of kZones
    std::string tissue;           ///< a tissue's name as in case.toml
    std::string side;             ///< of kSides
    std::string statistic;        ///< of kStatistics
    std::optional<double> limit;  ///< a threshold of the measure, in the unit that its kind says

    friend bool operator==(const Selection&, const Selection&) = default;
};

/// Of a task: what is to go, what may go beside and under it, what must stay, and all else.
inline constexpr std::string_view kZones[] = {"target", "leeway-side", "leeway-floor", "protected", "container"};
/// Towards which a wall, ridge or surface lies. "labial" and "palatal" are buccal and lingual of teeth that have them.
inline constexpr std::string_view kSides[] = {"mesial", "distal", "buccal", "lingual", "occlusal", "gingival"};
/// Of the samples that a measure is taken at; each kind has its own where none is named.
inline constexpr std::string_view kStatistics[] = {"mean", "median", "least", "greatest", "p5", "p95"};

struct MeasureKind {
    std::string_view id;    ///< "floor-depth": stable, in rubrics and results
    std::string_view unit;  ///< "mm", "mm2", "mm3", "deg", "um", "%", "s", "N", "N s", "rpm", "" for a count or a share
    Subject subject = Subject::tooth;
    unsigned takes = 0;               ///< Selector bits
    double least = 0.0, most = 1e12;  ///< no value lies beyond: a rubric that asks for one is wrong
    std::string_view says;            ///< in one line; the definition is in docs/assessment.md
};

/// Raised with every change after which the same work may be measured otherwise, or another measure is taken: kept
/// values of before are taken anew.
inline constexpr int kMeasuresRevision = 7;

/// All there are, by id.
[[nodiscard]] std::span<const MeasureKind> measureKinds();
/// Null when there is none of this id.
[[nodiscard]] const MeasureKind* findMeasureKind(std::string_view id);

/// Texts of the evidence that a mean or a median has beside its own place: where one in twenty places has less, and
/// where one in twenty has more.
inline constexpr const char *kLeastHere = "least here", *kMostHere = "most here";

/// Where and when a value came from.
struct Evidence {
    std::optional<double> timeS;        ///< of the session
    std::optional<core::Vec3> placeMm;  ///< tooth frame
    std::optional<double> forceN;       ///< on the bur, at that time
    std::string text;                   ///< in a few words
    std::size_t session = 0;            ///< of the chain that the work is, the one that `timeS` is of
};

/// What is to be measured.
struct Request {
    std::string kind;
    Selection of{};
};
/// The request's kind. Throws core::Error for one that does not exist or does not take what is selected.
const MeasureKind& requireKind(const Request& request);

/// What was measured; a measure that cannot be taken says why and has no value (never 0).
struct Measured {
    std::string kind;
    Selection of;
    std::optional<double> value;  ///< in the kind's unit
    double uncertainty = 0.0;     ///< half-width of an interval that covers the error in 95 % of cases, same unit
    std::string reason;           ///< why there is no value; empty where there is one
    std::vector<Evidence> evidence{};
};

}  // namespace handpiece::measures
