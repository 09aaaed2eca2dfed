// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/attempt.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/hash_text.h"
#include "handpiece/model/case/case_files.h"
#include "handpiece/model/case/package_type.h"
#include "handpiece/model/case/toml_text.h"

namespace handpiece::cases {
namespace {

namespace fs = std::filesystem;
using config::Table;

constexpr std::int64_t kFormatVersion = 1;
constexpr std::uint64_t kMaxStateBytes = 2ull << 30;
constexpr double kMinVoxelMm = 0.005, kMaxVoxelMm = 1.0;  // as a session's
constexpr std::size_t kMaxRecordings = 1000, kMaxListBytes = 256 << 10, kLongestName = 120;
constexpr std::uint64_t kMaxResultBytes = 4 << 20;
constexpr const char* kRecordingsFolder = "recordings/";
constexpr const char* kRemedy = "see docs/case-format.md#attempts";

std::uint64_t hashOf(std::span<const std::byte> bytes) {
    core::Hasher hasher;
    if (!bytes.empty()) hasher.add(bytes);
    return hasher.value();
}

std::uint64_t hexOf(const Table& table, std::string_view key) {
    const std::optional<std::uint64_t> value = core::readHash(table.text(key).value_or(""));
    if (!value) table.fail(fmt::format("\"{}\" is not 16 hexadecimal digits", key), kRemedy, key);
    return *value;
}

double amountOf(const Table& table, std::string_view key, double otherwise) {
    const double value = table.number(key).value_or(otherwise);
    if (value < 0.0) table.fail(fmt::format("\"{}\" is {}", key, value), "it cannot be below zero", key);
    return value;
}

/// An attempt and the sum over its state, which is not part of it.
struct Parsed {
    Attempt attempt;
    std::uint64_t stateHash;
};

Parsed parse(std::string_view text, const std::string& where) {
    const Table root = Table::parse(text, where);
    const std::int64_t version = root.integer("format").value_or(0);
    if (version != kFormatVersion)
        root.fail(fmt::format("the attempt's format is {}, this program reads format {}", version, kFormatVersion),
                  version > kFormatVersion ? "use a newer Handpiece" : kRemedy, "format");
    root.allowOnly({"format", "case", "case_key", "case_name", "state_file_hash", "voxel_mm", "bur", "ability", "drive",
                    "elapsed_s", "student", "session", "undo_depth", "removed_mm3", "counters"});
    Parsed parsed;
    Attempt& a = parsed.attempt;
    const std::string caseFile = root.text("case").value_or("");
    if (caseFile.empty() || std::count(caseFile.begin(), caseFile.end(), '\0') > 0)
        root.fail("the attempt names no case", kRemedy);
    a.caseFile = caseFile;
    a.caseKey = hexOf(root, "case_key");
    parsed.stateHash = hexOf(root, "state_file_hash");
    a.caseName = root.text("case_name").value_or("");
    a.voxelMm = amountOf(root, "voxel_mm", a.voxelMm);
    if (!(a.voxelMm > 0.0)) root.fail("voxel_mm is 0", "it must be above zero", "voxel_mm");
    if (!(a.voxelMm >= kMinVoxelMm && a.voxelMm <= kMaxVoxelMm))
        root.fail(fmt::format("voxel_mm is {}", a.voxelMm), fmt::format("give {} to {}", kMinVoxelMm, kMaxVoxelMm),
                  "voxel_mm");
    a.bur = root.text("bur").value_or("");
    a.cuttingParameters = root.text("ability").value_or("");
    a.drive = root.text("drive").value_or("");
    a.elapsedS = amountOf(root, "elapsed_s", 0.0);
    a.student = root.text("student").value_or("");
    a.session = root.text("session").value_or("");
    if (a.session.find('/') != std::string::npos || a.session == "..")
        root.fail(fmt::format("the session \"{}\" is not a plain file name", a.session), kRemedy, "session");
    a.undoDepth = root.integer("undo_depth").value_or(0);
    if (a.undoDepth < 0)
        root.fail(fmt::format("undo_depth is {}", a.undoDepth), "it cannot be below zero", "undo_depth");
    if (const auto removed = root.table("removed_mm3"))
        for (const std::string& name : removed->keys()) {
            try {
                a.removedMm3[static_cast<std::size_t>(tissueByName(name))] = amountOf(*removed, name, 0.0);
            } catch (const core::Error& e) {
                if (e.where() == where) throw;
                removed->fail(e.problem(), e.remedy(), name);
            }
        }
    if (const auto counters = root.table("counters"))
        for (const std::string& name : counters->keys())
            a.counters[name] = *counters->integer(name);
    return parsed;
}

std::string toml(const Attempt& a, const std::string& caseFile) {
    std::string out = "# What has been cut of a case: docs/case-format.md#attempts.\n";
    out += fmt::format("format = {}\ncase = {}\ncase_key = \"{:016x}\"\ncase_name = {}\n", kFormatVersion,
                       tomlText(caseFile), a.caseKey, tomlText(a.caseName));
    out += fmt::format("state_file_hash = \"{:016x}\"\nvoxel_mm = {}\n", hashOf(a.state), tomlNumber(a.voxelMm));
    out += fmt::format("bur = {}\nability = {}\ndrive = {}\n", tomlText(a.bur), tomlText(a.cuttingParameters),
                       tomlText(a.drive));
    out += fmt::format("elapsed_s = {}\nstudent = {}\nsession = {}\nundo_depth = {}\n", tomlNumber(a.elapsedS),
                       tomlText(a.student), tomlText(a.session), a.undoDepth);
    out += "\n[removed_mm3]\n";
    for (std::size_t i = 1; i < kTissueCount; ++i)
        if (a.removedMm3[i] != 0.0)
            out += fmt::format("{} = {}\n", properties(static_cast<Tissue>(i)).name, tomlNumber(a.removedMm3[i]));
    out += "\n[counters]\n";
    for (const auto& [name, count] : a.counters)
        out += fmt::format("{} = {}\n", tomlText(name), count);
    return out;
}

bool isRecordingName(const std::string& name) {
    return name.size() > 3 && name.size() <= kLongestName && name.ends_with(".h5") && name.front() != '.' &&
           std::all_of(name.begin(), name.end(), [](unsigned char c) { return c > 0x1f && c != '/' && c != '\\'; });
}

std::string recordingsToml(const Attempt& a) {
    std::vector<std::string> names;
    for (const Attempt::Recording& recording : a.recordings)
        names.push_back(recording.name);
    return fmt::format(
        "# The recordings of this attempt: docs/case-format.md#recordings.\nformat = 1\nhanded_in = {}\n"
        "recordings = {}\n",
        a.handedIn, tomlList(names));
}

/// What an attempt without this file does not say.
void readRecordings(const CaseFiles& files, Attempt& a) {
    if (!files.has(kRecordingsFile)) return;
    const std::vector<std::byte> text = files.read(kRecordingsFile, kMaxListBytes);
    const Table root =
        Table::parse({reinterpret_cast<const char*>(text.data()), text.size()}, files.where(kRecordingsFile));
    const std::int64_t version = root.integer("format").value_or(0);
    if (version != 1)
        root.fail(fmt::format("the list's format is {}, this program reads format 1", version),
                  version > 1 ? "use a newer Handpiece" : kRemedy, "format");
    root.allowOnly({"format", "handed_in", "recordings"});
    a.handedIn = root.flag("handed_in").value_or(false);
    const std::vector<std::string> names = root.texts("recordings");
    if (names.size() > kMaxRecordings) root.fail("too many recordings", kRemedy, "recordings");
    for (const std::string& name : names) {
        if (!isRecordingName(name))
            root.fail(fmt::format("the recording \"{}\" is not a plain file name", name), kRemedy, "recordings");
        a.recordings.push_back({name, files.has(kRecordingsFolder + name)});
    }
}

std::string handInToml(const Attempt::HandIn& h) {
    std::string out = fmt::format(
        "# What was handed in: docs/case-format.md#hand-ins.\nformat = 1\nexercise = {}\nexercise_version = {}\n"
        "exercise_hash = {}\n",
        tomlText(h.exercise), h.version, tomlText(h.exerciseHash));
    if (h.expectedPercent) out += fmt::format("expected_percent = {}\n", tomlNumber(*h.expectedPercent));
    if (!h.expectedWords.empty()) out += fmt::format("expected_words = {}\n", tomlText(h.expectedWords));
    return out;
}

void readHandIn(const CaseFiles& files, Attempt& a) {
    if (!files.has(kHandInFile)) return;
    const Table root = Table::parse(tomlIn(files, kHandInFile), files.where(kHandInFile));
    const std::int64_t version = root.integer("format").value_or(0);
    if (version != 1)
        root.fail(fmt::format("the hand-in's format is {}, this program reads format 1", version),
                  version > 1 ? "use a newer Handpiece" : kRemedy, "format");
    root.allowOnly({"format", "exercise", "exercise_version", "exercise_hash", "expected_percent", "expected_words"});
    Attempt::HandIn h;
    h.exercise = root.text("exercise").value_or("");
    h.version = root.integer("exercise_version").value_or(1);
    h.exerciseHash = root.text("exercise_hash").value_or("");
    (void)hexOf(root, "exercise_hash");
    h.expectedPercent = root.number("expected_percent");
    if (h.expectedPercent && !(*h.expectedPercent >= 0.0 && *h.expectedPercent <= 100.0))
        root.fail(fmt::format("expected_percent is {}", *h.expectedPercent), "give 0 to 100", "expected_percent");
    h.expectedWords = root.text("expected_words").value_or("");
    if (files.has(kHandInResultFile)) {
        const std::vector<std::byte> json = files.read(kHandInResultFile, kMaxResultBytes);
        h.result.assign(reinterpret_cast<const char*>(json.data()), json.size());
    }
    a.handIn = std::move(h);
}

/// What an attempt of no exercise, or of before, does not have.
void readExercise(const CaseFiles& files, Attempt& a) {
    const auto text = [&](const char* name) {
        if (!files.has(name)) return std::string();
        const std::vector<std::byte> bytes = files.read(name, Table::kMaxBytes);
        return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    a.exercise = text(kExerciseInAttempt);
    a.rubric = text(kRubricInAttempt);
}

bool isNoRecording(const std::string& name) {
    return !name.starts_with(kRecordingsFolder);
}

std::vector<std::byte> bytesOf(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

/// The folder that the case's place is relative to.
fs::path baseOf(const fs::path& attempt) {
    const fs::path whole = core::wholePath(attempt).lexically_normal();
    const fs::path place = whole.has_filename() ? whole : whole.parent_path();
    return isPackageName(place) ? place.parent_path() : place;
}

Attempt readFrom(const CaseFiles& files, const fs::path& path) {
    if (!files.has(kAttemptFile))
        throw core::Error(fmt::format("this is no attempt: it has no {}", kAttemptFile), path.string(),
                          "name the folder or .handpiece file that was saved")
            .as("not-an-attempt");
    Parsed parsed = parse(tomlIn(files, kAttemptFile), files.where(kAttemptFile));
    Attempt& a = parsed.attempt;
    a.state = files.read(kAttemptStateFile, kMaxStateBytes);
    if (hashOf(a.state) != parsed.stateHash)
        throw core::Error("this is not the state that the attempt was saved with, or it is damaged",
                          files.where(kAttemptStateFile), "save the attempt again, or copy both its files")
            .as("attempt-damaged");
    if (a.caseFile.is_absolute())
        throw core::Error(fmt::format("the case \"{}\" is not told from where the attempt lies", a.caseFile.string()),
                          files.where(kAttemptFile), kRemedy)
            .as("attempt-damaged");
    a.caseFile = (baseOf(path) / a.caseFile).lexically_normal();
    readRecordings(files, a);
    readHandIn(files, a);
    readExercise(files, a);
    return std::move(parsed.attempt);
}

}  // namespace

std::string attemptToml(const Attempt& attempt) {
    return toml(attempt, attempt.caseFile.generic_string());
}

Attempt parseAttempt(std::string_view text, const std::string& where) {
    return parse(text, where).attempt;
}

namespace {
bool isAttemptType(std::optional<PackageType> type) {
    return type == PackageType::attempt || type == PackageType::handIn;
}
}  // namespace

bool isAttempt(const fs::path& path) {
    std::error_code ec;
    if (fs::is_directory(path, ec)) return fs::exists(path / kAttemptFile, ec);
    return isPackageName(path) && fs::exists(path, ec) && isAttemptType(packageType(path));
}

void writeAttempt(const Attempt& attempt, const fs::path& path, const Case* toothCase, PackageFiles recordings) {
    if (path.empty()) throw core::Error("an attempt needs a place", "output", "name a folder or a .handpiece file");
    if (attempt.caseFile.empty()) throw core::Error("the attempt has no case", path.string());
    double least = std::min(attempt.elapsedS, attempt.voxelMm);
    for (const double volume : attempt.removedMm3)
        least = std::isfinite(volume) ? std::min(least, volume) : -1.0;
    if (!(least >= 0.0 && std::isfinite(attempt.elapsedS + attempt.voxelMm) && attempt.voxelMm > 0.0))
        throw core::Error("a time, a voxel or a volume of the attempt is negative or not finite", path.string());
    const bool packed = isPackageName(path);
    if (toothCase && !packed)
        throw core::Error("an attempt takes its case along only as one file", path.string(), "name it .handpiece");
    if (toothCase && contentKey(*toothCase) != attempt.caseKey)
        throw core::Error("this is not the case that the attempt was cut from", toothCase->name);
    std::error_code ec;
    const fs::path target = core::wholePath(attempt.caseFile).lexically_normal();
    fs::path relative = fs::relative(target, baseOf(path), ec);
    if (ec || relative.empty()) relative = target.lexically_relative(baseOf(path));
    // What is passed on with all that it needs says nothing of the machine it comes from: its case is in itself.
    if (toothCase) relative = path.filename();
    PackageFiles files;
    files[kAttemptFile] = bytesOf(toml(attempt, relative.generic_string()));
    files[kAttemptStateFile] = attempt.state;
    if (toothCase)
        for (auto& [name, data] : caseFiles(*toothCase))
            files[kCaseInAttempt + name] = std::move(data);
    std::uint64_t recorded = 0;
    for (auto& [name, data] : recordings) {
        const bool known = std::any_of(attempt.recordings.begin(), attempt.recordings.end(),
                                       [&n = name](const Attempt::Recording& r) { return r.name == n; });
        if (!known || !isRecordingName(name))
            throw core::Error(fmt::format("\"{}\" is no recording of this attempt", name), path.string());
        recorded += data.size();
        if (recorded > kMaxRecordingBytes)
            throw core::Error(fmt::format("the recordings have more than {} MB", kMaxRecordingBytes >> 20),
                              path.string(), "leave some out");
        files[kRecordingsFolder + name] = std::move(data);
    }
    // Programs before it passed such a file over.
    if (attempt.handedIn || !attempt.recordings.empty()) files[kRecordingsFile] = bytesOf(recordingsToml(attempt));
    if (!attempt.exercise.empty()) files[kExerciseInAttempt] = bytesOf(attempt.exercise);
    if (!attempt.rubric.empty()) files[kRubricInAttempt] = bytesOf(attempt.rubric);
    if (attempt.handIn) {
        files[kHandInFile] = bytesOf(handInToml(*attempt.handIn));
        if (!attempt.handIn->result.empty()) files[kHandInResultFile] = bytesOf(attempt.handIn->result);
    }
    if (packed) {
        setPackageType(files, attempt.handedIn ? PackageType::handIn : PackageType::attempt);
        writePackage(path, files);
    } else
        writeFolder(path, files, kAttemptFile);
}

Attempt readAttempt(const fs::path& path) {
    if (!isPackageName(path)) return readFrom(filesInFolder(path), path);
    const PackageFiles content = readPackage(path, isNoRecording);
    requireOpenable(content, path.string());
    return readFrom(filesInPackage(path, content), path);
}

std::vector<std::byte> readRecording(const fs::path& attempt, const std::string& name) {
    const std::string wanted = kRecordingsFolder + name;
    if (!isRecordingName(name)) throw core::Error(fmt::format("\"{}\" is no recording", name), attempt.string());
    if (!isPackageName(attempt)) return filesInFolder(attempt).read(wanted, kMaxRecordingBytes);
    PackageFiles content = readPackage(attempt, [&wanted](const std::string& n) { return n == wanted; });
    const auto found = content.find(wanted);
    if (found == content.end())
        throw core::Error(fmt::format("there is no recording \"{}\" in it", name), attempt.string())
            .as("file-not-found");
    return std::move(found->second);
}

OpenAttempt openAttempt(const fs::path& path) {
    std::optional<PackageFiles> content;
    if (isPackageName(path)) {
        content = readPackage(path, isNoRecording);
        requireOpenable(*content, path.string());
    }
    Attempt attempt = readFrom(content ? filesInPackage(path, *content) : filesInFolder(path), path);
    const bool holdsCase = content && content->count(std::string(kCaseInAttempt) + kCaseFile) > 0;
    if (holdsCase) attempt.caseFile = core::wholePath(path).lexically_normal();
    if (!holdsCase && !core::isThere(attempt.caseFile))
        throw core::Error(fmt::format("the case that was cut is no longer at {}", attempt.caseFile.string()),
                          path.string(), fmt::format("put \"{}\" back there", attempt.caseName))
            .as("case-moved", {attempt.caseFile.string()});
    Case toothCase =
        holdsCase ? readCaseFiles(filesInPackage(path, *content, kCaseInAttempt)) : readCase(attempt.caseFile);
    if (contentKey(toothCase) != attempt.caseKey)
        throw core::Error(fmt::format("the case at {} has changed since: it is another tooth now",
                                      holdsCase ? path.string() : attempt.caseFile.string()),
                          path.string(), fmt::format("put the old \"{}\" back, or start anew", attempt.caseName))
            .as("case-changed", {holdsCase ? path.string() : attempt.caseFile.string()});
    return {std::move(attempt), std::move(toothCase)};
}

}  // namespace handpiece::cases
