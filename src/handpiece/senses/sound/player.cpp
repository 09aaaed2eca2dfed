// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/sound/player.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "handpiece/base/core/any_error.h"
#include "handpiece/base/rt/realtime_thread.h"
#include "handpiece/base/rt/triple_buffer.h"
#include "handpiece/senses/sound/stage.h"
#include "handpiece/senses/sound/voices.h"

namespace handpiece::sound {
namespace {

using std::chrono::steady_clock;

constexpr int kBlock = 64;             // frames made at a time
constexpr int kSpareFrames = 192;      // queued beyond one period of the device
constexpr int kMaxSpareFrames = 4800;  // a machine that stutters with this much is left to
constexpr auto kWake = std::chrono::milliseconds(1);
constexpr auto kFirstRetry = std::chrono::seconds(10), kLastRetry = std::chrono::seconds(160);
constexpr auto kLook = std::chrono::milliseconds(500);  // whether the device is still there
constexpr int kPriority = 20;                           // under the tick's 80

using Three = std::array<double, 3>;

Three plain(const core::Vec3& v) {
    return {v.x(), v.y(), v.z()};
}
core::Vec3 vec(const Three& v) {
    return {v[0], v[1], v[2]};
}

/// The same as DrillState and Ear, of plain arrays: what a mailbox between threads may copy.
struct DrillMail {
    double speedRpm, freeSpeedRpm, pedal, loadTorqueNmm, removalMm3S, burRadiusMm;
    Three positionMm, axis;
    int edges;
    cases::Tissue tissue;
    bool cutting, stalled, water;
};
struct EarMail {
    Three eyeMm, forward, up;
};

DrillMail mailOf(const DrillState& d) {
    return {d.speedRpm,    d.freeSpeedRpm, d.pedal,  d.loadTorqueNmm, d.removalMm3S, d.burRadiusMm, plain(d.positionMm),
            plain(d.axis), d.edges,        d.tissue, d.cutting,       d.stalled,     d.water};
}
DrillState stateOf(const DrillMail& m) {
    return {m.speedRpm, m.freeSpeedRpm, m.pedal,   m.loadTorqueNmm, m.removalMm3S,     m.tissue,   m.burRadiusMm,
            m.edges,    m.cutting,      m.stalled, m.water,         vec(m.positionMm), vec(m.axis)};
}
EarMail mailOf(const Ear& e) {
    return {plain(e.eyeMm), plain(e.forward), plain(e.up)};
}
Ear earOf(const EarMail& m) {
    return {vec(m.eyeMm), vec(m.forward), vec(m.up)};
}

}  // namespace

struct Player::State {
    PlayerSettings settings;
    rt::TripleBuffer<DrillMail> drill{mailOf(DrillState{})};
    rt::TripleBuffer<EarMail> ear{mailOf(Ear{})};
    rt::TripleBuffer<Mix> mix;

    std::mutex mutex;  // over all that follows; never held while sound is made
    std::condition_variable ended;
    bool end = false, newLoops = false;
    std::shared_ptr<const Loop> motor, cutting;
    PlayerStatus status;

    Voices voices;  // the thread's
    std::thread thread;

    bool waitUntil(steady_clock::time_point time) {
        std::unique_lock lock(mutex);
        return ended.wait_until(lock, time, [this] { return end; });
    }

    void tellSilent(const std::string& why) {
        const std::lock_guard lock(mutex);
        status.silent = true;
        status.device = why;
        status.latencyMs = 0.0;
    }

    void run() {
        (void)rt::requestRealtime(kPriority);  // what is not granted is done without
        steady_clock::duration retry = kFirstRetry;
        for (;;) {
            try {
                Stage stage(StageKind::device, settings.headphones);
                retry = kFirstRetry;
                if (play(stage)) return;
                tellSilent("the sound card was lost");
            } catch (const std::exception& error) {
                tellSilent(core::asError(error).problem());
            }
            if (waitUntil(steady_clock::now() + retry)) return;
            retry = std::min<steady_clock::duration>(2 * retry, kLastRetry);
        }
    }

    void takeLoops() {
        std::unique_lock lock(mutex, std::try_to_lock);
        if (!lock || !newLoops) return;
        newLoops = false;
        voices.useLoops(motor, cutting);
    }

    void makeBlock(Stage& stage) {
        takeLoops();
        const DrillState state = stateOf(drill.read());
        std::array<float, kBlock> motorBlock, cuttingBlock;
        voices.render(state, mix.read(), motorBlock, cuttingBlock);
        stage.place(earOf(ear.read()), motorPositionMm(state), state.positionMm, kBlock / kSampleRateHz);
        stage.queue(motorBlock, cuttingBlock);
    }

    /// Plays until the end (true) or until the device is lost.
    bool play(Stage& stage) {
        int spare = kSpareFrames;
        double latencyMs = 0.0;
        bool playing = false;
        auto look = steady_clock::now();
        for (auto wake = look; !waitUntil(wake);) {
            if (playing && stage.ranDry()) {
                playing = false;
                spare = std::min(spare + spare / 2, kMaxSpareFrames);
                const std::lock_guard lock(mutex);
                ++status.underruns;
            }
            // A stopped source counts what it holds as played: begin from nothing.
            const int target = stage.periodFrames() + spare;
            int queued = playing ? stage.queuedFrames() : 0;
            const bool added = queued < target;
            for (; queued < target; queued += kBlock)
                makeBlock(stage);
            if (!playing) stage.start();
            if (added) {
                // A state given now waits for the next block, which goes behind all that is queued.
                const double nowMs =
                    1e3 * (queued / kSampleRateHz + stage.deviceLatencyS()) + 1e3 * kBlock / kSampleRateHz;
                latencyMs = latencyMs == 0.0 || !playing ? nowMs : latencyMs + 0.02 * (nowMs - latencyMs);
            }
            playing = true;
            const auto now = steady_clock::now();
            if (now >= look) {
                look = now + kLook;
                if (!stage.connected()) return false;
                const std::lock_guard lock(mutex);
                status.silent = false;
                status.device = stage.name();
                status.latencyMs = latencyMs;
            }
            wake = now + kWake;
        }
        return true;
    }
};

Player::Player(const PlayerSettings& settings) : state_(std::make_unique<State>()) {
    state_->settings = settings;
    state_->status.silent = true;
    state_->status.device = "looking for a sound card";
    state_->thread = std::thread([state = state_.get()] { state->run(); });
}

Player::~Player() {
    {
        const std::lock_guard lock(state_->mutex);
        state_->end = true;
    }
    state_->ended.notify_all();
    state_->thread.join();
}

void Player::setDrill(const DrillState& drill) noexcept {
    state_->drill.write(mailOf(drill));
}
void Player::setEar(const Ear& ear) noexcept {
    state_->ear.write(mailOf(ear));
}
void Player::setMix(const Mix& mix) noexcept {
    state_->mix.write(mix);
}

void Player::setRecordings(const Recording& motor, const Recording& cutting) {
    auto motorLoop = loadLoop(motor), cuttingLoop = loadLoop(cutting);
    const std::lock_guard lock(state_->mutex);
    state_->motor = std::move(motorLoop);
    state_->cutting = std::move(cuttingLoop);
    state_->newLoops = true;
}

PlayerStatus Player::status() const {
    const std::lock_guard lock(state_->mutex);
    return state_->status;
}

}  // namespace handpiece::sound
