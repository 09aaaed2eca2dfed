// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// "New case from scan" in the window: the wizard, and what it opens.

#include <QPointer>

#include "desktop/features/scan/scan_wizard.h"
#include "desktop/framework/feature.h"

namespace handpiece::desktop {

class ScanFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { anew };
    explicit ScanFeature(const FeatureContext& context);

  private:
    /// The wizard at this file or folder, or (empty) none. It belongs to the window.
    void open(const QString& path = {});

    CommandSet<Command> commands_;
    QPointer<ScanWizard> wizard_;
};

}  // namespace handpiece::desktop
