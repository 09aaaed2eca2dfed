// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/hand/standing_impulse.h"

#include <utility>

namespace handpiece::hand {

/// What was pressed since belongs to the last step that stands.
void StandingImpulse::settle() {
    for (const auto& [on, impulse] : since_)
        steps_[done_ - 1].pressed[on].add(impulse);
    since_.clear();
}

void StandingImpulse::endStroke(bool hasRemoved) {
    if (!hasRemoved) return settle();
    steps_.resize(done_);  // nothing is left to be done again
    steps_.push_back({std::exchange(since_, {}), false});
    ++done_;
}

void StandingImpulse::undo() {
    since_.clear();
    // What was cut before the record began may be taken back too: nothing is known of it.
    if (done_ > 1) --done_;
}

void StandingImpulse::redo() {
    settle();
    if (done_ < steps_.size()) ++done_;
}

void StandingImpulse::reset() {
    settle();
    steps_.resize(done_);
    steps_.push_back({{}, true});
    ++done_;
}

Impulse StandingImpulse::on(int tissue) const {
    std::size_t from = done_ - 1;
    while (from > 0 && !steps_[from].isReset)
        --from;
    Impulse sum;
    const auto add = [&](const Pressed& pressed) {
        if (const auto at = pressed.find(tissue); at != pressed.end()) sum.add(at->second);
    };
    for (std::size_t i = from; i < done_; ++i)
        add(steps_[i].pressed);
    add(since_);
    return sum;
}

}  // namespace handpiece::hand
