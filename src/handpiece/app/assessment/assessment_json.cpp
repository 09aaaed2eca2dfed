// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/assessment_json.h"

#include <nlohmann/json.hpp>

namespace handpiece::assessment {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json orNull(const std::optional<T>& value) {
    return value ? Json(*value) : Json(nullptr);
}
std::string written(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// What narrows the measure down, as in the rubric.
void addSelection(Json& json, const measures::Selection& of) {
    for (const auto& [key, text] :
         {std::pair{"zone", &of.zone}, {"tissue", &of.tissue}, {"side", &of.side}, {"statistic", &of.statistic}})
        if (!text->empty()) json[key] = *text;
    if (of.limit) json["limit"] = *of.limit;
}

const char* nameOf(score::Verdict verdict) {
    return verdict == score::Verdict::no ? "no" : verdict == score::Verdict::yes ? "yes" : "borderline";
}

Json toJson(const measures::Evidence& e) {
    Json json = Json::object();
    json["t_s"] = orNull(e.timeS);
    json["session"] = e.timeS ? Json(e.session) : Json(nullptr);
    json["xyz_mm"] = e.placeMm ? Json{e.placeMm->x(), e.placeMm->y(), e.placeMm->z()} : Json(nullptr);
    json["force_n"] = orNull(e.forceN);
    json["text"] = e.text;
    return json;
}

Json toJson(const score::CriterionScore& c) {
    Json json = {{"id", c.id}, {"measure", c.measure}};
    addSelection(json, c.of);
    json["value"] = orNull(c.value);
    json["unit"] = c.unit;
    json["uncertainty"] = c.value ? Json(c.uncertainty) : Json(nullptr);
    json["band"] = c.band.empty() ? Json(nullptr) : Json(c.band);
    json["possible_bands"] = c.possibleBands;
    json["points"] = orNull(c.points);
    json["max_points"] = c.maxPoints;
    json["points_range"] = c.points ? Json{c.leastPoints, c.mostPoints} : Json(nullptr);
    json["standing"] = score::nameOf(c.standing);
    json["reason"] = c.reason;
    json["critical"] = nameOf(c.critical);
    json["borderline"] = c.borderline;
    json["evidence"] = Json::array();
    for (const measures::Evidence& e : c.evidence)
        json["evidence"].push_back(toJson(e));
    return json;
}

}  // namespace

std::string resultJson(const score::Assessment& a, const score::Identity& of) {
    Json json = {{"schema", kResultSchema},
                 {"engine", of.engineRevision},
                 {"exercise", of.exercise},
                 {"exercise_hash", of.exerciseHash},
                 {"case_key", of.caseKey},
                 {"session_hash", of.sessionHashes},
                 {"proven", of.proven},
                 {"score", a.score},
                 {"max_score", a.maxScore},
                 {"whole_score", a.wholeScore},
                 {"score_range", {a.leastScore, a.mostScore}},
                 {"passed", score::nameOf(a.passed)},
                 {"why", a.why},
                 {"borderline", a.borderline},
                 {"critical", Json::array()},
                 {"rubric", a.rubric},
                 {"rubric_version", a.rubricVersion},
                 {"rubric_hash", rubric::hashText(a.rubricHash)},
                 {"state_hash", of.stateHash},
                 {"device", a.context.device},
                 {"motion_scale", a.context.motionScale}};
    for (const score::CriticalError& e : a.critical)
        json["critical"].push_back({{"criterion", e.criterion}, {"borderline", e.borderline}});
    json["criteria"] = Json::array();
    for (const score::CriterionScore& c : a.criteria)
        json["criteria"].push_back(toJson(c));
    json["steps"] = Json::array();
    for (const score::StepScore& s : a.steps)
        json["steps"].push_back(
            {{"id", s.id}, {"points", s.points}, {"max_points", s.maxPoints}, {"whole", s.isWhole}});
    json["rules"] = Json::array();
    for (const score::RuleResult& r : a.rules)
        json["rules"].push_back({{"id", r.id}, {"holds", orNull(r.holds)}});
    return written(json);
}

std::string rubricJson(const rubric::Rubric& r) {
    Json json = {{"id", r.id},
                 {"version", r.version},
                 {"hash", rubric::hashText(rubric::hashOf(r))},
                 {"status", rubric::nameOf(r.status)},
                 {"source", r.source},
                 {"title", r.title},
                 {"words", r.words},
                 {"pass_mark", orNull(r.passMark)}};
    json["bands"] = Json::array();
    for (const rubric::BandName& b : r.bands)
        json["bands"].push_back({{"id", b.id}, {"title", b.title}});
    json["criteria"] = Json::array();
    for (const rubric::Criterion& c : r.criteria) {
        Json one = {{"id", c.id}, {"title", c.title}, {"measure", c.measure}};
        addSelection(one, c.of);
        one["unit"] = c.unit;
        one["weight"] = c.weight;
        one["knots"] = Json::array();
        for (const rubric::Knot& k : c.knots)
            one["knots"].push_back({k.value, k.points});
        one["bands"] = Json::array();
        for (const rubric::Band& b : c.bands)
            one["bands"].push_back(
                {{"id", b.id}, {"from", orNull(b.from)}, {"to", orNull(b.to)}, {"points", orNull(b.points)}});
        one["critical"] = c.critical ? Json{{"below", orNull(c.critical->below)},
                                            {"above", orNull(c.critical->above)},
                                            {"title", c.critical->title}}
                                     : Json(nullptr);
        one["devices"] = c.devices;
        one["excludes"] = c.excludes;
        one["words"] = c.words;
        one["leaves_out"] = c.leavesOut;
        one["status"] = rubric::nameOf(c.status.value_or(r.status));
        one["source"] = c.source;
        json["criteria"].push_back(std::move(one));
    }
    json["steps"] = Json::array();
    for (const rubric::Step& s : r.steps)
        json["steps"].push_back({{"id", s.id}, {"title", s.title}, {"criteria", s.criteria}});
    json["rules"] = Json::array();
    for (const rubric::Rule& rule : r.rules) {
        Json needs = Json::array();
        for (const rubric::Condition& n : rule.needs) {
            if (!n.rule.empty())
                needs.push_back({{"rule", n.rule}});
            else
                needs.push_back(
                    {{"bands", n.bands}, {"of", n.of}, {"least", orNull(n.least)}, {"most", orNull(n.most)}});
        }
        json["rules"].push_back({{"id", rule.id},
                                 {"title", rule.title},
                                 {"needs", needs},
                                 {"required", rule.required},
                                 {"else_at_most", orNull(rule.elseAtMost)}});
    }
    return written(json);
}

}  // namespace handpiece::assessment
