// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Exams as pages of a school's server.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/app/report/school_pages.h"
#include "handpiece/school/store/exam_books.h"

namespace handpiece::report {

struct ExamRow {
    school::ExamCandidate candidate;
    std::optional<school::ExamSitting> sitting;  ///< the last
    std::optional<school::Score> score;
    std::size_t doubts = 0;
    std::string verdict{};
    bool isAppealed = false;
};
struct ExamView {
    school::Assignment exam;
    school::ExamSettings settings;
    std::int64_t packVersion = 0;  ///< 0: none was signed
    bool showsVerdicts = false;    ///< else for who marks blind
    std::vector<ExamRow> rows{};
};
/// Candidates, how each stands, and what a teacher has to look at.
[[nodiscard]] std::string examPage(const Looker& who, const ExamView& view, const Names& names);

struct SittingView {
    school::ExamSitting sitting;
    std::string title{};
    bool hasArrived = false, seesWorth = false, seesDecisions = false;
    std::optional<school::Score> score;
    std::vector<std::string> doubts{};
    std::string verdict{};
    std::vector<school::ExamDecision> decisions{};
    bool mayConfirm = false, mayAppeal = false, mayRemark = false, mayDecide = false;
};
/// What stands out of a sitting in the page's language: the books keep it in English, and by its English words
/// (school-exam-doubt) it is found again. What is not found stays as it is.
[[nodiscard]] std::string doubtWords(const std::string& said);
/// One sitting: what came, what is doubted, what was decided, and what this person may decide.
[[nodiscard]] std::string sittingPage(const Looker& who, const SittingView& view, const Names& names);

}  // namespace handpiece::report
