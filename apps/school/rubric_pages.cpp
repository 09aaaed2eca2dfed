// SPDX-License-Identifier: Apache-2.0
// Rubrics as forms and as text, their versions, and work scored again by another one.
#include <fmt/format.h>

#include <algorithm>

#include "handpiece/app/report/assessment_words.h"
#include "handpiece/app/report/report_html.h"
#include "handpiece/assess/rubric/lint.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/school/store/teaching.h"
#include "school/teaching.h"

namespace handpiece::school_server {
namespace {

using config::words;
using report::FormField;
using report::HtmlReport;
using school::Action;
using school::Teaching;
using Cell = HtmlReport::Cell;
using Tone = HtmlReport::Tone;

std::string typedOf(const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string();
}
std::string typedOf(const std::vector<rubric::Knot>& knots) {
    std::string text;
    for (const rubric::Knot& knot : knots)
        text += fmt::format("{}{} {}", text.empty() ? "" : "; ", knot.value, knot.points);
    return text;
}
std::string localOf(const rubric::Texts& texts) {
    if (const auto own = texts.find(words().language()); own != texts.end()) return own->second;
    return texts.empty() ? std::string() : texts.begin()->second;
}

/// What a form changes of a rubric, and what of it cannot be read.
class RubricForm {
  public:
    RubricForm(rubric::Rubric rubric, const Fields& fields) : rubric_(std::move(rubric)), fields_(fields) {
        readText("version", rubric_.version);
        readTitle("title", rubric_.title);
        readNumber("pass_mark", rubric_.passMark);
        if (rubric_.completeness) readKnots("completeness", rubric_.completeness->knots);
        for (std::size_t i = 0; i < rubric_.criteria.size(); ++i) {
            rubric::Criterion& c = rubric_.criteria[i];
            const std::string at = fmt::format("{}.", i);
            readTitle(at + "title", c.title);
            std::optional<double> weight = c.isGraded() ? std::optional(c.weight) : std::nullopt;
            readNumber(at + "weight", weight);
            c.weight = weight.value_or(0.0);
            readKnots(at + "knots", c.knots);
            for (std::size_t k = 0; k < c.bands.size(); ++k) {
                const std::string band = fmt::format("{}band{}.", at, k);
                readNumber(band + "from", c.bands[k].from);
                readNumber(band + "to", c.bands[k].to);
                readNumber(band + "points", c.bands[k].points);
            }
            rubric::Critical critical = c.critical.value_or(rubric::Critical{});
            readNumber(at + "below", critical.below);
            readNumber(at + "above", critical.above);
            if (critical.below || critical.above)
                c.critical = critical;
            else
                c.critical.reset();
        }
        // The sum that the file states goes with the weights that the form has.
        if (rubric_.totalWeight) {
            double sum = 0.0;
            for (const rubric::Criterion& c : rubric_.criteria)
                sum += c.weight;
            rubric_.totalWeight = sum;
        }
    }
    [[nodiscard]] const rubric::Rubric& rubric() const { return rubric_; }
    [[nodiscard]] const std::map<std::string, std::string>& wrong() const { return wrong_; }

  private:
    [[nodiscard]] bool has(const std::string& name) const { return fields_.contains(name); }
    void readText(const std::string& name, std::string& text) {
        if (has(name)) text = fieldOf(fields_, name);
    }
    void readTitle(const std::string& name, rubric::Texts& texts) {
        if (!has(name) || fieldOf(fields_, name) == localOf(texts)) return;
        texts[words().language()] = fieldOf(fields_, name);
    }
    void readNumber(const std::string& name, std::optional<double>& value) {
        if (!has(name)) return;
        const std::string typed = fieldOf(fields_, name);
        if (typed.find_first_not_of(' ') == std::string::npos) return value.reset();
        if (const std::optional<double> read = numberIn(typed))
            value = *read;
        else
            wrong_.emplace(name, words()("school-teaching.no-number"));
    }
    void readKnots(const std::string& name, std::vector<rubric::Knot>& knots) {
        if (!has(name)) return;
        std::vector<rubric::Knot> read;
        std::string rest = fieldOf(fields_, name);
        while (rest.find_first_not_of(" ;") != std::string::npos) {
            const std::size_t end = rest.find(';');
            std::string one = rest.substr(0, end);
            rest = end == std::string::npos ? std::string() : rest.substr(end + 1);
            one.erase(0, one.find_first_not_of(' '));
            const std::size_t gap = one.find(' ');
            const std::optional<double> value = numberIn(one.substr(0, gap)),
                                        points = gap == std::string::npos ? std::nullopt : numberIn(one.substr(gap));
            if (!value || !points) {
                wrong_.emplace(name, words()("school-teaching.no-knots"));
                return;
            }
            read.push_back({*value, *points});
        }
        knots = std::move(read);
    }

    rubric::Rubric rubric_;
    const Fields& fields_;
    std::map<std::string, std::string> wrong_;
};

/// As the form shows it first.
Fields fieldsOf(const rubric::Rubric& rubric) {
    Fields fields{
        {"version", rubric.version}, {"title", localOf(rubric.title)}, {"pass_mark", typedOf(rubric.passMark)}};
    if (rubric.completeness) fields.emplace("completeness", typedOf(rubric.completeness->knots));
    for (std::size_t i = 0; i < rubric.criteria.size(); ++i) {
        const rubric::Criterion& c = rubric.criteria[i];
        const std::string at = fmt::format("{}.", i);
        fields.emplace(at + "title", localOf(c.title));
        fields.emplace(at + "weight", c.isGraded() ? fmt::format("{}", c.weight) : std::string());
        fields.emplace(at + "knots", typedOf(c.knots));
        for (std::size_t k = 0; k < c.bands.size(); ++k) {
            const std::string band = fmt::format("{}band{}.", at, k);
            fields.emplace(band + "from", typedOf(c.bands[k].from));
            fields.emplace(band + "to", typedOf(c.bands[k].to));
            fields.emplace(band + "points", typedOf(c.bands[k].points));
        }
        fields.emplace(at + "below", c.critical ? typedOf(c.critical->below) : std::string());
        fields.emplace(at + "above", c.critical ? typedOf(c.critical->above) : std::string());
    }
    return fields;
}

report::Form rubricForm(const Visit& v, const std::string& hash, const rubric::Rubric& rubric, const Fields& typed,
                        const std::map<std::string, std::string>& wrong) {
    report::Form form{"/rubrics/check", {report::tokenField(lookerOf(v)), {"of", {}, "hidden", hash}}, {}};
    const auto field = [&](const std::string& name, std::string label, std::string hint = {}) {
        FormField one{name, std::move(label), "text", fieldOf(typed, name), std::move(hint)};
        if (const auto found = wrong.find(name); found != wrong.end()) one.wrong = found->second;
        form.fields.push_back(std::move(one));
    };
    const auto group = [&](const std::string& legend) { form.fields.push_back({{}, legend, "group"}); };
    const auto end = [&] { form.fields.push_back({{}, {}, "end"}); };
    group(words()("school-teaching.rubric-whole"));
    field("title", words()("school-teaching.title"));
    field("version", words()("school-teaching.version"));
    field("pass_mark", words()("school-teaching.pass-mark"), words()("school-teaching.pass-mark-hint"));
    if (rubric.completeness)
        field("completeness", words()("school-teaching.completeness"),
              words()("school-teaching.completeness-hint", rubric.completeness->unit));
    end();
    for (std::size_t i = 0; i < rubric.criteria.size(); ++i) {
        const rubric::Criterion& c = rubric.criteria[i];
        const std::string at = fmt::format("{}.", i);
        group(fmt::format("{} ({}{})", report::criterionTitle(rubric, c.id), c.measure,
                          c.unit.empty() ? "" : ", " + c.unit));
        field(at + "title", words()("school-teaching.title"));
        field(at + "weight", words()("school-teaching.weight"), words()("school-teaching.weight-hint"));
        field(at + "knots", words()("school-teaching.knots"), words()("school-teaching.knots-hint", c.unit));
        for (std::size_t k = 0; k < c.bands.size(); ++k) {
            const std::string band = fmt::format("{}band{}.", at, k), title = report::bandTitle(rubric, c.bands[k].id);
            field(band + "from", words()("school-teaching.band-from", title), c.unit);
            field(band + "to", words()("school-teaching.band-to", title), c.unit);
            field(band + "points", words()("school-teaching.band-points", title),
                  words()("school-teaching.band-points-hint"));
        }
        field(at + "below", words()("school-teaching.critical-below"), c.unit);
        field(at + "above", words()("school-teaching.critical-above"), c.unit);
        end();
    }
    form.buttons = {{words()("school-teaching.check")}};
    return form;
}

report::Form textForm(const Visit& v, const std::string& text) {
    FormField area{"text", words()("school-teaching.rubric-text"), "textarea", text,
                   words()("school-teaching.rubric-text-hint")};
    return {"/rubrics/check", {report::tokenField(lookerOf(v)), area}, {{words()("school-teaching.check")}}};
}

/// What is wrong with it, in the program's language; true where it can be used.
bool addFindings(HtmlReport& page, const rubric::Rubric& rubric) {
    bool isSound = true;
    std::vector<std::vector<std::string>> rows;
    for (const rubric::SaidFinding& one : rubric::lint(rubric)) {
        isSound = isSound && one.finding.severity != rubric::Severity::error;
        const char* severity = one.finding.severity == rubric::Severity::error     ? "school-teaching.error"
                               : one.finding.severity == rubric::Severity::warning ? "school-teaching.warning"
                                                                                   : "school-teaching.remark";
        rows.push_back({words()(severity),
                        one.about.empty() ? words()("school-teaching.rubric-whole") : words()(one.about),
                        words()(one.problem), words()(one.remedy)});
    }
    if (!rows.empty())
        page.table({words()("school-teaching.finding"), words()("school-teaching.where"),
                    words()("school-teaching.what"), words()("school-teaching.what-to-do")},
                   rows, words()("school-teaching.findings"));
    return isSound;
}

bool maySetRubrics(const Visit& v) {
    return may(v, Action::setExercise, {});
}

/// The newest of its id.
std::optional<school::RubricVersion> newestOf(const Teaching& teaching, const std::string& id) {
    std::optional<school::RubricVersion> newest;
    for (school::RubricVersion& one : teaching.rubrics())
        if (one.id == id) newest = std::move(one);
    return newest;
}

std::string scoreText(const school::Score& score) {
    if (score.state == "refused") return words()("school.refused");
    return score.maxScore > 0.0 ? fmt::format("{:.1f} / {:.1f}", score.score, score.maxScore)
                                : words()("school.no-score");
}
std::string passedText(const std::string& passed) {
    return passed == "yes"  ? words()("assessment.passed")
           : passed == "no" ? words()("assessment.not-passed")
                            : words()("assessment.teacher");
}

}  // namespace

Page rubricsOf(const Visit& v) {
    if (!maySetRubrics(v)) return notYours();
    HtmlReport page = report::sitePage(words()("school-teaching.rubrics"), lookerOf(v), "/rubrics");
    std::vector<std::vector<Cell>> rows;
    for (const school::RubricVersion& one : Teaching(v.books).rubrics())
        rows.push_back({{one.id, "/rubrics/" + one.hash},
                        {fmt::format("{}", one.version)},
                        {report::momentOf(one.made)},
                        {one.hash}});
    if (rows.empty())
        page.paragraph(words()("school-teaching.no-rubrics"), Tone::missing);
    else
        page.linkedTable({words()("school-teaching.rubric"), words()("school-teaching.version"), words()("school.made"),
                          words()("school-teaching.hash")},
                         rows, words()("school-teaching.rubrics-about"));
    page.heading(words()("school-teaching.upload-rubric"));
    FormField file{"file", words()("school-teaching.rubric-file"), "file"};
    file.isRequired = true;
    page.form({"/rubrics/check", {report::tokenField(lookerOf(v)), file}, {{words()("school-teaching.check")}}});
    return {200, page.text()};
}

Page rubricOf(const Visit& v, const std::string& hash) {
    if (!maySetRubrics(v)) return notYours();
    const auto version = v.books.rubric(hash);
    if (!version) return notYours();
    const rubric::Rubric read = rubric::parseRubric(version->text, version->id);
    HtmlReport page =
        report::sitePage(words()("school-teaching.rubric-version", version->id, version->version), lookerOf(v));
    page.link("/rubrics", words()("school-teaching.rubrics"));
    page.link("/rubrics/" + hash + "/edit", words()("school-teaching.edit"));
    page.facts({}, {{words()("school-teaching.hash"), hash},
                    {words()("school.made"), report::momentOf(version->made)},
                    {words()("school-teaching.pass-mark"), typedOf(read.passMark)}});
    std::optional<school::RubricVersion> before;
    for (school::RubricVersion& one : Teaching(v.books).rubrics())
        if (one.id == version->id && one.version < version->version) before = std::move(one);
    if (before) {
        page.heading(words()("school-teaching.changes-since", before->version));
        page.list(rubric::differences(rubric::parseRubric(before->text, before->id), read));
    }
    page.heading(words()("school-teaching.in-words"));
    page.code(rubric::describe(read, words().language()));
    page.heading(words()("school-teaching.as-file"));
    page.code(version->text);
    return {200, page.text()};
}

Page editRubric(const Visit& v, const std::string& hash) {
    if (!maySetRubrics(v)) return notYours();
    const auto version = v.books.rubric(hash);
    if (!version) return notYours();
    const rubric::Rubric read = rubric::parseRubric(version->text, version->id);
    HtmlReport page =
        report::sitePage(words()("school-teaching.edit-version", version->id, version->version), lookerOf(v));
    page.link("/rubrics/" + hash, words()("school-teaching.back-to-rubric"));
    page.paragraph(words()("school-teaching.edit-about"), Tone::note);
    page.heading(words()("school-teaching.as-form"));
    page.form(rubricForm(v, hash, read, fieldsOf(read), {}));
    page.heading(words()("school-teaching.as-text"));
    page.form(textForm(v, version->text));
    return {200, page.text()};
}

Page checkRubric(const Visit& v, const Fields& fields, const std::string& text) {
    if (!maySetRubrics(v)) return notYours();
    HtmlReport page = report::sitePage(words()("school-teaching.check-rubric"), lookerOf(v));
    page.link("/rubrics", words()("school-teaching.rubrics"));
    const std::string of = fieldOf(fields, "of");
    std::optional<rubric::Rubric> read;
    std::string toml = text;
    // What was typed comes back whatever is wrong with it.
    const auto again = [&](const rubric::Rubric* base, const std::map<std::string, std::string>& wrong) {
        page.heading(words()("school-teaching.mend"));
        page.form(base != nullptr ? rubricForm(v, of, *base, fields, wrong) : textForm(v, text));
        return Page{422, page.text()};
    };
    if (!of.empty()) {
        const auto version = v.books.rubric(of);
        if (!version) return notYours();
        const rubric::Rubric base = rubric::parseRubric(version->text, version->id);
        const RubricForm form(base, fields);
        if (!form.wrong().empty()) {
            page.paragraph(words()("school-teaching.wrong", form.wrong().size()), Tone::bad);
            return again(&base, form.wrong());
        }
        toml = rubric::rubricToml(form.rubric());
        read = rubric::parseRubric(toml, base.id);
        if (!addFindings(page, *read)) {
            page.paragraph(words()("school-teaching.not-sound"), Tone::bad);
            return again(&base, {});
        }
    } else {
        try {
            if (text.size() > rubric::kMaxBytes)
                throw core::Error(words()("school-teaching.too-long", rubric::kMaxBytes), "rubric.toml");
            read = rubric::parseRubric(text, "rubric.toml");
        } catch (const core::Error& error) {
            page.paragraph(error.what(), Tone::bad);
            return again(nullptr, {});
        }
        if (!addFindings(page, *read)) {
            page.paragraph(words()("school-teaching.not-sound"), Tone::bad);
            return again(nullptr, {});
        }
    }
    const std::string hash = rubric::hashText(rubric::hashOf(*read));
    const Teaching teaching(v.books);
    if (const auto there = v.books.rubric(hash)) {
        page.paragraph(words()("school-teaching.same-rubric", there->id, there->version), Tone::missing);
        page.link("/rubrics/" + hash, words()("school-teaching.rubric-version", there->id, there->version));
        return {200, page.text()};
    }
    page.paragraph(words()("school-teaching.sound"), Tone::good);
    if (const auto before = of.empty() ? newestOf(teaching, read->id) : v.books.rubric(of)) {
        page.heading(words()("school-teaching.changes-since", before->version));
        page.list(rubric::differences(rubric::parseRubric(before->text, before->id), *read));
    } else {
        page.paragraph(words()("school-teaching.new-rubric", read->id), Tone::note);
    }
    page.form({"/rubrics",
               {report::tokenField(lookerOf(v)), {"text", {}, "hidden", toml}},
               {{words()("school-teaching.save-version")}}});
    page.paragraph(words()("school-teaching.save-about"), Tone::note);
    return {200, page.text()};
}

Page saveRubric(const Visit& v, const Fields& fields) {
    if (!maySetRubrics(v)) return notYours();
    const std::string text = fieldOf(fields, "text");
    std::optional<rubric::Rubric> read;
    try {
        read = rubric::parseRubric(text, "rubric.toml");
        rubric::requireSound(*read);
        const std::string hash = rubric::hashText(rubric::hashOf(*read));
        (void)Teaching(v.books).addRubric({hash, read->id, text, 0, 0}, actOf(v));
        return {303, {}, "/rubrics/" + hash};
    } catch (const core::Error& error) {
        if (read && error.id().starts_with("store")) throw;
        return checkRubric(v, {}, text);
    }
}

namespace {
/// Whether there is still some of it to do.
bool addProgress(HtmlReport& page, const school::Progress& far) {
    const std::int64_t all = far.waiting + far.taken + far.done + far.failed;
    page.progress(static_cast<double>(far.done + far.failed), static_cast<double>(std::max<std::int64_t>(all, 1)),
                  words()("school-teaching.far", far.done, all, far.failed));
    return far.waiting + far.taken > 0;
}
}  // namespace

Page rescoreProgressOf(const Visit& v, const std::string& assignment) {
    if (!assignedFor(v, assignment, Action::rescore)) return notYours();
    HtmlReport page(words()("school-teaching.rescore"));
    bool isOpen = false;
    for (const school::Campaign& one : Teaching(v.books).campaigns(assignment))
        isOpen = addProgress(page, v.books.progress(one.id)) || isOpen;
    if (isOpen) page.keepUp("?progress");
    return {200, page.text()};
}

Page rescoreOf(const Visit& v, const std::string& assignment, const Told& told) {
    const auto of = assignedFor(v, assignment, Action::rescore);
    if (!of) return notYours();
    const Teaching teaching(v.books);
    HtmlReport page = report::sitePage(words()("school-teaching.rescore-of", of->assignment.title), lookerOf(v));
    page.link("/assignments/" + assignment, words()("school-teaching.back-to-assignment", of->assignment.title));
    if (!told.text.empty()) page.paragraph(told.text, told.isWrong ? Tone::bad : Tone::good);
    page.paragraph(words()("school-teaching.rescore-about"), Tone::note);
    std::map<std::string, school::RubricVersion> versions;
    std::vector<FormField::Choice> choices;
    for (school::RubricVersion& one : teaching.rubrics()) {
        choices.push_back({one.hash, fmt::format("{} {} ({})", one.id, one.version, one.hash)});
        versions[one.hash] = std::move(one);
    }
    const auto nameOf = [&](const std::string& hash) {
        const auto found = versions.find(hash);
        return found == versions.end() ? hash : fmt::format("{} {}", found->second.id, found->second.version);
    };
    const FormField token = report::tokenField(lookerOf(v));
    page.form({"/assignments/" + assignment + "/rescore",
               {token, {"rubric", words()("school-teaching.rubric"), "select", of->rubricHash, {}, {}, choices}},
               {{words()("school-teaching.rescore"), "do", "begin"}}});
    const std::vector<school::Campaign> campaigns = teaching.campaigns(assignment);
    if (campaigns.empty()) return {told.isWrong ? 422 : 200, page.text()};
    const std::string counting = teaching.counting(assignment);
    // By campaign, then attempt.
    std::map<std::string, std::map<std::string, school::Score>> scores;
    const auto take = [&](const std::string& campaign) {
        for (school::Score& one : teaching.scores(assignment, campaign))
            scores[campaign][one.attempt] = std::move(one);
    };
    take(school::kArrival);
    bool isOpen = false;
    for (const school::Campaign& one : campaigns) {
        take(one.id);
        page.heading(words()("school-teaching.campaign", nameOf(one.rubric), report::momentOf(one.made)));
        isOpen = addProgress(page, v.books.progress(one.id)) || isOpen;
        const bool counts = counting == one.id;
        page.paragraph(words()(counts ? "school-teaching.counts" : "school-teaching.counts-not"),
                       counts ? Tone::good : Tone::note);
        const FormField which{"campaign", {}, "hidden", one.id};
        report::Form form{"/assignments/" + assignment + "/rescore", {token, which}, {}};
        if (!counts) form.buttons.push_back({words()("school-teaching.let-count"), "do", "count"});
        form.buttons.push_back({words()("school-teaching.rescore-rest"), "do", "again"});
        page.form(form);
    }
    page.heading(words()("school-teaching.old-and-new"));
    std::vector<std::string> header{words()("school-teaching.attempt"), words()("school-teaching.as-arrived")};
    for (const school::Campaign& one : campaigns)
        header.push_back(nameOf(one.rubric));
    header.push_back(words()("school-teaching.difference"));
    std::vector<std::vector<Cell>> rows;
    for (const auto& [attempt, first] : scores[school::kArrival]) {
        std::vector<Cell> row{{attempt.substr(0, 6), "/attempts/" + attempt},
                              {fmt::format("{}, {}", scoreText(first), passedText(first.passed))}};
        std::optional<double> change;
        for (const school::Campaign& one : campaigns) {
            const auto found = scores[one.id].find(attempt);
            if (found == scores[one.id].end()) {
                row.push_back({"\u2013"});
                continue;
            }
            row.push_back({fmt::format("{}, {}", scoreText(found->second), passedText(found->second.passed))});
            if (first.maxScore > 0.0 && found->second.maxScore > 0.0)
                change = 100.0 * (found->second.score / found->second.maxScore - first.score / first.maxScore);
        }
        row.push_back({change ? fmt::format("{:+.1f} %", *change) : "\u2013"});
        rows.push_back(std::move(row));
    }
    page.linkedTable(header, rows, words()("school-teaching.old-and-new-about"));
    if (counting != school::kArrival)
        page.form({"/assignments/" + assignment + "/rescore",
                   {token, {"campaign", {}, "hidden", school::kArrival}},
                   {{words()("school-teaching.let-arrival-count"), "do", "count"}}});
    if (isOpen) {
        page.link("/assignments/" + assignment + "/rescore", words()("school-teaching.look-again"));
        page.keepUp("?progress");
        page.script("/live.js", "{}");
    }
    noteLook(v, "scores seen", "", assignment);
    Page shown{told.isWrong ? 422 : 200, page.text()};
    shown.runsScript = isOpen;
    return shown;
}

Page changeScores(const Visit& v, const std::string& assignment, const Fields& fields) {
    const auto of = assignedFor(v, assignment, Action::rescore);
    if (!of) return notYours();
    Teaching teaching(v.books);
    const std::string what = fieldOf(fields, "do"), campaign = fieldOf(fields, "campaign"),
                      here = "/assignments/" + assignment + "/rescore";
    if (what == "begin") {
        const auto version = v.books.rubric(fieldOf(fields, "rubric"));
        if (!version) return rescoreOf(v, assignment, {words()("school-teaching.choose-rubric"), true});
        const school::Campaign made{school::newId(), assignment, version->hash, v.person.code};
        teaching.add(made, actOf(v));
        (void)v.books.rescore(made.id, assignment, made.rubric, actOf(v));
        return {303, {}, here};
    }
    const auto known = teaching.campaign(campaign);
    const bool isOurs = known && known->assignment == assignment;
    if (what == "again" && isOurs) {
        (void)v.books.rescore(known->id, assignment, known->rubric, actOf(v));
        return {303, {}, here};
    }
    if (what == "count" && (isOurs || campaign == school::kArrival)) {
        teaching.setCounting(assignment, campaign, actOf(v));
        return {303, {}, here};
    }
    return rescoreOf(v, assignment, {words()("school-teaching.choose-campaign"), true});
}

}  // namespace handpiece::school_server
