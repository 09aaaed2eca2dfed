// SPDX-License-Identifier: Apache-2.0
#include "cli/app.h"
#include "school/commands.h"

int main(int argc, char** argv) {
    return handpiece::cli::runApp(
        argc, argv,
        {"handpiece-school", "A school's server, and a station's way to it", [](handpiece::cli::Command& top) {
             handpiece::school_cli::addServeCommand(top);
             handpiece::school_cli::addBooksCommands(top);
             handpiece::school_cli::addPeopleCommands(top);
             handpiece::school_cli::addBackupCommands(top);
             handpiece::school_cli::addStationCommands(top);
             handpiece::school_cli::addWorkerCommands(top);
             handpiece::school_cli::addExamCommands(top);
             handpiece::school_cli::addElsewhereCommands(top);
             handpiece::school_cli::addLiveCommands(top);
         }});
}
