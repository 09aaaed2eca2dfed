// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The paper's stroboscope pictures in three dimensions: one exposure of the tooth for each place of the bur.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "handpiece/model/tooth/state_delta.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "studies/stroboscope.h"

namespace handpiece::studies {

/// A tooth, cut open at the plane of the tips, with the bur at each of them; drawn by the window's renderer.
/// Writes the picture to `file` and says nothing, or says why there is no OpenGL; then nothing is written. Throws
/// core::Error without tips and for a file that cannot be written.
[[nodiscard]] std::string writeStroboscope(const std::shared_ptr<const tooth::ToothModel>& uncut,
                                           const tooth::StateDelta& state, const instrument::Bur& bur,
                                           const Stroboscope& shot, const std::filesystem::path& file);

}  // namespace handpiece::studies
