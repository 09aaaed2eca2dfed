// SPDX-License-Identifier: Apache-2.0
// Any text as exercise.toml, beside a block with a fissure, contacts, a horn, an orifice and a junction, must give a
// task that is written, read and written again as the same bytes and has the same hash, and lies on the block or tells
// why not; or one core::Error.
#include <unistd.h>

#include <cmath>

#include "fuzz_model.h"
#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/file.h"

namespace fs = std::filesystem;
using namespace handpiece;

namespace {

/// 10 x 9 x 14 mm, of enamel.
cases::Case block() {
    cases::Case made;
    made.name = made.kind = "block";
    made.buccalSign = -1;
    geometry::TriangleMesh& mesh = made.outer;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back({i & 1 ? 5.0 : -5.0, i & 2 ? 4.5 : -4.5, i & 4 ? 7.0 : -7.0});
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    made.parts.push_back({"enamel", cases::Tissue::enamel, 10, mesh});
    using Kind = cases::LandmarkKind;
    made.landmarks = {{Kind::fissure, "central", {{-2.5, 0, 7}, {0, 0.3, 7}, {2.5, 0, 7}}},
                      {Kind::contact, "mesial", {{5, 0, 4}}},
                      {Kind::contact, "distal", {{-5, 0, 4}}},
                      {Kind::pulpHorn, "mesiobuccal", {{1.5, -1.5, 3}}},
                      {Kind::orifice, "mesial", {{1.5, 0, -2}}},
                      {Kind::orifice, "distal", {{-1.5, 0, -2}}},
                      {Kind::cementoEnamelJunction, "", {{5, 4.5, 0}, {-5, 4.5, 0}, {-5, -4.5, 0}, {5, -4.5, 0}}}};
    return made;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // What is written to a disk that is memory takes no time.
    static const fs::path folder = [] {
        const fs::path made = fs::path("/dev/shm") / ("fuzz_exercise." + std::to_string(getpid()));
        tasks::Task task;
        task.id = "fuzz";
        task.toothCase = block();
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
        if (!read.preparation) return;
        const preparation::Laid laid = preparation::layOn(read.toothCase, *read.preparation);
        if (!laid.draw.allFinite() || !laid.zones->box().min.allFinite() || !laid.zones->box().max.allFinite())
            __builtin_trap();
        for (int i = 0; i <= 8; ++i) {
            const core::Vec3 p(0.1, -0.2, 8.0 - 2.0 * i);
            if (!std::isfinite(laid.zones->targetMm(p))) __builtin_trap();
            (void)laid.zones->at(p);
        }
    });
}
