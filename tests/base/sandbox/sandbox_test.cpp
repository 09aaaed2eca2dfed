// SPDX-License-Identifier: Apache-2.0
// A program that reads strangers' files can do nothing else, whatever they make of it.
#include "handpiece/base/sandbox/sandbox.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "handpiece/base/core/file.h"
#include "support/error_of.h"

namespace handpiece::sandbox::sandbox_test {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

const fs::path kChild = HANDPIECE_SANDBOX_CHILD;

Answer asked(const std::string& request, const std::vector<fs::path>& readable = {}, const Bounds& bounds = {}) {
    return ask(request, readable, bounds, {}, kChild);
}
std::string idOf(const std::string& request, const Bounds& bounds = {}) {
    try {
        (void)asked(request, {}, bounds);
        return "";
    } catch (const core::Error& e) {
        return e.id() + (isFault(e) ? "" : ", no fault");
    }
}

class Sandbox : public testing::Test {
  protected:
    fs::path written(const char* name, const std::string& text) {
        const fs::path file = folder_.path() / name;
        std::ofstream(file) << text;
        return file;
    }
    core::PrivateFolder folder_;
};

TEST_F(Sandbox, AnswersAndTellsHowFarItIs) {
    const Answer answer = asked("echo hello there");
    EXPECT_EQ(answer.text, "hello there");
    EXPECT_EQ(answer.bytes, std::vector<std::byte>(3, std::byte{7}));
    EXPECT_GT(answer.peakBytes, 500'000u);
    EXPECT_EQ(asked("threads").text, "8");
    // What it says besides is taken, and not kept.
    EXPECT_EQ(asked("complain").text, "done");
}

TEST_F(Sandbox, ItsErrorsAreItsOwn) {
    try {
        (void)asked("error");
        FAIL();
    } catch (const core::Error& e) {
        EXPECT_EQ(e.id(), "odd");
        EXPECT_EQ(e.problem(), "the file is odd");
        EXPECT_EQ(e.where(), "line 3");
        EXPECT_EQ(e.remedy(), "make it even");
        // Text that a page and a database take, whatever it was.
        EXPECT_THAT(e.arguments(), testing::ElementsAre("a", "b ?"));
        EXPECT_TRUE(isFault(e));
    }
    EXPECT_EQ(idOf("broken"), "");
    // It cannot say that it was the machine, nor that somebody wanted it to stop.
    for (const char* id : {"sandbox-start", "sandbox-killed", "cancelled"})
        EXPECT_EQ(idOf(std::string("pretend ") + id), "sandbox-died") << id;
}

TEST_F(Sandbox, OpensWhatItIsGivenAndNothingElse) {
    const fs::path given = written("given", "text"), other = written("other", "secret");
    EXPECT_EQ(asked("read " + given.string(), {given}).text, "text");
    EXPECT_EQ(asked("open " + given.string(), {given}).text, "it went");
    for (const std::string& path :
         {other.string(), std::string("/etc/passwd"), std::string("/"), std::string("/tmp"), folder_.path().string(),
          std::string("/proc/self/environ"), std::string("/proc/1/environ"),
          "/proc/" + std::to_string(getpid()) + "/maps", std::string("/dev/null"), std::string("/proc/self/mem")})
        EXPECT_EQ(asked("open " + path, {given}).text, "Permission denied") << path;
    // Nor through what is given.
    const fs::path link = folder_.path() / "link";
    fs::create_symlink(other, link);
    EXPECT_EQ(asked("open " + link.string(), {given}).text, "Permission denied");
    EXPECT_EQ(asked("open " + link.string(), {link}).text, "it went") << "who asks names what it leads to";
}

TEST_F(Sandbox, ChangesNothing) {
    const fs::path given = written("given", "text");
    for (const std::string what : {"write", "truncate", "remove", "rename", "link", "mode", "folder"})
        for (const fs::path& path : {given, folder_.path() / "new"})
            EXPECT_THAT(asked(what + " " + path.string(), {given}).text,
                        AnyOf("Permission denied", "Operation not permitted"))
                << what << " " << path;
    EXPECT_EQ(asked("read " + given.string(), {given}).text, "text");
}

TEST_F(Sandbox, ReachesNobody) {
    const std::string me = std::to_string(getpid());
    for (const std::string& what : std::vector<std::string>{
             "socket 1", "socket 2", "socket 10", "socket 16", "fork", "vfork", "exec", "kill " + me, "kill -1",
             "signal " + me, "trace " + me, "memory " + me, "limit " + me, "orphan", "keys", "ring", "space"})
        EXPECT_EQ(asked(what).text, "Operation not permitted") << what;
    EXPECT_EQ(asked("raise").text, "Operation not permitted") << "memory";
}

TEST_F(Sandbox, KnowsNothing) {
    ::setenv("HANDPIECE_TEST_SECRET", "hunter2", 1);
    const int open = ::dup(2);  // as a program that forgot to close it on exec
    const std::string around = asked("around").text;
    ::close(open);
    EXPECT_THAT(around, Not(HasSubstr("hunter2")));
    EXPECT_THAT(around, Not(HasSubstr("HOME=")));
    EXPECT_THAT(around, Not(HasSubstr("open ")));
}

TEST_F(Sandbox, WhoPassesItsBoundsEnds) {
    EXPECT_EQ(idOf("eat", {.memoryBytes = 256u << 20}), "sandbox-large");
    EXPECT_EQ(idOf("recurse", {.memoryBytes = 256u << 20}), "sandbox-died");
    EXPECT_EQ(idOf("spin", {.cpuS = 1.0}), "sandbox-slow");
    EXPECT_EQ(idOf("sleep", {.wallS = 0.5}), "sandbox-slow");
    EXPECT_EQ(idOf("large"), "sandbox-died") << "more than an answer may have";
}

TEST_F(Sandbox, AnEndIsTheFilesFaultOrNot) {
    for (const char* how : {"segv", "abort", "leave", "noise", "twice"})
        EXPECT_EQ(idOf(how), "sandbox-died") << how;
    // From within it looks as if from outside: it is tried again, and the books count how often.
    EXPECT_EQ(idOf("killed"), "sandbox-killed, no fault");
    try {
        (void)ask("echo", {}, {}, {}, "/usr/bin/false");
        FAIL();
    } catch (const core::Error& e) {
        EXPECT_EQ(e.id(), "sandbox-start");
        EXPECT_FALSE(isFault(e));
    }
    for (const fs::path& program : {fs::path(), fs::path("/nonexistent")})
        EXPECT_EQ(test::errorOf([&] { (void)ask("echo", {}, {}, {}, program); }).substr(0, 17), "handpiece-sandbox");
}

TEST_F(Sandbox, StopsWhenAskedAndLeavesNobodyBehind) {
    const auto began = std::chrono::steady_clock::now();
    double heard = 0.0;
    try {
        (void)ask(
            "sleep", {}, {}, [&](double fraction) { return (heard = fraction) < 0.2; }, kChild);
        FAIL();
    } catch (const core::Error& e) {
        EXPECT_EQ(e.problem(), "cancelled");
        EXPECT_FALSE(isFault(e));
    }
    EXPECT_EQ(heard, 0.25);
    EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20));
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "no child is left";
}

TEST_F(Sandbox, EndsWithWhoAsked) {
    int lines[2];
    ASSERT_EQ(::pipe(lines), 0);
    const pid_t asker = ::fork();
    if (asker == 0) {
        ::close(lines[0]);
        // The child says nothing of its number: this one's children are looked up by who waits.
        try {
            (void)ask(
                "sleep", {}, {}, [&](double f) { return f < 0.2 || ::write(lines[1], "s", 1) == 1; }, kChild);
        } catch (...) {
        }
        ::_exit(0);
    }
    ::close(lines[1]);
    char one = 0;
    ASSERT_EQ(::read(lines[0], &one, 1), 1);
    std::string child;
    std::ifstream("/proc/" + std::to_string(asker) + "/task/" + std::to_string(asker) + "/children") >> child;
    ASSERT_FALSE(child.empty());
    ::kill(asker, SIGKILL);
    ::waitpid(asker, nullptr, 0);
    ::close(lines[0]);
    bool isGone = false;
    for (int i = 0; i < 500 && !isGone; ++i) {
        std::string state = "gone";
        std::ifstream stat("/proc/" + child + "/stat");
        std::string number, name;
        stat >> number >> name >> state;
        isGone = state == "gone" || state == "Z";
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_TRUE(isGone);
}

}  // namespace
}  // namespace handpiece::sandbox::sandbox_test
