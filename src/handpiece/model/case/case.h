// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A case: the surfaces of a tooth, what they are made of, what is to be done with it. As files hold it.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/base/geometry/vertex_colours.h"
#include "handpiece/model/case/exercise.h"
#include "handpiece/model/case/landmark.h"
#include "handpiece/model/case/tissue.h"

namespace handpiece::cases {

/// One closed surface of a case and what it is made of.
struct Part {
    std::string name;
    Tissue tissue = Tissue::enamel;
    int priority = 0;  ///< where parts overlap the higher wins
    geometry::TriangleMesh mesh;
    bool isFelt = false;                ///< of scenery: a solid that the instrument meets; else it is only seen
    geometry::VertexColours colours{};  ///< as a scanner saw it; empty: not known
};

/// A tooth as files hold it, in its own frame: millimetres, +z occlusal, +x mesial, +y completes the right hand.
struct Tooth {
    std::string name;
    std::string kind;              ///< "lower-first-molar"; may be empty
    int fdiNumber = 0;             ///< 0 when unknown
    int buccalSign = 0;            ///< +1: buccal is +y, -1: -y, 0 unknown
    geometry::TriangleMesh outer;  ///< the whole tooth as one closed surface; empty when there is none
    std::vector<Part> parts;       ///< its tissues
    std::vector<Landmark> landmarks{};
    geometry::VertexColours outerColours{};  ///< of `outer` as a scanner saw it; empty: not known

    /// That is felt: `outer`, or that of its only part; empty when there is neither.
    [[nodiscard]] const geometry::TriangleMesh& surface() const noexcept {
        return outer.triangles.empty() && parts.size() == 1 ? parts.front().mesh : outer;
    }
    /// Of surface().
    [[nodiscard]] const geometry::VertexColours& surfaceColours() const noexcept {
        return outer.triangles.empty() && parts.size() == 1 ? parts.front().colours : outerColours;
    }
};

/// Another tooth of the mouth.
struct PlacedTooth : Tooth {
    core::Pose inCase;       ///< its frame in that of the case's own tooth: rigid
    bool isCuttable = true;  ///< else the instrument is held off by it and no more
};

/// A case as read: a folder with case.toml and STL or PLY parts, or one STL (then a single enamel part). It is the
/// tooth that is worked on, whose frame is the case's, and what stands around it.
struct Case : Tooth {
    std::filesystem::path source;            ///< folder or file, for messages and for the cache beside it
    std::vector<PlacedTooth> others{};       ///< adjacent teeth, antagonists: felt
    std::vector<Part> scenery{};             ///< gum, bone and what is only seen, in the case's frame
    core::Pose opening{};                    ///< what moved the lower jaw out of occlusion, in the case's frame
    TissueTable tissues = builtInTissues();  ///< with what the case changes
    std::string tissuesToml;                 ///< the text of what it changes; empty when it changes nothing
    std::optional<Exercise> exercise;
};

/// Reads a case folder, a .handpiece file, or a single mesh file. Throws core::Error (what, where, remedy).
[[nodiscard]] Case readCase(const std::filesystem::path& path);
/// Writes case.toml and one STL per part (and outer.stl) into a folder, or all of it as one .handpiece file; whole or
/// not at all. What has colours is a PLY.
void writeCase(const Case& toothCase, const std::filesystem::path& path);

/// A number that differs when the tooth does: its surfaces (as an STL holds them), tissues or priorities. Texts,
/// landmarks, scenery and the tissue table count for nothing. An attempt keeps it.
[[nodiscard]] std::uint64_t contentKey(const Tooth& tooth);
/// Of all teeth of a case and where they stand; contentKey() of its tooth when it has no others.
[[nodiscard]] std::uint64_t caseKey(const Case& toothCase);

/// All that is to be seen around the tooth that is worked on, in the case's frame: the surfaces of the other teeth as
/// Tissue::neighbour, in their order, then the scenery.
[[nodiscard]] std::vector<Part> surroundings(const Case& toothCase);

/// Whether a surface that is seen from outside has the colours of a scan.
[[nodiscard]] bool isScannedInColour(const Case& toothCase);

/// Why a surface cannot be felt, or that it can: closed, oriented, sane in size, not crossing itself.
/// Throws core::Error with counts, the first place, and the command that mends it.
void requireSolid(const geometry::TriangleMesh& mesh, const std::string& where);

}  // namespace handpiece::cases
