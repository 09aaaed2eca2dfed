// SPDX-License-Identifier: Apache-2.0
#include "handpiece/record/session/event_watch.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace handpiece::session::event_watch_test {
namespace {

using cases::Tissue;
using messages::HapticSample;

struct Watched {
    std::vector<std::string> told;
    EventWatch watch{[this](std::uint64_t tick, EventName name, std::string_view) {
        told.push_back(std::to_string(tick) + " " + std::string(nameOf(name)));
    }};
    HapticSample sample;
    void tick(double seconds = 0.001) {
        ++sample.tick;
        sample.timeS += seconds;
        watch.look(sample);
    }
    double& removed(Tissue t) { return sample.removedMm3[static_cast<std::size_t>(t)]; }
};

TEST(EventWatch, aStrokeEndsWhenThePedalIsUpAndEveryBrickWasHandedOver) {
    Watched w;
    w.tick();
    w.sample.pedal = 1.0;
    w.tick();
    w.tick();
    w.sample.pedal = 0.0;
    w.sample.waitingBricks = 3;
    w.tick();
    EXPECT_TRUE(w.watch.inStroke());
    w.sample.waitingBricks = 0;
    w.tick();
    EXPECT_FALSE(w.watch.inStroke());
    EXPECT_EQ(w.watch.strokes(), 1u);
    EXPECT_EQ(w.told, (std::vector<std::string>{"2 stroke begin", "5 stroke end"}));
}

TEST(EventWatch, tellsWhereTheBurCameToOnceAndAgainAfterAnUndo) {
    Watched w;
    w.removed(Tissue::enamel) = 1.0;
    w.tick();
    w.removed(Tissue::dentine) = 1e-6;  // grit
    w.tick();
    w.removed(Tissue::dentine) = 0.1;
    w.tick();
    w.tick();
    w.removed(Tissue::pulp) = 0.01;
    w.tick();
    w.removed(Tissue::pulp) = 0.0;
    w.tick();
    w.removed(Tissue::pulp) = 0.01;
    w.tick();
    EXPECT_EQ(w.told, (std::vector<std::string>{"3 first dentine", "5 pulp exposure", "7 pulp exposure"}));
}

TEST(EventWatch, limitsAndStallsAreToldAsTheyBeginAndNotTooOften) {
    Watched w;
    for (int i = 0; i < 5; ++i) {  // flickers within a second
        w.sample.flags = messages::kForceLimited;
        w.tick();
        w.sample.flags = 0;
        w.tick();
    }
    EXPECT_EQ(w.told.size(), 1u);
    w.tick(2.0);
    w.sample.flags = messages::kForceLimited | messages::kStalled;
    w.tick();
    w.tick();
    EXPECT_EQ(w.told.size(), 3u);
    w.sample.flags = messages::kFault;
    w.tick();
    EXPECT_EQ(w.told.back(), "14 fault");
}

}  // namespace
}  // namespace handpiece::session::event_watch_test
