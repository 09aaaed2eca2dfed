// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Several teeth felt at once, by the bur and by the parts of the handpiece behind it.

#include <memory>
#include <vector>

#include "handpiece/model/instrument/bur.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/contact/method.h"

namespace handpiece::contact {

/// One convex piece of the instrument at one tooth, or at what yields.
struct PlacedMethod {
    std::unique_ptr<Method> method;                ///< of piece and tooth, in their own frames
    std::shared_ptr<const instrument::Bur> solid;  ///< the piece, a solid of revolution
    core::Pose pieceInBur;
    core::Pose toothInScene;
    core::Box toothBoxMm;     ///< of the tooth's surface, its own frame
    std::uint16_t tooth = 0;  ///< as answers name it
    Piece piece = Piece::bur;
    bool isYielding = false;  ///< no tooth but what gives way (gingiva): it holds nothing off
    bool isPlain = false;     ///< no tooth but what is only hard (bone): held off by its depth, the bur has no patches
    bool isCuttable = true;   ///< the tooth is: else the bur has patches on it, and no bearing
};

/// Bur and handpiece as pieces to be felt, with what the methods of all teeth share of them.
class FeltInstrument {
  public:
    explicit FeltInstrument(std::shared_ptr<const instrument::Bur> bur);

    /// Where a tooth stands, and what it is: as in PlacedMethod.
    struct Standing {
        core::Pose inScene;
        std::uint16_t tooth = 0;
        bool isYielding = false, isPlain = false, isCuttable = true;
    };
    /// Adds a pair for each piece.
    void place(const std::shared_ptr<const tooth::ToothModel>& tooth, const Standing& standing,
               std::vector<PlacedMethod>& to) const;
    void place(const std::shared_ptr<const tooth::ToothState>& tooth, const Standing& standing,
               std::vector<PlacedMethod>& to) const;

  private:
    struct Piece {
        std::shared_ptr<const instrument::Bur> solid;
        core::Pose inBur;
        contact::Piece part;
        std::shared_ptr<const MedialSheets> sheets;
    };
    template <class Tooth>
    void placeAll(const std::shared_ptr<const Tooth>& tooth, const core::Box& box, const Standing& standing,
                  std::vector<PlacedMethod>& to) const;
    std::vector<Piece> pieces_;
};

/// Feels them as one; poses and answers are in the scene's frame, which is that of the case's own tooth. A pair is
/// asked when its boxes are near enough to matter, so the cost is that of what is near. One pair whose frames are the
/// scene's gives that method's answers bit for bit.
///
/// Throws core::Error for none, or more than kMaxPlaced.
inline constexpr std::size_t kMaxPlaced = 512;
[[nodiscard]] std::unique_ptr<Method> makeMouthMethod(std::vector<PlacedMethod> placed, double reachMm = 5.0);

}  // namespace handpiece::contact
