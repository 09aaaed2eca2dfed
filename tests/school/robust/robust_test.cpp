// SPDX-License-Identifier: Apache-2.0
// A school of real programs in trouble: killed at any moment, without room, cut off, at a wrong time. Nothing is lost,
// nothing doubled. HANDPIECE_KILLS=50: so often; HANDPIECE_UPLOADS=1: 300 uploads of 20 MB at once.
#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/books_accounts.h"
#include "school/server/school_fixture.h"
#include "school/store/postgres_server.h"

namespace handpiece::school_server {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

int times(const char* variable, int few) {
    const char* const text = std::getenv(variable);
    return text ? std::max(1, std::atoi(text)) : few;
}

/// A program of its own, as an administrator or a student starts it.
class Program {
  public:
    Program(const std::vector<std::string>& words, const fs::path& log) {
        child_ = fork();
        if (child_ == 0) {
            const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
            dup2(out, 1), dup2(out, 2);
            std::vector<char*> argv;
            argv.push_back(const_cast<char*>(HANDPIECE_SCHOOL));
            for (const std::string& word : words)
                argv.push_back(const_cast<char*>(word.c_str()));
            argv.push_back(nullptr);
            execv(HANDPIECE_SCHOOL, argv.data());
            _exit(127);
        }
    }
    ~Program() {
        if (child_ > 0) kill();
    }
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;
    void kill() {
        ::kill(child_, SIGKILL);
        (void)end();
    }
    /// Its exit status; as killed: 128 and the signal.
    int end() {
        int status = 0;
        waitpid(child_, &status, 0);
        child_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    int terminate() {
        ::kill(child_, SIGTERM);
        return end();
    }
    [[nodiscard]] bool isRunning() const { return waitpid(child_, nullptr, WNOHANG) == 0; }
    [[nodiscard]] pid_t id() const { return child_; }

  private:
    pid_t child_ = -1;
};

int freePort() {
    const int line = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET, at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    EXPECT_EQ(bind(line, reinterpret_cast<sockaddr*>(&at), sizeof at), 0);
    getsockname(line, reinterpret_cast<sockaddr*>(&at), &size);
    close(line);
    return ntohs(at.sin_port);
}

/// Between stations and their server: cuts each connection after so many bytes (0: never), and may change a text that
/// passes into another of its length.
class Between {
  public:
    Between(int port, std::function<std::size_t()> bytesUntilCut, std::string from = {}, std::string to = {})
        : server_(port), until_(std::move(bytesUntilCut)), from_(std::move(from)), to_(std::move(to)) {
        listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        sockaddr_in at{};
        at.sin_family = AF_INET, at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof at;
        EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&at), sizeof at), 0);
        getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size);
        port_ = ntohs(at.sin_port);
        listen(listener_, 64);
        thread_ = std::thread([this] {
            for (;;) {
                const int in = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
                if (in < 0) return;
                lines_.emplace_back([this, in] { pass(in); });
            }
        });
    }
    ~Between() {
        shutdown(listener_, SHUT_RDWR);
        close(listener_);
        thread_.join();
        for (std::thread& line : lines_)
            line.join();
    }
    [[nodiscard]] std::string address() const { return fmt::format("http://127.0.0.1:{}", port_); }
    [[nodiscard]] int cuts() const { return cuts_; }

  private:
    void pass(int in) {
        const int out = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        sockaddr_in to{};
        to.sin_family = AF_INET, to.sin_port = htons(static_cast<std::uint16_t>(server_)),
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        std::size_t left = until_();
        const bool cuts = left > 0;
        if (connect(out, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) {
            std::vector<char> bytes(1 << 16);
            for (bool open = true; open;) {
                fd_set ready;
                FD_ZERO(&ready);
                FD_SET(in, &ready), FD_SET(out, &ready);
                timeval patience{20, 0};
                if (select(std::max(in, out) + 1, &ready, nullptr, nullptr, &patience) <= 0) break;
                for (const auto& [from, into] : {std::pair(in, out), std::pair(out, in)}) {
                    if (!FD_ISSET(from, &ready)) continue;
                    ssize_t got = recv(from, bytes.data(), bytes.size(), 0);
                    if (got <= 0) {
                        open = false;
                        break;
                    }
                    if (!from_.empty()) {
                        const auto end = bytes.begin() + got;
                        for (auto at = std::search(bytes.begin(), end, from_.begin(), from_.end()); at != end;
                             at = std::search(at, end, from_.begin(), from_.end()))
                            std::copy(to_.begin(), to_.end(), at);
                    }
                    if (cuts)
                        got = static_cast<ssize_t>(std::min<std::size_t>(static_cast<std::size_t>(got), left)),
                        left -= static_cast<std::size_t>(got);
                    if (send(into, bytes.data(), static_cast<std::size_t>(got), MSG_NOSIGNAL) != got) open = false;
                    if (cuts && left == 0) {
                        ++cuts_;
                        open = false;
                        break;
                    }
                }
            }
        }
        close(in), close(out);
    }
    int server_, listener_ = -1, port_ = 0;
    std::function<std::size_t()> until_;
    std::string from_, to_;
    std::atomic<int> cuts_{0};
    std::thread thread_;
    std::vector<std::thread> lines_;
};

/// A school's folder and database, stations with work to send, and the programs.
class RobustTest : public testing::TestWithParam<const char*> {
  protected:
    static constexpr const char* kNoServer = "postgresql-15 is not installed: not tested on it";
    static bool isPostgres() { return std::string(GetParam()) == "postgres"; }
    static test::PostgresServer* postgres() {
        static const std::unique_ptr<test::PostgresServer> one = test::PostgresServer::start();
        return one.get();
    }
    void SetUp() override {
        seed_ = std::random_device()();
        random_.seed(seed_);
        RecordProperty("seed", std::to_string(seed_));
        SCOPED_TRACE(seed_);
        if (isPostgres()) {
            if (!postgres()) GTEST_SKIP() << kNoServer;
            database_ = postgres()->address(postgres()->newSchema());
        }
        port_ = freePort();
    }
    void TearDown() override {
        if (HasFailure()) std::printf("seed %u\n", seed_);
    }
    Books books() const { return Books(data_, database_); }
    std::string address() const { return fmt::format("http://127.0.0.1:{}", port_); }

    void furnish(int stations, int attempts, std::size_t bytes) {
        Books open = books();
        const Act act{"server", 1};
        for (int s = 0; s < stations; ++s) {
            const std::string person = fmt::format("s{:03}", s), station = school::newId(), key = school::newSecret();
            const school::Person one{person, person, "", "", "", {"student"}, 1, 0};
            open.add(std::span(&one, 1), act);
            const std::string code = "code " + school::newId();
            open.offerCode(code, person, 4'000'000'000'000, act);
            ASSERT_TRUE(open.enrolStation(code, station, key, 2));
            auto chair = std::make_unique<Chair>();
            school_station::writeEnrolment({address(), station, key, person, 0, {}}, chair->home() / "school.json");
            for (int a = 0; a < attempts; ++a) {
                const fs::path session = chair->home() / "new.h5";
                {
                    std::ofstream out(session, std::ios::binary);
                    std::vector<std::uint64_t> block(1 << 13);
                    for (std::size_t done = 0; done < bytes; done += sizeof(block[0]) * block.size()) {
                        for (std::uint64_t& word : block)
                            word = random_();
                        out.write(
                            reinterpret_cast<const char*>(block.data()),
                            static_cast<std::streamsize>(std::min(bytes - done, sizeof(block[0]) * block.size())));
                    }
                }
                school::Attempt work;
                work.id = school::newId();
                work.exercise = "block", work.exerciseHash = std::string(16, 'e'),
                work.rubricHash = std::string(16, 'f');
                const std::string name = fmt::format("{}.h5", a);
                fs::rename(session, chair->home() / "sessions" / name);
                const std::string hash = school::sha256Of(chair->home() / "sessions" / name);
                work.sessionHashes = {hash.substr(0, 16)}, work.recordings = {name};
                work.began = 1000, work.finished = 5000, work.device = "simulated", work.passed = "teacher",
                work.result = "{}";
                chair->store().add(work);
                expected_[work.id] = hash;
            }
            chairs_.push_back(std::move(chair));
        }
    }
    std::unique_ptr<Program> serve() {
        std::vector<std::string> words{
            "serve", "--data", data_.string(), "--listen", fmt::format("127.0.0.1:{}", port_), "--workers", "0"};
        if (!database_.empty()) words.insert(words.end(), {"--database", database_});
        auto server = std::make_unique<Program>(words, log());
        for (int i = 0; i < 2000; ++i) {
            httplib::Client http(address());
            http.set_connection_timeout(1);
            if (const auto well = http.Get("/healthz"); well && well->status == 200) return server;
            std::this_thread::sleep_for(10ms);
        }
        ADD_FAILURE() << "the server does not come up: " << logged();
        return server;
    }
    std::unique_ptr<Program> push(std::size_t chair) {
        return std::make_unique<Program>(std::vector<std::string>{"push", "--home", chairs_[chair]->home().string()},
                                         log());
    }
    /// Each station to its end, however often it has to begin again.
    void pushAll(int most = 40) {
        for (std::size_t i = 0; i < chairs_.size(); ++i) {
            int tries = 0;
            while (push(i)->end() != 0 && ++tries < most)
                std::this_thread::sleep_for(50ms);
            ASSERT_LT(tries, most) << logged();
        }
    }
    /// All that was finished is there, once, whole, and nothing else.
    void expectAllOnce() {
        const Books open = books();
        std::size_t found = 0;
        std::stringstream all;
        all << std::ifstream(log()).rdbuf();
        const std::string text = all.str();
        const std::size_t refused = text.find("refused:");
        EXPECT_EQ(refused, std::string::npos) << text.substr(std::min(refused, text.size()), 400);
        for (std::size_t i = 0; i < chairs_.size(); ++i)
            for (const school::PushedAttempt& one : open.attemptsOf(fmt::format("s{:03}", i))) {
                ++found;
                ASSERT_EQ(expected_.count(one.attempt.id), 1u);
                ASSERT_EQ(one.files.size(), 1u);
                EXPECT_EQ(one.files[0], expected_[one.attempt.id]);
                ASSERT_TRUE(open.files().has(one.files[0])) << one.attempt.id;
                EXPECT_EQ(school::sha256Of(open.files().path(one.files[0])), one.files[0]);
            }
        EXPECT_EQ(found, expected_.size());
        const school::Progress work = open.progress("arrival");
        EXPECT_EQ(static_cast<std::size_t>(work.waiting), expected_.size()) << "each waits to be scored, once";
        std::set<std::string> hashes;
        for (const auto& [id, hash] : expected_)
            hashes.insert(hash);
        const std::vector<std::string> there = open.files().all();
        EXPECT_EQ(std::set<std::string>(there.begin(), there.end()), hashes);
    }
    fs::path log() const { return folder_.path() / "log"; }
    std::string logged() const {
        std::stringstream all;
        all << std::ifstream(log()).rdbuf();
        const std::string text = all.str();
        return text.substr(text.size() - std::min<std::size_t>(text.size(), 1500));
    }
    void sleepUpTo(int ms) {
        std::this_thread::sleep_for(std::chrono::microseconds(random_() % static_cast<std::uint64_t>(1000 * ms)));
    }

    unsigned seed_ = 0;
    std::mt19937_64 random_;
    test::TemporaryFolder folder_;
    fs::path data_ = folder_.path() / "school";
    std::string database_;
    int port_ = 0;
    std::vector<std::unique_ptr<Chair>> chairs_;
    std::map<std::string, std::string> expected_;  ///< attempt: its file
};
INSTANTIATE_TEST_SUITE_P(OnBoth, RobustTest, testing::Values("sqlite", "postgres"),
                         [](const auto& all) { return std::string(all.param); });

TEST_P(RobustTest, StationsAreKilledWhileTheyPush) {
    const int kills = times("HANDPIECE_KILLS", 6);
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
    const int kills = times("HANDPIECE_KILLS", 5);
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

TEST_P(RobustTest, StationsOfAnotherVersionAreToldWhyAndGoOnOnceTheyAreUpdated) {
    furnish(times("HANDPIECE_KILLS", 0) > 1 ? 30 : 6, 2, 50'000);
    const auto server = serve();
    const Between newer(
        port_, [] { return std::size_t{0}; }, "Handpiece-Protocol: 1", "Handpiece-Protocol: 9");
    // Before each is updated it is told why, and keeps what it has; the others go on meanwhile.
    for (std::size_t i = 0; i < chairs_.size(); ++i) {
        Enrolment own = chairs_[i]->kept();
        own.server = newer.address();
        try {
            (void)chairs_[i]->push(own);
            ADD_FAILURE() << "taken";
        } catch (const core::Error& e) {
            EXPECT_EQ(e.id(), "protocol-other");
            EXPECT_THAT(e.what(), HasSubstr("bring the older of the two up to date"));
        }
        EXPECT_EQ(school_station::waitingIn(chairs_[i]->store(), own), 2u);
        own.server = address();
        EXPECT_EQ(chairs_[i]->push(own).attempts, 2u);
    }
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

TEST(WrongClock, ADayOffEndsLogInsAndCodesAndNothingElse) {
    const test::TemporaryFolder folder;
    const fs::path data = folder.path() / "school";
    School::furnish(data);
    constexpr school::Milliseconds kNow = 1'700'000'000'000, kDay = 86'400'000;
    Books books(data);
    const Act act{"server", kNow};
    books.offerCode("one-time-code", "chair", kNow + kDay / 2, act);
    books.addLogin(std::string(64, 'a'), "s017", kNow + kDay / 2, act);
    // A server that is a day ahead: who is logged in logs in again, codes are made anew; a station goes on.
    EXPECT_FALSE(books.personByToken(std::string(64, 'a'), kNow + kDay));
    EXPECT_FALSE(books.enrolStation("one-time-code", std::string(32, '1'), std::string(64, 'k'), kNow + kDay));
    ASSERT_TRUE(books.enrolStation(kCode, std::string(32, '2'), std::string(64, 'k'), kNow + kDay));
    EXPECT_TRUE(books.stationByKey(std::string(64, 'k')));
    // Set right again, a day back: nothing that was made meanwhile is in its way.
    EXPECT_TRUE(books.personByToken(std::string(64, 'a'), kNow));
    school::PushedAttempt p;
    p.attempt.id = school::newId(), p.attempt.exercise = "block", p.attempt.exerciseHash = std::string(16, 'e');
    p.attempt.rubricHash = std::string(16, 'f'), p.attempt.passed = "teacher", p.attempt.result = "{}";
    p.attempt.began = kNow + kDay, p.attempt.finished = kNow + kDay + 1000;
    p.station = std::string(32, '2'), p.person = "s017", p.received = kNow;
    EXPECT_TRUE(books.push(p)) << "a station whose clock is a day ahead";
    // A lease that was taken in the wrong day: the clock goes back, and the work is done once.
    const auto ahead = books.takeJob("w1", kNow + kDay, 60'000);
    if (ahead) {
        EXPECT_FALSE(books.takeJob("w2", kNow, 60'000)) << "lent until a minute into tomorrow";
        EXPECT_TRUE(books.giveBack(*ahead));
        const auto again = books.takeJob("w2", kNow, 60'000);
        ASSERT_TRUE(again);
        EXPECT_TRUE(books.takeJob("w3", kNow + kDay, 60'000)) << "the clock jumps: it ran out";
        school::Score score;
        score.attempt = p.attempt.id, score.state = "refused", score.passed = "teacher";
        EXPECT_FALSE(books.finish(*again, score)) << "and is finished by the other alone";
    }
}

}  // namespace
}  // namespace handpiece::school_server
