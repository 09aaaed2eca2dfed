// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/cut_session.h"

#include <fmt/format.h>

#include "handpiece/base/core/error.h"
#include "handpiece/model/tooth/state_file.h"

namespace handpiece::simulation {
namespace {

using session::EventName;

// Key frames: any instant opens within a second when the next earlier one is some ten seconds away; and they stay the
// smaller part of a session's hundred megabytes an hour.
constexpr double kKeyFrameEveryS = 10.0;
constexpr double kKeyFrameFirstBytes = 4e6, kKeyFrameBytesPerS = 8e3;

std::vector<int> fdiNumbersOf(const SimulationSetup& station) {
    std::vector<int> numbers;
    for (const StandingTooth& other : station.others)
        numbers.push_back(other.fdiNumber);
    return numbers;
}

}  // namespace

std::string hashText(std::uint64_t stateHash) {
    return fmt::format("{:016x}", stateHash);
}

CutSession::CutSession(const SimulationSetup& station, session::Recorder* recorder, bool mayWait,
                       const history::History* before)
    : recorder_(recorder),
      mayWait_(mayWait),
      identity_(station.identity()),
      mirror_(station.teeth()),
      source_(mirror_),
      watch_([this](std::uint64_t tick, EventName name, std::string_view text) { tell(tick, name, text); },
             fdiNumbersOf(station)) {
    const tooth::StateDelta state = station.state();
    mirror_.apply(state);
    if (before != nullptr)
        history_ = *before;
    else
        history_.start(state);
    removedMm3_ = state.removedMm3;
    if (recorder_ != nullptr && station.settings.resumed) recorder_->keyFrame(0, tooth::encodeState(state, identity_));
}

void CutSession::tell(std::uint64_t tick, EventName name, std::string_view text) {
    if (recorder_ != nullptr) recorder_->event(tick, name, text);
    if (listener_) listener_(tick, name);
}

void CutSession::tellWhenTaken(std::uint64_t command, EventName name, std::string text) {
    pending_.push_back({command, name, std::move(text)});
}

void CutSession::correct(const tooth::StateDelta& state) {
    const tooth::StateDelta change = tooth::changeBetween(mirror_.state(), state);
    mirror_.apply(change);
    for (const tooth::StateDelta::Brick& brick : change.bricks)
        history_.noteTouched(brick.id);
    removedMm3_ = state.removedMm3;
}

void CutSession::settle(const tooth::StateDelta& state) {
    if (state.removedMm3 == history_.removedMm3()) return;
    correct(state);
    history_.endStroke(source_, state.removedMm3);
}

void CutSession::hear(const tooth::BrickSnapshot& brick) {
    mirror_.apply(brick);
    history_.noteTouched(brick.id);
    if (const std::uint16_t tooth = tooth::toothOf(brick.id); tooth > 0) removedMm3_.set(tooth, brick.removedMm3);
}

void CutSession::hear(const messages::HapticSample& sample) {
    for (; !pending_.empty() && pending_.front().command <= sample.lastCommand; pending_.pop_front())
        tell(sample.tick, pending_.front().name, pending_.front().text);
    watch_.look(sample);
    removedMm3_.own = sample.removedMm3;
    hasRestored_ = hasRestored_ || (sample.flags & messages::kRestoring) != 0;
    if (recorder_ != nullptr) {
        const session::Record record = session::recordOf(sample);
        if (mayWait_)
            recorder_->pushWaiting(record);
        else
            recorder_->push(record);
    }
    if (watch_.strokes() != strokes_) {
        strokes_ = watch_.strokes();
        history_.endStroke(source_, removedMm3_);
        keepKeyFrame(sample);
    } else if (hasRestored_ && (sample.flags & messages::kRestoring) == 0 && sample.waitingBricks == 0) {
        // A jump past this step finds the tooth here, whatever was done before it.
        keepKeyFrame(sample);
    } else if (watch_.inStroke() && sample.timeS - lastKeyFrameS_ > kKeyFrameEveryS && sample.waitingBricks == 0) {
        keepKeyFrame(sample);
    }
}

void CutSession::keepKeyFrame(const messages::HapticSample& sample) {
    hasRestored_ = false;
    if (recorder_ == nullptr) return;
    if (keyFrameBytes_ > kKeyFrameFirstBytes + kKeyFrameBytesPerS * sample.timeS) return;
    lastKeyFrameS_ = sample.timeS;
    std::vector<std::byte> bytes = tooth::encodeState(state(), identity_);
    keyFrameBytes_ += static_cast<double>(bytes.size());
    recorder_->keyFrame(sample.tick, std::move(bytes));
}

bool CutSession::take(Step step, loop::HapticLoop& loop) {
    return !watch_.inStroke() && takeAgain(step, loop);
}

bool CutSession::takeAgain(Step step, loop::HapticLoop& loop) {
    if (loop.restoring()) return false;
    auto change = step == Step::undo ? history_.undo() : step == Step::redo ? history_.redo() : history_.reset();
    if (!change) return false;
    mirror_.apply(*change);
    removedMm3_.others = change->removedMm3.others;
    const std::uint64_t command = loop.restore(std::move(*change));
    tellWhenTaken(command,
                  step == Step::undo   ? EventName::undo
                  : step == Step::redo ? EventName::redo
                                       : EventName::reset,
                  "");
    return true;
}

void CutSession::finish(const tooth::StateDelta& state, std::uint64_t tick) {
    if (recorder_ == nullptr) return;
    recorder_->keyFrame(tick, tooth::encodeState(state, identity_));
    recorder_->event(tick, EventName::end,
                     fmt::format("{{\"state_hash\": \"{}\"}}", hashText(tooth::stateHash(state))));
}

}  // namespace handpiece::simulation
