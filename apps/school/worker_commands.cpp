// SPDX-License-Identifier: Apache-2.0
// A machine that cuts works again for a school's server elsewhere, over the server's own protocol.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
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
                          "say --again to enrol it anew; the key of before holds until the office revokes it");
    core::prepareOutputFolder(o.home, true);
    std::filesystem::permissions(o.home, std::filesystem::perms::owner_all);
    school_station::writeEnrolment(school_station::enrol(o.server, o.code, "", "worker"), file);
    fmt::print("enrolled; now: handpiece school worker run --home {}\n", o.home);
}

school_station::Enrolment enrolmentOf(const WorkerOptions& o) {
    try {
        return school_station::readEnrolment(enrolmentIn(o));
    } catch (const core::Error& e) {
        throw core::Error(e.id() == "not-enrolled" ? "this machine works for no school yet" : e.problem(), e.where(),
                          fmt::format("enrol it: handpiece school worker enrol SERVER CODE{} --home {}",
                                      e.id() == "not-enrolled" ? "" : " --again", o.home))
            .as(e.id());
    }
}

/// One at a time works from a folder: what lies in it is its own.
class OnlyHere {
  public:
    explicit OnlyHere(const std::filesystem::path& folder)
        : file_(open((folder / "running").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600)) {
        if (file_ >= 0 && flock(file_, LOCK_EX | LOCK_NB) == 0) return;
        if (file_ >= 0) close(file_);
        throw core::Error("another worker runs from this folder", folder.string(),
                          "one is enough: it takes --workers; or give another --home")
            .as("not-writable", {folder.string()});
    }
    ~OnlyHere() { close(file_); }
    OnlyHere(const OnlyHere&) = delete;
    OnlyHere& operator=(const OnlyHere&) = delete;

  private:
    const int file_;
};

void run(const WorkerOptions& o) {
    std::atomic<bool> ended{false};
    listenForEnd();
    const school_station::Enrolment enrolment = enrolmentOf(o);
    const OnlyHere only(o.home);
    const std::filesystem::path works = std::filesystem::path(o.home) / "works";
    std::error_code none;  // what one that was killed left
    std::filesystem::remove_all(works, none);
    core::prepareOutputFolder(works, true);
    std::mutex guard;
    std::optional<core::Error> refused;
    std::vector<std::unique_ptr<school_server::Worker>> workers;
    for (std::size_t i = 0; i < o.workers; ++i) {
        workers.push_back(
            std::make_unique<school_server::Worker>(school_server::worksOf(enrolment, works), std::chrono::seconds(2)));
        workers.back()->onRefused([&](const core::Error& e) {
            const std::lock_guard held(guard);
            refused = e;
            ended = true;
        });
        workers.back()->start();
    }
    tellManager("READY=1");
    fmt::print("works for {} (Ctrl-C ends it)\n", enrolment.server);
    (void)std::fflush(stdout);
    waitForEnd(ended);
    tellManager("STOPPING=1");
    for (const auto& one : workers)
        one->stop();
    if (refused)
        throw core::Error("the server takes no work of this machine: " + refused->problem(), enrolment.server,
                          "have a new code made (handpiece school code --worker), then: handpiece school worker enrol "
                          "SERVER CODE --again --home " +
                              o.home)
            .as(refused->id(), refused->arguments());
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
