// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One function a command: adds its options to the app; its callback does the work and throws core::Error on failure.

#include "cli/cli.h"
#include "cli/command.h"

namespace handpiece::cli {

void addMakeCommand(Command& app);
void addMakeScanCommand(Command& make);
void addMakeMouthCommand(Command& make);
void addMakeBlockCommand(Command& make);
void addMeshCommand(Command& app);
void addCaseCommand(Command& app);
void addProbeCommand(Command& app, const MethodRegistry& methods);
void addRunCommand(Command& app, const MethodRegistry& methods);
void addReplayCommand(Command& app);
void addExportCommand(Command& app);
void addReportCommand(Command& app);
void addReproduceCommand(Command& app);
void addBenchCommand(Command& app);
void addPassivityCommand(Command& app);
void addDeviceCommand(Command& app);
void addPictureCommand(Command& app);
void addScanCommand(Command& app);
void addXrayCommand(Command& app);
void addExerciseCommand(Command& app);
void addRubricCommand(Command& app);
void addScoreCommand(Command& app);
void addRescoreCommand(Command& app);
void addAgreeCommand(Command& app);
void addSchoolCommands(Command& app);

}  // namespace handpiece::cli
