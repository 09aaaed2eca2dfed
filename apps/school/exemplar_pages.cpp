// SPDX-License-Identifier: Apache-2.0
// Works that show how marks are meant, and how near to them a new marker is.
#include <fmt/format.h>

#include <algorithm>

#include "handpiece/app/marking/desk_agreement.h"
#include "handpiece/app/report/assessment_words.h"
#include "handpiece/app/report/report_html.h"
#include "handpiece/base/config/words.h"
#include "handpiece/school/store/teaching.h"
#include "school/teaching.h"

namespace handpiece::school_server {
namespace {

using config::words;
using report::HtmlReport;
using school::Action;
using school::Teaching;
using Cell = HtmlReport::Cell;
using Tone = HtmlReport::Tone;

/// Marker and consensus beside each other.
void addComparison(HtmlReport& page, const rubric::Rubric& rubric, const Sheet& own, const Sheet& consensus,
                   const std::string& caption) {
    std::vector<std::vector<std::string>> rows;
    for (const std::string& id : marking::askedOf(rubric)) {
        std::string difference;
        const auto a = own.marks.find(id), b = consensus.marks.find(id);
        if (a != own.marks.end() && b != consensus.marks.end()) {
            if (a->second.points && b->second.points)
                difference = fmt::format("{:+g}", *a->second.points - *b->second.points);
            else
                difference = words()(a->second == b->second ? "school-teaching.same" : "school-teaching.other");
        }
        std::string why;
        for (const marking::Comment& comment : consensus.comments)
            if (comment.criterion == id) why = comment.text;
        rows.push_back({id == marking::kTotal ? words()("agreement.all-points") : report::criterionTitle(rubric, id),
                        markText(rubric, own, id), markText(rubric, consensus, id), difference, why});
    }
    const auto rating = [](const Sheet& sheet) { return sheet.rating > 0 ? ratingWord(sheet.rating) : "\u2013"; };
    rows.push_back({words()("school-teaching.rating"), rating(own), rating(consensus),
                    words()(own.rating == consensus.rating ? "school-teaching.same" : "school-teaching.other"), ""});
    page.table(
        {words()("assessment.criterion"), words()("school-teaching.your-mark"), words()("school-teaching.consensus"),
         words()("school-teaching.difference"), words()("school-teaching.why")},
        rows, caption);
}

/// The assignment of an attempt that they may make an exemplar of.
std::optional<std::pair<Assigned, school::PushedAttempt>> toShow(const Visit& v, const std::string& id) {
    auto attempt = v.books.attempt(id);
    if (!attempt || attempt->assignment.empty() || !may(v, Action::mark, relationTo(v, *attempt))) return {};
    auto of = assignedFor(v, attempt->assignment, Action::mark);
    if (!of || !visibleOf(v, *attempt).marks) return {};
    return std::pair(std::move(*of), std::move(*attempt));
}

Page exemplarPage(const Visit& v, const Assigned& of, const school::PushedAttempt& attempt, const Fields& typed,
                  const std::map<std::string, std::string>& wrong, bool isSet, Readings& readings) {
    HtmlReport page =
        report::sitePage(words()("school-teaching.exemplar-work", attempt.attempt.id.substr(0, 6)), lookerOf(v));
    page.link("/assignments/" + of.assignment.id + "/exemplars", words()("school-teaching.exemplars"));
    if (!wrong.empty()) page.paragraph(words()("school-teaching.wrong", wrong.size()), Tone::bad);
    page.paragraph(words()("school-teaching.exemplar-about"), Tone::note);
    addPicture(page, v, attempt, of.assignment.pack, readings);
    page.heading(words()("school-teaching.consensus"));
    report::Form form{"/attempts/" + attempt.attempt.id + "/exemplar", {report::tokenField(lookerOf(v))}, {}};
    for (report::FormField& field : sheetFields(of.rubric, typed, wrong))
        form.fields.push_back(std::move(field));
    form.buttons = {{words()("school-teaching.set-exemplar"), "do", "set"}};
    if (isSet) form.buttons.push_back({words()("school-teaching.remove-exemplar"), "do", "remove", true});
    page.form(form);
    return {wrong.empty() ? 200 : 422, page.text()};
}

/// Exemplar `number` of an assignment, from 1; never of the marker's own work.
struct Calibrated {
    Assigned of;
    school::Exemplar exemplar;
    school::PushedAttempt attempt;
};
std::optional<Calibrated> toCalibrate(const Visit& v, const std::string& assignment, std::size_t number) {
    auto of = assignedFor(v, assignment, Action::markBlind);
    if (!of) return {};
    const std::vector<school::Exemplar> all = Teaching(v.books).exemplars(assignment);
    if (number < 1 || number > all.size()) return {};
    auto attempt = v.books.attempt(all[number - 1].attempt);
    if (!attempt || attempt->person == v.person.code) return {};
    return Calibrated{std::move(*of), all[number - 1], std::move(*attempt)};
}

std::optional<school::Calibration> ownOf(const Visit& v, const std::string& assignment, const std::string& attempt) {
    for (school::Calibration& one : Teaching(v.books).calibrations(assignment))
        if (one.marker == v.person.code && one.attempt == attempt) return std::move(one);
    return {};
}

Page calibrationPage(const Visit& v, const Calibrated& of, std::size_t number, const Fields& typed,
                     const std::map<std::string, std::string>& wrong, Readings& readings) {
    HtmlReport page = report::sitePage(words()("school-teaching.exemplar-number", number), lookerOf(v));
    page.link("/assignments/" + of.of.assignment.id + "/exemplars", words()("school-teaching.exemplars"));
    if (!wrong.empty()) page.paragraph(words()("school-teaching.wrong", wrong.size()), Tone::bad);
    addPicture(page, v, of.attempt, of.of.assignment.pack, readings);
    if (const auto own = ownOf(v, of.of.assignment.id, of.exemplar.attempt)) {
        page.heading(words()("school-teaching.you-and-consensus"));
        addComparison(page, of.of.rubric, readSheet(of.of.rubric, parseSheet(own->content)),
                      readSheet(of.of.rubric, parseSheet(of.exemplar.content)),
                      words()("school-teaching.you-and-consensus"));
        return {200, page.text()};
    }
    page.heading(words()("school-teaching.your-marks"));
    page.paragraph(words()("school-teaching.calibrate-about"), Tone::note);
    report::Form form{fmt::format("/assignments/{}/exemplars/{}", of.of.assignment.id, number),
                      {report::tokenField(lookerOf(v))},
                      {}};
    for (report::FormField& field : sheetFields(of.of.rubric, typed, wrong))
        form.fields.push_back(std::move(field));
    form.buttons = {{words()("school-teaching.compare")}};
    page.form(form);
    return {wrong.empty() ? 200 : 422, page.text()};
}

}  // namespace

std::size_t exemplarsOpen(const Visit& v, const std::string& assignment) {
    const Teaching teaching(v.books);
    const std::vector<school::Calibration> done = teaching.calibrations(assignment);
    std::size_t open = 0;
    for (const school::Exemplar& one : teaching.exemplars(assignment)) {
        const auto attempt = v.books.attempt(one.attempt);
        // Who said what is meant, and whose work it is, have nothing to learn of it.
        if (!attempt || one.who == v.person.code || attempt->person == v.person.code) continue;
        open += std::none_of(done.begin(), done.end(), [&](const school::Calibration& c) {
            return c.marker == v.person.code && c.attempt == one.attempt;
        });
    }
    return open;
}

Page exemplarsOf(const Visit& v, const std::string& assignment, const Told& told) {
    const auto of = assignedFor(v, assignment, Action::markBlind);
    if (!of) return notYours();
    const Teaching teaching(v.books);
    HtmlReport page = report::sitePage(words()("school-teaching.exemplars-of", of->assignment.title), lookerOf(v));
    page.link("/assignments/" + assignment, words()("school-teaching.back-to-assignment", of->assignment.title));
    if (!told.text.empty()) page.paragraph(told.text, told.isWrong ? Tone::bad : Tone::good);
    page.paragraph(words()("school-teaching.exemplars-about"), Tone::note);
    const bool isTeacher = may(v, Action::mark, of->relation);
    const std::vector<school::Exemplar> all = teaching.exemplars(assignment);
    const std::vector<school::Calibration> done = teaching.calibrations(assignment);
    const auto hasDone = [&](const school::Exemplar& one) {
        return std::any_of(done.begin(), done.end(), [&](const school::Calibration& c) {
            return c.marker == v.person.code && c.attempt == one.attempt;
        });
    };
    std::vector<std::vector<Cell>> rows;
    for (std::size_t i = 0; i < all.size(); ++i) {
        std::vector<Cell> row{{words()("school-teaching.exemplar-number", i + 1),
                               fmt::format("/assignments/{}/exemplars/{}", assignment, i + 1)},
                              {all[i].who == v.person.code ? words()("school-teaching.yours")
                               : hasDone(all[i])           ? words()("school-teaching.given-in")
                                                           : words()("school-teaching.open")}};
        if (isTeacher && seesMarks(v, *of))
            row.push_back({words()("school-teaching.consensus"), "/attempts/" + all[i].attempt + "/exemplar"});
        rows.push_back(std::move(row));
    }
    if (rows.empty()) {
        page.paragraph(words()("school-teaching.no-exemplars"), Tone::missing);
    } else {
        std::vector<std::string> header{words()("school-teaching.exemplar"), words()("school.state")};
        if (rows.front().size() > 2) header.push_back(words()("school-teaching.consensus"));
        page.linkedTable(header, rows, words()("school-teaching.exemplars"));
    }
    // Agreement with what was agreed: of oneself, or of all to who set them.
    const std::vector<std::string> asked = marking::askedOf(of->rubric);
    const std::string consensus = words()("school-teaching.consensus");
    std::string csv = marking::marksHead();
    std::size_t told_ = 0;
    for (const school::Exemplar& one : all)
        csv += marking::marksLines(one.attempt, consensus, asked, readSheet(of->rubric, parseSheet(one.content)).marks);
    for (const school::Calibration& one : done) {
        if (one.marker != v.person.code && !(isTeacher && exemplarsOpen(v, assignment) == 0)) continue;
        ++told_;
        csv +=
            marking::marksLines(one.attempt, one.marker, asked, readSheet(of->rubric, parseSheet(one.content)).marks);
    }
    if (told_ > 0 && exemplarsOpen(v, assignment) == 0) {
        page.heading(words()("school-teaching.with-consensus"));
        constexpr std::size_t kDraws = 200;
        std::vector<std::vector<std::string>> lines;
        for (const assessment::CriterionAgreement& c :
             marking::agreementOfMarks(of->rubric, csv, "the books", kDraws).criteria)
            for (const assessment::RaterPair& p : c.pairs) {
                if (p.first != consensus && p.second != consensus) continue;
                const std::string& marker = p.first == consensus ? p.second : p.first;
                std::string kappa = "\u2013", bias = "\u2013";
                const auto& weighted = p.linear ? p.linear : p.kappa;
                if (weighted)
                    kappa = weighted->value ? fmt::format("{:.2f}", *weighted->value) : report::said(weighted->reason);
                if (p.blandAltman && p.blandAltman->bias)
                    // Marker less consensus, whichever stands first.
                    bias = fmt::format("{:+.2f}", (p.first == consensus ? -1.0 : 1.0) * *p.blandAltman->bias);
                lines.push_back({c.title, marker, fmt::format("{}", p.items), kappa, bias});
            }
        page.table({words()("assessment.criterion"), words()("school.marker"), words()("class.count"),
                    words()("school-teaching.kappa"), words()("school-teaching.bias")},
                   lines, words()("school-teaching.with-consensus"));
    }
    if (isTeacher && seesMarks(v, *of)) {
        page.heading(words()("school-teaching.choose-exemplar"));
        std::vector<std::vector<Cell>> works;
        for (const std::string& id : teaching.worksOf(assignment))
            works.push_back({{id.substr(0, 6), "/attempts/" + id + "/exemplar"}});
        if (works.empty())
            page.paragraph(words()("school-teaching.no-works"), Tone::missing);
        else
            page.linkedTable({words()("school-teaching.attempt")}, works, words()("school-teaching.choose-exemplar"));
    }
    return {told.isWrong ? 422 : 200, page.text()};
}

Page exemplarOf(const Visit& v, const std::string& id, Readings& readings) {
    const auto of = toShow(v, id);
    if (!of) return notYours();
    noteLook(v, "exemplar seen", id);
    for (const school::Exemplar& one : Teaching(v.books).exemplars(of->first.assignment.id))
        if (one.attempt == id)
            return exemplarPage(v, of->first, of->second, parseSheet(one.content), {}, true, readings);
    return exemplarPage(v, of->first, of->second, {}, {}, false, readings);
}

Page setExemplar(const Visit& v, const std::string& id, const Fields& fields, Readings& readings) {
    const auto of = toShow(v, id);
    if (!of) return notYours();
    Teaching teaching(v.books);
    const std::string& assignment = of->first.assignment.id;
    const school::Act act{v.person.code, v.now};
    const std::vector<school::Exemplar> all = teaching.exemplars(assignment);
    const bool isSet =
        std::any_of(all.begin(), all.end(), [&](const school::Exemplar& one) { return one.attempt == id; });
    if (fieldOf(fields, "do") == "remove") {
        if (isSet) teaching.removeExemplar(id, act);
        return {303, {}, "/assignments/" + assignment + "/exemplars"};
    }
    const Sheet sheet = readSheet(of->first.rubric, fields);
    if (!sheet.wrong.empty()) return exemplarPage(v, of->first, of->second, fields, sheet.wrong, isSet, readings);
    teaching.set(school::Exemplar{id, assignment, sheetJson(fields), v.person.code}, act);
    return {303, {}, "/assignments/" + assignment + "/exemplars"};
}

Page calibrationOf(const Visit& v, const std::string& assignment, std::size_t number, Readings& readings) {
    const auto of = toCalibrate(v, assignment, number);
    if (!of) return notYours();
    noteLook(v, "exemplar seen", of->exemplar.attempt);
    return calibrationPage(v, *of, number, {}, {}, readings);
}

Page calibrate(const Visit& v, const std::string& assignment, std::size_t number, const Fields& fields,
               Readings& readings) {
    const auto of = toCalibrate(v, assignment, number);
    if (!of) return notYours();
    const Sheet sheet = readSheet(of->of.rubric, fields);
    if (!sheet.wrong.empty()) return calibrationPage(v, *of, number, fields, sheet.wrong, readings);
    // The first counts: who knows the consensus does not mark anew.
    (void)Teaching(v.books).add(school::Calibration{of->exemplar.attempt, v.person.code, sheetJson(fields)},
                                {v.person.code, v.now});
    return {303, {}, fmt::format("/assignments/{}/exemplars/{}", assignment, number)};
}

}  // namespace handpiece::school_server
