// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How smooth a movement is: the spectral arc length of its speed.

#include <optional>
#include <span>

namespace handpiece::hand {

/// As the authors' own program has them (github.com/siva82kb/SPARC, smoothness.py); the first paper cut off at 20 Hz.
struct ArcLengthSettings {
    double cutOffHz = 10.0;   ///< no hand means what is faster
    double threshold = 0.05;  ///< of the spectrum's greatest: beyond the last that reaches it nothing counts
    int padding = 4;          ///< the spectrum is that of 2^padding times the samples, rounded up to a power of two
};

/// Minus the length of the speed's magnitude spectrum, both axes scaled to 1: -1.41 for one reach as smooth as can be,
/// less the more a movement stops and starts. Free of speed's unit and of how long a movement takes.
/// S. Balasubramanian, A. Melendez-Calderon, E. Burdet: A robust and sensitive metric for quantifying movement
/// smoothness, IEEE Trans. Biomed. Eng. 59 (2012); adaptive cut-off: with A. Roby-Brami, J. NeuroEng. Rehabil. 12
/// (2015). None for fewer than four samples, what does not move, and what is no number. Samples are at most 2^16.
[[nodiscard]] std::optional<double> spectralArcLength(std::span<const double> speed, double rateHz,
                                                      const ArcLengthSettings& settings = {});

}  // namespace handpiece::hand
