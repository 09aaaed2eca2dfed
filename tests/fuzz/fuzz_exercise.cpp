// SPDX-License-Identifier: Apache-2.0
// Any text as exercise.toml, beside a block with a fissure, contacts, a horn, an orifice and a junction, must give a
// task that is written, read and written again as the same bytes and has the same hash, also as a teacher's draft, and
// lies on the block with the draft's handles or tells why not; or one core::Error.
#include <unistd.h>

#include <cmath>

#include "fuzz_block.h"
#include "handpiece/assess/draft/draft.h"
#include "handpiece/assess/draft/handles.h"
#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/file.h"

namespace fs = std::filesystem;
using namespace handpiece;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // What is written to a disk that is memory takes no time.
    static const fs::path folder = [] {
        const fs::path made = fs::path("/dev/shm") / ("fuzz_exercise." + std::to_string(getpid()));
        tasks::Task task;
        task.id = "fuzz";
        task.toothCase = fuzz::block();
        tasks::writeTask(task, made / "in");
        return made;
    }();
    core::writeFile(folder / "in" / tasks::kTaskFile, std::as_bytes(std::span(data, size)), {false, false});
    return fuzz::readText(data, size, [](std::string_view) {
        const tasks::Task read = tasks::readTask(folder / "in");
        tasks::writeTask(read, folder / "once");
        const tasks::Task again = fuzz::mustRead([] { return tasks::readTask(folder / "once"); });
        tasks::writeTask(again, folder / "twice");
        const auto textIn = [](const char* name) { return core::readFile(folder / name / tasks::kTaskFile); };
        if (textIn("once") != textIn("twice")) __builtin_trap();
        if (tasks::contentHash(read) != tasks::contentHash(again)) __builtin_trap();
        // The same as a teacher's draft.
        const draft::Content content = draft::contentOf(read);
        if (tasks::contentHash(draft::taskOf(content)) != tasks::contentHash(read)) __builtin_trap();
        (void)draft::problems(content);
        if (!read.preparation) return;
        const preparation::Laid laid = preparation::layOn(read.toothCase, *read.preparation);
        if (!laid.draw.allFinite() || !laid.zones->box().min.allFinite() || !laid.zones->box().max.allFinite())
            __builtin_trap();
        for (int i = 0; i <= 8; ++i) {
            const core::Vec3 p(0.1, -0.2, 8.0 - 2.0 * i);
            if (!std::isfinite(laid.zones->targetMm(p))) __builtin_trap();
            (void)laid.zones->at(p);
        }
        for (const draft::Handle& h : draft::handlesOf(read.toothCase, *read.preparation, laid))
            if (!h.placeMm.allFinite() || !h.way.allFinite() ||
                !std::isfinite(draft::valueOf(h, *read.preparation, 0.3)))
                __builtin_trap();
    });
}
