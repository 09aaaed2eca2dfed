// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/segmentation/voxels.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::segmentation {

void forRows(const Shape& shape, const std::function<void(int, int)>& body) {
    core::parallelFor(static_cast<std::size_t>(shape.size[2]), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k)
            for (int j = 0; j < shape.size[1]; ++j)
                body(j, static_cast<int>(k));
    });
}

int blurReach(double sigma) {
    return std::max(1, static_cast<int>(std::ceil(2.8 * sigma)));
}

void blur(const Shape& shape, const Field& in, Field& out, Field& scratch, double sigma) {
    const int radius = blurReach(sigma);
    std::vector<float> weights(static_cast<std::size_t>(2 * radius + 1));
    double sum = 0;
    for (int n = -radius; n <= radius; ++n)
        sum += core::exp(-0.5 * n * n / (sigma * sigma));
    for (int n = -radius; n <= radius; ++n)
        weights[static_cast<std::size_t>(n + radius)] =
            static_cast<float>(core::exp(-0.5 * n * n / (sigma * sigma)) / sum);
    scratch.resize(in.size());
    out.resize(in.size());
    const int nx = shape.size[0], ny = shape.size[1], nz = shape.size[2];
    const auto width = static_cast<std::size_t>(nx);
    core::parallelFor(static_cast<std::size_t>(nz), 1, [&](std::size_t from, std::size_t to) {
        std::vector<float> padded(width + 2 * static_cast<std::size_t>(radius)), slice(shape.sliceStride());
        for (std::size_t k = from; k < to; ++k) {
            for (int j = 0; j < ny; ++j) {
                const float* row = &in[shape.index(0, j, static_cast<int>(k))];
                std::copy(row, row + nx, padded.begin() + radius);
                std::fill(padded.begin(), padded.begin() + radius, row[0]);
                std::fill(padded.end() - radius, padded.end(), row[nx - 1]);
                float* to1 = &slice[static_cast<std::size_t>(j) * width];
                std::fill(to1, to1 + nx, 0.0f);
                for (int n = 0; n <= 2 * radius; ++n) {
                    const float w = weights[static_cast<std::size_t>(n)];
                    const float* shifted = padded.data() + n;
                    for (int i = 0; i < nx; ++i)
                        to1[i] += w * shifted[i];
                }
            }
            for (int j = 0; j < ny; ++j) {
                float* to2 = &scratch[shape.index(0, j, static_cast<int>(k))];
                std::fill(to2, to2 + nx, 0.0f);
                for (int n = -radius; n <= radius; ++n) {
                    const float w = weights[static_cast<std::size_t>(n + radius)];
                    const float* row = &slice[static_cast<std::size_t>(std::clamp(j + n, 0, ny - 1)) * width];
                    for (int i = 0; i < nx; ++i)
                        to2[i] += w * row[i];
                }
            }
        }
    });
    core::parallelFor(static_cast<std::size_t>(nz), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k)
            for (int j = 0; j < ny; ++j) {
                float* result = &out[shape.index(0, j, static_cast<int>(k))];
                std::fill(result, result + nx, 0.0f);
                for (int n = -radius; n <= radius; ++n) {
                    const float w = weights[static_cast<std::size_t>(n + radius)];
                    const float* row = &scratch[shape.index(0, j, std::clamp(static_cast<int>(k) + n, 0, nz - 1))];
                    for (int i = 0; i < nx; ++i)
                        result[i] += w * row[i];
                }
            }
    });
}

void dampKeepingEdges(const Shape& shape, Field& values, Field& scratch, float kappa, int rounds) {
    const float inverse = 1.0f / (kappa * kappa);
    const int nx = shape.size[0];
    scratch.resize(values.size());
    for (int round = 0; round < rounds; ++round) {
        forRows(shape, [&](int j, int k) {
            const auto row = [&](int jj, int kk) {
                return &values[shape.index(0, std::clamp(jj, 0, shape.size[1] - 1),
                                           std::clamp(kk, 0, shape.size[2] - 1))];
            };
            const float *own = row(j, k), *a = row(j - 1, k), *b = row(j + 1, k), *c = row(j, k - 1),
                        *d = row(j, k + 1);
            float* out = &scratch[shape.index(0, j, k)];
            const auto flow = [inverse](float delta) { return delta / (1.0f + delta * delta * inverse); };
            const auto at = [&](int i, float left, float right) {
                const float v = own[i];
                out[i] = v + (1.0f / 7.0f) * (flow(left - v) + flow(right - v) + flow(a[i] - v) + flow(b[i] - v) +
                                              flow(c[i] - v) + flow(d[i] - v));
            };
            at(0, own[0], own[std::min(1, nx - 1)]);
            for (int i = 1; i + 1 < nx; ++i)
                at(i, own[i - 1], own[i + 1]);
            if (nx > 1) at(nx - 1, own[nx - 2], own[nx - 1]);
        });
        values.swap(scratch);
    }
}

float sample(const Shape& shape, const Field& values, const core::Vec3& at) {
    std::array<int, 3> low{};
    std::array<float, 3> part{};
    for (int axis = 0; axis < 3; ++axis) {
        const int last = shape.size[static_cast<std::size_t>(axis)] - 1;
        const double x = std::clamp(at[axis], 0.0, static_cast<double>(last));
        low[static_cast<std::size_t>(axis)] = std::min(static_cast<int>(x), std::max(0, last - 1));
        part[static_cast<std::size_t>(axis)] = static_cast<float>(x - low[static_cast<std::size_t>(axis)]);
    }
    const std::size_t base = shape.index(low[0], low[1], low[2]);
    const std::size_t dx = shape.size[0] > 1 ? 1 : 0, dy = shape.size[1] > 1 ? shape.rowStride() : 0,
                      dz = shape.size[2] > 1 ? shape.sliceStride() : 0;
    const auto line = [&](std::size_t from) { return values[from] + part[0] * (values[from + dx] - values[from]); };
    const float y0 = line(base), y1 = line(base + dy), z0 = line(base + dz), z1 = line(base + dy + dz);
    const float near = y0 + part[1] * (y1 - y0), far = z0 + part[1] * (z1 - z0);
    return near + part[2] * (far - near);
}

core::Vec3 gradient(const Shape& shape, const Field& values, int i, int j, int k) {
    const std::array<int, 3> at{i, j, k};
    core::Vec3 result;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::array<int, 3> low = at, high = at;
        low[axis] = std::max(0, at[axis] - 1);
        high[axis] = std::min(shape.size[axis] - 1, at[axis] + 1);
        const int apart = std::max(1, high[axis] - low[axis]);
        result[static_cast<int>(axis)] =
            (values[shape.index(high[0], high[1], high[2])] - values[shape.index(low[0], low[1], low[2])]) / apart;
    }
    return result;
}

namespace {
/// Lower envelope of parabolas along one line.
void distanceLine(const std::vector<float>& f, std::vector<float>& d, std::vector<int>& v, std::vector<float>& z,
                  int n) {
    int k = 0;
    v[0] = 0;
    z[0] = -1e20f;
    z[1] = 1e20f;
    const auto meet = [&](int q, int p) {
        return ((f[static_cast<std::size_t>(q)] + static_cast<float>(q) * static_cast<float>(q)) -
                (f[static_cast<std::size_t>(p)] + static_cast<float>(p) * static_cast<float>(p))) /
               static_cast<float>(2 * q - 2 * p);
    };
    for (int q = 1; q < n; ++q) {
        float s = meet(q, v[static_cast<std::size_t>(k)]);
        while (k > 0 && s <= z[static_cast<std::size_t>(k)])
            s = meet(q, v[static_cast<std::size_t>(--k)]);
        ++k;
        v[static_cast<std::size_t>(k)] = q;
        z[static_cast<std::size_t>(k)] = s;
        z[static_cast<std::size_t>(k) + 1] = 1e20f;
    }
    k = 0;
    for (int q = 0; q < n; ++q) {
        while (z[static_cast<std::size_t>(k) + 1] < static_cast<float>(q))
            ++k;
        const int p = v[static_cast<std::size_t>(k)];
        d[static_cast<std::size_t>(q)] = static_cast<float>((q - p) * (q - p)) + f[static_cast<std::size_t>(p)];
    }
}
}  // namespace

Field squaredDistance(const Shape& shape, const Mask& mask) {
    constexpr float kFar = 1e12f;
    Field result(mask.size());
    forRows(shape, [&](int j, int k) {
        // Along i two passes do: what is set is binary.
        const std::size_t from = shape.index(0, j, k);
        const int n = shape.size[0];
        float last = 1e6f;
        for (int i = 0; i < n; ++i) {
            last = mask[from + static_cast<std::size_t>(i)] ? 0.0f : last + 1.0f;
            result[from + static_cast<std::size_t>(i)] = last;
        }
        last = 1e6f;
        for (int i = n - 1; i >= 0; --i) {
            float& r = result[from + static_cast<std::size_t>(i)];
            last = mask[from + static_cast<std::size_t>(i)] ? 0.0f : last + 1.0f;
            r = std::min(r, last);
            r = r >= 1e6f ? kFar : r * r;
        }
    });
    for (std::size_t axis = 1; axis < 3; ++axis) {
        const int n = shape.size[axis];
        const std::size_t stride = axis == 1 ? shape.rowStride() : shape.sliceStride();
        const int others = axis == 1 ? shape.size[2] : shape.size[1];
        core::parallelFor(static_cast<std::size_t>(others), 1, [&](std::size_t begin, std::size_t end) {
            const auto size = static_cast<std::size_t>(n);
            std::vector<float> f(size), d(size), z(size + 1);
            std::vector<int> v(size);
            for (std::size_t other = begin; other < end; ++other)
                for (int i = 0; i < shape.size[0]; ++i) {
                    const int o = static_cast<int>(other);
                    const std::size_t from = axis == 1 ? shape.index(i, 0, o) : shape.index(i, o, 0);
                    bool any = false;
                    for (std::size_t q = 0; q < size; ++q) {
                        f[q] = result[from + q * stride];
                        any = any || f[q] > 0;
                    }
                    if (!any) continue;
                    distanceLine(f, d, v, z, n);
                    for (std::size_t q = 0; q < size; ++q)
                        result[from + q * stride] = std::min(d[q], kFar);
                }
        });
    }
    return result;
}

std::uint32_t Parts::largest() const {
    std::uint32_t best = 0;
    std::size_t most = 0;
    for (std::uint32_t p = 1; p < counts.size(); ++p)
        if (counts[p] > most) most = counts[best = p];
    return best;
}

Parts connectedParts(const Shape& shape, const Mask& mask) {
    Parts parts;
    parts.of.resize(mask.size());
    // Runs along i are joined by union and find: a pass over the voxels in pieces of slices, then one over the slices
    // where pieces meet. Runs are numbered as they come and the lowest of a part names it, however it is cut.
    const auto slices = static_cast<std::size_t>(shape.size[2]);
    std::vector<std::uint32_t> firstRun(slices + 1, 1);
    core::parallelFor(slices, 4, [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) {
            std::uint32_t runs = 0;
            for (int j = 0; j < shape.size[1]; ++j) {
                const std::uint8_t* row = &mask[shape.index(0, j, static_cast<int>(k))];
                for (int i = 0; i < shape.size[0]; ++i)
                    runs += row[i] != 0 && (i == 0 || row[i - 1] == 0);
            }
            firstRun[k + 1] = runs;
        }
    });
    std::partial_sum(firstRun.begin(), firstRun.end(), firstRun.begin());
    std::vector<std::uint32_t> parent(firstRun[slices]);
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](std::uint32_t a) {
        while (parent[a] != a)
            a = parent[a] = parent[parent[a]];
        return a;
    };
    const auto join = [&](std::uint32_t run, std::uint32_t other) {
        const std::uint32_t a = root(run), b = root(other);
        if (a != b) parent[std::max(a, b)] = std::min(a, b);
    };
    std::vector<std::uint8_t> isFirst(slices, 0);
    core::parallelFor(slices, 16, [&](std::size_t from, std::size_t to) {
        isFirst[from] = 1;
        for (std::size_t k = from; k < to; ++k) {
            std::uint32_t last = firstRun[k] - 1;
            for (int j = 0; j < shape.size[1]; ++j) {
                std::size_t at = shape.index(0, j, static_cast<int>(k));
                bool isIn = false;
                for (int i = 0; i < shape.size[0]; ++i, ++at) {
                    if (!mask[at]) {
                        parts.of[at] = 0;
                        isIn = false;
                        continue;
                    }
                    if (!isIn) ++last;
                    isIn = true;
                    parts.of[at] = last;
                    if (j > 0 && mask[at - shape.rowStride()]) join(last, parts.of[at - shape.rowStride()]);
                    if (k > from && mask[at - shape.sliceStride()]) join(last, parts.of[at - shape.sliceStride()]);
                }
            }
        }
    });
    for (std::size_t k = 1; k < slices; ++k)
        if (isFirst[k] != 0)
            for (std::size_t at = k * shape.sliceStride(); at < (k + 1) * shape.sliceStride(); ++at)
                if (parts.of[at] != 0 && parts.of[at - shape.sliceStride()] != 0)
                    join(parts.of[at], parts.of[at - shape.sliceStride()]);
    parts.counts.push_back(0);
    std::vector<std::uint32_t> name(parent.size(), 0);
    for (std::uint32_t p = 1; p < parent.size(); ++p) {
        if (root(p) == p) {
            name[p] = static_cast<std::uint32_t>(parts.counts.size());
            parts.counts.push_back(0);
        }
        name[p] = name[root(p)];
    }
    std::mutex counting;
    core::parallelFor(parts.of.size(), 1 << 18, [&](std::size_t from, std::size_t to) {
        // Neighbours are mostly of one part.
        std::vector<std::pair<std::uint32_t, std::size_t>> stretches;
        for (std::size_t n = from; n < to; ++n) {
            std::uint32_t& p = parts.of[n];
            p = name[p];
            if (stretches.empty() || stretches.back().first != p) stretches.emplace_back(p, 0);
            ++stretches.back().second;
        }
        const std::lock_guard lock(counting);
        for (const auto& [part, count] : stretches)
            parts.counts[part] += count;
    });
    return parts;
}

namespace {
Mask combined(const Shape& shape, const Mask& mask, bool grow) {
    Mask result(mask.size());
    forRows(shape, [&](int j, int k) {
        const auto row = [&](int jj, int kk) {
            return &mask[shape.index(0, std::clamp(jj, 0, shape.size[1] - 1), std::clamp(kk, 0, shape.size[2] - 1))];
        };
        const std::uint8_t *own = row(j, k), *a = row(j - 1, k), *b = row(j + 1, k), *c = row(j, k - 1),
                           *d = row(j, k + 1);
        std::uint8_t* out = &result[shape.index(0, j, k)];
        for (int i = 0; i < shape.size[0]; ++i) {
            const std::uint8_t left = own[std::max(0, i - 1)], right = own[std::min(shape.size[0] - 1, i + 1)];
            out[i] = grow ? static_cast<std::uint8_t>(own[i] | left | right | a[i] | b[i] | c[i] | d[i])
                          : static_cast<std::uint8_t>(own[i] & left & right & a[i] & b[i] & c[i] & d[i]);
        }
    });
    return result;
}
}  // namespace

Mask eroded(const Shape& shape, const Mask& mask) {
    return combined(shape, mask, false);
}

Mask dilated(const Shape& shape, const Mask& mask) {
    return combined(shape, mask, true);
}

namespace {

constexpr float kUnknown = 1e9f;

/// Voxels of a layer by slice, as places in it: each slice is then one thread's own, at any number of threads.
using PlacesBySlice = std::vector<std::vector<std::uint32_t>>;

/// From how far, on the grid's lines through it, values change their sign beside voxel i of a row; 0: nowhere.
float distanceToZero(const Shape& shape, const Field& values, int i, int j, int k) {
    const std::size_t at = shape.index(i, j, k);
    const std::array<int, 3> c{i, j, k};
    const std::array<std::size_t, 3> strides{1, shape.rowStride(), shape.sliceStride()};
    const float v = values[at];
    const bool in = v > 0;
    float inverse = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        float nearest = 2;
        const auto cross = [&](float n) {
            if ((n > 0) == in) return;
            const float whole = std::abs(v) + std::abs(n);
            nearest = std::min(nearest, whole > 0 ? std::abs(v) / whole : 0.5f);
        };
        if (c[axis] > 0) cross(values[at - strides[axis]]);
        if (c[axis] + 1 < shape.size[axis]) cross(values[at + strides[axis]]);
        if (nearest < 2) {
            nearest = std::max(nearest, 1e-4f);
            inverse += 1.0f / (nearest * nearest);
        }
    }
    return inverse > 0 ? 1.0f / std::sqrt(inverse) : 0.0f;
}

/// The voxels of slice k beside the zero, and how far it is from them.
void findBeside(const Shape& shape, const Field& values, int k, std::vector<std::uint32_t>& places,
                std::vector<float>& distances) {
    const int nx = shape.size[0], ny = shape.size[1], nz = shape.size[2];
    std::vector<std::uint8_t> crosses(static_cast<std::size_t>(nx));
    for (int j = 0; j < ny; ++j) {
        const auto row = [&](int jj, int kk) {
            return &values[shape.index(0, std::clamp(jj, 0, ny - 1), std::clamp(kk, 0, nz - 1))];
        };
        const float *own = row(j, k), *a = row(j - 1, k), *b = row(j + 1, k), *c = row(j, k - 1), *d = row(j, k + 1);
        for (int i = 0; i < nx; ++i) {
            const int in = own[i] > 0;
            crosses[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(
                (in ^ int{a[i] > 0}) | (in ^ int{b[i] > 0}) | (in ^ int{c[i] > 0}) | (in ^ int{d[i] > 0}));
        }
        for (int i = 0; i + 1 < nx; ++i) {
            const auto changes = static_cast<std::uint8_t>(int{own[i] > 0} ^ int{own[i + 1] > 0});
            crosses[static_cast<std::size_t>(i)] |= changes;
            crosses[static_cast<std::size_t>(i) + 1] |= changes;
        }
        for (auto at = crosses.begin(); (at = std::find(at, crosses.end(), 1)) != crosses.end(); ++at) {
            const int i = static_cast<int>(at - crosses.begin());
            places.push_back(static_cast<std::uint32_t>(j * nx + i));
            distances.push_back(distanceToZero(shape, values, i, j, k));
        }
    }
}

/// |grad| = 1 from the values around voxel `place` of a slice, first-order upwind.
float solved(const Shape& shape, const Field& values, std::uint32_t place, int k) {
    const auto nx = static_cast<std::uint32_t>(shape.size[0]);
    const std::array<int, 3> c{static_cast<int>(place % nx), static_cast<int>(place / nx), k};
    const std::array<std::size_t, 3> strides{1, shape.rowStride(), shape.sliceStride()};
    const std::size_t at = shape.index(0, 0, k) + place;
    std::array<float, 3> low{kUnknown, kUnknown, kUnknown};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (c[axis] > 0) low[axis] = std::min(low[axis], std::abs(values[at - strides[axis]]));
        if (c[axis] + 1 < shape.size[axis]) low[axis] = std::min(low[axis], std::abs(values[at + strides[axis]]));
    }
    std::sort(low.begin(), low.end());
    float d = low[0] + 1;
    if (d > low[1]) {
        d = 0.5f * (low[0] + low[1] + std::sqrt(std::max(0.0f, 2 - (low[0] - low[1]) * (low[0] - low[1]))));
        if (d > low[2]) {
            const float sum = low[0] + low[1] + low[2];
            const float squares = low[0] * low[0] + low[1] * low[1] + low[2] * low[2];
            d = (sum + std::sqrt(std::max(0.0f, sum * sum - 3 * (squares - 1)))) / 3;
        }
    }
    return d;
}

/// The unknown voxels of slice k beside the layer; they are marked as found.
void findNext(const Shape& shape, Field& values, int k, const PlacesBySlice& layer, std::vector<std::uint32_t>& next) {
    next.clear();
    float* own = &values[shape.index(0, 0, k)];
    const auto take = [&](std::uint32_t place) {
        float& v = own[place];
        if (std::abs(v) != kUnknown) return;
        v *= 2;
        next.push_back(place);
    };
    const auto nx = static_cast<std::uint32_t>(shape.size[0]), count = static_cast<std::uint32_t>(shape.sliceStride());
    const auto slice = static_cast<std::size_t>(k);
    for (const std::uint32_t place : layer[slice]) {
        const std::uint32_t i = place % nx;
        if (i > 0) take(place - 1);
        if (i + 1 < nx) take(place + 1);
        if (place >= nx) take(place - nx);
        if (place + nx < count) take(place + nx);
    }
    if (k > 0) std::for_each(layer[slice - 1].begin(), layer[slice - 1].end(), take);
    if (slice + 1 < layer.size()) std::for_each(layer[slice + 1].begin(), layer[slice + 1].end(), take);
}

}  // namespace

void redistance(const Shape& shape, Field& values, float band) {
    // Distances at the voxels beside the zero from where it crosses the grid's lines; further ones layer by layer from
    // the ones already known.
    const int layers = static_cast<int>(std::ceil(band)) + 1;
    const auto slices = static_cast<std::size_t>(shape.size[2]);
    PlacesBySlice layer(slices), next(slices);
    std::vector<std::vector<float>> distances(slices);
    const auto forSlices = [&](const auto& body) {
        core::parallelFor(slices, 1, [&](std::size_t from, std::size_t to) {
            for (std::size_t k = from; k < to; ++k)
                body(k, &values[shape.index(0, 0, static_cast<int>(k))]);
        });
    };
    const auto set = [&](const std::vector<std::uint32_t>& places, const std::vector<float>& to, float* slice) {
        for (std::size_t n = 0; n < places.size(); ++n)
            slice[places[n]] = std::copysign(to[n], slice[places[n]]);
    };
    forSlices(
        [&](std::size_t k, const float*) { findBeside(shape, values, static_cast<int>(k), layer[k], distances[k]); });
    forSlices([&](std::size_t k, float* slice) {
        for (std::size_t n = 0; n < shape.sliceStride(); ++n)
            slice[n] = slice[n] > 0 ? kUnknown : -kUnknown;
        set(layer[k], distances[k], slice);
    });
    for (int round = 0; round < layers; ++round) {
        forSlices([&](std::size_t k, const float*) { findNext(shape, values, static_cast<int>(k), layer, next[k]); });
        // Twice: the second time a layer's voxels know each other.
        for (int pass = 0; pass < 2; ++pass) {
            forSlices([&](std::size_t k, const float*) {
                distances[k].resize(next[k].size());
                for (std::size_t n = 0; n < next[k].size(); ++n)
                    distances[k][n] = solved(shape, values, next[k][n], static_cast<int>(k));
            });
            forSlices([&](std::size_t k, float* slice) { set(next[k], distances[k], slice); });
        }
        layer.swap(next);
    }
    core::parallelFor(values.size(), 1 << 18, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n)
            values[n] = std::clamp(values[n], -band, band);
    });
}

}  // namespace handpiece::segmentation
