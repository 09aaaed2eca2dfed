// SPDX-License-Identifier: Apache-2.0
// Does what it is asked, the first word of the request: what a reader would do that a file has taken over.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <new>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/sandbox/sandbox.h"

extern char** environ;

namespace handpiece {
namespace {

using sandbox::Answer;

std::string said(long result) {
    return result < 0 ? std::string(std::strerror(errno)) : "it went";
}

Answer tried(const std::string& what, const std::string& rest) {
    if (what == "open") return {said(open(rest.c_str(), O_RDONLY | O_CLOEXEC))};
    if (what == "write") return {said(open(rest.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600))};
    if (what == "truncate") return {said(truncate(rest.c_str(), 0))};
    if (what == "remove") return {said(unlink(rest.c_str()))};
    if (what == "rename") return {said(rename(rest.c_str(), (rest + ".other").c_str()))};
    if (what == "link") return {said(symlink("/etc/passwd", rest.c_str()))};
    if (what == "mode") return {said(chmod(rest.c_str(), 0777))};
    if (what == "folder") return {said(mkdir(rest.c_str(), 0700))};
    if (what == "socket") return {said(socket(std::atoi(rest.c_str()), SOCK_STREAM, 0))};
    if (what == "fork") return {said(fork())};
    if (what == "vfork")
        return {said(syscall(SYS_clone, CLONE_VM | CLONE_VFORK | SIGCHLD, nullptr, nullptr, nullptr, nullptr))};
    if (what == "exec") {
        char name[] = "/usr/bin/true";
        char* const arguments[] = {name, nullptr};
        return {said(execve(name, arguments, environ))};
    }
    if (what == "kill") return {said(kill(std::atoi(rest.c_str()), SIGKILL))};
    if (what == "signal") return {said(syscall(SYS_tgkill, std::atoi(rest.c_str()), std::atoi(rest.c_str()), SIGKILL))};
    if (what == "trace") return {said(ptrace(PTRACE_ATTACH, std::atoi(rest.c_str()), nullptr, nullptr))};
    if (what == "memory")
        return {said(syscall(SYS_process_vm_readv, std::atoi(rest.c_str()), nullptr, 0, nullptr, 0, 0))};
    if (what == "limit") {
        const rlimit narrow{1, 1};
        return {said(syscall(SYS_prlimit64, std::atoi(rest.c_str()), RLIMIT_NOFILE, &narrow, nullptr))};
    }
    if (what == "raise") {
        const rlimit wide{RLIM_INFINITY, RLIM_INFINITY};
        return {said(setrlimit(RLIMIT_AS, &wide))};
    }
    if (what == "orphan") return {said(prctl(PR_SET_PDEATHSIG, 0))};
    if (what == "keys") return {said(syscall(SYS_keyctl, 0, -3, 0))};
    if (what == "ring") return {said(syscall(SYS_io_uring_setup, 1, nullptr))};
    if (what == "space") return {said(syscall(SYS_unshare, CLONE_NEWUSER))};
    throw std::logic_error("no such thing to try: " + what);
}

Answer work(const std::string& request, const core::Progress& progress) {
    std::istringstream in(request);
    std::string first, rest;
    in >> first;
    std::getline(in >> std::ws, rest);
    if (first == "echo") return {rest, std::vector<std::byte>(3, std::byte{7})};
    if (first == "read") {
        const std::vector<std::byte> bytes = core::readFile(rest);
        return {std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())};
    }
    if (first == "around") {
        std::string all;
        for (char** one = environ; *one; ++one)
            all += std::string(*one) + "\n";
        for (int fd = 3; fd < 64; ++fd)
            if (fcntl(fd, F_GETFD) >= 0) all += "open " + std::to_string(fd) + "\n";
        return {all};
    }
    if (first == "error")
        throw core::Error("the file is odd", "line 3", "make it even").as("odd", {"a", std::string("b\0\xff", 3)});
    if (first == "pretend") throw core::Error("it was the machine").as(rest);
    if (first == "broken") throw std::runtime_error("a bug");
    if (first == "segv") std::raise(SIGSEGV);
    if (first == "abort") std::abort();
    if (first == "killed") syscall(SYS_tgkill, getpid(), getpid(), SIGKILL);
    if (first == "leave") _exit(0);
    if (first == "spin") {
        std::signal(SIGXCPU, SIG_IGN);
        for (volatile bool on = true; on;) {
        }
    }
    if (first == "sleep") {
        progress(0.25);
        std::this_thread::sleep_for(std::chrono::hours(1));
    }
    if (first == "eat") {
        std::vector<std::vector<char>> all;
        for (;;)
            all.emplace_back(std::size_t{16} << 20, 'x');
    }
    if (first == "recurse") {
        const auto deeper = [](const auto& again, std::size_t n) -> std::size_t {
            volatile char frame[4096];
            frame[n % 4096] = 1;
            return n == 0 ? frame[0] : again(again, n - 1) + static_cast<std::size_t>(frame[1]);
        };
        return {std::to_string(deeper(deeper, std::size_t{1} << 30))};
    }
    if (first == "large") return {std::string(100'000'000, 'x')};
    if (first == "noise") {
        for (int i = 0; i < 100; ++i)
            (void)!write(1, "zzzzzzzzzzzzzzzz", 16);
        _exit(0);
    }
    if (first == "twice") {
        (void)!write(1, "r\0\0\0\0", 5);
        _exit(0);
    }
    if (first == "complain") {
        for (int i = 0; i < 100'000; ++i)
            std::fputs("a line that nobody needs to read, of which there are a great many\n", stderr);
        return {"done"};
    }
    if (first == "threads") {
        std::vector<std::thread> all;
        int sum = 0;
        for (int i = 0; i < 8; ++i)
            all.emplace_back([] {});
        for (std::thread& one : all)
            one.join(), ++sum;
        return {std::to_string(sum)};
    }
    return tried(first, rest);
}

}  // namespace
}  // namespace handpiece

int main() {
    return handpiece::sandbox::serve(handpiece::work);
}
