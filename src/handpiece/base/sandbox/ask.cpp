// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "handpiece/base/core/file.h"
#include "handpiece/base/sandbox/frames.h"
#include "handpiece/base/sandbox/hearing.h"
#include "handpiece/base/sandbox/sandbox.h"

namespace handpiece::sandbox {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

core::Error cannotStart(const std::string& why) {
    return core::Error(fmt::format("nothing from outside is read here: {}", why), "handpiece-sandbox",
                       "give it a kernel with Landlock and seccomp (Linux 5.13 or later), and the whole installation")
        .as("sandbox-start", {why});
}

class Descriptor {
  public:
    explicit Descriptor(int fd = -1) : fd_(fd) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() { shut(); }
    void shut() {
        if (fd_ >= 0) close(fd_);
        fd_ = -1;
    }
    void take(int fd) { shut(), fd_ = fd; }
    [[nodiscard]] int get() const { return fd_; }

  private:
    int fd_;
};

struct Pipe {
    Descriptor out, in;
    Pipe() {
        int both[2];
        if (pipe2(both, O_CLOEXEC) != 0) throw cannotStart(std::strerror(errno));
        out.take(both[0]), in.take(both[1]);
    }
};

Descriptor& filled(Descriptor& file, const std::string& text) {
    file.take(memfd_create("order", MFD_CLOEXEC));
    std::string_view left = text;
    while (!left.empty()) {
        const ssize_t n = write(file.get(), left.data(), left.size());
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) throw cannotStart(std::strerror(errno));
        left.remove_prefix(static_cast<std::size_t>(n));
    }
    if (lseek(file.get(), 0, SEEK_SET) != 0) throw cannotStart(std::strerror(errno));
    return file;
}

/// What of this program's surroundings the child has: nothing that says where anything lies.
std::vector<std::string> surroundings() {
    std::vector<std::string> all = {"LC_ALL=C.UTF-8", "MESA_SHADER_CACHE_DISABLE=true",
                                    "HDF5_PLUGIN_PRELOAD=::", "ASAN_OPTIONS=detect_leaks=0"};
    for (const char* name : {"HANDPIECE_SIMD", "LD_LIBRARY_PATH", "LIBGL_ALWAYS_SOFTWARE"})
        if (const char* value = std::getenv(name)) all.push_back(fmt::format("{}={}", name, value));
    return all;
}

/// One child, gone when this goes.
class Child {
  public:
    Child(const Order& order, const fs::path& program) {
        if (program.empty()) throw cannotStart("its program handpiece-sandbox is not there");
        Descriptor asked;
        filled(asked, order.packed());
        posix_spawn_file_actions_t files;
        posix_spawnattr_t how;
        posix_spawn_file_actions_init(&files), posix_spawnattr_init(&how);
        posix_spawn_file_actions_adddup2(&files, asked.get(), 0);
        posix_spawn_file_actions_adddup2(&files, answers_.in.get(), 1);
        posix_spawn_file_actions_adddup2(&files, complaints_.in.get(), 2);
        posix_spawn_file_actions_addclosefrom_np(&files, 3);
        sigset_t none, usual;
        sigemptyset(&none), sigemptyset(&usual), sigaddset(&usual, SIGPIPE);
        posix_spawnattr_setsigmask(&how, &none), posix_spawnattr_setsigdefault(&how, &usual);
        posix_spawnattr_setflags(&how, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
        std::vector<std::string> around = surroundings();
        std::vector<char*> environment;
        for (std::string& one : around)
            environment.push_back(one.data());
        environment.push_back(nullptr);
        std::string name = program.string();
        char* const arguments[] = {name.data(), nullptr};
        const int error = posix_spawn(&id_, name.c_str(), &files, &how, arguments, environment.data());
        posix_spawn_file_actions_destroy(&files), posix_spawnattr_destroy(&how);
        if (error != 0) id_ = -1;
        if (error != 0) throw cannotStart(std::strerror(error));
        answers_.in.shut(), complaints_.in.shut();
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    ~Child() { (void)end(); }

    struct Ending {
        bool isKnown = false;
        int status = 0;
        rusage used{};
    };
    /// It is killed unless it ends by itself at once.
    Ending end(std::chrono::milliseconds patience = {}) {
        Ending ending;
        if (id_ < 0) return ending;
        const Clock::time_point until = Clock::now() + patience;
        for (;;) {
            const pid_t is = wait4(id_, &ending.status, WNOHANG, &ending.used);
            if (is == id_) ending.isKnown = true;
            if (is == id_ || (is < 0 && errno != EINTR)) break;
            if (Clock::now() >= until) {
                kill(id_, SIGKILL);
                while (wait4(id_, &ending.status, 0, &ending.used) < 0 && errno == EINTR)
                    ;
                break;
            }
            poll(nullptr, 0, 2);
        }
        id_ = -1;
        return ending;
    }
    /// What has come, `most` milliseconds waited for; false where nothing will come any more.
    bool hear(std::string& out, int mostMs) {
        std::array<pollfd, 2> both{pollfd{answers_.out.get(), POLLIN, 0}, pollfd{complaints_.out.get(), POLLIN, 0}};
        if (poll(both.data(), both.size(), mostMs) <= 0) return true;
        if (both[1].revents != 0) hearComplaints();
        if (both[0].revents == 0) return true;
        std::array<char, 65'536> some{};
        const ssize_t n = read(answers_.out.get(), some.data(), some.size());
        if (n < 0) return errno == EINTR;
        out.append(some.data(), static_cast<std::size_t>(n));
        return n > 0;
    }
    /// The last of what it said otherwise, on one line of plain letters.
    std::string complaint() {
        while (complaints_.out.get() >= 0) {
            pollfd one{complaints_.out.get(), POLLIN, 0};
            if (poll(&one, 1, 0) <= 0) break;
            hearComplaints();
        }
        std::string text = complaint_;
        for (char& c : text)
            if (c < ' ' || c > '~') c = ' ';
        while (!text.empty() && text.back() == ' ')
            text.pop_back();
        return text;
    }

  private:
    void hearComplaints() {
        std::array<char, 4096> some{};
        const ssize_t n = read(complaints_.out.get(), some.data(), some.size());
        if (n <= 0) return complaints_.out.shut();
        complaint_.append(some.data(), static_cast<std::size_t>(n));
        if (complaint_.size() > 500) complaint_.erase(0, complaint_.size() - 500);
    }

    Pipe answers_, complaints_;
    pid_t id_ = -1;
    std::string complaint_;
};

}  // namespace

fs::path programPath() {
    std::error_code ec;
    const fs::path here = fs::read_symlink("/proc/self/exe", ec).parent_path();
    for (const fs::path& one : {here / "handpiece-sandbox", here.parent_path() / "libexec/handpiece/handpiece-sandbox"})
        if (fs::is_regular_file(one, ec)) return one;
    return {};
}

bool isFault(const core::Error& e) {
    return e.id() != "sandbox-start" && e.id() != "sandbox-killed" && e.problem() != "cancelled";
}

Answer ask(const std::string& request, std::span<const fs::path> readable, const Bounds& bounds,
           const core::Progress& progress, const fs::path& program) {
    Order order;
    order.memoryBytes = bounds.memoryBytes, order.cpuS = static_cast<std::uint64_t>(bounds.cpuS) + 1;
    for (const fs::path& one : readable)
        order.readable.push_back(core::wholePath(one).string());
    order.request = request;
    Child child(order, program);
    Hearing heard(bounds.answerBytes);
    const Clock::time_point until = Clock::now() + std::chrono::milliseconds(static_cast<long>(1e3 * bounds.wallS));
    const core::Error slow = core::Error(fmt::format("it takes longer than the {:.0f} minutes that anybody's work may",
                                                     std::max(bounds.cpuS, bounds.wallS) / 60.0))
                                 .as("sandbox-slow");
    std::string come;
    Clock::time_point told{};
    while (!heard.isWhole && child.hear(come, 100)) {
        heard.hear(come);
        const Clock::time_point now = Clock::now();
        if (now - told > std::chrono::milliseconds(100)) told = now, core::report(progress, heard.progress);
        if (now > until) throw slow;
    }
    using namespace std::chrono_literals;
    const Child::Ending ending = child.end(heard.isWhole ? 100ms : 2s);
    heard.answer.peakBytes = 1024 * static_cast<std::uint64_t>(ending.used.ru_maxrss);
    if (heard.isWhole) return std::move(heard.answer);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    const bool isSignal = ending.isKnown && WIFSIGNALED(ending.status);
    if (!heard.isReady && !(isSignal && WTERMSIG(ending.status) == SIGKILL)) throw cannotStart(child.complaint());
    if (seconds(ending.used.ru_utime) + seconds(ending.used.ru_stime) >= bounds.cpuS) throw slow;
    if (isSignal && WTERMSIG(ending.status) != SIGKILL) {
        const char* name = sigabbrev_np(WTERMSIG(ending.status));
        throw died(fmt::format("SIG{}", name ? name : std::to_string(WTERMSIG(ending.status))));
    }
    if (ending.isKnown && !isSignal) throw died(fmt::format("it ended with {}", WEXITSTATUS(ending.status)));
    throw core::Error("the program that was reading it was ended from outside", "", "it is tried again")
        .as("sandbox-killed");
}

}  // namespace handpiece::sandbox
