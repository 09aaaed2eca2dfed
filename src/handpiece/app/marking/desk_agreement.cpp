// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/marking/desk_agreement.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "handpiece/app/marking/desk_csv.h"
#include "handpiece/app/report/assessment_words.h"
#include "handpiece/app/report/plot.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"

namespace handpiece::marking {
namespace {

using assessment::CriterionAgreement;
using assessment::RaterPair;

std::string told(const Mark& mark) {
    if (mark.cannotTell) return {};
    return mark.points ? fmt::format("{}", *mark.points) : mark.band;
}
/// In the words in which markers mark: a band, or points.
std::string told(const rubric::Criterion& c, const score::CriterionScore& s) {
    if (s.standing != score::Standing::judged) return {};
    if (!c.bands.empty()) return s.band;
    return s.points ? fmt::format("{}", *s.points) : std::string();
}

}  // namespace

std::string marksHead() {
    return csvLine({"item", "rater", "criterion", "mark"});
}

std::string marksLines(const std::string& item, const std::string& rater, const std::vector<std::string>& asked,
                       const std::map<std::string, Mark>& marks) {
    std::string out;
    for (const std::string& id : asked)
        if (const auto mark = marks.find(id); mark != marks.end())
            out += csvLine({item, rater, id, told(mark->second)});
    return out;
}

std::string machineLines(const std::string& item, const rubric::Rubric& rubric, const std::vector<std::string>& asked,
                         const score::Assessment& a) {
    std::string out;
    for (std::size_t i = 0; i < a.criteria.size(); ++i)
        if (std::find(asked.begin(), asked.end(), a.criteria[i].id) != asked.end())
            out += csvLine({item, kMachine, a.criteria[i].id, told(rubric.criteria[i], a.criteria[i])});
    // Of all points, as the marker's: a score of part of them would be another scale.
    if (!asked.empty() && asked.back() == kTotal)
        out +=
            csvLine({item, kMachine, kTotal, a.maxScore == a.wholeScore ? fmt::format("{}", a.score) : std::string()});
    return out;
}

std::string marksCsv(const Desk& desk, const std::vector<DeskState>& desks) {
    if (!desk.isBlind())
        throw core::Error("marks are not independent of the machine's where its score was seen", desk.file().string(),
                          "begin a desk that marks blind");
    std::string out = marksHead();
    const std::vector<std::string> asked = desk.asked();
    std::set<std::string> open;  // ids of works that may be seen
    for (const std::string& code : desk.codes())
        if (desk.isRevealed(code)) open.insert(desk.work(code).id);
    std::set<std::string> raters;
    for (const DeskState& one : desks) {
        if (!raters.insert(one.marker).second) continue;
        for (const DeskItem& item : itemsOf(one)) {
            const auto sheet = one.sheets.find(item.code);
            if (!open.contains(item.workId) || sheet == one.sheets.end() || !sheet->second.isIn) continue;
            out += marksLines(item.workId, one.marker + (item.isRepeat ? kAgain : ""), asked, sheet->second.marks);
        }
    }
    std::set<std::string> told_;
    for (const std::string& code : desk.codes()) {
        const assessment::Result* machine = desk.machine(code);
        if (machine == nullptr || !told_.insert(desk.work(code).id).second) continue;
        out += machineLines(desk.work(code).id, desk.rubric(), asked, machine->assessment);
    }
    return out;
}

DeskAgreement agreementOfDesk(const Desk& desk, const std::vector<DeskState>& desks, std::size_t draws) {
    return agreementOfMarks(desk.rubric(), marksCsv(desk, desks), desk.file().string(), draws);
}

DeskAgreement agreementOfMarks(const rubric::Rubric& rubric, const std::string& csv, const std::string& where,
                               std::size_t draws) {
    DeskAgreement agreement;
    if (std::count(csv.begin(), csv.end(), '\n') < 2) return agreement;
    std::map<std::string, assessment::MarkTable> tables;
    for (assessment::MarkTable& table : assessment::parseMarks(csv, where))
        tables.emplace(table.criterion, std::move(table));
    std::set<std::string> raters;
    for (const std::string& id : askedOf(rubric)) {
        const auto table = tables.find(id);
        if (table == tables.end()) continue;
        assessment::MarkScale scale;
        const rubric::Criterion* c = rubric.criterion(id);
        if (c != nullptr && !c->bands.empty())
            for (const rubric::BandName& band : rubric.bands)
                if (std::any_of(c->bands.begin(), c->bands.end(),
                                [&](const rubric::Band& b) { return b.id == band.id; }))
                    scale.categories.push_back(band.id);
        agreement.criteria.push_back(assessment::agreementOf(table->second, scale, draws));
        agreement.criteria.back().title =
            c != nullptr ? report::criterionTitle(rubric, id) : config::words()("agreement.all-points");
        raters.insert(table->second.raters.begin(), table->second.raters.end());
    }
    agreement.raters.assign(raters.begin(), raters.end());
    std::set<std::pair<std::string, std::string>> pairs;
    for (const CriterionAgreement& c : agreement.criteria)
        for (const RaterPair& p : c.pairs) {
            if (p.items < 2) continue;
            if (p.kappa) pairs.emplace(p.first, p.second);
            if (p.blandAltman) {
                RaterPair called = p;
                called.first = raterName(p.first);
                called.second = raterName(p.second);
                agreement.pictures.push_back(
                    {config::words()("agreement.bland-altman-of", c.title, called.first, called.second),
                     assessment::blandAltmanSvg(c, called)});
            }
        }
    for (const auto& [first, second] : pairs)
        agreement.pictures.push_back({config::words()("agreement.kappa-of", raterName(first), raterName(second)),
                                      kappaSvg(agreement.criteria, first, second)});
    return agreement;
}

std::string raterName(const std::string& rater) {
    if (rater == kMachine) return config::words().text("agreement.machine");
    const std::string_view again = kAgain;
    if (rater.size() > again.size() && rater.ends_with(again))
        return config::words()("agreement.again", rater.substr(0, rater.size() - again.size()));
    return rater;
}

std::string kappaSvg(const std::vector<CriterionAgreement>& criteria, const std::string& first,
                     const std::string& second) {
    report::Plot plot;
    plot.title = config::words()("agreement.kappa-of", raterName(first), raterName(second));
    plot.yLabel = report::said("kappa, linear weights");
    report::Series values;
    values.line = false;
    values.markers = true;
    values.colour = 0;
    std::vector<report::Series> intervals;
    std::string names;
    double place = 0.0;
    for (const CriterionAgreement& c : criteria)
        for (const RaterPair& p : c.pairs) {
            if (p.first != first || p.second != second || !p.linear) continue;
            place += 1.0;
            names +=
                fmt::format("{}{:g} {}", names.empty() ? "" : ", ", place, c.title.empty() ? c.criterion : c.title);
            if (!p.linear->value) continue;
            values.x.push_back(place);
            values.y.push_back(*p.linear->value);
            if (p.linear->interval) {
                report::Series interval;
                interval.x = {place, place};
                interval.y = {p.linear->interval->low, p.linear->interval->high};
                interval.colour = 0;
                intervals.push_back(std::move(interval));
            }
        }
    plot.xLabel = names;
    plot.series.push_back(std::move(values));
    for (report::Series& interval : intervals)
        plot.series.push_back(std::move(interval));
    plot.limits = {{1.0, report::said("as one")}, {0.0, report::said("by chance")}};
    return report::toSvg(plot, true);
}

}  // namespace handpiece::marking
