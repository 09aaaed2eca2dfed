// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/volume/window.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"

namespace handpiece::volume {
namespace {

double bytesOf(const std::array<int, 3>& size) {
    return static_cast<double>(size[0]) * size[1] * size[2] * sizeof(float);
}

std::string tooLargeText(const std::array<int, 3>& size, std::uint64_t limitBytes) {
    constexpr double kGb = 1 << 30;
    return fmt::format("{} x {} x {} voxels need {:.1f} GB of memory, more than the {:.1f} GB that are allowed",
                       size[0], size[1], size[2], bytesOf(size) / kGb, static_cast<double>(limitBytes) / kGb);
}

/// `by` slices of the scan to one of what is kept of it.
void shrinkSlices(const float* slices, const Grid& whole, const Window& window, bool isLabels, float* to) {
    const std::size_t columns = static_cast<std::size_t>(whole.size[0]), each = whole.index(0, 0, 1);
    const auto by = static_cast<std::size_t>(window.by);
    const double share = 1.0 / static_cast<double>(by * by * by);
    std::vector<float> block(by * by * by);
    for (std::size_t j = 0; j < static_cast<std::size_t>(window.count[1] / window.by); ++j)
        for (std::size_t i = 0; i < static_cast<std::size_t>(window.count[0] / window.by); ++i) {
            const float* from = slices + (static_cast<std::size_t>(window.first[1]) + j * by) * columns +
                                static_cast<std::size_t>(window.first[0]) + i * by;
            std::size_t n = 0;
            double sum = 0.0;
            for (std::size_t c = 0; c < by; ++c)
                for (std::size_t b = 0; b < by; ++b)
                    for (std::size_t a = 0; a < by; ++a) {
                        block[n] = from[c * each + b * columns + a];
                        sum += static_cast<double>(block[n++]);
                    }
            if (!isLabels) {
                *to++ = static_cast<float>(sum * share);
                continue;
            }
            // The commonest; of two that are as common the smaller.
            std::sort(block.begin(), block.end());
            float best = block[0];
            std::size_t most = 0;
            for (std::size_t at = 0; at < block.size();) {
                std::size_t end = at + 1;
                while (end < block.size() && block[end] == block[at])
                    ++end;
                if (end - at > most) {
                    most = end - at;
                    best = block[at];
                }
                at = end;
            }
            *to++ = best;
        }
}

}  // namespace

std::uint64_t checkedBytes(const std::array<int, 3>& size, const std::string& where, std::uint64_t limitBytes) {
    if (bytesOf(size) > static_cast<double>(limitBytes))
        throw core::Error(tooLargeText(size, limitBytes), where,
                          "name a region of it, or crop or halve it in the program that made it; or the header is "
                          "damaged")
            .as("scan-too-large");
    return static_cast<std::uint64_t>(bytesOf(size));
}

int shrinkingOf(const std::array<int, 3>& size, std::uint64_t limitBytes) {
    constexpr int kLeastVoxels = 16;
    if (bytesOf(size) <= static_cast<double>(limitBytes)) return 1;
    for (const int by : {2, 4}) {
        const std::array<int, 3> small = shrunk(size, by);
        if (*std::min_element(small.begin(), small.end()) >= kLeastVoxels &&
            bytesOf(small) <= static_cast<double>(limitBytes))
            return by;
    }
    return 1;
}

std::string shrinkingText(const std::array<int, 3>& size, int by, std::uint64_t limitBytes) {
    return fmt::format("{}: it is read at {} of its size along each axis; a region of it (--region) keeps its fineness",
                       tooLargeText(size, limitBytes), by == 2 ? "half" : "a quarter");
}

Window windowOf(const Grid& grid, const core::Vec3& stepMm, const std::array<core::Vec3, 2>& regionMm,
                const std::string& where) {
    for (const core::Vec3& corner : regionMm)
        if (!corner.allFinite())
            throw core::Error("a region's corner is no number", "region", "give millimetres of the scan's frame");
    const core::Vec3 step = stepOf(grid, stepMm);
    core::Mat3 toMm;
    toMm << grid.axes.col(0) * grid.spacingMm.x(), grid.axes.col(1) * grid.spacingMm.y(), step;
    const core::Mat3 toVoxels = toMm.inverse();
    core::Vec3 low = core::Vec3::Constant(INFINITY), high = core::Vec3::Constant(-INFINITY);
    for (std::size_t corner = 0; corner < 8; ++corner) {
        const core::Vec3 mm(regionMm[corner & 1].x(), regionMm[corner >> 1 & 1].y(), regionMm[corner >> 2 & 1].z());
        const core::Vec3 at = toVoxels * (mm - grid.originMm);
        low = low.cwiseMin(at);
        high = high.cwiseMax(at);
    }
    Window window;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<Eigen::Index>(axis);
        const double from = std::max(0.0, std::floor(low[a])), to = std::min(grid.size[axis] - 1.0, std::ceil(high[a]));
        if (!(from <= to)) {
            const core::Vec3 last(grid.size[0] - 1.0, grid.size[1] - 1.0, grid.size[2] - 1.0);
            const core::Vec3 end = grid.originMm + toMm * last;
            throw core::Error(
                "nothing of the scan lies in the region", where,
                fmt::format("it reaches from {:.1f},{:.1f},{:.1f} to {:.1f},{:.1f},{:.1f} mm", grid.originMm.x(),
                            grid.originMm.y(), grid.originMm.z(), end.x(), end.y(), end.z()));
        }
        window.first[axis] = static_cast<int>(from);
        window.count[axis] = static_cast<int>(to) - window.first[axis] + 1;
    }
    return window;
}

void readWindow(const Candidate& candidate, const Window& window, bool isLabels, const TakeSlice& take,
                const core::Progress& progress) {
    const Grid& whole = candidate.grid;
    const int first = window.first[2], made = window.count[2] / window.by;
    const std::size_t each = whole.index(0, 0, 1), by = static_cast<std::size_t>(window.by);
    const std::size_t eachMade =
        static_cast<std::size_t>(window.count[0] / window.by) * static_cast<std::size_t>(window.count[1] / window.by);
    // Slices of the file in, one of what is kept out.
    struct Room {
        std::vector<float> read, kept;
    };
    const auto room = [&] { return Room{std::vector<float>(each * by), {}}; };
    const auto finish = [&](Room& r, int k) {
        if (window.isAll(whole)) return take(k, r.read.data());
        r.kept.resize(eachMade);
        shrinkSlices(r.read.data(), whole, window, isLabels, r.kept.data());
        take(k, r.kept.data());
    };
    if (candidate.load) {
        Room one = room();
        candidate.load(
            first, made * window.by,
            [&](int k) {
                const int n = k - first;
                if (n > 0 && n % window.by == 0) finish(one, n / window.by - 1);
                return one.read.data() + static_cast<std::size_t>(n % window.by) * each;
            },
            progress);
        finish(one, made - 1);
        return;
    }
    std::atomic<int> done{0};
    core::parallelFor(static_cast<std::size_t>(made), 1, [&](std::size_t begin, std::size_t end) {
        Room one = room();
        for (std::size_t k = begin; k < end; ++k) {
            for (int n = 0; n < window.by; ++n)
                candidate.slice(first + static_cast<int>(k) * window.by + n,
                                one.read.data() + static_cast<std::size_t>(n) * each);
            finish(one, static_cast<int>(k));
            core::report(progress, static_cast<double>(++done) / made);
        }
    });
}

}  // namespace handpiece::volume
