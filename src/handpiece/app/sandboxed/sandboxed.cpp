// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/sandboxed/sandboxed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/proving/likeness.h"
#include "handpiece/app/sandboxed/sandboxed_work.h"
#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/prepared/prepared_files.h"
#include "handpiece/base/sandbox/sandbox.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/case/package_type.h"
#include "handpiece/school/store/content_files.h"

namespace handpiece::sandboxed {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

core::Error noAnswer() {
    return core::Error("what its reader says of it is no answer", "",
                       "it is damaged, or was made to do this: record it again")
        .as("sandbox-died", {"no answer"});
}

/// Of what the reader said. Every question of a kind that it has not is the file's fault.
class Said {
  public:
    explicit Said(const std::string& text) : json_(config::outsideJson<Json>(text)) {
        if (!json_.is_object()) throw noAnswer();
    }
    [[nodiscard]] std::string text(const char* key, std::size_t most) const { return textOf(at(key), most); }
    [[nodiscard]] double number(const char* key) const { return numberOf(at(key)); }
    [[nodiscard]] std::optional<double> numberIfAny(const char* key) const {
        if (at(key).is_null()) return {};
        return number(key);
    }
    [[nodiscard]] bool yes(const char* key) const {
        if (!at(key).is_boolean()) throw noAnswer();
        return at(key).get<bool>();
    }
    [[nodiscard]] std::size_t count(const char* key) const { return countOf(at(key)); }
    [[nodiscard]] std::vector<std::string> texts(const char* key, std::size_t mostTexts, std::size_t most) const {
        return textsOf(at(key), mostTexts, most);
    }
    static std::vector<std::string> textsOf(const Json& list, std::size_t mostTexts, std::size_t most) {
        if (!list.is_array() || list.size() > mostTexts) throw noAnswer();
        std::vector<std::string> all;
        for (const Json& one : list)
            all.push_back(textOf(one, most));
        return all;
    }
    [[nodiscard]] std::map<std::string, std::string> byLanguage(const char* key, std::size_t most) const {
        const Json& list = at(key);
        if (!list.is_object() || list.size() > 50) throw noAnswer();
        std::map<std::string, std::string> all;
        for (const auto& [language, words] : list.items())
            all[language.substr(0, 16)] = textOf(words, most);
        return all;
    }
    [[nodiscard]] const Json& at(const char* key) const {
        const auto found = json_.find(key);
        if (found == json_.end()) throw noAnswer();
        return *found;
    }
    static double numberOf(const Json& one) {
        if (!one.is_number() || !std::isfinite(one.get<double>())) throw noAnswer();
        return one.get<double>();
    }
    static std::size_t countOf(const Json& one) {
        if (!one.is_number_unsigned()) throw noAnswer();
        return one.get<std::size_t>();
    }
    static std::string textOf(const Json& one, std::size_t most) {
        if (!one.is_string() || one.get_ref<const std::string&>().size() > most) throw noAnswer();
        std::string text = one;
        for (char& c : text)
            if ((static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\t') || c == '\x7f') c = ' ';
        return text;
    }

  private:
    Json json_;
};

std::string oneLine(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

sandbox::Answer asked(const char* work, Json request, const Files& files, const sandbox::Bounds& bounds,
                      const core::Progress& progress = {}, std::span<const fs::path> besides = {}) {
    std::vector<fs::path> readable = files.sessions;
    Json sessions = Json::array();
    for (fs::path& one : readable) {
        one = core::wholePath(one);
        sessions.push_back(one.string());
    }
    const fs::path exercise = files.exercise.empty() ? fs::path() : core::wholePath(files.exercise);
    if (!exercise.empty() && !core::isThere(exercise))
        throw core::Error("there is no such file", exercise.string(), "check its name");
    if (!exercise.empty()) readable.push_back(exercise);
    for (const fs::path& one : besides)
        readable.push_back(core::wholePath(one));
    request["work"] = work, request["language"] = config::words().language();
    request["sessions"] = sessions, request["exercise"] = exercise.string();
    return sandbox::ask(oneLine(request), readable, bounds, progress);
}

/// A recording of half an hour has some 30 MB [R] (docs/session-format.md) and is cut again in minutes.
sandbox::Bounds boundsFor(const Files& files) {
    double megabytes = 0.0;
    for (const fs::path& one : files.sessions) {
        std::error_code ec;
        const std::uintmax_t size = fs::file_size(one, ec);
        if (!ec) megabytes += 1e-6 * static_cast<double>(size);
    }
    sandbox::Bounds bounds;
    bounds.cpuS = std::min(600.0 + 120.0 * megabytes, 4.0 * 3600.0);
    bounds.wallS = bounds.cpuS + 600.0;
    return bounds;
}
/// Of what somebody waits for in front of a page.
constexpr sandbox::Bounds kPage{.cpuS = 120.0, .wallS = 120.0};

school::Score refusedFor(const core::Error& e) {
    school::Score s;
    s.state = "refused", s.passed = "teacher", s.reason = e.problem();
    s.engine = core::kEngineRevision;
    return s;
}

/// Sessions that came along with something else.
struct Carried {
    std::string name{};
    std::span<const std::byte> bytes{};
};
constexpr std::size_t kMostCarried = 1000;
/// As `answer` says, which must outlive them.
std::vector<Carried> carriedIn(const Said& said, const sandbox::Answer& answer) {
    const Json& list = said.at("sessions");
    if (!list.is_array() || list.size() > kMostCarried) throw noAnswer();
    std::span<const std::byte> left(answer.bytes);
    std::vector<Carried> all;
    for (const Json& one : list) {
        if (!one.is_object() || !one.contains("name") || !one.contains("bytes")) throw noAnswer();
        const std::size_t size = Said::countOf(one.at("bytes"));
        if (size > left.size()) throw noAnswer();
        all.push_back({Said::textOf(one.at("name"), 250), left.first(size)});
        left = left.subspan(size);
    }
    return all;
}

constexpr std::size_t kMostResult = 1u << 20, kMostWords = 16'384;

Exercise exerciseFrom(const Said& said) {
    Exercise e;
    e.id = said.text("id", 64), e.hash = said.text("hash", 16), e.tooth = said.text("tooth", 1000);
    e.level = said.text("level", 64), e.rubric = said.text("rubric", 1u << 20);
    e.title = said.byLanguage("title", 1000), e.instructions = said.byLanguage("instructions", kMostWords);
    const double version = said.number("version");
    if (version < 0 || version > 1e15 || !school::isHex(e.hash, 16)) throw noAnswer();
    e.version = static_cast<std::int64_t>(version);
    e.minutes = said.numberIfAny("minutes"), e.voxelMm = said.number("voxel_mm");
    e.hasPreparation = said.yes("has_preparation"), e.lockedHelps = said.texts("locked_helps", 100, 64);
    return e;
}

Contents contentsFrom(const Said& said, std::size_t sessions) {
    Contents contents{said.texts("contents", sessions, 64), {}};
    if (contents.inputs.size() != sessions) throw noAnswer();
    for (const std::string& one : contents.inputs)
        if (!one.empty() && !school::isHex(one, 64)) throw noAnswer();
    const Json& sketches = said.at("sketches");
    if (!sketches.is_array() || sketches.size() != sessions) throw noAnswer();
    for (const Json& one : sketches) {
        contents.sketches.push_back(Said::textsOf(one, proving::kSketch, 16));
        for (const std::string& hash : contents.sketches.back())
            if (!school::isHex(hash, 16)) throw noAnswer();
    }
    return contents;
}
Contents nothingIn(std::size_t sessions) {
    return {std::vector<std::string>(sessions), std::vector<std::vector<std::string>>(sessions)};
}

}  // namespace

Contents contentsOf(const std::vector<fs::path>& sessions) {
    const Files files{sessions, {}};
    try {
        return contentsFrom(Said(asked("contents", Json::object(), files, boundsFor(files)).text), sessions.size());
    } catch (const core::Error& e) {
        if (!sandbox::isFault(e)) throw;
        return nothingIn(sessions.size());
    }
}

std::string questionOf(const school::PushedAttempt& pushed, const std::string& rubric,
                       const std::optional<ExamNotes>& exam) {
    const school::Attempt& a = pushed.attempt;
    Json question{{"rubric", rubric},
                  {"attempt",
                   {{"id", a.id},
                    {"exercise_hash", a.exerciseHash},
                    {"rubric_hash", a.rubricHash},
                    {"session_hashes", a.sessionHashes},
                    {"device", a.device},
                    {"score", a.score},
                    {"max_score", a.maxScore},
                    {"passed", a.passed}}}};
    if (exam) question["exam"] = {{"locked", exam->locked}, {"entries", exam->entries}};
    return oneLine(question);
}

std::string toJson(const Proof& proof) {
    const school::Score& s = proof.score;
    return oneLine({{"state", s.state},
                    {"reason", s.reason},
                    {"state_hash", s.stateHash},
                    {"score", s.score},
                    {"max_score", s.maxScore},
                    {"whole_score", s.wholeScore},
                    {"passed", s.passed},
                    {"borderline", s.borderline},
                    {"result", s.result},
                    {"contents", proof.contents.inputs},
                    {"sketches", proof.contents.sketches},
                    {"doubts", proof.doubts}});
}
std::string toJson(const Contents& contents) {
    return oneLine({{"contents", contents.inputs}, {"sketches", contents.sketches}});
}

Proof proofFrom(const std::string& json, std::size_t sessions) {
    const Said said(json);
    Proof proof;
    school::Score& s = proof.score;
    s.state = said.text("state", 16), s.reason = said.text("reason", kMostWords);
    s.passed = said.text("passed", 16), s.stateHash = said.text("state_hash", 64);
    s.score = said.number("score"), s.maxScore = said.number("max_score");
    s.wholeScore = said.number("whole_score"), s.borderline = said.yes("borderline");
    s.result = said.text("result", kMostResult);
    s.engine = core::kEngineRevision;
    const bool isKind = (s.state == "proven" || s.state == "refused") &&
                        (s.passed == "yes" || s.passed == "no" || s.passed == "teacher") &&
                        (s.state == "refused" || !s.result.empty());
    // What no rubric gives.
    constexpr double kMostPoints = 1e6, kSame = 1e-6;
    const bool isInOrder = s.score >= 0.0 && s.score <= s.maxScore + kSame && s.maxScore <= kMostPoints &&
                           s.wholeScore >= 0.0 && s.wholeScore <= kMostPoints;
    if (!isKind || !isInOrder) throw noAnswer();
    if (!s.result.empty()) {
        const score::Assessment a = assessment::parseResult(s.result, "what was found").assessment;
        if (std::abs(a.score - s.score) > kSame || std::abs(a.maxScore - s.maxScore) > kSame) throw noAnswer();
    }
    proof.contents = contentsFrom(said, sessions);
    proof.doubts = said.texts("doubts", 1000, 1000);
    return proof;
}

Proof prove(const std::string& question, const Files& files, const core::Progress& progress) {
    const std::size_t sessions = files.sessions.size();
    Json asks = config::outsideJson<Json>(question);
    if (!asks.is_object()) throw noAnswer();
    const bool isExam = asks.contains("exam");
    try {
        return proofFrom(asked("prove", std::move(asks), files, boundsFor(files), progress).text, sessions);
    } catch (const core::Error& e) {
        if (!sandbox::isFault(e) || e.id() == "sandbox-exercise") throw;
        Proof proof{refusedFor(e), nothingIn(sessions), {}};
        if (isExam) proof.doubts = {"its recordings cannot be held against what was noted: " + e.problem()};
        return proof;
    }
}

report::Review review(const Files& files, const std::string& title, const std::string& result,
                      const std::string& rubric, std::size_t mostBytes, const core::Progress& progress) {
    sandbox::Bounds bounds = boundsFor(files);
    bounds.answerBytes = 4 * mostBytes;
    const sandbox::Answer answer =
        asked("review", {{"title", title}, {"result", result}, {"rubric", rubric}, {"most", mostBytes}}, files, bounds,
              progress);
    const Said said(answer.text);
    report::Review review;
    review.json = said.text("review", 4 * mostBytes);
    // It stands in a page between two tags.
    if (review.json.find('<') != std::string::npos || !config::jsonProblem(review.json).empty()) throw noAnswer();
    std::span<const std::byte> left(answer.bytes);
    const auto taken = [&left](std::size_t size) {
        if (size > left.size()) throw noAnswer();
        const std::span<const std::byte> piece = left.first(size);
        left = left.subspan(size);
        return std::vector<std::byte>(piece.begin(), piece.end());
    };
    review.data = taken(said.count("data"));
    const Json& pictures = said.at("pictures");
    if (!pictures.is_array() || pictures.size() > 100) throw noAnswer();
    for (const Json& one : pictures) {
        if (!one.is_object() || !one.contains("time_s") || !one.contains("bytes")) throw noAnswer();
        review.pictures.push_back({Said::numberOf(one.at("time_s")), taken(Said::countOf(one.at("bytes")))});
    }
    return review;
}

ReadThrough readThrough(const fs::path& session, const core::Progress& progress) {
    const Files files{{session}, {}};
    sandbox::Bounds bounds = boundsFor(files);
    bounds.answerBytes = 4096;
    const sandbox::Answer answer = asked("session", Json::object(), files, bounds, progress);
    const Said said(answer.text);
    return {said.count("ticks"), said.count("events"), said.count("key_frames"), answer.peakBytes};
}

CheckedPackage checkPackage(const fs::path& file, const core::Progress& progress) {
    constexpr double kOfItself = 0.3;  // of the work, where there are sessions in it
    sandbox::Bounds bounds = boundsFor({{file}, {}});
    bounds.answerBytes = kMostCarriedBytes;
    const sandbox::Answer answer =
        asked("package", Json::object(), {{}, file}, bounds, core::part(progress, 0.0, kOfItself));
    const Said said(answer.text);
    CheckedPackage checked;
    checked.type = said.text("type", 16);
    if (std::find(cases::kPackageTypes.begin(), cases::kPackageTypes.end(), checked.type) == cases::kPackageTypes.end())
        throw noAnswer();
    const std::vector<Carried> sessions = carriedIn(said, answer);
    if (sessions.empty()) return checked;
    const core::PrivateFolder folder;
    for (std::size_t i = 0; i < sessions.size(); ++i) {
        const auto share = [&](std::size_t n) {
            return kOfItself + (1.0 - kOfItself) * static_cast<double>(n) / static_cast<double>(sessions.size());
        };
        const fs::path place = folder.path() / fmt::format("{}.h5", i + 1);
        core::writeFile(place, sessions[i].bytes, {true, false});
        checked.sessions.push_back(prepared::sha256Of(sessions[i].bytes));
        try {
            (void)readThrough(place, core::part(progress, share(i), share(i + 1)));
        } catch (const core::Error& e) {
            if (!sandbox::isFault(e)) throw;
            throw core::Error(e.problem(), fmt::format("{} in {}", sessions[i].name, file.string()), e.remedy())
                .as(e.id(), e.arguments());
        }
    }
    return checked;
}

namespace {

/// A folder's files are all that lies in it.
sandbox::Bounds boundsOf(const fs::path& work) {
    Files files;
    std::error_code ec;
    if (!core::isFolder(work)) files.sessions.push_back(work);
    for (fs::recursive_directory_iterator at(work, ec), end; !ec && at != end; at.increment(ec))
        if (at->is_regular_file(ec)) files.sessions.push_back(at->path());
    return boundsFor(files);
}

/// The case that an attempt names; empty where there is none in its own folder.
fs::path beside(const fs::path& work, const std::string& named) {
    std::error_code none, noFolder;
    const fs::path in = fs::canonical(work.parent_path(), noFolder), is = fs::canonical(named, none);
    if (noFolder || none || std::mismatch(in.begin(), in.end(), is.begin(), is.end()).first != in.end()) return {};
    return cases::isPackageName(is) || core::isThere(is / "case.toml") ? is : fs::path();
}

bool isPlainName(const std::string& name) {
    return name.size() > 3 && name.ends_with(".h5") && name.front() != '.' && name.find('/') == std::string::npos;
}

}  // namespace

marking::Judged returned(const Returned& of, const core::Progress& progress) {
    const fs::path work = core::wholePath(of.work);
    constexpr double kUnpacking = 0.05;
    sandbox::Bounds bounds = boundsOf(work);
    std::vector<fs::path> besides{work};
    std::optional<core::PrivateFolder> unpacked;
    if (cases::isPackageName(work) || core::isThere(work / cases::kAttemptFile)) {
        bounds.answerBytes = kMostCarriedBytes;
        const sandbox::Answer answer =
            asked("recordings", {{"of", work.string()}}, {}, bounds, core::part(progress, 0.0, kUnpacking), besides);
        const Said said(answer.text);
        unpacked.emplace();
        for (const Carried& one : carriedIn(said, answer)) {
            if (!isPlainName(one.name)) throw noAnswer();
            core::writeFile(unpacked->path() / one.name, one.bytes, {true, false});
        }
        besides.push_back(unpacked->path());
        if (const fs::path named = beside(work, said.text("case", 4096)); !named.empty()) besides.push_back(named);
    }
    bounds.answerBytes = 8u << 20;
    const sandbox::Answer answer = asked("returned",
                                         {{"of", work.string()},
                                          {"unpacked", unpacked ? unpacked->path().string() : std::string()},
                                          {"rubric", of.rubric},
                                          {"prove", of.prove},
                                          {"draws", of.draws}},
                                         {{}, of.exercise}, bounds, core::part(progress, kUnpacking, 1.0), besides);
    const Said said(answer.text);
    marking::Judged judged{assessment::parseResult(said.text("result", kMostResult), "what was found")};
    judged.result.proof = said.text("proof", kMostWords);
    if (answer.bytes.empty()) return judged;
    view::Image& picture = judged.picture;
    picture.width = marking::kPictureWidth, picture.height = marking::kPictureHeight;
    const std::size_t size = 4 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
    if (answer.bytes.size() != size) throw noAnswer();
    const auto* pixels = reinterpret_cast<const std::uint8_t*>(answer.bytes.data());
    picture.rgba.assign(pixels, pixels + size);
    return judged;
}

view::Image picture(const Files& files, int widthPx, int heightPx) {
    view::Image image;
    image.width = widthPx, image.height = heightPx;
    sandbox::Bounds bounds = kPage;
    const std::size_t size = 4 * static_cast<std::size_t>(widthPx) * static_cast<std::size_t>(heightPx);
    bounds.answerBytes = size;
    const sandbox::Answer answer = asked("picture", {{"width", widthPx}, {"height", heightPx}}, files, bounds);
    if (answer.bytes.size() != size) throw noAnswer();
    const auto* pixels = reinterpret_cast<const std::uint8_t*>(answer.bytes.data());
    image.rgba.assign(pixels, pixels + size);
    return image;
}

Exercise exercise(const fs::path& file) {
    return exerciseFrom(Said(asked("exercise", Json::object(), {{}, file}, kPage).text));
}

PackedExercise pack(const fs::path& file, std::size_t mostBytes) {
    sandbox::Bounds bounds = kPage;
    bounds.answerBytes = mostBytes;
    sandbox::Answer answer = asked("pack", Json::object(), {{}, file}, bounds);
    const Said said(answer.text);
    PackedExercise packed{exerciseFrom(said), std::move(answer.bytes)};
    if (packed.file.empty()) throw noAnswer();
    return packed;
}

std::string studentReport(const fs::path& exercise, const std::string& result, const std::string& rubric) {
    sandbox::Bounds bounds = kPage;
    bounds.answerBytes = 8u << 20;
    std::string page = asked("student report", {{"result", result}, {"rubric", rubric}}, {{}, exercise}, bounds).text;
    if (page.empty()) throw noAnswer();
    return page;
}

}  // namespace handpiece::sandboxed
