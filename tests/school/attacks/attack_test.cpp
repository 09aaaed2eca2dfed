// SPDX-License-Identifier: Apache-2.0
// Who wants to break a school's server, against the real program on both databases: recordings that were made to, two
// hundred clients that hold on, readers that are killed. HANDPIECE_KILLS=50: so often.
#include <dirent.h>
#include <netinet/in.h>
#include <netinet/tcp.h>

#include <set>

#include "handpiece/record/session/session_reader.h"
#include "handpiece/record/session/session_writer.h"
#include "school/robust/robust_fixture.h"
#include "school/server/browser.h"

namespace handpiece::school_server::attack_test {
namespace {

using testing::HasSubstr;

/// Of a process, by a line of its status [kB].
std::size_t statusOf(pid_t id, const std::string& line) {
    std::ifstream status("/proc/" + std::to_string(id) + "/status");
    for (std::string name; status >> name; std::getline(status, name))
        if (name == line + ":") {
            std::size_t kB = 0;
            status >> kB;
            return kB;
        }
    return 0;
}
constexpr std::size_t kMostServerKb = 300'000;

class AttackTest : public RobustTest {
  protected:
    std::string finish(std::size_t chair, const fs::path& recording) {
        return chairs_[chair]->finish(recording, school::newId() + ".h5");
    }
    /// The honest session's, with other settings.
    fs::path forged(const std::string& settings, const char* name) {
        const fs::path file = folder_.path() / name;
        const session::SessionReader honest(session());
        session::SessionInfo info = honest.info();
        info.settings = settings;
        session::SessionWriter writer(file, info);
        for (const session::Record& one : honest.records(0, 3000))
            writer.append(one);
        return file;
    }
    fs::path written(const std::string& bytes, const char* name) {
        const fs::path file = folder_.path() / name;
        std::ofstream(file, std::ios::binary) << bytes;
        return file;
    }
    template <class Condition>
    static bool comesTo(const Condition& isSo) {
        for (int i = 0; i < 6000; ++i, std::this_thread::sleep_for(20ms))
            if (isSo()) return true;
        return false;
    }
};
INSTANTIATE_TEST_SUITE_P(OnBoth, AttackTest, testing::Values("sqlite", "postgres"),
                         [](const auto& all) { return std::string(all.param); });

TEST_P(AttackTest, RecordingsThatWereMadeToBreakTheirReaderBreakNothingElse) {
    School::furnish(data_, database_);
    furnish(1, 0, 0);
    std::stringstream honest;
    honest << std::ifstream(session(), std::ios::binary).rdbuf();
    const std::string whole = honest.str();
    std::map<std::string, std::string> attempts;  // and what is expected of each
    const auto hand = [&](const fs::path& file, const char* state) { attempts[finish(0, file)] = state; };
    hand(forged(std::string(400'000, '['), "deep.h5"), "refused");
    hand(forged("{\"tissues\":" + std::string(200'000, '[') + std::string(200'000, ']') + "}", "deeper.h5"), "refused");
    hand(forged("{}", "empty.h5"), "refused");
    hand(written("no session", "text.h5"), "refused");
    hand(written(whole.substr(0, whole.size() / 3), "third.h5"), "refused");
    std::string odd = whole;
    for (std::size_t i = 200; i < odd.size(); i += 997)
        odd[i] = static_cast<char>(odd[i] ^ 0x55);
    hand(written(odd, "odd.h5"), "refused");
    hand(session(), "proven");
    const auto server = serve(0s, 1);
    ASSERT_EQ(push(0)->end(), 0) << logged();
    EXPECT_TRUE(comesTo([&] { return books().progress("arrival").done == static_cast<std::int64_t>(attempts.size()); }))
        << books().progress("arrival").failed << " failed: " << logged();
    for (const auto& [attempt, state] : attempts) {
        const std::vector<school::Score> scores = books().scoresOf(attempt);
        ASSERT_EQ(scores.size(), 1u) << "and not again";
        EXPECT_EQ(scores.back().state, state) << scores.back().reason;
        if (state == "refused") {
            EXPECT_FALSE(scores.back().reason.empty());
        }
    }
    // Looked at, by the one whose they are.
    {
        Books open = books();
        const school::Act act{"server", 1};
        open.rename("s000", "Ida", "ida000", act);
        open.setPassword("s000", school::hashOfPassword(kPassword), act);
    }
    Browser student(address());
    ASSERT_EQ(student.logIn("ida000"), 303);
    for (const auto& [attempt, state] : attempts) {
        EXPECT_EQ(student.get("/attempts/" + attempt)->status, 200);
        std::string page;
        EXPECT_TRUE(comesTo([&] {
            const auto shown = student.get("/attempts/" + attempt + "/review");
            if (!shown) return false;
            page = shown->body;
            return page.find("id=\"again\"") == page.npos;
        }));
    }
    EXPECT_TRUE(server->isRunning());
    EXPECT_LT(statusOf(server->id(), "VmHWM"), kMostServerKb) << "kB";
    EXPECT_THAT(childrenOf(server->id()), testing::IsEmpty()) << "no reader is left";
    EXPECT_EQ(server->terminate(), 0);
}

TEST_P(AttackTest, AReaderThatIsKilledCostsNobodyAnything) {
    const int kills = times("HANDPIECE_KILLS", 3);
    School::furnish(data_, database_);
    furnish(1, 0, 0);
    // Each work may be begun five times.
    std::vector<std::string> attempts;
    for (int i = 0; i < kills / 2 + 2; ++i)
        attempts.push_back(finish(0, session()));
    {
        const auto taker = serve();
        ASSERT_EQ(push(0)->end(), 0) << logged();
        EXPECT_EQ(taker->terminate(), 0);
    }
    const auto server = serve(0s, 1);
    std::set<pid_t> killed;
    for (int i = 0; i < kills; ++i) {
        const bool isFound = comesTo([&] {
            for (const pid_t one : childrenOf(server->id()))
                if (killed.insert(one).second) return ::kill(one, SIGKILL) == 0;
            return books().progress("arrival").done == static_cast<std::int64_t>(attempts.size());
        });
        EXPECT_TRUE(isFound);
        // Not the same work each time.
        std::this_thread::sleep_for(std::chrono::milliseconds(700 + random_() % 2000));
    }
    EXPECT_TRUE(
        comesTo([&] { return books().progress("arrival").done == static_cast<std::int64_t>(attempts.size()); }));
    for (const std::string& one : attempts) {
        ASSERT_EQ(books().scoresOf(one).size(), 1u);
        EXPECT_EQ(books().scoresOf(one).back().state, "proven") << books().scoresOf(one).back().reason;
    }
    EXPECT_GT(killed.size(), 0u);
    EXPECT_EQ(server->terminate(), 0);
}

/// Holds on to the server in one of several ways until it is told to end.
class Hostile {
  public:
    Hostile(int port, unsigned kind) : thread_([this, port, kind] { work(port, kind); }) {}
    ~Hostile() {
        ends_ = true;
        thread_.join();
    }
    Hostile(const Hostile&) = delete;
    Hostile& operator=(const Hostile&) = delete;

  private:
    void work(int port, unsigned kind) {
        while (!ends_) {
            const int line = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
            sockaddr_in from{}, to{};
            from.sin_family = to.sin_family = AF_INET;
            from.sin_addr.s_addr = htonl(INADDR_LOOPBACK + 1 + kind % 3);  // three machines
            to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
            to.sin_port = htons(static_cast<std::uint16_t>(port));
            const timeval patience{1, 0};
            setsockopt(line, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
            if (bind(line, reinterpret_cast<const sockaddr*>(&from), sizeof from) == 0 &&
                connect(line, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0)
                hold(line, kind);
            close(line);
            std::this_thread::sleep_for(20ms);
        }
    }
    void hold(int line, unsigned kind) {
        const auto says = [&](const std::string& text) {
            return send(line, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
        };
        const auto waits = [&](std::chrono::milliseconds ms) {
            for (; ms > 0ms && !ends_; ms -= 50ms)
                std::this_thread::sleep_for(50ms);
            return !ends_;
        };
        const auto hears = [&] {
            char some[4096];
            while (recv(line, some, sizeof some, 0) > 0) {
            }
        };
        switch (kind % 7) {
            case 0:  // a byte a second
                for (const char c :
                     std::string("GET /healthz HTTP/1.1\r\nHost: a\r\nX: aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"))
                    if (!says(std::string(1, c)) || !waits(1s)) return;
                return;
            case 1:  // nothing
                (void)waits(15s);
                return;
            case 2:  // a head without end
                if (!says("GET /login HTTP/1.1\r\nHost: a\r\n")) return;
                while (says("X-Y: " + std::string(2000, 'z') + "\r\n") && waits(50ms)) {
                }
                return;
            case 3:  // a body that never comes
                if (says("POST /login HTTP/1.1\r\nHost: a\r\nContent-Length: 100000\r\n\r\nlogin=")) (void)waits(15s);
                return;
            case 4: {  // brackets
                const std::string deep(100'000, '[');
                if (says(fmt::format(
                             "POST /api/v1/enrol HTTP/1.1\r\nHost: a\r\nHandpiece-Protocol: 1\r\nConnection: close\r\n"
                             "Content-Length: {}\r\n\r\n",
                             deep.size()) +
                         deep))
                    hears();
                (void)waits(300ms);
                return;
            }
            case 5:  // said to be packed, in pieces without end
                if (says("POST /login HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\nContent-Encoding: "
                         "gzip\r\n\r\n"))
                    while (says("1000\r\n" + std::string(0x1000, 'x') + "\r\n") && waits(50ms)) {
                    }
                return;
            default:  // guesses, and launches that nobody sent
                if (says("GET /lti/login?iss=a&login_hint=b&target_link_uri=c HTTP/1.1\r\nHost: a\r\nConnection: "
                         "close\r\n\r\n"))
                    hears();
                (void)waits(300ms);
        }
    }

    std::atomic<bool> ends_{false};
    std::thread thread_;
};

TEST_P(AttackTest, ThirtyStationsWorkBesideTwoHundredHostileClients) {
    if (isPostgres() && !std::getenv("HANDPIECE_KILLS"))
        GTEST_SKIP() << "the door is the same for both databases: HANDPIECE_KILLS=1 holds it before this one, too";
    constexpr std::size_t kStations = 30, kHostile = 200;
    furnish(kStations, 1, 400'000);
    const auto server = serve();
    const auto pushed = [&] {
        const auto began = std::chrono::steady_clock::now();
        std::vector<std::unique_ptr<Program>> all;
        for (std::size_t i = 0; i < kStations; ++i)
            all.push_back(push(i));
        for (auto& one : all)
            EXPECT_EQ(one->end(), 0) << logged();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    };
    const double quietS = pushed();
    for (std::size_t i = 0; i < kStations; ++i)
        (void)work(*chairs_[i], 400'000);
    const std::size_t audited = books().audit(0, 100'000).size();
    double hostileS = 0.0;
    {
        std::vector<std::unique_ptr<Hostile>> hostile;
        for (unsigned i = 0; i < kHostile; ++i)
            hostile.push_back(std::make_unique<Hostile>(port_, i));
        std::this_thread::sleep_for(3s);
        hostileS = pushed();
    }
    std::printf("thirty stations pushed in %.1f s, beside %zu hostile clients in %.1f s; server %zu MB\n", quietS,
                kHostile, hostileS, statusOf(server->id(), "VmHWM") / 1000);
    EXPECT_LT(statusOf(server->id(), "VmHWM"), kMostServerKb) << "kB";
    EXPECT_LE(books().audit(0, 100'000).size(), audited + 2 * kStations) << "strangers write nothing";
    EXPECT_TRUE(server->isRunning());
    EXPECT_EQ(server->terminate(), 0);
    expectAllOnce();
}

}  // namespace
}  // namespace handpiece::school_server::attack_test
