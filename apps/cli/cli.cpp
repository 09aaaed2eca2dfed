// SPDX-License-Identifier: Apache-2.0
#include "cli/cli.h"

#include "cli/app.h"
#include "cli/commands.h"
#include "cli/school_program.h"
#include "handpiece/app/scan_case/textures.h"

namespace handpiece::cli {

int run(int argc, const char* const* argv, const MethodRegistry& extraMethods, const LawRegistry& extraLaws) {
    if (isForSchool(argc, argv)) return runSchoolProgram(argc, argv);
    App app{"handpiece", "An open dental surgery simulator", {}, {}};
    app.addCommands = [&](Command& top) {
        addMakeCommand(top);
        addMeshCommand(top);
        addCaseCommand(top);
        addScanCommand(top);
        addProbeCommand(top, extraMethods);
        addRunCommand(top, extraMethods);
        addDeviceCommand(top);
        addReplayCommand(top);
        addExportCommand(top);
        addReportCommand(top);
        addPictureCommand(top);
        addXrayCommand(top);
        addExerciseCommand(top);
        addRubricCommand(top);
        addScoreCommand(top);
        addRescoreCommand(top);
        addAgreeCommand(top);
        addSchoolCommands(top);
        addReproduceCommand(top);
        addBenchCommand(top);
        addPassivityCommand(top);
    };
    app.begin = [&] {
        scan_case::readTextures();
        for (const auto& [name, make] : extraLaws)
            force::addLaw(name, make);
    };
    return runApp(argc, argv, app);
}

}  // namespace handpiece::cli
