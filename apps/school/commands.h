// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The commands of handpiece-school: one function each.

#include "cli/command.h"

namespace handpiece::school_cli {

void addServeCommand(cli::Command& app);
/// On the server's machine: code, person, exercise, assign, results.
void addBooksCommands(cli::Command& app);
/// On the server's machine: people import, export, erase.
void addPeopleCommands(cli::Command& app);
/// On the server's machine: backup, restore.
void addBackupCommands(cli::Command& app);
/// On a station: enrol, push, status.
void addStationCommands(cli::Command& app);
/// On a machine that cuts works again for a server elsewhere: worker enrol, worker run.
void addWorkerCommands(cli::Command& app);
/// exam, verify-receipt.
void addExamCommands(cli::Command& app);
/// lti, retention, statements.
void addElsewhereCommands(cli::Command& app);
/// station: a window's own, fed by it; simulate: many stations and browsers at a server of its own.
void addLiveCommands(cli::Command& app);

}  // namespace handpiece::school_cli
