// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// 3Dconnexion SpaceMouse: six axes without force, through the free daemon spacenavd, whose socket is spoken to
/// directly (HANDPIECE_SPNAV_SOCKET names another). Never tried on hardware: docs/devices/spacemouse.md.

#include <memory>

#include "handpiece/devices/drivers/catalogue.h"

namespace handpiece::drivers {

[[nodiscard]] Found lookSpaceMouse();
/// The daemon has one device, whatever OpenOptions::which says. Throws core::Error.
[[nodiscard]] std::unique_ptr<link::Driver> openSpaceMouse(const OpenOptions& options);

}  // namespace handpiece::drivers
