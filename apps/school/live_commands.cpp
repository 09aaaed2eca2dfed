// SPDX-License-Identifier: Apache-2.0
// A station for as long as its window is open, fed by it; and many of them, to see what a server bears.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "handpiece/base/core/error.h"
#include "school/commands.h"
#include "school/simulated_school.h"
#include "school/station_service.h"

namespace handpiece::school_cli {
namespace {

/// To its end; none at the input's end. What is longer than any that the window writes is none of its.
std::optional<std::string> readLine() {
    constexpr std::size_t kMost = 64 << 10;
    std::string line;
    for (int c = std::getchar(); c != '\n'; c = std::getchar()) {
        if (c == EOF) return {};
        if (line.size() >= kMost) throw core::Error("a line is too long", "standard input", "let the window start it");
        line += static_cast<char>(c);
    }
    return line;
}

/// docs/school-live.md has what it reads and writes.
void runStation(const school_station::StationFolders& folders) {
    school_station::StationService service(folders, [](const school_station::Standing& standing) {
        fmt::print("{}\n", toJson(standing));
        (void)std::fflush(stdout);
    });
    while (const std::optional<std::string> line = readLine()) {
        const auto json = nlohmann::json::parse(*line, nullptr, false);
        const std::string kind = json.is_object() ? json.value("kind", "") : "";
        if (kind == "live") {
            const std::size_t bytes = json.value("bytes", std::size_t{0});
            if (bytes > school_wire::kMostPicture)
                throw core::Error("a picture is too long", "standard input", "let the window start it");
            std::string picture(bytes, '\0');
            if (std::fread(picture.data(), 1, bytes, stdin) != bytes) break;
            service.show(school_wire::liveFrom(school_wire::framed(*line, picture)));
        } else if (kind == "rest") {
            service.rest();
        } else if (kind == "push") {
            service.push();
        } else {
            throw core::Error("a line is none of the window's", "standard input", "let the window start it");
        }
    }
    // The window is gone. What is on its way may be cut off anywhere: it goes on from there next time.
    std::_Exit(0);
}

struct Options {
    std::string home, recordings;
    school_cli::SimulatedSchool simulated;
};

}  // namespace

void addLiveCommands(cli::Command& app) {
    const auto options = std::make_shared<Options>();
    Options& o = *options;
    cli::Command station = app.subcommand("station", "This station at its school, fed by its window over a pipe");
    station.option("--home", o.home, "folder with school.json and results.db").required();
    station.option("--sessions", o.recordings, "folder with recordings; else sessions in --home");
    station.callback([options] {
        const std::filesystem::path home = options->home;
        runStation(
            {home, options->recordings.empty() ? home / "sessions" : std::filesystem::path(options->recordings)});
    });

    cli::Command simulate =
        app.subcommand("simulate", "Stations and browsers at a server of their own, and how late pictures come");
    SimulatedSchool& s = o.simulated;
    simulate.option("--pictures", s.pictures, "folder of JPEG files that stations show in turn").required();
    simulate.option("--sessions", s.sessions, "folder of sessions (.h5) that stations push in turn").required();
    simulate.option("--stations", s.stations, "how many")
        .check(cli::range(std::size_t{1}, std::size_t{500}))
        .showDefault();
    simulate.option("--browsers", s.browsers, "that watch all of them")
        .check(cli::range(std::size_t{0}, std::size_t{100}))
        .showDefault();
    simulate.option("--seconds", s.seconds, "that it runs")
        .check(cli::range(std::size_t{5}, std::size_t{86'400}))
        .showDefault();
    simulate.option("--attempts", s.attempts, "that each station pushes meanwhile")
        .check(cli::range(std::size_t{0}, std::size_t{1000}))
        .showDefault();
    simulate.option("--database", s.database, "postgresql://... of an empty database instead of SQLite");
    simulate.flag("--singly", s.singly, "browsers ask for each picture by itself instead of all in one answer");
    simulate.callback([options] { simulateSchool(options->simulated); });
}

}  // namespace handpiece::school_cli
