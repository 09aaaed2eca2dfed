// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Intraoral radiographs of a case, by attenuation through its tissues: docs/radiographs.md.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/model/case/case.h"
#include "handpiece/senses/radiograph/beam.h"

namespace handpiece::radiograph {

enum class View { bitewing, periapical };
/// "bitewing", "periapical"; throws core::Error naming them.
[[nodiscard]] View viewByName(std::string_view name);
[[nodiscard]] std::string_view nameOf(View view);

/// Where the detector lies and what meets it. Case frame; the picture is seen from the tube's side.
struct Projection {
    core::Vec3 centreMm = core::Vec3::Zero();  ///< of the detector
    core::Vec3 right = core::Vec3::UnitX();    ///< of the picture; unit, as `up`, at right angles to it
    core::Vec3 up = core::Vec3::UnitZ();
    int width = 0, height = 0;  ///< pixels
    double pixelMm = 0.03;
    double sourceMm = 300.0;  ///< from the focal spot to the detector, along its normal

    /// Towards the tube.
    [[nodiscard]] core::Vec3 normal() const { return right.cross(up); }
};

struct Settings {
    View view = View::bitewing;
    int fdiNumber = 0;          ///< the tooth in the middle; 0: the case's own
    int width = 0, height = 0;  ///< pixels; 0: a sensor of 36 x 26 mm, upright where the tooth asks for it
    double pixelUm = 30.0;
    double kv = 65.0;
    double filtrationMm = 2.0;  ///< aluminium
    double cheekMm = 10.0;      ///< soft tissue that no case holds
    Filling filling = Filling::amalgam;
    double sourceMm = 300.0;
    double focalSpotMm = 0.7;  ///< a square
    int spotPoints = 2;        ///< by as many
    double quanta = 1500.0;    ///< a pixel detects in the open beam; 0: no noise
    double blurUm = 40.0;      ///< standard deviation of the detector's spread
    std::uint64_t seed = 1;
};
/// Throws core::Error for settings out of range, naming the option of `handpiece xray`.
void check(const Settings& settings);

/// What the detector took in: share of the open beam, rows from the top.
struct Exposure {
    int width = 0, height = 0;
    std::vector<float> signal;
    [[nodiscard]] float at(int x, int y) const {
        return signal[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
};

/// Where a case's tooth is to be taken. Throws core::Error: no such tooth, nothing to image.
[[nodiscard]] Projection project(const cases::Case& toothCase, const Settings& settings);
/// The beam as it arrives, without blur and noise. The same bytes at any number of threads. Throws core::Error for a
/// surface that is open or out of reach, naming it; scenery that is only seen and open is passed over.
[[nodiscard]] Exposure expose(const cases::Case& toothCase, const Projection& projection, const Settings& settings,
                              const core::Progress& progress = {});
/// Quanta are counted, then spread.
void detect(Exposure& exposure, const Settings& settings);

/// Grey values as a sensor's program shows them: 0 black (open beam), 65535 white. Steepest where teeth are told from
/// what is in them, as DICOM's sigmoid VOI function: nothing is cut off, so that all of it can be windowed anew.
struct Picture {
    int width = 0, height = 0;
    std::vector<std::uint16_t> grey;
    double windowCentre = 1.5, windowWidth = 2.0;  ///< of attenuation, -ln of the signal
};
/// 0 to 1, by 1 / (1 + exp(-4 (attenuation - centre) / width)), with the open beam at 0.
[[nodiscard]] double greyOf(double attenuation, double windowCentre, double windowWidth);
/// The window is chosen by what hard tissue takes in this picture; SIMULATED stands in a corner.
[[nodiscard]] Picture develop(const Exposure& exposure);

/// All of it.
struct Radiograph {
    Projection projection;
    Settings settings;
    int fdiNumber = 0;  ///< of the tooth that was taken; 0 where the case does not tell
    Picture picture;
};
[[nodiscard]] Radiograph take(const cases::Case& toothCase, const Settings& settings,
                              const core::Progress& progress = {});

}  // namespace handpiece::radiograph
