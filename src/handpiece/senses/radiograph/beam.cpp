// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/radiograph/beam.h"

#include <fmt/format.h>

#include <algorithm>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::radiograph {
namespace {

using cases::Tissue;

enum Element {
    hydrogen,
    carbon,
    nitrogen,
    oxygen,
    aluminium,
    phosphorus,
    calcium,
    copper,
    silver,
    tin,
    iodine,
    caesium,
    mercury,
    kElements
};

/// Mass attenuation with coherent scattering [cm2/g], mean over each band: NIST XCOM as xraylib 4.0.0 holds it.
constexpr std::array<Spectrum, kElements> kMassAttenuation = {{
    {{0.3746, 0.3712, 0.3679, 0.3647, 0.3616, 0.3585, 0.3556, 0.3527, 0.3499, 0.3472, 0.3445,
      0.3419, 0.3393, 0.3368, 0.3343, 0.3319, 0.3295, 0.3272, 0.3249, 0.3227, 0.3205, 0.3183}},  // hydrogen
    {{0.6773, 0.5011, 0.3997, 0.3369, 0.2957, 0.2674, 0.2471, 0.232,  0.2205, 0.2115, 0.2043,
      0.1983, 0.1933, 0.189,  0.1853, 0.1821, 0.1792, 0.1765, 0.1742, 0.172,  0.17,   0.1681}},  // carbon
    {{1.016,  0.7179, 0.5466, 0.4409, 0.3721, 0.3251, 0.2918, 0.2674, 0.249,  0.2348, 0.2235,
      0.2145, 0.207,  0.2007, 0.1954, 0.1909, 0.1869, 0.1834, 0.1802, 0.1774, 0.1749, 0.1725}},  // nitrogen
    {{1.49,   1.022,  0.7533, 0.5876, 0.4798, 0.4066, 0.3549, 0.3173, 0.2892, 0.2676, 0.2507,
      0.2372, 0.2263, 0.2173, 0.2097, 0.2033, 0.1977, 0.1929, 0.1887, 0.185,  0.1816, 0.1786}},  // oxygen
    {{6.361,  4.181,  2.912,  2.126,  1.613,  1.265,  1.019,  0.8417, 0.71,   0.6101, 0.533,
      0.4724, 0.4242, 0.3851, 0.3532, 0.3268, 0.3047, 0.2861, 0.2703, 0.2567, 0.245,  0.2348}},  // aluminium
    {{9.912,  6.512,  4.522,  3.282,  2.47,   1.917,  1.527,  1.244,  1.035,  0.8758, 0.7532,
      0.6571, 0.5805, 0.5187, 0.4682, 0.4264, 0.3917, 0.3625, 0.3377, 0.3165, 0.2984, 0.2826}},  // phosphorus
    {{23.95, 15.85, 11.04, 8.002,  5.997,  4.62,   3.644,  2.933,  2.402,  1.999,  1.687,
      1.441, 1.246, 1.088, 0.9593, 0.8532, 0.7649, 0.6909, 0.6282, 0.5748, 0.5291, 0.4896}},  // calcium
    {{60.12, 40.62, 28.76, 21.1,  15.94, 12.34, 9.757, 7.854, 6.422, 5.324, 4.467,
      3.789, 3.246, 2.805, 2.444, 2.145, 1.896, 1.686, 1.509, 1.357, 1.227, 1.115}},  // copper
    {{32.48, 22,    15.66, 11.59, 42.3,  41.02, 33.08, 27.05, 22.39, 18.74, 15.86,
      13.54, 11.67, 10.12, 8.845, 7.775, 6.874, 6.109, 5.456, 4.895, 4.411, 3.99}},  // silver
    {{37.92, 25.71, 18.31, 13.54, 10.34, 22.17, 37.66, 31.09, 25.61, 21.26, 17.89,
      15.26, 13.17, 11.45, 10.03, 8.832, 7.818, 6.954, 6.216, 5.58,  5.031, 4.553}},  // tin
    {{44.84, 30.45, 21.7,  16.06, 12.26, 9.615, 7.697, 28.28, 28.55, 24.03, 20.43,
      17.52, 15.15, 13.19, 11.55, 10.18, 9.012, 8.022, 7.175, 6.446, 5.815, 5.266}},  // iodine
    {{49.69, 33.77, 24.09, 17.83, 13.62, 10.68, 8.548, 6.961, 20.28, 25.91, 22.01,
      18.92, 16.41, 14.32, 12.57, 11.08, 9.813, 8.734, 7.813, 7.021, 6.337, 5.742}},  // caesium
    {{138.4, 96.22, 69.75, 52.19, 40.24, 31.8,  25.59, 20.92, 17.36, 14.59, 12.4,
      10.63, 9.195, 8.019, 7.042, 6.223, 5.533, 4.946, 4.443, 4.01,  3.634, 3.307}},  // mercury
}};

/// Share of the weight of each element.
using Composition = std::array<double, kElements>;

constexpr Composition of(std::initializer_list<std::pair<Element, double>> shares) {
    Composition c{};
    for (const auto& [element, share] : shares)
        c[element] += share;
    return c;
}
constexpr Composition mix(std::initializer_list<std::pair<const Composition*, double>> parts) {
    Composition c{};
    for (const auto& [part, share] : parts)
        for (std::size_t e = 0; e < kElements; ++e)
            c[e] += share * (*part)[e];
    return c;
}

constexpr Composition kWater = of({{hydrogen, 0.1119}, {oxygen, 0.8881}});
constexpr Composition kHydroxyapatite =
    of({{hydrogen, 0.0020}, {oxygen, 0.4141}, {phosphorus, 0.1850}, {calcium, 0.3989}});
constexpr Composition kCollagen = of({{hydrogen, 0.067}, {carbon, 0.531}, {nitrogen, 0.171}, {oxygen, 0.231}});
/// ICRU 44 soft tissue and cortical bone; their traces count as their nearest neighbour here.
constexpr Composition kSoft = of(
    {{hydrogen, 0.102}, {carbon, 0.143}, {nitrogen, 0.034}, {oxygen, 0.710}, {phosphorus, 0.0085}, {calcium, 0.0025}});
constexpr Composition kCortical = of({{hydrogen, 0.034},
                                      {carbon, 0.155},
                                      {nitrogen, 0.042},
                                      {oxygen, 0.435},
                                      {aluminium, 0.003},
                                      {phosphorus, 0.106},
                                      {calcium, 0.225}});
constexpr Composition kAmalgam = of({{mercury, 0.50}, {silver, 0.34}, {tin, 0.12}, {copper, 0.04}});
constexpr Composition kCaesiumIodide = of({{caesium, 0.5115}, {iodine, 0.4885}});
constexpr Composition kAluminium = of({{aluminium, 1.0}});

constexpr double kMineralGCm3 = 3.16, kWaterGCm3 = 1.0;
constexpr double kEnamelGCm3 = 2.95, kDentineGCm3 = 2.14, kCementumGCm3 = 2.03;
constexpr double kEnamelMineral = 0.96, kDentineMineral = 0.70, kCementumMineral = 0.61;  // of the weight
/// Mineral that carious tissue has lost, water in its place: caries as one tissue, then the levels in their order, soft
/// first; and enamel whose surface stands.
constexpr double kCariesLost = 0.5, kEnamelLost = 0.35;
constexpr std::array<double, cases::kCariousLevels.size()> kLevelLost = {0.85, 0.70, 0.55, 0.42, 0.30, 0.20};
constexpr double kCalculusGCm3 = 2.0, kCalculusMineral = 0.75;
constexpr double kNeighbourEnamel = 0.3;  ///< of the volume of an adjacent tooth that is one surface
constexpr double kCompositeMmAl = 2.5;    ///< aluminium that 1 mm of composite equals

Spectrum perMm(const Composition& c, double gCm3) {
    Spectrum s{};
    for (std::size_t b = 0; b < kBands; ++b) {
        double sum = 0.0;
        for (std::size_t e = 0; e < kElements; ++e)
            sum += c[e] * kMassAttenuation[e][b];
        s[b] = 0.1 * gCm3 * sum;
    }
    return s;
}

Spectrum blend(double aShare, const Spectrum& a, double bShare, const Spectrum& b) {
    Spectrum s{};
    for (std::size_t n = 0; n < kBands; ++n)
        s[n] = aShare * a[n] + bShare * b[n];
    return s;
}

struct Table {
    std::array<Spectrum, cases::kTissueCount> tissue{};
    Spectrum composite{}, aluminium{}, scintillator{};
};

Table makeTable() {
    Table t;
    const auto at = [&](Tissue tissue) -> Spectrum& { return t.tissue[static_cast<std::size_t>(tissue)]; };
    const auto hard = [](double mineral, double organic, double gCm3) {
        return perMm(mix({{&kHydroxyapatite, mineral}, {&kCollagen, organic}, {&kWater, 1.0 - mineral - organic}}),
                     gCm3);
    };
    at(Tissue::enamel) = hard(kEnamelMineral, 0.01, kEnamelGCm3);
    at(Tissue::dentine) = hard(kDentineMineral, 0.20, kDentineGCm3);
    at(Tissue::cementum) = hard(kCementumMineral, 0.27, kCementumGCm3);
    const auto less = [](const Spectrum& sound, double lostGCm3) {
        return blend(1.0, sound, 1.0,
                     blend(-1.0, perMm(kHydroxyapatite, lostGCm3), lostGCm3 / kMineralGCm3, perMm(kWater, kWaterGCm3)));
    };
    const double dentineGCm3 = kDentineMineral * kDentineGCm3;
    at(Tissue::caries) = less(at(Tissue::dentine), kCariesLost * dentineGCm3);
    for (std::size_t level = 0; level < kLevelLost.size(); ++level)
        at(cases::kCariousLevels[level]) = less(at(Tissue::dentine), kLevelLost[level] * dentineGCm3);
    at(Tissue::demineralisedEnamel) = less(at(Tissue::enamel), kEnamelLost * kEnamelMineral * kEnamelGCm3);
    at(Tissue::stainedEnamel) = at(Tissue::enamel);
    at(Tissue::calculus) = hard(kCalculusMineral, 0.10, kCalculusGCm3);
    at(Tissue::pulp) = at(Tissue::gum) = perMm(kSoft, 1.06);
    at(Tissue::bone) = perMm(kCortical, 1.92);
    at(Tissue::neighbour) = blend(kNeighbourEnamel, at(Tissue::enamel), 1.0 - kNeighbourEnamel, at(Tissue::dentine));
    at(Tissue::restoration) = perMm(kAmalgam, 11.0);
    t.aluminium = perMm(kAluminium, 2.699);
    t.composite = blend(kCompositeMmAl, t.aluminium, 0.0, t.aluminium);
    t.scintillator = perMm(kCaesiumIodide, 4.51);
    return t;
}

const Table& table() {
    static const Table kTable = makeTable();
    return kTable;
}

constexpr double kScintillatorMm = 0.1;

double energyKev(std::size_t band) {
    return kFirstKev + (static_cast<double>(band) + 0.5) * kBandKev;
}

/// Photons of a thick tungsten target in each band (Kramers), through aluminium.
Spectrum tubeSpectrum(double kv, double aluminiumMm) {
    Spectrum s{};
    for (std::size_t b = 0; b < kBands; ++b) {
        // The last band may be cut by the tube's voltage.
        const double low = kFirstKev + static_cast<double>(b) * kBandKev, high = std::min(low + kBandKev, kv);
        if (high <= low) break;
        const double middle = 0.5 * (low + high);
        s[b] = (high - low) * (kv / middle - 1.0) * core::exp(-table().aluminium[b] * aluminiumMm);
    }
    return s;
}

}  // namespace

Filling fillingByName(std::string_view name) {
    if (name == "amalgam") return Filling::amalgam;
    if (name == "composite") return Filling::composite;
    throw core::Error(fmt::format("there is no filling called \"{}\"", name.substr(0, 60)), "--filling",
                      "choose amalgam or composite");
}

const Spectrum& attenuationPerMm(Tissue tissue, Filling filling) {
    if (tissue == Tissue::restoration && filling == Filling::composite) return table().composite;
    return table().tissue.at(static_cast<std::size_t>(tissue));
}

const Spectrum& aluminiumPerMm() {
    return table().aluminium;
}

Beam::Beam(double kv, double aluminiumMm, double softTissueMm, Filling filling) {
    if (!(kv >= 50.0 && kv <= 70.0))
        throw core::Error(fmt::format("a tube of {:g} kV is not possible", kv), "--kv", "give 50 to 70");
    bare_ = tubeSpectrum(kv, aluminiumMm);
    double sum = 0.0;
    for (std::size_t b = 0; b < kBands; ++b) {
        const double absorbed = 1.0 - core::exp(-table().scintillator[b] * kScintillatorMm);
        const double cheek = core::exp(-attenuationPerMm(Tissue::gum)[b] * softTissueMm);
        weights_[b] = bare_[b] * cheek * absorbed * energyKev(b);
        sum += weights_[b];
    }
    for (double& w : weights_)
        w /= sum;
    // Bands that would not be seen at all are left out of the sum for every pixel.
    constexpr double kSeen = 1e-9;
    while (first_ < kBands && weights_[first_] < kSeen)
        ++first_;
    last_ = kBands;
    while (last_ > first_ && weights_[last_ - 1] < kSeen)
        --last_;
    for (std::size_t t = 0; t < cases::kTissueCount; ++t)
        attenuation_[t] = &attenuationPerMm(static_cast<Tissue>(t), filling);
}

double Beam::transmission(const Paths& pathsMm) const noexcept {
    Spectrum depth{};
    for (std::size_t t = 1; t < cases::kTissueCount; ++t)
        if (pathsMm[t] > 0.0)
            for (std::size_t b = first_; b < last_; ++b)
                depth[b] += (*attenuation_[t])[b] * pathsMm[t];
    double sum = 0.0;
    for (std::size_t b = first_; b < last_; ++b)
        sum += weights_[b] * core::exp(-depth[b]);
    return sum;
}

double Beam::halfValueLayerMm() const {
    // Air kerma of a photon: its energy times air's mass energy absorption, which falls about as E^-3 up to 30 keV and
    // flattens where scattering takes over (NIST: 0.5389, 0.1537, 0.06833, 0.04098, 0.03041 at 20, 30, 40, 50, 60 keV).
    constexpr std::array<std::pair<double, double>, 7> kAir = {{{15.0, 1.334},
                                                                {20.0, 0.5389},
                                                                {30.0, 0.1537},
                                                                {40.0, 0.06833},
                                                                {50.0, 0.04098},
                                                                {60.0, 0.03041},
                                                                {80.0, 0.02407}}};
    const auto kerma = [&](double aluminiumMm) {
        double sum = 0.0;
        for (std::size_t b = 0; b < kBands; ++b) {
            const double kev = energyKev(b);
            std::size_t n = 1;
            while (kAir[n].first < kev)
                ++n;
            const auto [e0, a0] = kAir[n - 1];
            const auto [e1, a1] = kAir[n];
            const double share = core::log(kev / e0) / core::log(e1 / e0);
            sum += bare_[b] * kev * a0 * core::pow(a1 / a0, share) * core::exp(-table().aluminium[b] * aluminiumMm);
        }
        return sum;
    };
    double low = 0.0, high = 20.0;
    for (int n = 0; n < 60; ++n) {
        const double middle = 0.5 * (low + high);
        (kerma(middle) > 0.5 * kerma(0.0) ? low : high) = middle;
    }
    return low;
}

}  // namespace handpiece::radiograph
