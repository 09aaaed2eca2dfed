// SPDX-License-Identifier: Apache-2.0
// handpiece exercise: tasks as files. handpiece make block: tasks for the hand alone.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/inputs.h"
#include "handpiece/app/course/finished_work.h"
#include "handpiece/app/course/shipped_exercises.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/app/simulation/tissue_export.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/starter/block.h"
#include "handpiece/model/tooth/state_file.h"
#include "studies/exercise_trials.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct ExerciseOptions {
    std::string exercise, student, words;
    double expected = -1.0;  // not said
    std::string teacherWork;
    std::string path, out, caseFile, preparation, side, rubric, id, title, instructions, bur, fromWork, painted;
    std::vector<std::string> set;  // NAME=NUMBER
    bool noRubric = false;
    double voxelUm = 50.0, sideMm = 0.2, floorMm = 0.2, minutes = 0.0;
    std::string kind, layers = "hard";
    int level = 1;
    bool json = false;
    studies::TrialOptions trials;
    double trialVoxelUm = 100.0;
    std::size_t threads = 0;
};

std::string listed(const std::vector<std::string>& names) {
    return fmt::format("{}", fmt::join(names, ", "));
}
std::vector<std::string> preparationNames(bool ofBlocks) {
    std::vector<std::string> names;
    for (const preparation::Template& t : preparation::templates())
        if (t.isBlock == ofBlocks && !t.isOwn) names.emplace_back(ofBlocks ? t.id.substr(6) : t.id);
    return names;
}

std::string text(const std::string& file) {
    const std::vector<std::byte> bytes = core::readFile(file, config::Table::kMaxBytes);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// By name or as a file; without one that which is made for the preparation.
std::string rubricOf(const ExerciseOptions& o, const preparation::Recipe& recipe) {
    if (o.noRubric) return {};
    if (o.rubric.empty()) return rubric::shippedTextFor(recipe.kind(), recipe.side, preparation::notAsked(recipe));
    const std::vector<std::string> shipped = rubric::shippedRubrics();
    const bool isName = std::find(shipped.begin(), shipped.end(), o.rubric) != shipped.end();
    std::string given = isName ? std::string(rubric::shippedRubricText(o.rubric)) : text(o.rubric);
    rubric::requireSound(rubric::parseRubric(given, o.rubric));
    return given;
}

/// As [preparation] of a file would have it, so that it is checked by the same rules. `own`: lines of a target of
/// one's own.
preparation::Recipe recipeOf(const ExerciseOptions& o, std::string_view id, const std::string& own = {}) {
    std::string toml = fmt::format("[preparation]\ntemplate = \"{}\"\nleeway_side_mm = {}\nleeway_floor_mm = {}\n", id,
                                   o.sideMm, o.floorMm);
    toml += own;
    if (!o.side.empty()) toml += fmt::format("side = \"{}\"\n", o.side);
    for (const std::string& pair : o.set) {
        const std::size_t equals = pair.find('=');
        double value = 0.0;
        const char* end = pair.data() + pair.size();
        if (equals == std::string::npos ||
            std::from_chars(pair.data() + equals + 1, end, value) != std::from_chars_result{end, std::errc{}})
            throw core::Error(fmt::format("\"{}\" is no NAME=NUMBER", pair), "--set", "as in --set depth_mm=1.8");
        toml += fmt::format("\"{}\" = {}\n", pair.substr(0, equals), value);
    }
    return preparation::readRecipe(*config::Table::parse(toml, "the command line").table("preparation"));
}

/// What it is like to work on, for people who choose.
void describe(Json& json, const std::string& level, const std::optional<double>& minutes, const std::string& drive,
              const std::optional<cases::Exercise>& exercise) {
    json["level"] = level.empty() ? Json(nullptr) : Json(level);
    json["minutes"] = minutes ? Json(*minutes) : Json(nullptr);
    const cases::Exercise e = exercise.value_or(cases::Exercise{});
    json["title"] = exercise ? Json(e.title) : Json(nullptr);
    json["instructions"] = exercise ? Json(e.instructions) : Json(nullptr);
    json["bur"] = e.bur.empty() ? Json(nullptr) : Json(e.bur);
    json["allowed_burs"] = e.allowedBurs;
    json["drive"] = drive.empty() ? Json(nullptr) : Json(drive);
    json["locked_helps"] = e.lockedHelps;
}

Json toJson(const tasks::Task& task) {
    Json json{{"id", task.id},
              {"version", task.version},
              {"hash", fmt::format("{:016x}", tasks::contentHash(task))},
              {"case", task.toothCase.name},
              {"fdi", task.toothCase.fdiNumber},
              {"voxel_um", 1e3 * task.voxelMm},
              {"preparation", nullptr},
              {"rubric", !task.rubric.empty()}};
    if (task.preparation) json["preparation"] = task.preparation->preparation;
    json["speed_rpm"] = task.speedRpm ? Json(*task.speedRpm) : Json(nullptr);
    describe(json, task.level, task.minutes, task.drive, task.toothCase.exercise);
    return json;
}

Json toJson(const course::Shipped& shipped) {
    Json json{{"id", shipped.id},
              {"number", shipped.number == 0 ? Json(nullptr) : Json(shipped.number)},
              {"fdi", shipped.fdi == 0 ? Json(nullptr) : Json(shipped.fdi)},
              {"neighbours", shipped.hasNeighbours},
              {"preparation", shipped.preparation}};
    describe(json, shipped.level, shipped.minutes, shipped.drive, shipped.exercise);
    return json;
}

void print(const Json& json) {
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

/// One line of what it is, and what it asks under it.
void printRow(const std::string& name, const Json& one) {
    const auto text = [&one](const char* key) {
        return one[key].is_object() ? one[key].value("en", std::string()) : std::string();
    };
    std::vector<std::string> about{text("title")};
    if (about.front().empty()) about.front() = one["id"].get<std::string>();
    if (one["level"].is_string()) about.push_back(one["level"].get<std::string>());
    if (one["minutes"].is_number()) about.push_back(fmt::format("{:g} min", one["minutes"].get<double>()));
    if (one["bur"].is_string()) about.push_back(fmt::format("bur {}", one["bur"].get<std::string>()));
    if (one["drive"].is_string()) about.push_back(one["drive"].get<std::string>());
    for (const Json& help : one["locked_helps"])
        about.push_back(fmt::format("locked: {}", help.get<std::string>()));
    fmt::print("{}: {}\n", name, fmt::join(about, ", "));
    if (const std::string asks = text("instructions"); !asks.empty()) fmt::print("    {}\n", asks);
}

void listShipped(const ExerciseOptions& o) {
    Json all = Json::array();
    for (const course::Shipped& shipped : course::shippedExercises())
        all.push_back(toJson(shipped));
    if (o.json) return print(all);
    for (const Json& one : all)
        printRow(one["id"].get<std::string>(), one);
}

void list(const ExerciseOptions& o) {
    if (o.path.empty()) return listShipped(o);
    Json all = Json::array();
    for (const course::Found& found : course::exercisesIn(o.path)) {
        // One bad file hides no other; it is told in its place.
        Json one = found.task ? toJson(*found.task) : Json{{"error", found.error->what()}};
        one["file"] = found.path.filename().string();
        all.push_back(one);
    }
    if (o.json) return print(all);
    for (const Json& one : all)
        if (one.contains("error"))
            fmt::print("{}: {}\n", one["file"].get<std::string>(), one["error"].get<std::string>());
        else
            printRow(one["file"].get<std::string>(), one);
    if (all.empty()) fmt::print("{}: no exercises\n", o.path);
}

void write(const tasks::Task& task, const std::string& out) {
    const std::vector<std::string> wrong = tasks::problems(task);
    if (!wrong.empty()) throw core::Error(wrong.front(), out, "nothing was written");
    tasks::writeTask(task, out);
    fmt::print("{}: exercise {} version {}, {}, hash {:016x}\n", out, task.id, task.version, task.toothCase.name,
               tasks::contentHash(task));
}

/// What somebody cut as the target of others. The case and the voxel are the work's own.
preparation::Recipe recordedRecipe(const ExerciseOptions& o, tasks::Task& task) {
    const fs::path path(o.fromWork);
    std::error_code ec;
    if (path.extension() != ".h5" && !fs::exists(path, ec))
        throw core::Error("there is no such work", path.string(), "name a session (.h5) or an attempt");
    studies::ProgressBar bar("reading the work");
    const std::optional<simulation::CutTeeth> work = simulation::readCutTeeth(path, {}, true, bar.listener());
    bar.finish();
    if (!work)
        throw core::Error("this is neither a session nor an attempt", path.string(),
                          "name session.h5, an attempt's folder or a .handpiece file");
    if (!o.caseFile.empty() && cases::caseKey(cases::readCase(o.caseFile)) != cases::caseKey(work->toothCase))
        throw core::Error("this is work on another tooth than the case's", path.string(),
                          fmt::format("leave --case out: the work is of {}", work->toothCase.name));
    if (o.caseFile.empty()) task.toothCase = work->toothCase;
    task.voxelMm = work->teeth.front()->field.settings().voxelMm;
    tooth::ToothMirror cut(work->teeth.front());
    cut.apply(work->state);
    auto recorded =
        std::make_shared<const preparation::RecordedWork>(preparation::recordWork(cut, work->toothCase.buccalSign));
    preparation::Recipe recipe =
        recipeOf(o, preparation::kRecordedTemplate,
                 fmt::format("zones_hash = \"{:016x}\"\n{}", recorded->hash(),
                             o.preparation.empty() ? "" : fmt::format("like = \"{}\"\n", o.preparation)));
    recipe.recorded = std::move(recorded);
    return recipe;
}

preparation::Recipe paintedRecipe(const ExerciseOptions& o) {
    std::string toml = o.preparation.empty() ? "" : fmt::format("like = \"{}\"\n", o.preparation);
    const config::Table strokes = config::Table::read(o.painted);
    strokes.allowOnly({"stroke", "depth_mm"});
    if (const auto depth = strokes.number("depth_mm")) toml += fmt::format("depth_mm = {}\n", *depth);
    return recipeOf(o, preparation::kPaintedTemplate,
                    toml + preparation::strokesToml(preparation::readStrokes(strokes), "preparation"));
}

void makeNew(const ExerciseOptions& o) {
    tasks::Task task;
    task.id = o.id;
    if (o.fromWork.empty() && o.caseFile.empty())
        throw core::Error("no tooth is named", "--case", "name a case, or work with --from-work");
    if (o.preparation.empty() && o.fromWork.empty() && o.painted.empty())
        throw core::Error("nothing says what is to be cut", "--preparation",
                          "name a preparation, work with --from-work, or strokes with --painted");
    if (!o.fromWork.empty() && !o.painted.empty())
        throw core::Error("a target is recorded or painted, not both", "--painted", "leave one of them out");
    if (!o.caseFile.empty()) task.toothCase = cases::readCase(o.caseFile);
    task.voxelMm = 1e-3 * o.voxelUm;
    task.preparation = !o.fromWork.empty()  ? recordedRecipe(o, task)
                       : !o.painted.empty() ? paintedRecipe(o)
                                            : recipeOf(o, o.preparation);
    cases::Exercise exercise = task.toothCase.exercise.value_or(cases::Exercise{});
    if (!o.title.empty()) exercise.title["en"] = o.title;
    if (!o.instructions.empty()) exercise.instructions["en"] = o.instructions;
    if (!o.bur.empty()) exercise.bur = o.bur;
    task.toothCase.exercise = exercise;
    if (o.minutes > 0.0) task.minutes = o.minutes;
    task.rubric = rubricOf(o, *task.preparation);
    write(task, o.out);
}

void check(const ExerciseOptions& o) {
    const tasks::Task task = exerciseOf(o.path).task;
    const std::vector<std::string> wrong = tasks::problems(task);
    if (o.json) {
        Json json = toJson(task);
        json["problems"] = wrong;
        print(json);
    } else {
        for (const std::string& problem : wrong)
            fmt::print("{}\n", problem);
        if (wrong.empty()) fmt::print("{}: nothing is wrong\n", o.path);
    }
    if (!wrong.empty()) throw core::Error(fmt::format("{} found", wrong.size()), o.path, "mend them");
}

/// The tooth as it should be, as an attempt of the exercise's case.
void ideal(const ExerciseOptions& o) {
    const auto [path, task] = exerciseOf(o.path);
    if (!task.preparation)
        throw core::Error("this exercise asks for no preparation", o.path, "add [preparation] to exercise.toml");
    simulation::SimulationSettings settings;
    settings.field = simulation::fieldSettingsAt(task.voxelMm);
    studies::ProgressBar bar("making the tooth");
    const simulation::SimulationSetup station =
        simulation::makeSimulation(task.toothCase, settings, true, bar.listener());
    bar.finish();
    const preparation::Laid laid = preparation::layOn(task.toothCase, *task.preparation);
    const tooth::StateDelta state = zones::idealState(*laid.zones, station.tooth);
    cases::Attempt attempt;
    std::error_code ec;
    attempt.caseFile = fs::absolute(fs::is_directory(path, ec) ? path / "case" : path);
    attempt.caseKey = cases::contentKey(task.toothCase);
    attempt.caseName = task.toothCase.name;
    attempt.state = tooth::encodeState(state, station.identity());
    attempt.voxelMm = task.voxelMm;
    attempt.removedMm3 = state.removedMm3.own;
    attempt.bur =
        task.toothCase.exercise && !task.toothCase.exercise->bur.empty() ? task.toothCase.exercise->bur : "330";
    attempt.cuttingParameters = "carbide";
    attempt.drive = "turbine";
    cases::writeAttempt(attempt, o.out);
    fmt::print("{}: {:.2f} mm3 gone\n", o.out, tooth::sumOf(state.removedMm3.own));
}

/// As one file or folder, with the teacher's own work where it is named.
void pack(const ExerciseOptions& o) {
    tasks::Task task = exerciseOf(o.path).task;
    if (!o.teacherWork.empty()) {
        studies::ProgressBar bar("cutting it again");
        task.teacherWork = assessment::provenWork(o.teacherWork, task, bar.listener()).file;
        bar.finish();
    }
    write(task, o.out);
}

/// A finished piece of work as one file for a teacher.
void handIn(const ExerciseOptions& o) {
    const auto task = std::make_shared<const tasks::Task>(exerciseOf(o.exercise).task);
    studies::ProgressBar bar("cutting it again");
    const course::FinishedWork done = course::judged(o.path, task, bar.listener());
    bar.finish();
    const std::optional<double> expected = o.expected < 0.0 ? std::nullopt : std::optional(o.expected);
    course::handIn(done, {o.student, expected, o.words}, o.out);
    fmt::print("{}: exercise {}, hash {}, {} sessions, {}; {:.1f} of {:.1f} points here\n", o.out, task->id,
               done.result.identity.exerciseHash, done.work.recordings.size(),
               done.result.identity.proven ? "proven" : "not proven", done.result.assessment.score,
               done.result.assessment.maxScore);
}

void trials(const ExerciseOptions& o) {
    core::setThreadCount(o.threads);
    studies::TrialOptions options = o.trials;
    options.out = o.out;
    options.voxelMm = 1e-3 * o.trialVoxelUm;
    studies::ProgressBar bar("exercises");
    const std::vector<studies::ExerciseTrials> all = studies::tryExercises(options, bar.listener());
    bar.finish();
    const std::string json = studies::trialsJson(options, all), text = studies::trialsText(options, all);
    core::writeFile(options.out / "trials.json", json);
    core::writeFile(options.out / "trials.md", text);
    fmt::print("{}", o.json ? json : text);
}

void makeBlock(const ExerciseOptions& o) {
    tasks::Task task = course::blockTask(o.kind, o.level, o.layers);
    ExerciseOptions with = o;
    with.sideMm = task.preparation->leeway.sideMm;
    with.floorMm = task.preparation->leeway.floorMm;
    task.preparation = recipeOf(with, "block-" + o.kind);
    task.rubric = rubricOf(o, *task.preparation);
    write(task, o.out);
}

void addHandInCommand(Command& exercise, const std::shared_ptr<ExerciseOptions>& options) {
    ExerciseOptions& o = *options;
    Command hand = exercise.subcommand("hand-in", "Work on an exercise as one file for a teacher");
    hand.option("WORK", o.path, "a session (.h5), a folder with all sessions of it, or an attempt").required();
    hand.option("--exercise", o.exercise, "folder, .handpiece file, or id of one that comes along").required();
    hand.option("--student", o.student, "a code, never a name");
    hand.option("--expected", o.expected, "what the student expects [%]").check(range(0.0, 100.0));
    hand.option("--words", o.words, "and says of it");
    hand.option("--out", o.out, "file that ends in .handpiece").required();
    hand.footer(
        "Example:\n  handpiece exercise hand-in cut/session.h5 --exercise 46-class-i --student A7 --out a7.handpiece");
    hand.callback([options] { handIn(*options); });
}

}  // namespace

void addExerciseCommand(Command& app) {
    Command exercise = app.subcommand("exercise", "Exercises: a case, what is to be done with it, how it is judged");
    exercise.requireSubcommand();
    exercise.footer(
        "Examples:\n  handpiece exercise new --case molar --preparation class-one --id class-one-46 --out class-one\n"
        "  handpiece exercise check class-one\n  handpiece exercise pack class-one class-one.handpiece\n"
        "  handpiece exercise list\n  handpiece exercise pack 46-class-ii-mo class-two.handpiece");
    const auto options = std::make_shared<ExerciseOptions>();
    ExerciseOptions& o = *options;

    Command listing = exercise.subcommand("list", "The exercises that come along, or those of a folder");
    listing.option("FOLDER", o.path, "with folders and .handpiece files in it; none: those that come along");
    listing.flag("--json", o.json, "as JSON");
    listing.callback([options] { list(*options); });

    Command make = exercise.subcommand("new", "An exercise of a case and a preparation laid onto its tooth");
    make.option("--case", o.caseFile, "the case, with its landmarks; of work it is the work's own");
    make.option("--preparation", o.preparation,
                "one of: " + listed(preparationNames(false)) +
                    "; with --from-work or --painted: what it is like, which says how it is measured and judged")
        .check(oneOf(preparationNames(false)));
    make.option("--from-work", o.fromWork,
                "a session or an attempt: what was cut in it is the target, in the voxel it was cut in");
    make.option("--painted", o.painted, "a file of strokes: what they paint is the target");
    make.option("--side", o.side, "mesial or distal, where the preparation has a side");
    make.option("--set", o.set, "NAME=NUMBER: a size of the preparation, such as depth_mm=1.8; several times")
        .takeAll();
    make.option("--leeway-side", o.sideMm, "what may go beside the target [mm]").showDefault();
    make.option("--leeway-floor", o.floorMm, "what may go under it [mm]").showDefault();
    make.option("--rubric", o.rubric, "how it is judged: a name or a file; else as the preparation's own says");
    make.flag("--no-rubric", o.noRubric, "it is not judged");
    make.option("--id", o.id, "small letters, digits, '-'").required();
    make.option("--title", o.title, "in English");
    make.option("--instructions", o.instructions, "in English");
    make.option("--bur", o.bur, "to start with");
    make.option("--minutes", o.minutes, "that it may take").check(nonNegative());
    make.option("--voxel", o.voxelUm, "of the tooth [um]").check(range(20.0, 400.0)).showDefault();
    make.option("--out", o.out, "folder, or file that ends in .handpiece").required();
    make.callback([options] { makeNew(*options); });

    Command checking = exercise.subcommand("check", "What is wrong with an exercise; exit code 1 if anything is");
    checking.option("EXERCISE", o.path, "folder, .handpiece file, or id of one that comes along").required();
    checking.flag("--json", o.json, "as JSON");
    checking.callback([options] { check(*options); });

    Command asked = exercise.subcommand("ideal", "The tooth as the exercise asks for it, as an attempt to look at");
    asked.option("EXERCISE", o.path, "folder, .handpiece file, or id of one that comes along").required();
    asked.option("--out", o.out, "folder").required();
    asked.callback([options] { ideal(*options); });

    Command trying = exercise.subcommand(
        "trials", "The ten shipped exercises, done by scripted hands: well, with each critical error, and unsteadily");
    trying.option("--out", o.out, "folder for trials.json, trials.md and the teeth").required();
    trying.option("--only", o.trials.exercises, "numbers of exercises, 1 to 10").takeAll();
    trying.option("--trials", o.trials.trials, "of each of five steadinesses, on exercises 1, 2 and 4; 0: none")
        .check(range(0, 1000))
        .showDefault();
    trying.option("--seed", o.trials.seed, "of the hands' noise").showDefault();
    trying.option("--voxel", o.trialVoxelUm, "of the teeth [um]").check(range(20.0, 400.0)).showDefault();
    trying.option("--faces", o.trials.faces, "triangles of each tooth").showDefault();
    trying.flag("--arm", o.trials.atTheArm,
                "those done well by the loop at 1 kHz, recorded and proven, instead of sweeping alone");
    trying.option("--threads", o.threads, "threads for long work; 0: all cores").check(range(0, 64)).showDefault();
    trying.flag("--json", o.json, "as JSON");
    trying.callback([options] { trials(*options); });

    Command pack = exercise.subcommand("pack", "An exercise as one file, or back into a folder");
    pack.option("EXERCISE", o.path, "folder, .handpiece file, or id of one that comes along").required();
    pack.option("OUT", o.out, "file that ends in .handpiece, or folder").required();
    pack.option("--teacher-work", o.teacherWork,
                "a session (.h5) of your own work on this exercise, for students to look at beside theirs");
    pack.callback([options] { cli::pack(*options); });
    addHandInCommand(exercise, options);
}

void addMakeBlockCommand(Command& make) {
    Command block = make.subcommand("block", "An exercise for the hand alone: a figure in a block as hard as a tooth");
    const auto options = std::make_shared<ExerciseOptions>();
    ExerciseOptions& o = *options;
    block.option("--kind", o.kind, "one of: " + listed(preparationNames(true)))
        .required()
        .check(oneOf(preparationNames(true)));
    block.option("--level", o.level, "1 to 3: the higher, the less may go beside the figure")
        .check(range(1, 3))
        .showDefault();
    block.option("--layers", o.layers, "hard, layered (enamel on dentine) or carious")
        .check(oneOf({starter::kBlockLayers.begin(), starter::kBlockLayers.end()}))
        .showDefault();
    block.option("--set", o.set, "NAME=NUMBER: a size of the figure, such as depth_mm=2; several times").takeAll();
    block.option("--rubric", o.rubric, "how it is judged: a name or a file; else as the figure's own says");
    block.flag("--no-rubric", o.noRubric, "it is not judged");
    block.option("--out", o.out, "folder, or file that ends in .handpiece").required();
    block.footer("Example:\n  handpiece make block --kind cross --level 2 --out cross");
    block.callback([options] { makeBlock(*options); });
}

}  // namespace handpiece::cli
