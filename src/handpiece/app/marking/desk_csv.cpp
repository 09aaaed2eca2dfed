// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/marking/desk_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "handpiece/app/report/assessment_report.h"
#include "handpiece/base/core/csv_cell.h"

namespace handpiece::marking {
namespace {

std::string number(const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string();
}

}  // namespace

std::string csvLine(const std::vector<std::string>& cells) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i)
        line += (i > 0 ? "," : "") + core::csvCell(cells[i]);
    return line + "\r\n";
}

std::string resultsCsv(const Desk& desk, Naming naming) {
    std::vector<std::string> head = {"code"};
    if (naming == Naming::withFiles) head.emplace_back("file");
    for (const char* name :
         {"score", "max_score", "passed", "machine_score", "machine_max_score", "machine_passed", "proven",
          "borderline", "critical", "decision_reason", "comments", "problem", "completeness", "completeness_factor"})
        head.emplace_back(name);
    for (const rubric::Criterion& c : desk.rubric().criteria)
        for (const char* what : {"points", "band", "machine_points", "machine_band", "value", "reason"})
            head.push_back(fmt::format("{}.{}", c.id, what));
    std::string out = csvLine(head);
    for (const std::string& code : desk.codes()) {
        std::vector<std::string> row = {code};
        // Whose a code is stays hidden from who marks blind until the mark is in.
        if (naming == Naming::withFiles) row.push_back(desk.isRevealed(code) ? desk.work(code).name : std::string());
        const assessment::Result* machine = desk.machine(code);
        const std::optional<score::Assessment> final = desk.finalScore(code);
        const Sheet& sheet = desk.sheet(code);
        if (machine != nullptr && final) {
            const score::Assessment& was = machine->assessment;
            std::vector<std::string> critical;
            for (const score::CriticalError& e : final->critical)
                critical.push_back(e.criterion + (e.borderline ? "?" : ""));
            for (const std::string& cell :
                 {number(final->score), number(final->maxScore), std::string(score::nameOf(*desk.passed(code))),
                  number(was.score), number(was.maxScore), std::string(score::nameOf(was.passed)),
                  std::string(machine->identity.proven ? "yes" : "no"), std::string(final->borderline ? "yes" : "no"),
                  fmt::format("{}", fmt::join(critical, " "))})
                row.push_back(cell);
        } else {
            row.resize(row.size() + 9);
        }
        row.push_back(sheet.decision ? sheet.decision->reason : std::string());
        std::vector<std::string> comments;
        for (const Comment& c : sheet.comments)
            comments.push_back(c.criterion.empty() ? c.text : c.criterion + ": " + c.text);
        row.push_back(fmt::format("{}", fmt::join(comments, " | ")));
        row.push_back(desk.problem(code));
        if (const auto& done = machine != nullptr && final ? final->completeness : std::nullopt; done && done->value) {
            row.push_back(number(done->value));
            row.push_back(number(done->factor));
        } else {
            row.resize(row.size() + 2);
        }
        for (std::size_t i = 0; i < desk.rubric().criteria.size(); ++i) {
            if (machine == nullptr || !final) {
                row.resize(row.size() + 6);
                continue;
            }
            const score::CriterionScore &now = final->criteria[i], &was = machine->assessment.criteria[i];
            const auto said = sheet.overrides.find(now.id);
            for (const std::string& cell :
                 {number(now.points), now.band, number(was.points), was.band, number(was.value),
                  said != sheet.overrides.end() ? said->second.reason : std::string()})
                row.push_back(cell);
        }
        out += csvLine(row);
    }
    return out;
}

std::string classPage(const Desk& desk, Naming naming) {
    std::vector<report::ClassEntry> entries;
    std::set<const ReturnedWork*> seen;
    for (const std::string& code : desk.codes()) {
        const assessment::Result* machine = desk.machine(code);
        const std::optional<score::Assessment> final = desk.finalScore(code);
        if (machine == nullptr || !final || !seen.insert(&desk.work(code)).second) continue;
        const std::string& file = desk.work(code).name;
        report::ClassEntry entry;
        entry.student = naming == Naming::withFiles ? std::filesystem::path(file).stem().string() : code;
        entry.file = naming == Naming::withFiles ? file : code;
        entry.result = *machine;
        entry.result.assessment = *final;
        entry.result.assessment.passed = *desk.passed(code);
        if (const std::optional<Decision>& decision = desk.sheet(code).decision)
            entry.result.assessment.why = decision->reason;
        entries.push_back(std::move(entry));
    }
    if (entries.empty())
        throw core::Error("no work has a score that may be seen", desk.folder().string(),
                          "score the works; where marks are blind, give them in first");
    return report::classReport(entries);
}

}  // namespace handpiece::marking
