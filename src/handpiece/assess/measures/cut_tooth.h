// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A preparation taken apart: the surface that was cut, its floors and its walls. Everything is made when it is first
/// asked for. Private to this room.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/assess/measures/fit.h"
#include "handpiece/assess/measures/preparation.h"
#include "handpiece/model/field/sharp_lookup.h"

namespace handpiece::measures {

inline constexpr double kSin45 = 0.70710678118654752;
/// Rays along the path of draw stand this far apart, and walls are taken at as many places.
inline constexpr double kProbeMm = 0.05;
/// Under the pulpal floor lies the gingival one.
inline constexpr double kLowerMm = 0.4;

/// A place of a surface where an edge of the grid passes through it. Such places stand for equal areas on the whole: an
/// area A with normal n is met |n_x| + |n_y| + |n_z| times A / h^2 (Cauchy and Crofton).
struct SurfacePoint {
    core::Vec3 p, n;  ///< tooth frame; unit, out of the tooth
    double areaMm2 = 0.0;
};

/// u towards mesial where that is square to the path of draw, w along it, v completes the right hand.
struct DrawFrame {
    core::Vec3 u, v, w;
    [[nodiscard]] core::Vec3 to(const core::Vec3& p) const { return {u.dot(p), v.dot(p), w.dot(p)}; }
    [[nodiscard]] core::Vec3 from(const core::Vec3& q) const { return q.x() * u + q.y() * v + q.z() * w; }
};

/// What is first met along the path of draw, on a square grid of rays.
struct HeightMap {
    struct Node {
        double before = 0.0, now = 0.0;  ///< w of the uncut and of the present surface
        core::Vec3 n;                    ///< of the present one
        bool isMet = false, isCut = false;
    };
    double u0 = 0.0, v0 = 0.0;
    int width = 0, height = 0;
    std::vector<Node> nodes;  ///< u fastest
    [[nodiscard]] double uOf(int i) const { return u0 + kProbeMm * i; }
    [[nodiscard]] double vOf(int j) const { return v0 + kProbeMm * j; }
    [[nodiscard]] int at(int i, int j) const { return i + width * j; }
    [[nodiscard]] core::Vec3 drawOf(int index) const {
        return {uOf(index % width), vOf(index / width), nodes[static_cast<std::size_t>(index)].now};
    }
};

/// A connected piece of cut surface that faces the path of draw.
struct Floor {
    std::vector<int> nodes;  ///< of the height map, rising
    std::vector<int> flat;   ///< those of them out of the corners towards the walls
    std::vector<int> inner;  ///< those of `flat` that do not lie at its edge
    double unevenMm = 0.0;   ///< rms of `flat` about its surface of second order
    Plane plane;             ///< w over (u, v), through `flat`
    double areaMm2 = 0.0;    ///< as the path of draw sees it
};

/// A wall as a probe finds it that is led up along the path of draw.
struct WallStation {
    std::string_view side;  ///< of kSides
    int floor = 0;
    int row = 0, run = 0;                   ///< of the height map; which of its runs over the floor, counted on
    core::Vec3 h = core::Vec3::Zero();      ///< square to the path of draw, into the wall
    core::Vec3 start = core::Vec3::Zero();  ///< in the draw frame
    double spacingMm = kProbeMm;
    struct Sample {
        double w, r;  ///< along the path of draw; along h from start
        core::Vec3 n;
    };
    std::vector<Sample> samples;  ///< rising
    double floorW = 0.0, marginW = 0.0;
    core::Vec3 marginMm = core::Vec3::Zero();  ///< tooth frame
    bool isCorner = false;                     ///< the wall turns here, or ends
    bool isCavosurface = false;                ///< it ends at the uncut surface, not at another floor
    Line middle;                               ///< r over w, of the middle part
    double middleFromW = 0.0, middleToW = 0.0;
    [[nodiscard]] double heightMm() const { return marginW - floorW; }
};

/// What a crown preparation has towards one side of its axis, in a plane through that.
struct AxialStation {
    double azimuthRad = 0.0;
    std::string_view side;
    core::Vec3 h = core::Vec3::Zero();         ///< square to the path of draw, out of the tooth and square to the wall
    std::vector<WallStation::Sample> samples;  ///< r along h from the axis; rising w; from the margin up
    bool hasMargin = false;
    double marginW = 0.0, topW = 0.0, widthMm = 0.0;
    core::Vec3 marginMm = core::Vec3::Zero();
    Line middle;
};

/// A place where a wall meets the uncut surface.
struct MarginPlace {
    core::Vec3 p;      ///< tooth frame
    core::Vec3 outer;  ///< unit, of the uncut surface
    double lengthMm;   ///< of margin that it stands for
    double roughMm;    ///< by how much the wall's steps leave it open; 0: an even wall
};

class CutTooth {
  public:
    explicit CutTooth(const Preparation& preparation);

    /// Looks up the two surfaces. For one thread.
    class Look {
      public:
        explicit Look(const CutTooth& tooth);
        /// Signed distance [mm] to the tooth as it is, and as it was: right near the surface, else of the right sign.
        [[nodiscard]] double now(const core::Vec3& p);
        [[nodiscard]] double before(const core::Vec3& p) { return before_.distance(p); }
        [[nodiscard]] core::Vec3 normalNow(const core::Vec3& p) { return now_.normal(p); }
        [[nodiscard]] core::Vec3 normalBefore(const core::Vec3& p) { return before_.normal(p); }
        [[nodiscard]] bool isCut(const core::Vec3& p) { return before(p) < -cutMm_; }
        /// How far along a unit direction the tooth as it is begins, from a place in the air. 0 from one in the tooth.
        [[nodiscard]] std::optional<double> cast(const core::Vec3& from, const core::Vec3& along, double farMm);

      private:
        const CutTooth& tooth_;
        field::SharpLookup now_, before_;
        double cutMm_;
    };

    [[nodiscard]] const Preparation& preparation() const { return p_; }
    [[nodiscard]] const tooth::ToothModel& whole() const { return *p_.whole; }
    [[nodiscard]] double voxelMm() const { return whole().field.settings().voxelMm; }
    [[nodiscard]] const DrawFrame& frame() const { return frame_; }
    [[nodiscard]] const std::vector<std::uint32_t>& changedBricks() const { return changed_; }
    /// Deeper than this under the uncut surface [mm] the surface counts as cut.
    [[nodiscard]] double cutMm() const { return 0.1 * voxelMm(); }

    /// Signed distance to the tooth as it is, trilinear: any thread.
    [[nodiscard]] double nearlyNow(const core::Vec3& p) const;
    /// Of the surface that was cut; empty when nothing was.
    [[nodiscard]] const std::vector<SurfacePoint>& cutPoints();
    /// The cavosurface margin, about as dense as the voxels.
    [[nodiscard]] const std::vector<MarginPlace>& margin();
    [[nodiscard]] const HeightMap& heights();
    /// The pulpal one first, then the largest.
    [[nodiscard]] const std::vector<Floor>& floors();
    [[nodiscard]] Form form();
    [[nodiscard]] const std::vector<WallStation>& walls();
    /// Every 5 degrees, from mesial on.
    [[nodiscard]] const std::vector<AxialStation>& axialWalls();
    inline static constexpr int kAzimuths = 72;
    /// By the task's zones, of which there are some.
    [[nodiscard]] const zones::RemovedVolumes& removedVolumes();
    [[nodiscard]] const zones::WholeVolumes& wholeVolumes();

  private:
    friend class Look;
    void findFloors();
    void findWalls();
    /// False where there is no wall.
    [[nodiscard]] bool probeWall(Look& look, WallStation& wall, double topW, double farMm, const Floor& floor) const;
    [[nodiscard]] bool isNearCut(const core::Vec3& p) const;
    [[nodiscard]] double floorAt(const Floor& floor, const core::Vec3& q) const;
    [[nodiscard]] AxialStation axialAt(Look& look, double azimuthRad, const core::Vec3& axis, double lowW,
                                       double highW) const;

    const Preparation& p_;
    DrawFrame frame_;
    std::vector<std::uint32_t> changed_;
    std::vector<bool> isKept_;  ///< by dense brick: in now_
    std::optional<field::DistanceField> now_;
    std::optional<std::vector<SurfacePoint>> cutPoints_;
    std::optional<std::vector<MarginPlace>> margin_;
    std::optional<HeightMap> heights_;
    std::optional<std::vector<Floor>> floors_;
    std::optional<std::vector<WallStation>> walls_;
    std::optional<std::vector<AxialStation>> axial_;
    std::optional<Form> form_;
    std::optional<zones::RemovedVolumes> removedVolumes_;
    std::optional<zones::WholeVolumes> wholeVolumes_;
};

}  // namespace handpiece::measures
