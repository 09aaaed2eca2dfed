// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>

#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/error.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::core::file_test {
namespace {

namespace fs = std::filesystem;

std::string textOf(const fs::path& path) {
    const std::vector<std::byte> data = readFile(path);
    return {reinterpret_cast<const char*>(data.data()), data.size()};
}

std::size_t filesIn(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator{}));
}

TEST(File, comesBackAsWritten) {
    const test::TemporaryFolder folder;
    const std::string text("a\0b\n", 4);
    writeFile(folder.path() / "x", text);
    EXPECT_EQ(textOf(folder.path() / "x"), text);
    writeFile(folder.path() / "x", std::string_view{});
    EXPECT_EQ(textOf(folder.path() / "x"), "");
    EXPECT_EQ(filesIn(folder.path()), 1u) << "no temporary file may stay";
}

TEST(File, saysWhatIsWrongAndWhere) {
    const test::TemporaryFolder folder;
    try {
        (void)readFile(folder.path() / "missing");
        FAIL() << "a missing file was read";
    } catch (const Error& e) {
        EXPECT_NE(e.where().find("missing"), std::string::npos);
        EXPECT_FALSE(e.problem().empty());
    }
    EXPECT_THROW((void)readFile(folder.path()), Error);
    writeFile(folder.path() / "big", std::string(1000, 'x'));
    EXPECT_THROW((void)readFile(folder.path() / "big", 999), Error);
}

TEST(File, keepsTheOldFileWhenTheNewOneCannotBeWritten) {
    const test::TemporaryFolder folder;
    fs::create_directory(folder.path() / "target");
    std::ofstream(folder.path() / "target" / "inside") << "stays";
    // A folder of that name is in the way of the rename.
    EXPECT_THROW(writeFile(folder.path() / "target", std::string_view("new")), Error);
    EXPECT_EQ(textOf(folder.path() / "target" / "inside"), "stays");
    EXPECT_EQ(filesIn(folder.path()), 1u);
    EXPECT_THROW(writeFile(folder.path() / "no" / "such" / "folder", std::string_view("x")), Error);
}

TEST(File, preparesAFolderOrSaysWhyNot) {
    const test::TemporaryFolder folder;
    prepareOutputFolder(folder.path() / "a" / "b");
    EXPECT_TRUE(fs::is_directory(folder.path() / "a" / "b"));
    EXPECT_EQ(filesIn(folder.path() / "a" / "b"), 0u);
    writeFile(folder.path() / "file", std::string_view("x"));
    EXPECT_THROW(prepareOutputFolder(folder.path() / "file"), Error);
    EXPECT_THROW(prepareOutputFolder(folder.path() / "file" / "below"), Error);
}

fs::perms modeOf(const fs::path& path) {
    return fs::status(path).permissions() & fs::perms::all;
}

TEST(File, OnlyPlainFilesAreRead) {
    const test::TemporaryFolder folder;
    const fs::path pipe = folder.path() / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    for (const fs::path& path : {fs::path("/dev/zero"), pipe}) {  // one has no end, the other no beginning
        try {
            (void)readFile(path);
            FAIL() << path << " was read";
        } catch (const Error& e) {
            EXPECT_EQ(e.id(), "not-a-file");
            EXPECT_EQ(e.where(), path.string());
        }
    }
    EXPECT_FALSE(readFile("/proc/self/status").empty()) << "a file that does not tell its size";
    EXPECT_THROW(writeFile(pipe, std::string_view("x")), Error);
    EXPECT_TRUE(fs::is_fifo(pipe)) << "what is no plain file is not replaced by one";
}

TEST(File, KeepsTheModeOfTheFileItReplaces) {
    const test::TemporaryFolder folder;
    const fs::path own = folder.path() / "own", usual = folder.path() / "usual";
    writeFile(own, "a", {.ownerOnly = true});
    writeFile(usual, "a");
    EXPECT_EQ(modeOf(own), fs::perms::owner_read | fs::perms::owner_write);
    EXPECT_EQ(modeOf(usual) & fs::perms::owner_all, fs::perms::owner_read | fs::perms::owner_write);
    // Whoever shares a file, or takes it back, keeps it so.
    for (const unsigned mode : {0640u, 0604u, 0600u, 0444u}) {
        for (const fs::path& file : {own, usual}) {
            fs::permissions(file, fs::perms(mode));
            writeFile(file, "b", {.ownerOnly = true, .lasting = false});
            EXPECT_EQ(modeOf(file), fs::perms(mode)) << file;
        }
    }
}

TEST(File, AFolderOfOnesOwn) {
    const test::TemporaryFolder folder;
    prepareOutputFolder(folder.path() / "a" / "own", true);
    EXPECT_EQ(modeOf(folder.path() / "a" / "own"), fs::perms::owner_all);
    fs::permissions(folder.path() / "a" / "own", fs::perms(0750));
    prepareOutputFolder(folder.path() / "a" / "own", true);
    EXPECT_EQ(modeOf(folder.path() / "a" / "own"), fs::perms(0750)) << "shared on purpose";
}

TEST(Error, putsPlaceProblemAndRemedyOnOneLine) {
    const Error e("it is empty", "tooth.stl", "export it again");
    EXPECT_STREQ(e.what(), "tooth.stl: it is empty (export it again)");
    EXPECT_STREQ(Error("alone").what(), "alone");
}

/// Where even the administrator may not look: a link to itself.
fs::path loop(const test::TemporaryFolder& folder) {
    const fs::path link = folder.path() / "loop";
    fs::create_symlink(link, link);
    return link / "below";
}

TEST(File, saysWhereOneMayNotLook) {
    const test::TemporaryFolder folder;
    writeFile(folder.path() / "x", std::string_view("x"));
    EXPECT_TRUE(isThere(folder.path() / "x"));
    EXPECT_FALSE(isFolder(folder.path() / "x"));
    EXPECT_TRUE(isFolder(folder.path()));
    EXPECT_FALSE(isThere(folder.path() / "none" / "below"));
    EXPECT_FALSE(isThere(folder.path() / "x" / "below a file"));
    const fs::path below = loop(folder);
    for (const auto& ask : std::vector<std::function<void()>>{
             [&] { (void)isThere(below); }, [&] { (void)isFolder(below); }, [&] { (void)readFile(below); },
             [&] { prepareOutputFolder(below); }, [&] { requireReplaceable(below, "m"); }}) {
        const std::string said = test::errorOf(ask);
        EXPECT_NE(said.find("below"), std::string::npos);
        EXPECT_NE(said.find("Too many levels"), std::string::npos) << said;
    }
}

TEST(File, replacesNothingButAResultOfBefore) {
    const test::TemporaryFolder folder;
    const fs::path place = folder.path() / "place";
    const auto said = [&] { return test::errorOf([&] { requireReplaceable(place, "mark"); }); };
    EXPECT_EQ(said(), "");
    fs::create_directory(place);
    EXPECT_EQ(said(), "");
    writeFile(place / "diary", std::string_view("dear"));
    EXPECT_NE(said().find("holds something else"), std::string::npos);
    writeFile(place / "mark", std::string_view(""));
    EXPECT_EQ(said(), "");
    EXPECT_NE(test::errorOf([&] { requireReplaceable(place / "diary", "mark"); }), "");
}

TEST(File, temporaryFoldersAreNobodyElsesAndGo) {
    fs::path place, other;
    {
        const PrivateFolder one, two;
        place = one.path();
        other = two.path();
        EXPECT_NE(place, other);
        EXPECT_EQ(fs::status(place).permissions(), fs::perms::owner_all);
        writeFile(place / "x", std::string_view("x"));
    }
    EXPECT_FALSE(fs::exists(place));
    EXPECT_FALSE(fs::exists(other));
}

TEST(AnyError, becomesOneLineWithWhatAndWhere) {
    EXPECT_STREQ(asError(Error("a", "b", "c").as("id")).what(), "b: a (c)");
    EXPECT_EQ(asError(Error("a").as("id")).id(), "id");
    EXPECT_NE(std::string(asError(std::bad_alloc()).what()).find("memory"), std::string::npos);
    try {
        (void)fs::exists(fs::path(std::string(5000, 'x')));
        FAIL();
    } catch (const std::exception& e) {
        EXPECT_EQ(asError(e).where(), std::string(5000, 'x'));
    }
    EXPECT_NE(std::string(asError(std::runtime_error("odd")).what()).find("odd"), std::string::npos);
}

}  // namespace
}  // namespace handpiece::core::file_test
