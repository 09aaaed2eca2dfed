// SPDX-License-Identifier: Apache-2.0
// Any bytes as the store of results must open and tell what is in it, or one core::Error; what opens can be added to,
// or one core::Error. The file is one in memory.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <string>

#include "fuzz_model.h"
#include "handpiece/school/store/store.h"

namespace school = handpiece::school;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string folder = "/dev/shm/fuzz_store." + std::to_string(getpid());
    const std::string file = folder + "/results.db";
    std::filesystem::create_directories(folder);
    std::filesystem::remove(file);
    std::filesystem::remove(file + "-journal");
    std::filesystem::remove(file + "-wal");
    std::filesystem::remove(file + "-shm");
    if (std::FILE* out = std::fopen(file.c_str(), "wb")) {
        if (std::fwrite(data, 1, size, out) != size) __builtin_trap();
        std::fclose(out);
    }
    try {
        school::Store store(file, std::chrono::milliseconds(0));
        for (const school::Attempt& attempt : store.attempts()) {
            (void)attempt.percent();
            (void)store.judgementOf(attempt.id);
            (void)store.commentsOn(attempt.id);
        }
        (void)store.exercises();
        (void)store.outbox(0);
        school::Attempt mine;
        mine.id = "fuzz";
        mine.passed = "yes";
        store.see({"fuzz", 1, "hash", "title", 1, 1});
        store.add(mine);
        if (!store.attempt("fuzz")) __builtin_trap();
    } catch (const handpiece::core::Error& e) {
        if (e.problem().empty()) __builtin_trap();
    }
    return 0;
}
