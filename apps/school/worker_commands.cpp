// SPDX-License-Identifier: Apache-2.0
// A machine that cuts works again for a school's server elsewhere, over the server's own protocol.
#include <fmt/format.h>

#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "school/commands.h"
#include "school/remote_work.h"
#include "school/school_settings.h"
#include "school/service_manager.h"
#include "school/worker.h"

namespace handpiece::school_cli {
namespace {

struct WorkerOptions {
    std::string home = "/var/lib/handpiece-worker", server, code;
    std::size_t workers = 1;
    bool again = false;
};

std::filesystem::path enrolmentIn(const WorkerOptions& o) {
    return std::filesystem::path(o.home) / "worker.json";
}

void enrol(const WorkerOptions& o) {
    const std::filesystem::path file = enrolmentIn(o);
    if (core::isThere(file) && !o.again)
        throw core::Error("this machine works for a school already", file.string(),
                          "say --again to enrol it anew; it has one key");
    core::prepareOutputFolder(o.home, true);
    school_station::writeEnrolment(school_station::enrol(o.server, o.code, "", "worker"), file);
    fmt::print("enrolled; now: handpiece school worker run --home {}\n", o.home);
}

void run(const WorkerOptions& o) {
    std::atomic<bool> ended{false};
    listenForEnd();
    const school_station::Enrolment enrolment = school_station::readEnrolment(enrolmentIn(o));
    std::vector<std::unique_ptr<school_server::Worker>> workers;
    for (std::size_t i = 0; i < o.workers; ++i) {
        workers.push_back(
            std::make_unique<school_server::Worker>(school_server::worksOf(enrolment), std::chrono::seconds(2)));
        workers.back()->start();
    }
    tellManager("READY=1");
    fmt::print("works for {} (Ctrl-C ends it)\n", enrolment.server);
    (void)std::fflush(stdout);
    waitForEnd(ended);
    tellManager("STOPPING=1");
    for (const auto& one : workers)
        one->stop();
}

}  // namespace

void addWorkerCommands(cli::Command& app) {
    const auto options = std::make_shared<WorkerOptions>();
    WorkerOptions& o = *options;
    cli::Command top = app.subcommand("worker", "A machine that cuts works again for a server elsewhere");
    top.requireSubcommand();
    const auto home = [&o](cli::Command& command) {
        command.option("--home", o.home, "its folder, which nobody else reads").showDefault();
    };
    cli::Command enrols = top.subcommand("enrol", "This machine may cut works of a school again");
    home(enrols);
    enrols.option("SERVER", o.server, "its address, as https://school.example:8620").required();
    enrols.option("CODE", o.code, "a one-time code: handpiece school code --worker").required();
    enrols.flag("--again", o.again, "in the place of what it was enrolled as before");
    enrols.callback([options] { enrol(*options); });

    cli::Command runs = top.subcommand("run", "Cuts again what waits at the server, until it is ended");
    home(runs);
    runs.option("--workers", o.workers, "works at once").check(cli::range(std::size_t{1}, kMostWorkers)).showDefault();
    runs.callback([options] { run(*options); });
}

}  // namespace handpiece::school_cli
