// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What several commands take alike: a tooth, a bur, a contact method.

#include <memory>
#include <string>

#include "cli/cli.h"
#include "cli/command.h"
#include "handpiece/app/course/shipped_exercises.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/tick/contact/field_method.h"

namespace handpiece::cli {

/// The unit of meshes that are given as files.
struct MeshUnit {
    std::string name = "mm";
    double scale = 1.0;  ///< besides

    [[nodiscard]] double mmPerUnit() const;
    /// A mesh file in millimetres; what was left out of it is told, and goes to `notes` besides. Throws core::Error.
    [[nodiscard]] geometry::TriangleMesh read(const std::string& file, geometry::ReadNotes* notes = nullptr) const;
    /// The same with the colours that a scanner saw.
    [[nodiscard]] geometry::ColouredMesh readColoured(const std::string& file,
                                                      geometry::ReadNotes* notes = nullptr) const;
};
/// An option that takes a unit of length.
void addLengthUnit(Command& command, const char* name, std::string& unit, const char* help);
/// --unit, and --scale where that is not an arm's.
void addUnitOptions(Command& command, MeshUnit& unit, bool withScale = true);

/// A bur by name, or a mesh file in a unit.
struct BurInput {
    std::string name = "330", unit = "mm";

    [[nodiscard]] double mmPerUnit() const;
};
/// --bur and --bur-unit.
void addBurOption(Command& command, BurInput& bur);

struct ContactInputs {
    MeshUnit unit;  ///< of a tooth that is a mesh file
    std::string tooth, method = "field";
    BurInput bur;
    double voxelUm = 50.0;
    bool noCache = false;
    std::size_t threads = 0;
};

/// --tooth, --unit, --bur, --method, --voxel, --no-cache, --threads.
void addContactOptions(Command& command, ContactInputs& inputs, const MethodRegistry& methods);

/// The case; one that is a mesh file in its unit. Throws core::Error.
[[nodiscard]] cases::Case readToothOf(const ContactInputs& inputs);
/// Voxel, bands and cache as asked for; sets the number of threads. Throws core::Error for values out of range.
[[nodiscard]] tooth::LoadSettings prepareSettingsOf(const ContactInputs& inputs);
/// Reads or reopens the tooth, with a progress bar. Throws core::Error.
[[nodiscard]] std::shared_ptr<const tooth::ToothModel> loadTooth(const ContactInputs& inputs);
/// A name of the catalogue, SHAPE:DxL, or a mesh file.
[[nodiscard]] std::shared_ptr<const instrument::Bur> loadBur(const BurInput& bur);
/// An exercise's folder or .handpiece file, or the id of one that comes along: that is made first, in the user's cache
/// folder, with a progress bar. Throws core::Error.
[[nodiscard]] course::Made exerciseOf(const std::string& given);
/// By name: field, hull or a registered one; throws core::Error naming those there are.
[[nodiscard]] std::unique_ptr<contact::Method> makeMethod(const std::string& name, const MethodRegistry& extra,
                                                          std::shared_ptr<const tooth::ToothModel> tooth,
                                                          std::shared_ptr<const instrument::Bur> bur);

}  // namespace handpiece::cli
