// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/marking/returned_marks.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash_text.h"

namespace handpiece::marking {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kReturnedFormat = 1;
constexpr std::size_t kMaxReturnedText = 4000, kMaxReturnedMarkerBytes = 60, kMaxList = 1000;
/// More than any rubric gives, and far under where a picture of it ends.
constexpr double kMostPoints = 1e6, kMostMm = 1e4, kMostS = 1e6;

std::string boundedText(const Json& json, std::size_t most = kMaxReturnedText) {
    std::string text = json.get<std::string>();
    if (text.size() > most) throw std::length_error("a text is too long");
    return text;
}
double numberIn(const Json& json, double least, double most) {
    const double value = json.get<double>();
    if (!(value >= least && value <= most)) throw std::out_of_range("a number is none that can be");
    return value;
}
std::string hashIn(const Json& json) {
    const std::string hash = json.get<std::string>();
    const std::optional<std::uint64_t> value = core::readHash(hash);
    if (!value || rubric::hashText(*value) != hash) throw std::invalid_argument("a hash is none");
    return hash;
}
const Json& listIn(const Json& json) {
    if (!json.is_array() || json.size() > kMaxList) throw std::length_error("a list is none, or too long");
    return json;
}

Json toJson(const Comment& c) {
    Json one = {{"text", c.text}};
    if (!c.criterion.empty()) one["criterion"] = c.criterion;
    if (c.placeMm) one["xyz_mm"] = {c.placeMm->x(), c.placeMm->y(), c.placeMm->z()};
    if (c.timeS) one["t_s"] = *c.timeS;
    if (c.session) one["session"] = *c.session;
    return one;
}

Comment commentOf(const Json& one) {
    Comment c;
    c.text = boundedText(one.at("text"));
    if (one.contains("criterion")) c.criterion = boundedText(one.at("criterion"), 200);
    if (one.contains("xyz_mm")) {
        const Json& place = one.at("xyz_mm");
        if (!place.is_array() || place.size() != 3) throw std::length_error("a place has three numbers");
        c.placeMm = core::Vec3(numberIn(place.at(0), -kMostMm, kMostMm), numberIn(place.at(1), -kMostMm, kMostMm),
                               numberIn(place.at(2), -kMostMm, kMostMm));
    }
    if (one.contains("t_s")) c.timeS = numberIn(one.at("t_s"), 0.0, kMostS);
    if (one.contains("session")) {
        const auto* const which = one.at("session").get_ptr<const Json::number_integer_t*>();
        if (which == nullptr || *which < 0 || *which >= static_cast<std::int64_t>(kMaxList))
            throw std::out_of_range("a session's place is none");
        c.session = static_cast<std::size_t>(*which);
    }
    return c;
}

score::Passed passedIn(const Json& json) {
    const std::string name = json.get<std::string>();
    for (const score::Passed passed : {score::Passed::yes, score::Passed::no, score::Passed::teacher})
        if (score::nameOf(passed) == name) return passed;
    throw std::invalid_argument("passed is yes, no or teacher");
}

ReturnedMarks marksOf(const Json& json) {
    ReturnedMarks marks;
    marks.marker = boundedText(json.at("marker"), kMaxReturnedMarkerBytes);
    marks.exercise = boundedText(json.at("exercise"), 200);
    marks.exerciseHash = hashIn(json.at("exercise_hash"));
    marks.stateHash = hashIn(json.at("state_hash"));
    for (const Json& hash : listIn(json.at("session_hash")))
        marks.sessionHashes.push_back(hashIn(hash));
    marks.rubric = boundedText(json.at("rubric"), 200);
    marks.rubricHash = hashIn(json.at("rubric_hash"));
    marks.maxScore = numberIn(json.at("max_score"), 0.0, kMostPoints);
    marks.score = numberIn(json.at("score"), 0.0, marks.maxScore);
    marks.passed = passedIn(json.at("passed"));
    if (json.contains("decision")) marks.decision = boundedText(json.at("decision"));
    for (const Json& one : listIn(json.at("changes"))) {
        ReturnedMarks::Change c;
        c.criterion = boundedText(one.at("criterion"), 200);
        if (one.contains("band")) c.band = boundedText(one.at("band"), 200);
        c.maxPoints = numberIn(one.at("max_points"), 0.0, kMostPoints);
        if (one.contains("points")) c.points = numberIn(one.at("points"), 0.0, c.maxPoints);
        c.isCritical = one.value("critical", false);
        c.reason = boundedText(one.at("reason"));
        marks.changes.push_back(std::move(c));
    }
    for (const Json& one : listIn(json.at("comments")))
        marks.comments.push_back(commentOf(one));
    return marks;
}

}  // namespace

ReturnedMarks returnedMarks(const Desk& desk, const std::string& code) {
    const assessment::Result* machine = desk.machine(code);
    const std::optional<score::Assessment> final = desk.finalScore(code);
    if (machine == nullptr || !final) {
        if (!desk.isRevealed(code)) throw core::Error("the machine's score is hidden yet", code, "mark first");
        const std::string why = desk.problem(code);
        throw core::Error("this work has no score" + (why.empty() ? why : ": " + why), code,
                          "score it: by that its student's program finds the work that the marks are of")
            .as("return-without-score", {why});
    }
    const Sheet& sheet = desk.sheet(code);
    ReturnedMarks marks;
    marks.marker = desk.marker();
    marks.exercise = machine->identity.exercise;
    marks.exerciseHash = machine->identity.exerciseHash;
    marks.stateHash = machine->identity.stateHash;
    marks.sessionHashes = machine->identity.sessionHashes;
    marks.rubric = desk.rubric().id;
    marks.rubricHash = rubric::hashText(final->rubricHash);
    marks.score = final->score;
    marks.maxScore = final->maxScore;
    marks.passed = *desk.passed(code);
    if (sheet.decision) marks.decision = sheet.decision->reason;
    for (const score::CriterionScore& now : final->criteria)
        if (const auto said = sheet.overrides.find(now.id); said != sheet.overrides.end())
            marks.changes.push_back({now.id, now.band, now.points, now.maxPoints, now.critical == score::Verdict::yes,
                                     said->second.reason});
    marks.comments = sheet.comments;
    return marks;
}

bool areOf(const ReturnedMarks& marks, const score::Identity& work) {
    return marks.exerciseHash == work.exerciseHash && marks.stateHash == work.stateHash &&
           // A hand-in may have gone without its recordings.
           (marks.sessionHashes.empty() || marks.sessionHashes == work.sessionHashes);
}

std::string returnedJson(const ReturnedMarks& marks) {
    Json json = {{"handpiece", kReturnedKind},
                 {"format", kReturnedFormat},
                 {"marker", marks.marker},
                 {"exercise", marks.exercise},
                 {"exercise_hash", marks.exerciseHash},
                 {"state_hash", marks.stateHash},
                 {"session_hash", marks.sessionHashes},
                 {"rubric", marks.rubric},
                 {"rubric_hash", marks.rubricHash},
                 {"score", marks.score},
                 {"max_score", marks.maxScore},
                 {"passed", score::nameOf(marks.passed)}};
    if (!marks.decision.empty()) json["decision"] = marks.decision;
    json["changes"] = Json::array();
    for (const ReturnedMarks::Change& c : marks.changes) {
        Json one = {{"criterion", c.criterion}};
        if (!c.band.empty()) one["band"] = c.band;
        if (c.points) one["points"] = *c.points;
        one["max_points"] = c.maxPoints;
        if (c.isCritical) one["critical"] = true;
        one["reason"] = c.reason;
        json["changes"].push_back(std::move(one));
    }
    json["comments"] = Json::array();
    for (const Comment& c : marks.comments)
        json["comments"].push_back(toJson(c));
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

ReturnedMarks parseReturned(std::string_view text, const std::string& where) {
    const auto wrong = [&where](const std::string& why) {
        return core::Error("these are no marks of a teacher: " + why, where, "ask your teacher for the file once more")
            .as("returned-damaged", {why});
    };
    if (text.size() > kMaxReturnedBytes) throw wrong("it is larger than 4 MiB");
    try {
        const Json json = config::requireOutsideJson<Json>(text);
        if (json.at("handpiece").get<std::string>() != kReturnedKind) throw wrong("it is something else");
        const auto* const format = json.at("format").get_ptr<const Json::number_integer_t*>();
        if (format == nullptr || *format < 1) throw wrong("its format is none");
        if (*format > kReturnedFormat)
            throw core::Error(
                fmt::format("these marks have format {}, and this program reads {}", *format, kReturnedFormat), where,
                "use the newer program")
                .as("returned-newer");
        return marksOf(json);
    } catch (const core::Error&) {
        throw;
    } catch (const std::exception& error) {  // of the JSON library and of numbers
        throw wrong(error.what());
    }
}

}  // namespace handpiece::marking
