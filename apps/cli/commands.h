// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One function a command: adds its options to the app; its callback does the work and throws core::Error on failure.

#include "cli/cli.h"

namespace CLI {
class App;
}

namespace handpiece::cli {

void addMakeCommand(CLI::App& app);
void addMakeScanCommand(CLI::App& make);
void addMeshCommand(CLI::App& app);
void addCaseCommand(CLI::App& app);
void addProbeCommand(CLI::App& app, const MethodRegistry& methods);
void addRunCommand(CLI::App& app, const MethodRegistry& methods);
void addReplayCommand(CLI::App& app);
void addExportCommand(CLI::App& app);
void addReportCommand(CLI::App& app);
void addReproduceCommand(CLI::App& app);
void addBenchCommand(CLI::App& app);
void addPassivityCommand(CLI::App& app);
void addDeviceCommand(CLI::App& app);
void addPictureCommand(CLI::App& app);
void addScanCommand(CLI::App& app);

}  // namespace handpiece::cli
