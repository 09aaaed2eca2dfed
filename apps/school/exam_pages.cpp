// SPDX-License-Identifier: Apache-2.0
#include "school/exam_pages.h"

#include <algorithm>

#include "handpiece/app/report/exam_pages.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/school/store/exam_books.h"
#include "school/exam_arrival.h"
#include "school/visit.h"

namespace handpiece::school_server {
namespace {

using config::words;
using school::Action;
using school::ExamBooks;
using school::Relation;

/// The last score of the server's.
std::optional<school::Score> scoreOf(const Visit& v, const std::string& id) {
    const std::vector<school::Score> scores = v.books.scoresOf(id);
    return scores.empty() ? std::nullopt : std::optional(scores.back());
}

}  // namespace

bool isExam(const Visit& v, const std::string& attempt) {
    return ExamBooks(v.books).sitting(attempt).has_value();
}

Page examOf(const Visit& v, const std::string& id, const std::filesystem::path&) {
    ExamBooks exams(v.books);
    const auto assignment = v.books.assignment(id);
    if (!assignment || !exams.settings(id)) return notYours();
    const Relation relation = relationToClass(v, assignment->schoolClass);
    // Those who mark it blind see it without names.
    if (!may(v, Action::seeClass, relation) && !may(v, Action::markBlind, relation)) return notYours();
    const school::Visible others = visibleIn(v, relation);
    report::ExamView view;
    view.exam = *assignment, view.settings = *exams.settings(id), view.showsVerdicts = others.decisions;
    if (const auto pack = exams.newestPack(id)) view.packVersion = pack->version;
    const std::vector<school::ExamSitting> sittings = exams.sittingsOf(id);
    Sight sight(v);
    for (const school::ExamCandidate& candidate : exams.candidates(id)) {
        report::ExamRow row{candidate, {}, {}, 0, {}};
        // The last; but one that is appealed before one that was decided, and that before what came of beginning again.
        int most = -1;
        for (const school::ExamSitting& one : sittings) {
            if (one.person != candidate.person) continue;
            const std::vector<school::ExamDecision> decisions = exams.decisionsOf(one.id);
            const int weight = school::hasOpenAppeal(decisions) ? 2 : decisions.empty() ? 0 : 1;
            if (weight >= most) most = weight, row.sitting = one;
        }
        if (row.sitting) {
            const school::Visible seen = sight.of(workOf(*row.sitting));
            if (seen.worth) row.score = scoreOf(v, row.sitting->id);
            if (seen.doubts) row.doubts = doubtsOf(v.books, *row.sitting).size();
            row.verdict = school::verdictOf(exams.decisionsOf(row.sitting->id));
            row.isAppealed = school::hasOpenAppeal(exams.decisionsOf(row.sitting->id));
        }
        // Who marks blind sees what they are asked to mark.
        if (others.decisions || row.isAppealed) view.rows.push_back(std::move(row));
    }
    report::Names names{{v.person.code, v.person.name}};
    for (const report::ExamRow& row : view.rows)
        if (!others.whose && row.sitting) names[row.candidate.person] = row.sitting->id.substr(0, 8);
    if (others.whose)
        for (const report::ExamRow& row : view.rows)
            if (const auto person = v.books.person(row.candidate.person)) names[person->code] = person->name;
    noteLook(v, "exam seen", "", id);
    return {200, report::examPage(lookerOf(v), view, names)};
}

Page sittingOf(const Visit& v, const std::string& id, const std::filesystem::path&) {
    ExamBooks exams(v.books);
    const auto sitting = exams.sitting(id);
    const school::Visible seen = sitting ? visibleOf(v, workOf(*sitting)) : school::Visible{};
    if (!seen.exists) return notYours();
    const Relation relation = relationTo(v, workOf(*sitting));
    const std::vector<school::ExamDecision> decisions = exams.decisionsOf(id);
    report::SittingView view;
    view.sitting = *sitting;
    if (const auto assignment = v.books.assignment(sitting->exam)) view.title = assignment->title;
    view.seesDecisions = seen.decisions, view.seesWorth = seen.worth;
    view.hasArrived = v.books.attempt(id).has_value();
    if (view.seesWorth) view.score = scoreOf(v, id);
    if (seen.doubts) view.doubts = doubtsOf(v.books, *sitting);
    view.decisions = view.seesDecisions ? decisions : std::vector<school::ExamDecision>{};
    view.verdict = school::verdictOf(decisions);
    const bool isOpen = school::hasOpenAppeal(decisions);
    view.mayConfirm = !isOpen && may(v, Action::mark, relation) && view.seesDecisions;
    view.mayAppeal = relation.isOwn && !decisions.empty() && !isOpen;
    view.mayRemark = isOpen && may(v, Action::markBlind, relation) &&
                     std::none_of(decisions.begin(), decisions.end(),
                                  [&](const school::ExamDecision& d) { return d.person == v.person.code; });
    view.mayDecide = isOpen && may(v, Action::mark, relation) && view.seesDecisions;
    noteLookAt(v, "sitting seen", workOf(*sitting));
    report::Names names = namesFor(v, seen, sitting->person);
    // A code that one logs in by is a name too.
    if (!seen.whose) names[sitting->person] = id.substr(0, 8);
    return {200, report::sittingPage(lookerOf(v), view, names)};
}

Page receiptOf(const Visit& v, const std::string& id, const std::filesystem::path& data) {
    const auto sitting = ExamBooks(v.books).sitting(id);
    if (!sitting || !visibleOf(v, workOf(*sitting)).decisions) return notYours();
    v.books.note({v.person.code, v.now}, "receipt made", id);
    Page page;
    page.body = exam::joined(receiptOf(v.books, *sitting, examKey(data), v.now));
    page.type = "text/plain; charset=utf-8", page.fileName = "receipt-" + id.substr(0, 8) + ".txt";
    return page;
}

Page decide(const Visit& v, const std::string& id, const char* kind, const std::string& verdict,
            const std::string& said) {
    ExamBooks exams(v.books);
    const auto sitting = exams.sitting(id);
    const Relation relation = sitting ? relationTo(v, workOf(*sitting)) : Relation{};
    const std::string_view which = kind;
    const bool isTheirs = which == "appeal"   ? relation.isOwn
                          : which == "remark" ? may(v, Action::markBlind, relation)
                                              : may(v, Action::mark, relation);
    if (!sitting || !isTheirs) return notYours();
    school::ExamDecision decision;
    decision.id = school::newId(), decision.sitting = id, decision.person = v.person.code;
    decision.kind = kind, decision.verdict = which == "appeal" ? "" : verdict, decision.words = said;
    decision.made = v.now;
    try {
        exams.add(decision, {v.person.code, v.now});
    } catch (const core::Error& e) {
        if (e.id() != "books-invalid") throw;
        return refused(e.problem() + ": " + e.remedy(), 409);
    }
    return {303, {}, "/sittings/" + id};
}

}  // namespace handpiece::school_server
