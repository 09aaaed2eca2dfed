// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/prctl.h>
#include <linux/seccomp.h>
#include <malloc.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <iterator>

#include "handpiece/base/sandbox/frames.h"

namespace handpiece::sandbox {
namespace {

std::string because(const char* what) {
    return fmt::format("{}: {}", what, std::strerror(errno));
}

std::string limit(const Order& order) {
    const auto set = [](auto which, rlim_t soft, rlim_t hard) {
        const rlimit bound{soft, hard};
        return setrlimit(which, &bound) == 0;
    };
    bool isSet = set(RLIMIT_CPU, order.cpuS, order.cpuS + 5) && set(RLIMIT_FSIZE, 0, 0) && set(RLIMIT_CORE, 0, 0) &&
                 set(RLIMIT_NOFILE, 64, 64);
#ifndef HANDPIECE_SANITIZED  // whose shadow memory is larger than any bound
    isSet = isSet && set(RLIMIT_AS, order.memoryBytes, order.memoryBytes);
#endif
    // Each thread's own heap reserves 64 MB.
    mallopt(M_ARENA_MAX, 4);
    return isSet ? std::string() : because("limits of memory and time");
}

/// Where the machine's memory ends, this goes before who asked; where that cannot be said, it is as it was.
void goFirst() {
    const int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
    if (file < 0) return;
    [[maybe_unused]] const ssize_t n = write(file, "1000", 4);
    close(file);
}

/// All rights of Landlock's versions 1 to 5, of which headers name as many as they are old.
constexpr std::uint64_t kAllRights[] = {(1ull << 13) - 1, (1ull << 14) - 1, (1ull << 15) - 1, (1ull << 15) - 1,
                                        (1ull << 16) - 1};

std::string closeFiles(const Order& order) {
    const long version = syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
    if (version < 1) return because("Landlock (Linux 5.13 or later, not switched off)");
    const std::size_t known = std::min<std::size_t>(static_cast<std::size_t>(version), std::size(kAllRights)) - 1;
    landlock_ruleset_attr rules{};
    rules.handled_access_fs = kAllRights[known];
    const int set = static_cast<int>(syscall(SYS_landlock_create_ruleset, &rules, sizeof rules.handled_access_fs, 0));
    if (set < 0) return because("Landlock");
    const auto allow = [&](const char* path, bool isNeeded) {
        const int at = open(path, O_PATH | O_CLOEXEC);
        if (at < 0) return !isNeeded;
        struct stat what {};
        fstat(at, &what);
        landlock_path_beneath_attr rule{};
        rule.parent_fd = at;
        rule.allowed_access = LANDLOCK_ACCESS_FS_READ_FILE | (S_ISDIR(what.st_mode) ? LANDLOCK_ACCESS_FS_READ_DIR : 0);
        const bool isAllowed = syscall(SYS_landlock_add_rule, set, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
        close(at);
        return isAllowed;
    };
    // Libraries and their data, processors, memory. Nothing of /etc but what the loader and OpenGL look up.
    for (const char* path :
         {"/usr/lib", "/usr/share", "/usr/local/lib", "/lib", "/lib64", "/etc/ld.so.cache", "/etc/glvnd", "/etc/drirc",
          "/sys/devices/system/cpu", "/sys/devices/system/node", "/proc/cpuinfo", "/proc/meminfo"})
        if (!allow(path, false)) return because(path);
    for (const std::string& path : order.readable)
        if (!allow(path.c_str(), true)) return because(path.c_str());
    if (syscall(SYS_landlock_restrict_self, set, 0) != 0) return because("Landlock");
    close(set);
    return {};
}

#if defined(__x86_64__)
constexpr std::uint32_t kArch = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArch = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t kArch = 0;
#endif

/// All that reading, computing and drawing in memory need.
constexpr long kAllowed[] = {SYS_read,
                             SYS_readv,
                             SYS_pread64,
                             SYS_write,
                             SYS_writev,
                             SYS_close,
                             SYS_lseek,
                             SYS_fstat,
                             SYS_newfstatat,
                             SYS_statx,
                             SYS_openat,
                             SYS_faccessat,
                             SYS_faccessat2,
                             SYS_readlinkat,
                             SYS_getdents64,
                             SYS_getcwd,
                             SYS_fcntl,
                             SYS_flock,
                             SYS_fadvise64,
                             SYS_statfs,
                             SYS_fstatfs,
#ifdef SYS_open
                             SYS_open,
                             SYS_stat,
                             SYS_lstat,
                             SYS_access,
                             SYS_readlink,
                             SYS_poll,
                             SYS_arch_prctl,
                             SYS_time,
#endif
                             SYS_mmap,
                             SYS_munmap,
                             SYS_mremap,
                             SYS_mprotect,
                             SYS_madvise,
                             SYS_brk,
                             SYS_futex,
                             SYS_set_robust_list,
                             SYS_get_robust_list,
                             SYS_rseq,
                             SYS_membarrier,
                             SYS_sched_yield,
                             SYS_sched_getaffinity,
                             SYS_getcpu,
                             SYS_sysinfo,
                             SYS_uname,
                             SYS_getpid,
                             SYS_gettid,
                             SYS_getppid,
                             SYS_getuid,
                             SYS_geteuid,
                             SYS_getgid,
                             SYS_getegid,
                             SYS_getrusage,
                             SYS_getrandom,
                             SYS_clock_gettime,
                             SYS_clock_getres,
                             SYS_clock_nanosleep,
                             SYS_nanosleep,
                             SYS_gettimeofday,
                             SYS_times,
                             SYS_rt_sigaction,
                             SYS_rt_sigprocmask,
                             SYS_rt_sigreturn,
                             SYS_sigaltstack,
                             SYS_ppoll,
                             SYS_restart_syscall,
                             SYS_exit,
                             SYS_exit_group};

/// The filter: what is not named is refused with an error, so that a library that only tries goes on without.
class Filter {
  public:
    Filter() {
        add(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, arch));
        // Calls of another processor's numbers, or of x32, mean something else.
        jump(BPF_JEQ, kArch, 1, 0);
        give(SECCOMP_RET_KILL_PROCESS);
        add(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr));
#ifdef __x86_64__
        jump(BPF_JGE, 0x40000000u, 0, 1);
        give(SECCOMP_RET_KILL_PROCESS);
#endif
        for (const long call : kAllowed)
            on(call, SECCOMP_RET_ALLOW);
        // Its flags cannot be looked at; the C library does with the older one then.
        on(SYS_clone3, SECCOMP_RET_ERRNO | ENOSYS);
        on(SYS_ioctl, SECCOMP_RET_ERRNO | ENOTTY);
        onlyIf(SYS_clone, {{0, BPF_JSET, 0x00010000u /* CLONE_THREAD */}});
        onlyIf(SYS_tgkill, {{0, BPF_JEQ, static_cast<std::uint32_t>(getpid())}});
        onlyIf(SYS_prctl, {{0, BPF_JEQ, PR_SET_NAME}});
        // Its own limits are looked up, and none is set.
        onlyIf(SYS_prlimit64, {{0, BPF_JEQ, 0}, {2, BPF_JEQ, 0}, {2, BPF_JEQ, 0, true}});
        give(SECCOMP_RET_ERRNO | EPERM);
    }
    [[nodiscard]] std::string install() {
        const sock_fprog program{static_cast<unsigned short>(lines_.size()), lines_.data()};
        return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0 ? std::string() : because("seccomp");
    }

  private:
    void add(std::uint16_t code, std::uint32_t k, std::uint8_t yes = 0, std::uint8_t no = 0) {
        lines_.push_back({code, yes, no, k});
    }
    void jump(std::uint16_t how, std::uint32_t k, std::uint8_t yes, std::uint8_t no) {
        add(static_cast<std::uint16_t>(BPF_JMP | how | BPF_K), k, yes, no);
    }
    void give(std::uint32_t what) {
        add(BPF_RET | BPF_K, what);
    }
    void on(long call, std::uint32_t what) {
        jump(BPF_JEQ, static_cast<std::uint32_t>(call), 0, 1);
        give(what);
    }
    /// Half of an argument, held against a number.
    struct Condition {
        std::size_t argument;
        std::uint16_t how;
        std::uint32_t number;
        bool isUpper = false;
    };
    void onlyIf(long call, std::initializer_list<Condition> all) {
        const std::size_t at = lines_.size();
        jump(BPF_JEQ, static_cast<std::uint32_t>(call), 0, 0);
        for (const Condition& one : all) {
            add(BPF_LD | BPF_W | BPF_ABS,
                static_cast<std::uint32_t>(offsetof(seccomp_data, args) + one.argument * sizeof(std::uint64_t) +
                                           (one.isUpper ? sizeof(std::uint32_t) : 0)));
            jump(one.how, one.number, 1, 0);
            give(SECCOMP_RET_ERRNO | EPERM);
        }
        give(SECCOMP_RET_ALLOW);
        lines_[at].jf = static_cast<std::uint8_t>(lines_.size() - at - 1);
    }

    std::vector<sock_filter> lines_;
};

/// That it holds, and is not only said to.
std::string tried() {
    if (open("/etc/passwd", O_RDONLY | O_CLOEXEC) >= 0 || open("/", O_RDONLY | O_DIRECTORY | O_CLOEXEC) >= 0)
        return "files outside can be opened still";
    if (open("/tmp/handpiece-sandbox", O_WRONLY | O_CREAT | O_CLOEXEC, 0600) >= 0)
        return "files outside can be written still";
    if (socket(AF_INET, SOCK_STREAM, 0) >= 0) return "the network can be reached still";
    return {};
}

}  // namespace

std::string confine(const Order& order) {
    if (kArch == 0) return "not made for this processor";
    // Who asked decides when it ends, and it never outlives them.
    for (const int one : {SIGTERM, SIGINT, SIGHUP})
        std::signal(one, SIG_IGN);
    if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return because("prctl");
    goFirst();
    if (std::string why = limit(order); !why.empty()) return why;
    if (std::string why = closeFiles(order); !why.empty()) return why;
    if (std::string why = Filter().install(); !why.empty()) return why;
    return tried();
}

}  // namespace handpiece::sandbox
