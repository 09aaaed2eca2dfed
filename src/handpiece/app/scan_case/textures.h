// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Meshes whose colours lie in JPEG and PNG pictures beside them.

namespace handpiece::scan_case {

/// From now on this process reads them (geometry::readColouredMesh). Programs that open meshes say so as they begin.
void readTextures();

}  // namespace handpiece::scan_case
