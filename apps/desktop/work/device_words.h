// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What holds the handpiece, for a person.

#include <QString>

namespace handpiece::desktop {

class Simulator;

/// A device is there and the tooth is under it.
[[nodiscard]] bool holdsDevice(const Simulator& simulator);
/// Devices of makers keep the names they have.
[[nodiscard]] QString deviceInHand(const Simulator& simulator);

}  // namespace handpiece::desktop
