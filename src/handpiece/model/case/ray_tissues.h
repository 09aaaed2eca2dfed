// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Which tissue lies along a ray, from where it crosses the surfaces of teeth and what stands around them.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/model/case/tissue.h"

namespace handpiece::cases {

/// A closed surface that rays cross.
struct RaySurface {
    enum class Role { outer, part, scenery };
    std::string name;  ///< for messages
    Tissue tissue = Tissue::enamel;
    int priority = 0;
    Role role = Role::part;
    std::uint32_t tooth = 0;  ///< which tooth an outer surface or a part is of
};

struct RayCrossing {
    double at = 0.0;
    std::uint32_t surface = 0;
    std::int32_t step = 0;  ///< +1 into the surface, -1 out of it
};

/// A stretch of a ray in one tissue.
struct RayStretch {
    double from = 0.0, to = 0.0;
    Tissue tissue = Tissue::none;
    bool isScenery = false;
};

/// The surfaces of a scene. A point is of the part of highest priority that holds it, of equal ones the later; a tooth
/// with an outer surface ends there, one without parts is enamel, and scenery counts where no tooth is. Const, any
/// thread.
class RayTissues {
  public:
    explicit RayTissues(std::vector<RaySurface> surfaces);
    [[nodiscard]] const std::vector<RaySurface>& surfaces() const { return surfaces_; }

    /// Tooth in which no part lies, from..to, and what touches it before and after (null: nothing): appends stretches.
    using FillGap = std::function<void(std::uint32_t tooth, double from, double to, const RayStretch* before,
                                       const RayStretch* after, std::vector<RayStretch>& out)>;
    /// What one thread needs to work in.
    struct Work {
        /// A stretch; one without a tissue is a gap in the parts of `tooth`.
        struct Piece {
            RayStretch stretch;
            std::uint32_t tooth;
        };
        std::vector<int> winding;
        std::vector<std::uint32_t> inside;
        std::vector<Piece> pieces;
    };
    /// Stretches at rising places that do not overlap, from crossings in their order. Throws core::Error when a surface
    /// proves open.
    void follow(std::span<const RayCrossing> crossings, const FillGap& fillGap, Work& work,
                std::vector<RayStretch>& out) const;

  private:
    struct Tooth {
        std::uint32_t outer = kNone;
        bool hasParts = false;
    };
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};

    std::vector<RaySurface> surfaces_;
    std::vector<std::uint32_t> rank_;    ///< of each surface; outer surfaces have none
    std::vector<std::uint32_t> ranked_;  ///< parts, then scenery, the winning ones first
    std::vector<Tooth> teeth_;
};

}  // namespace handpiece::cases
