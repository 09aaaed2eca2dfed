// SPDX-License-Identifier: Apache-2.0
#include "support/realtime_trap.h"

#include <cerrno>
#include <cstddef>

#if defined(HANDPIECE_SANITIZED) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TRAP_ACTIVE 0
#else
#define TRAP_ACTIVE 1
#endif

#if TRAP_ACTIVE
#include <dlfcn.h>
#include <execinfo.h>
#include <pthread.h>
#include <semaphore.h>
#include <time.h>
#include <unistd.h>

#include <cstdarg>
#include <cstdio>
#endif

namespace handpiece::test {
namespace {

// initial-exec: a thread-local read inside malloc must not itself allocate.
struct Counters {
    int armed;
    bool reporting;
    std::uint64_t allocations, locks, waits;
};
thread_local constinit Counters counters __attribute__((tls_model("initial-exec"))) = {};

#if TRAP_ACTIVE
void caught(std::uint64_t Counters::*which, const char* what) {
    if (counters.armed == 0 || counters.reporting) return;
    counters.reporting = true;
    if (counters.allocations + counters.locks + counters.waits == 0) {
        void* frames[24];
        const int count = backtrace(frames, 24);
        char line[96];
        const int length = std::snprintf(line, sizeof line, "real-time trap: %s inside the tick\n", what);
        if (length > 0) (void)!::write(2, line, static_cast<std::size_t>(length));
        backtrace_symbols_fd(frames, count, 2);
    }
    ++(counters.*which);
    counters.reporting = false;
}
#endif

}  // namespace

RealtimeTrap::RealtimeTrap()
    : startAllocations_(counters.allocations), startLocks_(counters.locks), startWaits_(counters.waits) {
#if TRAP_ACTIVE
    // The first backtrace() loads libgcc and allocates: have that behind us.
    void* frames[2];
    backtrace(frames, 2);
#endif
    ++counters.armed;
}
RealtimeTrap::~RealtimeTrap() {
    --counters.armed;
}
std::uint64_t RealtimeTrap::allocations() const {
    return counters.allocations - startAllocations_;
}
std::uint64_t RealtimeTrap::locks() const {
    return counters.locks - startLocks_;
}
std::uint64_t RealtimeTrap::waitsAndFiles() const {
    return counters.waits - startWaits_;
}
bool RealtimeTrap::isActive() {
    return TRAP_ACTIVE != 0;
}

}  // namespace handpiece::test

#if TRAP_ACTIVE
using handpiece::test::caught;
using handpiece::test::Counters;

// The process's own malloc and friends: glibc's stay reachable under their internal names.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
    caught(&Counters::allocations, "malloc");
    return __libc_malloc(size);
}
void* calloc(std::size_t n, std::size_t size) {
    caught(&Counters::allocations, "calloc");
    return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t size) {
    caught(&Counters::allocations, "realloc");
    return __libc_realloc(p, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
    caught(&Counters::allocations, "memalign");
    return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
    caught(&Counters::allocations, "aligned_alloc");
    return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
    caught(&Counters::allocations, "posix_memalign");
    *out = __libc_memalign(alignment, size);
    return *out ? 0 : ENOMEM;
}
void free(void* p) {
    if (p) caught(&Counters::allocations, "free");
    __libc_free(p);
}

// Everything else is found behind us with dlsym, once and before any trap is armed.
#define HANDPIECE_WRAP(result, name, which, parameters, arguments)                        \
    result name parameters {                                                              \
        using Function = result(*) parameters;                                            \
        static const Function next = reinterpret_cast<Function>(dlsym(RTLD_NEXT, #name)); \
        caught(&Counters::which, #name);                                                  \
        return next arguments;                                                            \
    }
HANDPIECE_WRAP(int, pthread_mutex_lock, locks, (pthread_mutex_t * m), (m))
HANDPIECE_WRAP(int, pthread_mutex_trylock, locks, (pthread_mutex_t * m), (m))
HANDPIECE_WRAP(int, pthread_rwlock_rdlock, locks, (pthread_rwlock_t * m), (m))
HANDPIECE_WRAP(int, pthread_rwlock_wrlock, locks, (pthread_rwlock_t * m), (m))
HANDPIECE_WRAP(int, pthread_cond_wait, locks, (pthread_cond_t * c, pthread_mutex_t* m), (c, m))
HANDPIECE_WRAP(int, sem_wait, locks, (sem_t * s), (s))
HANDPIECE_WRAP(int, nanosleep, waits, (const timespec* t, timespec* r), (t, r))
HANDPIECE_WRAP(int, clock_nanosleep, waits, (clockid_t c, int f, const timespec* t, timespec* r), (c, f, t, r))
HANDPIECE_WRAP(ssize_t, read, waits, (int fd, void* b, std::size_t n), (fd, b, n))
HANDPIECE_WRAP(ssize_t, write, waits, (int fd, const void* b, std::size_t n), (fd, b, n))
HANDPIECE_WRAP(FILE*, fopen, waits, (const char* p, const char* m), (p, m))
HANDPIECE_WRAP(int, fflush, waits, (FILE * f), (f))
}
#endif
