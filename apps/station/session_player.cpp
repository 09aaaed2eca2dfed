// SPDX-License-Identifier: Apache-2.0
#include "station/session_player.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "handpiece/base/core/error.h"
#include "handpiece/model/tooth/case_bytes.h"
#include "handpiece/model/tooth/cut_state_file.h"
#include "handpiece/tick/device/replay_device.h"
#include "handpiece/tick/force/pose_guard.h"
#include "station/cut_session.h"
#include "station/history_bytes.h"

namespace handpiece::station {
namespace {

using session::Event;
using session::EventName;
using session::Record;

constexpr std::size_t kStretch = 4096, kReportEvery = 256;
/// The rotor comes to its speed with a third of a second's time constant; the proxy needs less.
constexpr double kRunUpS = 2.0;
/// What is no farther ahead is played, not jumped to: it stays exact.
constexpr double kPlayedAheadS = 2.0;

bool isNamed(const Event& event, EventName name) {
    return event.name == session::nameOf(name);
}

std::optional<CutSession::Step> stepOf(const Event& event) {
    if (isNamed(event, EventName::undo)) return CutSession::Step::undo;
    if (isNamed(event, EventName::redo)) return CutSession::Step::redo;
    if (isNamed(event, EventName::reset)) return CutSession::Step::reset;
    return std::nullopt;
}

std::optional<tooth::CutState> take(history::History& history, CutSession::Step step) {
    return step == CutSession::Step::undo   ? history.undo()
           : step == CutSession::Step::redo ? history.redo()
                                            : history.reset();
}

bool isChange(const Event& event) {
    return isNamed(event, EventName::burChange) || isNamed(event, EventName::parameterChange);
}

device::Reading readingOf(const Record& record) {
    const session::Inputs in = session::inputsOf(record);
    device::Reading reading;
    reading.burInTooth.positionMm = core::Vec3(in.positionMm[0], in.positionMm[1], in.positionMm[2]);
    reading.burInTooth.orientation =
        core::Quat(in.orientation[0], in.orientation[1], in.orientation[2], in.orientation[3]);
    reading.pedal = in.pedal;
    reading.buttons = in.buttons;
    return reading;
}

/// The hand as it was. A device that lost its pose goes on telling the last one: of a tick without a believable pose
/// this finds, as the loop's guard did, whether the pose was lost or had jumped from the last one `believed`.
std::vector<device::Reading> readingsOf(const std::vector<Record>& records, std::optional<core::Vec3>& believed) {
    std::vector<device::Reading> readings;
    readings.reserve(records.size());
    for (const Record& record : records) {
        device::Reading reading = readingOf(record);
        const core::Vec3& place = reading.burInTooth.positionMm;
        if ((record.flags & messages::kInvalidPose) != 0 &&
            !(believed && (place - *believed).norm() > force::kMaxJumpMm))
            reading.status = device::ReadStatus::lost;
        else if (reading.burInTooth.isValid())
            believed = place;
        readings.push_back(reading);
    }
    return readings;
}

/// A state of the tooth that the session tells: at its end or, when it was cut off, in its last key frame.
struct Told {
    std::uint64_t tick = 0;
    std::string hash;
};

}  // namespace

struct SessionPlayer::State {
    State(const std::filesystem::path& path, const Settings& settings, const core::Progress& progress)
        : where(path.string()), reader(path), events(reader.events()), frames(reader.keyFrameTicks()) {
        if (reader.size() == 0)
            throw core::Error("the session has no ticks", where, "it ended before the first second was over")
                .as("session-empty");
        toothCase = tooth::decodeCase(reader.info().tooth, where);
        if (!reader.info().scenery.empty()) toothCase.scenery = tooth::decodeCase(reader.info().scenery, where).parts;
        first = settingsFromJson(reader.info().settings, where);
        if (settings.field) {
            if (first.resumed)
                throw core::Error("this session went on from a tooth that had been cut before", where,
                                  "keep the voxel size, or begin with a whole tooth")
                    .as("voxel-resumed");
            first.field = *settings.field;
            isOtherField = true;
        }
        station = makeStation(toothCase, first, settings.useCache, core::part(progress, 0.0, 0.5));
        if (first.resumed) {
            if (frames.empty())
                throw core::Error("the state that the session began with is missing", where, "take another copy");
            start = stateOf(reader.keyFrame(0));
            if (!reader.info().history.empty())
                strokesBefore = decodeHistory(reader.info().history, start, station, where);
        }
        lastTick = reader.records(reader.size() - 1, 1).front().tick;
        begin();
        if (settings.isSeen)
            live = std::make_shared<LiveTooth>(station.tooth, station.field->state(), core::part(progress, 0.5, 1.0));
        playOne();
    }

    const std::string where;
    const session::SessionReader reader;
    const std::vector<Event> events;
    const std::vector<std::uint64_t> frames;
    tooth::Case toothCase;
    StationSettings first;
    bool isOtherField = false;
    tooth::CutState start;
    std::optional<history::History> strokesBefore;  ///< strokes before the session
    std::uint64_t lastTick = 0;

    Station station;
    std::shared_ptr<LiveTooth> live;
    std::unique_ptr<loop::HapticLoop> loop;
    device::ReplayDevice* hand = nullptr;  // the loop's
    std::unique_ptr<CutSession> cutting;
    std::uint64_t next = 0;  ///< record to be played
    std::size_t nextEvent = 0, nextFrame = 0;
    std::vector<Record> stretch;
    std::optional<core::Vec3> believed;  // the last pose of the hand that was believed
    std::uint64_t stretchFirst = 0;
    bool isExact = true, isRunningUp = false;
    std::uint64_t differs = 0, firstDiffering = 0, skippedSteps = 0;
    messages::HapticSample sample;

    [[nodiscard]] double timeOf(std::uint64_t tick) const { return static_cast<double>(tick) / first.rateHz; }
    [[nodiscard]] bool isAtEnd() const { return next >= reader.size(); }

    [[nodiscard]] tooth::CutState stateOf(const session::KeyFrame& frame) const {
        return tooth::decodeState(frame.state, station.identity, *station.tooth, where);
    }

    /// A tooth in this state and a loop that begins with record `index`. The field is a new one: what follows does not
    /// depend on what was played before.
    void startAt(std::uint64_t index, const tooth::CutState& state, const history::History* strokes = nullptr) {
        loop.reset();
        cutting.reset();
        station.field = std::make_shared<tooth::CutField>(station.tooth);
        if (!state.bricks.empty()) station.resume(state);
        station.settings = first;
        next = index;
        loadStretch();
        const std::uint64_t tick = stretch.front().tick;
        nextEvent = 0;
        // Of the first tick they are played: their commands were given while it ran.
        for (; index > 0 && nextEvent < events.size() && events[nextEvent].tick <= tick; ++nextEvent)
            if (isChange(events[nextEvent])) (void)applyChange(events[nextEvent].text, station.settings, where);
        nextFrame = static_cast<std::size_t>(std::lower_bound(frames.begin(), frames.end(), tick) - frames.begin());
        believed.reset();
        auto device =
            std::make_unique<device::ReplayDevice>(station.settings.capability, readingsOf(stretch, believed));
        hand = device.get();
        loop::LoopSettings settings;
        settings.rateHz = first.rateHz;
        settings.queueCapacity = 16;
        loop = std::make_unique<loop::HapticLoop>(settings, std::move(device), station.work(),
                                                  station.settings.parameters, station.settings.drive);
        cutting = std::make_unique<CutSession>(station, nullptr, false, strokes);
        differs = firstDiffering = 0;
    }

    void begin() {
        startAt(0, start, strokesBefore ? &*strokesBefore : nullptr);
        isExact = true;
    }

    void loadStretch() {
        const bool follows = !stretch.empty() && stretchFirst + stretch.size() == next;
        const std::uint64_t before = follows ? stretch.back().tick : 0;
        std::vector<Record> read = reader.records(next, kStretch);
        for (std::size_t i = follows ? 0 : 1; i < read.size(); ++i) {
            const std::uint64_t last = i > 0 ? read[i - 1].tick : before;
            if (read[i].tick - last == read[i].elapsedPeriods) continue;
            if (i > 0) {  // as far as it goes
                read.resize(i);
                break;
            }
            throw core::Error(fmt::format("ticks are missing after tick {}: the disk was too slow", last), where,
                              "it can be exported, not replayed")
                .as("session-gap");
        }
        stretch = std::move(read);
        stretchFirst = next;
    }

    const Record& record() {
        if (next - stretchFirst >= stretch.size()) {
            loadStretch();
            hand->continueWith(readingsOf(stretch, believed));
        }
        return stretch[next - stretchFirst];
    }

    void applyEvents(std::uint64_t tick) {
        for (; nextEvent < events.size() && events[nextEvent].tick <= tick; ++nextEvent) {
            const Event& event = events[nextEvent];
            if (isChange(event)) {
                const Changed changed = applyChange(event.text, station.settings, where);
                if (changed.work) loop->setWork(station.work());
                if (changed.drive) loop->setDrive(station.settings.drive);
                if (changed.parameters) loop->setParameters(station.settings.parameters);
                continue;
            }
            const auto step = stepOf(event);
            // After a jump the steps before it are not known: the next key frame has the tooth.
            if (!step || isRunningUp || cutting->takeAgain(*step, *loop)) continue;
            if (isExact && !isOtherField)
                throw core::Error(fmt::format("{} at tick {} cannot be repeated", event.name, event.tick), where);
            ++skippedSteps;
        }
    }

    void playOne() {
        const Record recorded = record();
        applyEvents(recorded.tick);
        rt::Beat beat;
        beat.periods = recorded.elapsedPeriods;
        loop->tick(beat);
        loop->fetch(
            [&](const messages::HapticSample& told) {
                sample = told;
                sample.tick = recorded.tick;
                sample.timeS = timeOf(recorded.tick);
                cutting->hear(sample);
                Record again = session::recordOf(sample);
                if (!isExact) again.lastCommand = recorded.lastCommand;  // counted from the jump
                if (again != recorded && differs++ == 0) firstDiffering = recorded.tick;
            },
            [&](const tooth::BrickSnapshot& brick) {
                cutting->hear(brick);
                if (live && !isRunningUp) live->hear(brick);
            });
        ++next;
        for (; nextFrame < frames.size() && frames[nextFrame] <= recorded.tick; ++nextFrame)
            if (!isExact && !isRunningUp && frames[nextFrame] == recorded.tick)
                correct(stateOf(reader.keyFrame(nextFrame)));
    }

    void put(const tooth::CutState& state) {
        const tooth::CutState change = tooth::changeBetween(station.field->state(), state);
        for (std::size_t i = 0; i < change.bricks.size();)
            i = station.field->restore(change, i, change.bricks.size());
        sample.removedMm3 = state.removedMm3;
    }

    /// The tooth is the recorded one again; its bricks come to the listeners with the next ticks.
    void correct(const tooth::CutState& state) {
        if (tooth::stateHash(state) == station.field->stateHash()) return;
        put(state);
        cutting->correct(state);
    }

    /// The last tick up to a time: a time that is meant to be a tick's own may lie a rounding before it.
    [[nodiscard]] std::uint64_t tickAt(double timeS) const {
        return static_cast<std::uint64_t>(std::floor(std::max(timeS, 0.0) * first.rateHz + 1e-6));
    }

    void playTo(double toS, const core::Progress& progress) {
        const std::uint64_t from = next;
        const double last = std::min(toS, timeOf(lastTick));
        const double most = std::max((last - sample.timeS) * first.rateHz, 1.0);
        const std::uint64_t lastOfAll = tickAt(last);
        while (!isAtEnd() && record().tick <= lastOfAll) {
            playOne();
            if ((next - from) % kReportEvery == 0)
                core::report(progress, std::min(1.0, static_cast<double>(next - from) / most));
        }
        if (live) live->refresh();
    }

    void seek(double toS, const core::Progress& progress) {
        const double target = std::clamp(toS, 0.0, timeOf(lastTick));
        const std::uint64_t tick = tickAt(target);
        const auto after = std::upper_bound(frames.begin(), frames.end(), tick);
        const bool isAhead = tick >= sample.tick;
        const bool framed = after != frames.begin() && !isOtherField;
        const bool nearer = framed && *(after - 1) > sample.tick;
        if (isAhead && (!nearer || target - sample.timeS <= kPlayedAheadS)) return playTo(target, progress);
        if (!framed) {
            begin();
            showWhole();
            return playTo(target, progress);
        }
        const auto frame = static_cast<std::size_t>(after - frames.begin() - 1);
        const tooth::CutState state = stateOf(reader.keyFrame(frame));
        const auto runUp = static_cast<std::uint64_t>(kRunUpS * first.rateHz);
        const std::uint64_t from = frames[frame] > runUp ? frames[frame] - runUp : 0;
        std::uint64_t index = std::min(reader.indexOfTick(from), reader.size() - 1);
        stretch.clear();
        index = afterGap(index, frames[frame]);
        isExact = false;
        startAt(index, state);
        isRunningUp = true;
        while (!isAtEnd() && record().tick <= frames[frame])
            playOne();
        isRunningUp = false;
        put(state);
        discardBricks();
        cutting = std::make_unique<CutSession>(station, nullptr, false);
        if (live) live->apply(tooth::changeBetween(live->state({}), state));
        differs = firstDiffering = 0;
        playTo(target, progress);
    }

    /// The first record from which on none is missing up to a tick.
    [[nodiscard]] std::uint64_t afterGap(std::uint64_t index, std::uint64_t toTick) const {
        const std::uint64_t to = std::min(reader.indexOfTick(toTick), reader.size() - 1);
        const std::vector<Record> all = reader.records(index, static_cast<std::size_t>(to - index + 1));
        std::uint64_t from = index;
        for (std::size_t i = 1; i < all.size(); ++i)
            if (all[i].tick - all[i - 1].tick != all[i].elapsedPeriods) from = index + i;
        return from;
    }

    void showWhole() {
        if (live) live->apply(tooth::changeBetween(live->state({}), start));
    }

    /// What is on its way to listeners who begin with the state as it is.
    void discardBricks() {
        while (station.field->handOver(station.field->waitingBricks(),
                                       [](const tooth::BrickSnapshot&) { return true; }) > 0) {
        }
    }

    [[nodiscard]] history::History historyByKeyFrames(const tooth::CutState& end) const {
        tooth::CutMirror mirror(station.tooth);
        const history::MirrorSource source(mirror);
        history::History history;
        mirror.apply(start);
        if (strokesBefore)
            history = *strokesBefore;
        else
            history.start(start);
        const auto cutTo = [&](const tooth::CutState& state) {
            if (state.removedMm3 == history.removedMm3()) return;
            const tooth::CutState change = tooth::changeBetween(mirror.state({}), state);
            mirror.apply(change);
            for (const tooth::CutState::Brick& brick : change.bricks)
                history.noteTouched(brick.dense);
            history.endStroke(source, state.removedMm3);
        };
        bool inStroke = false;
        auto event = events.begin();
        // What came after the last sample that reached the file is not played either.
        for (std::size_t f = 0; f < frames.size() && frames[f] <= lastTick; ++f) {
            for (; event != events.end() && event->tick <= frames[f]; ++event) {
                if (isNamed(*event, EventName::strokeBegin)) inStroke = true;
                if (isNamed(*event, EventName::strokeEnd)) inStroke = false;
                if (const auto step = stepOf(*event))
                    if (const auto change = take(history, *step)) mirror.apply(*change);
            }
            if (!inStroke) cutTo(stateOf(reader.keyFrame(f)));
        }
        for (; event != events.end() && event->tick <= lastTick; ++event)
            if (const auto step = stepOf(*event))
                if (const auto change = take(history, *step)) mirror.apply(*change);
        cutTo(end);
        return history;
    }

    [[nodiscard]] std::optional<Told> told() const {
        for (auto e = events.rbegin(); e != events.rend(); ++e) {
            if (!isNamed(*e, EventName::end)) continue;
            const auto end = nlohmann::json::parse(e->text, nullptr, false);
            if (!end.is_object() || !end.contains("state_hash") || !end["state_hash"].is_string())
                throw core::Error("the event that ends the session is damaged", where);
            return Told{e->tick, end["state_hash"].get<std::string>()};
        }
        const auto frame = reader.keyFrameBefore(lastTick);
        if (!frame) return std::nullopt;
        return Told{frame->tick, hashText(tooth::stateHash(stateOf(*frame)))};
    }
};

SessionPlayer::SessionPlayer(const std::filesystem::path& path, const Settings& settings,
                             const core::Progress& progress)
    : state_(std::make_unique<State>(path, settings, progress)) {}

SessionPlayer::SessionPlayer(const std::filesystem::path& path, bool useCache, const core::Progress& progress)
    : SessionPlayer(path, Settings{useCache, true, {}}, progress) {}

SessionPlayer::~SessionPlayer() = default;

const session::SessionReader& SessionPlayer::reader() const noexcept {
    return state_->reader;
}

const std::vector<Event>& SessionPlayer::events() const noexcept {
    return state_->events;
}

const tooth::Case& SessionPlayer::toothCase() const noexcept {
    return state_->toothCase;
}

const Station& SessionPlayer::station() const noexcept {
    return state_->station;
}

const std::shared_ptr<LiveTooth>& SessionPlayer::tooth() const noexcept {
    return state_->live;
}

double SessionPlayer::durationS() const noexcept {
    return state_->timeOf(state_->lastTick);
}

double SessionPlayer::timeS() const noexcept {
    return state_->sample.timeS;
}

void SessionPlayer::seek(double timeS, const core::Progress& progress) {
    state_->seek(timeS, progress);
}

void SessionPlayer::advance(double toS, const core::Progress& progress) {
    state_->playTo(toS, progress);
}

const messages::HapticSample& SessionPlayer::sample() const noexcept {
    return state_->sample;
}

std::vector<PlotPoint> SessionPlayer::plot(double stepS) const {
    const State& s = *state_;
    std::vector<PlotPoint> points;
    const auto add = [&points](const PlotPoint& point) { points.push_back(point); };
    PlotGatherer gatherer(stepS);
    for (std::uint64_t first = 0; first < s.reader.size(); first += kStretch)
        for (const Record& record : s.reader.records(first, kStretch))
            gatherer.take(s.timeOf(record.tick), record, add);
    gatherer.finish(add);
    return points;
}

tooth::CutState SessionPlayer::state() const {
    return state_->station.field->state();
}

const history::History& SessionPlayer::endHistory() {
    state_->cutting->settle(state());
    return state_->cutting->history();
}

history::History SessionPlayer::historyByKeyFrames(const tooth::CutState& end) const {
    return state_->historyByKeyFrames(end);
}

bool SessionPlayer::isExact() const noexcept {
    return state_->isExact && !state_->isOtherField;
}

std::uint64_t SessionPlayer::differingTicks() const noexcept {
    return state_->differs;
}

std::uint64_t SessionPlayer::firstDifferingTick() const noexcept {
    return state_->firstDiffering;
}

std::uint64_t SessionPlayer::skippedSteps() const noexcept {
    return state_->skippedSteps;
}

Verdict SessionPlayer::compareAll(const core::Progress& progress) {
    State& s = *state_;
    const auto told = s.told();
    Verdict verdict;
    verdict.complete = s.reader.isComplete();
    verdict.ticks = s.reader.size();
    s.begin();
    s.showWhole();
    const auto hashNow = [&s] { return hashText(s.station.field->stateHash()); };
    if (told && told->tick <= s.lastTick) {
        const double share = static_cast<double>(told->tick + 1) / static_cast<double>(s.lastTick + 1);
        s.playTo(s.timeOf(told->tick) + 0.5 / s.first.rateHz, core::part(progress, 0.0, share));
        verdict.hash = hashNow();
        s.playTo(durationS() + 1.0, core::part(progress, share, 1.0));
    } else {
        s.playTo(durationS() + 1.0, progress);
        verdict.hash = hashNow();
    }
    verdict.recorded = told ? told->hash : "";
    verdict.matches = told && verdict.hash == told->hash;
    verdict.differingTicks = s.differs;
    verdict.firstDifferingTick = s.firstDiffering;
    return verdict;
}

Recovered recover(const std::filesystem::path& session, const core::Progress& progress) {
    SessionPlayer player(session, {true, false, {}}, core::part(progress, 0.0, 0.5));
    player.seek(player.durationS(), core::part(progress, 0.5, 1.0));
    tooth::CutState end = player.state();
    history::History history = player.historyByKeyFrames(end);
    return {std::move(end),     player.durationS(), player.station().settings, player.reader().info().code,
            player.toothCase(), std::move(history)};
}

Recut recutAt(const std::filesystem::path& session, const tooth::FieldSettings& field, bool useCache,
              const core::Progress& progress) {
    SessionPlayer player(session, {useCache, false, field}, core::part(progress, 0.0, 0.3));
    player.advance(player.durationS(), core::part(progress, 0.3, 1.0));
    Recut recut{player.station(), player.state(), player.durationS(), player.endHistory(), player.skippedSteps()};
    // What the loop had not handed over: whoever listens next begins with this state.
    while (recut.station.field->handOver(recut.station.field->waitingBricks(),
                                         [](const tooth::BrickSnapshot&) { return true; }) > 0) {
    }
    return recut;
}

}  // namespace handpiece::station
