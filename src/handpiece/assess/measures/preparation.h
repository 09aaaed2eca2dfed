// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A preparation to be measured, and the one way to its measures. docs/assessment.md defines each of them.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/assess/measures/measure.h"
#include "handpiece/assess/zones/zones.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/landmark.h"
#include "handpiece/model/tooth/tooth_mirror.h"

namespace handpiece::measures {

/// Directions of a preparation, unit, tooth frame.
struct Axes {
    core::Vec3 draw = core::Vec3::UnitZ();  ///< the path of draw: along which a restoration would leave the preparation
    core::Vec3 longAxis = core::Vec3::UnitZ();  ///< from the apex towards the crown
    core::Vec3 mesial = core::Vec3::UnitX();
    core::Vec3 buccal = core::Vec3::Zero();  ///< zero when nobody says which side is buccal
};
/// From a case's landmarks: draw is the path of insertion, else the long axis; the long axis else +z.
[[nodiscard]] Axes axesOf(std::span<const cases::Landmark> landmarks, int buccalSign);
/// The direction of a side of kSides, square to the path of draw; none for a side that lies along it, or is not known.
[[nodiscard]] std::optional<core::Vec3> sideDirection(const Axes& axes, std::string_view side);
/// The same as the tooth lies, whatever the path of draw: unit; none where it is not known.
[[nodiscard]] std::optional<core::Vec3> axisOf(const Axes& axes, std::string_view side);
/// The side that a direction points to most; empty when none is known within 45 degrees of it.
[[nodiscard]] std::string_view sideOf(const Axes& axes, const core::Vec3& direction);

/// Cut into the tooth, or all round it. `found`: by whether its walls face one another.
enum class Form { found, cavity, crown };

/// Of a scan: at least so deep under the whole tooth something was cut [mm]; what lies nearer all over is noise.
inline constexpr double kScanSeedMm = 0.1;

/// What is measured. References must outlive the measuring; nobody may feed the mirrors meanwhile.
struct Preparation {
    std::shared_ptr<const tooth::ToothModel> whole;
    const tooth::ToothMirror* cut = nullptr;
    Axes axes;
    std::span<const cases::Landmark> landmarks{};
    Form form = Form::found;
    /// A cavity beside cusps that are taken down: what faces the path of draw is not all floor.
    bool isCapped = false;
    /// As the session counted; none: integrated from the two fields, which gives the same but for rounding.
    std::optional<tooth::TissueVolumes> removedMm3{};
    struct Other {
        std::shared_ptr<const tooth::ToothModel> whole;
        const tooth::ToothMirror* cut = nullptr;
        core::Pose inTooth{};
        int fdiNumber = 0;
    };
    std::span<const Other> others{};  ///< teeth beside it
    /// Gingiva as a surface, tooth frame; null when the case has none.
    const geometry::TriangleTree* gingiva = nullptr;
    /// Rms of what a scanner has left on the surface; 0: it was cut here.
    double noiseMm = 0.0;
    /// Of the task; null where it has none.
    const zones::Zones* zones = nullptr;
};

/// One value, or reason why there is none, a request, in their order. The same bits at any thread count. Throws
/// core::Error for a kind that does not exist, is not of the tooth, or does not take what is selected.
[[nodiscard]] std::vector<Measured> measure(const Preparation& preparation, std::span<const Request> requests);

}  // namespace handpiece::measures
