// SPDX-License-Identifier: Apache-2.0
// What is typed as a secret is shown by no terminal, and the terminal is left as it was.
#include "school/typed_secret.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "handpiece/base/core/error.h"

namespace handpiece::school_cli::typed_secret_test {
namespace {

class TypedSecretTest : public testing::Test {
  protected:
    void SetUp() override {
        keyboard_ = posix_openpt(O_RDWR | O_NOCTTY);
        ASSERT_GE(keyboard_, 0);
        ASSERT_EQ(grantpt(keyboard_), 0);
        ASSERT_EQ(unlockpt(keyboard_), 0);
        terminal_ = open(ptsname(keyboard_), O_RDWR | O_NOCTTY);
        ASSERT_GE(terminal_, 0);
        ASSERT_TRUE(shows());
    }
    void TearDown() override {
        close(terminal_);
        close(keyboard_);
    }
    [[nodiscard]] bool shows() const {
        termios how{};
        return tcgetattr(terminal_, &how) == 0 && (how.c_lflag & ECHO) != 0;
    }
    [[nodiscard]] bool comesTo(bool showing) const {
        for (int i = 0; i < 500 && shows() != showing; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        return shows() == showing;
    }
    int keyboard_ = -1, terminal_ = -1;
};

TEST_F(TypedSecretTest, IsNotShown) {
    std::string got;
    std::thread asks([&] { got = typedSecret("password", terminal_); });
    EXPECT_TRUE(comesTo(false));
    EXPECT_EQ(write(keyboard_, "hidden one\n", 11), 11);
    asks.join();
    EXPECT_EQ(got, "hidden one");
    EXPECT_TRUE(shows());
    // The end of the line alone came back.
    fcntl(keyboard_, F_SETFL, O_NONBLOCK);
    char seen[64];
    const ssize_t count = read(keyboard_, seen, sizeof seen);
    EXPECT_EQ(std::string(seen, count > 0 ? static_cast<std::size_t>(count) : 0u), "\r\n");
}

TEST_F(TypedSecretTest, WhoBreaksOffHasTheirTerminalBack) {
    for (const int which : {SIGINT, SIGTERM}) {
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            (void)typedSecret("password", terminal_);
            _exit(0);
        }
        EXPECT_TRUE(comesTo(false));
        kill(child, which);
        int how = 0;
        ASSERT_EQ(waitpid(child, &how, 0), child);
        EXPECT_TRUE(WIFSIGNALED(how));
        EXPECT_EQ(WTERMSIG(how), which);
        EXPECT_TRUE(comesTo(true));
    }
}

TEST(TypedSecret, ComesFromAProgramLineByLine) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    ASSERT_EQ(write(ends[1], "one\ntwo", 7), 7);
    close(ends[1]);
    EXPECT_EQ(typedSecret("password", ends[0]), "one");
    EXPECT_EQ(typedSecret("password", ends[0]), "two");
    EXPECT_EQ(typedSecret("password", ends[0]), "");
    close(ends[0]);
    ASSERT_EQ(pipe(ends), 0);
    const std::string endless(5000, 'x');
    ASSERT_EQ(write(ends[1], endless.data(), endless.size()), 5000);
    close(ends[1]);
    EXPECT_THROW((void)typedSecret("password", ends[0]), core::Error);
    close(ends[0]);
}

}  // namespace
}  // namespace handpiece::school_cli::typed_secret_test
