// SPDX-License-Identifier: Apache-2.0
// A pressed bur at the edge of a tooth: pointer, hand, tick and what the window knows of the tooth, without threads.
#include <gtest/gtest.h>

#include <cstdio>

#include "handpiece/model/starter/starter.h"
#include "station/pointer_hand.h"
#include "station/sitting_fixture.h"

namespace handpiece::station {
namespace {

using core::Vec2;
using core::Vec3;
using messages::HapticSample;

// 0.3 mm of free fall, and what a hand that pressed dips when the tooth is suddenly gone: 0.5 mm under 1 N, and it
// comes back.
constexpr double kLongestFallMm = 0.65;
constexpr int kTicksPerPicture = 33;  // at 1 kHz: thirty pictures a second
const view::Viewport kViewport{900, 700};

/// The window's side and the tick's, one after the other.
struct Bench {
    explicit Bench(Station made, const Vec3& startMm)
        : station(std::move(made)),
          mirror(station.tooth),
          probe(mirror),
          mailbox(std::make_shared<device::PointerMailbox>()),
          hand(mailbox, {startMm, core::Quat::Identity()},
               [this](const view::Ray& ray) { return probe.cast(ray.originMm, ray.direction); }),
          loop({},
               std::make_unique<device::PointerDevice>(device::PointerHandSettings{}, mailbox,
                                                       core::Pose{startMm, core::Quat::Identity()}),
               station.work(), force::defaultParameters()) {
        camera.eyeMm = startMm + Vec3(0, -20, 60);
        camera.targetMm = startMm;
        camera.up = Vec3::UnitZ();
        hand.setEye(camera, kViewport);
        hand.setBur(station.settings.bur->lengthMm(), station.settings.bur->maxRadiusMm());
        hand.setGoneOver([this](const Vec3& p, const Vec3& axis) { return probe.depthAlongMm(p, axis).value_or(0.0); });
    }
    [[nodiscard]] Vec2 pixel(const Vec3& p) const { return view::pixelOf(camera, kViewport, p).value(); }
    [[nodiscard]] Vec3 tip() const { return Vec3(last.proxyPositionMm.data()); }

    /// `at` gives the pixel of a time since the call, or nothing while the pointer stands.
    template <class At>
    void run(double seconds, At&& at) {
        const auto ticks = static_cast<int>(std::lround(seconds / loop.periodS()));
        for (int i = 0; i < ticks; ++i, ++ticksDone) {
            if (ticksDone % 16 == 0)
                if (const std::optional<Vec2> pixel = at(i * loop.periodS())) hand.move(*pixel);
            if (ticksDone % kTicksPerPicture == 0) hand.follow(last);
            loop.tick({});
            loop.fetch([&](const HapticSample& sample) { hear(sample); },
                       [&](const tooth::BrickSnapshot& brick) { mirror.apply(brick); });
        }
    }
    void hear(const HapticSample& sample) {
        last = sample;
        // What rubs at its side does not hold it.
        const Vec3 forceN(sample.forceN.data());
        if (forceN.z() > std::max(0.1, 0.35 * forceN.norm())) {
            heldAtMm = tip().z();
            wasHeld = true;
        } else if (wasHeld) {
            longestFallMm = std::max(longestFallMm, heldAtMm - tip().z());
        }
        lowestMm = std::min(lowestMm, tip().z());
    }

    Station station;
    tooth::CutMirror mirror;
    measure::ToothProbe probe;
    std::shared_ptr<device::PointerMailbox> mailbox;
    PointerHand hand;
    loop::HapticLoop loop;
    view::Camera camera;
    HapticSample last;
    int ticksDone = 0;
    bool wasHeld = false;
    double heldAtMm = 0.0, longestFallMm = 0.0, lowestMm = 1e9;
};
const auto kStands = [](double) { return std::optional<Vec2>(); };

tooth::Case molarCase() {
    tooth::Case molar;
    molar.name = "molar";
    molar.outer = starter::makeOuter(starter::ToothKind::lowerFirstMolar, 10000);
    molar.parts.push_back({"enamel", tooth::Tissue::enamel, 0, molar.outer});
    return molar;
}

class PointerAtAnEdge : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        StationSettings settings;
        settings.field.voxelMm = 0.1;
        settings.bur = burOf("cylinder-round:1.0x4.0");
        block_ = std::make_unique<Station>(makeStation(blockCase(), settings, false));
        molar_ = std::make_unique<Station>(makeStation(molarCase(), settings, false));
    }
    static void TearDownTestSuite() {
        block_.reset();
        molar_.reset();
    }
    static Station fresh(const Station& of) {
        Station station = of;
        station.field = std::make_shared<tooth::CutField>(station.tooth);
        return station;
    }
    /// Near the edge on a side, where the surface still looks up.
    static Vec3 edgeOf(const Station& station, const Vec3& side) {
        const tooth::CutMirror mirror(station.tooth);
        const measure::ToothProbe probe(mirror);
        for (double out = 10.0; out > 0.0; out -= 0.1) {
            const auto hit = probe.cast(topOf(station) + out * side + Vec3(0, 0, 5), -Vec3::UnitZ());
            if (hit && hit->normal.z() > 0.8) return hit->pointMm - 0.5 * side;
        }
        return topOf(station);
    }
    static Vec3 topOf(const Station& station) {
        const core::Box box = station.tooth->tooth->outer.bounds();
        return {box.centre().x(), box.centre().y(), box.max.z()};
    }

    static inline std::unique_ptr<Station> block_, molar_;
};

TEST_F(PointerAtAnEdge, draggedOffAnySideItDoesNotFall) {
    for (const Station* tooth : {block_.get(), molar_.get()}) {
        const core::Box box = tooth->tooth->tooth->outer.bounds();
        for (const Vec3& side : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
            for (const bool turning : {true, false}) {
                for (const double off : {0.3, 0.8, 3.0}) {
                    Bench bench(fresh(*tooth), topOf(*tooth) + Vec3(0, 0, 2));
                    const double half = 0.5 * box.size().cwiseProduct(side).norm();
                    const Vec3 from = edgeOf(*tooth, side);
                    const Vec3 to = from + (half + off - (from - topOf(*tooth)).dot(side)) * side;
                    bench.hand.move(bench.pixel(from));
                    bench.run(0.3, kStands);
                    bench.hand.press(bench.pixel(from), turning);
                    const Vec2 step = bench.pixel(to) - bench.pixel(from);
                    bench.run(1.0, [&](double t) { return std::optional<Vec2>(bench.pixel(from) + t * step); });
                    bench.run(6.0, kStands);
                    std::printf("  %s, side %+.0f %+.0f, %.1f mm off, %s: fell %.3f mm, ends at %.3f, lowest %.3f\n",
                                tooth == block_.get() ? "block" : "molar", side.x(), side.y(), off,
                                turning ? "turning" : "still", bench.longestFallMm, bench.tip().z(), bench.lowestMm);
                    EXPECT_TRUE(bench.wasHeld);
                    EXPECT_LT(bench.longestFallMm, kLongestFallMm);
                }
            }
        }
    }
}

TEST_F(PointerAtAnEdge, pressedOnTheToothItCutsAsDeepAsTheLoadTakesIt) {
    double deep[2];
    for (const bool byHand : {true, false}) {
        Bench bench(fresh(*block_), Vec3(0, 0, 0.5));
        if (byHand) {
            bench.hand.setLoad(kMostLoadN);
            bench.hand.move(bench.pixel(Vec3::Zero()));
            bench.run(0.2, kStands);
            bench.hand.press(bench.pixel(Vec3::Zero()), true);
            bench.run(1.0, kStands);
        } else {
            device::PointerTarget freely;  // nothing but the load
            freely.positionMm[2] = 0.5;
            bench.mailbox->write(freely);
            const auto tick = [&] {
                bench.loop.tick({});
                bench.loop.fetch([&](const HapticSample& sample) { bench.hear(sample); },
                                 [](const tooth::BrickSnapshot&) {});
            };
            for (int i = 0; i < 200; ++i)
                tick();
            freely.loadN = kMostLoadN;
            freely.pedal = 1.0;
            bench.mailbox->write(freely);
            for (int i = 0; i < 1000; ++i)
                tick();
        }
        deep[byHand ? 0 : 1] = -bench.tip().z();
    }
    std::printf("  %.3f mm in a second by the hand, %.3f mm by the load alone\n", deep[0], deep[1]);
    EXPECT_GT(deep[0], 0.5);
    EXPECT_NEAR(deep[0], deep[1], 0.02 * deep[1]);
}

}  // namespace
}  // namespace handpiece::station
