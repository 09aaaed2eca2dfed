// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/measure_store.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/model/field/field_cache.h"

namespace handpiece::assessment {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using measures::Evidence;
using measures::Measured;

/// Before the hash of what follows it.
constexpr std::string_view kHead = "handpiece-measures-1 ";
constexpr std::size_t kHashDigits = 16, kMostBytes = 16 << 20;

template <class T>
Json orNull(const std::optional<T>& value) {
    return value ? Json(*value) : Json(nullptr);
}
std::optional<double> numberOr(const Json& json) {
    return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}
std::string hashOf(std::string_view text) {
    core::Hasher hasher;
    hasher.add(text);
    return rubric::hashText(hasher.value());
}

Json toJson(const Evidence& e) {
    return {{"t", orNull(e.timeS)},
            {"p", e.placeMm ? Json{e.placeMm->x(), e.placeMm->y(), e.placeMm->z()} : Json(nullptr)},
            {"f", orNull(e.forceN)},
            {"text", e.text},
            {"session", e.session}};
}
Evidence evidenceOf(const Json& json) {
    Evidence e;
    e.timeS = numberOr(json.at("t"));
    if (const Json& p = json.at("p"); !p.is_null())
        e.placeMm = core::Vec3(p.at(0).get<double>(), p.at(1).get<double>(), p.at(2).get<double>());
    e.forceN = numberOr(json.at("f"));
    e.text = json.at("text").get<std::string>();
    const auto* const session = json.at("session").get_ptr<const Json::number_unsigned_t*>();
    if (session == nullptr) throw core::Error("a session without a number", "kept measures");
    e.session = static_cast<std::size_t>(*session);
    return e;
}

Json toJson(const Measured& m) {
    Json json = {{"kind", m.kind},
                 {"of", {m.of.zone, m.of.tissue, m.of.side, m.of.statistic}},
                 {"limit", orNull(m.of.limit)},
                 {"value", orNull(m.value)},
                 {"uncertainty", m.uncertainty},
                 {"reason", m.reason}};
    json["evidence"] = Json::array();
    for (const Evidence& e : m.evidence)
        json["evidence"].push_back(toJson(e));
    return json;
}
/// Throws where it is none: also nlohmann's own errors.
Measured measuredOf(const Json& json) {
    Measured m;
    m.kind = json.at("kind").get<std::string>();
    const Json& of = json.at("of");
    m.of = {of.at(0).get<std::string>(), of.at(1).get<std::string>(), of.at(2).get<std::string>(),
            of.at(3).get<std::string>(), numberOr(json.at("limit"))};
    (void)measures::requireKind({m.kind, m.of});
    m.value = numberOr(json.at("value"));
    m.uncertainty = json.at("uncertainty").get<double>();
    m.reason = json.at("reason").get<std::string>();
    for (const Json& e : json.at("evidence"))
        m.evidence.push_back(evidenceOf(e));
    if (m.value.has_value() == !m.reason.empty()) throw core::Error("a value and a reason for none", m.kind);
    return m;
}

Json keyJson(const StoreKey& key) {
    return {{"work", key.work},
            {"exercise", key.exercise},
            {"engine", core::kEngineRevision},
            {"measures", measures::kMeasuresRevision}};
}

/// A number that is none has no JSON, and would come back as nothing.
bool canBeKept(const MeasuredWork& work) {
    return std::all_of(work.measured.begin(), work.measured.end(), [](const Measured& m) {
        return (!m.value || std::isfinite(*m.value)) && std::isfinite(m.uncertainty) &&
               m.value.has_value() == m.reason.empty() &&
               std::all_of(m.evidence.begin(), m.evidence.end(), [](const Evidence& e) {
                   return (!e.timeS || std::isfinite(*e.timeS)) && (!e.forceN || std::isfinite(*e.forceN)) &&
                          (!e.placeMm || e.placeMm->allFinite());
               });
    });
}

}  // namespace

std::string encodeMeasures(const StoreKey& key, const MeasuredWork& work) {
    Json json = {{"key", keyJson(key)},
                 {"exercise", work.identity.exercise},
                 {"exercise_hash", work.identity.exerciseHash},
                 {"case_key", work.identity.caseKey},
                 {"state_hash", work.identity.stateHash},
                 {"sessions", work.identity.sessionHashes},
                 {"proven", work.identity.proven},
                 {"proof", work.proof},
                 {"device", work.context.device},
                 {"motion_scale", work.context.motionScale}};
    json["measured"] = Json::array();
    for (const Measured& m : work.measured)
        json["measured"].push_back(toJson(m));
    const std::string body = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    return std::string(kHead) + hashOf(body) + "\n" + body;
}

std::optional<MeasuredWork> decodeMeasures(std::string_view text, const StoreKey& key) {
    const std::size_t from = kHead.size() + kHashDigits + 1;
    if (text.size() < from || !text.starts_with(kHead) || text[from - 1] != '\n' ||
        text.substr(kHead.size(), kHashDigits) != hashOf(text.substr(from)))
        return {};
    try {
        const Json json = config::requireOutsideJson<Json>(text.substr(from));
        if (json.at("key") != keyJson(key)) return {};
        MeasuredWork work;
        work.identity.exercise = json.at("exercise").get<std::string>();
        work.identity.exerciseHash = json.at("exercise_hash").get<std::string>();
        work.identity.caseKey = json.at("case_key").get<std::string>();
        work.identity.stateHash = json.at("state_hash").get<std::string>();
        work.identity.sessionHashes = json.at("sessions").get<std::vector<std::string>>();
        work.identity.proven = json.at("proven").get<bool>();
        work.identity.engineRevision = core::kEngineRevision;
        work.proof = json.at("proof").get<std::string>();
        work.context = {json.at("device").get<std::string>(), json.at("motion_scale").get<double>()};
        for (const Json& m : json.at("measured"))
            work.measured.push_back(measuredOf(m));
        return work;
    } catch (const nlohmann::json::exception&) {
        return {};  // not as this program writes it: it is measured again
    } catch (const core::Error&) {
        return {};  // measures that this program does not have
    }
}

const Measured* findMeasured(const MeasuredWork& in, const std::string& kind, const measures::Selection& of) {
    const auto at = std::find_if(in.measured.begin(), in.measured.end(),
                                 [&](const Measured& m) { return m.kind == kind && m.of == of; });
    return at == in.measured.end() ? nullptr : &*at;
}

bool takeMissing(MeasuredWork& to, const MeasuredWork& from) {
    if (to.identity.stateHash != from.identity.stateHash) return false;
    for (const Measured& m : from.measured)
        if (findMeasured(to, m.kind, m.of) == nullptr) to.measured.push_back(m);
    return true;
}

MeasureStore MeasureStore::usual() {
    const fs::path user = field::userCacheFolder();
    return MeasureStore(user.empty() ? user : user / "measures");
}

fs::path MeasureStore::placeOf(const StoreKey& key) const {
    return folder_ / (hashOf(keyJson(key).dump()) + ".measures");
}

std::optional<MeasuredWork> MeasureStore::find(const StoreKey& key) const {
    if (folder_.empty()) return {};
    const core::FileStream file = core::openOwnFile(placeOf(key));
    if (!file) return {};
    const std::uint64_t size = core::sizeOf(file);
    if (size > kMostBytes) return {};
    std::string text(static_cast<std::size_t>(size), '\0');
    if (std::fread(text.data(), 1, text.size(), file.get()) != text.size()) return {};
    return decodeMeasures(text, key);
}

void MeasureStore::keep(const StoreKey& key, const MeasuredWork& work) const {
    if (folder_.empty() || !canBeKept(work)) return;
    try {
        core::prepareOutputFolder(folder_, true);
        core::writeFile(placeOf(key), encodeMeasures(key, work), {true, false});
    } catch (const core::Error&) {
        // A full disk or a folder of somebody else's: nothing is lost but time.
    }
}

void MeasureStore::add(const StoreKey& key, MeasuredWork work) const {
    if (const std::optional<MeasuredWork> kept = find(key); kept && kept->identity.proven == work.identity.proven)
        takeMissing(work, *kept);
    keep(key, work);
}

}  // namespace handpiece::assessment
