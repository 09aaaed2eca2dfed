// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/memory.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/decimate.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/scan/surfacing/nesting.h"
#include "handpiece/scan/surfacing/smoothing.h"
#include "handpiece/scan/surfacing/surfaces.h"

namespace handpiece::surfacing {
namespace {

using cases::Tissue;
using core::Vec3;
using geometry::TriangleMesh;
using geometry::TriangleTree;

constexpr std::size_t kFewestFaces = 4;     ///< a tetrahedron
constexpr double kCoarseStandOutMm = 0.02;  ///< least, where faces are large: flakes of what is below stay away
constexpr double kMaxOffsetMm = 0.02;       ///< a step of putting lost volume back
constexpr double kMaxPulpMm = 0.5;          ///< a pulp of few faces may have to leave a thin wall by this
constexpr int kInsideRounds = 40, kSideRounds = 8;
constexpr double kRemarkMm = 0.01;  ///< a side kept worse than this is worth a remark

/// One run per surface at a time on each core; the progress of all is the mean of theirs, by faces.
class SharedProgress {
  public:
    SharedProgress(const core::Progress& progress, std::vector<double> weights)
        : progress_(progress), weights_(std::move(weights)), done_(weights_.size(), 0.0) {
        for (const double w : weights_)
            sum_ += w;
    }
    [[nodiscard]] core::Progress of(std::size_t i) {
        if (!progress_) return {};
        return [this, i](double fraction) {
            const std::lock_guard lock(mutex_);
            done_[i] = fraction * weights_[i] / sum_;
            double all = 0.0;
            for (const double d : done_)
                all += d;
            return progress_(all);
        };
    }

  private:
    const core::Progress& progress_;
    std::vector<double> weights_, done_;
    double sum_ = 0.0;
    std::mutex mutex_;
};

std::vector<const Surface*> allOf(const Surfaces& surfaces) {
    std::vector<const Surface*> all{&surfaces.outer};
    for (const Surface& tissue : surfaces.tissues)
        all.push_back(&tissue);
    return all;
}

/// Holds the surfaces of fewer faces to the sides that the full ones have of each other.
class Mender {
  public:
    /// With `isOnce` no tree is kept for another step.
    Mender(const Surfaces& full, bool isOnce) : full_(full), isOnce_(isOnce) {}

    /// Gives back which surfaces (0: outer, then the tissues) no moving of vertices could mend: they need more faces.
    std::vector<std::size_t> mend(Surfaces& coarse, const core::Progress& progress) {
        std::vector<std::size_t> bad;
        std::size_t left = 0;
        coarse.outer.errorBoundMm += uncross(coarse.outer.mesh, left);
        if (left > 0) bad.push_back(0);
        // All that the full tooth is asked for first: its tree is as large as all the rest.
        std::vector<std::vector<Bounds>> onTissues(coarse.tissues.size());
        for (std::size_t i = 0; i < coarse.tissues.size(); ++i)
            if (coarse.tissues[i].tissue != Tissue::pulp) onTissues[i] = sidesOf(coarse, coarse.tissues[i]);
        drop(0);
        const TriangleTree tooth(coarse.outer.mesh);
        const Surface* dentine = nullptr;
        for (std::size_t i = 0; i < coarse.tissues.size(); ++i) {
            Surface& tissue = coarse.tissues[i];
            left = 0;
            if (tissue.tissue == Tissue::pulp) {
                if (dentine) inside(coarse, tissue, *dentine, "the dentine");
                left = inside(coarse, tissue, coarse.outer, "the tooth");
            } else {
                left = sides(coarse, tissue, i, onTissues[i]);
                const DrawnBack back = drawBack(tissue.mesh, tooth);
                tissue.errorBoundMm += back.movedMm;
                left += back.left;
            }
            if (left > 0) bad.push_back(i + 1);
            if (tissue.tissue == Tissue::dentine) dentine = &tissue;
            core::report(progress, static_cast<double>(i + 1) / static_cast<double>(coarse.tissues.size()));
        }
        return bad;
    }

  private:
    const TriangleTree& fullTree(std::size_t index) {
        if (trees_.empty()) trees_.resize(full_.tissues.size() + 1);
        std::optional<TriangleTree>& tree = trees_[index];
        if (!tree) tree.emplace(index == 0 ? full_.outer.mesh : full_.tissues[index - 1].mesh);
        return *tree;
    }

    void drop(std::size_t index) {
        if (isOnce_ && !trees_.empty()) trees_[index].reset();
    }

    /// Farther from each other than this two surfaces cannot have crossed by losing faces.
    [[nodiscard]] double nearOf(const Surface& a, const Surface& b) const {
        return 2.0 * (a.errorBoundMm + b.errorBoundMm) + 4.0 * full_.standOutMm + 4.0 * full_.leastGapMm;
    }

    /// Gives back how many pairs of faces still cross, as finish() does.
    std::size_t inside(Surfaces& coarse, Surface& pulp, const Surface& around, std::string_view name) {
        const double gap = 2.0 * full_.leastGapMm;
        const std::vector<Bounds> in(pulp.mesh.vertices.size(), {Bounds{}.low, -gap}),
            out(around.mesh.vertices.size(), {gap, Bounds{}.high});
        return finish(
            coarse, pulp,
            holdApart(pulp.mesh, in, around.mesh, out, nearOf(around, pulp), kMaxPulpMm, kInsideRounds, true, {}), 0.0,
            name);
    }

    /// Vertices on the side of the full surface that they were on; where they were on it they are free.
    static Bounds sideOf(double fullMm, double standOutMm, double gapMm) {
        // Outside: out of the way of flat faces. Inside: no thinner than half of what was there.
        if (fullMm > 0.25 * standOutMm) return {std::min(fullMm, kCoarseStandOutMm), kMaxStandOutMm};
        if (fullMm < -standOutMm) return {Bounds{}.low, -std::min(-0.5 * fullMm, gapMm)};
        return {Bounds{}.low, kMaxStandOutMm};
    }

    /// No nearest point within reach: deep inside, and so it stays.
    static std::optional<double> distance(const TriangleTree& tree, const Vec3& p, double nearMm) {
        const geometry::NearestPoint n = tree.nearest(p, nearMm);
        if (n.triangle == geometry::kNoTriangle) return {};
        return tree.side(p, n) * n.distanceMm;
    }

    /// Where the vertices of a tissue have to stay, by the full tooth.
    std::vector<Bounds> sidesOf(const Surfaces& coarse, const Surface& tissue) {
        const TriangleTree& outer = fullTree(0);
        const double nearMm = nearOf(coarse.outer, tissue);
        std::vector<Bounds> bounds(tissue.mesh.vertices.size());
        core::parallelFor(bounds.size(), 512, [&](std::size_t b, std::size_t e) {
            for (std::size_t v = b; v < e; ++v)
                if (const std::optional<double> mm = distance(outer, tissue.mesh.vertices[v], nearMm))
                    bounds[v] = sideOf(*mm, full_.standOutMm, full_.leastGapMm);
        });
        return bounds;
    }

    std::size_t sides(Surfaces& coarse, Surface& tissue, std::size_t index, const std::vector<Bounds>& onTissue) {
        const TriangleTree& own = fullTree(index + 1);
        std::vector<Bounds> onOuter(coarse.outer.mesh.vertices.size());
        const double nearMm = nearOf(coarse.outer, tissue);
        core::parallelFor(onOuter.size(), 512, [&](std::size_t b, std::size_t e) {
            for (std::size_t v = b; v < e; ++v) {
                const std::optional<double> mm = distance(own, coarse.outer.mesh.vertices[v], nearMm);
                if (!mm) continue;
                const double over = *mm / full_.standOutMm;
                if (over > 1.0) onOuter[v].low = std::min(0.5 * *mm, full_.leastGapMm);
                if (over < -0.25 && over > -2.0) onOuter[v].high = -0.25 * full_.standOutMm;
            }
        });
        drop(index + 1);
        return finish(
            coarse, tissue,
            holdApart(tissue.mesh, onTissue, coarse.outer.mesh, onOuter, nearMm, nearMm, kSideRounds, false, {}),
            kRemarkMm, "the tooth");
    }

    static std::size_t finish(Surfaces& coarse, Surface& tissue, const Apart& apart, double allowedMm,
                              std::string_view name) {
        tissue.errorBoundMm += apart.movedMm;
        const std::string_view own = cases::properties(tissue.tissue).name;
        if (apart.failed > 0 && apart.failedByMm > allowedMm)
            coarse.notes.push_back(
                fmt::format("{} with {} faces does not keep its distance to {} at {} places, one at ({:.2f}, {:.2f}, "
                            "{:.2f}) mm: choose more faces",
                            own, tissue.mesh.triangles.size(), name, apart.failed, apart.failedMm.x(),
                            apart.failedMm.y(), apart.failedMm.z()));
        std::size_t left = 0;
        tissue.errorBoundMm += uncross(tissue.mesh, left);
        return left;
    }

    const Surfaces& full_;
    const bool isOnce_;
    std::vector<std::optional<TriangleTree>> trees_;
};

/// Flat faces cut off what is round: the volume they lost is put back along the normals. Gives back by how much.
double restoreVolume(TriangleMesh& mesh, const Surface& full) {
    Shells together = shellsOf(mesh);
    std::fill(together.ofFace.begin(), together.ofFace.end(), 0u);
    return setVolumes(mesh, together, {geometry::enclosedVolumeMm3(full.mesh)}, kMaxOffsetMm);
}

/// What cannot be mended by moving vertices keeps twice the faces, and twice again.
void mendStep(Mender& mender, const std::vector<const Surface*>& full, Surfaces& step, const core::Progress& progress) {
    const auto nameOf = [](const Surface& s) {
        return s.tissue == Tissue::none ? std::string_view("the tooth") : cases::properties(s.tissue).name;
    };
    const std::vector<std::string> given = step.notes;
    std::vector<std::size_t> tried(full.size(), 0);  // faces at first, of those that got more
    for (;;) {
        step.notes = given;
        for (std::size_t i = 0; i < tried.size(); ++i)
            if (tried[i] > 0)
                step.notes.push_back(
                    fmt::format("{} keeps {} faces: with {} it would cross itself or leave the tooth", nameOf(*full[i]),
                                (i == 0 ? step.outer : step.tissues[i - 1]).mesh.triangles.size(), tried[i]));
        const std::vector<std::size_t> bad = mender.mend(step, progress);
        bool isFiner = false;
        for (const std::size_t i : bad) {
            Surface& surface = i == 0 ? step.outer : step.tissues[i - 1];
            const std::size_t faces = surface.mesh.triangles.size(), most = full[i]->mesh.triangles.size();
            if (faces >= most) {
                step.notes.push_back(fmt::format("{} crosses itself or leaves the tooth", nameOf(*full[i])));
                continue;
            }
            isFiner = true;
            if (tried[i] == 0) tried[i] = faces;
            geometry::Decimated made = geometry::decimate(full[i]->mesh, std::min(2 * faces, most));
            surface.mesh = std::move(made.mesh);
            surface.errorBoundMm = full[i]->errorBoundMm + made.errorBoundMm + restoreVolume(surface.mesh, *full[i]);
        }
        if (!isFiner) return;
    }
}

/// targets[step][surface], each below the surface's own count unless it stays as it is.
std::vector<Surfaces> toTargets(const Surfaces& full, const std::vector<std::vector<std::size_t>>& targets,
                                const core::Progress& progress) {
    const std::vector<const Surface*> all = allOf(full);
    std::vector<Surfaces> steps(targets.size(), Surfaces{});
    for (Surfaces& step : steps) {
        step.leastGapMm = full.leastGapMm;
        step.standOutMm = full.standOutMm;
        step.notes = full.notes;
        step.tissues.resize(full.tissues.size());
    }
    std::vector<double> weights;
    for (const Surface* surface : all)
        weights.push_back(static_cast<double>(surface->mesh.triangles.size()) + 1.0);
    const core::Progress collapsing = core::part(progress, 0.0, 0.7);
    SharedProgress shared(collapsing, weights);
    core::parallelFor(all.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            std::vector<std::size_t> wanted, at;
            for (std::size_t s = 0; s < targets.size(); ++s) {
                Surface& to = i == 0 ? steps[s].outer : steps[s].tissues[i - 1];
                if (targets[s][i] >= all[i]->mesh.triangles.size()) {
                    to = *all[i];
                    continue;
                }
                to.tissue = all[i]->tissue;
                to.isAuthored = all[i]->isAuthored;
                wanted.push_back(targets[s][i]);
                at.push_back(s);
            }
            std::vector<geometry::Decimated> made = geometry::decimateSteps(all[i]->mesh, wanted, shared.of(i));
            for (std::size_t k = 0; k < at.size(); ++k) {
                Surface& to = i == 0 ? steps[at[k]].outer : steps[at[k]].tissues[i - 1];
                to.mesh = std::move(made[k].mesh);
                to.errorBoundMm = all[i]->errorBoundMm + made[k].errorBoundMm + restoreVolume(to.mesh, *all[i]);
            }
        }
    });
    core::giveBackFreeMemory();
    Mender mender(full, steps.size() == 1);
    for (std::size_t s = 0; s < steps.size(); ++s) {
        const double from = 0.7 + 0.3 * static_cast<double>(s) / static_cast<double>(steps.size());
        bool isWhole = true;
        for (std::size_t i = 0; i < all.size(); ++i)
            isWhole = isWhole && targets[s][i] >= all[i]->mesh.triangles.size();
        if (!isWhole)
            mendStep(mender, all, steps[s], core::part(progress, from, from + 0.3 / static_cast<double>(steps.size())));
    }
    core::report(progress, 1.0);
    return steps;
}

/// The even number nearest to `faces`.
std::size_t evenNear(double faces) {
    return std::max(kFewestFaces, 2 * static_cast<std::size_t>(std::llround(0.5 * faces)));
}

}  // namespace

std::vector<Surfaces> decimatedSteps(const Surfaces& full, std::span<const double> percents,
                                     const core::Progress& progress) {
    std::vector<std::vector<std::size_t>> targets;
    for (const double percent : percents) {
        if (!(percent > 0.0 && percent <= 100.0))
            throw core::Error(fmt::format("{} percent of the faces is not possible", percent), "--percent",
                              "give a number above 0, up to 100");
        targets.emplace_back();
        for (const Surface* surface : allOf(full))
            targets.back().push_back(evenNear(0.01 * percent * static_cast<double>(surface->mesh.triangles.size())));
    }
    return toTargets(full, targets, progress);
}

double usefulPercent(const Surfaces& full, double voxelMm) {
    double areaMm2 = 0.0, faces = 0.0;
    for (const Surface* surface : allOf(full)) {
        areaMm2 += geometry::surfaceAreaMm2(surface->mesh);
        faces += static_cast<double>(surface->mesh.triangles.size());
    }
    // Of equilateral triangles with edges of two voxels.
    const double useful = areaMm2 / (std::sqrt(3.0) * voxelMm * voxelMm);
    return std::clamp(std::ceil(100.0 * useful / std::max(faces, 1.0)), 1.0, 100.0);
}

Surfaces decimated(const Surfaces& full, double percent, const core::Progress& progress) {
    return std::move(decimatedSteps(full, std::span(&percent, 1), progress).front());
}

Surfaces decimatedTo(const Surfaces& full, std::size_t faces, const core::Progress& progress) {
    constexpr std::size_t kFewestEach = 100;
    const std::vector<const Surface*> all = allOf(full);
    if (faces < kFewestEach * all.size())
        throw core::Error(fmt::format("{} faces are too few for {} surfaces", faces, all.size()), "--faces",
                          fmt::format("give {} at least", kFewestEach * all.size()));
    double areaMm2 = 0.0;
    for (const Surface* surface : all)
        areaMm2 += geometry::surfaceAreaMm2(surface->mesh);
    std::vector<std::size_t> targets;
    for (const Surface* surface : all)
        targets.push_back(std::max(
            kFewestEach, evenNear(static_cast<double>(faces) * geometry::surfaceAreaMm2(surface->mesh) / areaMm2)));
    return std::move(toTargets(full, {targets}, progress).front());
}

}  // namespace handpiece::surfacing
