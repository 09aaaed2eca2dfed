// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/live_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <exception>
#include <future>
#include <mutex>
#include <optional>
#include <thread>
#include <variant>

#include "handpiece/app/input/held_button.h"
#include "handpiece/app/simulation/cut_session.h"
#include "handpiece/app/simulation/tick_statistics.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/model/case/case_bytes.h"
#include "handpiece/model/tooth/state_file.h"

namespace handpiece::simulation {
namespace {

using messages::HapticSample;
using session::EventName;

constexpr std::int64_t kSecondNs = 1'000'000'000, kRefreshNs = kSecondNs / 120, kWatchNs = kSecondNs / 4;
constexpr std::size_t kMaxPlotPoints = 60000, kMaxNotices = 256;
/// Bricks on their way: an undo of a large cavity comes at once.
constexpr std::size_t kBrickCapacity = 4096;

// Requests, one after the other.
struct TakeStep {
    CutSession::Step step;
};
struct ChangeBur {
    std::shared_ptr<const instrument::Bur> bur;
    instrument::CuttingParameters cuttingParameters;
};
struct ChangeDrive {
    instrument::Drive drive;
};
struct ChangeParameters {
    force::Parameters parameters;
};
struct ChangeMethod {
    bool hull;
};
using Request = std::variant<TakeStep, ChangeBur, ChangeDrive, ChangeParameters, ChangeMethod, WorkingWay>;

bool anythingRemoved(const tooth::TissueVolumes& mm3) {
    return std::any_of(mm3.begin(), mm3.end(), [](double v) { return v > 0.0; });
}

const char* noticeOf(EventName name) {
    if (name == EventName::pulpExposure) return "pulp-exposed";
    if (name == EventName::neighbourTouched) return "neighbour-touched";
    if (name == EventName::neighbourCut) return "neighbour-cut";
    if (name == EventName::gingivaCut) return "gingiva-cut";
    if (name == EventName::headTouched) return "head-touched";
    if (name == EventName::stall) return "stalled";
    if (name == EventName::forceLimit) return "force-limited";
    if (name == EventName::fault) return "device-fault";
    return nullptr;
}

std::unique_ptr<session::Recorder> recorderFor(const SimulationSetup& station, const cases::Case& toothCase,
                                               const LiveSessionSettings& settings) {
    if (settings.sessionFile.empty()) return nullptr;
    if (settings.session != LiveSessionSettings::Session::anew) {
        auto recorder = std::make_unique<session::Recorder>(settings.sessionFile);
        // The key frame with the tooth as it is comes first of all that follows (CutSession).
        recorder->event(0, EventName::resume,
                        resumptionJson({station.settings, hashText(station.stateHash()),
                                        settings.session == LiveSessionSettings::Session::recovered}));
        return recorder;
    }
    session::SessionInfo info;
    info.rateHz = station.settings.rateHz;
    info.code = settings.code;
    info.version = HANDPIECE_VERSION;
    info.settings = settingsJson(station.settings);
    info.tooth = cases::encodeCase(toothCase);
    cases::Case around;
    for (const cases::Part& part : toothCase.scenery)
        if (!part.isFelt) around.parts.push_back(part);
    if (!around.parts.empty()) info.scenery = cases::encodeCase(around);
    info.history = settings.history.bytes;
    return std::make_unique<session::Recorder>(settings.sessionFile, info);
}

loop::LoopSettings loopSettingsOf(const SimulationSetup& station, const LiveSessionSettings& settings) {
    loop::LoopSettings l;
    l.rateHz = station.settings.rateHz;
    l.spinUs = settings.spinUs;
    l.brickCapacity = kBrickCapacity;
    // A listener that is held up by long work may be four seconds behind.
    l.queueCapacity = static_cast<std::size_t>(4.0 * station.settings.rateHz);
    return l;
}

}  // namespace

struct LiveSession::State {
    State(SimulationSetup theStation, const cases::Case& theCase, std::unique_ptr<device::Device> device,
          const LiveSessionSettings& theSettings, std::shared_ptr<LiveTooth> liveTooth)
        : station(std::move(theStation)),
          inForce(station),
          settings(theSettings),
          caseName(theCase.name),
          caseKey(cases::contentKey(theCase)),
          live(std::move(liveTooth)),
          recorder(recorderFor(station, theCase, settings)),
          cutting(station, recorder.get(), false, settings.history.steps.get()),
          loop(loopSettingsOf(station, settings), std::move(device), station.work(), station.settings.parameters,
               station.settings.drive),
          statistics(station.settings.rateHz),
          asked(station.settings) {
        if (live) live->gingiva().clear();  // a sitting's time begins anew
        cutting.setEventListener([this](std::uint64_t, EventName name) {
            // With the pedal up the bur passes over the teeth around on its way; what it cuts even so is told.
            if (name == EventName::neighbourTouched && last.pedal <= 0.0) return;
            if (const char* id = noticeOf(name)) notice(id);
        });
    }

    // Never written after the thread has begun.
    const SimulationSetup station;
    // The listener's thread alone.
    SimulationSetup inForce;  ///< with the settings that the loop has been given
    const LiveSessionSettings settings;
    const std::string caseName;
    const std::uint64_t caseKey;
    const std::shared_ptr<LiveTooth> live;
    const std::unique_ptr<session::Recorder> recorder;
    CutSession cutting;
    loop::HapticLoop loop;
    TickStatistics statistics;
    PlotGatherer gatherer;
    input::HeldButton lower;
    HapticSample last;
    std::optional<rt::Scheduling> told;
    bool any = false, fresh = false, outOfBricks = false, toldStopped = false, toldIncomplete = false;
    std::uint64_t toldLost = 0;
    std::int64_t refreshedNs = 0, watchedNs = 0, toldNs = 0, attendedNs = 0, busyNs = 0, absentNs = 0;
    SampleListener listener;
    std::string fault;

    std::atomic<bool> stopWanted{false};
    mutable std::mutex mutex;  // of what follows; held for moments
    std::deque<Request> requests;
    std::vector<std::promise<tooth::StateDelta>> questions;
    std::vector<std::shared_ptr<SampleFeed>> feeds;
    std::optional<SampleListener> nextListener;
    std::deque<PlotPoint> plot;
    std::deque<Notice> notices;
    LiveSessionStatus status;
    SimulationSettings asked;
    bool ended = false;
    tooth::StateDelta finalState;
    std::thread thread;

    void notice(std::string id, std::vector<std::string> arguments = {}, std::optional<core::Error> cause = {}) {
        const std::lock_guard lock(mutex);
        if (notices.size() < kMaxNotices) notices.push_back({std::move(id), std::move(arguments), std::move(cause)});
    }

    void post(Request request) {
        const std::lock_guard lock(mutex);
        if (ended) return;
        const bool replaces = !requests.empty() && requests.back().index() == request.index() &&
                              !std::holds_alternative<TakeStep>(request) &&
                              !std::holds_alternative<WorkingWay>(request);
        if (replaces) requests.pop_back();
        requests.push_back(std::move(request));
    }

    // What follows: the listener's thread.

    void hear(const HapticSample& sample) {
        last = sample;
        any = fresh = true;
        statistics.take(sample);
        cutting.hear(sample);
        gatherer.take(sample.timeS, sample, [this](const PlotPoint& point) {
            const std::lock_guard lock(mutex);
            plot.push_back(point);
            if (plot.size() > kMaxPlotPoints) plot.pop_front();
        });
        if ((sample.flags & messages::kOutOfBricks) != 0 && !std::exchange(outOfBricks, true)) notice("out-of-bricks");
        if (settings.lowerButtonUndoes && lower.take(sample)) post(TakeStep{CutSession::Step::undo});
        if (live) live->gingiva().hear(sample, *inForce.settings.bur);
        if (listener) listener(sample);
    }

    void fetch() {
        loop.fetch([this](const HapticSample& sample) { hear(sample); },
                   [this](const tooth::BrickSnapshot& brick) {
                       cutting.hear(brick);
                       if (live) live->hear(brick);
                   });
    }

    void attend(const rt::SchedulingGrant& scheduling) {
        const std::int64_t begunNs = rt::monotonicNs();
        if (attendedNs != 0) absentNs = std::max(absentNs, begunNs - attendedNs);
        std::vector<std::shared_ptr<SampleFeed>> toTell;
        {
            const std::lock_guard lock(mutex);
            if (nextListener) listener = std::move(*nextListener);
            nextListener.reset();
            toTell = feeds;
        }
        fetch();
        if (std::exchange(fresh, false))
            for (const auto& feed : toTell)
                feed->write(last);
        answer();
        serveOne();
        if (live && begunNs - refreshedNs >= kRefreshNs && live->tryRefresh()) refreshedNs = begunNs;
        if (stopWanted.load(std::memory_order_acquire)) loop.requestStop();
        attendedNs = rt::monotonicNs();
        busyNs += attendedNs - begunNs;
        if (begunNs - watchedNs >= kWatchNs) watchRecord(begunNs);
        if (begunNs - toldNs >= kSecondNs) tell(scheduling, begunNs);
        const std::lock_guard lock(mutex);
        fillNow(status);
    }

    void fillNow(LiveSessionStatus& now) const {
        now.timeS = last.timeS;
        now.queueOverflow = toldLost;
        now.undoSteps = cutting.history().undoSteps();
        now.redoSteps = cutting.history().redoSteps();
        now.strokes = cutting.strokes();
        now.inStroke = cutting.inStroke();
        now.restoring = (last.flags & messages::kRestoring) != 0;
        now.cut = anythingRemoved(last.removedMm3) || last.removedOthersMm3 > 0.0;
        now.hull = inForce.settings.hull;
    }

    /// Once a second: what the status bar says, and what became of the record.
    void tell(const rt::SchedulingGrant& scheduling, std::int64_t nowNs) {
        LiveSessionStatus now;
        statistics.fill(now);
        now.scheduling = scheduling;
        if (told != scheduling.scheduling && recorder)
            recorder->event(last.tick, EventName::scheduling,
                            fmt::format(R"({{"class": "{}"}})", rt::nameOf(scheduling.scheduling)));
        told = scheduling.scheduling;
        now.listenerLoad = toldNs == 0 ? 0.0 : static_cast<double>(busyNs) / static_cast<double>((nowNs - toldNs));
        now.listenerAbsentMs = static_cast<double>(absentNs) * 1e-6;
        busyNs = absentNs = 0;
        toldNs = nowNs;
        if (const std::uint64_t lost = loop.samples().overflowCount(); lost > toldLost) {
            notice("samples-lost", {fmt::format("{}", lost - toldLost)});
            toldLost = lost;
        }
        fillNow(now);
        const std::lock_guard lock(mutex);
        status = std::move(now);
    }

    void watchRecord(std::int64_t nowNs) {
        watchedNs = nowNs;
        if (!recorder) return;
        const session::RecorderStatus now = recorder->status();
        if (!now.message.empty() && !std::exchange(toldStopped, true))
            notice("recording-stopped", {now.message}, core::Error(now.message).as(now.id, {now.reason}));
        if (now.lostRecords > 0 && !std::exchange(toldIncomplete, true))
            notice("recording-incomplete", {fmt::format("{}", now.lostRecords)});
    }

    void answer() {
        std::vector<std::promise<tooth::StateDelta>> taken;
        {
            const std::lock_guard lock(mutex);
            taken.swap(questions);
        }
        for (auto& question : taken)
            question.set_value(cutting.state());
    }

    /// One at a time, the next when the loop has taken the one before: so that a replay finds them in this order.
    void serveOne() {
        if (cutting.isWaiting() || loop.restoring()) return;
        Request request;
        {
            const std::lock_guard lock(mutex);
            if (requests.empty()) return;
            request = std::move(requests.front());
            requests.pop_front();
        }
        try {
            std::visit([this](const auto& r) { serve(r); }, request);
        } catch (const core::Error& e) {
            notice("refused", {e.what()}, e);
        }
    }

    void serve(const TakeStep& request) {
        using Step = CutSession::Step;
        if (inForce.settings.hull) return notice("hull-only-touches");
        if (cutting.inStroke() && last.pedal > 0.0) return notice("not-while-cutting");
        if (cutting.inStroke()) {  // the last bricks are on their way
            const std::lock_guard lock(mutex);
            requests.push_front(request);
            return;
        }
        if (cutting.take(request.step, loop)) {
            if (request.step == Step::reset && live) live->gingiva().clear();
        } else
            notice(request.step == Step::undo   ? "nothing-to-undo"
                   : request.step == Step::redo ? "nothing-to-redo"
                                                : "nothing-to-reset");
    }
    void serve(const WorkingWay& request) {
        if (recorder) recorder->event(last.tick, EventName::workingWay, workingWayJson(request));
    }
    void serve(const ChangeBur& request) {
        SimulationSetup next = inForce;
        next.settings.bur = request.bur;
        next.settings.cuttingParameters = request.cuttingParameters;
        changeWork(std::move(next));
    }
    void serve(const ChangeMethod& request) {
        if (request.hull == inForce.settings.hull) return;
        if (request.hull && (cutting.inStroke() || !cutting.state().bricks.empty())) {
            notice("hull-needs-whole-tooth");
            const std::lock_guard lock(mutex);
            asked.hull = false;
            return;
        }
        SimulationSetup next = inForce;
        next.settings.hull = request.hull;
        changeWork(std::move(next));
    }
    void changeWork(SimulationSetup next) {
        loop::Work work = next.work();
        inForce = std::move(next);
        cutting.tellWhenTaken(loop.setWork(std::move(work)), EventName::burChange, burChangeJson(inForce.settings));
    }
    void serve(const ChangeDrive& request) {
        inForce.settings.drive = request.drive;
        cutting.tellWhenTaken(loop.setDrive(request.drive), EventName::parameterChange,
                              driveChangeJson(inForce.settings));
    }
    void serve(const ChangeParameters& request) {
        inForce.settings.parameters = request.parameters;
        cutting.tellWhenTaken(loop.setParameters(request.parameters), EventName::parameterChange,
                              parameterChangeJson(inForce.settings));
    }

    void run() {
        try {
            runAttended(loop, settings.realTime, [this](const rt::SchedulingGrant& scheduling) { attend(scheduling); });
            fetch();
        } catch (const std::exception& e) {
            fault = e.what();
        }
        try {
            finish();
        } catch (const std::exception& e) {
            if (fault.empty()) fault = e.what();
        }
        const std::lock_guard lock(mutex);
        ended = true;
        status.fault = fault;
        requests.clear();
        for (auto& question : questions)
            question.set_value(finalState);
        questions.clear();
    }

    /// The loop has ended: field and queues are this thread's now.
    void finish() {
        tooth::StateDelta state = station.state();
        {
            const std::lock_guard lock(mutex);
            finalState = state;
        }
        if (recorder) {
            cutting.finish(state, last.tick);
            recorder->close();
            watchRecord(attendedNs);
        }
        gatherer.finish([this](const PlotPoint& point) {
            const std::lock_guard lock(mutex);
            plot.push_back(point);
        });
        cutting.settle(state);
        if (live) {
            live->apply(tooth::changeBetween(live->state({}), state));
            live->refresh();
        }
        const std::lock_guard lock(mutex);
        statistics.fill(status);
        statistics.fillAll(status);
        fillNow(status);
    }
};

LiveSession::LiveSession(SimulationSetup station, const cases::Case& toothCase, std::unique_ptr<device::Device> device,
                         const LiveSessionSettings& settings, std::shared_ptr<LiveTooth> liveTooth)
    : state_(
          std::make_unique<State>(std::move(station), toothCase, std::move(device), settings, std::move(liveTooth))) {
    state_->thread = std::thread([s = state_.get()] { s->run(); });
}

LiveSession::~LiveSession() {
    stop();
}

void LiveSession::stop() {
    state_->stopWanted.store(true, std::memory_order_release);
    if (state_->thread.joinable()) state_->thread.join();
}

void LiveSession::undo() {
    state_->post(TakeStep{CutSession::Step::undo});
}

void LiveSession::redo() {
    state_->post(TakeStep{CutSession::Step::redo});
}

void LiveSession::reset() {
    state_->post(TakeStep{CutSession::Step::reset});
}

void LiveSession::setBur(std::shared_ptr<const instrument::Bur> bur,
                         const instrument::CuttingParameters& cuttingParameters) {
    if (!bur) throw core::Error("there is no bur", "sitting");
    instrument::validate(cuttingParameters);
    {
        const std::lock_guard lock(state_->mutex);
        state_->asked.bur = bur;
        state_->asked.cuttingParameters = cuttingParameters;
    }
    state_->post(ChangeBur{std::move(bur), cuttingParameters});
}

void LiveSession::setDrive(const instrument::Drive& drive) {
    instrument::validate(drive);
    {
        const std::lock_guard lock(state_->mutex);
        state_->asked.drive = drive;
    }
    state_->post(ChangeDrive{drive});
}

void LiveSession::setParameters(const force::Parameters& parameters) {
    force::validate(parameters);
    {
        const std::lock_guard lock(state_->mutex);
        state_->asked.parameters = parameters;
    }
    state_->post(ChangeParameters{parameters});
}

void LiveSession::setHullMethod(bool hull) {
    {
        const std::lock_guard lock(state_->mutex);
        state_->asked.hull = hull;
    }
    state_->post(ChangeMethod{hull});
}

void LiveSession::noteWorkingWay(const WorkingWay& way) {
    state_->post(way);
}

std::shared_ptr<SampleFeed> LiveSession::subscribe() {
    auto feed = std::make_shared<SampleFeed>();
    const std::lock_guard lock(state_->mutex);
    state_->feeds.push_back(feed);
    return feed;
}

void LiveSession::setListener(SampleListener listener) {
    const std::lock_guard lock(state_->mutex);
    state_->nextListener = std::move(listener);
}

std::vector<PlotPoint> LiveSession::takePlot() {
    const std::lock_guard lock(state_->mutex);
    std::vector<PlotPoint> taken(state_->plot.begin(), state_->plot.end());
    state_->plot.clear();
    return taken;
}

std::vector<Notice> LiveSession::takeNotices() {
    const std::lock_guard lock(state_->mutex);
    std::vector<Notice> taken(state_->notices.begin(), state_->notices.end());
    state_->notices.clear();
    return taken;
}

LiveSessionStatus LiveSession::status() const {
    LiveSessionStatus now;
    bool ended = false;
    {
        const std::lock_guard lock(state_->mutex);
        now = state_->status;
        ended = state_->ended;
    }
    if (state_->recorder) now.recording = state_->recorder->status();
    now.recording.recording = state_->recorder != nullptr && !ended && now.recording.message.empty();
    return now;
}

const std::shared_ptr<LiveTooth>& LiveSession::tooth() const noexcept {
    return state_->live;
}

const SimulationSetup& LiveSession::station() const noexcept {
    return state_->station;
}

SimulationSettings LiveSession::settings() const {
    const std::lock_guard lock(state_->mutex);
    return state_->asked;
}

const history::History& LiveSession::history() const {
    return state_->cutting.history();
}

tooth::StateDelta LiveSession::state() const {
    std::future<tooth::StateDelta> answer;
    {
        const std::lock_guard lock(state_->mutex);
        if (state_->ended) return state_->finalState;
        answer = state_->questions.emplace_back().get_future();
    }
    return answer.get();
}

cases::Attempt LiveSession::attempt(const std::filesystem::path& caseFile) const {
    const tooth::StateDelta now = state();
    const LiveSessionStatus status = this->status();
    const SimulationSettings chosen = settings();
    cases::Attempt attempt;
    attempt.caseFile = core::wholePath(caseFile);
    attempt.caseKey = state_->caseKey;
    attempt.caseName = state_->caseName;
    attempt.state = tooth::encodeState(now, state_->station.identity());
    attempt.voxelMm = chosen.field.voxelMm;
    attempt.removedMm3 = now.removedMm3.own;
    attempt.bur = chosen.bur->name();
    attempt.cuttingParameters = chosen.cuttingParameters.name;
    attempt.drive = chosen.drive.name;
    attempt.elapsedS = state_->settings.elapsedS + status.timeS;
    attempt.student = state_->settings.code;
    attempt.session = state_->settings.sessionFile.filename().string();
    attempt.undoDepth = static_cast<std::int64_t>(status.undoSteps);
    return attempt;
}

}  // namespace handpiece::simulation
