// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/statements/statements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/hash_text.h"

namespace handpiece::statements {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostCode = 200, kMostAddress = 500;
constexpr school::Milliseconds kMsPerDay = 86'400'000, kLastMs = 253'402'300'799'999;  // 9999-12-31

bool isPlain(char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// Percent-encoded, all but letters, digits and "-._~" (RFC 3986).
std::string encoded(std::string_view text) {
    std::string out;
    for (const char c : text)
        out += isPlain(c) || std::string_view("-._~").find(c) != std::string_view::npos
                   ? std::string(1, c)
                   : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    return out;
}

void check(const Actor& actor) {
    const bool hasScheme = actor.homePage.starts_with("https://") || actor.homePage.starts_with("http://");
    const bool isAddress =
        hasScheme && actor.homePage.size() <= kMostAddress && actor.homePage.find("//") + 2 < actor.homePage.size() &&
        std::all_of(actor.homePage.begin(), actor.homePage.end(), [](char c) {
            return isPlain(c) || std::string_view("-._~:/[]@!$&'()*+,;=%").find(c) != std::string_view::npos;
        });
    if (!isAddress)
        throw core::Error(fmt::format("\"{}\" is no address of a school", actor.homePage), "--home-page",
                          "give one as https://school.example");
    const bool hasControl = std::any_of(actor.code.begin(), actor.code.end(),
                                        [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
    if (actor.code.empty() || actor.code.size() > kMostCode || hasControl)
        throw core::Error("a person's code has 1 to 200 bytes and no control characters", "--person",
                          "give the code that the school knows the person by");
    if (actor.code.find('@') != std::string::npos)
        throw core::Error("a person's code is no e-mail address", "--person",
                          "give the code that the school knows the person by: statements go to others");
}

/// 128 bits as RFC 4122 wants them, version 4: six bits say so.
std::string uuid(std::uint64_t high, std::uint64_t low) {
    high = (high & ~std::uint64_t{0xf000}) | 0x4000;
    low = (low & ~(std::uint64_t{3} << 62)) | std::uint64_t{2} << 62;
    return fmt::format("{:08x}-{:04x}-{:04x}-{:04x}-{:012x}", high >> 32, (high >> 16) & 0xffff, high & 0xffff,
                       low >> 48, low & 0xffffffffffff);
}
std::string uuidOf(const school::Attempt& attempt) {
    const std::string& id = attempt.id;
    const std::string_view text(id);
    const auto high = core::readHash(text.substr(0, 16));
    const auto low = text.size() == 32 ? core::readHash(text.substr(16)) : std::nullopt;
    if (!high || !low) throw core::Error("its id is none", fmt::format("attempt \"{}\"", id), "restore the store");
    return uuid(*high, *low);
}
std::string uuidOf(const school::Returned& returned) {
    std::uint64_t halves[2];
    for (std::uint64_t i = 0; i < 2; ++i) {
        core::Hasher hasher;
        hasher.add(i);
        for (const std::string* part : {&returned.attempt, &returned.marker, &returned.marks})
            hasher.add(std::uint64_t{part->size()}), hasher.add(*part);
        halves[i] = hasher.value();
    }
    return uuid(halves[0], halves[1]);
}

Json verb(const char* id, const char* english, const char* japanese) {
    return {{"id", fmt::format("http://adlnet.gov/expapi/verbs/{}", id)},
            {"display", {{"en", english}, {"ja", japanese}}}};
}

/// Addresses of extensions and activities lie under the school's own page: nobody else's names are claimed.
class Writer {
  public:
    explicit Writer(const Actor& actor) : actor_(actor), base_(actor.homePage) {
        while (base_.ends_with('/'))
            base_.pop_back();
    }

    Json completed(const Work& work) const {
        const school::Attempt& a = work.attempt;
        Json result = {{"completion", true}};
        addScore(result, a.score, a.maxScore);
        if (a.passed == "yes") result["success"] = true;
        if (a.workedS > 0.0) result["duration"] = fmt::format("PT{:.2f}S", a.workedS);
        Json about = {{term("passed"), a.passed},
                      {term("borderline"), a.borderline},
                      {term("proven"), a.proven},
                      {term("whole"), a.isWhole()},
                      {term("device"), a.device},
                      {term("motion-scale"), a.motionScale},
                      {term("late-s"), std::round(1e3 * a.lateS()) / 1e3},
                      {term("rubric-hash"), a.rubricHash},
                      {term("exercise-hash"), a.exerciseHash},
                      {term("session-hash"), a.sessionHashes}};
        result["extensions"] = std::move(about);
        return statement(uuidOf(a), verb("completed", "completed", "終えた"), work, std::move(result), a.finished);
    }

    Json scored(const Work& work, const school::Returned& returned) const {
        const auto damaged = [&](const char* why) -> core::Error {
            return {why, fmt::format("marks of attempt {}", work.attempt.id), "have them returned once more"};
        };
        const Json marks = config::outsideJson<Json>(returned.marks);
        if (!marks.is_object()) throw damaged("they are no marks");
        const auto number = [&](const char* key) {
            const auto found = marks.find(key);
            if (found == marks.end() || !found->is_number() || !std::isfinite(found->get<double>()))
                throw damaged("a number is missing");
            return found->get<double>();
        };
        Json result = Json::object();
        addScore(result, number("score"), number("max_score"));
        const auto verdict = marks.find("passed");
        if (verdict == marks.end() || !verdict->is_string()) throw damaged("they do not say who passed");
        const std::string passed = verdict->get<std::string>();
        if (passed == "yes" || passed == "no") result["success"] = passed == "yes";
        result["extensions"] = {{term("passed"), passed}};
        if (work.tellsMarkers) result["extensions"][term("marker")] = returned.marker;
        return statement(uuidOf(returned), verb("scored", "was marked in", "採点を受けた"), work, std::move(result),
                         returned.made);
    }

  private:
    std::string term(const char* name) const { return fmt::format("{}/handpiece/terms/{}", base_, name); }

    static void addScore(Json& result, double score, double most) {
        if (!(most > 0.0) || !std::isfinite(most) || !std::isfinite(score)) return;
        const double raw = std::clamp(score, 0.0, most);
        result["score"] = {{"scaled", raw / most}, {"raw", raw}, {"min", 0.0}, {"max", most}};
    }

    Json statement(std::string id, Json verb, const Work& work, Json result, school::Milliseconds at) const {
        const school::Attempt& a = work.attempt;
        Json definition = {{"type", "http://adlnet.gov/expapi/activities/simulation"}};
        if (!work.title.empty()) definition["name"] = {{"und", work.title}};
        // Under another rubric it is another activity: their scores are not to be pooled.
        std::string activity =
            fmt::format("{}/handpiece/exercises/{}/{}", base_, encoded(a.exercise), encoded(a.exerciseHash));
        if (!a.rubricHash.empty()) activity += fmt::format("/rubrics/{}", encoded(a.rubricHash));
        return {
            {"id", std::move(id)},
            {"actor", {{"objectType", "Agent"}, {"account", {{"homePage", actor_.homePage}, {"name", actor_.code}}}}},
            {"verb", std::move(verb)},
            {"object",
             {{"objectType", "Activity"}, {"id", std::move(activity)}, {"definition", std::move(definition)}}},
            {"result", std::move(result)},
            {"context", {{"platform", "Handpiece"}}},
            {"timestamp", timestamp(at)},
            {"version", "1.0.3"}};
    }

    const Actor& actor_;
    std::string base_;
};

}  // namespace

std::string timestamp(school::Milliseconds since1970) {
    const school::Milliseconds at = std::clamp<school::Milliseconds>(since1970, 0, kLastMs);
    // Days to a date: H. Hinnant's civil_from_days, for days since 1970.
    const std::int64_t days = at / kMsPerDay + 719'468, era = days / 146'097, ofEra = days % 146'097;
    const std::int64_t yearOfEra = (ofEra - ofEra / 1460 + ofEra / 36'524 - ofEra / 146'096) / 365;
    const std::int64_t ofYear = ofEra - (365 * yearOfEra + yearOfEra / 4 - yearOfEra / 100);
    const std::int64_t shifted = (5 * ofYear + 2) / 153, month = shifted < 10 ? shifted + 3 : shifted - 9;
    const std::int64_t year = yearOfEra + era * 400 + (month <= 2 ? 1 : 0), ms = at % kMsPerDay;
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", year, month, ofYear - (153 * shifted + 2) / 5 + 1,
                       ms / 3'600'000, ms / 60'000 % 60, ms / 1000 % 60, ms % 1000);
}

std::string statementsOf(std::span<const Work> works, const Actor& actor) {
    check(actor);
    const Writer writer(actor);
    Json all = Json::array();
    for (const Work& work : works) {
        all.push_back(writer.completed(work));
        for (const school::Returned& returned : work.returned)
            all.push_back(writer.scored(work, returned));
    }
    return all.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace handpiece::statements
