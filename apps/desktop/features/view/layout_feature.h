// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How the window looks: three layouts, colours, language, full screen, and what it stands on.

#include "desktop/framework/feature.h"

namespace handpiece::desktop {

class LayoutFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { practice, laboratory, paper, resetLayout, fullScreen, asDesktop, light, dark, about };
    explicit LayoutFeature(const FeatureContext& context);

  private:
    void connectLayouts();
    void connectThemes();
    void listLanguages();
    void showAbout();

    CommandSet<Command> commands_;
};

}  // namespace handpiece::desktop
