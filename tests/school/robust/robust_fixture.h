// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A school of real programs, and what may come between them.

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/books_accounts.h"
#include "school/server/school_fixture.h"
#include "support/times.h"

namespace handpiece::school_server {

using namespace std::chrono_literals;

using test::times;

/// A program of its own, as an administrator or a student starts it; `ahead`: so much its machine's clock is.
class Program {
  public:
    Program(const std::vector<std::string>& words, const fs::path& log, std::chrono::seconds ahead = 0s) {
        child_ = fork();
        if (child_ == 0) {
            if (ahead != 0s) {
                setenv("LD_PRELOAD", HANDPIECE_OTHER_CLOCK, 1);
                setenv("HANDPIECE_CLOCK_AHEAD_S", std::to_string(ahead.count()).c_str(), 1);
                const char* const asan = std::getenv("ASAN_OPTIONS");
                setenv("ASAN_OPTIONS", (std::string(asan ? asan : "") + ":verify_asan_link_order=0").c_str(), 1);
            }
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

inline std::vector<pid_t> childrenOf(pid_t id) {
    std::vector<pid_t> all;
    const std::string tasks = "/proc/" + std::to_string(id) + "/task";
    std::error_code none;
    for (const auto& task : fs::directory_iterator(tasks, none)) {
        std::ifstream children(task.path() / "children");
        for (pid_t one = 0; children >> one;)
            all.push_back(one);
    }
    return all;
}

inline int freePort() {
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
    static constexpr const char* kExercise = "eeeeeeeeeeeeeeee";
    static constexpr const char* kNoServer = "postgresql-15 is not installed: not tested on it";
    static bool isPostgres() { return std::string(GetParam()) == "postgres"; }
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
            chairs_.push_back(std::move(chair));
            for (int a = 0; a < attempts; ++a)
                (void)work(*chairs_.back(), bytes);
        }
    }
    /// Somebody works there, and finishes; returns the attempt.
    std::string work(Chair& chair, std::size_t bytes, school::Milliseconds finished = 5000) {
        school::Attempt work;
        work.id = school::newId();
        const std::string name = work.id + ".h5";
        const fs::path session = chair.home() / "sessions" / name;
        {
            std::ofstream out(session, std::ios::binary);
            std::vector<std::uint64_t> block(1 << 13);
            for (std::size_t done = 0; done < bytes; done += sizeof(block[0]) * block.size()) {
                for (std::uint64_t& word : block)
                    word = random_();
                out.write(reinterpret_cast<const char*>(block.data()),
                          static_cast<std::streamsize>(std::min(bytes - done, sizeof(block[0]) * block.size())));
            }
        }
        const std::string hash = school::sha256Of(session);
        work.exercise = "block", work.exerciseHash = kExercise, work.rubricHash = std::string(16, 'f');
        work.sessionHashes = {hash.substr(0, 16)}, work.recordings = {name};
        work.began = finished - 4000, work.finished = finished, work.device = "simulated";
        work.passed = "teacher", work.result = "{}";
        chair.store().add(work);
        expected_[work.id] = hash;
        return work.id;
    }
    std::unique_ptr<Program> serve(std::chrono::seconds ahead = 0s, int workers = 0) {
        std::vector<std::string> words{"serve",
                                       "--data",
                                       data_.string(),
                                       "--listen",
                                       fmt::format("127.0.0.1:{}", port_),
                                       "--workers",
                                       std::to_string(workers)};
        if (!database_.empty()) words.insert(words.end(), {"--database", database_});
        auto server = std::make_unique<Program>(words, log(), ahead);
        for (int i = 0; i < 2000; ++i) {
            httplib::Client http(address());
            http.set_connection_timeout(1);
            if (const auto well = http.Get("/healthz"); well && well->status == 200) return server;
            std::this_thread::sleep_for(10ms);
        }
        ADD_FAILURE() << "the server does not come up: " << logged();
        return server;
    }
    std::unique_ptr<Program> push(std::size_t chair, std::chrono::seconds ahead = 0s) {
        return std::make_unique<Program>(std::vector<std::string>{"push", "--home", chairs_[chair]->home().string()},
                                         log(), ahead);
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
        std::set<std::string> hashes = besides_;
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
    std::set<std::string> besides_;                ///< other files
};

}  // namespace handpiece::school_server
