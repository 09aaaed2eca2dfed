// SPDX-License-Identifier: Apache-2.0
#include "school/wire.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "handpiece/base/config/outside_json.h"

namespace handpiece::school_wire {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostText = 4000, kMostResult = 3 << 20, kMostList = 200, kMostTasks = 2000,
                      kMostValues = 100'000;
constexpr double kMostNumber = 1e12;

/// A message from somebody: every field is looked at before it is used.
class Message {
  public:
    explicit Message(std::string_view text) {
        if (text.size() > kMostMessage) fail("message", "is too long");
        json_ = config::outsideJson<Json>(text, {.values = kMostValues});
        if (!json_.is_object()) fail("message", "is no JSON object");
    }
    [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }
    [[nodiscard]] std::string text(const char* key, std::size_t most = kMostText) const {
        const Json& found = at(key);
        if (!found.is_string()) fail(key, "is no text");
        std::string value = found.get<std::string>();
        if (value.size() > most) fail(key, "is too long");
        return value;
    }
    /// A SHA-256.
    [[nodiscard]] std::string hash(const char* key) const {
        std::string value = text(key, 64);
        if (!school::isHex(value, 64)) fail(key, "is no SHA-256");
        return value;
    }
    /// Empty where an older program says nothing of it.
    [[nodiscard]] std::string textIfAny(const char* key) const { return has(key) ? text(key) : std::string(); }
    [[nodiscard]] double number(const char* key) const {
        const Json& found = at(key);
        if (!found.is_number()) fail(key, "is no number");
        const double value = found.get<double>();
        if (!std::isfinite(value) || std::abs(value) > kMostNumber) fail(key, "is no number that can be meant");
        return value;
    }
    template <class T>
    [[nodiscard]] T whole(const char* key) const {
        const Json& found = at(key);
        if (found.is_number_unsigned() && std::in_range<T>(found.get<std::uint64_t>()))
            return static_cast<T>(found.get<std::uint64_t>());
        if (!found.is_number_unsigned() && found.is_number_integer() && std::in_range<T>(found.get<std::int64_t>()))
            return static_cast<T>(found.get<std::int64_t>());
        fail(key, "is no whole number that can be meant");
    }
    [[nodiscard]] bool flag(const char* key) const {
        const Json& found = at(key);
        if (!found.is_boolean()) fail(key, "is neither true nor false");
        return found.get<bool>();
    }
    [[nodiscard]] std::vector<std::string> texts(const char* key) const {
        const Json& found = at(key);
        if (!found.is_array() || found.size() > kMostList) fail(key, "is no list, or too long");
        std::vector<std::string> all;
        for (const Json& one : found) {
            if (!one.is_string() || one.get_ref<const std::string&>().size() > kMostText)
                fail(key, "is no list of texts");
            all.push_back(one.get<std::string>());
        }
        return all;
    }
    [[nodiscard]] Message message(const char* key) const {
        if (!at(key).is_object()) fail(key, "is no object");
        return Message(at(key));
    }
    [[nodiscard]] std::vector<Message> messages(const char* key) const {
        const Json& found = at(key);
        if (!found.is_array() || found.size() > kMostTasks) fail(key, "is no list, or too long");
        std::vector<Message> all;
        for (const Json& one : found) {
            if (!one.is_object()) fail(key, "is no list of objects");
            all.push_back(Message(one));
        }
        return all;
    }

  private:
    explicit Message(Json json) : json_(std::move(json)) {}
    [[noreturn]] static void fail(const char* key, const char* why) {
        throw core::Error(fmt::format("\"{}\" {}", key, why), "message", "use programs that belong together")
            .as("message-damaged", {key, why});
    }
    [[nodiscard]] const Json& at(const char* key) const {
        const auto found = json_.find(key);
        if (found == json_.end()) fail(key, "is missing");
        return *found;
    }
    Json json_;
};

std::string dumped(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string toJson(const school::PushedAttempt& p) {
    const school::Attempt& a = p.attempt;
    return dumped({{"id", a.id},
                   {"person", p.person},
                   {"assignment", p.assignment},
                   {"files", p.files},
                   {"exercise", a.exercise},
                   {"exercise_hash", a.exerciseHash},
                   {"rubric_hash", a.rubricHash},
                   {"session_hash", a.sessionHashes},
                   {"began_ms", a.began},
                   {"finished_ms", a.finished},
                   {"device", a.device},
                   {"motion_scale", a.motionScale},
                   {"score", a.score},
                   {"max_score", a.maxScore},
                   {"whole_score", a.wholeScore},
                   {"passed", a.passed},
                   {"borderline", a.borderline},
                   {"worked_s", a.workedS},
                   {"limit_s", a.limitS},
                   {"result", a.result}});
}
school::PushedAttempt attemptFrom(std::string_view json) {
    const Message m(json);
    school::PushedAttempt p;
    school::Attempt& a = p.attempt;
    a.id = m.text("id");
    p.person = m.text("person"), p.assignment = m.text("assignment"), p.files = m.texts("files");
    a.exercise = m.text("exercise"), a.exerciseHash = m.text("exercise_hash"), a.rubricHash = m.text("rubric_hash");
    a.sessionHashes = m.texts("session_hash");
    a.began = m.whole<school::Milliseconds>("began_ms"), a.finished = m.whole<school::Milliseconds>("finished_ms");
    a.device = m.text("device"), a.motionScale = m.number("motion_scale");
    a.score = m.number("score"), a.maxScore = m.number("max_score"), a.wholeScore = m.number("whole_score");
    a.passed = m.text("passed"), a.borderline = m.flag("borderline");
    a.workedS = m.number("worked_s"), a.limitS = m.number("limit_s");
    a.result = m.text("result", kMostResult);
    return p;
}

std::string toJson(const school::Judgement& j) {
    return dumped({{"attempt", j.attempt}, {"percent", j.percent}, {"words", j.words}, {"made_ms", j.made}});
}
school::Judgement judgementFrom(std::string_view json) {
    const Message m(json);
    return {m.text("attempt"), m.number("percent"), m.text("words"), m.whole<school::Milliseconds>("made_ms")};
}

std::string toJson(const Enrolled& e) {
    return dumped({{"station", e.station}, {"key", e.key}, {"person", e.person}});
}
Enrolled enrolledFrom(std::string_view json) {
    const Message m(json);
    return {m.text("station"), m.text("key"), m.textIfAny("person")};
}
std::string toJson(const Enrol& e) {
    Json json{{"code", e.code}};
    if (e.person) json["person"] = *e.person;
    if (e.kind) json["kind"] = *e.kind;
    return dumped(std::move(json));
}
Enrol enrolFrom(std::string_view json) {
    const Message m(json);
    Enrol enrol{m.text("code", 200), {}, {}};
    if (m.has("person")) enrol.person = m.text("person", 64);
    if (m.has("kind")) enrol.kind = m.text("kind", 16);
    return enrol;
}

std::string toJson(const Received& r) {
    return dumped({{"bytes", r.bytes}, {"whole", r.isWhole}});
}
Received receivedFrom(std::string_view json) {
    const Message m(json);
    return {m.whole<std::uint64_t>("bytes"), m.flag("whole")};
}

std::string toJson(const Status& s) {
    return dumped({{"server", s.server},
                   {"protocol", s.protocol},
                   {"engine", s.engine},
                   {"station", s.station},
                   {"books", s.books},
                   {"now_ms", s.now},
                   {"missing", s.missing}});
}
Status statusFrom(std::string_view json) {
    const Message m(json);
    return {m.text("server"),
            m.whole<int>("protocol"),
            m.whole<std::int32_t>("engine"),
            m.text("station"),
            m.has("books") ? m.text("books") : std::string(),
            m.has("now_ms") ? m.whole<std::int64_t>("now_ms") : 0,
            m.texts("missing")};
}

std::string toJson(const std::vector<Task>& tasks) {
    Json list = Json::array();
    for (const Task& t : tasks)
        list.push_back({{"assignment", t.assignment},
                        {"exercise_hash", t.exerciseHash},
                        {"title", t.title},
                        {"opens_ms", t.opens},
                        {"closes_ms", t.closes}});
    return dumped({{"tasks", std::move(list)}});
}
std::vector<Task> tasksFrom(std::string_view json) {
    std::vector<Task> tasks;
    for (const Message& m : Message(json).messages("tasks"))
        tasks.push_back({m.text("assignment"), m.text("exercise_hash"), m.text("title"),
                         m.whole<school::Milliseconds>("opens_ms"), m.whole<school::Milliseconds>("closes_ms")});
    return tasks;
}

std::string toJson(const Work& w) {
    const auto file = [](const Work::File& f) { return Json{{"hash", f.hash}, {"bytes", f.bytes}}; };
    Json sessions = Json::array();
    for (const Work::File& one : w.sessions)
        sessions.push_back(file(one));
    return dumped({{"number", w.number},
                   {"turn", w.turn},
                   {"lease_ms", w.leaseMs},
                   {"question", w.question},
                   {"sessions", std::move(sessions)},
                   {"exercise", file(w.exercise)}});
}
Work workFrom(std::string_view json) {
    // They become files' names.
    const auto file = [](const Message& m) { return Work::File{m.hash("hash"), m.whole<std::uint64_t>("bytes")}; };
    const Message m(json);
    Work work{m.whole<std::int64_t>("number"), m.whole<std::int64_t>("turn"), m.whole<school::Milliseconds>("lease_ms"),
              m.text("question", kMostMessage)};
    for (const Message& one : m.messages("sessions"))
        work.sessions.push_back(file(one));
    work.exercise = file(m.message("exercise"));
    return work;
}

std::string framed(std::string_view json, std::string_view rest) {
    std::string bytes;
    bytes.reserve(4 + json.size() + rest.size());
    for (int shift = 0; shift < 32; shift += 8)
        bytes += static_cast<char>(json.size() >> shift & 0xFF);
    bytes.append(json).append(rest);
    return bytes;
}
std::pair<std::string_view, std::string_view> unframed(std::string_view bytes) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4 && i < bytes.size(); ++i)
        length |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[i])) << 8 * i;
    if (bytes.size() < 4 || length > bytes.size() - 4)
        throw core::Error("it is shorter than it says", "message", "use programs that belong together")
            .as("message-damaged", {"message", "is shorter than it says"});
    return {bytes.substr(4, length), bytes.substr(4 + length)};
}

std::string toBytes(const Live& live) {
    return framed(dumped({{"person", live.person},
                          {"assignment", live.assignment},
                          {"exercise_hash", live.exerciseHash},
                          {"title", live.title},
                          {"shared", live.isShared},
                          {"elapsed_s", live.elapsedS},
                          {"removed_mm3", live.removedMm3},
                          {"flags", live.flags},
                          {"age_ms", live.ageMs}}),
                  live.picture);
}
Live liveFrom(std::string_view bytes) {
    const auto [json, picture] = unframed(bytes);
    constexpr std::size_t kMostWord = 200;
    const Message m(json);
    Live live;
    live.person = m.text("person", kMostWord), live.assignment = m.text("assignment", kMostWord);
    live.exerciseHash = m.text("exercise_hash", kMostWord), live.title = m.text("title", kMostWord);
    live.isShared = m.flag("shared");
    live.elapsedS = m.number("elapsed_s"), live.removedMm3 = m.number("removed_mm3");
    const std::vector<std::string> flags = m.texts("flags");
    for (const std::string_view known : kLiveFlags)
        if (std::find(flags.begin(), flags.end(), known) != flags.end()) live.flags.emplace_back(known);
    live.ageMs = m.whole<std::int64_t>("age_ms");
    live.picture = picture;
    return live;
}

std::string toJson(const Watched& watched) {
    Json by = Json::array();
    for (const Watcher& one : watched.by)
        by.push_back({{"name", one.name}, {"role", one.role}});
    return dumped({{"by", std::move(by)}, {"closely", watched.closely}});
}
Watched watchedFrom(std::string_view json) {
    const Message m(json);
    Watched watched;
    for (const Message& one : m.messages("by"))
        watched.by.push_back({one.text("name"), one.text("role")});
    watched.closely = m.flag("closely");
    return watched;
}

std::string toJson(const core::Error& e) {
    return dumped({{"error", e.id()},
                   {"what", e.problem()},
                   {"where", e.where()},
                   {"remedy", e.remedy()},
                   {"arguments", e.arguments()}});
}
core::Error errorFrom(std::string_view json, int status) {
    try {
        const Message m(json);
        const std::string where = m.text("where");
        return core::Error(m.text("what"), std::string(kServer) + (where.empty() ? "" : ": " + where), m.text("remedy"))
            .as(m.text("error"), m.texts("arguments"));
    } catch (const core::Error&) {
        return core::Error(fmt::format("it answers {} and nothing that can be read", status), "the school's server",
                           "ask whether this is its address")
            .as("server-nonsense", {std::to_string(status)});
    }
}

}  // namespace handpiece::school_wire
