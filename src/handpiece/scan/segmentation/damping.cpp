// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/base/core/parallel.h"
#include "handpiece/scan/segmentation/work.h"

namespace handpiece::segmentation {

using core::Vec3;

void cutOut(Work& work, const volume::Volume& volume, const Vec3& lowVoxel, const Vec3& highVoxel, double spacingMm,
            const core::Progress& progress) {
    const volume::Grid& scan = volume.grid;
    const double h = spacingMm;
    const double margin = std::max(6 * h, 0.4);
    Vec3 low = lowVoxel.cwiseProduct(scan.spacingMm) - Vec3::Constant(margin);
    const Vec3 high = highVoxel.cwiseProduct(scan.spacingMm) + Vec3::Constant(margin);
    const bool isSame = ((scan.spacingMm.array() / h - 1).abs() < 1e-6).all();
    // Voxel centres of the scan where they can be: nothing is blurred then.
    if (isSame) low = (low / h).array().floor() * h;
    for (std::size_t axis = 0; axis < 3; ++axis)
        work.grid.size[axis] =
            static_cast<int>(std::ceil((high[static_cast<int>(axis)] - low[static_cast<int>(axis)]) / h)) + 1;
    work.grid.spacingMm = Vec3::Constant(h);
    work.grid.axes = scan.axes;
    work.grid.originMm = scan.originMm + scan.axes * low;
    work.shape = {work.grid.size};
    work.raw.resize(work.shape.count());
    const Shape from{scan.size};
    const Vec3 first = low.cwiseQuotient(scan.spacingMm), step = Vec3::Constant(h).cwiseQuotient(scan.spacingMm);
    std::array<int, 3> sub{1, 1, 1};
    for (std::size_t axis = 0; axis < 3; ++axis)
        sub[axis] = std::max(1, static_cast<int>(std::lround(step[static_cast<int>(axis)])));
    forRows(work.shape, [&](int j, int k) {
        if (j == 0) core::report(progress, static_cast<double>(k) / work.shape.size[2]);
        float* out = &work.raw[work.shape.index(0, j, k)];
        for (int i = 0; i < work.shape.size[0]; ++i) {
            const Vec3 at = first + step.cwiseProduct(Vec3(i, j, k));
            bool isInside = true;
            for (int axis = 0; axis < 3; ++axis)
                isInside = isInside && at[axis] > -0.5 && at[axis] < scan.size[static_cast<std::size_t>(axis)] - 0.5;
            float value = work.levels.outside;
            if (isInside && isSame) {
                value =
                    volume.values[scan.index(static_cast<int>(std::lround(at[0])), static_cast<int>(std::lround(at[1])),
                                             static_cast<int>(std::lround(at[2])))];
            } else if (isInside) {
                float sum = 0;
                for (int c = 0; c < sub[2]; ++c)
                    for (int b = 0; b < sub[1]; ++b)
                        for (int a = 0; a < sub[0]; ++a)
                            sum +=
                                sample(from, volume.values,
                                       at + step.cwiseProduct(Vec3((a + 0.5) / sub[0] - 0.5, (b + 0.5) / sub[1] - 0.5,
                                                                   (c + 0.5) / sub[2] - 0.5)));
                value = sum / static_cast<float>(sub[0] * sub[1] * sub[2]);
            }
            out[i] = std::isfinite(value) ? value : work.levels.outside;
        }
    });
}

float noiseOf(const Shape& shape, const Field& values) {
    std::vector<float> differences;
    const std::size_t stride = 1 + values.size() / 300000;
    for (std::size_t n = 1; n + 1 < values.size(); n += stride) {
        const std::size_t i = n % shape.rowStride();
        if (i == 0 || i + 1 == shape.rowStride()) continue;
        const float d = std::abs(values[n] - 0.5f * (values[n - 1] + values[n + 1]));
        if (d > 0) differences.push_back(d);
    }
    if (differences.size() < 100) return 0;
    std::nth_element(differences.begin(), differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2),
                     differences.end());
    return differences[differences.size() / 2] / 0.6745f * 0.8165f;
}

void damp(Work& work, const core::Progress& progress) {
    work.noise = noiseOf(work.shape, work.raw);
    work.damped = work.raw;
    const float step = work.levels.dentine - work.levels.outside;
    if (work.noise > 0.004f * step)
        dampKeepingEdges(work.shape, work.damped, work.scratch, std::min(3 * work.noise, 0.35f * step), 4);
    core::report(progress, 1);
}

}  // namespace handpiece::segmentation
