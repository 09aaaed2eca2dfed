// SPDX-License-Identifier: Apache-2.0
// A school of real programs in trouble: killed at any moment, without room, cut off, at once. Nothing is lost, nothing
// doubled. HANDPIECE_KILLS=50: so often; HANDPIECE_UPLOADS=1: 300 uploads of 20 MB at once.
#include <sys/mount.h>
#include <sys/resource.h>

#include "school/robust/robust_fixture.h"

namespace handpiece::school_server::robust_test {
namespace {

using testing::HasSubstr;

INSTANTIATE_TEST_SUITE_P(OnBoth, RobustTest, testing::Values("sqlite", "postgres"),
                         [](const auto& all) { return std::string(all.param); });

TEST_P(RobustTest, StationsAreKilledWhileTheyPush) {
    const int kills = times("HANDPIECE_KILLS", 4);
    furnish(2, kills / 4 + 3, 3'000'000);
    const auto server = serve();
    int unfinished = 0;
    for (int i = 0; i < kills; ++i) {
        const auto one = push(static_cast<std::size_t>(i) % 2);
        sleepUpTo(120);
        unfinished += one->isRunning() ? 1 : 0;
        one->kill();
    }
    pushAll();
    EXPECT_GT(unfinished, 0) << "none was killed in its work, seed " << seed_;
    EXPECT_EQ(server->terminate(), 0) << "and the server ends as it should";
    expectAllOnce();
}

TEST_P(RobustTest, TheServerIsKilledWhileStationsPush) {
    const int kills = times("HANDPIECE_KILLS", 3);
    furnish(3, 2 * kills / 3 + 3, 2'000'000);
    std::atomic<bool> ends{false};
    std::vector<std::thread> stations;
    for (std::size_t i = 0; i < chairs_.size(); ++i)
        stations.emplace_back([&, i] {
            while (!ends)
                if (push(i)->end() == 0) std::this_thread::sleep_for(5ms);
        });
    for (int i = 0; i < kills; ++i) {
        const auto server = serve();
        sleepUpTo(400);
        server->kill();
    }
    const auto server = serve();
    ends = true;
    for (std::thread& one : stations)
        one.join();
    pushAll();
    EXPECT_EQ(server->terminate(), 0);
    expectAllOnce();
}

TEST_P(RobustTest, TheDatabaseIsKilledWhileStationsPush) {
    if (!isPostgres()) GTEST_SKIP() << "SQLite is in the server";
    const int kills = times("HANDPIECE_KILLS", 3);
    furnish(3, kills / 2 + 3, 2'000'000);
    const auto server = serve();
    std::atomic<bool> ends{false};
    std::vector<std::thread> stations;
    for (std::size_t i = 0; i < chairs_.size(); ++i)
        stations.emplace_back([&, i] {
            while (!ends)
                if (push(i)->end() == 0) std::this_thread::sleep_for(5ms);
        });
    for (int i = 0; i < kills; ++i) {
        sleepUpTo(400);
        postgres()->kill();
        httplib::Client http(address());
        http.set_read_timeout(60);
        if (i == 0) {
            const auto gone = http.Get("/healthz");
            ASSERT_TRUE(gone);
            EXPECT_EQ(gone->status, 503);
            EXPECT_THAT(gone->body, HasSubstr("store-gone"));
        }
        postgres()->run();
    }
    ends = true;
    for (std::thread& one : stations)
        one.join();
    pushAll();
    EXPECT_TRUE(server->isRunning());
    EXPECT_EQ(server->terminate(), 0);
    expectAllOnce();
}

TEST_P(RobustTest, ADiskThatIsFullIsToldAndWorkGoesOnWhenThereIsRoom) {
    if (geteuid() != 0) GTEST_SKIP() << "only root can make a disk that is full";
    const fs::path disk = folder_.path() / "disk";
    fs::create_directories(disk);
    if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=12m") != 0) GTEST_SKIP() << "this system mounts none";
    struct Unmount {
        fs::path at;
        ~Unmount() { umount2(at.c_str(), MNT_DETACH); }
    } const unmount{disk};
    data_ = disk / "school";
    furnish(1, 5, 5'000'000);
    {
        const auto server = serve();
        EXPECT_NE(push(0)->end(), 0);
        EXPECT_THAT(logged(), HasSubstr("make room"));
        // It stands, and nothing that is half lies among what is whole.
        const auto well = httplib::Client(address()).Get("/healthz");
        ASSERT_TRUE(well);
        for (const std::string& hash : books().files().all())
            EXPECT_EQ(school::sha256Of(books().files().path(hash)), hash);
        EXPECT_NE(push(0)->end(), 0) << "still full";
        ASSERT_EQ(mount("tmpfs", disk.c_str(), "tmpfs", MS_REMOUNT, "size=60m"), 0);
        pushAll();
        EXPECT_EQ(server->terminate(), 0);
    }
    expectAllOnce();
    chairs_.clear();
}

TEST_P(RobustTest, ANetworkThatIsCutAnywhereLosesNothing) {
    furnish(2, times("HANDPIECE_KILLS", 4), 3'000'000);
    const auto server = serve();
    std::mutex guard;
    Between between(port_, [&] {
        const std::lock_guard lock(guard);
        return std::size_t{1} + random_() % (random_() % 3 == 0 ? 2000 : 2'500'000);
    });
    for (const auto& chair : chairs_) {
        Enrolment enrolment = chair->kept();
        enrolment.server = between.address();
        school_station::writeEnrolment(enrolment, chair->home() / "school.json");
    }
    pushAll(400);
    EXPECT_GT(between.cuts(), 3) << "seed " << seed_;
    EXPECT_EQ(server->terminate(), 0);
    expectAllOnce();
}

TEST_P(RobustTest, ManyUploadsAtOnceComeEachOnce) {
    const bool isWhole = std::getenv("HANDPIECE_UPLOADS") != nullptr;
    furnish(30, isWhole ? 10 : 1, isWhole ? 20'000'000 : 300'000);
    const auto server = serve();
    const auto begun = std::chrono::steady_clock::now();
    std::vector<std::unique_ptr<Program>> all;
    for (std::size_t i = 0; i < chairs_.size(); ++i)
        all.push_back(push(i));
    for (const auto& one : all)
        EXPECT_EQ(one->end(), 0) << logged();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    std::ifstream status(fmt::format("/proc/{}/status", server->id()));
    std::string line, peak;
    while (std::getline(status, line))
        if (line.starts_with("VmHWM")) peak = line.substr(6);
    std::printf("%zu uploads in %.1f s, server's memory at most %s\n", expected_.size(), seconds, peak.c_str());
    EXPECT_EQ(server->terminate(), 0);
    expectAllOnce();
}

TEST_P(RobustTest, AfterARestoreStationsSendAgainWhatCameSinceTheBackup) {
    furnish(2, 2, 100'000);
    const std::string file = (folder_.path() / "backup.zip").string();
    std::vector<std::string> backup{"backup", file, "--data", data_.string()},
        restore{"restore", file, "--data", (folder_.path() / "second").string()};
    if (!database_.empty()) backup.insert(backup.end(), {"--database", database_});
    {
        const auto server = serve();
        ASSERT_EQ(push(0)->end(), 0);
        ASSERT_EQ(Program(backup, log()).end(), 0) << logged();
        ASSERT_EQ(push(1)->end(), 0);
        EXPECT_EQ(server->terminate(), 0);
    }
    if (isPostgres()) {
        database_ = postgres()->address(postgres()->newSchema());
        restore.insert(restore.end(), {"--database", database_});
    }
    ASSERT_EQ(Program(restore, log()).end(), 0) << logged();
    data_ = folder_.path() / "second";
    const auto server = serve();
    EXPECT_TRUE(books().attemptsOf("s001").empty());
    pushAll();
    EXPECT_EQ(server->terminate(), 0);
    expectAllOnce();
}

}  // namespace
}  // namespace handpiece::school_server::robust_test
