// SPDX-License-Identifier: Apache-2.0
#include "school/typed_secret.h"

#include <poll.h>
#include <signal.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdio>

#include "handpiece/base/core/error.h"

namespace handpiece::school_cli {
namespace {

constexpr std::array kEnds = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP};
volatile sig_atomic_t heard = 0;

/// A terminal that shows nothing of what is typed. It shows it again when this ends, also where a signal ends the
/// program: that is let in only then.
class Silence {
  public:
    explicit Silence(int terminal) : terminal_(terminal) {
        if (!isatty(terminal_) || tcgetattr(terminal_, &before_) != 0) return;
        heard = 0;
        struct sigaction note {};
        note.sa_handler = [](int which) { heard = which; };
        sigset_t ends;
        sigemptyset(&ends);
        for (std::size_t i = 0; i < kEnds.size(); ++i) {
            sigaction(kEnds[i], &note, &actions_[i]);
            sigaddset(&ends, kEnds[i]);
        }
        (void)pthread_sigmask(SIG_BLOCK, &ends, &mask_);
        termios silent = before_;
        silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
        silent.c_lflag |= ECHONL;
        isOn_ = true;
        (void)tcsetattr(terminal_, TCSAFLUSH, &silent);
    }
    ~Silence() {
        if (!isOn_) return;
        (void)tcsetattr(terminal_, TCSANOW, &before_);
        for (std::size_t i = 0; i < kEnds.size(); ++i)
            sigaction(kEnds[i], &actions_[i], nullptr);
        (void)pthread_sigmask(SIG_SETMASK, &mask_, nullptr);
        if (heard != 0) (void)raise(heard);
    }
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;
    [[nodiscard]] bool isOn() const { return isOn_; }
    /// For what is typed, and for a signal, which comes nowhere else. False: it came.
    [[nodiscard]] bool waits() const {
        pollfd line{terminal_, POLLIN, 0};
        while (heard == 0)
            if (ppoll(&line, 1, nullptr, &mask_) > 0) return true;
        return false;
    }

  private:
    const int terminal_;
    bool isOn_ = false;
    termios before_{};
    sigset_t mask_{};
    std::array<struct sigaction, kEnds.size()> actions_{};
};

}  // namespace

std::string typedSecret(const char* what) {
    return typedSecret(what, STDIN_FILENO);
}

std::string typedSecret(const char* what, int from) {
    constexpr std::size_t kMost = 4096;
    std::string secret;
    const Silence silence(from);
    if (silence.isOn()) std::fprintf(stderr, "%s: ", what);
    for (char c = 0;;) {
        // Broken off: nobody has the half of it.
        if (silence.isOn() && !silence.waits()) return {};
        // One at a time: what comes after the line is the next one's who reads.
        const ssize_t got = read(from, &c, 1);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0 || c == '\n') break;
        if (secret.size() == kMost)
            throw core::Error("this is too long for a secret", what, "give one line of 4096 bytes at most");
        secret += c;
    }
    return secret;
}

}  // namespace handpiece::school_cli
