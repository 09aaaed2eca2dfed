// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/marking/scoring.h"
#include "handpiece/base/core/error.h"

namespace handpiece::marking {
namespace {

using ReadJson = nlohmann::json;

constexpr std::size_t kMaxResultBytes = 8u << 20;

std::optional<double> numberOrNull(const ReadJson& json) {
    if (json.is_null()) return {};
    return json.get<double>();
}
std::string textOrNull(const ReadJson& json) {
    return json.is_null() ? std::string() : json.get<std::string>();
}
std::uint64_t hashOfText(const std::string& text) {
    std::size_t used = 0;
    const std::uint64_t value = std::stoull(text, &used, 16);
    if (used != text.size()) throw std::invalid_argument(text);
    return value;
}

score::Verdict verdictOf(const std::string& text) {
    if (text == "no") return score::Verdict::no;
    if (text == "yes") return score::Verdict::yes;
    if (text == "borderline") return score::Verdict::borderline;
    throw std::invalid_argument(text);
}
template <class Enum>
Enum named(const std::string& text, std::initializer_list<Enum> all) {
    for (const Enum one : all)
        if (score::nameOf(one) == text) return one;
    throw std::invalid_argument(text);
}

measures::Evidence evidenceOf(const ReadJson& json) {
    measures::Evidence e;
    e.timeS = numberOrNull(json.at("t_s"));
    if (const ReadJson& place = json.at("xyz_mm"); !place.is_null())
        e.placeMm = core::Vec3(place.at(0).get<double>(), place.at(1).get<double>(), place.at(2).get<double>());
    e.forceN = numberOrNull(json.at("force_n"));
    e.text = json.at("text").get<std::string>();
    return e;
}

score::CriterionScore criterionOf(const ReadJson& json) {
    score::CriterionScore c;
    c.id = json.at("id").get<std::string>();
    c.measure = json.at("measure").get<std::string>();
    c.of.zone = json.value("zone", std::string());
    c.of.tissue = json.value("tissue", std::string());
    c.of.side = json.value("side", std::string());
    c.of.statistic = json.value("statistic", std::string());
    if (json.contains("limit")) c.of.limit = json.at("limit").get<double>();
    c.value = numberOrNull(json.at("value"));
    c.unit = json.at("unit").get<std::string>();
    c.uncertainty = numberOrNull(json.at("uncertainty")).value_or(0.0);
    c.band = textOrNull(json.at("band"));
    c.possibleBands = json.at("possible_bands").get<std::vector<std::string>>();
    c.points = numberOrNull(json.at("points"));
    c.maxPoints = json.at("max_points").get<double>();
    if (const ReadJson& range = json.at("points_range"); !range.is_null()) {
        c.leastPoints = range.at(0).get<double>();
        c.mostPoints = range.at(1).get<double>();
    }
    using score::Standing;
    c.standing = named(json.at("standing").get<std::string>(),
                       {Standing::judged, Standing::notMeasured, Standing::leftOut, Standing::voided});
    c.reason = json.at("reason").get<std::string>();
    c.critical = verdictOf(json.at("critical").get<std::string>());
    c.borderline = json.at("borderline").get<bool>();
    for (const ReadJson& e : json.at("evidence"))
        c.evidence.push_back(evidenceOf(e));
    return c;
}

assessment::Result resultOf(const ReadJson& json) {
    assessment::Result result;
    score::Assessment& a = result.assessment;
    score::Identity& of = result.identity;
    of.engineRevision = json.at("engine").get<std::int32_t>();
    of.exercise = json.at("exercise").get<std::string>();
    of.exerciseHash = json.at("exercise_hash").get<std::string>();
    of.caseKey = json.at("case_key").get<std::string>();
    of.sessionHashes = json.at("session_hash").get<std::vector<std::string>>();
    of.proven = json.at("proven").get<bool>();
    of.stateHash = json.at("state_hash").get<std::string>();
    a.score = json.at("score").get<double>();
    a.maxScore = json.at("max_score").get<double>();
    a.wholeScore = json.at("whole_score").get<double>();
    a.leastScore = json.at("score_range").at(0).get<double>();
    a.mostScore = json.at("score_range").at(1).get<double>();
    using score::Passed;
    a.passed = named(json.at("passed").get<std::string>(), {Passed::yes, Passed::no, Passed::teacher});
    a.why = json.at("why").get<std::string>();
    a.borderline = json.at("borderline").get<bool>();
    for (const ReadJson& e : json.at("critical"))
        a.critical.push_back({e.at("criterion").get<std::string>(), e.at("borderline").get<bool>()});
    a.rubric = json.at("rubric").get<std::string>();
    a.rubricVersion = json.at("rubric_version").get<std::string>();
    a.rubricHash = hashOfText(json.at("rubric_hash").get<std::string>());
    a.context = {json.at("device").get<std::string>(), json.at("motion_scale").get<double>()};
    for (const ReadJson& c : json.at("criteria"))
        a.criteria.push_back(criterionOf(c));
    for (const ReadJson& s : json.at("steps"))
        a.steps.push_back({s.at("id").get<std::string>(), s.at("points").get<double>(),
                           s.at("max_points").get<double>(), s.at("whole").get<bool>()});
    for (const ReadJson& r : json.at("rules")) {
        score::RuleResult rule{r.at("id").get<std::string>(), {}};
        if (!r.at("holds").is_null()) rule.holds = r.at("holds").get<bool>();
        a.rules.push_back(std::move(rule));
    }
    return result;
}

}  // namespace

assessment::Result parseResult(std::string_view text, const std::string& where) {
    const auto wrong = [&where](const std::string& why) {
        return core::Error("this is no result of a score: " + why, where, "let handpiece score write it again");
    };
    if (text.size() > kMaxResultBytes) throw wrong("it is larger than 8 MiB");
    try {
        const ReadJson json = ReadJson::parse(text);
        if (json.at("schema").get<std::string>() != assessment::kResultSchema) throw wrong("its schema is another");
        return resultOf(json);
    } catch (const core::Error&) {
        throw;
    } catch (const std::exception& error) {  // of the JSON library and of numbers
        throw wrong(error.what());
    }
}

}  // namespace handpiece::marking
