// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/assessment_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash_text.h"

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
    json["own_points"] = c.points ? Json(c.ownPoints) : Json(nullptr);
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

Json toJson(const score::Completeness& c) {
    Json json = {{"measure", c.measure}};
    addSelection(json, c.of);
    json["value"] = orNull(c.value);
    json["unit"] = c.unit;
    json["uncertainty"] = c.value ? Json(c.uncertainty) : Json(nullptr);
    json["factor"] = c.factor;
    json["factor_range"] = {c.leastFactor, c.mostFactor};
    json["reason"] = c.reason;
    json["evidence"] = Json::array();
    for (const measures::Evidence& e : c.evidence)
        json["evidence"].push_back(toJson(e));
    return json;
}

constexpr std::size_t kMostEntries = 1000;
constexpr std::size_t kMostResults = 100'000;

/// One object of a file, read strictly; errors name the member.
class Reader {
  public:
    Reader(const Json& json, std::string where) : json_(json), where_(std::move(where)) {
        if (!json.is_object()) fail("what should be an object is none");
    }
    [[noreturn]] void fail(const std::string& problem) const {
        throw core::Error("this is no result of a score: " + problem, where_,
                          "give a result.json as handpiece score writes it");
    }
    [[nodiscard]] const Json& member(const char* name) const {
        const auto at = json_.find(name);
        if (at == json_.end()) fail(fmt::format("\"{}\" is missing", name));
        return *at;
    }
    [[nodiscard]] std::string text(const char* name) const {
        if (!member(name).is_string()) fail(fmt::format("\"{}\" is no text", name));
        return member(name).get<std::string>();
    }
    [[nodiscard]] std::string textOrEmpty(const char* name) const {
        return json_.contains(name) && !member(name).is_null() ? text(name) : std::string();
    }
    [[nodiscard]] double number(const char* name) const { return number(member(name), name); }
    [[nodiscard]] std::optional<double> numberOrNone(const char* name) const {
        if (!json_.contains(name) || member(name).is_null()) return std::nullopt;
        return number(name);
    }
    [[nodiscard]] double number(const Json& json, const char* name) const {
        if (!json.is_number() || !std::isfinite(json.get<double>())) fail(fmt::format("\"{}\" is no number", name));
        return json.get<double>();
    }
    [[nodiscard]] bool flag(const char* name) const {
        if (!member(name).is_boolean()) fail(fmt::format("\"{}\" is neither true nor false", name));
        return member(name).get<bool>();
    }
    [[nodiscard]] const Json& list(const char* name) const {
        const Json& json = member(name);
        if (!json.is_array() || json.size() > kMostEntries) fail(fmt::format("\"{}\" is no list, or too long", name));
        return json;
    }
    [[nodiscard]] std::vector<double> numbers(const char* name, std::size_t count) const {
        const Json& json = list(name);
        if (json.size() != count) fail(fmt::format("\"{}\" has {} numbers, not {}", name, json.size(), count));
        std::vector<double> all;
        for (const Json& one : json)
            all.push_back(number(one, name));
        return all;
    }
    template <class T, class NameOf>
    [[nodiscard]] T oneOf(const char* name, std::initializer_list<T> known, NameOf&& nameOf) const {
        const std::string said = text(name);
        for (const T& one : known)
            if (nameOf(one) == said) return one;
        fail(fmt::format("\"{}\" is \"{}\"", name, said));
    }

  private:
    const Json& json_;
    std::string where_;
};

measures::Evidence evidenceOf(const Reader& json) {
    measures::Evidence e;
    e.timeS = json.numberOrNone("t_s");
    if (!json.member("xyz_mm").is_null()) {
        const std::vector<double> p = json.numbers("xyz_mm", 3);
        e.placeMm = core::Vec3(p[0], p[1], p[2]);
    }
    e.forceN = json.numberOrNone("force_n");
    e.text = json.text("text");
    e.session = static_cast<std::size_t>(std::clamp(json.numberOrNone("session").value_or(0.0), 0.0, 1e6));
    return e;
}

/// What both have, a criterion and completeness.
template <class Judged>
void readMeasured(const Reader& json, const std::string& where, Judged& c) {
    c.measure = json.text("measure");
    c.of = {json.textOrEmpty("zone"), json.textOrEmpty("tissue"), json.textOrEmpty("side"),
            json.textOrEmpty("statistic"), json.numberOrNone("limit")};
    c.value = json.numberOrNone("value");
    c.unit = json.text("unit");
    c.uncertainty = json.numberOrNone("uncertainty").value_or(0.0);
    c.reason = json.text("reason");
    for (const Json& one : json.list("evidence"))
        c.evidence.push_back(evidenceOf({one, where}));
}

score::Completeness completenessOf(const Reader& json, const std::string& where) {
    score::Completeness c;
    readMeasured(json, where, c);
    c.factor = json.number("factor");
    const std::vector<double> range = json.numbers("factor_range", 2);
    c.leastFactor = range[0];
    c.mostFactor = range[1];
    for (const double factor : {c.factor, c.leastFactor, c.mostFactor})
        if (factor < 0.0 || factor > 1.0) json.fail("a factor is not from 0 to 1");
    return c;
}

score::CriterionScore criterionOf(const Reader& json, const std::string& where) {
    score::CriterionScore c;
    c.id = json.text("id");
    readMeasured(json, where, c);
    c.band = json.textOrEmpty("band");
    for (const Json& band : json.list("possible_bands"))
        c.possibleBands.push_back(band.is_string() ? band.get<std::string>() : std::string());
    c.points = json.numberOrNone("points");
    c.maxPoints = json.number("max_points");
    if (c.points) {
        // Results of before knew no such factor.
        c.ownPoints = json.numberOrNone("own_points").value_or(*c.points);
        const std::vector<double> range = json.numbers("points_range", 2);
        c.leastPoints = range[0];
        c.mostPoints = range[1];
    }
    using score::Standing;
    c.standing = json.oneOf("standing", {Standing::judged, Standing::notMeasured, Standing::leftOut, Standing::voided},
                            [](Standing one) { return score::nameOf(one); });
    using score::Verdict;
    c.critical = json.oneOf("critical", {Verdict::no, Verdict::borderline, Verdict::yes},
                            [](Verdict one) { return std::string_view(nameOf(one)); });
    c.borderline = json.flag("borderline");
    return c;
}

/// "attempt-2" before "attempt-10".
bool comesBefore(const std::string& a, const std::string& b) {
    const auto isDigit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
    std::size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (isDigit(a[i]) && isDigit(b[j])) {
            std::size_t endA = i, endB = j;
            while (endA < a.size() && isDigit(a[endA]))
                ++endA;
            while (endB < b.size() && isDigit(b[endB]))
                ++endB;
            while (i + 1 < endA && a[i] == '0')
                ++i;
            while (j + 1 < endB && b[j] == '0')
                ++j;
            if (endA - i != endB - j) return endA - i < endB - j;
            if (const int order = a.compare(i, endA - i, b, j, endB - j); order != 0) return order < 0;
            i = endA;
            j = endB;
        } else if (a[i] != b[j]) {
            return a[i] < b[j];
        } else {
            ++i;
            ++j;
        }
    }
    return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

}  // namespace

score::Result parseResult(std::string_view text, const std::string& where) {
    const Json parsed = config::outsideJson<Json>(text);
    if (parsed.is_discarded())
        throw core::Error("this is no result of a score, nor JSON", where,
                          "give a result.json as handpiece score writes it");
    const Reader json(parsed, where);
    if (const std::string schema = json.text("schema"); schema != kResultSchema)
        json.fail(fmt::format("its schema is \"{}\", not \"{}\"", schema, kResultSchema));
    score::Result result;
    score::Identity& of = result.identity;
    of.engineRevision = static_cast<std::int32_t>(std::clamp(json.number("engine"), -1.0, 1e9));
    of.exercise = json.text("exercise");
    of.exerciseHash = json.text("exercise_hash");
    of.caseKey = json.text("case_key");
    of.stateHash = json.text("state_hash");
    of.proven = json.flag("proven");
    if (parsed.contains("scan") && !json.member("scan").is_null()) {
        const Reader scan(json.member("scan"), where);
        score::ScanFit& fit = of.scan.emplace();
        fit.rmsMm = scan.number("rms_mm");
        fit.uncutMm2 = scan.number("uncut_mm2");
        fit.noiseMm = scan.number("noise_mm");
        fit.cutMm2 = scan.number("cut_mm2");
        fit.voxelMm = scan.number("voxel_mm");
        // Results of before say nothing of these.
        fit.liesMm = scan.numberOrNone("lies_mm").value_or(0.0);
        fit.turnsDeg = scan.numberOrNone("turns_deg").value_or(0.0);
        if (const std::string on = scan.textOrEmpty("registered_on"); !on.empty()) {
            const auto found = score::registeredOnByName(on);
            if (!found) scan.fail("\"registered_on\" is none of what a scan is registered on");
            fit.registeredOn = *found;
        }
    }
    for (const Json& hash : json.list("session_hash"))
        of.sessionHashes.push_back(hash.is_string() ? hash.get<std::string>() : std::string());
    score::Assessment& a = result.assessment;
    a.score = json.number("score");
    a.maxScore = json.number("max_score");
    a.wholeScore = json.number("whole_score");
    const std::vector<double> range = json.numbers("score_range", 2);
    a.leastScore = range[0];
    a.mostScore = range[1];
    using score::Passed;
    a.passed =
        json.oneOf("passed", {Passed::yes, Passed::no, Passed::teacher}, [](Passed one) { return score::nameOf(one); });
    a.why = json.text("why");
    a.borderline = json.flag("borderline");
    for (const Json& one : json.list("critical")) {
        const Reader error(one, where);
        a.critical.push_back({error.text("criterion"), error.flag("borderline")});
    }
    a.rubric = json.text("rubric");
    a.rubricVersion = json.text("rubric_version");
    const std::optional<std::uint64_t> hash = core::readHash(json.text("rubric_hash"));
    if (!hash) json.fail("\"rubric_hash\" is no hash");
    a.rubricHash = *hash;
    if (parsed.contains("completeness") && !json.member("completeness").is_null())
        a.completeness = completenessOf({json.member("completeness"), where}, where);
    a.context.device = json.text("device");
    a.context.motionScale = json.number("motion_scale");
    for (const Json& one : json.list("criteria"))
        a.criteria.push_back(criterionOf({one, where}, where));
    for (const Json& one : json.list("steps")) {
        const Reader step(one, where);
        a.steps.push_back({step.text("id"), step.number("points"), step.number("max_points"), step.flag("whole")});
    }
    for (const Json& one : json.list("rules")) {
        const Reader rule(one, where);
        const bool isOpen = rule.member("holds").is_null();
        a.rules.push_back({rule.text("id"), isOpen ? std::nullopt : std::optional<bool>(rule.flag("holds"))});
    }
    return result;
}

std::vector<report::ClassEntry> readClass(const std::filesystem::path& folder) {
    namespace fs = std::filesystem;
    std::error_code ec;
    if (!fs::is_directory(folder, ec))
        throw core::Error("there is no such folder", folder.string(), "name one with a folder of results a student");
    std::vector<std::string> found;
    for (fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, ec), end;
         !ec && at != end; at.increment(ec)) {
        if (at->is_regular_file(ec) && at->path().extension() == ".json")
            found.push_back(at->path().lexically_relative(folder).generic_string());
        if (found.size() > kMostResults)
            throw core::Error(fmt::format("there are more than {} results", kMostResults), folder.string(),
                              "name the folder of one class");
    }
    if (ec) throw core::Error(ec.message(), folder.string(), "name a folder that can be read");
    if (found.empty())
        throw core::Error("there is no result in it", folder.string(),
                          "put results there as CODE/NAME.json: handpiece score --out writes result.json");
    std::sort(found.begin(), found.end(), comesBefore);
    std::vector<report::ClassEntry> entries;
    for (const std::string& file : found) {
        const fs::path path = folder / file;
        const std::vector<std::byte> bytes = core::readFile(path, kMaxResultBytes);
        const std::size_t slash = file.find('/');
        entries.push_back({slash == std::string::npos ? fs::path(file).stem().string() : file.substr(0, slash), file,
                           std::nullopt,
                           parseResult({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path.string())});
    }
    return entries;
}

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
    json["scan"] = !of.scan ? Json(nullptr)
                            : Json{{"registered_on", score::nameOf(of.scan->registeredOn)},
                                   {"rms_mm", of.scan->rmsMm},
                                   {"uncut_mm2", of.scan->uncutMm2},
                                   {"noise_mm", of.scan->noiseMm},
                                   {"cut_mm2", of.scan->cutMm2},
                                   {"voxel_mm", of.scan->voxelMm},
                                   {"lies_mm", of.scan->liesMm},
                                   {"turns_deg", of.scan->turnsDeg}};
    for (const score::CriticalError& e : a.critical)
        json["critical"].push_back({{"criterion", e.criterion}, {"borderline", e.borderline}});
    json["completeness"] = a.completeness ? toJson(*a.completeness) : Json(nullptr);
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
    const auto knotsOf = [](const std::vector<rubric::Knot>& all) {
        Json knots = Json::array();
        for (const rubric::Knot& k : all)
            knots.push_back({k.value, k.points});
        return knots;
    };
    json["completeness"] = nullptr;
    if (r.completeness) {
        const rubric::Completeness& c = *r.completeness;
        Json one = {{"measure", c.measure}};
        addSelection(one, c.of);
        one.update({{"unit", c.unit},
                    {"knots", knotsOf(c.knots)},
                    {"title", c.title},
                    {"words", c.words},
                    {"source", c.source}});
        json["completeness"] = std::move(one);
    }
    json["bands"] = Json::array();
    for (const rubric::BandName& b : r.bands)
        json["bands"].push_back({{"id", b.id}, {"title", b.title}});
    json["criteria"] = Json::array();
    for (const rubric::Criterion& c : r.criteria) {
        Json one = {{"id", c.id}, {"title", c.title}, {"measure", c.measure}};
        addSelection(one, c.of);
        one["unit"] = c.unit;
        one["weight"] = c.weight;
        one["knots"] = knotsOf(c.knots);
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
