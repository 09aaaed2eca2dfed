// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/phantom/phantom.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/scan/phantom/artefacts.h"
#include "handpiece/scan/phantom/rays.h"

namespace handpiece::phantom {
namespace {

using cases::Tissue;
using core::Vec3;

/// Grey values by Tissue: outside, enamel, dentine, pulp, caries, cementum, gum, bone, neighbour, restoration,
/// demineralised enamel, carious dentine from soft to nearly hard, stained enamel, calculus. CBCT in Hounsfield units,
/// as clinical scans show them; micro-CT as 16 bits of one that is set so that metal just fits.
constexpr std::array<double, cases::kTissueCount> kCbct = {-1000, 2800, 1500, 80,  900,  1350, 50,   850,  2200, 6000,
                                                           2100,  600,  750,  900, 1050, 1200, 1350, 2800, 1400};
constexpr std::array<double, cases::kTissueCount> kMicroCt = {6000,  48000, 27000, 9500,  19000, 24500, 9000,
                                                              20000, 38000, 63000, 38000, 15000, 17000, 19000,
                                                              21000, 23000, 25000, 48000, 25000};

/// 16 GB of grey values would be asked for by accident.
constexpr double kMaxVoxels = 2e9;

geometry::TriangleMesh wholeTooth(const cases::Case& toothCase) {
    if (!toothCase.outer.triangles.empty()) return toothCase.outer;
    geometry::TriangleMesh all;
    for (const cases::Part& part : toothCase.parts) {
        const auto first = static_cast<std::uint32_t>(all.vertices.size());
        all.vertices.insert(all.vertices.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
        for (const geometry::Triangle& t : part.mesh.triangles)
            all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    return all;
}

core::Box turnedBounds(const geometry::TriangleMesh& mesh, const core::Pose& pose) {
    core::Box box;
    for (const Vec3& v : mesh.vertices)
        box.extend(pose.apply(v));
    return box;
}

/// A grid over a box, its voxels centred in it.
volume::Grid gridOver(const core::Box& box, double voxelMm) {
    volume::Grid grid;
    grid.spacingMm = Vec3::Constant(voxelMm);
    double voxels = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double size = std::ceil(box.size()[axis] / voxelMm);
        voxels *= size;
        if (!(voxels < kMaxVoxels))
            throw core::Error(fmt::format("a scan of {:.1f} x {:.1f} x {:.1f} mm in voxels of {:g} um is too large",
                                          box.size().x(), box.size().y(), box.size().z(), voxelMm * 1000.0),
                              "make scan", "give larger voxels");
        grid.size[static_cast<std::size_t>(axis)] = std::max(1, static_cast<int>(size));
        grid.originMm[axis] = box.centre()[axis] - 0.5 * (grid.size[static_cast<std::size_t>(axis)] - 1) * voxelMm;
    }
    return grid;
}

void require(double value, double least, double most, const char* what, const char* where) {
    if (!(value >= least && value <= most))
        throw core::Error(fmt::format("{} of {:g} is not possible", what, value), where,
                          fmt::format("give {:g} to {:g}", least, most));
}

/// A neighbour is one surface in a case; a scanner sees enamel, dentine and pulp of it. Enamel: from nothing at the
/// neck (z = 0) to its full thickness; pulp: what lies deep. In the truth all of it is the neighbour.
std::vector<cases::Part> insideOf(const cases::Part& neighbour) {
    constexpr double kEnamelMm = 1.0, kFullFromMm = 3.0, kDeepMm = 2.6;
    const geometry::TriangleTree tree(neighbour.mesh);
    geometry::IsosurfaceSettings settings;
    settings.spacingMm = 0.25;
    settings.lipschitz = 1.0 + kEnamelMm / kFullFromMm;
    const core::Box box = neighbour.mesh.bounds().grown(0.5);
    const int priority = cases::properties(Tissue::restoration).priority;
    std::vector<cases::Part> parts{{neighbour.name, Tissue::enamel, priority, neighbour.mesh}};
    const auto add = [&](Tissue tissue, const geometry::ScalarFunction& f) {
        geometry::TriangleMesh mesh = geometry::isosurface(box, f, settings);
        if (!mesh.triangles.empty())
            parts.push_back({neighbour.name, tissue, priority + static_cast<int>(parts.size()), std::move(mesh)});
    };
    add(Tissue::dentine,
        [&](const Vec3& p) { return tree.signedDistance(p) + kEnamelMm * std::clamp(p.z() / kFullFromMm, 0.01, 1.0); });
    add(Tissue::pulp, [&](const Vec3& p) { return tree.signedDistance(p) + kDeepMm; });
    return parts;
}

/// Grey values of a slice before any blur, and its truth.
void imageSlice(const Rays& rays, int k, Scanner scanner, Image& image) {
    const volume::Grid& grid = image.volume.grid;
    const auto columns = static_cast<std::size_t>(grid.size[0]);
    const double outside = greyOf(scanner, Tissue::none);
    // Differences along each row; a step inside a voxel is shared with the next by where it lies.
    std::vector<double> steps((columns + 1) * static_cast<std::size_t>(grid.size[1]), 0.0);
    const auto addStep = [&](std::size_t row, double at, double by) {
        const double place = std::clamp(at + 0.5, 0.0, static_cast<double>(columns));
        const auto voxel = std::min(static_cast<std::size_t>(place), columns - 1);
        const double share = place - static_cast<double>(voxel);
        steps[row * (columns + 1) + voxel] += (1.0 - share) * by;
        steps[row * (columns + 1) + voxel + 1] += share * by;
    };
    rays.slice(k, true, true, [&](int j, int ray, std::span<const Stretch> stretches) {
        for (const Stretch& s : stretches) {
            if (ray > 0) {
                const double by = (greyOf(scanner, s.tissue) - outside) / kRays;
                addStep(static_cast<std::size_t>(j), s.from, by);
                addStep(static_cast<std::size_t>(j), s.to, -by);
                continue;
            }
            const bool isNeighbour = s.isScenery && s.tissue != Tissue::gum && s.tissue != Tissue::bone;
            const std::uint8_t label = isNeighbour ? kNeighbourLabel : labelOf(s.tissue);
            const int first = static_cast<int>(std::ceil(std::max(s.from, 0.0)));
            const int last = static_cast<int>(std::ceil(std::min(s.to, static_cast<double>(columns)))) - 1;
            for (int i = first; i <= last; ++i)
                image.truth.values[grid.index(i, j, k)] = label;
        }
    });
    for (int j = 0; j < grid.size[1]; ++j) {
        const double* from = &steps[static_cast<std::size_t>(j) * (columns + 1)];
        float* to = &image.volume.values[grid.index(0, j, k)];
        double sum = outside;
        for (std::size_t i = 0; i < columns; ++i) {
            sum += from[i];
            to[i] = static_cast<float>(sum);
        }
    }
}

Streaks streaksOf(const cases::Part& filling, const Image& image, double amplitude) {
    const volume::Grid& grid = image.volume.grid;
    core::Box box;
    for (const Vec3& v : filling.mesh.vertices)
        box.extend(grid.toVoxels(image.toothInScan.apply(v)));
    Streaks streaks;
    streaks.centreVoxels = box.centre();
    streaks.radiusVoxels = std::max(1.0, 0.25 * (box.size().x() + box.size().y()));
    streaks.halfHeightVoxels = std::max(1.0, 0.5 * box.size().z());
    streaks.amplitude = amplitude;
    return streaks;
}

}  // namespace

Scanner scannerByName(std::string_view name) {
    for (const Scanner scanner : {Scanner::microCt, Scanner::cbct})
        if (name == nameOf(scanner)) return scanner;
    throw core::Error(fmt::format("there is no scanner called \"{}\"", name), "--scanner",
                      "choose one of micro-ct, cbct");
}

std::string_view nameOf(Scanner scanner) {
    return scanner == Scanner::cbct ? "cbct" : "micro-ct";
}

void check(const Settings& s) {
    require(s.voxelUm, 1.0, 5000.0, "a voxel [um]", "--voxel");
    require(s.noise, 0.0, 1.0, "noise", "--noise");
    require(s.blurVoxels, 0.0, 20.0, "a blur [voxels]", "--blur");
    require(s.ring, 0.0, 1.0, "a ring", "--ring");
    require(s.metal, 0.0, 1.0, "metal", "--metal");
    require(s.marginMm, 0.0, 100.0, "a margin [mm]", "margin");
    if (!core::Pose{Vec3::Zero(), s.turn}.isValid())
        throw core::Error("the turn is no rotation", "--turn", "give a unit quaternion");
}

double greyOf(Scanner scanner, Tissue tissue) {
    return (scanner == Scanner::cbct ? kCbct : kMicroCt).at(static_cast<std::size_t>(tissue));
}

std::uint8_t labelOf(Tissue tissue) {
    // In the order of Tissue; cementum counts as dentine, carious dentine of every level as caries, what is left of
    // enamel as enamel. Calculus has no label of its own: it counts as dentine, which it is as dense as.
    constexpr std::array<std::uint8_t, cases::kTissueCount> kLabels = {0, 2, 3, 4, 1, 3, 7, 6, kNeighbourLabel, 5, 2,
                                                                       1, 1, 1, 1, 1, 1, 2, 3};
    return kLabels.at(static_cast<std::size_t>(tissue));
}

cases::Part makeFilling(const cases::Case& toothCase) {
    const geometry::TriangleMesh whole = wholeTooth(toothCase);
    const core::Box box = whole.bounds();
    const geometry::TriangleTree tree(whole);
    // Over the middle of the crown's top fifth.
    core::Box crown;
    for (const Vec3& v : whole.vertices)
        if (v.z() > box.max.z() - 0.2 * box.size().z()) crown.extend(v);
    const Vec3 above(crown.centre().x(), crown.centre().y(), box.max.z() + 1.0);
    const geometry::RayMeeting met = tree.firstMeeting(above, -Vec3::UnitZ());
    if (met.triangle == geometry::kNoTriangle)
        throw core::Error("there is no place for a filling in this tooth", toothCase.name, "leave --metal out");
    const double half = std::min({crown.size().x(), crown.size().y(), box.size().z()}) / 8.0;
    const Vec3 centre = above - Vec3::UnitZ() * (met.distanceMm + 0.5 * half);
    // A little proud of the surface, so that nothing of the tooth is left over it.
    constexpr double kProudMm = 0.03;
    const auto f = [&](const Vec3& p) {
        const double ball = (p - centre).norm() - half;
        return ball > 0.5 * half ? ball : std::max(ball, tree.signedDistance(p) - kProudMm);
    };
    geometry::IsosurfaceSettings settings;
    settings.spacingMm = half / 20.0;
    geometry::TriangleMesh mesh = geometry::isosurface(core::Box{centre, centre}.grown(1.2 * half), f, settings);
    return {"filling", Tissue::restoration, cases::properties(Tissue::restoration).priority, std::move(mesh)};
}

std::array<double, cases::kTissueCount> volumesMm3(const cases::Case& toothCase, const core::Progress& progress) {
    constexpr double kSteps = 160.0;  // along the longest side: some hundred thousand rays
    const core::Box box = wholeTooth(toothCase).bounds();
    if (box.isEmpty())
        throw core::Error("the case has no surface that could be imaged", toothCase.name, "give one with an outer.stl");
    const double stepMm = box.size().maxCoeff() / kSteps;
    const volume::Grid grid = gridOver(box.grown(2.0 * stepMm), stepMm);
    const Rays rays(toothCase, {}, grid, false);
    const auto slices = static_cast<std::size_t>(grid.size[2]);
    std::vector<std::array<double, cases::kTissueCount>> sums(slices);
    std::atomic<std::size_t> done{0};
    core::parallelFor(slices, 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            sums[k].fill(0.0);
            rays.slice(static_cast<int>(k), false, true, [&](int, int, std::span<const Stretch> stretches) {
                for (const Stretch& s : stretches)
                    sums[k][static_cast<std::size_t>(s.tissue)] += s.to - s.from;
            });
            core::report(progress, static_cast<double>(++done) / static_cast<double>(slices));
        }
    });
    std::array<double, cases::kTissueCount> volumes{};
    for (const auto& sum : sums)
        for (std::size_t t = 0; t < volumes.size(); ++t)
            volumes[t] += sum[t] * grid.voxelMm3() / kRays;
    return volumes;
}

Image image(const cases::Case& toothCase, const Settings& settings, const core::Progress& progress) {
    check(settings);
    Image image;
    cases::Case imaged = toothCase;
    if (settings.metal > 0.0) {
        image.filling = makeFilling(toothCase);
        imaged.parts.push_back(*image.filling);
    }
    const double voxelMm = settings.voxelUm / 1000.0;
    const geometry::TriangleMesh whole = wholeTooth(imaged);
    if (whole.triangles.empty())
        throw core::Error("the case has no surface that could be imaged", toothCase.name, "give one with an outer.stl");
    image.toothInScan.orientation = settings.turn;
    core::Box box = turnedBounds(whole, image.toothInScan);
    if (settings.scenery)
        for (const cases::Part& part : imaged.scenery)
            if (part.tissue == Tissue::neighbour) {
                const core::Box other = turnedBounds(part.mesh, image.toothInScan);
                box.extend(other.min);
                box.extend(other.max);
            }
    box = box.grown(settings.marginMm);
    // The first voxel is the scanner's origin.
    volume::Grid grid = gridOver(box, voxelMm);
    image.toothInScan.positionMm = -grid.originMm;
    grid.originMm = Vec3::Zero();
    image.volume.grid = image.truth.grid = grid;
    image.volume.values.resize(grid.count());
    image.truth.values.assign(grid.count(), 0);

    image.volumesMm3 = volumesMm3(imaged, core::part(progress, 0.0, 0.15));
    const std::vector<double> weights = normalWeights(settings.blurVoxels);
    {
        if (settings.scenery) {
            std::vector<cases::Part> scenery;
            for (cases::Part& part : imaged.scenery) {
                if (part.tissue != Tissue::neighbour) {
                    scenery.push_back(std::move(part));
                    continue;
                }
                for (cases::Part& piece : insideOf(part))
                    scenery.push_back(std::move(piece));
            }
            imaged.scenery = std::move(scenery);
        }
        const Rays rays(imaged, image.toothInScan, grid, settings.scenery);
        const auto slices = static_cast<std::size_t>(grid.size[2]);
        const auto area = static_cast<std::size_t>(grid.size[0]) * static_cast<std::size_t>(grid.size[1]);
        const core::Progress share = core::part(progress, 0.15, 0.55);
        std::atomic<std::size_t> done{0};
        core::parallelFor(slices, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                imageSlice(rays, static_cast<int>(k), settings.scanner, image);
                blurSlice({&image.volume.values[k * area], area}, grid.size[0], grid.size[1], weights);
                core::report(share, static_cast<double>(++done) / static_cast<double>(slices));
            }
        });
    }
    blurAcross(image.volume, weights, core::part(progress, 0.55, 0.7));

    const double step = greyOf(settings.scanner, Tissue::enamel) - greyOf(settings.scanner, Tissue::none);
    Artefacts artefacts;
    artefacts.noise = settings.noise * step;
    artefacts.ring = settings.ring * step;
    artefacts.seed = settings.seed;
    if (image.filling) artefacts.streaks = streaksOf(*image.filling, image, settings.metal * step);
    if (settings.scanner == Scanner::cbct) {
        artefacts.least = -32768.0;
        artefacts.most = 32767.0;
    }
    addArtefacts(image.volume, artefacts, core::part(progress, 0.7, 1.0));
    core::report(progress, 1.0);
    return image;
}

}  // namespace handpiece::phantom
