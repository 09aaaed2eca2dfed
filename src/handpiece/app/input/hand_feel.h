// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the pointer's hand feels of a mouth at a pose: how far bur and handpiece are clear of it. One thread.

#include <cstdint>
#include <memory>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/tooth/tooth_model.h"

namespace handpiece::input {

/// Nothing within reach: so far clear, at least.
inline constexpr double kFarClearMm = 5.0;

/// How far something is clear of tissue, negative: so deep in it; and of what.
struct Clearance {
    double mm = kFarClearMm;
    std::uint16_t what = 0;  ///< number of the tooth, or of the gingiva or bone; 0: the tooth worked on
    bool isTooth = true;
};

/// Poses are of the bur, in the frame of the tooth worked on.
class HandFeel {
  public:
    virtual ~HandFeel() = default;
    /// Of the bur from all that is there, as it was before any cut: teeth, gingiva, bone.
    [[nodiscard]] virtual Clearance ofBur(const core::Pose& bur) = 0;
    /// Of shank, head and handle from the same.
    [[nodiscard]] virtual double ofBodyMm(const core::Pose& bur) = 0;
    /// Of the bur's side, above its working end, from the same: where that is near a wall the bur cuts with its side.
    [[nodiscard]] virtual double ofSideMm(const core::Pose& bur) = 0;
    /// Of the bur from the tooth worked on as it was at the last beginStroke(). To 0.01 mm.
    [[nodiscard]] virtual double inStrokeMm(const core::Pose& bur) = 0;
    /// A stroke begins: what has been cut by now is its surface.
    virtual void beginStroke() = 0;
};

/// One tooth with nothing around it, nothing behind the bur and nothing ever cut. Null without a tooth or a bur.
[[nodiscard]] std::shared_ptr<HandFeel> feelUncut(std::shared_ptr<const tooth::ToothModel> tooth,
                                                  std::shared_ptr<const instrument::Bur> bur);

}  // namespace handpiece::input
