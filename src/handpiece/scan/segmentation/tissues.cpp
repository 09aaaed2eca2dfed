// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/base/core/parallel.h"
#include "handpiece/scan/segmentation/work.h"

namespace handpiece::segmentation {

using core::Vec3;

namespace {
constexpr float kSlope = 2.5066f;  ///< sqrt(2 pi)
constexpr double kMinPulpMm3 = 0.02;
constexpr double kMinCariesMm3 = 0.12;
constexpr double kCariesReachMm = 0.8;  ///< a lesion lies this near to enamel or to the outside
constexpr double kChannelMm = 0.5;      ///< half the width of a channel through the enamel, at most
constexpr double kMinEnamelMm3 = 0.3;
constexpr float kFaintEnamel = 0.18f;  ///< of the step from dentine: so bright is an edge thinner than the blur

float median(std::vector<float>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Median grey value of the voxels that are set, eroded as often as leaves enough of them.
float levelOf(const Work& work, Mask mask, int rounds, float otherwise) {
    std::vector<float> values;
    for (int round = 0; round <= rounds; ++round) {
        std::vector<float> now;
        for (std::size_t n = 0; n < mask.size(); ++n)
            if (mask[n]) now.push_back(work.damped[n]);
        if (now.size() < 30) break;
        values.swap(now);
        mask = eroded(work.shape, mask);
    }
    return values.size() < 30 ? otherwise : median(values);
}

/// Where a lesion may begin: close to enamel, on its dentine side or in it.
Mask nearEnamel(const Work& work) {
    const Shape& shape = work.shape;
    Mask mask(shape.count());
    for (std::size_t n = 0; n < mask.size(); ++n)
        mask[n] = work.outer[n] > 1 && work.damped[n] > work.levels.enamelFrom;
    const Field far = squaredDistance(shape, mask);
    const double reach = kCariesReachMm / work.spacingMm();
    for (std::size_t n = 0; n < mask.size(); ++n)
        mask[n] = far[n] < reach * reach;
    return mask;
}

/// Pulp: dark, inside, connected; and the thin canals that go on from it.
void findPulp(Work& work, const Mask& nearEnamel, bool isLevelOpen, const core::Progress& progress) {
    const Shape& shape = work.shape;
    Thresholds& t = work.levels;
    const double voxelMm3 = work.grid.voxelMm3();
    const double least = std::max(8.0, kMinPulpMm3 / voxelMm3);
    const auto darker = [&](float level) {
        Mask dark(shape.count());
        for (std::size_t n = 0; n < dark.size(); ++n)
            dark[n] = work.outer[n] > 2.2f && work.damped[n] < level;
        const Parts parts = connectedParts(shape, dark);
        for (std::size_t n = 0; n < dark.size(); ++n)
            dark[n] = dark[n] && static_cast<double>(parts.counts[parts.of[n]]) >= least;
        return dark;
    };
    if (isLevelOpen) t.pulp = levelOf(work, darker(t.toothFrom), 3, t.pulp);
    // Well below the middle between the two it is pulp, and what blurs around that. Near the middle it is a canal if it
    // is thin, and a lesion if it is several voxels thick.
    Mask lesion;
    const auto find = [&] {
        const float contrast = t.dentine - t.pulp;
        Mask seed = darker(t.pulp + 0.32f * contrast);
        seed = dilated(shape, dilated(shape, seed));
        lesion.assign(shape.count(), 0);
        for (std::size_t n = 0; n < lesion.size(); ++n)
            lesion[n] = work.outer[n] > 1.5f && !seed[n] && work.damped[n] < t.dentine - 0.2f * contrast;
        lesion = eroded(shape, lesion);
        if (work.spacingMm() < 0.13) lesion = eroded(shape, lesion);
        const Parts parts = connectedParts(shape, lesion);
        std::vector<std::uint8_t> isNear(parts.counts.size(), 0);
        for (std::size_t n = 0; n < lesion.size(); ++n)
            if (nearEnamel[n]) isNear[parts.of[n]] = 1;
        for (std::size_t n = 0; n < lesion.size(); ++n)
            lesion[n] = lesion[n] && isNear[parts.of[n]];
        for (int round = 0; round < 4; ++round)
            lesion = dilated(shape, lesion);
        Mask dark = darker(t.pulp + 0.5f * contrast);
        for (std::size_t n = 0; n < dark.size(); ++n)
            dark[n] = dark[n] && (seed[n] || !lesion[n]);
        return dark;
    };
    // What is dark tells how dark the pulp is, and that tells again what is.
    Mask dark = find();
    if (isLevelOpen) {
        const float level = levelOf(work, dark, 3, t.pulp);
        if (level < t.dentine - 0.15f * (t.dentine - t.outside)) t.pulp = level;
        dark = find();
    }
    core::report(progress, 0.4);
    const float contrast = t.dentine - t.pulp;
    const float half = 0.5f * (t.dentine + t.pulp);
    if (std::find(dark.begin(), dark.end(), 1) == dark.end()) {
        work.notes.emplace_back("no pulp was found");
        return;
    }
    // Canals about as thin as a voxel: darker than dentine and than their surroundings once noise is averaged out.
    constexpr double kAverage = 0.8;
    Field even, wide;
    blur(shape, work.raw, even, work.scratch, kAverage);
    wide.resize(shape.count());
    for (std::size_t n = 0; n < wide.size(); ++n)
        wide[n] = std::clamp(even[n], t.pulp, t.dentine);
    blur(shape, wide, wide, work.scratch, 2.6);
    Mask thin(shape.count());
    const float faint = std::max(0.11f * contrast, 5 * 0.21f * work.noise);
    for (std::size_t n = 0; n < thin.size(); ++n) {
        // Beside enamel a small lesion is likelier than a canal: what counts there must be plainer.
        const float strict = nearEnamel[n] ? 1.7f : 1.0f;
        thin[n] = dark[n] || (!lesion[n] && work.outer[n] > 2.5f && even[n] < t.dentine - strict * faint &&
                              even[n] < wide[n] - strict * strict * 0.05f * contrast);
    }
    const Parts parts = connectedParts(shape, thin);
    std::vector<std::uint8_t> has(parts.counts.size(), 0);
    for (std::size_t n = 0; n < dark.size(); ++n)
        if (dark[n]) has[parts.of[n]] = 1;
    work.pulp.assign(shape.count(), -kBand);
    const Mask near = dilated(shape, dilated(shape, dark));
    for (std::size_t n = 0; n < work.pulp.size(); ++n) {
        const float f = (half - work.damped[n]) / contrast * kSlope * static_cast<float>(work.sigma);
        if (dark[n] || (work.held[n] == kHeldCavity && work.outer[n] > 0))
            work.pulp[n] = std::max(f, 0.05f);
        else if (thin[n] && has[parts.of[n]])
            work.pulp[n] = std::max(f, 0.1f);
        else if (near[n])
            work.pulp[n] = std::min(f, -0.05f);
    }
    redistance(shape, work.pulp, kBand);
    core::report(progress, 1);
}

/// Where a lesion went in through the enamel: a dark channel from it to the tooth's surface, too thin for dentine.
void addChannels(const Work& work, Mask& lesion) {
    const Shape& shape = work.shape;
    const double r = kChannelMm / work.spacingMm();
    Mask bright(shape.count());
    for (std::size_t n = 0; n < bright.size(); ++n)
        bright[n] = work.outer[n] <= 0 || work.damped[n] > work.levels.enamelFrom;
    const Field depth = squaredDistance(shape, bright);
    Mask thick(shape.count());
    for (std::size_t n = 0; n < thick.size(); ++n)
        thick[n] = depth[n] > r * r;
    const Field toThick = squaredDistance(shape, thick);
    Mask thin(shape.count());
    for (std::size_t n = 0; n < thin.size(); ++n)
        thin[n] = !bright[n] && work.outer[n] > 1.8f && toThick[n] > r * r;
    const Mask near = dilated(shape, dilated(shape, lesion));
    const Parts parts = connectedParts(shape, thin);
    std::vector<std::uint8_t> touches(parts.counts.size(), 0), surfaces(parts.counts.size(), 0);
    for (std::size_t n = 0; n < thin.size(); ++n) {
        if (near[n]) touches[parts.of[n]] = 1;
        if (work.outer[n] < 2.8f) surfaces[parts.of[n]] = 1;
    }
    for (std::size_t n = 0; n < thin.size(); ++n)
        if (const std::uint32_t p = parts.of[n]; p != 0 && touches[p] && surfaces[p]) lesion[n] = 1;
}

/// Demineralised tissue: darker than sound dentine, brighter than pulp, and no mere mixture at one of their surfaces.
void findCaries(Work& work, const Mask& nearEnamel, const core::Progress& progress) {
    const Shape& shape = work.shape;
    const Thresholds& t = work.levels;
    const float contrast = t.dentine - std::max(t.pulp, t.outside);
    const float from = t.dentine - std::max(0.22f * contrast, 2.0f * work.noise);
    Mask candidate(shape.count());
    for (std::size_t n = 0; n < candidate.size(); ++n)
        candidate[n] = work.outer[n] > 1.8f && work.damped[n] < from && (work.pulp.empty() || work.pulp[n] < -2.2f);
    core::report(progress, 0.3);
    const Parts parts = connectedParts(shape, candidate);
    std::vector<std::uint8_t> isNear(parts.counts.size(), 0), hasCore(parts.counts.size(), 0);
    const Mask core = eroded(shape, candidate);
    for (std::size_t n = 0; n < candidate.size(); ++n) {
        if (!candidate[n]) continue;
        if (nearEnamel[n]) isNear[parts.of[n]] = 1;
        if (core[n]) hasCore[parts.of[n]] = 1;
    }
    Mask lesion(shape.count(), 0);
    bool any = false;
    for (std::size_t n = 0; n < candidate.size(); ++n) {
        const std::uint32_t p = parts.of[n];
        lesion[n] = p != 0 && isNear[p] && hasCore[p] &&
                    static_cast<double>(parts.counts[p]) * work.grid.voxelMm3() >= kMinCariesMm3;
        any = any || lesion[n];
    }
    if (!any) return;
    const float level = levelOf(work, lesion, 3, from);
    addChannels(work, lesion);
    work.cariesLevel = level;
    core::report(progress, 0.6);
    // Its surface: halfway to dentine, or to enamel where that is what lies beside it.
    const Mask near = dilated(shape, dilated(shape, dilated(shape, lesion)));
    Field& bright = work.scratch;
    bright.assign(shape.count(), -kBand);
    for (std::size_t n = 0; n < bright.size(); ++n)
        if (near[n]) {
            const auto [i, j, k] = shape.at(n);
            const Vec3 g = gradient(shape, work.damped, i, j, k);
            const double steep = g.norm();
            float beside = t.dentine;
            if (steep > 0.05 * contrast)
                for (const double d : {1.0, 2.0})
                    beside = std::max(beside, sample(shape, work.damped, Vec3(i, j, k) + d * g / steep));
            beside = std::min(beside, t.enamel);
            const float f = (0.5f * (beside + work.cariesLevel) - work.damped[n]) / (beside - work.cariesLevel) *
                            kSlope * static_cast<float>(work.sigma);
            const bool isOpen = work.outer[n] > 1.5f && (work.pulp.empty() || work.pulp[n] < -1.5f);
            bright[n] = isOpen ? f : -0.3f;
        }
    // Where it reaches the tooth's surface the air blurs in: as it is further in.
    work.caries.assign(shape.count(), -kBand);
    forRows(shape, [&](int j, int k) {
        for (int i = 0; i < shape.size[0]; ++i) {
            const std::size_t at = shape.index(i, j, k);
            if (!near[at]) continue;
            if (work.outer[at] > 1.5f) {
                work.caries[at] = std::clamp(bright[at], -kBand, kBand);
                continue;
            }
            Vec3 n = gradient(shape, work.outer, i, j, k);
            if (n.norm() < 0.1) continue;
            n.normalize();
            work.caries[at] = sample(shape, bright, Vec3(i, j, k) + (2.6 - work.outer[at]) * n);
        }
    });
    redistance(shape, work.caries, kBand);
    core::report(progress, 1);
}

void findRestoration(Work& work) {
    const Thresholds& t = work.levels;
    if (!std::isfinite(t.restorationFrom)) return;
    const Shape& shape = work.shape;
    Mask bright(shape.count());
    for (std::size_t n = 0; n < bright.size(); ++n)
        bright[n] = work.outer[n] > 0 && work.damped[n] > t.restorationFrom;
    const Parts parts = connectedParts(shape, bright);
    bool any = false;
    for (std::size_t n = 0; n < bright.size(); ++n) {
        bright[n] = bright[n] && static_cast<double>(parts.counts[parts.of[n]]) * work.grid.voxelMm3() > 0.2;
        any = any || bright[n];
    }
    if (!any) return;
    work.restorationLevel = levelOf(work, bright, 2, t.restorationFrom * 1.2f);
    const Mask near = dilated(shape, dilated(shape, bright));
    work.restoration.assign(shape.count(), -kBand);
    const float step = std::max(work.restorationLevel - t.enamel, 1e-3f);
    for (std::size_t n = 0; n < near.size(); ++n)
        if (near[n])
            work.restoration[n] = (work.damped[n] - 0.5f * (work.restorationLevel + t.enamel)) / step * kSlope *
                                  static_cast<float>(work.sigma);
    redistance(shape, work.restoration, kBand);
    work.notes.emplace_back("a filling or crown was found; metal darkens and brightens what lies around it");
}

/// Dentine with all that lies below the enamel. Near the outside the air blurs in and enamel looks like dentine: there
/// a look further in decides, and outside the tooth what is said goes on, so that one surface ends in the other.
void findDentine(Work& work, const core::Progress& progress) {
    const Shape& shape = work.shape;
    const Thresholds& t = work.levels;
    work.dentine.assign(shape.count(), kBand);
    if (!std::isfinite(t.enamelFrom)) return;
    const float step = t.enamel - t.dentine;
    Field& plain = work.scratch;
    plain.resize(shape.count());
    core::parallelFor(plain.size(), 1 << 16, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n)
            plain[n] = std::clamp((t.enamelFrom - work.damped[n]) / step * kSlope * static_cast<float>(work.sigma),
                                  -kBand, kBand);
    });
    // Lesions and fillings hide what was there: what lies beside them goes on.
    const auto hide = [&](const Field& what) {
        if (what.empty()) return;
        Mask unknown(shape.count());
        for (std::size_t n = 0; n < unknown.size(); ++n)
            unknown[n] = what[n] > -2.0f || work.outer[n] < 1.8f;
        spreadInto(shape, plain, unknown);
    };
    hide(work.caries);
    hide(work.restoration);
    core::report(progress, 0.4);
    forRows(shape, [&](int j, int k) {
        for (int i = 0; i < shape.size[0]; ++i) {
            const std::size_t at = shape.index(i, j, k);
            const float depth = work.outer[at];
            if (depth <= -kBand) continue;
            if (depth > 2.2f) {
                work.dentine[at] = plain[at];
                continue;
            }
            Vec3 n = gradient(shape, work.outer, i, j, k);
            if (n.norm() < 0.1) continue;
            n.normalize();
            const Vec3 here(i, j, k);
            float least = depth > 0 ? plain[at] : kBand, brightest = t.dentine;
            for (const double d : {1.0, 1.6, 2.2})
                if (d > depth) least = std::min(least, sample(shape, plain, here + (d - depth) * n));
            // An edge thinner than the blur never gets as bright as enamel: as thick as its brightness says.
            for (const double d : {0.5, 1.0, 1.5})
                brightest = std::max(brightest, sample(shape, work.damped, here + (d - depth) * n));
            const float share = (brightest - t.dentine) / step;
            if (share > kFaintEnamel)
                least = std::min(least, depth - std::max(0.8f, kSlope * static_cast<float>(work.sigma) * share));
            work.dentine[at] = least;
        }
    });
    // Further out as at the band's edge, lest a surface stand there.
    Mask known(shape.count());
    for (std::size_t n = 0; n < known.size(); ++n)
        known[n] = work.outer[n] > -kBand;
    Mask beyond = known;
    for (int round = 0; round < 3; ++round)
        beyond = dilated(shape, beyond);
    for (std::size_t n = 0; n < beyond.size(); ++n)
        beyond[n] = known[n] ? 0 : (beyond[n] ? 1 : 2);
    spreadInto(shape, work.dentine, beyond);
    core::report(progress, 0.6);
    // Specks of noise in either.
    Mask enamel(shape.count());
    for (std::size_t n = 0; n < enamel.size(); ++n)
        enamel[n] = work.dentine[n] <= 0 && work.outer[n] > 0;
    const Parts caps = connectedParts(shape, enamel);
    bool any = false;
    for (std::size_t n = 0; n < enamel.size(); ++n) {
        const bool isCap =
            enamel[n] && static_cast<double>(caps.counts[caps.of[n]]) * work.grid.voxelMm3() >= kMinEnamelMm3;
        if (enamel[n] && !isCap) work.dentine[n] = 0.5f;
        any = any || isCap;
        enamel[n] = !isCap && work.outer[n] > 0;
    }
    const Parts cores = connectedParts(shape, enamel);
    const std::uint32_t main = cores.largest();
    for (std::size_t n = 0; n < enamel.size(); ++n)
        if (enamel[n] && cores.of[n] != main) work.dentine[n] = -0.5f;
    if (!any) {
        work.dentine.assign(shape.count(), kBand);
        work.notes.emplace_back("no enamel was found");
        return;
    }
    redistance(shape, work.dentine, kBand);
    core::report(progress, 1);
}
}  // namespace

void findTissues(Work& work, const Settings& settings, const core::Progress& progress) {
    // Peaks of the whole scan are near; what lies well inside this tooth is right.
    Thresholds& t = work.levels;
    work.areLevelsOpen = !settings.thresholds;
    if (work.areLevelsOpen) {
        Mask enamel(work.shape.count()), dentine(work.shape.count());
        for (std::size_t n = 0; n < enamel.size(); ++n) {
            const bool isDeep = work.outer[n] > 2.0f;
            enamel[n] = isDeep && work.damped[n] > t.enamelFrom && work.damped[n] < t.restorationFrom;
            dentine[n] = isDeep && work.damped[n] > 0.5f * (t.dentine + t.toothFrom) && work.damped[n] < t.enamelFrom;
        }
        if (std::isfinite(t.enamelFrom)) {
            t.dentine = levelOf(work, dentine, 3, t.dentine);
            t.enamel = levelOf(work, enamel, 2, t.enamel);
            t.enamelFrom = 0.5f * (t.dentine + t.enamel);
        } else {
            t.dentine = t.enamel = levelOf(work, dentine, 3, t.dentine);
        }
    }
    core::report(progress, 0.1);
    const Mask near = nearEnamel(work);
    findPulp(work, near, !settings.thresholds, core::part(progress, 0.1, 0.4));
    if (settings.findCaries) findCaries(work, near, core::part(progress, 0.4, 0.6));
    findRestoration(work);
    findDentine(work, core::part(progress, 0.6, 1));
}

}  // namespace handpiece::segmentation
