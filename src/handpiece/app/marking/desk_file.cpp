// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <nlohmann/json.hpp>

#include "handpiece/app/marking/desk.h"
#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/core/error.h"

namespace handpiece::marking {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr std::size_t kMaxDeskBytes = 64u << 20, kMaxText = 4000, kMaxMarkerBytes = 60;

std::string hex(std::uint64_t value) {
    return fmt::format("{:016x}", value);
}

/// A text of limited length.
std::string textIn(const Json& json, std::size_t most = kMaxText) {
    std::string text = json.get<std::string>();
    if (text.size() > most) throw std::length_error("a text is too long");
    return text;
}
double numberIn(const Json& json) {
    const double value = json.get<double>();
    if (!std::isfinite(value)) throw std::out_of_range("a number is not finite");
    return value;
}
/// A count: 0 and more.
int countIn(const Json& json) {
    const auto* const whole = json.get_ptr<const Json::number_integer_t*>();
    if (whole == nullptr || *whole < 0 || *whole > INT_MAX) throw std::out_of_range("a count is none");
    return static_cast<int>(*whole);
}

Json toJson(const Sheet& sheet) {
    Json json = Json::object();
    if (sheet.isIn) json["in"] = true;
    for (const auto& [id, mark] : sheet.marks) {
        Json one = Json::object();
        if (!mark.band.empty()) one["band"] = mark.band;
        if (mark.points) one["points"] = *mark.points;
        if (mark.cannotTell) one["cannot_tell"] = true;
        json["marks"][id] = std::move(one);
    }
    for (const auto& [id, o] : sheet.overrides) {
        Json one = Json::object();
        if (!o.band.empty()) one["band"] = o.band;
        if (o.points) one["points"] = *o.points;
        if (o.critical) one["critical"] = *o.critical;
        one["reason"] = o.reason;
        json["overrides"][id] = std::move(one);
    }
    for (const Comment& c : sheet.comments) {
        Json one = {{"number", c.number}, {"text", c.text}};
        if (!c.criterion.empty()) one["criterion"] = c.criterion;
        if (c.placeMm) one["xyz_mm"] = {c.placeMm->x(), c.placeMm->y(), c.placeMm->z()};
        if (c.timeS) one["t_s"] = *c.timeS;
        if (c.session) one["session"] = *c.session;
        json["comments"].push_back(std::move(one));
    }
    if (sheet.decision) json["decision"] = {{"passed", sheet.decision->passed}, {"reason", sheet.decision->reason}};
    return json;
}

Sheet sheetOf(const Json& json) {
    Sheet sheet;
    sheet.isIn = json.value("in", false);
    if (json.contains("marks"))
        for (const auto& [id, one] : json.at("marks").items()) {
            Mark mark;
            if (one.contains("band")) mark.band = textIn(one.at("band"));
            if (one.contains("points")) mark.points = numberIn(one.at("points"));
            mark.cannotTell = one.value("cannot_tell", false);
            sheet.marks.emplace(id, std::move(mark));
        }
    if (json.contains("overrides"))
        for (const auto& [id, one] : json.at("overrides").items()) {
            Override o;
            if (one.contains("band")) o.band = textIn(one.at("band"));
            if (one.contains("points")) o.points = numberIn(one.at("points"));
            if (one.contains("critical")) o.critical = one.at("critical").get<bool>();
            o.reason = textIn(one.at("reason"));
            sheet.overrides.emplace(id, std::move(o));
        }
    if (json.contains("comments"))
        for (const Json& one : json.at("comments")) {
            Comment c;
            c.number = countIn(one.at("number"));
            c.text = textIn(one.at("text"));
            if (one.contains("criterion")) c.criterion = textIn(one.at("criterion"));
            if (one.contains("xyz_mm"))
                c.placeMm = core::Vec3(numberIn(one.at("xyz_mm").at(0)), numberIn(one.at("xyz_mm").at(1)),
                                       numberIn(one.at("xyz_mm").at(2)));
            if (one.contains("t_s")) c.timeS = numberIn(one.at("t_s"));
            if (one.contains("session")) c.session = static_cast<std::size_t>(countIn(one.at("session")));
            sheet.comments.push_back(std::move(c));
        }
    if (json.contains("decision"))
        sheet.decision =
            Decision{json.at("decision").at("passed").get<bool>(), textIn(json.at("decision").at("reason"))};
    return sheet;
}

DeskState stateOf(const Json& json) {
    DeskState state;
    state.marker = textIn(json.at("marker"), kMaxMarkerBytes);
    state.exercise = textIn(json.at("exercise"));
    state.exerciseHash = textIn(json.at("exercise_hash"));
    state.rubric = textIn(json.at("rubric"));
    state.rubricHash = textIn(json.at("rubric_hash"));
    state.isBlind = json.at("blind").get<bool>();
    const std::string seed = json.at("seed").get<std::string>();
    std::size_t used = 0;
    state.seed = std::stoull(seed, &used, 16);
    if (used != seed.size()) throw std::invalid_argument("the seed is no number");
    for (const Json& batch : json.at("batches")) {
        std::vector<std::string> ids;
        for (const Json& work : batch) {
            ids.push_back(textIn(work.at("id"), 64));
            if (!state.names.emplace(ids.back(), textIn(work.at("name"))).second)
                throw std::invalid_argument("a work is there twice");
        }
        if (state.names.size() > kMaxWorks) throw std::length_error("there are too many works");
        state.batches.push_back(std::move(ids));
    }
    for (const auto& [code, sheet] : json.at("sheets").items())
        state.sheets.emplace(code, sheetOf(sheet));
    state.nextComment = countIn(json.at("next_comment"));
    return state;
}

}  // namespace

fs::path deskFile(const fs::path& folder, const std::string& marker) {
    const bool isControl = std::any_of(marker.begin(), marker.end(), [](char c) {
        return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '/' || c == '\\' || c == '"';
    });
    if (marker.find_first_not_of(' ') == std::string::npos)
        throw core::Error("the marker has no name", folder.string(), "give a name or a code").as("marker-name");
    if (isControl || marker.size() > kMaxMarkerBytes || marker.front() == ' ' || marker.back() == ' ' ||
        marker.ends_with(" again") || marker == "machine")
        throw core::Error(fmt::format("nobody can mark as \"{}\"", marker), folder.string(),
                          "give a name or a code of up to 60 bytes, without / \\ \"; \"machine\" and \"... again\" are "
                          "taken")
            .as("marker-name");
    return folder / ("marking-" + marker + ".json");
}

std::string deskJson(const DeskState& state) {
    Json json = {{"handpiece", "marking"},
                 {"format", kFormat},
                 {"marker", state.marker},
                 {"exercise", state.exercise},
                 {"exercise_hash", state.exerciseHash},
                 {"rubric", state.rubric},
                 {"rubric_hash", state.rubricHash},
                 {"blind", state.isBlind},
                 {"seed", hex(state.seed)},
                 {"batches", Json::array()},
                 {"sheets", Json::object()},
                 {"next_comment", state.nextComment}};
    for (const std::vector<std::string>& ids : state.batches) {
        Json batch = Json::array();
        for (const std::string& id : ids)
            batch.push_back({{"id", id}, {"name", state.names.at(id)}});
        json["batches"].push_back(std::move(batch));
    }
    for (const auto& [code, sheet] : state.sheets)
        json["sheets"][code] = toJson(sheet);
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

DeskState parseDesk(std::string_view text, const std::string& where) {
    const auto wrong = [&where](const std::string& why) {
        return core::Error("this is no marking desk: " + why, where,
                           "bring it back from a copy, or mark under another name")
            .as("desk-damaged", {why});
    };
    if (text.size() > kMaxDeskBytes) throw wrong("it is larger than 64 MiB");
    try {
        const Json json = config::requireOutsideJson<Json>(text, {.keys = 20'000});
        if (json.at("handpiece").get<std::string>() != "marking") throw wrong("it is something else");
        if (const int format = countIn(json.at("format")); format > kFormat)
            throw core::Error(fmt::format("this desk has format {}, and this program reads {}", format, kFormat), where,
                              "use the newer program")
                .as("desk-newer");
        return stateOf(json);
    } catch (const core::Error&) {
        throw;
    } catch (const std::exception& error) {  // of the JSON library and of numbers
        throw wrong(error.what());
    }
}

}  // namespace handpiece::marking
