// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How measures are taken and registered: one function each, named in measure.cpp. Private to this room.

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/assess/measures/cut_tooth.h"

namespace handpiece::measures {

inline constexpr double kDegrees = 57.295779513082321;
inline constexpr const char* kNothing = "nothing was cut";

/// What a measure gives; measure() adds kind, selection and uncertainty.
struct Taken {
    std::optional<double> value;
    std::string reason;
    std::vector<Evidence> evidence{};
    double offMm = 0.0;     ///< what is open about where the measure is taken, in its unit
    double residual = 0.0;  ///< what the surface's own unevenness makes uncertain, one standard deviation, in its unit
};
using Take = Taken (*)(CutTooth& tooth, const Selection& of);

inline Taken none(std::string reason) {
    return {{}, std::move(reason)};
}
inline Taken at(double value, const core::Vec3& placeMm, std::string text) {
    return {value, {}, {Evidence{{}, placeMm, {}, std::move(text)}}};
}

/// Values at places, of which a statistic is asked.
struct Places {
    std::vector<double> values;
    std::vector<core::Vec3> mm;
    void add(double value, const core::Vec3& p) {
        values.push_back(value);
        mm.push_back(p);
    }
    /// Of a scan, extremes are asked of medians over `reach` places to either side: one place may be a flaw of the
    /// scan. `isClosed`: the last place stands beside the first.
    [[nodiscard]] Places evened(double noiseMm, std::size_t reach, bool isClosed) const;
    [[nodiscard]] Taken taken(const Selection& of, std::string_view ownStatistic, const char* text) const {
        const std::string_view statistic = of.statistic.empty() ? ownStatistic : of.statistic;
        std::size_t where = 0;
        const double value = statisticOf(values, statistic, &where);
        Taken taken = at(value, mm[where], text);
        // The place of a median says nothing of where to go on: its two ends do.
        if ((statistic == "mean" || statistic == "median") && values.size() > 1)
            for (const auto& [end, words] : {std::pair{"p5", kLeastHere}, std::pair{"p95", kMostHere}}) {
                (void)statisticOf(values, end, &where);
                taken.evidence.push_back({{}, mm[where], {}, words});
            }
        return taken;
    }
};

inline Places Places::evened(double noiseMm, std::size_t reach, bool isClosed) const {
    const std::size_t n = values.size();
    if (!(noiseMm > 0.0) || n < 2 * reach + 1) return *this;
    Places even;
    for (std::size_t i = 0; i < n; ++i) {
        std::vector<double> about;
        for (std::size_t k = 0; k <= 2 * reach; ++k) {
            const std::size_t at = i + n + k - reach;
            if (isClosed || (at >= n && at < 2 * n)) about.push_back(values[at % n]);
        }
        even.add(medianOf(std::move(about)), mm[i]);
    }
    return even;
}

Taken takeRemoved(CutTooth&, const Selection&);
Taken takeRemovedShare(CutTooth&, const Selection&);
Taken takeFloorDepth(CutTooth&, const Selection&);
Taken takeFloorDepthShortest(CutTooth&, const Selection&);
Taken takeFloorFlatness(CutTooth&, const Selection&);
Taken takeFloorTilt(CutTooth&, const Selection&);
Taken takeIsthmus(CutTooth&, const Selection&);
Taken takeIsthmusShare(CutTooth&, const Selection&);
Taken takeMarginalRidge(CutTooth&, const Selection&);
Taken takeWallHeight(CutTooth&, const Selection&);
Taken takeWallAngle(CutTooth&, const Selection&);
Taken takeUndercutArea(CutTooth&, const Selection&);
Taken takeUndercutDepth(CutTooth&, const Selection&);
Taken takeRoughness(CutTooth&, const Selection&);
Taken takeRemainingDentine(CutTooth&, const Selection&);
Taken takePulpExposed(CutTooth&, const Selection&);
Taken takeCavosurfaceAngle(CutTooth&, const Selection&);
Taken takeReduction(CutTooth&, const Selection&);
Taken takeConvergence(CutTooth&, const Selection&);
Taken takeMarginWidth(CutTooth&, const Selection&);
Taken takeMarginContinuity(CutTooth&, const Selection&);
Taken takeMarginHeight(CutTooth&, const Selection&);
Taken takeAxialDepth(CutTooth&, const Selection&);
Taken takeCariesLeft(CutTooth&, const Selection&);
Taken takeCariesLeftPeriphery(CutTooth&, const Selection&);
Taken takeCariesLeftPulpal(CutTooth&, const Selection&);
Taken takeUnsupportedEnamel(CutTooth&, const Selection&);
Taken takeAdjacentDepth(CutTooth&, const Selection&);
Taken takeAdjacentRemoved(CutTooth&, const Selection&);
Taken takeOutlineExtent(CutTooth&, const Selection&);
Taken takeProximalClearance(CutTooth&, const Selection&);
Taken takeOrificesReached(CutTooth&, const Selection&);
Taken takeGougeDepth(CutTooth&, const Selection&);

/// Unevenness is alike over this way [mm]: a mean over n such pieces is surer by the root of n.
inline constexpr double kPieceMm = 0.3;
[[nodiscard]] inline double meanOf(double rms, double piecesAlong, double piecesAcross = 1.0) {
    return rms / std::sqrt(std::max(1.0, piecesAlong) * std::max(1.0, piecesAcross));
}

/// Half-width of an interval about a value [the kind's unit]; docs/assessment.md says what each rests on.
[[nodiscard]] double uncertaintyOf(std::string_view kind, double voxelMm, double value, double residual);

/// Sum over the nodes of a tooth of weight(place, tissue) times what was there and is gone, or is left [mm3].
[[nodiscard]] double volumeOf(const tooth::ToothModel& whole, const tooth::ToothMirror& cut, bool ofRemoved,
                              const std::function<double(const core::Vec3&, cases::Tissue)>& weight);
/// True for a tissue's own name, and for any when none is asked.
[[nodiscard]] bool isAsked(const Selection& of, cases::Tissue tissue);

}  // namespace handpiece::measures
