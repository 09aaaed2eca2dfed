// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What burs did to the gingiva as it looks at a time: where they cut it is open, and blood runs from there. Depends on
/// the cuts and the time alone, not on the pictures drawn before. Private to this room.

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "handpiece/senses/view/wounded_gingiva.h"

namespace handpiece::view {

class Wounds {
  public:
    /// A piece of the gingiva as it was before any cut.
    struct Piece {
        std::uint32_t number = 0;
        gl::Vec3f minMm, maxMm;
        std::shared_ptr<const MeshPiece> mesh;
    };
    /// Other gingiva: nothing of it is open yet.
    void setGingiva(std::vector<Piece> pieces);
    /// By rising time. `down`: unit, as gravity acts on the patient.
    void setCuts(std::vector<messages::GingivaCut> cuts, const core::Vec3& down);
    /// The pieces that look different at this time from what they were when it was asked last.
    [[nodiscard]] std::vector<std::pair<std::uint32_t, MeshPiece>> at(double timeS);
    /// Whether blood ran when it was asked last: some time later it looks different.
    [[nodiscard]] bool isFlowing() const noexcept { return isFlowing_; }

  private:
    void beginAnew();
    void goTo(double timeS);
    void take(const messages::GingivaCut& cut);

    std::vector<Piece> pieces_;
    std::vector<messages::GingivaCut> cuts_;
    core::Vec3 down_ = -core::Vec3::UnitZ();
    std::optional<WoundedGingiva> wounded_;
    std::set<std::uint32_t> shown_;  ///< numbers of pieces that are not shown as they were
    std::size_t taken_ = 0;          ///< of cuts_
    std::int64_t step_ = 0;          ///< of time, done
    bool isAnew_ = false;            ///< what is shown is of before
    bool isFlowing_ = false;
};

}  // namespace handpiece::view
