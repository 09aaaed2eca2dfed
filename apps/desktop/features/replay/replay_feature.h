// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Recordings: the one under way, and watching one.

#include "desktop/framework/feature.h"

namespace handpiece::desktop {

class ReplayBar;

class ReplayFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { open, watch, keep };
    explicit ReplayFeature(const FeatureContext& context);
    void showDocument() override;
    void showTick() override;

  private:
    void connectCommands();
    void showMarks();
    void keep();
    [[nodiscard]] static QString eventText(const std::string& name);

    CommandSet<Command> commands_;
    ReplayBar* bar_;
};

}  // namespace handpiece::desktop
