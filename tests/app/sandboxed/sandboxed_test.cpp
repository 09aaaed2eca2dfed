// SPDX-License-Identifier: Apache-2.0
// What a school's server makes of strangers' files when it reads them apart: of honest ones the same as before, of
// others a refusal with its reason. HANDPIECE_CAMPAIGN=100000: so many mutated sessions.
#include "handpiece/app/sandboxed/sandboxed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <thread>

#include "app/simulation/live_session_fixture.h"
#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/proving/exam_check.h"
#include "handpiece/app/proving/proving.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/prepared/prepared_files.h"
#include "handpiece/base/sandbox/sandbox.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/record/session/session_reader.h"
#include "handpiece/record/session/session_writer.h"
#include "support/error_of.h"

namespace handpiece::sandboxed::sandboxed_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kRubric = R"(format = 1
id = "block"
version = "1"
title = { en = "Block" }
status = "proposal"
source = "a test"
[[criterion]]
id = "removed"
measure = "removed"
unit = "mm3"
weight = 1
knots = [[0, 0], [0.5, 100], [9, 100]]
title = { en = "removed" }
source = "a test"
)";

std::string bytesOf(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}
void write(const fs::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}

/// HDF5's checksum of what it says about a file: Bob Jenkins' lookup3.
std::uint32_t checksum(const unsigned char* k, std::size_t length) {
    const auto turned = [](std::uint32_t x, int n) { return (x << n) | (x >> (32 - n)); };
    std::uint32_t a = 0xdeadbeefu + static_cast<std::uint32_t>(length), b = a, c = a;
    const auto word = [&](std::size_t at, std::size_t most) {
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < std::min<std::size_t>(4, most); ++i)
            value |= std::uint32_t{k[at + i]} << (8 * i);
        return value;
    };
    while (length > 12) {
        a += word(0, 4), b += word(4, 4), c += word(8, 4);
        a -= c, a ^= turned(c, 4), c += b;
        b -= a, b ^= turned(a, 6), a += c;
        c -= b, c ^= turned(b, 8), b += a;
        a -= c, a ^= turned(c, 16), c += b;
        b -= a, b ^= turned(a, 19), a += c;
        c -= b, c ^= turned(b, 4), b += a;
        k += 12, length -= 12;
    }
    if (length == 0) return c;
    a += word(0, length);
    if (length > 4) b += word(4, length - 4);
    if (length > 8) c += word(8, length - 8);
    c ^= b, c -= turned(b, 14);
    a ^= c, a -= turned(c, 11);
    b ^= a, b -= turned(a, 25);
    c ^= b, c -= turned(b, 16);
    a ^= c, a -= turned(c, 4);
    b ^= a, b -= turned(a, 14);
    c ^= b, c -= turned(b, 24);
    return c;
}

/// What HDF5 says about a file, block by block, each with its checksum behind it.
struct Block {
    std::size_t begin, end;
};
std::vector<Block> blocksOf(const std::string& file) {
    std::vector<Block> blocks;
    const auto* bytes = reinterpret_cast<const unsigned char*>(file.data());
    for (const std::string sign : {"\x89HDF", "OHDR", "OCHK", "FRHP", "FHDB", "FHIB", "BTHD", "BTIN", "BTLF", "EAHD",
                                   "EAIB", "EASB", "EADB", "FAHD", "FADB", "FSHD", "FSSE"})
        for (std::size_t at = file.find(sign); at != std::string::npos; at = file.find(sign, at + 4))
            for (std::size_t end = at + 12; end + 4 <= std::min(file.size(), at + 4096); ++end) {
                std::uint32_t stored = 0;
                std::memcpy(&stored, &file[end], 4);
                if (stored != checksum(bytes + at, end - at)) continue;
                blocks.push_back({at, end});
                break;
            }
    return blocks;
}

/// A few bytes of one block or two are others, and the checksums are right.
std::string mutated(std::string file, const std::vector<Block>& blocks, std::mt19937_64& random) {
    static constexpr unsigned char kOdd[] = {0, 1, 2, 0x7f, 0x80, 0xff, 0xfe, 8, 16, 64};
    for (std::uint64_t n = 1 + random() % 2; n > 0; --n) {
        const Block& block = blocks[random() % blocks.size()];
        for (std::uint64_t k = 1 + random() % 4; k > 0; --k) {
            const std::size_t at = block.begin + 4 + random() % (block.end - block.begin - 4);
            file[at] = static_cast<char>(random() % 2 == 0 ? kOdd[random() % std::size(kOdd)] : random() % 256);
        }
        const std::uint32_t sum =
            checksum(reinterpret_cast<const unsigned char*>(file.data()) + block.begin, block.end - block.begin);
        std::memcpy(&file[block.end], &sum, 4);
    }
    return file;
}

class Sandboxed : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new test::TemporaryFolder;
        simulation::SimulationSettings settings = simulation::blockSettings();
        const instrument::Instrument known = instrument::makeInstrument("round:1.0x0.9");
        settings.bur = known.bur, settings.cuttingParameters = known.cuttingParameters;
        const cases::Case block = simulation::blockCase();
        const simulation::SimulationSetup station = simulation::makeSimulation(block, settings, false);
        simulation::LiveSessionSettings live;
        live.sessionFile = honest();
        const auto lead = std::make_shared<simulation::Lead>();
        simulation::LiveSession sitting(station, block, simulation::handOf(simulation::twoHoles(), lead), live,
                                        nullptr);
        ASSERT_TRUE(simulation::leadTo(sitting, *lead, 3.1));
        sitting.stop();
        tasks::Task task = blockTask();
        tasks::writeTask(task, exercise());
    }
    static void TearDownTestSuite() {
        delete folder_;
        folder_ = nullptr;
    }

    static fs::path honest() { return folder_->path() / "honest.h5"; }
    static fs::path exercise() { return folder_->path() / "block.handpiece"; }
    static fs::path hostile() { return folder_->path() / "hostile.h5"; }
    static tasks::Task blockTask() {
        tasks::Task task;
        task.id = "block";
        task.toothCase = simulation::blockCase();
        task.toothCase.exercise.emplace();
        task.toothCase.exercise->title["en"] = "A block";
        task.toothCase.exercise->allowedBurs = {"round:1.0x0.9"};
        task.voxelMm = simulation::blockSettings().field.voxelMm;
        task.rubric = kRubric;
        return task;
    }
    static school::PushedAttempt told(const fs::path& session) {
        school::PushedAttempt p;
        p.attempt.id = std::string(32, 'a');
        p.attempt.exercise = "block";
        p.attempt.exerciseHash = rubric::hashText(tasks::contentHash(blockTask()));
        p.attempt.sessionHashes = {assessment::workHash(session)};
        return p;
    }
    static Proof proved(const fs::path& session) {
        return prove(questionOf(told(session), kRubric, {}), {{session}, exercise()});
    }
    /// Of another's settings, and with a tooth of so many bytes.
    static void forged(const std::string& settings, std::size_t toothBytes = 100) {
        session::SessionInfo info = session::SessionReader(honest()).info();
        info.settings = settings;
        if (toothBytes > 0) info.tooth = std::vector<std::byte>(toothBytes);
        session::SessionWriter writer(hostile(), info);
        const session::SessionReader reader(honest());
        for (const session::Record& one : reader.records(0, 2000))
            writer.append(one);
    }

    static test::TemporaryFolder* folder_;
};
test::TemporaryFolder* Sandboxed::folder_ = nullptr;

TEST_F(Sandboxed, HonestWorkIsWorthTheSame) {
    const std::vector<fs::path> files{honest()};
    const Proof apart = proved(honest());
    const school::Score here =
        proving::prove(told(honest()), files, blockTask(), rubric::parseRubric(kRubric, "rubric.toml"));
    EXPECT_EQ(apart.score.state, "proven") << apart.score.reason;
    EXPECT_EQ(apart.score.state, here.state);
    EXPECT_EQ(apart.score.stateHash, here.stateHash);
    EXPECT_EQ(apart.score.result, here.result);
    EXPECT_EQ(apart.score.score, here.score);
    EXPECT_EQ(apart.score.maxScore, here.maxScore);
    EXPECT_EQ(apart.score.wholeScore, here.wholeScore);
    EXPECT_EQ(apart.score.passed, here.passed);
    EXPECT_EQ(apart.score.borderline, here.borderline);
    EXPECT_EQ(apart.score.reason, here.reason);
    EXPECT_EQ(apart.score.engine, here.engine);
    proving::RecordedInputs inputs(honest());
    inputs.goOn();
    EXPECT_THAT(apart.contents.inputs, ElementsAre(inputs.hash()));
    EXPECT_THAT(apart.doubts, IsEmpty());
    const ReadThrough read = readThrough(honest());
    EXPECT_EQ(read.ticks, session::SessionReader(honest()).size());
    EXPECT_GT(read.keyFrames, 0u);
}

TEST_F(Sandboxed, ThePictureOfItIsDrawn) {
    try {
        const view::Image image = picture({{honest()}, exercise()}, 160, 120);
        EXPECT_EQ(image.rgba.size(), 4u * 160 * 120);
        EXPECT_NE(*std::max_element(image.rgba.begin(), image.rgba.end()),
                  *std::min_element(image.rgba.begin(), image.rgba.end()));
    } catch (const core::Error& e) {
        if (std::string(e.what()).find("OpenGL") != std::string::npos) GTEST_SKIP() << e.what();
        throw;
    }
}

TEST_F(Sandboxed, TheReviewOfItIsMade) {
    const report::Review shown = review({{honest()}, {}}, "A block", {}, {}, 1'900'000);
    EXPECT_FALSE(shown.data.empty());
    EXPECT_THAT(shown.json, HasSubstr("A block"));
    const std::string result = proved(honest()).score.result;
    const report::Review held = review({{honest()}, exercise()}, "A block", result, kRubric, 1'900'000);
    EXPECT_GT(held.json.size(), shown.json.size());
}

TEST_F(Sandboxed, AnExerciseIsReadAndPackedAnew) {
    const PackedExercise packed = pack(exercise(), 64u << 20);
    EXPECT_EQ(packed.exercise.id, "block");
    EXPECT_EQ(packed.exercise.hash, rubric::hashText(tasks::contentHash(blockTask())));
    EXPECT_EQ(packed.exercise.title.at("en"), "A block");
    EXPECT_EQ(packed.exercise.rubric, kRubric);
    const fs::path again = folder_->path() / "again.handpiece";
    core::writeFile(again, packed.file);
    EXPECT_EQ(bytesOf(again), bytesOf(exercise()));
    EXPECT_EQ(sandboxed::exercise(again).hash, packed.exercise.hash);
    write(again, "PK no exercise at all");
    EXPECT_EQ(test::errorFrom([&] { (void)pack(again, 64u << 20); }).value().id(), "not-a-package");
    const std::string page = studentReport(exercise(), proved(honest()).score.result, kRubric);
    EXPECT_THAT(page, HasSubstr("<html"));
}

// As the window has it read that opens it afterwards.
TEST_F(Sandboxed, APackageIsReadWithAllThatIsInIt) {
    EXPECT_EQ(checkPackage(exercise()).type, "exercise");
    EXPECT_THAT(checkPackage(exercise()).sessions, IsEmpty());
    const fs::path file = folder_->path() / "checked.handpiece", beside = folder_->path() / "beside.handpiece";
    const std::vector<std::byte> honestBytes = core::readFile(honest());
    tasks::Task task = blockTask();
    task.teacherWork = std::make_shared<const std::vector<std::byte>>(honestBytes);
    tasks::writeTask(task, file);
    EXPECT_THAT(checkPackage(file).sessions, ElementsAre(prepared::sha256Of(honestBytes)));

    const cases::Case block = simulation::blockCase();
    cases::writeCase(block, beside);
    EXPECT_EQ(checkPackage(beside).type, "case");
    cases::Attempt attempt;
    attempt.caseFile = beside;
    attempt.caseKey = cases::contentKey(block);
    attempt.caseName = block.name;
    attempt.state =
        tooth::encodeState({}, simulation::makeSimulation(block, simulation::blockSettings(), false).identity());
    attempt.voxelMm = simulation::blockSettings().field.voxelMm;
    attempt.recordings = {{"honest.h5", true}, {"gone.h5", false}};
    cases::writeAttempt(attempt, file, &block, {{"honest.h5", honestBytes}});
    const CheckedPackage checked = checkPackage(file);
    EXPECT_EQ(checked.type, "attempt");
    EXPECT_THAT(checked.sessions, ElementsAre(prepared::sha256Of(honestBytes)));
    // The case that it only names is no part of it.
    cases::writeAttempt(attempt, file, nullptr, {{"honest.h5", honestBytes}});
    EXPECT_THAT(checkPackage(file).sessions, testing::SizeIs(1));
    // A session in it that is none, and no package at all.
    forged("no JSON", 0);
    cases::writeAttempt(attempt, file, &block, {{"honest.h5", core::readFile(hostile())}});
    EXPECT_THAT(test::errorOf([&] { (void)checkPackage(file); }), HasSubstr("honest.h5 in "));
    write(file, "PK no package at all");
    EXPECT_EQ(test::errorIdOf([&] { (void)checkPackage(file); }), "not-a-package");
    int asked = 0;
    EXPECT_EQ(
        test::errorFrom([&] { (void)readThrough(honest(), [&](double) { return ++asked < 0; }); }).value().problem(),
        "cancelled");
    EXPECT_GT(asked, 0);
}

// As a teacher's desk has it judged.
TEST_F(Sandboxed, ReturnedWorkIsWorthTheSame) {
    const fs::path works = folder_->path() / "works", chain = works / "chain", attempts = works / "attempt.handpiece",
                   named = works / "named.handpiece", alone = works / "case.handpiece";
    fs::create_directories(chain);
    fs::copy_file(honest(), chain / "one.h5");
    cases::Attempt attempt;
    const cases::Case block = simulation::blockCase();
    cases::writeCase(block, alone);
    attempt.caseFile = alone;
    attempt.caseKey = cases::contentKey(block);
    attempt.state =
        tooth::encodeState({}, simulation::makeSimulation(block, simulation::blockSettings(), false).identity());
    attempt.voxelMm = simulation::blockSettings().field.voxelMm;
    attempt.recordings = {{"honest.h5", true}};
    const std::vector<std::byte> bytes = core::readFile(honest());
    cases::writeAttempt(attempt, attempts, &block, {{"honest.h5", bytes}});
    cases::writeAttempt(attempt, named, nullptr, {{"honest.h5", bytes}});
    const rubric::Rubric rubric = rubric::parseRubric(kRubric, "rubric.toml");
    for (const fs::path& work : {honest(), chain, attempts, named}) {
        const marking::Judged apart = returned({work, exercise(), rubric::rubricToml(rubric)}),
                              here = marking::judgeReturned(work, blockTask(), rubric, true, false);
        EXPECT_EQ(assessment::resultJson(apart.result.assessment, apart.result.identity),
                  assessment::resultJson(here.result.assessment, here.result.identity))
            << work;
        EXPECT_EQ(apart.result.proof, here.result.proof) << work;
        EXPECT_EQ(apart.picture.width, apart.picture.rgba.empty() ? 0 : marking::kPictureWidth);
    }
    // Its case lies where the work has no business.
    fs::rename(alone, folder_->path() / "elsewhere.handpiece");
    attempt.caseFile = folder_->path() / "elsewhere.handpiece";
    cases::writeAttempt(attempt, named, nullptr, {{"honest.h5", bytes}});
    const Returned out{named, exercise(), rubric::rubricToml(rubric)};
    EXPECT_TRUE(sandbox::isFault(test::errorFrom([&] { (void)returned(out); }).value()));
    forged("no JSON", 0);
    const Returned bad{hostile(), exercise(), rubric::rubricToml(rubric)};
    EXPECT_TRUE(sandbox::isFault(test::errorFrom([&] { (void)returned(bad); }).value()));
    const Returned without{honest(), exercise(), "no rubric"};
    EXPECT_EQ(test::errorIdOf([&] { (void)returned(without); }), "sandbox-exercise");
}

TEST_F(Sandboxed, WhatIsWrongWithTheSchoolsOwnIsNoFaultOfTheWork) {
    const fs::path broken = folder_->path() / "broken.handpiece";
    write(broken, "no exercise");
    EXPECT_EQ(test::errorFrom([&] {
                  (void)prove(questionOf(told(honest()), kRubric, {}), {{honest()}, broken});
              })
                  .value()
                  .id(),
              "sandbox-exercise");
    EXPECT_EQ(test::errorFrom([&] {
                  (void)prove(questionOf(told(honest()), "no rubric", {}), {{honest()}, exercise()});
              })
                  .value()
                  .id(),
              "sandbox-exercise");
}

// 240 kB of brackets ended the server, wherever JSON stands in a session.
TEST_F(Sandboxed, DeepSettingsAreRefused) {
    for (const std::string& settings :
         {std::string(200'000, '['), "{\"tissues\":" + std::string(120'000, '[') + std::string(120'000, ']') + "}",
          std::string("{}"), std::string("no JSON")}) {
        forged(settings, 0);
        const Proof proof = proved(hostile());
        EXPECT_EQ(proof.score.state, "refused");
        EXPECT_NE(proof.score.reason, "") << settings.substr(0, 20);
        EXPECT_EQ(proof.score.passed, "teacher");
    }
}

// A file of some hundred kilobytes said that it held 1 GiB, of which nothing was there.
TEST_F(Sandboxed, ASizeThatIsOnlySaidTakesNoMemory) {
    fs::copy_file(honest(), hostile(), fs::copy_options::overwrite_existing);
    for (const char* name : {"tooth", "scenery"}) {
        const hid_t file = H5Fopen(hostile().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
        ASSERT_GE(file, 0);
        if (H5Lexists(file, name, H5P_DEFAULT) > 0) H5Ldelete(file, name, H5P_DEFAULT);
        const hsize_t size = hsize_t{1} << 30, chunk = hsize_t{1} << 20;
        const hid_t space = H5Screate_simple(1, &size, nullptr), how = H5Pcreate(H5P_DATASET_CREATE);
        H5Pset_chunk(how, 1, &chunk), H5Pset_deflate(how, 1);
        const hid_t set = H5Dcreate(file, name, H5T_STD_U8LE, space, H5P_DEFAULT, how, H5P_DEFAULT);
        EXPECT_GE(set, 0);
        H5Dclose(set), H5Pclose(how), H5Sclose(space), H5Fclose(file);
        EXPECT_LT(fs::file_size(hostile()), 3'000'000u);
        EXPECT_THAT(test::errorOf([&] { (void)readThrough(hostile()); }), HasSubstr("larger than what is stored"))
            << name;
        const Proof proof = proved(hostile());
        EXPECT_EQ(proof.score.state, "refused");
        EXPECT_THAT(proof.score.reason, HasSubstr("larger than what is stored"));
    }
}

TEST_F(Sandboxed, WhatIsNoSessionIsRefused) {
    for (const std::string& bytes : {std::string(), std::string("text"), bytesOf(honest()).substr(0, 2000)}) {
        write(hostile(), bytes);
        const Proof proof = proved(hostile());
        EXPECT_EQ(proof.score.state, "refused");
        EXPECT_NE(proof.score.reason, "");
        EXPECT_THAT(proof.contents.inputs, ElementsAre(""));
    }
}

// What HDF5 says about the file is changed and its checksums made right: some of these end HDF5 itself.
TEST_F(Sandboxed, MutatedSessionsHarmNobody) {
    const char* asked = std::getenv("HANDPIECE_CAMPAIGN");
    const std::size_t count = asked ? std::strtoul(asked, nullptr, 10) : 80;
    const std::string seed = bytesOf(honest());
    const std::vector<Block> blocks = blocksOf(seed);
    ASSERT_GT(blocks.size(), 20u);
    std::mutex mutex;
    std::map<std::string, std::size_t> kinds;
    std::uint64_t most = 0;
    std::atomic<std::size_t> next{0};
    const auto work = [&](unsigned which) {
        const fs::path file = folder_->path() / ("mutant" + std::to_string(which) + ".h5");
        for (std::size_t i = next++; i < count; i = next++) {
            std::mt19937_64 random(test::seed() + i);
            write(file, mutated(seed, blocks, random));
            std::string kind = "read";
            std::uint64_t peak = 0;
            try {
                peak = readThrough(file).peakBytes;
                if (i % 8 == 0) {
                    const Proof proof = proved(file);
                    kind = proof.score.state;
                    EXPECT_TRUE(kind == "proven" || !proof.score.reason.empty());
                }
            } catch (const core::Error& e) {
                kind = e.id().empty() ? "refused" : e.id();
                if (!sandbox::isFault(e) || e.problem().empty()) ADD_FAILURE() << i << ": " << e.what();
            }
            const std::lock_guard lock(mutex);
            ++kinds[kind], most = std::max(most, peak);
        }
    };
    std::vector<std::thread> all;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
        all.emplace_back(work, i);
    for (std::thread& one : all)
        one.join();
    std::string told;
    for (const auto& [kind, number] : kinds)
        told += kind + " " + std::to_string(number) + ", ";
    std::printf("%zu mutants of %zu blocks: %sat most %.0f MB\n", count, blocks.size(), told.c_str(),
                1e-6 * static_cast<double>(most));
    EXPECT_GT(kinds.size(), 1u);
    EXPECT_LT(most, std::uint64_t{3} << 30);
}

}  // namespace
}  // namespace handpiece::sandboxed::sandboxed_test
