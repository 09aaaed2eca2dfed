// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What of a tooth a task asks to take away, what it lets go beside that, and what it forbids; and how much of each is
/// gone.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/model/tooth/tooth_mirror.h"

namespace handpiece::zones {

enum class Zone : std::uint8_t {
    target,         ///< is to go
    leewaySide,     ///< may go: beside the target, past its walls
    leewayFloor,    ///< may go: under the target
    protectedZone,  ///< must stay, whatever lies there; wins over the others
    container,      ///< all else: must stay
};
inline constexpr std::size_t kZoneCount = 5;
/// In the order of Zone, as rubrics name them.
inline constexpr std::array<std::string_view, kZoneCount> kZoneNames = {"target", "leeway-side", "leeway-floor",
                                                                        "protected", "container"};

/// What stands for a distance where there is nothing to be distant from.
inline constexpr double kFarMm = 1e3;

/// How far a place lies past the walls of the target and past its floor, both negative in the target [mm]: signed
/// distances near it, of the right sign farther off.
struct PastTarget {
    double wallMm, floorMm;
    /// What lies past the target lies under it where this is negative, else beside it: signed distance to where the two
    /// meet.
    double besideMm = wallMm;
    /// Signed distance to the target.
    [[nodiscard]] double distanceMm() const;
};
/// Pure; called from several threads. Tooth frame.
using TargetFunction = std::function<PastTarget(const core::Vec3&)>;

/// What may go beside the target [mm].
struct Leeway {
    double sideMm = 0.0, floorMm = 0.0;
};

/// Functions of space, so that their walls lie where they lie whatever the voxel. Immutable; any thread.
class Zones {
  public:
    /// `box` holds the target. `protectedMm`: signed distance to what must stay; none: nothing is protected.
    /// Throws core::Error for leeway that is negative or no number, and for an empty box.
    Zones(TargetFunction target, const core::Box& box, const Leeway& leeway, geometry::ScalarFunction protectedMm = {});

    [[nodiscard]] Zone at(const core::Vec3& p) const;
    /// Signed distances, negative inside [mm].
    [[nodiscard]] double targetMm(const core::Vec3& p) const { return target_(p).distanceMm(); }
    /// Of the target and its leeway together.
    [[nodiscard]] double allowedMm(const core::Vec3& p) const { return allowedMm(target_(p)); }
    /// Far outside where nothing is protected.
    [[nodiscard]] double protectedMm(const core::Vec3& p) const;
    /// Holds the target.
    [[nodiscard]] const core::Box& box() const { return box_; }
    [[nodiscard]] const Leeway& leeway() const { return leeway_; }

    /// To the target, to all in and under it, what may go (target and leeway), what must stay; negative inside each
    /// [mm].
    struct Distances {
        double target, wall, allowed, kept;
    };
    [[nodiscard]] Distances distancesMm(const core::Vec3& p) const;
    /// Signed distance to a zone by its name; none where there is no such zone.
    [[nodiscard]] std::optional<double> distanceMm(std::string_view zone, const core::Vec3& p) const;

  private:
    [[nodiscard]] double allowedMm(const PastTarget& past) const;

    TargetFunction target_;
    core::Box box_;
    Leeway leeway_;
    geometry::ScalarFunction protected_;
};

/// By zone and tissue [mm3]: what has gone, which sums to what the field has lost, to rounding; what the uncut tooth
/// has in the target, its side and its floor's leeway (of the others it is not summed).
using RemovedVolumes = std::array<tooth::TissueVolumes, kZoneCount>;
using WholeVolumes = std::array<tooth::TissueVolumes, 3>;
struct ZoneVolumes {
    RemovedVolumes removed{};
    WholeVolumes whole{};
    [[nodiscard]] double removedMm3(Zone zone) const;
    [[nodiscard]] double targetMm3() const;
};

/// A voxel through which both the cut and a zone's border pass is shared as the distance to both says; shares of a
/// voxel sum to what it has lost. In parallel, the same bits at any thread count. What has gone takes as long as the
/// cut is large, the whole tooth up to seconds: who counts again and again keeps it.
[[nodiscard]] RemovedVolumes removedVolumes(const Zones& zones, const tooth::ToothMirror& cut);
[[nodiscard]] WholeVolumes wholeVolumes(const Zones& zones, const tooth::ToothModel& model);
[[nodiscard]] ZoneVolumes zoneVolumes(const Zones& zones, const tooth::ToothMirror& cut);

/// The tooth with all of the target taken away that is not protected, and nothing else: how it should be. As attempts
/// and key frames hold a cut. Throws core::Error when the tooth's memory for cuts does not suffice.
[[nodiscard]] tooth::StateDelta idealState(const Zones& zones, std::shared_ptr<const tooth::ToothModel> whole);

}  // namespace handpiece::zones
