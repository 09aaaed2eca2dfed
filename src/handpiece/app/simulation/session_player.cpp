// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/session_player.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "handpiece/app/simulation/cut_session.h"
#include "handpiece/app/simulation/history_bytes.h"
#include "handpiece/app/simulation/recorded_gingiva.h"
#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/case/case_bytes.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/tick/device/replay_device.h"
#include "handpiece/tick/force/pose_guard.h"

namespace handpiece::simulation {
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

std::optional<tooth::StateDelta> take(history::History& history, CutSession::Step step) {
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

/// Where the session goes on, on the tooth of the key frame there.
struct Seam {
    std::uint64_t tick = 0, record = 0;  ///< the first
    std::size_t event = 0;
    Resumption resumption;
};

std::vector<Seam> seamsOf(const session::SessionReader& reader, const std::vector<Event>& events, double rateHz,
                          const std::string& where) {
    std::vector<Seam> seams;
    for (std::size_t i = 0; i < events.size(); ++i) {
        if (!isNamed(events[i], EventName::resume)) continue;
        const std::uint64_t record = reader.indexOfTick(events[i].tick);
        // Cut off before anything followed, or gone on with where nothing had been done yet.
        if (record == 0 || record >= reader.size()) continue;
        if (!seams.empty() && seams.back().record == record) seams.pop_back();
        seams.push_back({events[i].tick, record, i, resumptionFromJson(events[i].text, where)});
        if (seams.back().resumption.settings.rateHz != rateHz)
            throw core::Error("the session goes on at another rate", where, "take another copy");
    }
    return seams;
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
        toothCase = cases::decodeCase(reader.info().tooth, where);
        if (!reader.info().scenery.empty()) {
            const cases::Case around = cases::decodeCase(reader.info().scenery, where);
            toothCase.scenery.insert(toothCase.scenery.end(), around.parts.begin(), around.parts.end());
        }
        first = settingsFromJson(reader.info().settings, where);
        seams = seamsOf(reader, events, first.rateHz, where);
        if (settings.field) {
            if (first.resumed || !seams.empty())
                throw core::Error("this session went on from a tooth that had been cut before", where,
                                  "keep the voxel size, or begin with a whole tooth")
                    .as("voxel-resumed");
            first.field = *settings.field;
            isOtherField = true;
        }
        station = makeSimulation(toothCase, first, settings.useCache, core::part(progress, 0.0, 0.5));
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
            live = std::make_shared<LiveTooth>(station, station.state(), core::part(progress, 0.5, 1.0));
        playOne();
    }

    const std::string where;
    const session::SessionReader reader;
    const std::vector<Event> events;
    const std::vector<std::uint64_t> frames;
    cases::Case toothCase;
    SimulationSettings first;
    std::vector<Seam> seams;
    bool isOtherField = false;
    tooth::StateDelta start;
    std::optional<history::History> strokesBefore;  ///< strokes before the session
    std::uint64_t lastTick = 0;

    SimulationSetup station;
    std::shared_ptr<LiveTooth> live;
    std::unique_ptr<loop::HapticLoop> loop;
    device::ReplayDevice* hand = nullptr;  // the loop's
    std::unique_ptr<CutSession> cutting;
    std::uint64_t next = 0;   ///< record to be played
    std::size_t segment = 0;  ///< seams before it
    std::size_t nextEvent = 0, nextFrame = 0;
    std::vector<Record> stretch;
    std::optional<core::Vec3> believed;  // the last pose of the hand that was believed
    std::uint64_t stretchFirst = 0;
    bool isExact = true, isRunningUp = false;
    std::uint64_t differs = 0, firstDiffering = 0, skippedSteps = 0, brokenSeams = 0;
    messages::HapticSample sample;
    Watch watch;
    double nextLookS = 0.0;

    [[nodiscard]] double timeOf(std::uint64_t tick) const { return static_cast<double>(tick) / first.rateHz; }
    [[nodiscard]] bool isAtEnd() const { return next >= reader.size(); }
    /// The first record of a segment, and the one behind its last.
    [[nodiscard]] std::uint64_t firstOf(std::size_t s) const { return s == 0 ? 0 : seams[s - 1].record; }
    [[nodiscard]] std::uint64_t endOf(std::size_t s) const {
        return s < seams.size() ? seams[s].record : reader.size();
    }

    [[nodiscard]] tooth::StateDelta stateOf(const session::KeyFrame& frame) const {
        return tooth::decodeState(frame.state, station.teeth(), where);
    }

    /// A tooth in this state and a loop that begins with record `index`. The field is a new one: what follows does not
    /// depend on what was played before.
    void startAt(std::uint64_t index, const tooth::StateDelta& state, const history::History* strokes = nullptr) {
        loop.reset();
        cutting.reset();
        station.renewFields();
        if (!state.bricks.empty()) station.resume(state);
        station.settings = first;
        next = index;
        segment = 0;
        while (segment < seams.size() && seams[segment].record <= index)
            ++segment;
        stretch.clear();
        loadStretch();
        const std::uint64_t tick = stretch.front().tick;
        nextEvent = 0;
        if (segment > 0) {
            station.settings = seams[segment - 1].resumption.settings;
            nextEvent = seams[segment - 1].event + 1;
        }
        // Of a loop's first tick they are played: their commands were given while it ran.
        for (; index > firstOf(segment) && nextEvent < events.size() && events[nextEvent].tick <= tick; ++nextEvent)
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
        // In another field there is no key frame to be put right by.
        isExact = isOtherField || reader.info().engineRevision == core::kEngineRevision;
        brokenSeams = 0;
    }

    void loadStretch() {
        const bool follows = !stretch.empty() && stretchFirst + stretch.size() == next;
        const std::uint64_t before = follows ? stretch.back().tick : 0;
        std::vector<Record> read =
            reader.records(next, static_cast<std::size_t>(std::min<std::uint64_t>(kStretch, endOf(segment) - next)));
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
            if (step == CutSession::Step::reset && live && !isRunningUp) live->gingiva().clear();
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
                if (live && !isRunningUp) live->gingiva().hear(sample, *station.settings.bur);
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

    void put(const tooth::StateDelta& state) {
        station.put(tooth::changeBetween(station.state(), state));
        sample.removedMm3 = state.removedMm3.own;
    }

    /// The tooth is the recorded one again; its bricks come to the listeners with the next ticks.
    void correct(const tooth::StateDelta& state) {
        if (tooth::stateHash(state) == station.stateHash()) return;
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
        while (!isAtEnd()) {
            if (next == endOf(segment)) {
                if (seams[segment].tick > lastOfAll) break;
                crossSeam();
            }
            if (record().tick > lastOfAll) break;
            playOne();
            if (watch.look && (sample.timeS >= nextLookS || isAtEnd())) {
                nextLookS = std::max(nextLookS, sample.timeS) + watch.stepS;
                watch.look();
            }
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
        const tooth::StateDelta state = jumpTo(frame);
        if (live) {
            live->apply(tooth::changeBetween(live->state({}), state));
            hearRecorded(live->gingiva(), reader, events, first, frames[frame], where);
        }
        playTo(target, progress);
    }

    /// To a key frame, with the run-up before it. Returns its state.
    tooth::StateDelta jumpTo(std::size_t frame) {
        tooth::StateDelta state = stateOf(reader.keyFrame(frame));
        const auto runUp = static_cast<std::uint64_t>(kRunUpS * first.rateHz);
        const std::uint64_t from = frames[frame] > runUp ? frames[frame] - runUp : 0;
        std::size_t loopOf = 0;
        while (loopOf < seams.size() && seams[loopOf].tick <= frames[frame])
            ++loopOf;
        std::uint64_t index = std::clamp(reader.indexOfTick(from), firstOf(loopOf), endOf(loopOf) - 1);
        index = afterGap(index, frames[frame], endOf(loopOf));
        isExact = false;
        startAt(index, state);
        isRunningUp = true;
        while (next < endOf(loopOf) && record().tick <= frames[frame]) {
            const double rpm = record().speedRpm;
            playOne();
            loop->setSpeedRpm(rpm);  // the tooth is not yet that of these ticks, nor is the bur's load
        }
        isRunningUp = false;
        put(state);
        station.discardBricks();
        cutting = std::make_unique<CutSession>(station, nullptr, false);
        differs = firstDiffering = 0;
        return state;
    }

    /// As after the pause or the crash: another loop on the tooth as it was brought back. Looks whether it was that of
    /// before.
    void crossSeam() {
        const Seam& seam = seams[segment];
        const auto frame = std::lower_bound(frames.begin(), frames.end(), seam.tick);
        if (frame == frames.end() || *frame != seam.tick)
            throw core::Error("the state that the session went on from is missing", where, "take another copy");
        const tooth::StateDelta state = stateOf(reader.keyFrame(static_cast<std::size_t>(frame - frames.begin())));
        const std::uint64_t hash = tooth::stateHash(state), differed = differs, differedFirst = firstDiffering,
                            skipped = skippedSteps;
        const bool wasExact = isExact;
        KeptHistory strokes;
        if (wasExact) {
            const tooth::StateDelta done = station.state();
            const std::uint64_t before = tooth::stateHash(done);
            if (!seam.resumption.isRecovered) {
                cutting->settle(done);
                strokes = keepHistory(cutting->history(), state, station);
            } else {
                strokes = keepHistory(historyByKeyFrames(state, segment), state, station);
            }
            const bool isTold = seam.resumption.stateHash == hashText(hash);
            const bool follows = before == hash || (seam.resumption.isRecovered && hash == foundAfterCrash(segment));
            if (!isTold || !follows) ++brokenSeams;
        }
        startAt(seam.record, state, strokes.steps.get());
        isExact = wasExact;
        differs = differed;
        firstDiffering = differedFirst;
        skippedSteps = skipped;
        if (live) live->apply(tooth::changeBetween(live->state({}), state));
    }

    /// Of the tooth that recover() found when the session ended with this segment. Plays somewhere else afterwards.
    std::uint64_t foundAfterCrash(std::size_t lastSegment) {
        const std::uint64_t last = reader.records(endOf(lastSegment) - 1, 1).front().tick;
        const std::uint64_t begun = reader.records(0, 1).front().tick;
        const auto after = std::upper_bound(frames.begin(), frames.end(), last);
        // As seek() decides there: near enough, or without a key frame, it was played from the beginning.
        if (after == frames.begin() || *(after - 1) <= begun || timeOf(last) - timeOf(begun) <= kPlayedAheadS) return 0;
        const std::shared_ptr<LiveTooth> seen = std::exchange(live, nullptr);
        jumpTo(static_cast<std::size_t>(after - frames.begin() - 1));
        playTo(timeOf(last), {});
        live = seen;
        return station.stateHash();
    }

    /// The first record from which on none is missing up to a tick.
    [[nodiscard]] std::uint64_t afterGap(std::uint64_t index, std::uint64_t toTick, std::uint64_t endOfLoop) const {
        const std::uint64_t to = std::min(reader.indexOfTick(toTick), endOfLoop - 1);
        const std::vector<Record> all = reader.records(index, static_cast<std::size_t>(to - index + 1));
        std::uint64_t from = index;
        for (std::size_t i = 1; i < all.size(); ++i)
            if (all[i].tick - all[i - 1].tick != all[i].elapsedPeriods) from = index + i;
        return from;
    }

    void showWhole() {
        if (!live) return;
        live->apply(tooth::changeBetween(live->state({}), start));
        live->gingiva().clear();
    }

    /// As the session's first segments leave it, this one the last.
    [[nodiscard]] history::History historyByKeyFrames(const tooth::StateDelta& end, std::size_t lastSegment) const {
        const std::uint64_t last = reader.records(endOf(lastSegment) - 1, 1).front().tick;
        tooth::MouthMirror mirror(station.teeth());
        const history::MirrorSource source(mirror);
        history::History history;
        mirror.apply(start);
        if (strokesBefore)
            history = *strokesBefore;
        else
            history.start(start);
        const auto cutTo = [&](const tooth::StateDelta& state) {
            if (state.removedMm3 == history.removedMm3()) return;
            const tooth::StateDelta change = tooth::changeBetween(mirror.state(), state);
            mirror.apply(change);
            for (const tooth::StateDelta::Brick& brick : change.bricks)
                history.noteTouched(brick.id);
            history.endStroke(source, state.removedMm3);
        };
        bool inStroke = false;
        auto event = events.begin();
        // What came after the last sample that reached the file is not played either.
        for (std::size_t f = 0; f < frames.size() && frames[f] <= last; ++f) {
            for (; event != events.end() && event->tick <= frames[f]; ++event) {
                if (isNamed(*event, EventName::strokeBegin)) inStroke = true;
                if (isNamed(*event, EventName::strokeEnd)) inStroke = false;
                if (isNamed(*event, EventName::resume)) {  // a stroke under way had ended
                    inStroke = false;
                    if (frames[f] == event->tick) cutTo(stateOf(reader.keyFrame(f)));
                }
                if (const auto step = stepOf(*event))
                    if (const auto change = take(history, *step)) mirror.apply(*change);
            }
            if (!inStroke) cutTo(stateOf(reader.keyFrame(f)));
        }
        for (; event != events.end() && event->tick <= last; ++event)
            if (const auto step = stepOf(*event))
                if (const auto change = take(history, *step)) mirror.apply(*change);
        cutTo(end);
        return history;
    }

    [[nodiscard]] std::optional<Told> told() const {
        const auto frame = reader.keyFrameBefore(lastTick);
        for (auto e = events.rbegin(); e != events.rend(); ++e) {
            if (!isNamed(*e, EventName::end) || (frame && frame->tick > e->tick)) continue;
            const auto end = config::outsideJson<nlohmann::json>(e->text);
            if (!end.is_object() || !end.contains("state_hash") || !end["state_hash"].is_string())
                throw core::Error("the event that ends the session is damaged", where);
            return Told{e->tick, end["state_hash"].get<std::string>()};
        }
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

const cases::Case& SessionPlayer::toothCase() const noexcept {
    return state_->toothCase;
}

const SimulationSetup& SessionPlayer::station() const noexcept {
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

tooth::StateDelta SessionPlayer::state() const {
    return state_->station.state();
}

std::uint64_t SessionPlayer::startHash() const {
    return tooth::stateHash(state_->start);
}

const history::History& SessionPlayer::endHistory() {
    state_->cutting->settle(state());
    return state_->cutting->history();
}

history::History SessionPlayer::historyByKeyFrames(const tooth::StateDelta& end) const {
    return state_->historyByKeyFrames(end, state_->seams.size());
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

Verdict SessionPlayer::compareAll(const core::Progress& progress, const Watch& watch) {
    State& s = *state_;
    struct Watching {
        State& of;
        ~Watching() { of.watch = {}; }
    } watching{s};
    s.watch = watch;
    s.nextLookS = 0.0;
    const auto told = s.told();
    Verdict verdict;
    verdict.complete = s.reader.isComplete();
    verdict.ticks = s.reader.size();
    s.begin();
    s.showWhole();
    const auto hashNow = [&s] { return hashText(s.station.stateHash()); };
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
    verdict.seams = s.seams.size();
    verdict.brokenSeams = s.brokenSeams;
    verdict.engineRevision = s.reader.info().engineRevision;
    verdict.matches = told && verdict.hash == told->hash && verdict.brokenSeams == 0 && !verdict.isOtherEngine();
    verdict.differingTicks = s.differs;
    verdict.firstDifferingTick = s.firstDiffering;
    return verdict;
}

Recovered recover(const std::filesystem::path& session, const core::Progress& progress) {
    SessionPlayer player(session, {true, false, {}}, core::part(progress, 0.0, 0.5));
    player.seek(player.durationS(), core::part(progress, 0.5, 1.0));
    tooth::StateDelta end = player.state();
    history::History history = player.historyByKeyFrames(end);
    return {std::move(end),     player.durationS(), player.station().settings, player.reader().info().code,
            player.toothCase(), std::move(history)};
}

Recut recutAt(const std::filesystem::path& session, const field::FieldSettings& field, bool useCache,
              const core::Progress& progress) {
    SessionPlayer player(session, {useCache, false, field}, core::part(progress, 0.0, 0.3));
    player.advance(player.durationS(), core::part(progress, 0.3, 1.0));
    Recut recut{player.station(), player.state(), player.durationS(), player.endHistory(), player.skippedSteps()};
    // What the loop had not handed over: whoever listens next begins with this state.
    recut.station.discardBricks();
    return recut;
}

}  // namespace handpiece::simulation
