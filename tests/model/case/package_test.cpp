// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/package.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zip.h>

#include <algorithm>
#include <functional>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/large_package.h"
#include "support/random.h"

namespace handpiece::cases::package_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

std::vector<std::byte> bytes(const std::string& text) {
    const auto view = std::as_bytes(std::span(text));
    return {view.begin(), view.end()};
}

class PackageTest : public testing::Test {
  protected:
    [[nodiscard]] fs::path folder() const { return temporary_.path(); }
    [[nodiscard]] fs::path file() const { return folder() / "p.handpiece"; }

    /// A zip as another program might write it.
    void zipOf(const std::vector<std::pair<std::string, std::string>>& files,
               const std::function<void(zip_t*, zip_uint64_t)>& spoil = {}) const {
        fs::remove(file());
        int error = 0;
        zip_t* archive = zip_open(file().c_str(), ZIP_CREATE | ZIP_TRUNCATE, &error);
        ASSERT_NE(archive, nullptr);
        for (const auto& [name, content] : files) {
            zip_source_t* source = zip_source_buffer(archive, content.data(), content.size(), 0);
            const zip_int64_t index = zip_file_add(archive, name.c_str(), source, ZIP_FL_ENC_UTF_8);
            ASSERT_GE(index, 0) << name;
            if (spoil) spoil(archive, static_cast<zip_uint64_t>(index));
        }
        ASSERT_EQ(zip_close(archive), 0) << zip_strerror(archive);
    }
    [[nodiscard]] std::string errorOf(const PackageLimits& limits = {}) const {
        try {
            (void)readPackage(file(), limits);
        } catch (const core::Error& e) {
            EXPECT_THAT(e.what(), HasSubstr("p.handpiece"));
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
            return e.what();
        }
        return {};
    }

  private:
    test::TemporaryFolder temporary_;
};

TEST_F(PackageTest, ComesBackAsItWasWrittenAndTheSameEveryTime) {
    std::mt19937_64 generator(test::seed());
    PackageFiles files{{"case.toml", bytes("format = 1\n")}, {"a/b/c.bin", {}}, {"empty", {}}};
    for (int i = 0; i < 300000; ++i)
        files["a/b/c.bin"].push_back(static_cast<std::byte>(generator()));
    writePackage(file(), files);
    EXPECT_EQ(readPackage(file()), files);
    const auto first = core::readFile(file());
    writePackage(file(), files);
    EXPECT_EQ(core::readFile(file()), first);
    EXPECT_TRUE(isPackageName("x/y.HandPiece"));
    EXPECT_FALSE(isPackageName("x/handpiece"));
}

TEST_F(PackageTest, FoldersInItAreFine) {
    zipOf({{"case/", ""}, {"case/a.txt", "hello"}});
    EXPECT_EQ(readPackage(file()), (PackageFiles{{"case/a.txt", bytes("hello")}}));
}

TEST_F(PackageTest, NamesThatLeadElsewhereAreRefused) {
    for (const char* name : {"../evil", "a/../../evil", "/etc/passwd", "a/..", "C:evil", "C:\\evil", "..\\evil", "a//b",
                             "./a", "a/./b", "tab\there"}) {
        zipOf({{"fine", "1"}, {name, "2"}});
        EXPECT_THAT(errorOf(), HasSubstr("is refused")) << name;
    }
    zipOf({{std::string(300, 'x'), "2"}});
    EXPECT_THAT(errorOf(), HasSubstr("too long"));
    EXPECT_EQ(fs::exists(folder().parent_path() / "evil"), false);
}

// No library writes such a zip: it is made of one with two names.
TEST_F(PackageTest, ANameThatStandsTwiceIsRefused) {
    zipOf({{"case.toml", "format = 1"}, {"case.tomm", "format = 2"}});
    std::vector<std::byte> zip = core::readFile(file());
    const std::vector<std::byte> other = bytes("case.tomm");
    int found = 0;
    for (auto at = zip.begin(); (at = std::search(at, zip.end(), other.begin(), other.end())) != zip.end(); ++found)
        at[8] = std::byte{'l'};
    ASSERT_EQ(found, 2);  // before its content, and in the directory
    core::writeFile(file(), zip);
    EXPECT_THAT(errorOf(), HasSubstr("names an entry twice"));
    try {
        (void)LargePackage(file());
        FAIL();
    } catch (const core::Error& e) {
        EXPECT_THAT(e.what(), HasSubstr("names \"case.toml\" twice"));
    }
}

TEST_F(PackageTest, LinksDevicesAndEncryptedFilesAreRefused) {
    for (const unsigned type : {0120000u, 0020000u, 0060000u, 0010000u}) {
        zipOf({{"link", "/etc/passwd"}}, [type](zip_t* archive, zip_uint64_t index) {
            zip_file_set_external_attributes(archive, index, 0, ZIP_OPSYS_UNIX, (type | 0777u) << 16);
        });
        EXPECT_THAT(errorOf(), HasSubstr("link or a device")) << type;
    }
    zipOf({{"secret", "text"}}, [](zip_t* archive, zip_uint64_t index) {
        zip_file_set_encryption(archive, index, ZIP_EM_AES_256, "password");
    });
    EXPECT_THAT(errorOf(), HasSubstr("encrypted"));
}

TEST_F(PackageTest, BombsAreRefusedBeforeTheyGoOff) {
    zipOf({{"zeros", std::string(40 << 20, '\0')}});
    EXPECT_LT(fs::file_size(file()), 100000u);
    EXPECT_THAT(errorOf(), AllOf(HasSubstr("times its size"), HasSubstr("200")));
    // Little may be packed tightly.
    zipOf({{"zeros", std::string(4 << 20, '\0')}});
    EXPECT_EQ(errorOf(), "");
    PackageLimits limits;
    limits.bytes = 1 << 20;
    EXPECT_THAT(errorOf(limits), HasSubstr("more than 1 MB"));
    std::vector<std::pair<std::string, std::string>> many;
    for (int i = 0; i < 1001; ++i)
        many.emplace_back("f" + std::to_string(i), "x");
    zipOf(many);
    EXPECT_THAT(errorOf(), HasSubstr("1001 files"));
}

TEST_F(PackageTest, WhatIsDamagedIsTold) {
    EXPECT_THAT(errorOf(), HasSubstr("no such file"));
    core::writeFile(file(), "");
    EXPECT_NE(errorOf(), "");
    core::writeFile(file(), "this is a text, not a zip");
    EXPECT_THAT(errorOf(), HasSubstr("no .handpiece file"));
    std::string content;
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 20000; ++i)
        content += static_cast<char>(generator());
    writePackage(file(), {{"a", bytes(content)}, {"b", bytes("other")}});
    const std::vector<std::byte> whole = core::readFile(file());
    // Cut off anywhere, or a byte of the content turned: never content that differs.
    for (int i = 0; i < 60; ++i) {
        core::writeFile(file(), std::span(whole).first(generator() % whole.size()));
        EXPECT_NE(errorOf(), "");
    }
    for (int i = 0; i < 60; ++i) {
        std::vector<std::byte> turned = whole;
        turned[100 + generator() % 19000] ^= std::byte{0x10};
        core::writeFile(file(), turned);
        EXPECT_THAT(errorOf(), HasSubstr("damaged"));
    }
}

TEST_F(PackageTest, AFailureLeavesTheOldFile) {
    writePackage(file(), {{"a", bytes("1")}});
    const auto before = core::readFile(file());
    EXPECT_THROW(writePackage(file(), {{"../a", bytes("2")}}), core::Error);
    EXPECT_THROW(writePackage(folder() / "none" / "x.handpiece", {{"a", bytes("2")}}), core::Error);
    EXPECT_EQ(core::readFile(file()), before);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder()), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace handpiece::cases::package_test
