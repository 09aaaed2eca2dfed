// SPDX-License-Identifier: Apache-2.0
// Exercises as files: round trips, what is refused, what a hash rests on.
#include "handpiece/assess/task/task.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "handpiece/model/case/attempt.h"
#include "handpiece/model/starter/block.h"
#include "support/error_of.h"

namespace handpiece::tasks::task_test {
namespace {

namespace fs = std::filesystem;

class TaskFile : public testing::Test {
  protected:
    fs::path folder_ = fs::temp_directory_path() / fmt::format("handpiece-task-{}", ::getpid());
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }

    static Task block() {
        Task task;
        task.id = "block-line-1";
        task.version = 3;
        task.toothCase = starter::makeBlock(starter::BlockLayers::layered);
        task.voxelMm = 0.04;
        task.minutes = 7.5;
        task.drive = "low-speed";
        task.speedRpm = 12000.5;
        task.preparation = preparation::Recipe{"block-line", "", {{"depth_mm", 1.25}}, {0.3, 0.2}, 0.0};
        task.rubric = "format = 1\n# kept as it stands\n";
        cases::Exercise exercise;
        exercise.title = {{"en", "A \"line\""}, {"ja", "線"}};
        exercise.instructions = {{"en", "1.25 mm deep."}};
        exercise.bur = "330";
        exercise.lockedHelps = {"undo"};
        task.toothCase.exercise = exercise;
        return task;
    }
    void change(const fs::path& task, const std::string& from, const std::string& to) const {
        std::ifstream in(task / kTaskFile);
        std::string text{std::istreambuf_iterator<char>(in), {}};
        const std::size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        text.replace(at, from.size(), to);
        std::ofstream(task / kTaskFile) << text;
    }
};

TEST_F(TaskFile, ComesBackFromFolderAndPackage) {
    const Task task = block();
    for (const char* name : {"task", "task.handpiece"}) {
        const fs::path path = folder_ / name;
        writeTask(task, path);
        writeTask(task, path);  // once more, over it
        ASSERT_TRUE(isTask(path));
        const Task back = readTask(path);
        EXPECT_EQ(back.id, task.id);
        EXPECT_EQ(back.version, 3);
        EXPECT_DOUBLE_EQ(back.voxelMm, 0.04);
        EXPECT_EQ(back.minutes, 7.5);
        EXPECT_EQ(back.drive, "low-speed");
        EXPECT_EQ(back.speedRpm, 12000.5);
        EXPECT_EQ(*back.preparation, *task.preparation);
        EXPECT_EQ(back.rubric, task.rubric);
        EXPECT_EQ(back.toothCase.exercise->title, task.toothCase.exercise->title);
        EXPECT_EQ(back.toothCase.exercise->lockedHelps, task.toothCase.exercise->lockedHelps);
        EXPECT_EQ(contentHash(back), contentHash(task));
        EXPECT_TRUE(problems(back).empty());
    }
}

TEST_F(TaskFile, TheTeachersOwnWorkComesAlongAndCountsForNothing) {
    Task task = block();
    const std::uint64_t hash = contentHash(task);
    std::vector<std::byte> session(100'000);
    for (std::size_t i = 0; i < session.size(); ++i)
        session[i] = static_cast<std::byte>(i * i % 251);
    task.teacherWork = std::make_shared<const std::vector<std::byte>>(session);
    EXPECT_EQ(contentHash(task), hash);
    EXPECT_EQ(taskToml(task).find("teacher"), std::string::npos) << "an attempt is without it";
    for (const char* name : {"task", "task.handpiece"}) {
        writeTask(task, folder_ / name);
        const Task back = readTask(folder_ / name);
        ASSERT_NE(back.teacherWork, nullptr) << name;
        EXPECT_EQ(*back.teacherWork, session);
        // On as it came.
        writeTask(back, folder_ / "again.handpiece");
        EXPECT_EQ(*readTask(folder_ / "again.handpiece").teacherWork, session);
    }
    EXPECT_EQ(readTask(folder_ / "task").id, task.id);
    change(folder_ / "task", "teacher.h5", "../teacher.h5");
    EXPECT_NE(test::errorOf([&] { (void)readTask(folder_ / "task"); }).find("teacher.h5"), std::string::npos);
    writeTask(task, folder_ / "task");
    fs::remove(folder_ / "task" / kTeacherWorkFile);
    EXPECT_NE(test::errorOf([&] { (void)readTask(folder_ / "task"); }).find("not there"), std::string::npos);
    std::ofstream(folder_ / "task" / kTeacherWorkFile) << "";
    fs::resize_file(folder_ / "task" / kTeacherWorkFile, kMaxTeacherWorkBytes + 1);
    EXPECT_NE(test::errorOf([&] { (void)readTask(folder_ / "task"); }), "") << "of any size it is not read";
    // Without the line a file of this name is nothing.
    task.teacherWork.reset();
    writeTask(task, folder_ / "task");
    EXPECT_EQ(readTask(folder_ / "task").teacherWork, nullptr);
}

TEST_F(TaskFile, EveryVoxelComesBackBitForBit) {
    // Of 20 to 400 um, 42 whole numbers came back as another number (1000 times .051 is not 51), and with another hash.
    Task task = block();
    for (const double voxelUm : {26.0, 51.0, 102.0, 351.0, 33.3, 50.1, 1000.0 / 7.0}) {
        task.voxelMm = 1e-3 * voxelUm;
        writeTask(task, folder_ / "task");
        const Task back = readTask(folder_ / "task");
        EXPECT_EQ(back.voxelMm, task.voxelMm) << voxelUm;
        EXPECT_EQ(contentHash(back), contentHash(task)) << voxelUm;
    }
}

TEST_F(TaskFile, RecordedWorkComesAlongAndIsHeldToItsHash) {
    Task task = block();
    // A dent in the block's top, as its three faces.
    const double top = task.toothCase.outer.bounds().max.z();
    preparation::RecordedWork work;
    work.surface.vertices = {{-1.0, -1.0, top}, {1.0, -1.0, top}, {0.0, 1.0, top}, {0.0, 0.0, top - 1.0}};
    work.surface.triangles = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    work.cutTriangles = 3;
    work.voxelMm = task.voxelMm;
    const auto record = [&] {
        task.preparation = preparation::Recipe{};
        task.preparation->preparation = preparation::kRecordedTemplate;
        task.preparation->recorded = std::make_shared<const preparation::RecordedWork>(work);
        task.preparation->recordedHash = work.hash();
    };
    record();
    const std::uint64_t hash = contentHash(task);
    EXPECT_TRUE(problems(task).empty());
    for (const char* name : {"recorded", "recorded.handpiece"}) {
        writeTask(task, folder_ / name);
        const Task back = readTask(folder_ / name);
        EXPECT_EQ(contentHash(back), hash);
        EXPECT_EQ(back.preparation->recorded->surface.vertices, work.surface.vertices);
        EXPECT_TRUE(problems(back).empty());
    }
    // Other work is another exercise.
    work.surface.vertices[3].z() -= 0.5;
    record();
    EXPECT_NE(contentHash(task), hash);
    writeTask(task, folder_ / "other");
    fs::copy_file(folder_ / "other" / kZonesFile, folder_ / "recorded" / kZonesFile,
                  fs::copy_options::overwrite_existing);
    EXPECT_NE(test::errorOf([&] { (void)readTask(folder_ / "recorded"); }).find("not those"), std::string::npos);
    std::ofstream(folder_ / "recorded" / kZonesFile) << "HPZONES";
    EXPECT_NE(test::errorOf([&] { (void)readTask(folder_ / "recorded"); }).find(kZonesFile), std::string::npos);
    fs::remove(folder_ / "recorded" / kZonesFile);
    EXPECT_NE(test::errorOf([&] { (void)readTask(folder_ / "recorded"); }).find("has no zones.bin"), std::string::npos);
}

TEST_F(TaskFile, HashRestsOnWhatIsAskedAndNotOnWords) {
    const Task task = block();
    Task words = task, deeper = task, finer = task, other = task;
    words.toothCase.exercise->title["en"] = "Another";
    words.rubric += "# more\n";
    EXPECT_EQ(contentHash(words), contentHash(task));
    deeper.preparation->numbers["depth_mm"] = 1.3;
    EXPECT_NE(contentHash(deeper), contentHash(task));
    finer.voxelMm = 0.05;
    EXPECT_NE(contentHash(finer), contentHash(task));
    other.toothCase = starter::makeBlock(starter::BlockLayers::hard);
    EXPECT_NE(contentHash(other), contentHash(task));
    // A usual number that is written down is the same number.
    Task spelt = task;
    spelt.preparation->numbers["width_mm"] = 1.2;
    EXPECT_EQ(contentHash(spelt), contentHash(task));
}

TEST_F(TaskFile, AnExerciseInACaseIsReadAndMovedOver) {
    cases::Case old = block().toothCase;
    const fs::path path = folder_ / "case";
    cases::writeCase(old, path);
    Task task = readTask(path);
    EXPECT_EQ(task.toothCase.exercise->bur, "330");
    EXPECT_FALSE(task.preparation);
    task.id = "old";
    writeTask(task, folder_ / "moved");
    EXPECT_EQ(readTask(folder_ / "moved").toothCase.exercise->bur, "330");
    EXPECT_FALSE(cases::readCase(folder_ / "moved" / "case").exercise) << "it stands in exercise.toml now";
}

TEST_F(TaskFile, AnAttemptCarriesItsExerciseWhereverItGoes) {
    Task task = block();
    task.isTimeHard = task.hasLiveBar = true;
    writeTask(task, folder_ / "task");
    task = readTask(folder_ / "task");  // as files keep it
    EXPECT_TRUE(task.isTimeHard);
    EXPECT_TRUE(task.hasLiveBar);
    cases::Attempt attempt;
    attempt.caseFile = folder_ / "task" / "case";
    attempt.caseKey = cases::contentKey(task.toothCase);
    attempt.voxelMm = task.voxelMm;
    attempt.exercise = taskToml(task);
    attempt.rubric = task.rubric;
    cases::writeAttempt(attempt, folder_ / "one.handpiece", &task.toothCase);
    cases::writeAttempt(attempt, folder_ / "folder");
    for (const char* name : {"one.handpiece", "folder"}) {
        EXPECT_FALSE(isTask(folder_ / name)) << "it is an attempt";
        const Task back = readTask(folder_ / name);
        EXPECT_EQ(contentHash(back), contentHash(task)) << name;
        EXPECT_EQ(back.rubric, task.rubric);
        EXPECT_EQ(taskToml(back), taskToml(task));
    }
    attempt.exercise = "format = 9";
    cases::writeAttempt(attempt, folder_ / "newer.handpiece", &task.toothCase);
    EXPECT_NE(test::errorOf([&] { (void)readTask(folder_ / "newer.handpiece"); }).find("newer program"),
              std::string::npos);
    attempt.exercise.clear();
    cases::writeAttempt(attempt, folder_ / "none.handpiece", &task.toothCase);
    EXPECT_NE(test::errorOf([&] { (void)readTask(folder_ / "none.handpiece"); }).find("no exercise"),
              std::string::npos);
}

TEST_F(TaskFile, BadOnesAreToldInOneLineEach) {
    const fs::path path = folder_ / "bad";
    const auto errorAfter = [&](const std::string& from, const std::string& to) {
        writeTask(block(), path);
        change(path, from, to);
        const std::string error = test::errorOf([&] { (void)readTask(path); });
        EXPECT_NE(error.find("exercise.toml"), std::string::npos) << error;
        return error;
    };
    EXPECT_NE(errorAfter("format = 1", "format = 9").find("newer"), std::string::npos);
    EXPECT_NE(errorAfter("block-line-1", "Block Line").find("no id"), std::string::npos);
    EXPECT_NE(errorAfter("version = 3", "version = 0").find("version"), std::string::npos);
    EXPECT_NE(errorAfter("voxel_um = 40", "voxel_um = 1").find("20 to 400"), std::string::npos);
    EXPECT_NE(errorAfter("minutes = 7.5", "minutes = -1").find("minutes"), std::string::npos);
    EXPECT_NE(errorAfter("minutes", "minuets").find("minuets"), std::string::npos);
    EXPECT_NE(errorAfter("low-speed", "slow").find("turbine, weak-turbine, low-speed"), std::string::npos);
    EXPECT_NE(errorAfter("12000.5", "40001").find("800 to 40000 rpm"), std::string::npos);
    EXPECT_NE(errorAfter("12000.5", "799").find("800 to 40000 rpm"), std::string::npos);
    EXPECT_NE(errorAfter("drive = \"low-speed\"\n", "").find("without a drive"), std::string::npos);
    EXPECT_NE(errorAfter("depth_mm = 1.25", "depth_mm = 99").find("depth_mm"), std::string::npos);
    EXPECT_NE(errorAfter("rubric.toml", "../rubric.toml").find("rubric"), std::string::npos);
    EXPECT_NE(errorAfter("\"undo\"", "\"undone\"").find("undone"), std::string::npos);
    EXPECT_NE(errorAfter("type = \"exercise\"", "type = \"attempt\"").find("no exercise"), std::string::npos);

    EXPECT_NE(test::errorOf([&] { (void)readTask(folder_ / "nowhere"); }).find("no such"), std::string::npos);
    writeTask(block(), path);
    fs::remove_all(path / "case");
    EXPECT_NE(test::errorOf([&] { (void)readTask(path); }), "");
    cases::writeCase(starter::makeBlock(starter::BlockLayers::hard), folder_ / "plain");
    EXPECT_NE(test::errorOf([&] { (void)readTask(folder_ / "plain"); }).find("no exercise"), std::string::npos);
    std::ofstream(folder_ / "x.handpiece") << "no zip";
    EXPECT_NE(test::errorOf([&] { (void)readTask(folder_ / "x.handpiece"); }), "");
}

TEST_F(TaskFile, ATargetBesideTheToothIsTold) {
    Task task = block();
    task.preparation = preparation::Recipe{"class-one", "", {}, {}, 0.0};
    ASSERT_EQ(problems(task).size(), 1u);
    EXPECT_NE(problems(task).front().find("landmark"), std::string::npos);
}

}  // namespace
}  // namespace handpiece::tasks::task_test
