// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/radiograph/radiograph.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/parallel.h"
#include "support/closed_meshes.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::radiograph::radiograph_test {
namespace {

using cases::Tissue;
using core::Vec3;
using testing::HasSubstr;

geometry::TriangleMesh boxMesh(const Vec3& low, const Vec3& high) {
    geometry::TriangleMesh m;
    for (int n = 0; n < 8; ++n)
        m.vertices.push_back(
            {(n & 1) != 0 ? high.x() : low.x(), (n & 2) != 0 ? high.y() : low.y(), (n & 4) != 0 ? high.z() : low.z()});
    m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return m;
}

cases::Part part(Tissue tissue, geometry::TriangleMesh mesh) {
    return {std::string(cases::properties(tissue).name), tissue, cases::properties(tissue).priority, std::move(mesh)};
}

/// One point for a tube, no blur, no noise.
Settings sharp() {
    Settings s;
    s.focalSpotMm = 0.0;
    s.quanta = 0.0;
    s.blurUm = 0.0;
    return s;
}

/// A detector in the plane y = -30, seen from +y: a tooth about the origin is in its middle.
Projection frontOf(int width, int height, double pixelMm) {
    Projection p;
    p.centreMm = {0.0, -30.0, 0.0};
    p.right = -Vec3::UnitX();
    p.up = Vec3::UnitZ();
    p.width = width;
    p.height = height;
    p.pixelMm = pixelMm;
    return p;
}

/// Where the ray of a pixel's middle runs from and to.
struct Ray {
    Vec3 from, along;
    double lengthMm;
};
Ray rayOf(const Projection& p, int x, int y) {
    const Vec3 pixel =
        p.centreMm + (x - 0.5 * (p.width - 1)) * p.pixelMm * p.right + (0.5 * (p.height - 1) - y) * p.pixelMm * p.up;
    const Vec3 spot = p.centreMm + p.sourceMm * p.normal();
    return {spot, (pixel - spot).normalized(), (pixel - spot).norm()};
}

double chordMm(const Ray& ray, const Vec3& centre, double radiusMm) {
    const Vec3 to = centre - ray.from;
    const double square = radiusMm * radiusMm - (to - ray.along * ray.along.dot(to)).squaredNorm();
    return square > 0.0 ? 2.0 * std::sqrt(square) : 0.0;
}

/// Of a ray through a box, by its slabs.
double pathInBoxMm(const Ray& ray, const Vec3& low, const Vec3& high) {
    double from = 0.0, to = ray.lengthMm;
    for (int axis = 0; axis < 3; ++axis) {
        double a = (low[axis] - ray.from[axis]) / ray.along[axis], b = (high[axis] - ray.from[axis]) / ray.along[axis];
        if (a > b) std::swap(a, b);
        from = std::max(from, a);
        to = std::min(to, b);
    }
    return std::max(0.0, to - from);
}

/// Beer and Lambert in the test's own words.
double known(const Settings& s, const Paths& paths) {
    const Beam beam(s.kv, s.filtrationMm, s.cheekMm, s.filling);
    double sum = 0.0;
    for (std::size_t b = 0; b < kBands; ++b) {
        double depth = 0.0;
        for (std::size_t t = 1; t < paths.size(); ++t)
            depth += paths[t] * attenuationPerMm(static_cast<Tissue>(t), s.filling)[b];
        sum += beam.weights()[b] * std::exp(-depth);
    }
    return sum;
}

double& of(Paths& paths, Tissue tissue) {
    return paths[static_cast<std::size_t>(tissue)];
}

/// A tooth of nested balls about `centre`: enamel, dentine, pulp.
constexpr double kEnamelMm = 5.0, kDentineMm = 3.6, kPulpMm = 1.4;
cases::Case onion(const Vec3& centre = Vec3::Zero()) {
    cases::Case c;
    c.name = "onion";
    c.fdiNumber = 46;
    c.buccalSign = 1;
    c.outer = test::sphereMesh(6, kEnamelMm, centre);
    c.parts = {part(Tissue::enamel, test::sphereMesh(6, kEnamelMm, centre)),
               part(Tissue::dentine, test::sphereMesh(6, kDentineMm, centre)),
               part(Tissue::pulp, test::sphereMesh(6, kPulpMm, centre))};
    return c;
}

Paths onionPaths(const Ray& ray, const Vec3& centre) {
    Paths paths{};
    const double all = chordMm(ray, centre, kEnamelMm), inner = chordMm(ray, centre, kDentineMm),
                 pulp = chordMm(ray, centre, kPulpMm);
    of(paths, Tissue::enamel) = all - inner;
    of(paths, Tissue::dentine) = inner - pulp;
    of(paths, Tissue::pulp) = pulp;
    return paths;
}

TEST(Radiograph, NestedBallsAreAsTheClosedFormHasThem) {
    const Vec3 centre(1.3, 0.7, -2.1);
    const Projection p = frontOf(240, 240, 0.06);
    const Settings s = sharp();
    const Exposure seen = expose(onion(centre), p, s);
    double worst = 0.0, squares = 0.0, darkest = 1.0;
    int count = 0;
    for (int y = 0; y < p.height; ++y)
        for (int x = 0; x < p.width; ++x) {
            const Ray ray = rayOf(p, x, y);
            const Vec3 to = centre - ray.from;
            const double beside = (to - ray.along * ray.along.dot(to)).norm();
            // At a ball's rim a mesh of flat faces ends a little inside; half a pixel is left out.
            bool isRim = false;
            for (const double radius : {kEnamelMm, kDentineMm, kPulpMm})
                isRim = isRim || std::abs(beside - radius) < 0.03;
            if (isRim) continue;
            const double closed = known(s, onionPaths(ray, centre));
            const double error = static_cast<double>(seen.at(x, y)) / closed - 1.0;
            worst = std::max(worst, std::abs(error));
            squares += error * error;
            darkest = std::min(darkest, closed);
            ++count;
        }
    fmt::print("balls: worst {:.4f} %, rms {:.4f} %, darkest {:.4f}\n", 100 * worst, 100 * std::sqrt(squares / count),
               darkest);
    EXPECT_LT(darkest, 0.3);
    EXPECT_LT(worst, 0.002);
    EXPECT_LT(std::sqrt(squares / count), 2e-4);
}

TEST(Radiograph, SlabsAndAStepWedgeAreExact) {
    // Steps of enamel along x, with a slab of dentine and one of caries that wins over both.
    cases::Case c;
    std::vector<std::pair<Vec3, Vec3>> steps;
    for (int n = 0; n < 6; ++n)
        steps.push_back({Vec3(-6.0 + 2.0 * n, 0.0, -4.0), Vec3(-4.03 + 2.0 * n, 0.5 + n, 4.0)});
    for (const auto& [low, high] : steps)
        c.parts.push_back(part(Tissue::enamel, boxMesh(low, high)));
    const Vec3 dentineLow(-6.5, -4.0, -3.0), dentineHigh(6.5, -1.0, 1.0);
    const Vec3 cariesLow(-1.7, -2.0, -5.0), cariesHigh(1.1, 1.5, -0.4);
    c.parts.push_back(part(Tissue::dentine, boxMesh(dentineLow, dentineHigh)));
    c.parts.push_back(part(Tissue::caries, boxMesh(cariesLow, cariesHigh)));
    const Projection p = frontOf(151, 127, 0.101);
    const Settings s = sharp();
    const Exposure seen = expose(c, p, s);
    const auto overlap = [](std::pair<Vec3, Vec3> a, const Vec3& low, const Vec3& high) {
        return std::pair(Vec3(a.first.cwiseMax(low)), Vec3(a.second.cwiseMin(high)));
    };
    double worst = 0.0;
    for (int y = 0; y < p.height; ++y)
        for (int x = 0; x < p.width; ++x) {
            const Ray ray = rayOf(p, x, y);
            Paths paths{};
            for (const auto& step : steps) {
                const auto shared = overlap(step, cariesLow, cariesHigh);
                of(paths, Tissue::enamel) += pathInBoxMm(ray, step.first, step.second);
                if ((shared.second - shared.first).minCoeff() > 0.0)
                    of(paths, Tissue::enamel) -= pathInBoxMm(ray, shared.first, shared.second);
            }
            const auto shared = overlap({dentineLow, dentineHigh}, cariesLow, cariesHigh);
            of(paths, Tissue::dentine) =
                pathInBoxMm(ray, dentineLow, dentineHigh) - pathInBoxMm(ray, shared.first, shared.second);
            of(paths, Tissue::caries) = pathInBoxMm(ray, cariesLow, cariesHigh);
            worst = std::max(worst, std::abs(static_cast<double>(seen.at(x, y)) / known(s, paths) - 1.0));
        }
    fmt::print("slabs: worst {:.2e}\n", worst);
    EXPECT_LT(worst, 2e-5);  // Corners lie on 1/16384 of a pixel; the picture is in single precision.
}

TEST(Radiograph, TeethStandWhereTheCaseHasThemAndWhatIsBehindTheDetectorThrowsNoShadow) {
    cases::Case c = onion();
    cases::PlacedTooth beside;
    static_cast<cases::Tooth&>(beside) = onion();
    beside.name = "beside";
    beside.fdiNumber = 45;
    beside.inCase = {Vec3(11.0, 2.0, 1.0), core::Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()))};
    c.others.push_back(beside);
    beside.fdiNumber = 16;
    beside.inCase.positionMm = {4.0, -60.0, 0.0};
    c.others.push_back(beside);
    c.scenery.push_back(part(Tissue::gum, boxMesh({-20, -8, -9}, {20, 8, -1})));
    c.scenery.push_back(part(Tissue::neighbour, boxMesh({-12, -3, -8}, {-7, 3, 5})));
    // A sheet that is only seen.
    geometry::TriangleMesh sheet = boxMesh({-20, 10, -20}, {20, 11, 20});
    sheet.triangles.resize(3);
    c.scenery.push_back(part(Tissue::bone, sheet));
    const Projection p = frontOf(360, 260, 0.1);
    const Settings s = sharp();
    const Exposure seen = expose(c, p, s);
    double worst = 0.0;
    int shadowed = 0;
    for (int y = 0; y < p.height; ++y)
        for (int x = 0; x < p.width; ++x) {
            const Ray ray = rayOf(p, x, y);
            const std::array<Vec3, 2> centres = {Vec3::Zero(), Vec3(11.0, 2.0, 1.0)};
            Paths paths{};
            double teethInGum = 0.0;
            bool isRim = false;
            for (const Vec3& centre : centres) {
                const Paths own = onionPaths(ray, centre);
                for (std::size_t t = 0; t < paths.size(); ++t)
                    paths[t] += own[t];
                const Vec3 to = centre - ray.from;
                const double along = ray.along.dot(to), half = 0.5 * chordMm(ray, centre, kEnamelMm);
                for (const double radius : {kEnamelMm, kDentineMm, kPulpMm})
                    isRim = isRim || std::abs((to - ray.along * along).norm() - radius) < 0.05;
                if (half <= 0.0) continue;
                // The chord's part that lies in the gum's box.
                const Ray chord{ray.from + (along - half) * ray.along, ray.along, 2.0 * half};
                teethInGum += pathInBoxMm(chord, {-20, -8, -9}, {20, 8, -1});
            }
            if (isRim) continue;
            of(paths, Tissue::neighbour) = pathInBoxMm(ray, {-12, -3, -8}, {-7, 3, 5});
            of(paths, Tissue::gum) = pathInBoxMm(ray, {-20, -8, -9}, {20, 8, -1}) -
                                     pathInBoxMm(ray, {-12, -3, -8}, {-7, 3, -1}) - teethInGum;
            shadowed += of(paths, Tissue::pulp) > 0.0 ? 1 : 0;
            worst = std::max(worst, std::abs(static_cast<double>(seen.at(x, y)) / known(s, paths) - 1.0));
        }
    EXPECT_GT(shadowed, 500);
    EXPECT_LT(worst, 0.002);
}

TEST(Radiograph, ToothInNoPartIsOfTheNearest) {
    // Outer box of 10, dentine in its middle, enamel above: the rest is shared at half way between them.
    cases::Case c;
    c.outer = boxMesh({-5, -5, -5}, {5, 5, 5});
    c.parts = {part(Tissue::enamel, boxMesh({-5, -5, 3}, {5, 5, 5})),
               part(Tissue::dentine, boxMesh({-5, -5, -5}, {5, 5, -3}))};
    Projection p = frontOf(21, 101, 0.1);
    p.sourceMm = 1000.0;
    const Settings s = sharp();
    const Exposure seen = expose(c, p, s);
    for (int y = 0; y < p.height; ++y) {
        const Ray ray = rayOf(p, 10, y);
        const double z = ray.from.z() + ray.along.z() / ray.along.y() * -ray.from.y();
        if (std::abs(z) < 0.1 || std::abs(std::abs(z) - 5.0) < 0.1 || std::abs(std::abs(z) - 3.0) < 0.1) continue;
        Paths paths{};
        of(paths, z > 0.0 ? Tissue::enamel : Tissue::dentine) = pathInBoxMm(ray, {-5, -5, -5}, {5, 5, 5});
        EXPECT_NEAR(static_cast<double>(seen.at(10, y)) / known(s, paths), 1.0, 0.002) << z;
    }
    // Without any part a tooth is enamel.
    c.parts.clear();
    Paths paths{};
    of(paths, Tissue::enamel) = 10.0;
    EXPECT_NEAR(static_cast<double>(expose(c, p, s).at(10, 50)) / known(s, paths), 1.0, 1e-4);
}

TEST(Radiograph, TheFocalSpotBlursByItsGeometry) {
    // An edge at `above` the detector: its penumbra is the spot, seen through a pinhole at the edge.
    for (const double spotMm : {0.4, 0.7})
        for (const double above : {20.0, 100.0}) {
            cases::Case c;
            c.parts = {part(Tissue::restoration, boxMesh({0.0, above - 30.0, -20.0}, {40.0, above - 29.9, 20.0}))};
            Projection p = frontOf(400, 2, 0.01);
            p.right = Vec3::UnitX();
            p.up = -Vec3::UnitZ();
            Settings s = sharp();
            s.focalSpotMm = spotMm;
            s.spotPoints = 30;
            const Exposure seen = expose(c, p, s);
            const double low = static_cast<double>(seen.at(399, 1)), high = static_cast<double>(seen.at(0, 1));
            const auto placeOf = [&](double share) {
                for (int x = 1; x < p.width; ++x) {
                    const double before = static_cast<double>(seen.at(x - 1, 1)),
                                 here = static_cast<double>(seen.at(x, 1));
                    const double level = high + share * (low - high);
                    if (here <= level) return (x - 1 + (before - level) / (before - here)) * p.pixelMm;
                }
                return 1e9;
            };
            const double penumbra = spotMm * above / (p.sourceMm - above);
            EXPECT_NEAR(placeOf(0.9) - placeOf(0.1), 0.8 * penumbra, 0.01 + 0.03 * penumbra) << spotMm << ' ' << above;
        }
}

TEST(Radiograph, QuantaAreCountedAsPoissonHasThem) {
    const std::uint64_t seed = test::seed();
    for (const double mean : {0.7, 6.0, 39.0, 41.0, 900.0, 8000.0}) {
        Settings s;
        s.quanta = mean;
        s.blurUm = 0.0;
        s.seed = seed;
        Exposure e{700, 600, std::vector<float>(700 * 600, 1.0f)};
        detect(e, s);
        double sum = 0.0, squares = 0.0;
        for (const float v : e.signal) {
            const double counted = static_cast<double>(v) * mean;
            EXPECT_NEAR(counted, std::round(counted), 1e-3 + 1e-6 * mean);
            sum += counted;
            squares += counted * counted;
        }
        const double n = static_cast<double>(e.signal.size()), found = sum / n, variance = squares / n - found * found;
        EXPECT_NEAR(found, mean, 5.0 * std::sqrt(mean / n)) << "seed " << seed;
        // The variance of a variance is (2 + 1 / mean) / n of its square.
        EXPECT_NEAR(variance / mean, 1.0,
                    5.0 * std::sqrt((2.0 + 1.0 / mean) / n) + (mean > 40.0 ? 1.0 / (12.0 * mean) : 0.0))
            << "mean " << mean << ", seed " << seed;
    }
}

TEST(Radiograph, TheDetectorsSpreadKeepsTheSumAndCalmsTheNoiseAsItsKernelSays) {
    Settings s;
    s.quanta = 2000.0;
    s.blurUm = 45.0;
    s.pixelUm = 30.0;
    Exposure e{600, 600, std::vector<float>(600 * 600, 0.5f)};
    detect(e, s);
    double sum = 0.0, squares = 0.0;
    for (const float v : e.signal) {
        sum += static_cast<double>(v);
        squares += static_cast<double>(v) * static_cast<double>(v);
    }
    const double n = 360000.0, mean = sum / n, variance = squares / n - mean * mean;
    EXPECT_NEAR(mean, 0.5, 5e-4);
    // White noise through a normal kernel of sigma pixels keeps 1 / (4 pi sigma^2).
    EXPECT_NEAR(variance / (0.5 / 2000.0) * 4.0 * std::numbers::pi * 1.5 * 1.5, 1.0, 0.05);
    // A line spreads to the kernel itself.
    s.quanta = 0.0;
    Exposure line{101, 16, std::vector<float>(101 * 16, 1.0f)};
    for (int y = 0; y < 16; ++y)
        line.signal[static_cast<std::size_t>(y) * 101 + 50] = 0.0f;
    detect(line, s);
    for (const int x : {46, 49, 50, 52})
        EXPECT_NEAR(1.0 - static_cast<double>(line.at(x, 8)),
                    std::exp(-0.5 * (x - 50) * (x - 50) / 2.25) / (1.5 * std::sqrt(2.0 * std::numbers::pi)), 1e-4);
}

TEST(Radiograph, TheSameBitsAtAnyNumberOfThreadsAndAnotherNoiseForAnotherSeed) {
    Settings s;
    s.width = 300;
    s.height = 217;
    s.pixelUm = 60.0;
    core::setThreadCount(1);
    const Radiograph one = take(onion(), s);
    core::setThreadCount(2);
    const Radiograph two = take(onion(), s);
    core::setThreadCount(0);
    EXPECT_EQ(one.picture.grey, two.picture.grey);
    EXPECT_EQ(one.picture.windowCentre, two.picture.windowCentre);
    EXPECT_EQ(one.picture.windowWidth, two.picture.windowWidth);
    s.seed = 2;
    EXPECT_NE(take(onion(), s).picture.grey, one.picture.grey);
}

TEST(Radiograph, GreysGrowWithAttenuationAndSayThatTheyAreSimulated) {
    Settings s = sharp();
    s.width = 600;
    s.height = 433;
    s.pixelUm = 60.0;
    const Projection p = project(onion(), s);
    const Exposure seen = expose(onion(), p, s);
    const Picture picture = develop(seen);
    EXPECT_GE(picture.windowWidth, 0.8);
    EXPECT_LE(picture.windowWidth, 2.0);
    // The SIGMOID VOI LUT function of DICOM PS3.3 [R], with the open beam at black.
    const auto sigmoid = [&](double a) {
        return 1.0 / (1.0 + std::exp(-4.0 * (a - picture.windowCentre) / picture.windowWidth));
    };
    int white = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const std::uint16_t grey = picture.grey[static_cast<std::size_t>(y * picture.width + x)];
            const double known = 65535.0 * (sigmoid(-std::log(static_cast<double>(seen.at(x, y)))) - sigmoid(0.0)) /
                                 (1.0 - sigmoid(0.0));
            if (std::abs(grey - std::clamp(known, 0.0, 65535.0)) > 1.0) {
                // Only the words in the corner are no part of the picture.
                ASSERT_LT(x, 150);
                ASSERT_GT(y, 400);
                white += grey == 65535 ? 1 : 0;
            }
        }
    EXPECT_GT(white, 100);
}

TEST(Radiograph, ARootStandsInALigamentALaminaDuraAndTrabeculae) {
    // A square root in a square socket, 0.3 mm wider on each side, in a block of bone; seen along the socket's walls.
    cases::Case c;
    c.name = "root";
    c.outer = boxMesh({-2, -3, -6}, {2, 3, 6});
    c.parts = {part(Tissue::dentine, c.outer)};
    for (const double side : {-1.0, 1.0})
        c.scenery.push_back(part(Tissue::bone, boxMesh({std::min(2.3 * side, 9.0 * side), -4, -6},
                                                       {std::max(2.3 * side, 9.0 * side), 4, 6})));
    for (cases::Part& p : c.scenery)
        p.isFelt = true;
    Projection p = frontOf(400, 100, 0.05);
    p.sourceMm = 1000.0;
    const Settings s = sharp();
    const Exposure seen = expose(c, p, s);
    const auto attenuation = [&](double x) {  // mean down a column that shows the plane x in the middle of the case
        const int column = static_cast<int>(std::lround(0.5 * (p.width - 1) - x * 1000.0 / 970.0 / p.pixelMm));
        double sum = 0.0;
        for (int y = 0; y < p.height; ++y)
            sum -= std::log(static_cast<double>(seen.at(column, y)));
        return sum / p.height;
    };
    for (const double side : {-1.0, 1.0}) {
        EXPECT_LT(attenuation(2.15 * side), 0.05) << "the ligament is dark";
        EXPECT_GT(attenuation(2.45 * side), 1.25 * attenuation(5.0 * side)) << "the lamina dura is bright";
    }
    // Between nothing but marrow and nothing but compact bone, and by rule: two plates of 1.3 mm, trabeculae of a fifth
    // to two fifths of the volume between them.
    const auto block = [&](double share) {
        Paths paths{};
        of(paths, Tissue::bone) = 8.0 * share;
        of(paths, Tissue::gum) = 8.0 * (1.0 - share);
        return -std::log(known(s, paths));
    };
    const auto sharesOf = [](double trabecular) { return (2.6 * 0.95 + 5.4 * trabecular) / 8.0; };
    double sum = 0.0, squares = 0.0;
    int count = 0;
    for (double x = 4.0; x < 6.0; x += 0.05, ++count) {
        const double a = attenuation(x);
        sum += a;
        squares += a * a;
    }
    const double mean = sum / count;
    fmt::print("bone: {:.3f}, closed form {:.3f} to {:.3f}\n", mean, block(sharesOf(0.2)), block(sharesOf(0.4)));
    EXPECT_GT(mean, block(sharesOf(0.2)));
    EXPECT_LT(mean, block(sharesOf(0.4)));
    EXPECT_GT(std::sqrt(squares / count - mean * mean), 0.002 * mean) << "trabeculae are seen";
    // Another view of the same bone has the same trabeculae.
    EXPECT_EQ(expose(c, p, s).signal, seen.signal);
}

/// The tooth's crown up at z = 5, its root's end at z = -15, buccal +y.
cases::Case pole() {
    cases::Case c;
    c.name = "pole";
    c.fdiNumber = 46;
    c.buccalSign = 1;
    c.outer = boxMesh({-5, -4, -15}, {5, 4, 5});
    return c;
}

/// Where a point of the case is seen: pixels from the left and from the top.
core::Vec2 seenAt(const Projection& p, const Vec3& point) {
    const Vec3 from = point - p.centreMm;
    const double nearer = p.sourceMm / (p.sourceMm - from.dot(p.normal()));
    return {0.5 * (p.width - 1) + from.dot(p.right) * nearer / p.pixelMm,
            0.5 * (p.height - 1) - from.dot(p.up) * nearer / p.pixelMm};
}

TEST(Radiograph, ViewsShowWhatTheyAreFor) {
    Settings s = sharp();
    for (const int fdi : {46, 36, 16, 26})
        for (const int sign : {1, -1}) {
            cases::Case c = pole();
            c.fdiNumber = fdi;
            c.buccalSign = sign;
            SCOPED_TRACE(testing::Message() << fdi << ", buccal " << sign);
            s.view = View::bitewing;
            const Projection bitewing = project(c, s);
            EXPECT_NEAR(bitewing.width * bitewing.pixelMm, 36.0, 0.05);
            EXPECT_NEAR(bitewing.height * bitewing.pixelMm, 26.0, 0.05);
            // The tube is on the buccal side, the detector on the other, clear of the tooth.
            EXPECT_NEAR(bitewing.normal().y(), sign, 1e-9);
            EXPECT_LT(bitewing.centreMm.y() * sign, -4.0);
            // The occlusal plane is in the middle; lower crowns point up, upper ones down.
            EXPECT_NEAR(seenAt(bitewing, {0, 0, 4}).y(), 0.5 * bitewing.height, 5.0);
            EXPECT_EQ(seenAt(bitewing, {0, 0, 5}).y() < seenAt(bitewing, {0, 0, -5}).y(), fdi > 30);
            s.view = View::periapical;
            const Projection whole = project(c, s);
            // Crown and 2 to 3 mm beyond the apex, as it is seen at the tooth's middle.
            for (const double z : {-17.3, 5.0})
                for (const double x : {-5.0, 5.0}) {
                    const core::Vec2 at = seenAt(whole, {x, 0.0, z});
                    EXPECT_GE(at.y(), 0.0) << z;
                    EXPECT_LE(at.y(), whole.height) << z;
                    EXPECT_GE(at.x(), 0.0);
                    EXPECT_LE(at.x(), whole.width);
                }
        }
    // A canine's 27 mm need the sensor upright.
    cases::Case canine = pole();
    canine.outer = boxMesh({-4, -4, -17}, {4, 4, 10});
    canine.fdiNumber = 13;
    s.view = View::periapical;
    const Projection upright = project(canine, s);
    EXPECT_GT(upright.height, upright.width);
    EXPECT_LE(std::abs(seenAt(upright, {0, 0, -19.3}).y() - 0.5 * upright.height), 0.5 * upright.height);
    // By its long axis, where it is known, and another tooth by its number.
    cases::Case c = pole();
    c.landmarks.push_back({cases::LandmarkKind::longAxis, "", {{0, 3, -15}, {0, 0, 0}}});
    const Projection leaning = project(c, s);
    EXPECT_NEAR(leaning.up.dot(Vec3(0, -3, 15).normalized()), 1.0, 1e-9);
    EXPECT_NEAR(leaning.normal().dot(leaning.up), 0.0, 1e-12);
    cases::PlacedTooth other;
    static_cast<cases::Tooth&>(other) = pole();
    other.fdiNumber = 45;
    other.inCase.positionMm = {30.0, 0.0, 0.0};
    c.others.push_back(other);
    s.fdiNumber = 45;
    EXPECT_NEAR(project(c, s).centreMm.x(), 30.0, 1e-9);
}

TEST(Radiograph, WhatCannotBeTakenIsToldInOneSentence) {
    const auto taking = [](const cases::Case& c, const Settings& s) {
        return test::errorOf([&] { (void)take(c, s); });
    };
    Settings s = sharp();
    EXPECT_THAT(taking({}, s), HasSubstr("no surface that could be imaged"));
    cases::Case open = onion();
    open.parts[1].mesh.triangles.resize(open.parts[1].mesh.triangles.size() / 2);
    EXPECT_THAT(taking(open, s),
                testing::AllOf(HasSubstr("dentine"), HasSubstr("not closed"), HasSubstr("mesh repair")));
    cases::Case nowhere = onion();
    nowhere.outer.vertices[7].x() = std::nan("");
    EXPECT_THAT(taking(nowhere, s), HasSubstr("not finite"));
    cases::Case metres = pole();
    for (Vec3& v : metres.outer.vertices)
        v *= 1000.0;
    EXPECT_THAT(taking(metres, s), HasSubstr("millimetres"));
    s.fdiNumber = 11;
    EXPECT_THAT(taking(onion(), s), testing::AllOf(HasSubstr("no tooth 11"), HasSubstr("46")));
    s = sharp();
    for (const auto& [width, height] :
         {std::pair(1, 100), {100, 0}, {-5, 100}, {2000000000, 2000000000}, {8192, 8192}}) {
        s.width = width;
        s.height = height;
        EXPECT_THAT(taking(onion(), s), HasSubstr("--size")) << width << 'x' << height;
    }
    s = sharp();
    s.pixelUm = std::nan("");
    EXPECT_THAT(taking(onion(), s), HasSubstr("--pixel"));
    EXPECT_THAT(test::errorOf([] { (void)viewByName("panoramic"); }), HasSubstr("bitewing or periapical"));
    // It can be stopped.
    EXPECT_THAT(test::errorOf([] { (void)take(onion(), sharp(), [](double done) { return done < 0.3; }); }),
                HasSubstr("cancelled"));
}

}  // namespace
}  // namespace handpiece::radiograph::radiograph_test
