// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "handpiece/base/core/error.h"
#include "support/random.h"

namespace handpiece::core {
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

TEST(Error, putsPlaceProblemAndRemedyOnOneLine) {
    const Error e("it is empty", "tooth.stl", "export it again");
    EXPECT_STREQ(e.what(), "tooth.stl: it is empty (export it again)");
    EXPECT_STREQ(Error("alone").what(), "alone");
}

}  // namespace
}  // namespace handpiece::core
