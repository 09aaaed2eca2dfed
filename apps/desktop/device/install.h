// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Brings the dialogs about devices into the window.

namespace handpiece::desktop {

class MainWindow;
class Settings;
class Simulator;

/// Makes the window's menu open them. They belong to the window. `realTime`: of the block that is felt.
void installDeviceDialogs(MainWindow& window, Simulator& simulator, Settings& settings, bool realTime);

}  // namespace handpiece::desktop
