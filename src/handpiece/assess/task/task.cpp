// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/task/target.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/case/exercise_table.h"
#include "handpiece/model/case/package_type.h"
#include "handpiece/model/instrument/rotor.h"

namespace handpiece::tasks {
namespace {

namespace fs = std::filesystem;
using config::Table;

constexpr std::int64_t kFormatVersion = 1;
constexpr const char* kCasePrefix = "case/";
constexpr std::uint64_t kMostZonesBytes = 256ull << 20;
constexpr double kLeastVoxelUm = 20.0, kMostVoxelUm = 400.0;

bool isId(std::string_view id) {
    return !id.empty() && id.size() <= 64 && std::all_of(id.begin(), id.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
    });
}

std::string textOf(const std::vector<std::byte>& bytes, const std::string& where) {
    if (bytes.size() > Table::kMaxBytes)
        throw core::Error("this text is too long", where, "an exercise's texts have at most 1 MB");
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::byte> bytesOf(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

void readDrive(const Table& root, Task& task) {
    task.drive = root.text("drive").value_or("");
    task.speedRpm = root.number("speed_rpm");
    const std::vector<instrument::Drive>& drives = instrument::drives();
    const auto drive =
        std::find_if(drives.begin(), drives.end(), [&](const instrument::Drive& d) { return d.name == task.drive; });
    if (!task.drive.empty() && drive == drives.end()) {
        std::vector<std::string> names;
        for (const instrument::Drive& d : drives)
            names.push_back(d.name);
        root.fail(fmt::format("there is no drive \"{}\"", task.drive.substr(0, 64)),
                  fmt::format("one of {}", fmt::join(names, ", ")), "drive");
    }
    if (!task.speedRpm) return;
    if (task.drive.empty()) root.fail("a speed without a drive", "give drive, or leave speed_rpm out", "speed_rpm");
    const double least = kLeastSpeedShare * drive->freeSpeedRpm;
    if (!(*task.speedRpm >= least && *task.speedRpm <= drive->freeSpeedRpm))
        root.fail(fmt::format("{} rpm", *task.speedRpm),
                  fmt::format("{} turns at {:g} to {:g} rpm", task.drive, least, drive->freeSpeedRpm), "speed_rpm");
}

/// What exercise.toml says, but for case and rubric.
Task parse(std::string_view text, const std::string& where) {
    const Table root = Table::parse(text, where);
    root.allowOnly({"format", "type", "id", "version", "voxel_um", "minutes", "minutes_hard", "live_bar",
                    "own_judgement", "level", "drive", "speed_rpm", "rubric", "teacher_work", "exercise",
                    "preparation"});
    const std::int64_t format = root.integer("format").value_or(0);
    if (format != kFormatVersion)
        root.fail(fmt::format("this exercise is of format {}", format),
                  format > kFormatVersion ? "it needs a newer program" : "format = 1", "format");
    if (root.text("type").value_or("exercise") != "exercise")
        root.fail("this is no exercise", "type = \"exercise\"", "type");
    Task task;
    task.id = root.text("id").value_or("");
    if (!isId(task.id))
        root.fail(fmt::format("\"{}\" is no id", task.id), "1 to 64 small letters, digits and '-'", "id");
    task.version = root.integer("version").value_or(1);
    if (task.version < 1) root.fail("a version is 1 or more", {}, "version");
    const double voxelUm = root.number("voxel_um").value_or(50.0);
    if (!(voxelUm >= kLeastVoxelUm && voxelUm <= kMostVoxelUm))
        root.fail(fmt::format("a voxel of {} um", voxelUm),
                  fmt::format("give {} to {} um", kLeastVoxelUm, kMostVoxelUm), "voxel_um");
    task.voxelMm = 1e-3 * voxelUm;
    task.minutes = root.number("minutes");
    if (task.minutes && !(*task.minutes > 0.0 && *task.minutes <= 24 * 60))
        root.fail(fmt::format("{} minutes", *task.minutes), "give more than 0, a day at most", "minutes");
    task.isTimeHard = root.flag("minutes_hard").value_or(false);
    if (task.isTimeHard && !task.minutes)
        root.fail("a hard limit without minutes", "give minutes, or leave minutes_hard out", "minutes_hard");
    task.hasLiveBar = root.flag("live_bar").value_or(false);
    task.ownJudgement = root.flag("own_judgement").value_or(false);
    task.level = root.text("level").value_or("");
    if (!task.level.empty() && std::find(kLevels.begin(), kLevels.end(), task.level) == kLevels.end())
        root.fail(fmt::format("\"{}\" is no level", task.level), fmt::format("one of {}", fmt::join(kLevels, ", ")),
                  "level");
    readDrive(root, task);
    if (const auto rubric = root.text("rubric"); rubric && *rubric != kRubricFile)
        root.fail(fmt::format("the rubric is \"{}\"", *rubric), fmt::format("call the file {}", kRubricFile), "rubric");
    if (const auto work = root.text("teacher_work")) {
        if (*work != kTeacherWorkFile)
            root.fail(fmt::format("the teacher's work is \"{}\"", *work),
                      fmt::format("call the file {}", kTeacherWorkFile), "teacher_work");
        task.teacherWork = std::make_shared<const std::vector<std::byte>>();  // it is beside this text
    }
    if (const auto exercise = root.table("exercise")) task.toothCase.exercise = cases::readExercise(*exercise);
    if (const auto recipe = root.table("preparation")) task.preparation = preparation::readRecipe(*recipe);
    return task;
}

/// The shortest number of micrometres that is read as this voxel again, bit for bit: 51 um are no 1000 times .051.
std::string micrometres(double voxelMm) {
    const double near = 1e3 * voxelMm;
    std::string text;
    for (int digits = 3; digits <= 17; ++digits)
        // A thousand times it may lie a bit beside the number that it was read from.
        for (const double um : {near, std::nextafter(near, 0.0), std::nextafter(near, 1e9)}) {
            text = fmt::format("{:.{}g}", um, digits);
            double read = 0.0;
            std::from_chars(text.data(), text.data() + text.size(), read);
            if (1e-3 * read == voxelMm) return text;
        }
    return text;
}

/// Whole: with what lies beside exercise.toml.
std::string tomlOf(const Task& task, bool isWhole) {
    std::string out = fmt::format("format = {}\ntype = \"exercise\"\nid = \"{}\"\nversion = {}\nvoxel_um = {}\n",
                                  kFormatVersion, task.id, task.version, micrometres(task.voxelMm));
    if (task.minutes) out += fmt::format("minutes = {}\n", *task.minutes);
    if (task.isTimeHard) out += "minutes_hard = true\n";
    if (task.hasLiveBar) out += "live_bar = true\n";
    if (!task.level.empty()) out += fmt::format("level = \"{}\"\n", task.level);
    if (task.ownJudgement) out += "own_judgement = true\n";
    if (!task.drive.empty()) out += fmt::format("drive = \"{}\"\n", task.drive);
    if (task.speedRpm) out += fmt::format("speed_rpm = {}\n", *task.speedRpm);
    if (!task.rubric.empty()) out += fmt::format("rubric = \"{}\"\n", kRubricFile);
    if (isWhole && task.teacherWork) out += fmt::format("teacher_work = \"{}\"\n", kTeacherWorkFile);
    if (task.preparation) out += "\n" + preparation::recipeToml(*task.preparation);
    if (task.toothCase.exercise) out += "\n" + cases::exerciseText(*task.toothCase.exercise);
    return out;
}

/// Of a case's own `[exercise]`.
Task ofCase(const fs::path& path) {
    Task task;
    task.toothCase = cases::readCase(path);
    if (!task.toothCase.exercise)
        throw core::Error("this is no exercise", path.string(),
                          fmt::format("name a folder or a .handpiece file with {}", kTaskFile));
    task.id = "case";
    return task;
}

Task ofAttempt(const fs::path& path) {
    cases::OpenAttempt open = cases::openAttempt(path);
    if (open.attempt.exercise.empty())
        throw core::Error("this attempt is of no exercise", path.string(), "name the exercise's folder or file");
    return parseTask(open.attempt.exercise, open.attempt.rubric, std::move(open.toothCase),
                     path.string() + ": " + cases::kExerciseInAttempt);
}

}  // namespace

std::string taskToml(const Task& task) {
    return tomlOf(task, false);
}

Task parseTask(std::string_view toml, std::string rubric, cases::Case toothCase, const std::string& where) {
    Task task = parse(toml, where);
    task.teacherWork.reset();
    auto exercise = std::move(task.toothCase.exercise);
    task.toothCase = std::move(toothCase);
    if (exercise) task.toothCase.exercise = std::move(exercise);
    task.rubric = std::move(rubric);
    return task;
}

bool isTask(const fs::path& path) {
    std::error_code ec;
    if (fs::is_directory(path, ec)) return fs::exists(path / kTaskFile, ec);
    if (!cases::isPackageName(path) || !fs::exists(path, ec)) return false;
    return cases::packageType(path) == cases::PackageType::exercise;
}

Task readTask(const fs::path& path) {
    std::error_code ec;
    if (!fs::exists(path, ec))
        throw core::Error("there is no such exercise", path.string(), "name a folder or a .handpiece file");
    if (cases::isAttempt(path)) return ofAttempt(path);
    if (!isTask(path)) return ofCase(path);
    const bool isFolder = fs::is_directory(path, ec);
    cases::PackageFiles content;
    if (isFolder) {
        content[kTaskFile] = core::readFile(path / kTaskFile, Table::kMaxBytes);
        if (fs::exists(path / kRubricFile, ec))
            content[kRubricFile] = core::readFile(path / kRubricFile, Table::kMaxBytes);
        if (fs::exists(path / kZonesFile, ec)) content[kZonesFile] = core::readFile(path / kZonesFile, kMostZonesBytes);
    } else {
        content = cases::readPackage(path, [](const std::string& name) {
            return name == kTaskFile || name == kRubricFile || name == kTeacherWorkFile || name == kZonesFile;
        });
    }
    const auto where = [&](const char* name) {
        return isFolder ? (path / name).string() : fmt::format("{} in {}", name, path.string());
    };
    Task task = parse(textOf(content.at(kTaskFile), where(kTaskFile)), where(kTaskFile));
    if (const auto rubric = content.find(kRubricFile); rubric != content.end())
        task.rubric = textOf(rubric->second, where(kRubricFile));
    if (task.teacherWork) {
        if (isFolder && fs::exists(path / kTeacherWorkFile, ec))
            content[kTeacherWorkFile] = core::readFile(path / kTeacherWorkFile, kMaxTeacherWorkBytes);
        const auto work = content.find(kTeacherWorkFile);
        if (work == content.end())
            throw core::Error("the teacher's work is not there", where(kTeacherWorkFile),
                              "put it there, or leave teacher_work out");
        if (work->second.size() > kMaxTeacherWorkBytes)
            throw core::Error("the teacher's work is larger than 64 MiB", where(kTeacherWorkFile),
                              "record a shorter one");
        task.teacherWork = std::make_shared<const std::vector<std::byte>>(std::move(work->second));
    }
    if (task.preparation && task.preparation->preparation == preparation::kRecordedTemplate) {
        const auto zones = content.find(kZonesFile);
        if (zones == content.end())
            throw core::Error(fmt::format("the exercise has no {}", kZonesFile), path.string(),
                              "its target was recorded: copy all of the exercise");
        task.preparation->recorded = std::make_shared<const preparation::RecordedWork>(
            preparation::decodeZones(zones->second, where(kZonesFile)));
        if (task.preparation->recorded->hash() != task.preparation->recordedHash)
            throw core::Error("these zones are not those that the exercise names", where(kZonesFile),
                              "copy all of the exercise, or make it anew");
    }
    auto exercise = std::move(task.toothCase.exercise);
    task.toothCase = cases::readCase(isFolder ? path / "case" : path);
    if (exercise) task.toothCase.exercise = std::move(exercise);
    return task;
}

namespace {
cases::PackageFiles filesOf(const Task& task) {
    if (!isId(task.id))
        throw core::Error(fmt::format("\"{}\" is no id", task.id), "the exercise",
                          "1 to 64 small letters, digits and '-'");
    cases::PackageFiles files;
    cases::Case plain = task.toothCase;
    plain.exercise.reset();
    for (auto& [name, data] : cases::caseFiles(plain))
        files[kCasePrefix + name] = std::move(data);
    files[kTaskFile] = bytesOf(tomlOf(task, true));
    if (task.teacherWork) files[kTeacherWorkFile] = *task.teacherWork;
    if (!task.rubric.empty()) files[kRubricFile] = bytesOf(task.rubric);
    if (task.preparation && task.preparation->recorded)
        files[kZonesFile] = preparation::encodeZones(*task.preparation->recorded);
    return files;
}
}  // namespace

std::vector<std::byte> packedTask(const Task& task) {
    cases::PackageFiles files = filesOf(task);
    cases::setPackageType(files, cases::PackageType::exercise);
    return cases::packed(files);
}

void writeTask(const Task& task, const fs::path& path) {
    if (cases::isPackageName(path))
        core::writeFile(path, packedTask(task));
    else
        cases::writeFolder(path, filesOf(task), kTaskFile);
}

std::uint64_t contentHash(const Task& task) {
    core::Hasher hasher;
    hasher.add(std::string_view("handpiece exercise"));
    hasher.add(cases::caseKey(task.toothCase));
    hasher.add(task.voxelMm);
    if (task.preparation) {
        // As written, with every number that is as usual: a template whose usual numbers change is another task.
        preparation::Recipe full = *task.preparation;
        for (const preparation::Parameter& p : preparation::findTemplate(full.preparation)->parameters)
            full.numbers.emplace(p.name, full.number(p.name));
        hasher.add(std::string_view(preparation::recipeToml(full)));
        // Where it lies comes from the landmarks.
        for (const cases::Landmark& mark : task.toothCase.landmarks) {
            hasher.add(mark.kind);
            hasher.add(std::string_view(mark.name));
            for (const core::Vec3& p : mark.pointsMm)
                for (int k = 0; k < 3; ++k)
                    hasher.add(static_cast<std::int64_t>(std::llround(1e5 * p[k])));  // as files keep them
        }
    }
    return hasher.value();
}

void requireTarget(const Task& task) {
    if (!task.preparation) return;
    const preparation::Laid laid = preparation::layOn(task.toothCase, *task.preparation);
    // Is there tooth in the target at all?
    const core::Box& box = laid.zones->box();
    constexpr int kSteps = 40;
    for (int z = 0; z < kSteps; ++z)
        for (int y = 0; y < kSteps; ++y)
            for (int x = 0; x < kSteps; ++x) {
                const core::Vec3 p =
                    box.min + box.size().cwiseProduct((core::Vec3(x, y, z).array() + 0.5).matrix()) / kSteps;
                if (laid.zones->at(p) == zones::Zone::target && laid.whole->signedDistance(p) < 0.0) return;
            }
    throw core::Error("the target holds nothing of the tooth", {}, "give other numbers or landmarks")
        .as("target-empty");
}

std::vector<std::string> problems(const Task& task) {
    try {
        requireTarget(task);
    } catch (const core::Error& error) {
        return {error.what()};
    }
    return {};
}

}  // namespace handpiece::tasks
