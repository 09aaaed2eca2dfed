// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Force by time on what must not be pressed. Private to this room.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/assess/measures/measure.h"

namespace handpiece::hand {

/// The moment at which something was greatest.
struct Moment {
    std::optional<double> value;
    measures::Evidence at;
    void take(double v, const measures::Evidence& now) {
        if (value && v <= *value) return;
        value = v;
        at = now;
    }
    [[nodiscard]] std::vector<measures::Evidence> told(std::string text) const {
        if (!value) return {};
        measures::Evidence evidence = at;
        evidence.text = std::move(text);
        return {evidence};
    }
};

struct Impulse {
    double newtonSeconds = 0.0, lastsS = 0.0;
    std::optional<measures::Evidence> first;
    Moment worst;
    void take(double forceN, double lastsS_, const measures::Evidence& now) {
        if (!(forceN > 0.0)) return;
        newtonSeconds += forceN * lastsS_;
        lastsS += lastsS_;
        if (!first) first = now;
        worst.take(forceN, now);
    }
    /// Of what came after.
    void add(const Impulse& later) {
        newtonSeconds += later.newtonSeconds;
        lastsS += later.lastsS;
        if (!first) first = later.first;
        if (later.worst.value) worst.take(*later.worst.value, later.worst.at);
    }
};

}  // namespace handpiece::hand
