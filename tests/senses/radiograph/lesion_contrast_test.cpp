// SPDX-License-Identifier: Apache-2.0
// How well lesions are seen in a bitewing, by class: the tooth with them against the same tooth without, free of noise.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/field/part_tissues.h"
#include "handpiece/model/lesion/lesion.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/senses/radiograph/radiograph.h"

namespace handpiece::radiograph::lesion_contrast_test {
namespace {

using cases::Tissue;
using core::Vec3;

/// Crown and half the root of a molar, with the defaults of `handpiece xray`.
Settings crownOnly() {
    Settings s;
    s.width = 440;
    s.height = 440;
    return s;
}

const cases::Case& soundMolar() {
    static const cases::Case kTooth = [] {
        cases::Case tooth = starter::makeTooth(starter::ToothKind::lowerFirstMolar, {12000, 0, false});
        std::erase_if(tooth.parts, [](const cases::Part& p) { return cases::isCarious(p.tissue); });
        return tooth;
    }();
    return kTooth;
}
cases::Case molarWith(std::string_view lesions, std::uint64_t seed) {
    cases::Case tooth = soundMolar();
    lesion::addLesions(tooth, lesion::lesionsByName(lesions), {.seed = seed, .spacingMm = 0.12});
    return tooth;
}

/// What arrives, spread by the detector, not yet counted.
Exposure withoutNoise(const cases::Case& tooth, const Projection& projection) {
    Settings s = crownOnly();
    Exposure e = expose(tooth, projection, s);
    s.quanta = 0.0;
    detect(e, s);
    return e;
}

std::size_t pixelOf(const Projection& p, const Vec3& point) {
    const Vec3 from = point - p.centreMm;
    const double nearer = p.sourceMm / (p.sourceMm - from.dot(p.normal())) / p.pixelMm;
    const auto within = [](double v, int size) {
        return static_cast<std::size_t>(std::clamp(v, 0.0, static_cast<double>(size - 1)));
    };
    return within(0.5 * p.height - from.dot(p.up) * nearer, p.height) * static_cast<std::size_t>(p.width) +
           within(0.5 * p.width + from.dot(p.right) * nearer, p.width);
}

/// Pixels near to what a part's vertices show.
void mark(std::vector<std::uint8_t>& mask, const cases::Part& part, const Projection& p) {
    constexpr int kNear = 4;  // pixels, 0.12 mm: the grid that lesions are made on
    for (const Vec3& v : part.mesh.vertices) {
        const auto pixel = static_cast<int>(pixelOf(p, v));
        const int x = pixel % p.width, y = pixel / p.width;
        for (int j = std::max(0, y - kNear); j <= std::min(p.height - 1, y + kNear); ++j)
            for (int i = std::max(0, x - kNear); i <= std::min(p.width - 1, x + kNear); ++i)
                mask[static_cast<std::size_t>(j * p.width + i)] = 1;
    }
}

double lessAt(const Exposure& sound, const Exposure& carious, std::size_t p) {
    return std::log(static_cast<double>(carious.signal[p]) / static_cast<double>(sound.signal[p]));
}

/// A pixel's standard deviation of attenuation: quanta counted, spread by a normal kernel.
double noiseOf(double signal) {
    const Settings s = crownOnly();
    const double sigma = s.blurUm / s.pixelUm;
    return std::sqrt(1.0 / (s.quanta * signal * 4.0 * std::numbers::pi * sigma * sigma));
}

/// Where less is taken by at least half of the most: means there.
struct Seen {
    double most = 0.0;         ///< attenuation
    double attenuation = 0.0;  ///< less than without the lesion
    double grey = 0.0;         ///< darker by so many of 255
    double toNoise = 0.0;      ///< attenuation over a pixel's standard deviation
    double areaMm2 = 0.0;
};
/// Of the lesion as a whole, or of what lies in the dentine beside the enamel's part of it.
Seen seenOf(const cases::Case& tooth, std::string_view name, bool inDentine, const Projection& projection,
            const Exposure& sound, const Exposure& carious, const Picture& picture) {
    std::vector<std::uint8_t> shown(sound.signal.size(), 0), enamel(sound.signal.size(), 0);
    for (const cases::Part& part : tooth.parts)
        if (part.name.starts_with(name)) {
            mark(shown, part, projection);
            if (inDentine && part.tissue == Tissue::demineralisedEnamel) mark(enamel, part, projection);
        }
    std::vector<std::size_t> pixels;
    Seen seen;
    for (std::size_t p = 0; p < shown.size(); ++p)
        if (shown[p] != 0 && enamel[p] == 0) seen.most = std::max(seen.most, lessAt(sound, carious, p));
    for (std::size_t p = 0; p < shown.size(); ++p)
        if (shown[p] != 0 && enamel[p] == 0 && lessAt(sound, carious, p) > 0.5 * seen.most) pixels.push_back(p);
    const auto greyOfSignal = [&](float signal) {
        return 255.0 * greyOf(-std::log(static_cast<double>(signal)), picture.windowCentre, picture.windowWidth);
    };
    const auto count = static_cast<double>(pixels.size());
    for (const std::size_t p : pixels) {
        seen.attenuation += lessAt(sound, carious, p) / count;
        seen.grey += (greyOfSignal(sound.signal[p]) - greyOfSignal(carious.signal[p])) / count;
        seen.toNoise += lessAt(sound, carious, p) / noiseOf(static_cast<double>(carious.signal[p])) / count;
    }
    seen.areaMm2 = count * projection.pixelMm * projection.pixelMm;
    return seen;
}

/// Tissues along a ray, by a place every 10 um: another way than by the crossings of surfaces.
double attenuationBySteps(const cases::Case& tooth, const Projection& p, std::size_t pixel) {
    std::vector<geometry::TriangleTree> trees;
    trees.reserve(tooth.parts.size());
    std::vector<field::PartSurface> surfaces;
    for (const cases::Part& part : tooth.parts) {
        trees.emplace_back(part.mesh);
        surfaces.push_back({&trees.back(), part.tissue, part.priority});
    }
    const geometry::TriangleTree outer(tooth.outer);
    const field::PartTissues tissues(surfaces);
    const auto width = static_cast<std::size_t>(p.width);
    const Vec3 to = p.centreMm + (static_cast<double>(pixel % width) - 0.5 * (p.width - 1)) * p.pixelMm * p.right +
                    (0.5 * (p.height - 1) - static_cast<double>(pixel / width)) * p.pixelMm * p.up;
    const Vec3 from = p.centreMm + p.sourceMm * p.normal();
    constexpr double kStepMm = 0.01;
    Paths paths{};
    for (double way = 0.0; way < 25.0; way += kStepMm) {
        const Vec3 at = to + way * (from - to).normalized();
        if (outer.signedDistance(at) < 0.0) paths[static_cast<std::size_t>(tissues.at(at))] += kStepMm;
    }
    const Settings s = crownOnly();
    return -std::log(Beam(s.kv, s.filtrationMm, s.cheekMm, s.filling).transmission(paths));
}

// Each class at each of the two places; neighbours in one picture far enough apart.
constexpr std::array<std::string_view, 5> kTogether = {"mesial:E1,distal:E2,occlusal:E1",
                                                       "mesial:D1,distal:D2,occlusal:E2", "mesial:D3,occlusal:D1",
                                                       "occlusal:D2", "occlusal:D3"};

TEST(LesionContrast, EnamelLesionsAreHardToSeeDentineLesionsPlain) {
    const Projection projection = project(soundMolar(), crownOnly());
    const Exposure sound = withoutNoise(soundMolar(), projection);
    const Picture picture = develop(sound);
    fmt::print("window {:.2f} about {:.2f}\n", picture.windowWidth, picture.windowCentre);
    std::map<std::string, Seen> found;
    for (const std::string_view lesions : kTogether) {
        const cases::Case tooth = molarWith(lesions, 1);
        const Exposure carious = withoutNoise(tooth, projection);
        for (const lesion::Lesion& l : lesion::lesionsByName(lesions)) {
            const std::string depth(lesion::kFindings[static_cast<std::size_t>(l.finding)]);
            const std::string name =
                fmt::format("{}-{}", lesion::kSurfaces[static_cast<std::size_t>(l.surface)], depth);
            const std::string place = l.surface == lesion::Surface::occlusal ? "occlusal " : "proximal ";
            found[place + depth] = seenOf(tooth, name, false, projection, sound, carious, picture);
            if (l.finding >= lesion::Finding::d1)
                found[place + depth + " dentine"] = seenOf(tooth, name, true, projection, sound, carious, picture);
        }
        if (lesions != kTogether[1]) continue;
        // What is seen of them is what lies on the ray. The spot's four points see it from places 0.02 mm apart.
        Settings point = crownOnly();
        point.focalSpotMm = 0.0;
        const Exposure sharpSound = expose(soundMolar(), projection, point), sharp = expose(tooth, projection, point);
        std::size_t darkest = 0;
        for (std::size_t p = 0; p < sharp.signal.size(); ++p)
            if (lessAt(sharpSound, sharp, p) > lessAt(sharpSound, sharp, darkest)) darkest = p;
        const double bySteps =
            attenuationBySteps(soundMolar(), projection, darkest) - attenuationBySteps(tooth, projection, darkest);
        fmt::print("darkest by {:.4f}, by steps along the ray {:.4f}\n", lessAt(sharpSound, sharp, darkest), bySteps);
        EXPECT_NEAR(lessAt(sharpSound, sharp, darkest), bySteps, 0.03 * bySteps);
    }
    for (const auto& [name, seen] : found)
        fmt::print(
            "{}: attenuation less by {:.3f} at most, {:.3f} over {:.2f} mm2; {:.1f} of 255 darker; {:.1f} times "
            "a pixel's noise\n",
            name, seen.most, seen.attenuation, seen.areaMm2, seen.grey, seen.toNoise);
    // Of 255: some 4 are a step that an eye can just make out between large areas.
    const auto grey = [&](const std::string& name) { return found.at(name).grey; };
    EXPECT_GT(grey("proximal E1"), 4.0);
    EXPECT_LT(grey("proximal E1"), 18.0);
    EXPECT_LT(found.at("proximal E1").areaMm2, 0.6);
    EXPECT_GT(grey("proximal E2"), 15.0);
    EXPECT_GT(found.at("proximal E2").areaMm2, 2.0 * found.at("proximal E1").areaMm2);
    EXPECT_GT(grey("proximal D1 dentine"), 10.0);
    EXPECT_GT(grey("proximal D2 dentine"), 20.0);
    EXPECT_GT(grey("proximal D3 dentine"), 30.0);
    EXPECT_GT(grey("proximal D3 dentine"), grey("proximal D2 dentine"));
    EXPECT_GT(grey("proximal D2 dentine"), grey("proximal D1 dentine"));
    // In a fissure's enamel nothing is seen, in the dentine under it more and more.
    EXPECT_LT(grey("occlusal E1"), 6.0);
    EXPECT_LT(grey("occlusal E2"), 15.0);
    EXPECT_GT(grey("occlusal D2 dentine"), 15.0);
    EXPECT_GT(grey("occlusal D3 dentine"), 30.0);
}

TEST(LesionContrast, APixelsNoiseIsWhatTheTableTakesItFor) {
    const Settings s = crownOnly();
    const Exposure arrives = expose(soundMolar(), project(soundMolar(), s), s);
    Exposure noisy = arrives, quiet = arrives;
    detect(noisy, s);
    Settings q = s;
    q.quanta = 0.0;
    detect(quiet, q);
    double squares = 0.0, count = 0.0;
    for (std::size_t p = 0; p < noisy.signal.size(); ++p) {
        if (!(quiet.signal[p] < 0.5f)) continue;
        const double off = lessAt(quiet, noisy, p) / noiseOf(static_cast<double>(quiet.signal[p]));
        squares += off * off;
        ++count;
    }
    ASSERT_GT(count, 10000.0);
    EXPECT_NEAR(std::sqrt(squares / count), 1.0, 0.05);
}

}  // namespace
}  // namespace handpiece::radiograph::lesion_contrast_test
