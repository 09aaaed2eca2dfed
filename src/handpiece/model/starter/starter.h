// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Teeth that the product makes itself, from rules: nothing is downloaded, nobody's scan is shipped.

#include <cstddef>
#include <string_view>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/case/case.h"

namespace handpiece::starter {

enum class ToothKind { lowerFirstMolar, upperIncisor, upperPremolar };

struct ToothKindInfo {
    ToothKind kind;
    std::string_view name;  ///< as typed: "lower-first-molar"
    int fdiNumber;
    int buccalSign;  ///< +1: the buccal (labial) side is +y of the tooth frame, -1: -y
    std::string_view description;
};
[[nodiscard]] const std::vector<ToothKindInfo>& toothKinds();
[[nodiscard]] const ToothKindInfo& infoOf(ToothKind kind);
/// Throws core::Error naming the kinds there are.
[[nodiscard]] ToothKind toothKindByName(std::string_view name);

inline constexpr std::size_t kMinFaces = 2000, kMaxFaces = 2000000;

struct ToothOptions {
    std::size_t faces =
        68151;  ///< of the outer surface; an odd count becomes the even one above (closed surfaces have no other)
    std::size_t partFaces = 0;  ///< of each tissue's surface; 0: as fine as the outer surface, at most 120,000
    bool scene = false;         ///< also neighbours, gum and bone
};

/// A case with outer surface, enamel, dentine, pulp and a caries lesion, in the tooth frame [mm].
///
/// In parallel; the same bytes for the same options at any thread count. Throws core::Error for face counts outside
/// kMinFaces..kMaxFaces.
[[nodiscard]] cases::Case makeTooth(ToothKind kind, const ToothOptions& options = {},
                                    const core::Progress& progress = {});

/// Crown, root and what stands around them, roughly: to be looked at while the tooth itself is made. Under half a
/// second.
[[nodiscard]] cases::Case makeSketch(ToothKind kind);

/// The outer surface alone: closed, of genus 0, exactly `faces` triangles (the next even number).
[[nodiscard]] geometry::TriangleMesh makeOuter(ToothKind kind, std::size_t faces, const core::Progress& progress = {});

}  // namespace handpiece::starter
