// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How far raters agree. What cannot be said (no variance, too few) is undefined with a reason, never 1.
/// Definitions and sources: docs/agreement.md.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace handpiece::agreement {

struct Interval {
    double low = 0.0, high = 0.0;
};
/// A coefficient with its 95 % interval.
struct Estimate {
    std::optional<double> value;
    std::optional<double> standardError;
    std::optional<Interval> interval;
    std::string reason;  ///< why there is no value
};

enum class Weights { none, linear, quadratic };  ///< none: Cohen's kappa

/// counts[i * categories + j]: items that the first rater put into category i and the second into j. Categories that
/// nobody used count as places on the scale. Cohen 1960 and 1968; standard error of Fleiss, Cohen and Everitt 1969.
[[nodiscard]] Estimate kappa(std::span<const std::size_t> counts, std::size_t categories, Weights weights);
/// Of two raters' categories, item by item.
[[nodiscard]] std::vector<std::size_t> countsOf(std::span<const std::size_t> first, std::span<const std::size_t> second,
                                                std::size_t categories);

/// values[item * raters + rater], none missing. Shrout and Fleiss 1979; intervals of (2,k) as McGraw and Wong 1996.
struct Icc {
    double betweenItems = 0.0, withinItems = 0.0, betweenRaters = 0.0, error = 0.0;  ///< mean squares
    Estimate one1, two1, three1, oneK, twoK, threeK;
};
[[nodiscard]] Icc icc(std::span<const double> values, std::size_t raters);

/// Bland and Altman 1986; intervals as in 1999, by Student's t.
struct BlandAltman {
    std::size_t count = 0;
    std::optional<double> bias, spread;  ///< of first less second
    std::optional<double> low, high;     ///< bias -+ 1.96 spread
    std::optional<Interval> biasInterval, lowInterval, highInterval;
    std::string reason;
};
[[nodiscard]] BlandAltman blandAltman(std::span<const double> first, std::span<const double> second);

enum class Level { nominal, ordinal, interval, ratio };

/// values[item * raters + rater]; none where one did not mark. Krippendorff 2011. Ordinal: the values that occur, in
/// their order (one that nobody used lies between others without changing anything).
[[nodiscard]] Estimate krippendorffAlpha(std::span<const std::optional<double>> values, std::size_t raters,
                                         Level level);

/// 95 % by drawing items again, with replacement: percentiles of `draws` values of `statistic`, which is given the
/// places of the items drawn. The draws come from `seed` alone; make it of the content. Nothing where more than a tenth
/// of the draws are undefined.
struct Bootstrap {
    std::optional<Interval> interval;
    std::size_t undefined = 0;
    std::uint64_t seed = 0;
};
[[nodiscard]] Bootstrap bootstrap(std::size_t items, std::uint64_t seed, std::size_t draws,
                                  const std::function<std::optional<double>(std::span<const std::size_t>)>& statistic);
/// Of marks and their shape, for bootstrap().
[[nodiscard]] std::uint64_t seedOf(std::span<const std::optional<double>> values, std::size_t raters);

/// Share of Student's t, Snedecor's F under `x`, and where a share lies: |error| of the share under 1e-12.
[[nodiscard]] double studentBelow(double x, double degrees);
[[nodiscard]] double studentAt(double share, double degrees);
[[nodiscard]] double fisherBelow(double x, double degrees1, double degrees2);
[[nodiscard]] double fisherAt(double share, double degrees1, double degrees2);
/// Where 97.5 % of the normal distribution lie below.
inline constexpr double kNormal975 = 1.959963984540054;

}  // namespace handpiece::agreement
