// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/lesion/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/isosurface.h"

namespace handpiece::lesion {

using cases::Tissue;
using core::Vec3;

namespace {

/// Over the surface, so that what is felt there is the lesion.
constexpr double kProudMm = 0.03;
constexpr double kLeastSolidMm = 0.55;  ///< across; cases::requireSolid asks for 0.5
/// Each level's flat sides lie so much within those of the next harder one.
constexpr double kNestMm = 0.006;
/// Up and down, of shares (the classes leave room for it) and of radii: lesions are no cones turned on a lathe.
constexpr double kRagged = 0.06, kRaggedAside = 0.16, kFrayed = 0.12;

/// A closed surface to be made: its tissue, and its function at a node.
struct Solid {
    Tissue tissue;
    std::vector<float> values;
};

/// A regular grid over what a lesion may reach.
struct Grid {
    Vec3 origin;
    double spacing;
    std::array<std::uint32_t, 3> nodes;

    Grid(const core::Box& box, double spacingMm) : origin(box.min), spacing(spacingMm) {
        for (int k = 0; k < 3; ++k)
            nodes[static_cast<std::size_t>(k)] =
                static_cast<std::uint32_t>(std::ceil((box.max[k] - box.min[k]) / spacingMm)) + 1;
    }
    [[nodiscard]] std::size_t size() const { return std::size_t{nodes[0]} * nodes[1] * nodes[2]; }
    [[nodiscard]] Vec3 at(std::size_t i) const {
        return origin + spacing * Vec3(static_cast<double>(i % nodes[0]), static_cast<double>(i / nodes[0] % nodes[1]),
                                       static_cast<double>(i / nodes[0] / nodes[1]));
    }
};

/// Fills the solids: `f(p, out)` gives one value a solid, all of them outside unless it says otherwise.
void fill(const Grid& grid, std::vector<Solid>& solids, const std::function<void(const Vec3&, double*)>& f) {
    for (Solid& s : solids)
        s.values.resize(grid.size());
    core::parallelFor(grid.size(), 4096, [&](std::size_t begin, std::size_t end) {
        std::vector<double> values(solids.size());
        for (std::size_t i = begin; i < end; ++i) {
            std::fill(values.begin(), values.end(), 1.0);
            f(grid.at(i), values.data());
            for (std::size_t k = 0; k < solids.size(); ++k) {
                // No node on the surface itself: its triangles would have no area.
                const auto value = static_cast<float>(values[k]);
                solids[k].values[i] = std::abs(value) < 1e-4f ? std::copysign(1e-4f, value) : value;
            }
        }
    });
}

std::vector<cases::Part> partsOf(const Grid& grid, const std::vector<Solid>& solids, const std::string& name) {
    std::vector<cases::Part> parts;
    for (const Solid& s : solids) {
        geometry::TriangleMesh mesh =
            geometry::isosurface(geometry::ScalarGrid{grid.origin, grid.spacing, grid.nodes, s.values});
        // A level too small for a case to hold is of the next harder one.
        if (mesh.triangles.empty() || mesh.bounds().size().norm() < kLeastSolidMm) continue;
        const cases::TissueProperties& tissue = cases::properties(s.tissue);
        parts.push_back({solids.size() > 1 ? fmt::format("{} {}", name, tissue.name) : name, s.tissue, tissue.priority,
                         std::move(mesh)});
    }
    return parts;
}

/// A sum of waves in all directions, -1 to 1.
class Waves {
  public:
    Waves(Dice& dice, double radPerMm) {
        for (Wave& w : waves_)
            w = {Vec3(dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)).normalized() *
                     dice.between(0.7 * radPerMm, 1.3 * radPerMm),
                 dice.between(0.0, 2.0 * M_PI)};
    }
    [[nodiscard]] double at(const Vec3& p) const {
        double sum = 0.0;
        for (const Wave& w : waves_)
            sum += core::sin(w.along.dot(p) + w.phase);
        return sum / static_cast<double>(waves_.size());
    }

  private:
    struct Wave {
        Vec3 along;
        double phase;
    };
    std::array<Wave, 4> waves_;
};

core::Box boxAbout(const Ways& ways, double byMm) {
    core::Box box;
    for (const auto& way : ways)
        for (const Vec3& p : way)
            box.extend(p);
    return box.grown(byMm);
}

struct Sizes {
    double least, most;     ///< share of the enamel or dentine that it goes in
    double surfaceMm;       ///< radius in the enamel, where it is widest
    double alongGingiva;    ///< so many times as wide as high under a contact
    double junctionMm = 0;  ///< radius along the dentine
    double openMm = 0;      ///< radius of the hole in the enamel, full of soft tissue; 0: none
};
// Of a molar; chosen, docs/lesions.md. Shares with the raggedness stay within the class.
constexpr std::array<Sizes, 5> kSizes = {{{0.25, 0.45, 0.8, 1.5, 0, 0},
                                          {0.62, 0.92, 1.1, 2.0, 0, 0},
                                          {0.14, 0.30, 1.2, 2.1, 1.2, 0},
                                          {0.42, 0.60, 1.3, 2.0, 1.7, 0.35},
                                          {0.74, 0.86, 1.5, 1.7, 2.1, 0.6}}};
/// How far out each level reaches, of the whole lesion: what is shallow is hardly softened.
struct Reach {
    Tissue tissue;
    double share;
};
std::vector<Reach> levelsOf(Finding finding) {
    using enum Tissue;
    if (finding == Finding::d1)
        return {{cariesFirmToHard, 1.0}, {cariesFirm, 0.84}, {cariesLeatheryToFirm, 0.68}, {cariesLeathery, 0.48}};
    if (finding == Finding::d2)
        return {{cariesFirmToHard, 1.0}, {cariesFirm, 0.90},           {cariesLeatheryToFirm, 0.80},
                {cariesLeathery, 0.69},  {cariesSoftToLeathery, 0.57}, {cariesSoft, 0.44}};
    return {{cariesFirmToHard, 1.0}, {cariesFirm, 0.92},           {cariesLeatheryToFirm, 0.84},
            {cariesLeathery, 0.75},  {cariesSoftToLeathery, 0.65}, {cariesSoft, 0.53}};
}

double shareOf(double in, double left) {
    const double a = std::max(0.0, in), b = std::max(0.0, left);
    return a + b > 0.0 ? a / (a + b) : 0.0;
}

/// A cone along the way in: widest at share 0, its tip at `most`.
double coneOf(double asideMm, double radiusMm, double share, double most) {
    constexpr double kBend = 1.3;  // 1: straight sides
    return core::pow(core::pow(asideMm / radiusMm, kBend) + core::pow(share / most, kBend), 1.0 / kBend);
}

std::vector<cases::Part> cariesOf(const Surfaces& surfaces, const Ways& ways, const Lesion& lesion,
                                  const std::string& name, const Options& options, Dice& dice) {
    const Sizes& sizes = kSizes[static_cast<std::size_t>(lesion.finding)];
    const double scale = surfaces.scale() * dice.between(0.88, 1.12);
    const double most = dice.between(sizes.least, sizes.most);
    const double wide = scale * sizes.surfaceMm, open = scale * sizes.openMm;
    const bool inDentine = sizes.junctionMm > 0.0, inEnamel = lesion.surface != Surface::root,
               fromFissure = lesion.surface == Surface::occlusal;
    // A fissure's lesion is long already.
    const double along = (fromFissure ? 0.75 : 1.0) * scale * sizes.junctionMm;
    const Waves broad(dice, 2.5), fine(dice, 9.0);
    std::vector<Solid> solids;
    if (inEnamel) solids.push_back({Tissue::demineralisedEnamel, {}});
    const std::vector<Reach> levels = inDentine ? levelsOf(lesion.finding) : std::vector<Reach>{};
    for (const Reach& level : levels)
        solids.push_back({level.tissue, {}});
    const double reach = 1.4 * std::max(wide, along);
    // Between contact and gingiva, and along it, as plaque does: wider than high.
    const bool isProximal = lesion.surface == Surface::mesial || lesion.surface == Surface::distal;
    const Vec3 stretched(1.0, isProximal ? sizes.alongGingiva : 1.0, 1.0);
    Ways round = ways;
    for (std::vector<Vec3>& way : round)
        for (Vec3& p : way)
            p = p.cwiseQuotient(stretched);
    core::Box box = boxAbout(round, reach);
    const Grid grid({box.min.cwiseProduct(stretched), box.max.cwiseProduct(stretched)}, options.spacingMm);
    fill(grid, solids, [&](const Vec3& p, double* out) {
        const double way = distanceMm(round, p.cwiseQuotient(stretched));
        if (way > reach) return;
        // Deep in the dentine the outside decides nothing.
        const double dentine = surfaces.dentine(p), outer = dentine < -0.25 ? dentine : surfaces.outer(p);
        if (outer > 0.5) return;
        const double wave = broad.at(p), ragged = 1.0 + kRagged * wave;
        // Frayed where it is seen; in the dentine less, or crumbs would come off its edge.
        const double aside = way * (1.0 + kRaggedAside * wave + (dentine < 0.0 ? 0.3 : 1.0) * kFrayed * fine.at(p));
        const double inward = shareOf(-outer, dentine) * ragged;  // of the enamel
        if (inEnamel) {
            double value;
            // On a smooth surface a cone with its base outside, cut off where it goes on into the dentine; from a
            // fissure's walls one with its base at the dentine.
            if (fromFissure) {
                const double radius = wide * (0.35 + 0.65 * std::min(1.0, inward));
                value = std::max(aside - radius, inDentine ? -1.0 : inward - most);
            } else {
                value = inDentine ? aside - wide * (1.0 - 0.6 * std::min(1.0, inward))
                                  : wide * (coneOf(aside, wide, inward, most) - 1.0);
            }
            *out++ = std::max({value, outer - kProudMm, -dentine - 0.1});
        }
        if (!inDentine) return;
        const double deep = aside < 1.2 * along ? shareOf(-dentine, surfaces.pulp(p)) * ragged : 0.0;
        const double cone = coneOf(aside, along, deep, most);
        for (std::size_t k = 0; k < levels.size(); ++k) {
            const double nest = kNestMm * static_cast<double>(k), share = levels[k].share;
            double value = std::max(along * (cone - share), dentine - kProudMm + nest);
            if (open > 0.0 && inEnamel)
                value = std::min(value, std::max(aside - open * (0.4 + 0.6 * share), -dentine - 0.15));
            *out++ = std::max(value, outer - kProudMm + nest);
        }
    });
    return partsOf(grid, solids, name);
}

}  // namespace

std::vector<cases::Part> partsOf(const Surfaces& surfaces, const cases::Tooth& tooth, const Lesion& lesion,
                                 const Options& options, std::size_t number) {
    Dice dice(options.seed * 1000003u + number);
    const std::string name = fmt::format("{}-{}", kSurfaces[static_cast<std::size_t>(lesion.surface)],
                                         kFindings[static_cast<std::size_t>(lesion.finding)]);
    if (lesion.finding <= Finding::d3)
        return cariesOf(surfaces, waysIn(surfaces, tooth, lesion, dice), lesion, name, options, dice);
    const double scale = surfaces.scale();
    std::vector<Solid> solids(1);
    if (lesion.finding == Finding::filling) {
        // A box's walls and floor, a little into the dentine.
        const Ways ways = waysIn(surfaces, tooth, lesion, dice);
        const double radius = scale * dice.between(0.9, 1.3), floor = dice.between(0.1, 0.25);
        solids[0].tissue = Tissue::restoration;
        const Grid grid(boxAbout(ways, 1.2 * radius), options.spacingMm);
        fill(grid, solids, [&](const Vec3& p, double* out) {
            const double way = distanceMm(ways, p);
            if (way > 1.2 * radius) return;
            const double deep = shareOf(-surfaces.dentine(p), surfaces.pulp(p));
            *out = std::max({way - radius, 2.5 * (deep - floor), surfaces.outer(p) - kProudMm});
        });
        return partsOf(grid, solids, name);
    }
    solids[0].tissue = Tissue::stainedEnamel;
    if (lesion.finding == Finding::stain) {
        const Ways line{entries(surfaces, tooth, lesion.surface, 6.0 * scale, dice)};
        const double radius = dice.between(0.18, 0.26);
        const Grid grid(boxAbout(line, 2.0 * radius), std::min(options.spacingMm, 0.04));
        fill(grid, solids, [&](const Vec3& p, double* out) {
            const double way = distanceMm(line, p);
            if (way < 2.0 * radius) *out = std::max(way - radius, surfaces.outer(p) - kProudMm);
        });
        return partsOf(grid, solids, name);
    }
    // A crack: upright, from the margin down, through the enamel as far as the dentine.
    const Vec3 out = outwards(tooth, lesion.surface == Surface::occlusal ? Surface::mesial : lesion.surface);
    const Vec3 across = Vec3::UnitZ().cross(out);
    Lesion side = lesion;
    if (side.surface == Surface::occlusal) side.surface = Surface::mesial;
    const Vec3 middle = entries(surfaces, tooth, side.surface, 0.0, dice).front() + Vec3(0.0, 0.0, scale);
    const double length = scale * dice.between(1.6, 2.4);
    const Waves waves(dice, 3.0);
    constexpr double kHalfMm = 0.06;
    const Vec3 half = (length + 0.1) * (out.cwiseAbs() + Vec3::UnitZ()) + 0.4 * across.cwiseAbs();
    const Grid grid(core::Box{middle - half, middle + half}, std::min(options.spacingMm, 0.04));
    fill(grid, solids, [&](const Vec3& p, double* value) {
        const Vec3 from = p - middle;
        const double aside = std::abs(from.dot(across) + 0.12 * waves.at(Vec3(from.dot(out), 0.0, from.z())));
        if (aside > 3.0 * kHalfMm) return;
        *value = std::max(
            {aside - kHalfMm, from.norm() - length, surfaces.outer(p) - kProudMm, -surfaces.dentine(p) - 0.05});
    });
    return partsOf(grid, solids, name);
}

Deposit depositAt(const Surfaces& surfaces, const cases::Tooth& tooth, Surface surface, const Options& options,
                  std::size_t number) {
    if (surface == Surface::occlusal)
        throw core::Error("calculus does not lie on chewing surfaces", tooth.name, "choose another surface");
    Dice dice(options.seed * 1000003u + number);
    Vec3 middle = entries(surfaces, tooth, surface, 0.0, dice).front();
    // Along the gingiva, whichever side.
    const Vec3 out = outwards(tooth, surface);
    const double z = surfaces.cervixMm(out) + dice.between(0.2, 0.8);
    if (const auto met = surfaces.meeting(Vec3(middle.x(), middle.y(), z) + 20.0 * out, -out)) middle = *met;
    return {middle, surfaces.scale() * dice.between(1.8, 2.6), dice.between(0.3, 0.5), options.seed + number};
}

double Deposit::thicknessMm(const Vec3& p) const {
    constexpr double kBand = 1.8;  // so much longer along the gingiva than high
    Dice dice(seed);
    const Waves waves(dice, 3.5);
    const Vec3 d = (p - middle).cwiseProduct(Vec3(1.0, 1.0, kBand)) / radiusMm;
    return thickMm * (1.0 - d.squaredNorm()) * (1.0 + 0.4 * waves.at(p));
}

cases::Part partOf(const Surfaces& surfaces, const Deposit& deposit, std::string name, const Options& options) {
    std::vector<Solid> solids(1);
    solids[0].tissue = Tissue::calculus;
    const Grid grid(core::Box{deposit.middle, deposit.middle}.grown(deposit.radiusMm + 0.2), options.spacingMm);
    fill(grid, solids, [&](const Vec3& p, double* out) {
        if ((p - deposit.middle).norm() > deposit.radiusMm + 0.15) return;
        const double outer = surfaces.outer(p);
        *out = std::max(outer - deposit.thicknessMm(p), -outer - 0.1);
    });
    std::vector<cases::Part> parts = partsOf(grid, solids, name);
    if (parts.empty()) throw core::Error("calculus has no place there", name);
    return std::move(parts.front());
}

}  // namespace handpiece::lesion
