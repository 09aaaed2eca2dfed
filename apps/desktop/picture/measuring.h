// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the measuring tools of the picture give: plain data, and its text.

#include <QString>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/senses/measure/pulp_light.h"
#include "handpiece/senses/view/look.h"

namespace handpiece::desktop {

/// What the left button does in the picture.
enum class Tool { drill, calliper, depth, pulp, section, mirror, landmarks };

/// How a remaining dentine thickness is to be taken.
using Light = measure::PulpLight;
using measure::pulpLight;

/// One measurement on the tooth, tooth frame.
struct Measurement {
    enum class Kind { distance, depth, pulp };
    Kind kind = Kind::distance;
    core::Vec3 fromMm = core::Vec3::Zero();  ///< the first point; for depth and pulp the point of the surface
    core::Vec3 toMm = core::Vec3::Zero();    ///< distance: the second point; else the same point
    double valueMm = 0.0;  ///< distance; depth below the uncut surface (nearest); dentine left over the pulp
    std::optional<double> alongAxisMm;  ///< depth: as a gauge along the bur's axis reads it

    /// "3.42 mm", with what belongs to it, translated.
    [[nodiscard]] QString text() const;
};

/// Where the section lies. What is on the far side of the plane, seen from `towards`, stays.
struct SectionPlace {
    enum class Direction { buccoLingual, mesioDistal, horizontal };
    Direction direction = Direction::buccoLingual;
    double offsetMm = 0.0;  ///< along the axis the plane stands across: x, y or z of the tooth frame
    bool flipped = false;   ///< the other side is taken away
    friend bool operator==(const SectionPlace&, const SectionPlace&) = default;
};
/// A bucco-lingual section shows the tooth cut from cheek to tongue: its plane stands across x. Mesio-distal: across y.
[[nodiscard]] view::Plane planeOf(const SectionPlace& place);
[[nodiscard]] QString directionName(SectionPlace::Direction direction);

/// A landmark as it is drawn, tooth frame: a point, or a line of them.
struct ShownLandmark {
    std::vector<core::Vec3> pointsMm;
    QString name;
    bool isRing = false;    ///< closed from the last point to the first
    bool isInside = false;  ///< of the tooth: drawn through it
    bool isSelected = false;
    std::vector<bool> hidden{};  ///< by the tooth, point by point; the picture's own
};
/// One point of one of them.
struct LandmarkPoint {
    std::size_t landmark = 0, point = 0;
};

/// A tissue's name for a legend, translated.
[[nodiscard]] QString tissueText(cases::Tissue tissue);

}  // namespace handpiece::desktop
