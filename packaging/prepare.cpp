// SPDX-License-Identifier: Apache-2.0
// Makes what the packages bring ready made: handpiece_prepare FOLDER LIST. The teeth that a first start and the first
// exercises open, and their fields, as files in FOLDER, and the list of their SHA-256 that the window is built with as
// the source file LIST. The same bytes from the same sources.
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "handpiece/app/course/first_mouth.h"
#include "handpiece/app/course/shipped_exercises.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/prepared/prepared_files.h"

namespace {

using namespace handpiece;
namespace fs = std::filesystem;

void layOut(const cases::Case& toothCase, double voxelMm) {
    simulation::SimulationSettings settings;
    settings.field = simulation::fieldSettingsAt(voxelMm);
    (void)simulation::makeSimulation(toothCase, std::move(settings), true);
}

void prepare(const fs::path& folder, const fs::path& list) {
    const core::PrivateFolder work;
    // Where a case has no folder of its own: nothing of the one who builds is read, nor left there.
    ::setenv("XDG_CACHE_HOME", work.path().c_str(), 1);
    fs::remove_all(folder);
    fs::create_directories(folder);
    prepared::collectIn(folder);
    std::printf("the first mouth\n");
    layOut(course::firstMouth(work.path()), simulation::SimulationSettings{}.field.voxelMm);
    for (const course::Shipped& shipped : course::shippedExercises()) {
        if (shipped.number == 0) continue;  // of the blocks of the first ones
        std::printf("%s\n", shipped.id.c_str());
        std::fflush(stdout);
        const course::Made made = course::makeShipped(shipped.id, work.path());
        layOut(made.task.toothCase, made.task.voxelMm);
    }
    prepared::collectIn({});
    core::writeFile(list, prepared::listSource(folder));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: handpiece_prepare FOLDER LIST\n");
        return 2;
    }
    try {
        prepare(argv[1], argv[2]);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "handpiece_prepare: %s\n", handpiece::core::asError(error).what());
        return 1;
    }
}
