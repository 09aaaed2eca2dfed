// SPDX-License-Identifier: Apache-2.0
// handpiece replay: cuts a session's tooth again with the hand that was recorded, and compares what is left.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cli/commands.h"
#include "cli/cut_session.h"
#include "cli/progress_bar.h"
#include "cli/station.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/tooth/case_bytes.h"
#include "handpiece/model/tooth/cut_state_file.h"
#include "handpiece/record/session/session_reader.h"
#include "handpiece/tick/device/replay_device.h"

namespace handpiece::cli {
namespace {

struct ReplayOptions {
    std::string session;
    bool json = false, noCache = false;
    std::size_t threads = 0;
};

/// A state of the tooth that the session tells: at its end or, when it was cut off, in its last key frame.
struct Told {
    std::uint64_t tick = 0;
    std::string hash;
};

std::vector<session::Record> allRecords(const session::SessionReader& reader, const std::string& where) {
    std::vector<session::Record> all = reader.records(0, static_cast<std::size_t>(reader.size()));
    if (all.empty()) throw core::Error("the session has no ticks", where, "it ended before the first second was over");
    for (std::size_t i = 1; i < all.size(); ++i) {
        if (all[i].tick - all[i - 1].tick != all[i].elapsedPeriods) {
            throw core::Error(fmt::format("ticks are missing after tick {}: the disk was too slow", all[i - 1].tick),
                              where, "it can be exported, not replayed");
        }
    }
    return all;
}

device::Reading readingOf(const session::Record& record) {
    const session::Inputs in = session::inputsOf(record);
    device::Reading reading;
    reading.burInTooth.positionMm = core::Vec3(in.positionMm[0], in.positionMm[1], in.positionMm[2]);
    reading.burInTooth.orientation =
        core::Quat(in.orientation[0], in.orientation[1], in.orientation[2], in.orientation[3]);
    reading.pedal = in.pedal;
    reading.buttons = in.buttons;
    return reading;
}

std::optional<CutSession::Step> stepOf(const std::string& event) {
    if (event == session::nameOf(session::EventName::undo)) return CutSession::Step::undo;
    if (event == session::nameOf(session::EventName::redo)) return CutSession::Step::redo;
    if (event == session::nameOf(session::EventName::reset)) return CutSession::Step::reset;
    return std::nullopt;
}

std::optional<Told> toldBy(const session::SessionReader& reader, const std::vector<session::Event>& events,
                           const Station& station, std::uint64_t lastTick, const std::string& where) {
    for (auto e = events.rbegin(); e != events.rend(); ++e) {
        if (e->name != session::nameOf(session::EventName::end)) continue;
        const auto end = nlohmann::json::parse(e->text, nullptr, false);
        if (!end.is_object() || !end.contains("state_hash") || !end["state_hash"].is_string())
            throw core::Error("the event that ends the session is damaged", where);
        return Told{e->tick, end["state_hash"].get<std::string>()};
    }
    const auto frame = reader.keyFrameBefore(lastTick);
    if (!frame) return std::nullopt;
    const tooth::CutState state = tooth::decodeState(frame->state, station.identity, *station.tooth, where);
    return Told{frame->tick, hashText(tooth::stateHash(state))};
}

void replay(const ReplayOptions& o) {
    core::setThreadCount(o.threads);
    const session::SessionReader reader(o.session);
    const std::vector<session::Record> records = allRecords(reader, o.session);
    const std::vector<session::Event> events = reader.events();
    const tooth::Case toothCase = tooth::decodeCase(reader.info().tooth, o.session);
    const Station station = makeStation(toothCase, settingsFromJson(reader.info().settings, o.session), !o.noCache);
    if (station.settings.resumed) {
        if (reader.keyFrameTicks().empty())
            throw core::Error("the state that the session began with is missing", o.session, "take another copy");
        station.resume(tooth::decodeState(reader.keyFrame(0).state, station.identity, *station.tooth, o.session));
    }
    const auto told = toldBy(reader, events, station, records.back().tick, o.session);

    std::vector<device::Reading> readings;
    std::transform(records.begin(), records.end(), std::back_inserter(readings), readingOf);
    loop::LoopSettings settings;
    settings.rateHz = station.settings.rateHz;
    loop::HapticLoop loop(settings,
                          std::make_unique<device::ReplayDevice>(station.settings.capability, std::move(readings)),
                          station.work(), station.settings.parameters, station.settings.drive);
    CutSession cutting(station, nullptr, false);
    ProgressBar bar("cutting again");
    const core::Progress progress = bar.listener();
    std::string hash;
    std::uint64_t differs = 0, firstDiffering = 0;
    auto event = events.begin();
    for (std::size_t i = 0; i < records.size(); ++i) {
        for (; event != events.end() && event->tick <= records[i].tick; ++event) {
            const auto step = stepOf(event->name);
            if (step && !cutting.take(*step, loop))
                throw core::Error(fmt::format("{} at tick {} cannot be repeated", event->name, event->tick), o.session);
        }
        rt::Beat beat;
        beat.periods = records[i].elapsedPeriods;
        loop.tick(beat);
        tooth::BrickSnapshot brick;
        while (loop.bricks().tryPop(brick))
            cutting.hear(brick);
        messages::HapticSample sample;
        while (loop.samples().tryPop(sample)) {
            cutting.hear(sample);
            if (session::recordOf(sample) != records[i] && differs++ == 0) firstDiffering = sample.tick;
        }
        if (told && told->tick == records[i].tick) hash = hashText(station.field->stateHash());
        if (i % 256 == 0) core::report(progress, static_cast<double>(i) / static_cast<double>(records.size()));
    }
    bar.finish();
    if (!told || told->tick > records.back().tick) hash = hashText(station.field->stateHash());
    const bool matches = told && hash == told->hash;
    if (o.json) {
        nlohmann::ordered_json out{{"state_hash", hash},         {"recorded_hash", told ? told->hash : ""},
                                   {"matches", matches},         {"ticks", records.size()},
                                   {"differing_ticks", differs}, {"complete", reader.isComplete()}};
        fmt::print("{}\n", out.dump(2));
    } else {
        fmt::print("state_hash {}\nmatches {}\n", hash, matches);
        if (differs > 0) fmt::print("{} ticks differ, the first is {}\n", differs, firstDiffering);
    }
    if (!told) throw core::Error("the session was cut off before it told a state to compare with", o.session);
    if (!matches) throw core::Error("the tooth that was cut again is another", o.session);
}

}  // namespace

void addReplayCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("replay", "Cut a session's tooth again and prove that it is the same");
    const auto options = std::make_shared<ReplayOptions>();
    command->add_option("session", options->session, "session file (.h5)")->required();
    command->add_flag("--json", options->json, "print the result as JSON");
    command->add_flag("--no-cache", options->noCache, "build the fields anew");
    command->add_option("--threads", options->threads, "threads for long work; 0: all cores")
        ->check(CLI::Range(std::size_t{0}, std::size_t{1024}))
        ->capture_default_str();
    command->footer(
        "The session holds the tooth, the bur and the hand. state_hash is that of the cut tooth, bit for bit, at the "
        "session's\nend, or at its last key frame when it was cut off; matches says whether it was the same then.\n"
        "Example:\n  handpiece replay session.h5 --json");
    command->callback([options] { replay(*options); });
}

}  // namespace handpiece::cli
