// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Radiographs in the window: one command, one dialog.

#include "desktop/framework/feature.h"

namespace handpiece::desktop {

class RadiographDialog;

class RadiographFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { radiograph };
    explicit RadiographFeature(const FeatureContext& context);
    void showDocument() override;

  private:
    void save();

    CommandSet<Command> commands_;
    RadiographDialog* dialog_;
};

}  // namespace handpiece::desktop
