// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/phantom/artefacts.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/split_mix.h"
#include "handpiece/scan/phantom/phantom.h"

namespace handpiece::phantom {
namespace {

/// In (0, 1).
double uniform(std::uint32_t bits) {
    return (bits + 0.5) * 0x1p-32;
}

/// Normal numbers of a slice: pairs by Box and Muller from one counter a pair.
void normalSlice(std::uint64_t seed, std::size_t slice, std::span<float> out) {
    const std::uint64_t first = core::splitMix(core::splitMix(seed) ^ (slice + 1));
    for (std::size_t n = 0; n < out.size(); n += 2) {
        const std::uint64_t bits = core::splitMix(first + n);
        const double radius = std::sqrt(-2.0 * core::log(uniform(static_cast<std::uint32_t>(bits >> 32))));
        const double angle = 2.0 * std::numbers::pi * uniform(static_cast<std::uint32_t>(bits));
        out[n] = static_cast<float>(radius * core::cos(angle));
        if (n + 1 < out.size()) out[n + 1] = static_cast<float>(radius * core::sin(angle));
    }
}

/// One pass along `count` values that are `stride` apart, of `lanes` neighbours at once.
void blurLines(float* values, int count, std::size_t stride, std::size_t lanes, std::span<const double> weights,
               std::vector<float>& line) {
    const int reach = static_cast<int>(weights.size() / 2);
    line.resize(static_cast<std::size_t>(count) * lanes);
    for (int n = 0; n < count; ++n)
        std::copy_n(values + static_cast<std::size_t>(n) * stride, lanes, &line[static_cast<std::size_t>(n) * lanes]);
    for (int n = 0; n < count; ++n) {
        float* to = values + static_cast<std::size_t>(n) * stride;
        std::fill_n(to, lanes, 0.0f);
        for (int w = -reach; w <= reach; ++w) {
            const float weight = static_cast<float>(weights[static_cast<std::size_t>(w + reach)]);
            const float* from = &line[static_cast<std::size_t>(std::clamp(n + w, 0, count - 1)) * lanes];
            for (std::size_t lane = 0; lane < lanes; ++lane)
                to[lane] += weight * from[lane];
        }
    }
}

/// A pattern about an axis: even, between -1 and 1, both reached; thin streaks and two broad dark ones.
std::vector<float> streakPattern(std::uint64_t seed, std::size_t directions) {
    std::vector<float> pattern(directions);
    double least = 0.0, most = 0.0;
    for (std::size_t d = 0; d < directions; ++d) {
        const double angle = 2.0 * std::numbers::pi * static_cast<double>(d) / static_cast<double>(directions);
        double sum = 0.0;
        for (const int waves : {2, 5, 9, 14, 23}) {
            const double phase =
                2.0 * std::numbers::pi *
                uniform(static_cast<std::uint32_t>(core::splitMix(seed + static_cast<unsigned>(waves))));
            sum += core::cos(waves * angle + phase);
        }
        pattern[d] = static_cast<float>(sum);
        least = std::min(least, sum);
        most = std::max(most, sum);
    }
    for (float& value : pattern)
        value = static_cast<float>(value > 0.0f ? value / most : -value / least);
    return pattern;
}

/// What a detector's faulty elements leave: one offset a ring, most of them none.
float ringOf(std::uint64_t seed, int ring) {
    const std::uint64_t bits = core::splitMix(core::splitMix(seed ^ 0x52494E47ull) + static_cast<std::uint64_t>(ring));
    if (bits >> 62 != 0) return 0.0f;
    return (bits & 1u) != 0 ? 1.0f : -1.0f;
}

class Adder {
  public:
    Adder(volume::Volume& volume, const Artefacts& artefacts)
        : volume_(volume),
          artefacts_(artefacts),
          weights_(normalWeights(kNoiseSpreadVoxels)),
          columns_(volume.grid.size[0]),
          rows_(volume.grid.size[1]),
          slices_(volume.grid.size[2]),
          area_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
        double squares = 0.0;
        for (const double w : weights_)
            squares += w * w;
        noiseScale_ = static_cast<float>(artefacts.noise / core::pow(squares, 1.5));
        const double middle[2] = {0.5 * (columns_ - 1), 0.5 * (rows_ - 1)};
        const int rings = static_cast<int>(core::hypot(middle[0], middle[1])) + 3;
        for (int r = 0; r < rings; ++r)
            rings_.push_back(static_cast<float>(artefacts.ring) * ringOf(artefacts.seed, r));
        if (artefacts.streaks) pattern_ = streakPattern(artefacts.seed ^ 0x4D455441ull, 4096);
    }

    void slices(int first, int last, const std::function<void()>& sliceDone) {
        const int reach = artefacts_.noise > 0.0 ? static_cast<int>(weights_.size() / 2) : 0;
        std::vector<std::vector<float>> noise(static_cast<std::size_t>(2 * reach + 1));
        // Blurred along rows and columns, one a slice; the slices beyond the border are drawn too, so that the
        // deviation is the same everywhere.
        int drawn = first - reach;
        for (int k = first; k < last; ++k) {
            if (artefacts_.noise > 0.0)
                for (; drawn <= k + reach; ++drawn)
                    draw(drawn, noise[static_cast<std::size_t>((drawn + reach) % (2 * reach + 1))]);
            finish(k, reach, noise);
            sliceDone();
        }
    }

  private:
    void draw(int k, std::vector<float>& out) const {
        const int reach = static_cast<int>(weights_.size() / 2);
        const int wide = columns_ + 2 * reach, high = rows_ + 2 * reach;
        std::vector<float> white(static_cast<std::size_t>(wide) * static_cast<std::size_t>(high));
        normalSlice(artefacts_.seed, static_cast<std::size_t>(k + reach), white);
        blurSlice(white, wide, high, weights_);
        out.resize(area_);
        for (int j = 0; j < rows_; ++j)
            std::copy_n(&white[static_cast<std::size_t>(j + reach) * static_cast<std::size_t>(wide) +
                               static_cast<std::size_t>(reach)],
                        columns_, &out[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_)]);
    }

    void finish(int k, int reach, const std::vector<std::vector<float>>& noise) {
        float* values = &volume_.values[static_cast<std::size_t>(k) * area_];
        if (artefacts_.noise > 0.0) {
            for (int w = -reach; w <= reach; ++w) {
                const std::vector<float>& from = noise[static_cast<std::size_t>((k + w + reach) % (2 * reach + 1))];
                const float weight = static_cast<float>(weights_[static_cast<std::size_t>(w + reach)]) * noiseScale_;
                for (std::size_t n = 0; n < area_; ++n)
                    values[n] += weight * from[n];
            }
        }
        if (artefacts_.ring != 0.0) addRings(values);
        if (artefacts_.streaks) addStreaks(k, values);
        const auto least = static_cast<float>(artefacts_.least), most = static_cast<float>(artefacts_.most);
        for (std::size_t n = 0; n < area_; ++n)
            values[n] = std::nearbyint(std::clamp(values[n], least, most));
    }

    void addRings(float* values) const {
        const double middle[2] = {0.5 * (columns_ - 1), 0.5 * (rows_ - 1)};
        for (int j = 0; j < rows_; ++j)
            for (int i = 0; i < columns_; ++i, ++values) {
                const double x = i - middle[0], y = j - middle[1], r = std::sqrt(x * x + y * y);
                const auto ring = static_cast<std::size_t>(r);
                const float share = static_cast<float>(r - static_cast<double>(ring));
                *values += (1.0f - share) * rings_[ring] + share * rings_[ring + 1];
            }
    }

    void addStreaks(int k, float* values) const {
        const Streaks& s = *artefacts_.streaks;
        // Fades over half a filling's height beyond it.
        const double beyond = std::max(0.0, std::abs(k - s.centreVoxels.z()) - s.halfHeightVoxels) / s.halfHeightVoxels;
        const double amplitude = s.amplitude * std::max(0.0, 1.0 - 2.0 * beyond);
        if (amplitude == 0.0) return;
        const auto directions = static_cast<double>(pattern_.size());
        for (int j = 0; j < rows_; ++j)
            for (int i = 0; i < columns_; ++i, ++values) {
                const double x = i - s.centreVoxels.x(), y = j - s.centreVoxels.y();
                const double r = std::sqrt(x * x + y * y);
                const double turn = (core::atan2(y, x) / (2.0 * std::numbers::pi) + 0.5) * directions;
                const std::size_t at = static_cast<std::size_t>(turn) % pattern_.size();
                // The filling itself hides them.
                const double fall = r < s.radiusVoxels ? r / s.radiusVoxels : s.radiusVoxels / r;
                *values += static_cast<float>(amplitude * fall * static_cast<double>(pattern_[at]));
            }
    }

    volume::Volume& volume_;
    const Artefacts& artefacts_;
    std::vector<double> weights_;
    int columns_, rows_, slices_;
    std::size_t area_;
    float noiseScale_ = 0.0f;
    std::vector<float> rings_, pattern_;
};

}  // namespace

std::vector<double> normalWeights(double sigmaVoxels) {
    if (!(sigmaVoxels > 0.0)) return {1.0};
    const int reach = std::max(1, static_cast<int>(std::ceil(3.5 * sigmaVoxels)));
    std::vector<double> weights;
    double sum = 0.0;
    for (int w = -reach; w <= reach; ++w) {
        weights.push_back(core::exp(-0.5 * w * w / (sigmaVoxels * sigmaVoxels)));
        sum += weights.back();
    }
    for (double& w : weights)
        w /= sum;
    return weights;
}

void blurSlice(std::span<float> slice, int columns, int rows, std::span<const double> weights) {
    if (weights.size() < 2) return;
    const auto wide = static_cast<std::size_t>(columns);
    std::vector<float> line;
    blurLines(slice.data(), rows, wide, wide, weights, line);
    // Along a row: padded, so that the inner loop runs over neighbours.
    const std::size_t reach = weights.size() / 2;
    line.resize(wide + 2 * reach);
    for (int j = 0; j < rows; ++j) {
        float* row = slice.data() + static_cast<std::size_t>(j) * wide;
        std::fill_n(line.begin(), reach, row[0]);
        std::copy_n(row, wide, &line[reach]);
        std::fill_n(&line[reach + wide], reach, row[wide - 1]);
        std::fill_n(row, wide, 0.0f);
        for (std::size_t w = 0; w < weights.size(); ++w) {
            const float weight = static_cast<float>(weights[w]);
            for (std::size_t i = 0; i < wide; ++i)
                row[i] += weight * line[i + w];
        }
    }
}

void blurAcross(volume::Volume& volume, std::span<const double> weights, const core::Progress& progress) {
    if (weights.size() < 2) return;
    const auto wide = static_cast<std::size_t>(volume.grid.size[0]);
    const auto rows = static_cast<std::size_t>(volume.grid.size[1]);
    std::atomic<std::size_t> done{0};
    core::parallelFor(rows, 1, [&](std::size_t begin, std::size_t end) {
        std::vector<float> line;
        for (std::size_t j = begin; j < end; ++j) {
            blurLines(&volume.values[j * wide], volume.grid.size[2], wide * rows, wide, weights, line);
            core::report(progress, static_cast<double>(++done) / static_cast<double>(rows));
        }
    });
}

void addArtefacts(volume::Volume& volume, const Artefacts& artefacts, const core::Progress& progress) {
    Adder adder(volume, artefacts);
    const auto slices = static_cast<std::size_t>(volume.grid.size[2]);
    std::atomic<std::size_t> done{0};
    constexpr std::size_t kSlicesAtOnce = 16;
    core::parallelFor((slices + kSlicesAtOnce - 1) / kSlicesAtOnce, 1, [&](std::size_t begin, std::size_t end) {
        adder.slices(static_cast<int>(begin * kSlicesAtOnce), static_cast<int>(std::min(slices, end * kSlicesAtOnce)),
                     [&] { core::report(progress, static_cast<double>(++done) / static_cast<double>(slices)); });
    });
}

}  // namespace handpiece::phantom
