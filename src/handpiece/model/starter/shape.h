// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An anatomy as functions of space, negative inside. Private to this room.

#include "handpiece/base/core/vec.h"
#include "handpiece/model/starter/anatomy.h"

namespace handpiece::starter {

/// Lofted cross-sections, ready to be asked.
class LoftedColumn {
  public:
    explicit LoftedColumn(const Column& column);
    [[nodiscard]] double value(const core::Vec3& p) const;

  private:
    struct Knot {
        double z;
        double value[5], slope[5];  ///< cx, cy, halfX, halfY, square
    };
    std::vector<Knot> knots_;
    double bottomZ_, bottomLength_, topZ_, topLength_, wedge_, lean_;
};

/// The surfaces of one tooth as functions: about distances [mm] near their zero, at most kLipschitz steep.
class ToothShape {
  public:
    explicit ToothShape(const Anatomy& anatomy);

    static constexpr double kLipschitz = 3.2;

    [[nodiscard]] double outer(const core::Vec3& p) const;
    [[nodiscard]] double enamel(const core::Vec3& p) const;
    [[nodiscard]] double dentine(const core::Vec3& p) const;
    [[nodiscard]] double pulp(const core::Vec3& p) const;
    [[nodiscard]] double caries(const core::Vec3& p) const;
    /// Where the tooth lies, with a margin.
    [[nodiscard]] core::Box bounds() const;

  private:
    [[nodiscard]] double body(const core::Vec3& p) const;  ///< without fissures and the step at the neck
    [[nodiscard]] double occlusalHeight(double x, double y) const;
    [[nodiscard]] double fissureDepth(const core::Vec3& p) const;
    [[nodiscard]] double aboveNeck(const core::Vec3& p) const;  ///< height over the cervical line
    [[nodiscard]] double core(const core::Vec3& p, double bodyValue) const;

    Anatomy anatomy_;
    LoftedColumn crown_;
    std::vector<LoftedColumn> roots_;
    LoftedColumn chamber_;
};

/// max(a, b) with the edge rounded over `width`, never below max.
[[nodiscard]] double smoothMax(double a, double b, double width);
[[nodiscard]] inline double smoothMin(double a, double b, double width) {
    return -smoothMax(-a, -b, width);
}

}  // namespace handpiece::starter
