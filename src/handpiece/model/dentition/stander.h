// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A tooth as gingiva and bone see it: distances from its surface and heights over its cemento-enamel junction, looked
/// up fast. Private to this room.

#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/dentition/gingiva.h"
#include "handpiece/model/dentition/tooth_body.h"

namespace handpiece::dentition {

inline constexpr double kFarMm = 4.3;  ///< distances to teeth are told up to here

/// Signed distances from a tooth, in its frame, within kFarMm; looked up between nodes. Farther off they are rounded
/// where they have a crease, as between two roots: what lies so far from a tooth follows no one of them.
class DistanceGrid {
  public:
    explicit DistanceGrid(const ToothBody& body);
    [[nodiscard]] double at(const core::Vec3& p) const;

  private:
    [[nodiscard]] float& node(std::size_t i, std::size_t j, std::size_t k) {
        return values_[(k * count_[1] + j) * count_[0] + i];
    }
    void measure(const ToothBody& body, std::size_t stride);
    void roundCreases();

    core::Vec3 from_;
    std::size_t count_[3];
    std::vector<float> values_;
};

/// One tooth of the arch: its surface, and the height over its cemento-enamel junction.
class Stander {
  public:
    using Terms = Eigen::Matrix<double, 15, 1>;
    explicit Stander(const ArchTooth& t);
    [[nodiscard]] const ToothBody& body() const { return body_; }
    [[nodiscard]] const core::Pose& pose() const { return pose_; }
    [[nodiscard]] const core::Box& near() const { return near_; }
    [[nodiscard]] const core::Vec3& axis() const { return axis_; }
    [[nodiscard]] double rootMm() const { return rootMm_; }
    /// Of its neck, towards cheek and tongue.
    [[nodiscard]] double halfNeckMm() const { return half_.y(); }
    /// Where the junction lies in the middle of the face that looks that way, in the arch.
    [[nodiscard]] core::Vec3 neckTowards(const core::Vec3& direction) const;

    struct Seen {
        double distance;     ///< from its surface, within kFarMm
        double aboveCervix;  ///< over the junction
    };
    [[nodiscard]] Seen see(const core::Vec3& p) const;
    [[nodiscard]] double distance(const core::Vec3& p) const {
        return grid_.at(turn_.transpose() * (p - pose_.positionMm));
    }

  private:
    ToothBody body_;
    DistanceGrid grid_;
    core::Pose pose_;
    core::Mat3 turn_;
    core::Vec3 axis_;
    core::Box near_;
    std::vector<core::Vec3> ring_;
    core::Vec2 middle_, half_;  ///< of the junction, seen from above
    Terms junction_;
    double rootMm_ = 0.0;
};

}  // namespace handpiece::dentition
