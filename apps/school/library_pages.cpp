// SPDX-License-Identifier: Apache-2.0
// Exercises, and what a class has to do with them.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>

#include "handpiece/app/report/report_html.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/store/teaching.h"
#include "school/library.h"
#include "school/teaching.h"

namespace handpiece::school_server {
namespace {

using config::words;
using report::FormField;
using report::HtmlReport;
using school::Action;
using school::Milliseconds;
using school::Teaching;
using Cell = HtmlReport::Cell;
using Tone = HtmlReport::Tone;

/// "2026-11-26T18:05" as a browser sends it, UTC.
std::optional<Milliseconds> momentIn(const std::string& typed) {
    int part[5] = {};
    constexpr const char* kBetween = "--T:";
    const char* at = typed.data();
    const char* const end = at + typed.size();
    for (int i = 0; i < 5; ++i) {
        const auto [next, ec] = std::from_chars(at, end, part[i]);
        if (ec != std::errc() || next == at) return {};
        at = next;
        if (i < 4 && (at == end || *at++ != kBetween[i])) return {};
    }
    // Seconds may stand behind.
    if (at != end && *at != ':') return {};
    const auto [year, month, day, hour, minute] = std::tie(part[0], part[1], part[2], part[3], part[4]);
    if (year < 1970 || year > 9999 || month < 1 || month > 12 || day < 1 || day > 31 || hour < 0 || hour > 23 ||
        minute < 0 || minute > 59)
        return {};
    using namespace std::chrono;
    const year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                              std::chrono::day(static_cast<unsigned>(day))};
    if (!date.ok()) return {};
    return duration_cast<milliseconds>(sys_days(date).time_since_epoch() + hours(hour) + minutes(minute)).count();
}
std::string typedOf(Milliseconds moment) {
    std::string text = report::momentOf(moment);
    text[10] = 'T';
    return text;
}

std::vector<FormField> timeFields(const Fields& typed, const std::map<std::string, std::string>& wrong) {
    std::vector<FormField> all;
    for (const auto& [name, label] :
         {std::pair("opens", "school-teaching.opens"), std::pair("closes", "school-teaching.closes")}) {
        FormField one{name, words()(label), "datetime-local", fieldOf(typed, name), words()("school-teaching.utc")};
        if (const auto found = wrong.find(name); found != wrong.end()) one.wrong = found->second;
        one.isRequired = true;
        all.push_back(std::move(one));
    }
    return all;
}
/// From both fields; `wrong` says what is the matter.
std::pair<Milliseconds, Milliseconds> timesIn(const Fields& typed, std::map<std::string, std::string>& wrong) {
    const auto opens = momentIn(fieldOf(typed, "opens")), closes = momentIn(fieldOf(typed, "closes"));
    if (!opens) wrong.emplace("opens", words()("school-teaching.no-time"));
    if (!closes) wrong.emplace("closes", words()("school-teaching.no-time"));
    if (opens && closes && *closes <= *opens) wrong.emplace("closes", words()("school-teaching.closes-first"));
    return {opens.value_or(0), closes.value_or(0)};
}

Page assignmentsPage(const Visit& v, const std::string& schoolClass, const Fields& typed,
                     const std::map<std::string, std::string>& wrong) {
    const Teaching teaching(v.books);
    std::string name = schoolClass;
    for (const school::SchoolClass& one : v.books.classes())
        if (one.id == schoolClass) name = one.name;
    HtmlReport page = report::sitePage(words()("school-teaching.assignments-of", name), lookerOf(v));
    page.link("/classes/" + schoolClass, words()("school-teaching.back-to-class"));
    std::vector<std::vector<Cell>> rows;
    for (const school::Assignment& a : v.books.assignments(schoolClass))
        rows.push_back({{a.title, "/assignments/" + a.id},
                        {words()(a.kind == "exam" ? "school-teaching.exam" : "school-teaching.practice")},
                        {report::momentOf(a.opens)},
                        {report::momentOf(a.closes)}});
    if (rows.empty())
        page.paragraph(words()("school-teaching.no-assignments"), Tone::missing);
    else
        page.linkedTable({words()("school-teaching.assignment"), words()("school-teaching.kind"),
                          words()("school-teaching.opens"), words()("school-teaching.closes")},
                         rows, words()("school-teaching.times-utc"));
    page.heading(words()("school-teaching.new-assignment"));
    if (!wrong.empty()) page.paragraph(words()("school-teaching.wrong", wrong.size()), Tone::bad);
    std::vector<FormField::Choice> packs;
    for (const school::Pack& one : teaching.packs())
        packs.push_back({one.hash, fmt::format("{} ({})", one.title, one.exercise)});
    if (packs.empty()) {
        page.paragraph(words()("school-teaching.no-exercises"), Tone::missing);
        page.link("/exercises", words()("school-teaching.exercises"));
        return {200, page.text()};
    }
    const auto said = [&](FormField field) {
        if (const auto found = wrong.find(field.name); found != wrong.end()) field.wrong = found->second;
        return field;
    };
    report::Form form{"/classes/" + schoolClass + "/assignments", {report::tokenField(lookerOf(v))}, {}};
    form.fields.push_back(
        said({"pack", words()("school.exercise"), "select", fieldOf(typed, "pack"), {}, {}, std::move(packs)}));
    form.fields.push_back(said({"title", words()("school-teaching.title"), "text", fieldOf(typed, "title"),
                                words()("school-teaching.title-hint")}));
    form.fields.push_back(
        said({"kind",
              words()("school-teaching.kind"),
              "select",
              fieldOf(typed, "kind"),
              {},
              {},
              {{"practice", words()("school-teaching.practice")}, {"exam", words()("school-teaching.exam")}}}));
    form.fields.push_back(said({"helps", words()("school-teaching.helps"), "text", fieldOf(typed, "helps"),
                                words()("school-teaching.helps-hint")}));
    for (FormField& field : timeFields(typed, wrong))
        form.fields.push_back(std::move(field));
    form.buttons = {{words()("school-teaching.assign")}};
    page.form(form);
    return {wrong.empty() ? 200 : 422, page.text()};
}

}  // namespace

Page exercisesOf(const Visit& v, const Told& told) {
    if (!may(v, Action::setExercise, {})) return notYours();
    HtmlReport page = report::sitePage(words()("school-teaching.exercises"), lookerOf(v), "/exercises");
    if (!told.text.empty()) page.paragraph(told.text, told.isWrong ? Tone::bad : Tone::good);
    std::vector<std::vector<Cell>> rows;
    for (const school::Pack& one : Teaching(v.books).packs())
        rows.push_back({{one.title, "/exercises/" + one.hash},
                        {one.exercise},
                        {one.rubric, "/rubrics/" + one.rubric},
                        {one.hash},
                        {report::momentOf(one.made)}});
    if (rows.empty())
        page.paragraph(words()("school-teaching.no-exercises"), Tone::missing);
    else
        page.linkedTable({words()("school-teaching.title"), words()("school.exercise"),
                          words()("school-teaching.rubric"), words()("school-teaching.hash"), words()("school.made")},
                         rows, words()("school-teaching.exercises-about"));
    page.heading(words()("school-teaching.upload-exercise"));
    FormField file{"file", words()("school-teaching.exercise-file"), "file"};
    file.hint = words()("school-teaching.exercise-hint", kMostExercise >> 20);
    file.isRequired = true;
    page.form({"/exercises", {report::tokenField(lookerOf(v)), file}, {{words()("school-teaching.upload")}}});
    return {told.isWrong ? 422 : 200, page.text()};
}

Page addExercise(const Visit& v, const std::string& file) {
    if (!may(v, Action::setExercise, {})) return notYours();
    if (file.empty()) return exercisesOf(v, {words()("school-teaching.no-file"), true});
    if (file.size() > kMostExercise)
        return exercisesOf(v, {words()("school-teaching.too-large", kMostExercise >> 20), true});
    const core::PrivateFolder folder;
    const std::filesystem::path path = folder.path() / "exercise.handpiece";
    core::writeFile(path, std::string_view(file));
    try {
        return {303, {}, "/exercises/" + addExercise(v.books, path, actOf(v)).hash};
    } catch (const core::Error& error) {
        if (error.id().starts_with("store") || error.id() == "no-space") throw;
        // Where it lies here is nobody's business.
        std::string where = error.id().starts_with("books-") ? path.string() : error.where();
        if (const std::size_t at = where.find(path.string()); at != std::string::npos)
            where.replace(at, path.string().size(), "exercise.handpiece");
        return exercisesOf(v, {words()("school-teaching.not-taken",
                                       fmt::format("{}: {}{}", where, error.problem(),
                                                   error.remedy().empty() ? "" : " (" + error.remedy() + ")")),
                               true});
    }
}

Page exerciseOf(const Visit& v, const std::string& hash, Readings& readings) {
    if (!may(v, Action::setExercise, {})) return notYours();
    const auto pack = v.books.pack(hash);
    if (!pack) return notYours();
    const sandboxed::Exercise task = readings.exercise(v.books, hash);
    HtmlReport page = report::sitePage(
        task.title.empty() ? pack->title : std::string(cases::inLanguage(task.title, words().language())), lookerOf(v));
    page.link("/exercises", words()("school-teaching.exercises"));
    if (!task.instructions.empty())
        page.paragraph(std::string(cases::inLanguage(task.instructions, words().language())));
    page.facts({}, {{words()("school.exercise"),
                     fmt::format("{}, {} {}", task.id, words()("school-teaching.version"), task.version)},
                    {words()("school-teaching.tooth"), task.tooth},
                    {words()("school-teaching.level"), task.level},
                    {words()("school-teaching.minutes"), task.minutes ? fmt::format("{:g}", *task.minutes) : ""},
                    {words()("school-teaching.voxel"), fmt::format("{:g} mm", task.voxelMm)},
                    {words()("school-teaching.preparation"),
                     words()(task.hasPreparation ? "school-teaching.yes" : "school-teaching.no")},
                    {words()("school-teaching.hash"), hash}});
    page.link("/rubrics/" + pack->rubric, words()("school-teaching.its-rubric"));
    page.heading(words()("school-teaching.in-words"));
    page.code(rubric::describe(rubric::parseRubric(task.rubric, "rubric.toml"), words().language()));
    page.heading(words()("school-teaching.given-to"));
    bool isAny = false;
    for (const school::SchoolClass& one : v.books.classes()) {
        if (!may(v, Action::assign, relationToClass(v, one.id))) continue;
        isAny = true;
        page.link("/classes/" + one.id + "/assignments", words()("school-teaching.assign-to", one.name));
    }
    if (!isAny) page.paragraph(words()("school.no-classes"), Tone::note);
    return {200, page.text()};
}

Page assignmentOf(const Visit& v, const std::string& assignment, const Told& told) {
    const auto of = assignedFor(v, assignment, Action::markBlind);
    if (!of) return notYours();
    const school::Assignment& a = of->assignment;
    const std::string at = "/assignments/" + assignment;
    HtmlReport page = report::sitePage(a.title, lookerOf(v));
    const bool isTeacher = may(v, Action::assign, of->relation);
    if (isTeacher) page.link("/classes/" + a.schoolClass + "/assignments", words()("school-teaching.back-to-class"));
    if (!told.text.empty()) page.paragraph(told.text, told.isWrong ? Tone::bad : Tone::good);
    std::vector<std::pair<std::string, std::string>> facts{
        {words()("school-teaching.kind"),
         words()(a.kind == "exam" ? "school-teaching.exam" : "school-teaching.practice")},
        {words()("school-teaching.opens"), report::momentOf(a.opens) + " UTC"},
        {words()("school-teaching.closes"), report::momentOf(a.closes) + " UTC"},
        {words()("school-teaching.helps"), a.helps},
        {words()("school-teaching.rubric"), fmt::format("{} {}", of->rubric.id, of->rubricHash)},
        {words()("school-teaching.pass-mark"), of->rubric.passMark ? fmt::format("{:g} %", *of->rubric.passMark) : ""}};
    for (auto& line : keptStandards(v, assignment))
        facts.push_back(std::move(line));
    page.facts({}, facts);
    page.link(at + "/marking", words()("school-teaching.your-desk"));
    page.link(at + "/exemplars", words()("school-teaching.exemplars"));
    page.link(at + "/standard", words()("school-teaching.standards"));
    if (!isTeacher) return {200, page.text()};
    page.link(at + "/marks", words()("school-teaching.all-marks"));
    page.link(at + "/agreement", words()("school-teaching.agreement"));
    page.link(at + "/rescore", words()("school-teaching.rescore"));
    page.link("/exercises/" + a.pack, words()("school.exercise"));
    page.link("/rubrics/" + of->rubricHash, words()("school-teaching.its-rubric"));
    page.heading(words()("school-teaching.change-times"));
    report::Form form{at, {report::tokenField(lookerOf(v))}, {{words()("school-teaching.set")}}};
    for (FormField& field : timeFields({{"opens", typedOf(a.opens)}, {"closes", typedOf(a.closes)}}, {}))
        form.fields.push_back(std::move(field));
    page.form(form);
    return {told.isWrong ? 422 : 200, page.text()};
}

Page setTimes(const Visit& v, const std::string& assignment, const Fields& fields) {
    const auto of = assignedFor(v, assignment, Action::assign);
    if (!of) return notYours();
    std::map<std::string, std::string> wrong;
    const auto [opens, closes] = timesIn(fields, wrong);
    if (!wrong.empty())
        return assignmentOf(v, assignment, {words()("school-teaching.times-wrong", wrong.begin()->second), true});
    Teaching(v.books).setTimes(assignment, opens, closes, actOf(v));
    return assignmentOf(v, assignment, {words()("school-teaching.times-set"), false});
}

Page assignmentsOf(const Visit& v, const std::string& schoolClass) {
    if (!may(v, Action::assign, relationToClass(v, schoolClass))) return notYours();
    constexpr Milliseconds kDays = 86'400'000;
    return assignmentsPage(
        v, schoolClass, {{"opens", typedOf(v.now)}, {"closes", typedOf(v.now + 14 * kDays)}, {"kind", "practice"}}, {});
}

Page assign(const Visit& v, const std::string& schoolClass, const Fields& fields) {
    if (!may(v, Action::assign, relationToClass(v, schoolClass))) return notYours();
    constexpr std::size_t kMostTitle = 200;
    std::map<std::string, std::string> wrong;
    const auto [opens, closes] = timesIn(fields, wrong);
    const auto pack = v.books.pack(fieldOf(fields, "pack"));
    if (!pack) wrong.emplace("pack", words()("school-teaching.choose-one"));
    const std::string kind = fieldOf(fields, "kind"), title = fieldOf(fields, "title"),
                      helps = fieldOf(fields, "helps");
    if (kind != "practice" && kind != "exam") wrong.emplace("kind", words()("school-teaching.choose-one"));
    if (title.size() > kMostTitle) wrong.emplace("title", words()("school-teaching.too-long", kMostTitle));
    const bool areHelps = helps.size() <= kMostTitle && std::all_of(helps.begin(), helps.end(), [](char c) {
                              return (c >= 'a' && c <= 'z') || c == '-' || c == ' ';
                          });
    if (!areHelps) wrong.emplace("helps", words()("school-teaching.no-helps"));
    if (!wrong.empty()) return assignmentsPage(v, schoolClass, fields, wrong);
    const school::Assignment made{school::newId(),
                                  schoolClass,
                                  pack->hash,
                                  pack->rubric,
                                  title.find_first_not_of(' ') == std::string::npos ? pack->title : title,
                                  kind,
                                  helps,
                                  opens,
                                  closes};
    v.books.add(made, actOf(v));
    return {303, {}, "/assignments/" + made.id};
}

}  // namespace handpiece::school_server
