// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What several commands take alike: a tooth, a bur, a contact method.

#include <memory>
#include <string>

#include "cli/cli.h"
#include "handpiece/tick/contact/field_method.h"

namespace CLI {
class App;
}

namespace handpiece::cli {

struct ContactInputs {
    std::string tooth, bur = "330", method = "field";
    double voxelUm = 50.0;
    bool noCache = false;
    std::size_t threads = 0;
};

/// --tooth, --bur, --method, --voxel, --no-cache, --threads.
void addContactOptions(CLI::App& command, ContactInputs& inputs, const MethodRegistry& methods);

/// Voxel, bands and cache as asked for; sets the number of threads. Throws core::Error for values out of range.
[[nodiscard]] tooth::PrepareSettings prepareSettingsOf(const ContactInputs& inputs);
/// Reads or reopens the tooth, with a progress bar. Throws core::Error.
[[nodiscard]] std::shared_ptr<const tooth::Tooth> loadTooth(const ContactInputs& inputs);
/// A name of the catalogue, SHAPE:DxL, or a mesh file.
[[nodiscard]] std::shared_ptr<const instrument::Bur> loadBur(const std::string& nameOrFile);
/// By name: field, hull or a registered one; throws core::Error naming those there are.
[[nodiscard]] std::unique_ptr<contact::Method> makeMethod(const std::string& name, const MethodRegistry& extra,
                                                          std::shared_ptr<const tooth::Tooth> tooth,
                                                          std::shared_ptr<const instrument::Bur> bur);

/// The lowest point of a straight drop: how far (mm) the bur at `start` can move along `direction` until it touches.
/// Throws core::Error when it meets nothing within `reachMm`.
[[nodiscard]] double distanceToTouch(contact::Method& method, const core::Pose& start, const core::Vec3& direction,
                                     double reachMm);

}  // namespace handpiece::cli
