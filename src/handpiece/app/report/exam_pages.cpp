// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/exam_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "handpiece/app/report/html_form.h"
#include "handpiece/app/report/report_html.h"
#include "handpiece/app/report/sentence_places.h"
#include "handpiece/base/config/words.h"

namespace handpiece::report {
namespace {

using config::words;
using Cell = HtmlReport::Cell;
using Tone = HtmlReport::Tone;

std::string examWord(const char* what) {
    return words()(std::string("school-exam.") + what);
}
std::string verdictWord(const std::string& verdict) {
    return examWord(verdict == "pass"   ? "pass"
                    : verdict == "fail" ? "fail"
                    : verdict == "void" ? "void"
                                        : "unconfirmed");
}
std::string examName(const Names& names, const std::string& code) {
    const auto found = names.find(code);
    return found != names.end() && !found->second.empty() ? found->second : code;
}
std::string proofWord(const std::optional<school::Score>& score) {
    if (!score) return words()("school.provisional");
    return words()(score->state == "proven" ? "school.proven" : "school.refused");
}
std::string worthOf(const school::Score& s) {
    return s.maxScore > 0.0 ? fmt::format("{:.1f} / {:.1f}", s.score, s.maxScore) : words()("school.no-score");
}
std::string moreOf(const school::ExamCandidate& c) {
    std::string more;
    const auto add = [&](std::string text) { more += (more.empty() ? "" : ", ") + std::move(text); };
    if (c.extraPercent > 0) add(words()("school-exam.more-time", c.extraPercent));
    if (c.pauseMinutes > 0) add(words()("school-exam.pauses", c.pauseMinutes));
    if (!c.helps.empty()) add(words()("school-exam.helps", c.helps));
    return more;
}

constexpr const char* kDoubts[] = {
    "school-exam-doubt.no-beginning",      "school-exam-doubt.no-candidate",    "school-exam-doubt.before-opened",
    "school-exam-doubt.after-closed",      "school-exam-doubt.no-invigilator",  "school-exam-doubt.begun-here",
    "school-exam-doubt.begun-elsewhere",   "school-exam-doubt.clock-back",      "school-exam-doubt.clock-ahead",
    "school-exam-doubt.went-back",         "school-exam-doubt.restarted",       "school-exam-doubt.silent",
    "school-exam-doubt.given-up",          "school-exam-doubt.never-heard",     "school-exam-doubt.late",
    "school-exam-doubt.another-recording", "school-exam-doubt.not-handed-over", "school-exam-doubt.too-fast",
    "school-exam-doubt.locked-used",       "school-exam-doubt.not-comparable",  "school-exam-doubt.chain-changed",
    "school-exam-doubt.not-confirmed",     "school-exam-doubt.confirmed-twice", "school-exam-doubt.alike",
};

std::vector<std::string> told(const std::vector<std::string>& doubts) {
    std::vector<std::string> all;
    for (const std::string& one : doubts)
        all.push_back(doubtWords(one));
    return all;
}

/// A verdict, why, and the button.
Form verdictForm(const Looker& who, const std::string& address, const char* button, bool needsWhy) {
    FormField verdict{"verdict", examWord("verdict"), "select"};
    verdict.choices = {
        {"", "\u2013"}, {"pass", examWord("pass")}, {"fail", examWord("fail")}, {"void", examWord("void")}};
    verdict.isRequired = true;
    FormField why{"words", examWord("why"), "textarea"};
    why.isRequired = needsWhy;
    return {address, {tokenField(who), verdict, why}, {{examWord(button), {}, {}, true}}};
}

void addDecisions(HtmlReport& page, const SittingView& view, const Names& names) {
    std::vector<std::vector<Cell>> rows;
    for (const school::ExamDecision& d : view.decisions)
        rows.push_back({{momentOf(d.made)},
                        {examWord(("kind-" + d.kind).c_str())},
                        {examName(names, d.person)},
                        {d.kind == "appeal" ? "\u2013" : verdictWord(d.verdict)},
                        {d.words}});
    page.heading(examWord("trail"));
    if (rows.empty())
        page.paragraph(examWord("no-decision"), Tone::note);
    else
        page.linkedTable(
            {words()("school.made"), examWord("what"), examWord("by"), examWord("verdict"), examWord("why")}, rows);
}

}  // namespace

std::string examPage(const Looker& who, const ExamView& view, const Names& names) {
    HtmlReport page = sitePage(view.exam.title, who);
    page.facts({}, {{examWord("opens"), momentOf(view.exam.opens)},
                    {examWord("closes"), momentOf(view.exam.closes)},
                    {examWord("minutes"), std::to_string(view.settings.minutes)},
                    {examWord("locked"), view.settings.locked.empty() ? "\u2013" : view.settings.locked},
                    {examWord("pack"), view.packVersion > 0 ? std::to_string(view.packVersion) : examWord("no-pack")}});
    std::vector<std::vector<Cell>> rows;
    for (const ExamRow& row : view.rows) {
        const std::string address = row.sitting ? "/sittings/" + row.sitting->id : std::string();
        std::vector<Cell> cells{{examName(names, row.candidate.person), address}, {moreOf(row.candidate)}};
        if (!row.sitting) {
            cells.insert(cells.end(), {{examWord("not-begun")}, {}, {}, {}});
        } else {
            cells.push_back({fmt::format("{} {}", examWord(("state-" + row.sitting->state).c_str()),
                                         momentOf(row.sitting->ended > 0 ? row.sitting->ended : row.sitting->began))});
            cells.push_back(
                {row.score ? fmt::format("{} ({})", worthOf(*row.score), proofWord(row.score)) : proofWord(row.score)});
            cells.push_back({row.doubts > 0 ? words()("school-exam.doubts", row.doubts) : std::string()});
            cells.push_back({row.isAppealed       ? examWord("appealed")
                             : view.showsVerdicts ? verdictWord(row.verdict)
                                                  : ""});
        }
        rows.push_back(std::move(cells));
    }
    if (rows.empty())
        page.paragraph(examWord(view.showsVerdicts ? "no-candidates" : "nothing-to-mark"), Tone::missing);
    else
        page.linkedTable({words()("class.student"), examWord("more"), words()("school.state"), words()("class.score"),
                          examWord("look"), examWord("verdict")},
                         rows, view.showsVerdicts ? examWord("about") : std::string());
    return page.text();
}

std::string doubtWords(const std::string& said) {
    for (const char* id : kDoubts)
        if (auto places = placesIn(said, config::Words::in("en").text(id));
            places && std::none_of(places->begin(), places->end(), [](const std::string& one) { return one.empty(); }))
            return words()(config::Phrase{id, std::move(*places)});
    return said;
}

std::string sittingPage(const Looker& who, const SittingView& view, const Names& names) {
    const school::ExamSitting& s = view.sitting;
    HtmlReport page = sitePage(fmt::format("{}: {}", view.title, examName(names, s.person)), who);
    if (view.seesDecisions) {
        const Tone tone = view.verdict == "pass" ? Tone::good : view.verdict == "fail" ? Tone::bad : Tone::note;
        page.paragraph(verdictWord(view.verdict), tone);
        if (view.verdict != "pass" && view.verdict != "fail" && view.verdict != "void")
            page.paragraph(examWord("machine-alone"), Tone::note);
    }
    std::vector<std::pair<std::string, std::string>> facts{
        {words()("school.state"), examWord(("state-" + s.state).c_str())},
        {examWord("began"), momentOf(s.began)},
        {words()("school.finished"), s.ended > 0 ? momentOf(s.ended) : "\u2013"},
        {examWord("arrived"), examWord(view.hasArrived ? "yes" : "no")},
        {examWord("station"), s.station.substr(0, 8)}};
    if (view.seesDecisions) facts.push_back({examWord("invigilator"), s.invigilator});
    page.facts({}, facts);
    if (view.seesWorth && view.hasArrived) {
        page.heading(examWord("work"));
        if (!view.score) {
            page.paragraph(words()("school.waits"), Tone::missing);
        } else {
            page.paragraph(fmt::format("{} {}", proofWord(view.score), worthOf(*view.score)),
                           view.score->state == "proven" ? Tone::good : Tone::bad);
            if (!view.score->reason.empty())
                page.paragraph(view.score->reason, view.score->state == "proven" ? Tone::note : Tone::bad);
            if (!view.score->result.empty()) page.link("/attempts/" + s.id + "/result", words()("school.whole-result"));
            page.link("/attempts/" + s.id + "/review", words()("school-live.review"));
        }
    }
    if (view.seesWorth && view.seesDecisions) {
        page.heading(examWord("look"));
        if (view.doubts.empty())
            page.paragraph(examWord("no-doubts"), Tone::note);
        else
            page.list(told(view.doubts));
    }
    if (view.seesDecisions) {
        addDecisions(page, view, names);
        page.link("/sittings/" + s.id + "/receipt", examWord("receipt"));
    }
    const std::string here = "/sittings/" + s.id;
    if (view.mayConfirm) {
        page.heading(examWord("confirm"));
        page.form(verdictForm(who, here + "/confirm", "confirm", false));
    }
    if (view.mayDecide) {
        page.heading(examWord("decide"));
        page.form(verdictForm(who, here + "/decide", "decide", true));
    }
    if (view.mayRemark) {
        page.heading(examWord("remark"));
        page.paragraph(examWord("remark-about"), Tone::note);
        page.form(verdictForm(who, here + "/remark", "remark", true));
    }
    if (view.mayAppeal) {
        page.heading(examWord("appeal"));
        FormField why{"words", examWord("why"), "textarea"};
        why.isRequired = true;
        page.form({here + "/appeal", {tokenField(who), why}, {{examWord("appeal")}}});
    }
    return page.text();
}

}  // namespace handpiece::report
