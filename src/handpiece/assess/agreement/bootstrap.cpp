// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>

#include "handpiece/assess/agreement/agreement.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/split_mix.h"

namespace handpiece::agreement {

std::uint64_t seedOf(std::span<const std::optional<double>> values, std::size_t raters) {
    core::Hasher hasher;
    hasher.add(static_cast<std::uint64_t>(raters));
    for (const auto& v : values) {
        hasher.add(static_cast<std::uint64_t>(v ? 1 : 0));
        hasher.add(v && *v != 0.0 ? *v : 0.0);  // without the sign of a zero
    }
    return hasher.value();
}

Bootstrap bootstrap(std::size_t items, std::uint64_t seed, std::size_t draws,
                    const std::function<std::optional<double>(std::span<const std::size_t>)>& statistic) {
    Bootstrap out;
    out.seed = seed;
    if (items < 2 || draws == 0) return out;
    std::vector<std::optional<double>> values(draws);
    core::parallelFor(draws, 16, [&](std::size_t begin, std::size_t end) {
        std::vector<std::size_t> places(items);
        for (std::size_t d = begin; d < end; ++d) {
            std::uint64_t state = core::splitMix(seed ^ core::splitMix(d));
            for (std::size_t& place : places)
                place = std::min(items - 1, static_cast<std::size_t>(core::unitOf(core::nextSplitMix(state)) *
                                                                     static_cast<double>(items)));
            values[d] = statistic(places);
        }
    });
    std::vector<double> sorted;
    for (const auto& v : values)
        if (v) sorted.push_back(*v);
    out.undefined = draws - sorted.size();
    if (10 * out.undefined > draws) return out;
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double share) {
        const double place = share * static_cast<double>(sorted.size() - 1);
        const auto low = static_cast<std::size_t>(place);
        const std::size_t high = std::min(low + 1, sorted.size() - 1);
        return sorted[low] + (sorted[high] - sorted[low]) * (place - static_cast<double>(low));
    };
    out.interval = Interval{at(0.025), at(0.975)};
    return out;
}

}  // namespace handpiece::agreement
