// SPDX-License-Identifier: Apache-2.0
// A school in one file and back, on both databases and from one into the other.
#include "handpiece/school/keeping/backup.h"

#include <gmock/gmock.h>

#include <atomic>
#include <thread>

#include "handpiece/base/core/error.h"
#include "handpiece/model/case/package.h"
#include "handpiece/school/store/books_accounts.h"
#include "school/store/books_fixture.h"

namespace handpiece::school::backup_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string errorOf(const std::function<void()>& work) {
    try {
        work();
    } catch (const core::Error& e) {
        return e.id() + ": " + e.what();
    }
    return "no error";
}

class BackupTest : public BooksTest {
  protected:
    void SetUp() override {
        BooksTest::SetUp();
        if (IsSkipped()) return;
        const auto books = filled();
        std::mt19937_64 random(7);
        for (int i = 0; i < 20; ++i) {
            const std::string session = randomBytes(random, 5000 + below(random, 100'000));
            upload(*books, session);
            PushedAttempt p = attempt(static_cast<std::uint64_t>(i + 1), {session});
            p.attempt.result = "odd\ttext\nwith \\ and \r\n" + std::string(1, static_cast<char>('a' + i));
            books->push(p);
        }
        while (const auto job = books->takeJob("w", kNow, 1000))
            ASSERT_TRUE(books->finish(*job, scoreOf(*job, "w")));
        books->push(Comment{id(900), id(1), "t1", "no place", {}, {}, kNow});
        books->addLogin(std::string(64, 'a'), "t1", kNow + kDay, kAdmin);
    }
    Backup make() const { return backUp(data_, address_, file_, kNow, "0.0.0", true); }
    /// Into a new school of the other kind, or the same.
    std::string restored(bool intoPostgres, const fs::path& to) {
        std::string address;
        if (intoPostgres) address = server()->address(server()->newSchema());
        (void)restore(file_, to, address);
        return address;
    }
    /// What is compared: all but who is logged in.
    static std::string contentOf(const Books& books) {
        std::vector<BookTable> tables = books.everything();
        for (BookTable& table : tables)
            if (table.name == "logins") table.rows.clear();
        return asText(tables);
    }
    fs::path file_ = folder_.path() / "school.zip";
};
INSTANTIATE_TEST_SUITE_P(OnBoth, BackupTest, testing::Values("sqlite", "postgres"));

TEST_P(BackupTest, AllOfItComesBackAlsoIntoTheOtherDatabase) {
    const Backup made = make();
    EXPECT_EQ(made.files, 21);
    const std::string before = contentOf(*open());
    const std::string incarnation = BooksAccounts(*open()).incarnation();
    EXPECT_EQ(checkBackup(file_).rows, made.rows);
    EXPECT_EQ(fs::status(file_).permissions() & (fs::perms::group_all | fs::perms::others_all), fs::perms::none);
    for (const bool postgres : {false, true}) {
        if (postgres && !server()) continue;
        const fs::path to = folder_.path() / (postgres ? "p" : "s");
        const std::string address = restored(postgres, to);
        Books books(to, address);
        EXPECT_EQ(contentOf(books), before) << (postgres ? "postgres" : "sqlite");
        for (const std::string& hash : open()->files().all())
            EXPECT_EQ(sha256Of(books.files().path(hash)), hash);
        EXPECT_FALSE(books.personByToken(std::string(64, 'a'), kNow)) << "nobody is logged in";
        EXPECT_EQ(books.personByLogin("sato")->password, "$argon2id$2") << "and all can log in again";
        EXPECT_TRUE(books.stationByKey(std::string(40, 'k'))) << "stations go on";
        EXPECT_NE(BooksAccounts(books).incarnation(), incarnation) << "and learn that they were restored";
        // It goes on as books do.
        EXPECT_TRUE(books.push(attempt(77)));
        EXPECT_FALSE(books.push(*books.attempt(id(1)))) << "what it has is no error";
        // Once more into what is no longer empty: refused, and nothing changes.
        const std::string full = contentOf(books);
        EXPECT_THAT(errorOf([&] { (void)restore(file_, to, address); }),
                    AllOf(HasSubstr("store-not-empty"), HasSubstr("there are books already")));
        EXPECT_EQ(contentOf(books), full);
        for (const auto& entry : fs::directory_iterator(to))
            EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr(".handpiece-"))) << "left behind";
    }
    // Into books that a server made and nobody wrote into yet.
    const fs::path fresh = folder_.path() / "fresh";
    { const Books begun(fresh); }
    (void)restore(file_, fresh, {});
    EXPECT_EQ(contentOf(Books(fresh)), before);
}

TEST_P(BackupTest, TheServersKeysGoAlongAndWhatIsThereIsNotLost) {
    const auto keyAt = [](const fs::path& folder, const char* name) {
        const auto bytes = core::readFile(folder / name);
        return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    EXPECT_EQ(make().keys, 0) << "a school without exams has none";
    core::writeFile(data_ / "exam.key", std::string("exam's"), {.ownerOnly = true});
    core::writeFile(data_ / "lti.pem", std::string("platform's"), {.ownerOnly = true});
    EXPECT_EQ(make().keys, 2);
    EXPECT_EQ(checkBackup(file_).keys, 2);
    const fs::path to = folder_.path() / "to";
    // Of a server that was begun here: it made itself one.
    fs::create_directories(to);
    core::writeFile(to / "exam.key", std::string("new one's"), {.ownerOnly = true});
    (void)restored(false, to);
    EXPECT_EQ(keyAt(to, "exam.key"), "exam's");
    EXPECT_EQ(keyAt(to, "lti.pem"), "platform's");
    EXPECT_EQ(keyAt(to, "exam.key.before-restore-1"), "new one's");
    for (const char* name : {"exam.key", "lti.pem", "exam.key.before-restore-1"})
        EXPECT_EQ(fs::status(to / name).permissions(), fs::perms::owner_read | fs::perms::owner_write) << name;
    // Refused, because it is not empty: its keys stay.
    core::writeFile(to / "exam.key", std::string("today's"), {.ownerOnly = true});
    EXPECT_THAT(errorOf([&] { (void)restore(file_, to, {}); }), HasSubstr("store-not-empty"));
    EXPECT_EQ(keyAt(to, "exam.key"), "today's");
    EXPECT_EQ(backUp(data_, address_, file_, kNow, "0.0.0", false).keys, 0) << "left out where that is asked for";
    const fs::path without = folder_.path() / "without";
    (void)restored(false, without);
    EXPECT_FALSE(core::isThere(without / "exam.key"));
}

TEST_P(BackupTest, IsOneStateWhileOthersWrite) {
    std::atomic<bool> ends{false};
    std::atomic<int> pushed{0};
    std::thread writer([&] {
        const auto books = open();
        std::mt19937_64 random(9);
        for (std::uint64_t i = 1000; !ends; ++i) {
            const std::string session = randomBytes(random, 20'000);
            upload(*books, session);
            books->push(attempt(i, {session}));
            ++pushed;
        }
    });
    while (pushed < 5)
        std::this_thread::sleep_for(1ms);
    for (int i = 0; i < 5; ++i) {
        (void)make();
        const fs::path to = folder_.path() / fmt::format("copy{}", i);
        (void)restore(file_, to, {});
        const Books books(to);
        // Each attempt that is there has its file, its job and its line; none is half.
        for (const PushedAttempt& one : books.attemptsOf("s1", "a1"))
            for (const std::string& hash : one.files)
                EXPECT_EQ(sha256Of(books.files().path(hash)), hash);
        EXPECT_TRUE(books.missingFiles(kStation).empty());
        const std::size_t attempts = books.attemptsOf("s1", "a1").size();
        const Progress work = books.progress("arrival");
        EXPECT_EQ(static_cast<std::size_t>(work.waiting + work.done), attempts);
        fs::remove_all(to);
    }
    const int before = pushed;
    while (pushed < before + 2)
        std::this_thread::sleep_for(1ms);
    ends = true;
    writer.join();
}

TEST(Backup, ADamagedOneIsFoundAndNothingIsRestored) {
    const core::PrivateFolder folder;
    const fs::path data = folder.path() / "school", file = folder.path() / "school.zip";
    {
        Books books(data);
        fill(books);
        upload(books, std::string(3000, 's'));
        books.push(attempt(1, {std::string(3000, 's')}));
    }
    core::writeFile(data / "exam.key", std::string("a key"), {.ownerOnly = true});
    (void)backUp(data, {}, file, kNow, "0.0.0", true);
    const std::vector<std::byte> good = core::readFile(file);
    const cases::PackageFiles parts = cases::readPackage(good, "school.zip");
    const auto refused = [&](const std::string& what) {
        const fs::path to = folder.path() / "to";
        const std::string check = errorOf([&] { (void)checkBackup(file); }),
                          whole = errorOf([&] { (void)restore(file, to, {}); });
        EXPECT_NE(whole, "no error") << what;
        const bool hasBooks = core::isThere(to / "books.db") && !Books(to).people().empty();
        EXPECT_FALSE(hasBooks) << what;
        fs::remove_all(to);
        return check + "\n" + whole;
    };
    // A byte anywhere, and the end anywhere.
    const auto seed = std::random_device()();
    std::mt19937_64 random(seed);
    int unnoticed = 0;
    for (int i = 0; i < 60; ++i) {
        std::vector<std::byte> bad = good;
        const std::size_t at = below(random, bad.size());
        bad[at] ^= static_cast<std::byte>(1 + below(random, 255));
        core::writeFile(file, bad);
        // What is not read of a zip (times, attributes) may change: then all comes back as it was.
        const fs::path to = folder.path() / "flipped";
        if (errorOf([&] { (void)restore(file, to, {}); }) == "no error") {
            ++unnoticed;
            EXPECT_EQ(asText(Books(to).everything()), asText(Books(data).everything()))
                << "byte " << at << " seed " << seed;
        }
        fs::remove_all(to);
    }
    EXPECT_LT(unnoticed, 30) << "seed " << seed;
    for (const std::size_t size : {std::size_t{0}, std::size_t{10}, good.size() / 2, good.size() - 1}) {
        core::writeFile(file, std::span(good).first(size));
        refused(fmt::format("cut at {}", size));
    }
    // Parts that are missing, or others.
    const auto with = [&](const std::function<void(cases::PackageFiles&)>& change) {
        cases::PackageFiles bad = parts;
        change(bad);
        cases::writePackage(file, bad);
    };
    const auto text = [](std::string_view t) {
        return std::vector<std::byte>(std::as_bytes(std::span(t)).begin(), std::as_bytes(std::span(t)).end());
    };
    std::string content;
    for (const auto& [name, bytes] : parts)
        if (name.starts_with("files/")) content = name;
    with([&](auto& p) { p.erase(content); });
    EXPECT_THAT(refused("a file less"), HasSubstr("store-damaged"));
    with([&](auto& p) { p[content][0] ^= std::byte{1}; });
    EXPECT_THAT(refused("another file"), AllOf(HasSubstr("store-damaged"), HasSubstr("is not what was put into it")));
    with([&](auto& p) { p["tables/people.tsv"].back() ^= std::byte{1}; });
    EXPECT_THAT(refused("another table"), HasSubstr("tables/people.tsv"));
    with([&](auto& p) { p.erase("tables/audit.tsv"); });
    EXPECT_THAT(refused("a table less"), HasSubstr("tables/audit.tsv"));
    with([&](auto& p) { p["keys/exam.key"][0] ^= std::byte{1}; });
    EXPECT_THAT(refused("another key"), AllOf(HasSubstr("store-damaged"), HasSubstr("keys/exam.key")));
    with([&](auto& p) { p.erase("keys/exam.key"); });
    EXPECT_THAT(refused("a key less"), HasSubstr("keys/exam.key in this backup is missing"));
    with([&](auto& p) { p.erase("backup.toml"); });
    EXPECT_THAT(refused("no manifest"), HasSubstr("no backup of a school"));
    with([&](auto& p) { p["backup.toml"] = text("format = 9\n"); });
    EXPECT_THAT(refused("a newer format"), AllOf(HasSubstr("store-newer"), HasSubstr("newer Handpiece")));
    std::string manifest(reinterpret_cast<const char*>(parts.at("backup.toml").data()), parts.at("backup.toml").size());
    std::string newer = manifest;
    newer.replace(newer.find("books = "), 9, "books = 99");
    with([&](auto& p) { p["backup.toml"] = text(newer); });
    EXPECT_THAT(refused("newer books"), HasSubstr("store-newer"));
    std::string foreign = manifest;
    foreign.replace(foreign.find("\"exam.key\""), 10, "\"../a.key\"");
    with([&](auto& p) { p["backup.toml"] = text(foreign); });
    EXPECT_THAT(refused("a key that leads out"), HasSubstr("names a key that is none"));
    std::string evil = manifest;
    evil.replace(evil.find("\"people\""), 8, "\"../../x\"");
    with([&](auto& p) { p["backup.toml"] = text(evil); });
    EXPECT_THAT(refused("a name that leads out"), HasSubstr("store-damaged"));
    core::writeFile(file, std::string("no zip"));
    EXPECT_THAT(refused("no zip"), HasSubstr("not-a-package"));
}

}  // namespace
}  // namespace handpiece::school::backup_test
