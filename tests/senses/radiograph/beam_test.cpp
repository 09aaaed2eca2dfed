// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/radiograph/beam.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "support/error_of.h"

namespace handpiece::radiograph::beam_test {
namespace {

using cases::Tissue;

double bandKev(std::size_t band) {
    return kFirstKev + (static_cast<double>(band) + 0.5) * kBandKev;
}

constexpr std::array<double, 5> kKev = {20, 30, 40, 50, 60};

/// Between bands as NIST advises: straight lines of logarithms.
double ours(const Spectrum& perMm, double kev) {
    std::size_t b = 1;
    while (bandKev(b) < kev)
        ++b;
    const double share = std::log(kev / bandKev(b - 1)) / std::log(bandKev(b) / bandKev(b - 1));
    return perMm[b - 1] * std::pow(perMm[b] / perMm[b - 1], share);
}

// Hubbell and Seltzer, NISTIR 5632: mixtures that we put together from elements, as NIST lists them.
constexpr std::array<double, 5> kSoftTissue = {0.8230, 0.3790, 0.2688, 0.2264, 0.2048};
constexpr std::array<double, 5> kCorticalBone = {4.001, 1.331, 0.6655, 0.4242, 0.3148};
constexpr std::array<double, 5> kAluminium = {3.441, 1.128, 0.5685, 0.3681, 0.2778};

TEST(Beam, MixturesAttenuateAsNistHasThem) {
    for (std::size_t n = 0; n < kKev.size(); ++n) {
        const double kev = kKev[n];
        EXPECT_NEAR(ours(attenuationPerMm(Tissue::pulp), kev) / (0.106 * kSoftTissue[n]), 1.0, 0.015) << kev;
        EXPECT_NEAR(ours(attenuationPerMm(Tissue::bone), kev) / (0.192 * kCorticalBone[n]), 1.0, 0.015) << kev;
        EXPECT_NEAR(ours(aluminiumPerMm(), kev) / (0.2699 * kAluminium[n]), 1.0, 0.01) << kev;
    }
}

TEST(Beam, TissuesStandInTheOrderThatRadiographsShow) {
    const auto left = [](Tissue tissue, Filling filling = Filling::amalgam) {
        Paths paths{};
        paths[static_cast<std::size_t>(tissue)] = 3.0;
        return Beam(65.0, 2.0, 10.0, filling).transmission(paths);
    };
    EXPECT_LT(left(Tissue::restoration), 1e-3);  // amalgam lets nothing through
    EXPECT_LT(left(Tissue::restoration, Filling::composite), left(Tissue::enamel));
    EXPECT_LT(left(Tissue::enamel), left(Tissue::neighbour));
    EXPECT_LT(left(Tissue::neighbour), left(Tissue::dentine));
    EXPECT_LT(left(Tissue::dentine), left(Tissue::cementum));
    EXPECT_LT(left(Tissue::cementum), left(Tissue::bone));
    EXPECT_LT(left(Tissue::bone), left(Tissue::caries));
    EXPECT_LT(left(Tissue::enamel), left(Tissue::demineralisedEnamel));
    EXPECT_LT(left(Tissue::demineralisedEnamel), left(Tissue::dentine));
    // The softer, the less is left in the beam's way; sound dentine at the one end, more than soft tissue at the other.
    double before = left(Tissue::pulp);
    for (const Tissue level : cases::kCariousLevels) {
        EXPECT_LT(left(level), before) << cases::properties(level).name;
        before = left(level);
    }
    EXPECT_LT(left(Tissue::dentine), before);
    // Nothing that a case can hold is air.
    for (std::size_t t = 1; t < cases::kTissueCount; ++t)
        EXPECT_LT(left(static_cast<Tissue>(t)), 0.95) << t;
    EXPECT_LT(left(Tissue::bone), left(Tissue::pulp));
    EXPECT_EQ(left(Tissue::pulp), left(Tissue::gum));
}

TEST(Beam, IsAsHardAsDentalTubesAre) {
    // 21 CFR 1020.30(m), intraoral: at least 1.5 mm of aluminium at 70 kV; real tubes have up to about 2.6.
    const double at70 = Beam(70.0, 2.0, 0.0, Filling::amalgam).halfValueLayerMm();
    EXPECT_GT(at70, 1.5);
    EXPECT_LT(at70, 2.6);
    EXPECT_LT(Beam(60.0, 2.0, 0.0, Filling::amalgam).halfValueLayerMm(), at70);
    EXPECT_GT(Beam(70.0, 4.0, 0.0, Filling::amalgam).halfValueLayerMm(), at70);
}

TEST(Beam, TransmissionIsTheSumOverItsBands) {
    const Beam beam(62.0, 2.0, 10.0, Filling::composite);
    Paths paths{};
    for (std::size_t t = 0; t < paths.size(); ++t)
        paths[t] = 0.3 * static_cast<double>(t);
    double known = 0.0, sum = 0.0;
    for (std::size_t b = 0; b < kBands; ++b) {
        double depth = 0.0;
        for (std::size_t t = 1; t < paths.size(); ++t)
            depth += paths[t] * attenuationPerMm(static_cast<Tissue>(t), Filling::composite)[b];
        known += beam.weights()[b] * std::exp(-depth);
        sum += beam.weights()[b];
        if (bandKev(b) - 0.5 * kBandKev > 62.0) {
            EXPECT_EQ(beam.weights()[b], 0.0) << "above the tube's voltage";
        }
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_NEAR(beam.transmission(paths) / known, 1.0, 1e-7);
    EXPECT_NEAR(beam.transmission({}), 1.0, 1e-7);
}

TEST(Beam, OtherVoltagesAndFillingsAreRefused) {
    for (const double kv : {0.0, 49.0, 71.0, std::nan("")})
        EXPECT_NE(test::errorOf([&] { Beam(kv, 2.0, 0.0, Filling::amalgam); }).find("--kv"), std::string::npos);
    EXPECT_NE(test::errorOf([] { (void)fillingByName("gold"); }).find("amalgam or composite"), std::string::npos);
}

}  // namespace
}  // namespace handpiece::radiograph::beam_test
