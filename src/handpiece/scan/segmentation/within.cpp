// SPDX-License-Identifier: Apache-2.0
// The tissues of a tooth whose outline is known from labels.
#include <algorithm>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/scan/segmentation/label_key.h"
#include "handpiece/scan/segmentation/work.h"

namespace handpiece::segmentation {
namespace {

using core::Vec3;
using What = LabelMeaning::What;

constexpr double kFinestMm = 0.03;
constexpr int kBesideVoxels = 2;  ///< so far from another tooth the label alone says where this one ends

}  // namespace

Region segmentWithin(const volume::Volume& scan, const Thresholds& levels, const volume::Labels& labels,
                     const LabelKey& key, const ToothAlone& own, const Settings& settings,
                     const core::Progress& progress) {
    Work work;
    work.levels = settings.thresholds.value_or(levels);
    // The box of its label, in the scan's voxels.
    const volume::Grid& inner = own.labels.grid;
    Vec3 low = Vec3::Constant(1e30), high = -low;
    for (int corner = 0; corner < 8; ++corner) {
        Vec3 at;
        for (int a = 0; a < 3; ++a)
            at[a] = (corner >> a & 1) != 0 ? inner.size[static_cast<std::size_t>(a)] - 1 : 0;
        at = scan.grid.toVoxels(inner.toMm(at));
        low = low.cwiseMin(at);
        high = high.cwiseMax(at);
    }
    const Vec3 last(scan.grid.size[0] - 1, scan.grid.size[1] - 1, scan.grid.size[2] - 1);
    if ((high.array() < 0.0).any() || (low.array() > last.array()).any())
        throw core::Error("the labels lie outside the scan that they are said to be of", "scan",
                          "give the scan that was segmented, in the same frame");
    const double h = settings.spacingMm > 0 ? settings.spacingMm : std::max(kFinestMm, scan.grid.spacingMm.minCoeff());
    cutOut(work, scan, low, high, h, core::part(progress, 0.0, 0.1));
    damp(work, core::part(progress, 0.1, 0.2));

    const Shape& shape = work.shape;
    Mask solid(shape.count()), other(shape.count());
    forRows(shape, [&](int j, int k) {
        for (int i = 0; i < shape.size[0]; ++i) {
            const Vec3 mm = work.grid.toMm(Vec3(i, j, k));
            const std::size_t n = shape.index(i, j, k);
            if (const auto at = inner.indexAt(mm)) solid[n] = own.labels.values[*at] != 0;
            if (const auto at = labels.grid.indexAt(mm)) {
                const LabelMeaning& meaning = key.of[labels.values[*at]];
                other[n] = meaning.what == What::prosthesis ||
                           ((meaning.what == What::tooth || meaning.what == What::pulp) && meaning.number != own.fdi);
            }
        }
    });
    const Parts parts = connectedParts(shape, solid);
    const std::uint32_t largest = parts.largest();
    if (largest == 0)
        throw core::Error("the tooth's label is lost in voxels of this size", "scan", "give a smaller voxel");
    for (std::size_t n = 0; n < solid.size(); ++n)
        solid[n] = parts.of[n] == largest;
    const Mask cavity = closedCavities(shape, solid, work.spacingMm());
    for (int round = 0; round < kBesideVoxels; ++round)
        other = dilated(shape, other);
    work.held.assign(shape.count(), 0);
    Field share(shape.count());
    for (std::size_t n = 0; n < share.size(); ++n) {
        if (other[n]) work.held[n] = kHeldCut;
        if (cavity[n]) work.held[n] = kHeldCavity;
        share[n] = solid[n] || cavity[n] ? 1.0f : 0.0f;
    }
    work.outer = smoothed(shape, std::move(share));
    // What roots stand in may be brighter than air.
    work.groundLevel = 2 * work.levels.toothFrom - work.levels.dentine;
    findTissues(work, settings, core::part(progress, 0.3, 0.6));
    refine(work, core::part(progress, 0.6, 0.95));
    return toRegion(std::move(work), settings, core::part(progress, 0.95, 1.0));
}

}  // namespace handpiece::segmentation
