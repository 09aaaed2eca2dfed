// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/phantom/phantom.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/model/field/part_tissues.h"
#include "handpiece/model/starter/starter.h"

namespace handpiece::phantom::phantom_test {
namespace {

using cases::Tissue;
using core::Vec3;

constexpr unsigned kSeed = 611;

geometry::TriangleMesh ball(const Vec3& centre, double radiusMm) {
    geometry::IsosurfaceSettings settings;
    settings.spacingMm = radiusMm / 30.0;
    return geometry::isosurface(
        core::Box{centre, centre}.grown(1.1 * radiusMm), [&](const Vec3& p) { return (p - centre).norm() - radiusMm; },
        settings);
}

cases::Part partOf(Tissue tissue, geometry::TriangleMesh mesh) {
    return {std::string(cases::properties(tissue).name), tissue, cases::properties(tissue).priority, std::move(mesh)};
}

const Vec3 kCentre(0.13, -0.21, 0.37);
constexpr double kEnamelMm = 3.0, kDentineMm = 2.2, kPulpMm = 1.1;

/// Balls in balls: everything about them is known.
const cases::Case& onion() {
    static const cases::Case made = [] {
        cases::Case c;
        c.name = "onion";
        c.outer = ball(kCentre, kEnamelMm);
        c.parts = {partOf(Tissue::enamel, c.outer), partOf(Tissue::dentine, ball(kCentre, kDentineMm)),
                   partOf(Tissue::pulp, ball(kCentre, kPulpMm))};
        return c;
    }();
    return made;
}

const cases::Case& premolar() {
    static const cases::Case made = starter::makeTooth(starter::ToothKind::upperPremolar, {12000, 8000, false});
    return made;
}

double ballMm3(double radiusMm) {
    return 4.0 / 3.0 * std::numbers::pi * radiusMm * radiusMm * radiusMm;
}

/// Without blur and noise: what each voxel holds.
Settings sharp(double voxelUm) {
    Settings s;
    s.voxelUm = voxelUm;
    s.noise = 0.0;
    s.blurVoxels = 0.0;
    return s;
}

double stepOf(Scanner scanner) {
    return greyOf(scanner, Tissue::enamel) - greyOf(scanner, Tissue::none);
}

double sumOverOutside(const Image& image, Scanner scanner) {
    double sum = 0.0;
    for (const float v : image.volume.values)
        sum += static_cast<double>(v) - greyOf(scanner, Tissue::none);
    return sum * image.volume.grid.voxelMm3();
}

TEST(Phantom, AVoxelIsTheMeanOfWhatLiesInIt) {
    cases::Case one;
    one.outer = onion().outer;
    const Image image = phantom::image(one, sharp(250.0));
    const volume::Grid& grid = image.volume.grid;
    const Vec3 centre = image.toothInScan.apply(kCentre);
    const double outside = greyOf(Scanner::microCt, Tissue::none), step = stepOf(Scanner::microCt);
    const auto shareAt = [&](int i, int j, int k) {
        return (static_cast<double>(image.volume.values[grid.index(i, j, k)]) - outside) / step;
    };
    // Slices: the ball between two planes, by the closed form.
    const double h = grid.spacingMm.z();
    double worstSlice = 0.0;
    for (int k = 0; k < grid.size[2]; ++k) {
        double sum = 0.0;
        for (int j = 0; j < grid.size[1]; ++j)
            for (int i = 0; i < grid.size[0]; ++i)
                sum += shareAt(i, j, k);
        const double z = grid.toMm(Vec3(0, 0, k)).z() - centre.z();
        const double low = std::clamp(z - 0.5 * h, -kEnamelMm, kEnamelMm);
        const double high = std::clamp(z + 0.5 * h, -kEnamelMm, kEnamelMm);
        const double known =
            std::numbers::pi * (kEnamelMm * kEnamelMm * (high - low) - (high * high * high - low * low * low) / 3.0);
        worstSlice = std::max(worstSlice, std::abs(sum * grid.voxelMm3() - known) / ballMm3(kEnamelMm));
    }
    EXPECT_LT(worstSlice, 2e-4);
    // Voxels on the surface: 24 x 24 columns of each, cut by the ball exactly.
    double worst = 0.0, sum = 0.0, squares = 0.0;
    int seen = 0;
    for (int k = 0; k < grid.size[2]; ++k)
        for (int j = 0; j < grid.size[1]; ++j)
            for (int i = 0; i < grid.size[0]; ++i) {
                const Vec3 middle = grid.toMm(Vec3(i, j, k)) - centre;
                if (std::abs(middle.norm() - kEnamelMm) > h) continue;
                double known = 0.0;
                constexpr int kColumns = 24;
                for (int u = 0; u < kColumns; ++u)
                    for (int v = 0; v < kColumns; ++v) {
                        const double x = middle.x() + h * ((u + 0.5) / kColumns - 0.5);
                        const double y = middle.y() + h * ((v + 0.5) / kColumns - 0.5);
                        const double half = std::sqrt(std::max(0.0, kEnamelMm * kEnamelMm - x * x - y * y));
                        known += std::max(0.0, std::min(half, middle.z() + 0.5 * h) -
                                                   std::max(-half, middle.z() - 0.5 * h)) /
                                 h;
                    }
                known /= kColumns * kColumns;
                const double error = shareAt(i, j, k) - known;
                worst = std::max(worst, std::abs(error));
                sum += error;
                squares += error * error;
                ++seen;
            }
    ASSERT_GT(seen, 1000);
    EXPECT_LT(worst, 0.07);  // Two rays of 34 pass or miss together where the ball only grazes a voxel.
    EXPECT_LT(std::sqrt(squares / seen), 0.01);
    EXPECT_LT(std::abs(sum / seen), 0.002);
}

TEST(Phantom, VolumesAreThoseOfTheSurfacesEachWhereNoOtherLies) {
    const auto volumes = volumesMm3(onion());
    EXPECT_NEAR(volumes[static_cast<std::size_t>(Tissue::pulp)] / ballMm3(kPulpMm), 1.0, 1e-3);
    EXPECT_NEAR(volumes[static_cast<std::size_t>(Tissue::dentine)] / (ballMm3(kDentineMm) - ballMm3(kPulpMm)), 1.0,
                1e-3);
    EXPECT_NEAR(volumes[static_cast<std::size_t>(Tissue::enamel)] / (ballMm3(kEnamelMm) - ballMm3(kDentineMm)), 1.0,
                1e-3);
    // A real case: together the tooth, and what wins over all others its own surface's.
    const auto real = volumesMm3(premolar());
    double all = 0.0;
    for (const double v : real)
        all += v;
    EXPECT_NEAR(all / geometry::enclosedVolumeMm3(premolar().outer), 1.0, 1e-4);
    EXPECT_NEAR(real[static_cast<std::size_t>(Tissue::pulp)] / geometry::enclosedVolumeMm3(premolar().parts.at(2).mesh),
                1.0, 1e-3);
    EXPECT_LT(real[static_cast<std::size_t>(Tissue::dentine)],
              geometry::enclosedVolumeMm3(premolar().parts.at(1).mesh) - real[static_cast<std::size_t>(Tissue::pulp)]);
}

TEST(Phantom, PartialVolumesAddUpToTheTissuesBeforeAndAfterBlur) {
    for (const Scanner scanner : {Scanner::microCt, Scanner::cbct})
        for (const double blur : {0.0, 0.7}) {
            Settings s = sharp(200.0);
            s.scanner = scanner;
            s.blurVoxels = blur;
            const Image image = phantom::image(premolar(), s);
            double known = 0.0;
            for (std::size_t t = 1; t < cases::kTissueCount; ++t)
                known +=
                    image.volumesMm3[t] * (greyOf(scanner, static_cast<Tissue>(t)) - greyOf(scanner, Tissue::none));
            EXPECT_NEAR(sumOverOutside(image, scanner) / known, 1.0, 0.002) << nameOf(scanner) << " blur " << blur;
        }
}

TEST(Phantom, TruthIsTheTissueAtTheVoxelsMiddle) {
    const cases::Case& c = premolar();
    for (const double degrees : {0.0, 37.0}) {
        Settings s = sharp(150.0);
        s.turn = core::Quat(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Vec3(1, 2, -1).normalized()));
        const Image image = phantom::image(c, s);
        const geometry::TriangleTree outer(c.outer);
        std::vector<std::unique_ptr<geometry::TriangleTree>> trees;
        std::vector<field::PartSurface> parts;
        for (const cases::Part& part : c.parts) {
            trees.push_back(std::make_unique<geometry::TriangleTree>(part.mesh));
            parts.push_back({trees.back().get(), part.tissue, part.priority});
        }
        const field::PartTissues tissues(parts);
        std::mt19937 random(kSeed);
        SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", turned by " << degrees);
        int differing = 0, inTooth = 0;
        for (int n = 0; n < 8000; ++n) {
            const std::size_t voxel = random() % image.truth.values.size();
            const auto& size = image.truth.grid.size;
            const int i = static_cast<int>(voxel % static_cast<std::size_t>(size[0]));
            const int j =
                static_cast<int>(voxel / static_cast<std::size_t>(size[0]) % static_cast<std::size_t>(size[1]));
            const int k =
                static_cast<int>(voxel / static_cast<std::size_t>(size[0]) / static_cast<std::size_t>(size[1]));
            const Vec3 p = image.toothInScan.applyInverse(image.truth.grid.toMm(Vec3(i, j, k)));
            const Tissue known = outer.signedDistance(p) < 0.0 ? tissues.at(p) : Tissue::none;
            inTooth += known != Tissue::none ? 1 : 0;
            if (image.truth.values[voxel] == labelOf(known)) continue;
            ++differing;
            // Only slits between parts are shared another way; they are no wider than the parts are meshed apart.
            double nearest = std::abs(outer.signedDistance(p));
            for (const auto& tree : trees)
                nearest = std::min(nearest, tree->nearest(p).distanceMm);
            EXPECT_LT(nearest, 0.03);
        }
        EXPECT_GT(inTooth, 800);
        EXPECT_LT(differing, 10);
    }
}

TEST(Phantom, AQuarterTurnTurnsGreysAndTruth) {
    Settings s = sharp(200.0);
    const Image straight = phantom::image(onion(), s);
    s.turn = core::Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX()));  // y to z: rays pass another way
    const Image turned = phantom::image(onion(), s);
    const volume::Grid &a = straight.volume.grid, &b = turned.volume.grid;
    ASSERT_EQ(a.size[1], b.size[2]);
    ASSERT_EQ(a.size[2], b.size[1]);
    double worst = 0.0;
    std::size_t labels = 0;
    for (int k = 0; k < a.size[2]; ++k)
        for (int j = 0; j < a.size[1]; ++j)
            for (int i = 0; i < a.size[0]; ++i) {
                const std::size_t from = a.index(i, j, k), to = b.index(i, b.size[1] - 1 - k, j);
                worst = std::max(worst, std::abs(static_cast<double>(straight.volume.values[from]) -
                                                 static_cast<double>(turned.volume.values[to])));
                labels += straight.truth.values[from] != turned.truth.values[to] ? 1 : 0;
            }
    EXPECT_LT(worst / stepOf(Scanner::microCt), 0.08);
    EXPECT_LT(labels, a.count() / 5000);
}

TEST(Phantom, InsideATissueTheMeanIsItsGreyAndTheNoiseIsAsAsked) {
    for (const Scanner scanner : {Scanner::microCt, Scanner::cbct}) {
        Settings s;
        s.scanner = scanner;
        s.voxelUm = 80.0;
        s.noise = 0.04;
        s.seed = kSeed;
        const Image image = phantom::image(onion(), s);
        const volume::Grid& grid = image.volume.grid;
        const Vec3 centre = image.toothInScan.apply(kCentre);
        const double deviation = s.noise * stepOf(scanner), edge = 4.0 * grid.spacingMm.x();
        struct Shell {
            Tissue tissue;
            double from, to;
        };
        for (const Shell& shell : {Shell{Tissue::none, kEnamelMm, 1e9}, Shell{Tissue::enamel, kDentineMm, kEnamelMm},
                                   Shell{Tissue::dentine, kPulpMm, kDentineMm}, Shell{Tissue::pulp, -1.0, kPulpMm}}) {
            double n = 0, sum = 0, squares = 0, fourths = 0, pairs = 0, products = 0;
            const auto isIn = [&](int i, int j, int k) {
                const double r = (grid.toMm(Vec3(i, j, k)) - centre).norm();
                return r > shell.from + (shell.from > 0.0 ? edge : 0.0) && r < shell.to - edge;
            };
            const auto at = [&](int i, int j, int k) {
                return static_cast<double>(image.volume.values[grid.index(i, j, k)]) - greyOf(scanner, shell.tissue);
            };
            for (int k = 0; k < grid.size[2]; ++k)
                for (int j = 0; j < grid.size[1]; ++j)
                    for (int i = 0; i < grid.size[0]; ++i) {
                        if (!isIn(i, j, k)) continue;
                        const double d = at(i, j, k);
                        n += 1;
                        sum += d;
                        squares += d * d;
                        fourths += d * d * d * d;
                        if (k + 1 < grid.size[2] && isIn(i, j, k + 1)) {
                            pairs += 1;
                            products += d * at(i, j, k + 1);
                        }
                    }
            SCOPED_TRACE(testing::Message() << nameOf(scanner) << ' ' << static_cast<int>(shell.tissue) << ", " << n
                                            << " voxels, seed " << kSeed);
            ASSERT_GT(n, 1500);
            // Neighbours hang together: as sure as a third of as many independent ones.
            const double variance = squares / n - sum / n * sum / n;
            EXPECT_LT(std::abs(sum / n), 4.5 * deviation / std::sqrt(n / 4.0));
            EXPECT_NEAR(std::sqrt(variance) / deviation, 1.0, 4.5 / std::sqrt(n / 2.0));
            EXPECT_NEAR(fourths / n / (variance * variance), 3.0, 4.5 * std::sqrt(24.0 / (n / 3.0)));
            EXPECT_NEAR(products / pairs / variance, 0.26, 4.5 / std::sqrt(n / 2.0));
        }
    }
}

TEST(Phantom, RingsGoAboutTheAxisAndAreAsHighAsAsked) {
    Settings s = sharp(150.0);
    const Image without = phantom::image(onion(), s);
    s.ring = 0.1;
    const Image with = phantom::image(onion(), s);
    const volume::Grid& grid = with.volume.grid;
    const double amplitude = s.ring * stepOf(Scanner::microCt);
    const auto ringAt = [&](int i, int j, int k) {
        return static_cast<double>(with.volume.values[grid.index(i, j, k)]) -
               static_cast<double>(without.volume.values[grid.index(i, j, k)]);
    };
    double most = 0.0;
    int touched = 0;
    for (int j = 0; j < grid.size[1]; ++j)
        for (int i = 0; i < grid.size[0]; ++i) {
            const double here = ringAt(i, j, 5);
            most = std::max(most, std::abs(here));
            touched += std::abs(here) > 0.5 * amplitude ? 1 : 0;
            // The same in every slice, and on the other side of the axis.
            EXPECT_NEAR(here, ringAt(i, j, grid.size[2] / 2), 1.01);
            EXPECT_NEAR(here, ringAt(grid.size[0] - 1 - i, grid.size[1] - 1 - j, 5), 1.01);
        }
    EXPECT_LE(most, amplitude + 1.0);
    EXPECT_GT(most, 0.8 * amplitude);
    EXPECT_GT(touched, grid.size[0] * grid.size[1] / 20);
    EXPECT_LT(touched, grid.size[0] * grid.size[1] / 2);
}

TEST(Phantom, AFillingStreaksItsOwnSlicesAndIsInTheTruth) {
    Settings s = sharp(200.0);
    s.metal = 1e-9;  // A filling without streaks.
    const Image without = phantom::image(premolar(), s);
    s.metal = 0.15;
    const Image with = phantom::image(premolar(), s);
    ASSERT_TRUE(with.filling.has_value());
    EXPECT_EQ(without.truth.values, with.truth.values);
    const double restorationMm3 = with.volumesMm3[static_cast<std::size_t>(Tissue::restoration)];
    EXPECT_GT(restorationMm3, 0.3);
    EXPECT_LT(restorationMm3, 1.001 * geometry::enclosedVolumeMm3(with.filling->mesh));
    EXPECT_THAT(with.truth.values, testing::Contains(labelOf(Tissue::restoration)));
    const volume::Grid& grid = with.volume.grid;
    const double amplitude = s.metal * stepOf(Scanner::microCt);
    core::Box filling;
    for (const Vec3& v : with.filling->mesh.vertices)
        filling.extend(with.toothInScan.apply(v));
    double least = 0.0, most = 0.0;
    for (int k = 0; k < grid.size[2]; ++k) {
        const double z = grid.toMm(Vec3(0, 0, k)).z();
        const bool far = z < filling.min.z() - filling.size().z() || z > filling.max.z() + filling.size().z();
        for (std::size_t n = grid.index(0, 0, k); n < grid.index(0, 0, k) + grid.index(0, 0, 1); ++n) {
            const double streak =
                static_cast<double>(with.volume.values[n]) - static_cast<double>(without.volume.values[n]);
            least = std::min(least, streak);
            most = std::max(most, streak);
            if (far) {
                ASSERT_EQ(streak, 0.0);
            }
        }
    }
    EXPECT_LT(most, amplitude + 1.0);
    EXPECT_GT(most, 0.6 * amplitude);
    EXPECT_GT(least, -amplitude - 1.0);
    EXPECT_LT(least, -0.1 * amplitude);  // Air next to the filling cannot become darker than nothing.
}

TEST(Phantom, TheSameBytesAtAnyThreadCountAndOthersForAnotherSeed) {
    Settings s;
    s.voxelUm = 150.0;
    s.ring = 0.02;
    s.metal = 0.05;
    s.turn = core::Quat(Eigen::AngleAxisd(0.4, Vec3(3, 1, 2).normalized()));
    core::setThreadCount(1);
    const Image one = phantom::image(premolar(), s);
    core::setThreadCount(2);
    const Image two = phantom::image(premolar(), s);
    core::setThreadCount(0);
    EXPECT_TRUE(one.volume.values == two.volume.values);
    EXPECT_TRUE(one.truth.values == two.truth.values);
    EXPECT_EQ(one.volumesMm3, two.volumesMm3);
    s.seed = 2;
    const Image other = phantom::image(premolar(), s);
    EXPECT_FALSE(one.volume.values == other.volume.values);
    EXPECT_TRUE(one.truth.values == other.truth.values);
}

TEST(Phantom, SceneryStandsAroundAndNotInTheTooth) {
    cases::Case c = onion();
    c.scenery = {partOf(Tissue::neighbour, ball(kCentre + Vec3(6.5, 0, 0), 2.8)),
                 partOf(Tissue::gum, ball(kCentre - Vec3(0, 0, 4.0), 3.0))};
    Settings s = sharp(250.0);
    const Image alone = phantom::image(c, s);
    s.scenery = true;
    const Image among = phantom::image(c, s);
    EXPECT_EQ(alone.volumesMm3, among.volumesMm3);
    EXPECT_GT(among.volume.grid.size[0], alone.volume.grid.size[0] + 20);
    std::array<double, 256> voxels{};
    for (const std::uint8_t label : among.truth.values)
        voxels[label] += among.truth.grid.voxelMm3();
    EXPECT_NEAR(voxels[kNeighbourLabel] / ballMm3(2.8), 1.0, 0.02);
    EXPECT_GT(voxels[labelOf(Tissue::gum)], 1.0);
    for (const Tissue tissue : {Tissue::enamel, Tissue::dentine, Tissue::pulp})
        EXPECT_NEAR(voxels[labelOf(tissue)] / among.volumesMm3[static_cast<std::size_t>(tissue)], 1.0, 0.03);
}

TEST(Phantom, RefusesWhatItCannotImage) {
    const auto problem = [](const cases::Case& c, const Settings& s) -> std::string {
        try {
            (void)phantom::image(c, s);
        } catch (const core::Error& e) {
            EXPECT_FALSE(e.remedy().empty()) << e.what();
            return e.what();
        }
        return "no error";
    };
    using testing::HasSubstr;
    EXPECT_THAT(problem({}, {}), HasSubstr("no surface"));
    cases::Case open = onion();
    open.parts[1].mesh.triangles.resize(open.parts[1].mesh.triangles.size() / 2);
    EXPECT_THAT(problem(open, sharp(200.0)), testing::AllOf(HasSubstr("dentine"), HasSubstr("not closed")));
    Settings s;
    s.voxelUm = 1.0;
    EXPECT_THAT(problem(onion(), s), HasSubstr("too large"));
    s.voxelUm = 0.0;
    EXPECT_THAT(problem(onion(), s), HasSubstr("--voxel"));
    s = {};
    s.noise = -0.1;
    EXPECT_THAT(problem(onion(), s), HasSubstr("--noise"));
    s = {};
    s.blurVoxels = std::nan("");
    EXPECT_THAT(problem(onion(), s), HasSubstr("--blur"));
    s = {};
    s.turn = core::Quat(2, 0, 0, 0);
    EXPECT_THAT(problem(onion(), s), HasSubstr("--turn"));
    EXPECT_THROW((void)scannerByName("MRI"), core::Error);
}

TEST(Phantom, StopsWhenAskedAndSaysHowFarItIs) {
    Settings s;
    s.voxelUm = 200.0;
    EXPECT_THROW((void)phantom::image(onion(), s, [](double fraction) { return fraction < 0.5; }), core::Error);
    std::atomic<double> most{0.0};
    (void)phantom::image(onion(), s, [&](double fraction) {
        double before = most;
        while (before < fraction && !most.compare_exchange_weak(before, fraction)) {
        }
        return true;
    });
    EXPECT_EQ(most, 1.0);
}

}  // namespace
}  // namespace handpiece::phantom::phantom_test
