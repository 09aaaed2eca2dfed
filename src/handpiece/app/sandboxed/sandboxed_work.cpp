// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/sandboxed/sandboxed_work.h"

#include <fmt/format.h>

#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/marking/scoring.h"
#include "handpiece/app/proving/exam_check.h"
#include "handpiece/app/proving/likeness.h"
#include "handpiece/app/proving/proving.h"
#include "handpiece/app/report/assessment_report.h"
#include "handpiece/app/report/review.h"
#include "handpiece/app/sandboxed/sandboxed.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/case/case_bytes.h"
#include "handpiece/model/case/package_type.h"
#include "handpiece/record/session/session_reader.h"

namespace handpiece::sandboxed {
namespace {

using Json = nlohmann::json;
using sandbox::Answer;

std::vector<std::filesystem::path> sessionsOf(const Json& asked) {
    std::vector<std::filesystem::path> all;
    for (const std::string& one : asked.at("sessions").get<std::vector<std::string>>())
        all.emplace_back(one);
    return all;
}
std::string dumped(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// One byte more, and it is another file; not another work.
std::string contentOf(const std::filesystem::path& session) {
    try {
        proving::RecordedInputs inputs(session);
        inputs.goOn();
        return inputs.hasMoved() ? inputs.hash() : std::string();
    } catch (const core::Error&) {
        return {};  // the proof says why
    }
}

std::vector<std::string> sketchOf(const std::filesystem::path& session) {
    try {
        return proving::motionSketch(session);
    } catch (const core::Error&) {
        return {};
    }
}

Contents contentsIn(std::span<const std::filesystem::path> sessions) {
    Contents contents;
    for (const std::filesystem::path& one : sessions)
        contents.inputs.push_back(contentOf(one)), contents.sketches.push_back(sketchOf(one));
    return contents;
}
Answer contents(const Json& asked, const core::Progress& /*progress*/) {
    return {toJson(contentsIn(sessionsOf(asked)))};
}

std::vector<std::string> doubtsOf(const Json& exam, std::span<const std::filesystem::path> sessions) {
    try {
        std::vector<exam::Entry> entries;
        for (const std::string& text : exam.at("entries").get<std::vector<std::string>>())
            entries.push_back(exam::entryFrom(text, "the books"));
        return proving::recordingDoubts(exam.at("locked").get<std::vector<std::string>>(), entries, sessions);
    } catch (const core::Error& e) {
        return {"its recordings cannot be held against what was noted: " + e.problem()};
    }
}

/// What is wrong with the school's own is no fault of the work.
template <class Read>
auto schoolsOwn(Read read) {
    try {
        return read();
    } catch (const core::Error& e) {
        throw core::Error(e.problem(), e.where(), e.remedy()).as("sandbox-exercise", {e.problem()});
    }
}

Answer prove(const Json& asked, const core::Progress& progress) {
    const tasks::Task task = schoolsOwn([&] { return tasks::readTask(asked.at("exercise").get<std::string>()); });
    const rubric::Rubric rubric = schoolsOwn([&] {
        rubric::Rubric read = rubric::parseRubric(asked.at("rubric").get<std::string>(), "the rubric");
        rubric::requireSound(read);
        return read;
    });
    const std::vector<std::filesystem::path> sessions = sessionsOf(asked);
    Proof proof;
    proof.contents = contentsIn(sessions);
    school::PushedAttempt pushed;
    school::Attempt& a = pushed.attempt;
    const Json& of = asked.at("attempt");
    a.id = of.at("id"), a.exerciseHash = of.at("exercise_hash"), a.rubricHash = of.at("rubric_hash");
    a.sessionHashes = of.at("session_hashes").get<std::vector<std::string>>();
    a.device = of.at("device"), a.score = of.at("score"), a.maxScore = of.at("max_score"), a.passed = of.at("passed");
    proof.score = proving::prove(pushed, sessions, task, rubric, progress);
    if (asked.contains("exam")) proof.doubts = doubtsOf(asked.at("exam"), sessions);
    return {toJson(proof)};
}

Answer review(const Json& asked, const core::Progress& progress) {
    std::vector<report::Reviewed> chain;
    for (const std::filesystem::path& one : sessionsOf(asked))
        chain.push_back({one, fmt::format("session {}", chain.size() + 1), {}});
    const std::string exercise = asked.at("exercise"), result = asked.at("result"), text = asked.at("rubric");
    report::ReviewedAgainst against;
    std::optional<tasks::Task> task;
    std::optional<score::Result> scored;
    std::optional<rubric::Rubric> rubric;
    if (!exercise.empty() && !result.empty() && !text.empty()) {
        task = tasks::readTask(exercise);
        scored = assessment::parseResult(result, "the books");
        rubric = rubric::parseRubric(text, "the rubric");
        against = {&*task, &*scored, &*rubric};
    }
    const report::Review made = report::reviewOf(chain, asked.at("title"), against, true, asked.at("most"), progress);
    Answer answer{made.json, made.data};
    Json pictures = Json::array();
    for (const report::Review::Picture& one : made.pictures) {
        pictures.push_back({{"time_s", one.timeS}, {"bytes", one.png.size()}});
        answer.bytes.insert(answer.bytes.end(), one.png.begin(), one.png.end());
    }
    answer.text = dumped({{"review", made.json}, {"data", made.data.size()}, {"pictures", pictures}});
    return answer;
}

Answer readThrough(const Json& asked, const core::Progress& progress) {
    std::uint64_t ticks = 0, events = 0, keyFrames = 0;
    for (const std::filesystem::path& one : sessionsOf(asked)) {
        constexpr std::size_t kStretch = 10'000;
        const auto tell = [&](double begin, std::uint64_t done, std::uint64_t all) {
            core::report(progress, begin + 0.5 * static_cast<double>(done) / static_cast<double>(all));
        };
        const session::SessionReader reader(one);
        const std::string where = one.filename().string();
        (void)simulation::settingsFromJson(reader.info().settings, where);
        (void)cases::decodeCase(reader.info().tooth, where);
        if (!reader.info().scenery.empty()) (void)cases::decodeCase(reader.info().scenery, where);
        for (std::uint64_t at = 0; at < reader.size(); at += kStretch) {
            tell(0.0, at, reader.size());
            (void)reader.records(at, kStretch);
        }
        for (std::size_t i = 0; i < reader.keyFrameTicks().size(); ++i) {
            tell(0.5, i, reader.keyFrameTicks().size());
            (void)reader.keyFrame(i);
        }
        ticks += reader.size(), events += reader.events().size(), keyFrames += reader.keyFrameTicks().size();
    }
    return {dumped({{"ticks", ticks}, {"events", events}, {"key_frames", keyFrames}})};
}

/// Sessions that come along with something else, for who starts this: they are read as files, and none is written here.
class Carrying {
  public:
    void add(const std::string& name, std::span<const std::byte> bytes) {
        if (bytes.size() > kMostCarriedBytes - bytes_.size())
            throw core::Error(fmt::format("its recordings have more than {} MB", kMostCarriedBytes >> 20), name,
                              "leave some out")
                .as("too-large");
        list_.push_back({{"name", name}, {"bytes", bytes.size()}});
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    void addOf(const std::filesystem::path& file, const cases::Attempt& attempt) {
        for (const cases::Attempt::Recording& one : attempt.recordings)
            if (one.packed) add(one.name, cases::readRecording(file, one.name));
    }
    [[nodiscard]] Answer answer(Json with) {
        with["sessions"] = std::move(list_);
        return {dumped(with), std::move(bytes_)};
    }

  private:
    Json list_ = Json::array();
    std::vector<std::byte> bytes_;
};

/// One that was packed without its case names it: another file, which is read by itself.
bool holdsCase(const std::filesystem::path& file) {
    try {
        (void)cases::readCase(file);
        return true;
    } catch (const core::Error& e) {
        if (e.id() != "not-a-case") throw;
        return false;
    }
}

Answer package(const Json& asked, const core::Progress&) {
    const std::filesystem::path file = asked.at("exercise").get<std::string>();
    Carrying carrying;
    const cases::PackageType type = cases::packageType(file).value_or(cases::PackageType::toothCase);
    if (cases::isAttempt(file)) {
        const cases::Attempt attempt = cases::readAttempt(file);
        const bool isWhole = holdsCase(file);
        if (isWhole) (void)cases::openAttempt(file);
        if (isWhole && !attempt.exercise.empty()) (void)tasks::readTask(file);
        carrying.addOf(file, attempt);
    } else if (tasks::isTask(file)) {
        const tasks::Task task = tasks::readTask(file);
        if (task.teacherWork) carrying.add(tasks::kTeacherWorkFile, *task.teacherWork);
    } else {
        (void)cases::readCase(file);
    }
    return carrying.answer({{"type", cases::kPackageTypes[static_cast<std::size_t>(type)]}});
}

Answer recordings(const Json& asked, const core::Progress&) {
    const std::filesystem::path work = asked.at("of").get<std::string>();
    Carrying carrying;
    std::string named;
    if (cases::isAttempt(work)) {
        const cases::Attempt attempt = cases::readAttempt(work);
        carrying.addOf(work, attempt);
        if (!holdsCase(work)) named = attempt.caseFile.string();
    }
    return carrying.answer({{"case", named}});
}

Answer returned(const Json& asked, const core::Progress& progress) {
    const tasks::Task task = schoolsOwn([&] { return tasks::readTask(asked.at("exercise").get<std::string>()); });
    const rubric::Rubric rubric =
        schoolsOwn([&] { return rubric::parseRubric(asked.at("rubric").get<std::string>(), "the rubric"); });
    const marking::Judged judged =
        marking::judgeReturned(asked.at("of").get<std::string>(), task, rubric, asked.at("prove"), asked.at("draws"),
                               asked.at("unpacked").get<std::string>(), progress);
    const auto* pixels = reinterpret_cast<const std::byte*>(judged.picture.rgba.data());
    return {dumped({{"result", assessment::resultJson(judged.result.assessment, judged.result.identity)},
                    {"proof", judged.result.proof}}),
            {pixels, pixels + judged.picture.rgba.size()}};
}

Answer picture(const Json& asked, const core::Progress& progress) {
    const tasks::Task task = tasks::readTask(asked.at("exercise").get<std::string>());
    std::vector<assessment::ChainLink> chain;
    for (const std::filesystem::path& one : sessionsOf(asked))
        chain.push_back({fmt::format("{}.h5", chain.size() + 1), one});
    // Whether it is proven is asked elsewhere: what is seen here is what the last session left.
    const assessment::Work work = assessment::readChain(chain, task, false, progress);
    const view::Image image =
        marking::pictureOf(work, view::standingOf(task.toothCase.fdiNumber, task.toothCase.buccalSign),
                           asked.at("width"), asked.at("height"));
    const auto* pixels = reinterpret_cast<const std::byte*>(image.rgba.data());
    return {{}, {pixels, pixels + image.rgba.size()}};
}

Json factsOf(const tasks::Task& task) {
    const auto& texts = task.toothCase.exercise;
    return Json{{"id", task.id},
                {"version", task.version},
                {"hash", rubric::hashText(tasks::contentHash(task))},
                {"tooth", task.toothCase.name},
                {"level", task.level},
                {"minutes", task.minutes ? Json(*task.minutes) : Json()},
                {"voxel_mm", task.voxelMm},
                {"has_preparation", task.preparation.has_value()},
                {"rubric", task.rubric},
                {"locked_helps", texts ? texts->lockedHelps : std::vector<std::string>()},
                {"title", texts ? texts->title : cases::Texts()},
                {"instructions", texts ? texts->instructions : cases::Texts()}};
}

Answer exercise(const Json& asked, const core::Progress&) {
    return {dumped(factsOf(tasks::readTask(asked.at("exercise").get<std::string>())))};
}

Answer pack(const Json& asked, const core::Progress&) {
    const std::string file = asked.at("exercise");
    const tasks::Task task = tasks::readTask(file);
    if (task.rubric.empty())
        throw core::Error("this exercise has no rubric, so its work cannot be scored", file, "give it one")
            .as("exercise-unscored");
    return {dumped(factsOf(task)), tasks::packedTask(task)};
}

Answer studentReport(const Json& asked, const core::Progress&) {
    return {report::studentReport(assessment::parseResult(asked.at("result").get<std::string>(), "the books"),
                                  tasks::readTask(asked.at("exercise").get<std::string>()),
                                  rubric::parseRubric(asked.at("rubric").get<std::string>(), "the rubric"))};
}

}  // namespace

Answer answer(const std::string& request, const core::Progress& progress) {
    static const std::map<std::string, Answer (*)(const Json&, const core::Progress&)> works{
        {"prove", prove},
        {"contents", contents},
        {"review", review},
        {"picture", picture},
        {"session", readThrough},
        {"package", package},
        {"recordings", recordings},
        {"returned", returned},
        {"exercise", exercise},
        {"pack", pack},
        {"student report", studentReport}};
    const Json asked = config::requireOutsideJson<Json>(request, {.values = 10'000'000});
    const config::LanguageHere here(asked.at("language").get<std::string>());
    return works.at(asked.at("work"))(asked, progress);
}

}  // namespace handpiece::sandboxed
