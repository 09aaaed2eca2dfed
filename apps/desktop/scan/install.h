// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Brings "New case from scan" into the window.

#include <QString>

namespace handpiece::desktop {

class MainWindow;
class ScanWizard;

/// Makes the window's action open the wizard; "Try it now" opens the case in the window. The wizard belongs to the
/// window.
void installScanWizard(MainWindow& window);

}  // namespace handpiece::desktop
