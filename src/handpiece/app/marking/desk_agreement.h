// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How far markers agree with the machine, with themselves and with each other. Marks that were given blind alone:
/// who has seen a score does not mark independently of it.

#include <map>
#include <string>
#include <vector>

#include "handpiece/app/assessment/marks_agreement.h"
#include "handpiece/app/marking/desk.h"

namespace handpiece::marking {

/// The rater's name of the machine, and what is put behind a marker's for works that came again.
inline constexpr const char* kMachine = "machine";
inline constexpr const char* kAgain = " again";

/// All marks that this desk may show, as docs/agreement.md has them: item, rater, criterion, mark. Items are ids of
/// works, the same at every desk; only works that are revealed here. Throws core::Error where the desk is not blind.
[[nodiscard]] std::string marksCsv(const Desk& desk, const std::vector<DeskState>& desks);

/// The file's first line; what a marker said of an item; what the machine says of it: lines of such a file.
[[nodiscard]] std::string marksHead();
[[nodiscard]] std::string marksLines(const std::string& item, const std::string& rater,
                                     const std::vector<std::string>& asked, const std::map<std::string, Mark>& marks);
[[nodiscard]] std::string machineLines(const std::string& item, const rubric::Rubric& rubric,
                                       const std::vector<std::string>& asked, const score::Assessment& machine);

struct DeskAgreement {
    std::vector<assessment::CriterionAgreement> criteria;  ///< in the rubric's order, kTotal last
    std::vector<std::string> raters;                       ///< all that occur
    /// A picture (SVG) each, and what it is called. Names and labels are in the program's language, titles the
    /// rubric's.
    struct Picture {
        std::string name, svg;
    };
    std::vector<Picture> pictures;
};
/// Of marksCsv(). Empty without marks. `draws` of each bootstrap interval.
[[nodiscard]] DeskAgreement agreementOfDesk(const Desk& desk, const std::vector<DeskState>& desks,
                                            std::size_t draws = assessment::kDraws);
/// Of a file as marksCsv() makes it; `where` names it in messages.
[[nodiscard]] DeskAgreement agreementOfMarks(const rubric::Rubric& rubric, const std::string& csv,
                                             const std::string& where, std::size_t draws = assessment::kDraws);
/// What pages call a rater: a marker as they are, the machine and works that came again in the program's language.
[[nodiscard]] std::string raterName(const std::string& rater);
/// Linear weighted kappa of each criterion with bands, of two raters, with its interval.
[[nodiscard]] std::string kappaSvg(const std::vector<assessment::CriterionAgreement>& criteria,
                                   const std::string& first, const std::string& second);

}  // namespace handpiece::marking
