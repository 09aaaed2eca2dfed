// SPDX-License-Identifier: Apache-2.0
// The knock of a strike and the hum of a bur: what they sound like to a hand, and what they must never do.
#include "handpiece/tick/force/event_based_force.h"

#include <gtest/gtest.h>

#include <complex>
#include <cstdio>
#include <random>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/tick/force/wave.h"
#include "tick/force/analytic_methods.h"

namespace handpiece::force::event_based_force_test {
namespace {

using cases::Tissue;
using core::Pose;
using core::Vec3;

std::vector<double> knock(Tissue tissue, double speedMmS, double rateHz, double gain = 1.0) {
    ContactTransient transient(rateHz, 1.0);
    ContactTransient::Strike strike;
    strike.normal = Vec3::UnitZ();
    strike.tissue = tissue;
    strike.velocityMmS = Vec3(0, 0, -speedMmS);
    const ContactTransients on{true, gain};
    (void)transient.step(strike, on, 0.1);  // apart
    strike.touching = true;
    std::vector<double> wave;
    for (double t = 0.0; t < 0.1; t += 1.0 / rateHz)
        wave.push_back(transient.step(strike, on, 1.0 / rateHz).z());
    return wave;
}
double peakOf(const std::vector<double>& wave) {
    double peak = 0.0;
    for (const double v : wave)
        peak = std::max(peak, std::abs(v));
    return peak;
}
/// Mean frequency over the zero crossings of the first 30 ms.
double pitchOf(const std::vector<double>& wave, double rateHz) {
    int crossings = 0;
    std::size_t first = 0, last = 0;
    for (std::size_t i = 1; i < wave.size() && static_cast<double>(i) < 0.03 * rateHz; ++i) {
        if ((wave[i - 1] < 0.0) == (wave[i] < 0.0)) continue;
        if (crossings++ == 0) first = i;
        last = i;
    }
    return crossings < 2 ? 0.0 : 0.5 * (crossings - 1) * rateHz / static_cast<double>(last - first);
}

TEST(Wave, sineAndDecayAreThoseOfTheLibrary) {
    for (double x = -2.0; x <= 2.0; x += 0.00037)
        ASSERT_NEAR(sineOfTurns(x), std::sin(2.0 * M_PI * x), 1e-7) << x;
    for (double x = 0.0; x <= 1.0; x += 0.01)
        ASSERT_NEAR(decayOver(x), std::exp(-x), 1e-3) << x;
    for (double x = 0.0; x <= 1000.0; x += 0.5) {
        ASSERT_GE(decayOver(x), 0.0) << x;
        ASSERT_LE(decayOver(x), 1.0) << x;
    }
}

TEST(ContactTransient, hardTissueKnocksHighAndSoftTissueNotAtAll) {
    const double rate = 8000;
    const auto enamel = knock(Tissue::enamel, 60, rate), dentine = knock(Tissue::dentine, 60, rate);
    EXPECT_NEAR(pitchOf(enamel, rate), knockOf(Tissue::enamel).hz, 10.0);
    EXPECT_NEAR(pitchOf(dentine, rate), knockOf(Tissue::dentine).hz, 10.0);
    EXPECT_GT(pitchOf(enamel, rate), 1.3 * pitchOf(dentine, rate));
    EXPECT_GT(peakOf(enamel), 0.45);
    EXPECT_LT(peakOf(enamel), 0.60);
    EXPECT_GT(peakOf(enamel), 1.3 * peakOf(dentine));
    EXPECT_GT(peakOf(dentine), 0.2);
    for (const Tissue soft : {Tissue::caries, Tissue::gum, Tissue::pulp})
        EXPECT_EQ(peakOf(knock(soft, 60, rate)), 0.0);
    EXPECT_GT(enamel[0], 0.0);                                // outwards first, in the tick of the strike
    EXPECT_LT(std::abs(enamel[400]), 0.01 * peakOf(enamel));  // and gone after 50 ms
}

TEST(ContactTransient, growsWithTheSpeedOfTheStrikeUpToWhatTheArmMayGive) {
    const double slow = peakOf(knock(Tissue::enamel, 20, 4000)), fast = peakOf(knock(Tissue::enamel, 40, 4000));
    EXPECT_NEAR(fast, 2.0 * slow, 1e-9);
    EXPECT_NEAR(peakOf(knock(Tissue::enamel, 20, 4000, 2.0)), fast, 1e-9);
    EXPECT_LE(peakOf(knock(Tissue::enamel, 5000, 4000)), 1.0);
    EXPECT_EQ(peakOf(knock(Tissue::enamel, 2, 4000)), 0.0);  // laid down
    for (const double rate : {100.0, 500.0, 1000.0, 8000.0})
        EXPECT_LE(pitchOf(knock(Tissue::enamel, 60, rate), rate), 0.33 * rate) << rate;
}

TEST(ContactTransient, aBurThatChattersDoesNotStrikeAnew) {
    ContactTransient transient(1000, 1.0);
    ContactTransient::Strike strike;
    strike.normal = Vec3::UnitZ();
    strike.tissue = Tissue::enamel;
    strike.velocityMmS = Vec3(0, 0, -60);
    const ContactTransients on{true, 1.0};
    int strikes = 0;
    for (int i = 0; i < 300; ++i) {
        strike.touching = i % 4 != 0;
        const double before = transient.amplitudeN();
        (void)transient.step(strike, on, 1e-3);
        strikes += transient.amplitudeN() > before;
    }
    EXPECT_EQ(strikes, 1);
}

/// In place, size a power of two.
void fourier(std::vector<std::complex<double>>& a) {
    const std::size_t n = a.size();
    for (std::size_t i = 1, j = 0; i < n; ++i) {
        std::size_t bit = n >> 1;
        for (; (j & bit) != 0; bit >>= 1)
            j ^= bit;
        j ^= bit;
        if (i < j) std::swap(a[i], a[j]);
    }
    for (std::size_t length = 2; length <= n; length *= 2) {
        for (std::size_t i = 0; i < n; i += length) {
            for (std::size_t k = 0; k < length / 2; ++k) {
                const double angle = -2.0 * M_PI * static_cast<double>(k) / static_cast<double>(length);
                const std::complex<double> v = a[i + k + length / 2] * std::polar(1.0, angle), u = a[i + k];
                a[i + k] = u + v;
                a[i + k + length / 2] = u - v;
            }
        }
    }
}

/// A second of work on enamel and dentine that begins and ends at once, with the load of an unsteady hand.
std::vector<double> hum(double rateHz) {
    BurHum hum(rateHz, 0.5);
    const CuttingVibration on{true, 1.0};
    std::vector<double> wave;
    for (double t = 0.0; t < 1.9; t += 1.0 / rateHz) {
        BurHum::Work work;
        const bool pressed = t > 0.1 && t < 1.3;
        work.loadN = pressed ? 1.0 + 0.4 * std::sin(2 * M_PI * 7.0 * t) : 0.0;
        work.speedRpm = pressed ? 350000 : 400000;
        work.feedMmS = pressed ? 0.5 : 0.0;
        work.tissue = t < 0.7 ? Tissue::enamel : Tissue::dentine;
        work.headroomN = 2.0;
        wave.push_back(hum.step(work, on, 1.0 / rateHz));
    }
    return wave;
}

TEST(CuttingVibration, liesBetween100And400HzAtEveryRate) {
    for (const double rate : {1000.0, 2000.0, 4000.0, 8000.0}) {
        const std::vector<double> wave = hum(rate);
        EXPECT_LT(std::abs(wave.back()), 1e-4);  // it has died away: no window is needed
        std::vector<std::complex<double>> spectrum(wave.begin(), wave.end());
        std::size_t n = 1;
        while (n < spectrum.size())
            n *= 2;
        spectrum.resize(n);
        fourier(spectrum);
        double inside = 0.0, outside = 0.0;
        for (std::size_t i = 0; i <= n / 2; ++i) {
            const double hz = static_cast<double>(i) * rate / static_cast<double>(n);
            (hz >= 100.0 && hz <= 400.0 ? inside : outside) += std::norm(spectrum[i]);
        }
        double mean = 0.0;
        for (const double v : wave)
            mean += v / static_cast<double>(wave.size());
        const double db = 10.0 * std::log10(outside / inside);
        std::printf("  %4.0f Hz: peak %.3f N, outside 100 to 400 Hz %.1f dB, mean %.1e N\n", rate, peakOf(wave), db,
                    mean);
        EXPECT_LT(db, -40.0) << rate;
        EXPECT_LT(std::abs(mean), 1e-4) << rate;
        EXPECT_GT(peakOf(wave), 0.1) << rate;
        EXPECT_EQ(wave, hum(rate)) << rate;
    }
}

double settled(BurHum::Work work, double gain = 1.0) {
    BurHum hum(1000, 0.5);
    for (int i = 0; i < 300; ++i)
        (void)hum.step(work, {gain > 0.0, gain}, 1e-3);
    return hum.amplitudeN();
}

TEST(CuttingVibration, followsLoadTissueFeedAndTheRotor) {
    BurHum::Work work;
    work.loadN = 0.5;
    work.speedRpm = 350000;
    work.feedMmS = 0.5;
    work.tissue = Tissue::enamel;
    work.headroomN = 3.0;
    const double enamel = settled(work);
    EXPECT_GT(enamel, 0.05);
    EXPECT_NEAR(settled(work, 2.0), 2.0 * enamel, 1e-6);
    EXPECT_EQ(settled(work, 0.0), 0.0);
    const auto with = [&](auto&& change) {
        BurHum::Work other = work;
        change(other);
        return settled(other);
    };
    EXPECT_NEAR(with([](auto& w) { w.loadN = 1.0; }), 2.0 * enamel, 1e-6);
    EXPECT_LT(with([](auto& w) { w.tissue = Tissue::dentine; }), 0.7 * enamel);
    EXPECT_LT(with([](auto& w) { w.tissue = Tissue::caries; }), 0.3 * enamel);
    EXPECT_LT(with([](auto& w) { w.feedMmS = 0.0; }), 0.6 * enamel);
    EXPECT_EQ(with([](auto& w) { w.speedRpm = 0.0; }), 0.0);  // a bur that stands does not hum
    EXPECT_NEAR(with([](auto& w) { w.headroomN = 0.01; }), 0.01, 1e-6);
    EXPECT_LE(with([](auto& w) { w.loadN = 100.0; }), 0.5);

    BurHum fast(1000, 0.5), slow(1000, 0.5);
    for (int i = 0; i < 300; ++i) {
        (void)fast.step(work, {true, 1.0}, 1e-3);
        BurHum::Work tired = work;
        tired.speedRpm = 100000;
        (void)slow.step(tired, {true, 1.0}, 1e-3);
    }
    EXPECT_NEAR(fast.lowerHz(), 207.5, 0.1);
    EXPECT_NEAR(slow.lowerHz(), 145.0, 0.1);
}

/// A bur on a plane of enamel with all that is added, led by hand.
struct Bench {
    explicit Bench(bool on, double rateHz = 1000)
        : periodS(1.0 / rateHz), model(limits, parameters(on)), crisp(limits, rateHz) {}
    static Parameters parameters(bool on) {
        Parameters p = defaultParameters();
        p.transients = {on, 4.0};
        p.vibration = {on, 4.0};
        return p;
    }
    Vec3 go(const Pose& pose, const BurAtWork& bur, bool lost = false) {
        const Touch& touch = model.feel(method, pose, lost, periodS);
        command = model.compute(touch, periodS);
        return crisp.add(model, touch, command, bur, periodS);
    }
    Limits limits;
    double periodS;
    test::AnalyticMethod method{test::plane(), 0.5, 4.0};
    ForceModel model;
    EventBasedForce crisp;
    ForceCommand command;
};

TEST(EventBasedForce, staysWithinTheDeviceAndNeverPulls) {
    const unsigned seed = std::random_device{}();
    std::printf("  seed %u\n", seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (const bool sideways : {false, true}) {
        const double rate = sideways ? 1000.0 : 2000.0;
        Bench bench(true, rate);
        Vec3 position(0, 0, 1), velocity(0, 0, -50), last = Vec3::Zero();
        double most = 0.0, added = 0.0;
        for (int i = 0; i < static_cast<int>(1.2 * rate); ++i) {
            velocity += Vec3(uniform(random), uniform(random), uniform(random)) * 4000.0 * std::sqrt(bench.periodS);
            velocity -= bench.periodS * (20.0 * velocity + Vec3(0, 0, 2000.0 * (position.z() + 0.3)));
            if (!sideways) velocity.x() = velocity.y() = 0.0;
            position += velocity * bench.periodS;
            const Vec3 force = bench.go({position, core::Quat::Identity()}, {350000, 0.5}, i % 701 == 700);
            ASSERT_TRUE(force.allFinite());
            ASSERT_LE(force.norm(), bench.limits.maxForceN + 1e-9);
            ASSERT_LE((force - last).norm(), bench.limits.maxForceSlopeNPerS * bench.periodS + 1e-9);
            // Straight down on the plane the hum lies across: along the normal there is contact and knock alone.
            ASSERT_GE(force.z(), sideways ? -bench.limits.maxForceN : -1e-9) << i;
            most = std::max(most, force.norm());
            added = std::max(added, (force - bench.command.forceN).norm());
            last = force;
        }
        EXPECT_GT(most, 0.5);
        EXPECT_GT(added, 0.2);
    }
}

TEST(EventBasedForce, isTheForceItselfWhenOffAndSilentInDoubt) {
    Bench off(false), on(true);
    double added = 0.0;
    for (int i = 0; i < 400; ++i) {
        const Pose pose{Vec3(0, 0, 0.5 - 0.01 * i), core::Quat::Identity()};
        const Vec3 force = off.go(pose, {350000, 0.5});
        ASSERT_EQ(force, off.command.forceN);
        const Vec3 more = on.go(pose, {350000, 0.5});
        ASSERT_EQ(on.command.forceN, off.command.forceN);  // what is added changes nothing of what it is added to
        ASSERT_EQ(on.command.loadN, off.command.loadN);
        ASSERT_EQ(on.command.fullTorqueNmm, off.command.fullTorqueNmm);
        added = std::max(added, (more - force).norm());
    }
    EXPECT_GT(added, 0.2);
    EXPECT_GT(on.crisp.vibrationN(), 0.05);
    for (int i = 0; i < 3; ++i) {
        const Vec3 force = on.go({Vec3(0, 0, -3.5), core::Quat::Identity()}, {350000, 0.5}, true);
        EXPECT_EQ(force, on.command.forceN);
        EXPECT_EQ(on.crisp.vibrationN(), 0.0);
    }
    Parameters wrong = defaultParameters();
    wrong.vibration.gain = -1.0;
    EXPECT_THROW(validate(wrong), core::Error);
    wrong = defaultParameters();
    wrong.transients.gain = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(validate(wrong), core::Error);
}

}  // namespace
}  // namespace handpiece::force::event_based_force_test
