// SPDX-License-Identifier: Apache-2.0
// The real rtkit-daemon on a real system bus of the test's own. Who may have what is asked of PolicyKit: that answers
// as the test says.
#include <dbus/dbus.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "support/random.h"

extern char** environ;

namespace handpiece::rt::realtime_kit_test {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

constexpr const char* kDaemon = "/usr/libexec/rtkit-daemon";

class Process {
  public:
    Process(std::vector<std::string> words, const fs::path& output) {
        std::vector<char*> arguments;
        for (std::string& word : words)
            arguments.push_back(word.data());
        arguments.push_back(nullptr);
        posix_spawn_file_actions_t files;
        posix_spawn_file_actions_init(&files);
        posix_spawn_file_actions_addopen(&files, 1, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        posix_spawn_file_actions_adddup2(&files, 1, 2);
        if (posix_spawnp(&id_, arguments[0], &files, nullptr, arguments.data(), environ) != 0) id_ = -1;
        posix_spawn_file_actions_destroy(&files);
    }
    ~Process() {
        if (id_ > 0) kill(id_, SIGKILL);
        (void)wait();
    }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;
    int wait() {
        int status = -1;
        if (id_ > 0) waitpid(id_, &status, 0);
        id_ = -1;
        return status;
    }

  private:
    pid_t id_ = -1;
};

/// A service on the bus: `answer` makes the reply to a call, or nullptr for silence.
class Service {
  public:
    using Answer = std::function<DBusMessage*(DBusMessage*)>;
    Service(const std::string& address, const char* name, Answer answer) : answer_(std::move(answer)) {
        connection_ = dbus_connection_open_private(address.c_str(), nullptr);
        if (connection_ == nullptr || !dbus_bus_register(connection_, nullptr) ||
            dbus_bus_request_name(connection_, name, 0, nullptr) != DBUS_REQUEST_NAME_REPLY_PRIMARY_OWNER)
            throw std::runtime_error(std::string("no service ") + name);
        dbus_connection_set_exit_on_disconnect(connection_, FALSE);
        thread_ = std::jthread([this](const std::stop_token& stop) {
            while (!stop.stop_requested() && dbus_connection_read_write(connection_, 20))
                while (DBusMessage* call = dbus_connection_pop_message(connection_)) {
                    DBusMessage* reply =
                        dbus_message_get_type(call) == DBUS_MESSAGE_TYPE_METHOD_CALL ? answer_(call) : nullptr;
                    if (reply != nullptr) {
                        dbus_connection_send(connection_, reply, nullptr);
                        dbus_message_unref(reply);
                    }
                    dbus_message_unref(call);
                }
        });
    }
    ~Service() {
        thread_ = {};
        dbus_connection_close(connection_);
        dbus_connection_unref(connection_);
    }
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;

  private:
    DBusConnection* connection_ = nullptr;
    Answer answer_;
    std::jthread thread_;
};

/// PolicyKit's answer: authorised or not, no challenge, no details.
DBusMessage* authorization(DBusMessage* call, bool granted) {
    DBusMessage* reply = dbus_message_new_method_return(call);
    DBusMessageIter all, result, details;
    const dbus_bool_t yes = granted, no = FALSE;
    dbus_message_iter_init_append(reply, &all);
    dbus_message_iter_open_container(&all, DBUS_TYPE_STRUCT, nullptr, &result);
    dbus_message_iter_append_basic(&result, DBUS_TYPE_BOOLEAN, &yes);
    dbus_message_iter_append_basic(&result, DBUS_TYPE_BOOLEAN, &no);
    dbus_message_iter_open_container(&result, DBUS_TYPE_ARRAY, "{ss}", &details);
    dbus_message_iter_close_container(&result, &details);
    dbus_message_iter_close_container(&all, &result);
    return reply;
}

/// The action asked about: (subject kind, details), action, ...
std::string actionOf(DBusMessage* call) {
    DBusMessageIter at;
    const char* action = "";
    if (dbus_message_iter_init(call, &at) && dbus_message_iter_next(&at) &&
        dbus_message_iter_get_arg_type(&at) == DBUS_TYPE_STRING)
        dbus_message_iter_get_basic(&at, &action);
    return action;
}

struct Granted {
    std::string scheduling, line;
    int policy = -1, priority = -1, nice = 99;
    double seconds = 0.0;
};

class RealtimeKit : public testing::Test {
  protected:
    void SetUp() override {
        chmod(folder_.path().c_str(), 0755);  // rtkit-daemon is another user
        setenv("DBUS_SYSTEM_BUS_ADDRESS", address().c_str(), 1);
    }
    void TearDown() override { unsetenv("DBUS_SYSTEM_BUS_ADDRESS"); }
    [[nodiscard]] std::string address() const { return "unix:path=" + (folder_.path() / "bus").string(); }

    /// False where a bus or, when wanted, rtkit-daemon cannot run; the reason is then in `why_`.
    bool start(bool withDaemon, const std::function<bool(const std::string& action)>& grants = {}) {
        std::ofstream(folder_.path() / "bus.conf")
            << "<!DOCTYPE busconfig PUBLIC \"-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN\" "
               "\"http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd\">\n<busconfig><type>system</"
               "type><listen>"
            << address()
            << "</listen><auth>EXTERNAL</auth><policy context=\"default\"><allow user=\"*\"/><allow own=\"*\"/>"
               "<allow send_destination=\"*\"/><allow receive_sender=\"*\"/></policy></busconfig>\n";
        bus_ = std::make_unique<Process>(
            std::vector<std::string>{"dbus-daemon", "--nofork",
                                     "--config-file=" + (folder_.path() / "bus.conf").string()},
            folder_.path() / "bus.log");
        // Its socket is there before it listens.
        if (!waitFor([&] { return owned("org.freedesktop.DBus"); }))
            return because("dbus-daemon does not run here", "bus.log");
        if (!withDaemon) return true;
        if (!fs::exists(kDaemon)) return because("rtkit-daemon is not installed", "bus.log");
        authority_ = std::make_unique<Service>(address(), "org.freedesktop.PolicyKit1", [grants](DBusMessage* call) {
            return authorization(call, grants(actionOf(call)));
        });
        kit_ = std::make_unique<Process>(std::vector<std::string>{kDaemon}, folder_.path() / "kit.log");
        if (!waitFor([&] { return owned("org.freedesktop.RealtimeKit1"); }))
            return because("rtkit-daemon does not run here", "bus.log");
        return true;
    }

    Granted ask() {
        const auto begun = steady_clock::now();
        EXPECT_EQ(Process({HANDPIECE_GRANTED}, folder_.path() / "granted").wait(), 0);
        Granted g;
        g.seconds = std::chrono::duration<double>(steady_clock::now() - begun).count();
        std::ifstream in(folder_.path() / "granted");
        std::string numbers, word;
        std::getline(in, g.scheduling);
        std::getline(in, numbers);
        std::getline(in, g.line);
        std::istringstream(numbers) >> word >> g.policy >> word >> g.priority >> word >> g.nice;
        return g;
    }
    void expectNothing(const Granted& g, const std::string& reason) {
        EXPECT_EQ(g.scheduling, "normal") << g.line;
        EXPECT_EQ(g.policy, SCHED_OTHER);
        EXPECT_EQ(g.nice, 0);
        EXPECT_NE(g.line.find("RealtimeKit: "), std::string::npos) << g.line;
        EXPECT_NE(g.line.find(reason), std::string::npos) << g.line;
        // libdbus alone would wait 25 s, and this for each of three threads.
        EXPECT_LT(g.seconds, 10.0);
    }

    test::TemporaryFolder folder_;
    std::string why_;

  private:
    static bool waitFor(const std::function<bool()>& done) {
        for (int i = 0; i < 500; ++i) {
            if (done()) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return false;
    }
    bool because(const std::string& what, const char* log) {
        std::ostringstream text;
        text << std::ifstream(folder_.path() / log).rdbuf();
        why_ = what + ": " + text.str();
        return false;
    }
    bool owned(const char* name) {
        DBusConnection* connection = dbus_connection_open_private(address().c_str(), nullptr);
        if (connection == nullptr) return false;
        const bool has = dbus_bus_register(connection, nullptr) && dbus_bus_name_has_owner(connection, name, nullptr);
        dbus_connection_close(connection);
        dbus_connection_unref(connection);
        return has;
    }

    std::unique_ptr<Process> bus_;
    std::unique_ptr<Service> authority_;
    std::unique_ptr<Process> kit_;
};

TEST_F(RealtimeKit, givesRealTimeToAUserWhoHasNone) {
    if (!start(true, [](const std::string&) { return true; })) GTEST_SKIP() << why_;
    const Granted g = ask();
    EXPECT_EQ(g.scheduling, "realtime-kit") << g.line;
    EXPECT_EQ(g.policy, SCHED_RR);
    EXPECT_EQ(g.priority, 15);  // of 20 at most; 85 would have had those
    EXPECT_NE(g.line.find("RealtimeKit"), std::string::npos) << g.line;
}

TEST_F(RealtimeKit, givesAHighPriorityWhereRealTimeIsRefused) {
    if (!start(true, [](const std::string& action) { return action.ends_with("acquire-high-priority"); }))
        GTEST_SKIP() << why_;
    const Granted g = ask();
    EXPECT_EQ(g.scheduling, "high-priority") << g.line;
    EXPECT_EQ(g.policy, SCHED_OTHER);
    EXPECT_EQ(g.nice, -15);
}

TEST_F(RealtimeKit, mayRefuseAltogether) {
    if (!start(true, [](const std::string&) { return false; })) GTEST_SKIP() << why_;
    expectNothing(ask(), "ermi");  // "Operation not permitted", "Permission denied"
}

TEST_F(RealtimeKit, mayNotBeThere) {
    expectNothing(ask(), "");
    if (!start(false)) GTEST_SKIP() << why_;
    expectNothing(ask(), "org.freedesktop.RealtimeKit1");
}

TEST_F(RealtimeKit, mayNeverAnswer) {
    if (!start(false)) GTEST_SKIP() << why_;
    const Service silent(address(), "org.freedesktop.RealtimeKit1", [](DBusMessage*) { return nullptr; });
    expectNothing(ask(), "no answer within 1000 ms");
}

TEST_F(RealtimeKit, mayBeBehindABusThatStands) {
    // It listens and never looks who is there: the first one connects and waits, the next cannot even connect.
    const int bus = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    (folder_.path() / "bus").string().copy(at.sun_path, sizeof at.sun_path - 1);
    ASSERT_EQ(bind(bus, reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
    chmod(at.sun_path, 0666);
    ASSERT_EQ(listen(bus, 0), 0);
    expectNothing(ask(), "no answer within 1000 ms");
    expectNothing(ask(), "no answer within 1000 ms");
    close(bus);
}

}  // namespace
}  // namespace handpiece::rt::realtime_kit_test
