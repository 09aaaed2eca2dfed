// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A school's books on both databases for the tests of them: a real PostgreSQL server of the tests' own.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "handpiece/school/store/books.h"
#include "school/store/postgres_server.h"

namespace handpiece::school {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

inline constexpr Milliseconds kNow = 1'700'000'000'000, kDay = 86'400'000;
inline const Act kAdmin{"admin", kNow};

/// One for all tests; null where the package is not there.
inline test::PostgresServer* server() {
    static const std::unique_ptr<test::PostgresServer> one = test::PostgresServer::start();
    return one.get();
}
inline constexpr const char* kNoServer = "postgresql-15 is not installed: the books are not tested on it";

inline std::string id(std::uint64_t number) {
    return fmt::format("{:032x}", number);
}
inline std::string shortHash(std::uint64_t number) {
    return fmt::format("{:016x}", number);
}
inline std::span<const std::byte> bytesOf(const std::string& text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}
inline std::string randomBytes(std::mt19937_64& random, std::size_t size) {
    std::string bytes(size, '\0');
    for (char& byte : bytes)
        byte = static_cast<char>(random());
    return bytes;
}
inline std::size_t below(std::mt19937_64& random, std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
}

inline const std::string kStation = id(0x57a7), kPackFile = "the pack's bytes";

inline Upload uploadOf(const std::string& bytes, const std::string& station = kStation) {
    return {station, sha256(bytes), bytes.size()};
}
inline void upload(Books& books, const std::string& bytes) {
    books.append(uploadOf(bytes), 0, bytesOf(bytes), kNow);
}

inline PushedAttempt attempt(std::uint64_t number, const std::vector<std::string>& files = {},
                             std::size_t resultBytes = 300) {
    PushedAttempt p;
    Attempt& a = p.attempt;
    a.id = id(number);
    a.exercise = "class-one-46";
    a.exerciseHash = shortHash(0xe0);
    a.rubricHash = shortHash(0xab);
    for (const std::string& file : files) {
        p.files.push_back(sha256(file));
        a.sessionHashes.push_back(shortHash(a.sessionHashes.size() + 1));
    }
    a.began = kNow - 600'000;
    a.finished = kNow - 60'000 + static_cast<Milliseconds>(number);
    a.device = "pointer";
    a.score = 7.25;
    a.maxScore = 10.0;
    a.wholeScore = 12.5;
    a.passed = "teacher";
    a.borderline = true;
    a.workedS = 540.1;
    a.limitS = 600.0;
    a.result = std::string(resultBytes, 'r');
    p.station = kStation;
    p.person = "s1";
    p.assignment = "a1";
    p.received = kNow;
    return p;
}

inline Score scoreOf(const Job& job, const std::string& worker) {
    Score s;
    s.attempt = job.attempt;
    s.engine = 12;
    s.state = "proven";
    s.stateHash = shortHash(0x5);
    s.score = 6.5;
    s.maxScore = 10.0;
    s.wholeScore = 12.5;
    s.passed = "yes";
    s.result = "{}";
    s.worker = worker;
    s.made = kNow;
    return s;
}

/// A class with a teacher, an examiner, three students, an exercise and a station.
inline void fill(Books& books) {
    books.add(std::vector<Person>{{"admin", "Ada", "ada", "", "$argon2id$1", {"administrator"}},
                                  {"t1", "Sato Yuki", "sato", "x-1", "$argon2id$2", {"teacher", "examiner"}},
                                  {"s1", "Mori Aiko", "mori", "", "", {"student"}},
                                  {"s2", "O'Hara \"Bob\"", "ohara", "", "", {"student"}},
                                  {"s3", "\xe6\xa3\xae \xe6\x84\x9b\xe5\xad\x90", "", "", "", {"student"}}},
              kAdmin);
    books.add(SchoolClass{"c1", "Second year", "", 365}, kAdmin);
    books.enrol(
        std::vector<Enrolment>{
            {"c1", "t1", "teacher"}, {"c1", "s1", "student"}, {"c1", "s2", "student"}, {"c1", "s3", "student"}},
        kAdmin);
    books.add(RubricVersion{shortHash(0xab), "46-class-one", "[rubric]\n", 1}, kAdmin);
    books.add(RubricVersion{shortHash(0xac), "46-class-one", "[rubric] # two\n", 2}, kAdmin);
    upload(books, kPackFile);
    books.add(Pack{shortHash(0xe0), sha256(kPackFile), "class-one-46", "Class I", shortHash(0xab)}, kAdmin);
    books.add(
        Assignment{"a1", "c1", shortHash(0xe0), shortHash(0xab), "Week 1", "practice", "glass", kNow, kNow + kDay},
        kAdmin);
    books.offerCode("one-time-code", "Room 2, 14", kNow + kDay, kAdmin, "exam");
    ASSERT_TRUE(books.enrolStation("one-time-code", kStation, std::string(40, 'k'), kNow));
}
class BooksTest : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        if (!isPostgres()) return;
        if (!server()) GTEST_SKIP() << kNoServer;
        schema_ = server()->newSchema();
        address_ = server()->address(schema_);
    }
    static bool isPostgres() { return std::string(GetParam()) == "postgres"; }
    [[nodiscard]] std::unique_ptr<Books> open(std::chrono::milliseconds patience = 20s) const {
        return std::make_unique<Books>(data_, address_, patience);
    }
    [[nodiscard]] std::unique_ptr<Books> filled() const {
        auto books = open();
        fill(*books);
        return books;
    }
    [[nodiscard]] std::string dump() const { return asText(open()->everything()); }
    /// Past the books, as another program.
    std::string sql(const std::string& statements) const {
        if (isPostgres()) return server()->sql(schema_, statements);
        sqlite3* handle = nullptr;
        std::string answer;
        EXPECT_EQ(sqlite3_open((data_ / "books.db").c_str(), &handle), SQLITE_OK);
        char* why = nullptr;
        const auto keep = [](void* into, int, char** values, char**) {
            if (values[0]) *static_cast<std::string*>(into) = values[0];
            return 0;
        };
        const int code = sqlite3_exec(handle, statements.c_str(), keep, &answer, &why);
        const std::string text = why ? why : "";
        sqlite3_free(why);
        sqlite3_close(handle);
        if (code != SQLITE_OK) throw std::runtime_error(text);
        return answer;
    }

    core::PrivateFolder folder_;
    fs::path data_ = folder_.path() / "data";
    std::string schema_, address_;
};
}  // namespace handpiece::school
