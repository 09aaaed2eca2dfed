// SPDX-License-Identifier: Apache-2.0
// On the server's machine: the school in one file, and back.
#include <fmt/format.h>

#include <memory>

#include "handpiece/base/core/error.h"
#include "handpiece/school/keeping/backup.h"
#include "school/commands.h"
#include "school/school_settings.h"
#include "school/server.h"
#include "studies/progress_bar.h"

namespace handpiece::school_cli {
namespace {

struct BackupOptions {
    std::string data, database, file;
    bool onlyCheck = false, withoutKeys = false;
};

void tell(const school::Backup& backup, const char* what) {
    fmt::print("{}: {} rows, {} files ({:.1f} MB), {} keys\n", what, backup.rows, backup.files,
               1e-6 * static_cast<double>(backup.bytes), backup.keys);
}

}  // namespace

void addBackupCommands(cli::Command& app) {
    const auto options = std::make_shared<BackupOptions>();
    BackupOptions& o = *options;
    const auto books = [&o](cli::Command& command) {
        command.option("--data", o.data, "the server's folder (school)");
        command.option("--database", o.database, "postgresql://... instead of SQLite in the folder");
    };
    cli::Command backup = app.subcommand("backup", "The school in one file, while its server goes on");
    books(backup);
    backup.option("FILE", o.file, "the zip: it has names, passwords' hashes and the server's keys in it").required();
    backup.flag("--without-keys", o.withoutKeys, "leave out the keys by which the server signs (exam.key, lti.pem)");
    backup.callback([options] {
        const BackupOptions& of = *options;
        studies::ProgressBar bar("packing");
        const SchoolSettings place = placeOfBooks(of.data, of.database);
        const school::Backup made = school::backUp(place.data, place.database, of.file, school_server::systemClock()(),
                                                   HANDPIECE_VERSION, !of.withoutKeys, bar.listener());
        bar.finish();
        tell(made, of.file.c_str());
    });
    cli::Command restore = app.subcommand("restore", "A backup into an empty school");
    books(restore);
    restore.option("FILE", o.file, "what backup wrote").required();
    restore.flag("--check", o.onlyCheck, "only read all of it and compare it with its hashes");
    restore.callback([options] {
        const BackupOptions& of = *options;
        studies::ProgressBar bar(of.onlyCheck ? "checking" : "restoring");
        const auto restored = [&] {
            const SchoolSettings place = placeOfBooks(of.data, of.database);
            return school::restore(of.file, place.data, place.database, bar.listener());
        };
        const school::Backup read = of.onlyCheck ? school::checkBackup(of.file, bar.listener()) : restored();
        bar.finish();
        tell(read, of.onlyCheck ? "whole" : "restored");
    });
}

}  // namespace handpiece::school_cli
