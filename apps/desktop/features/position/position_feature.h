// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From where and how one works: the operator's position, by mirror, with a finger rest. Each change is in the record.

#include "desktop/framework/feature.h"

namespace handpiece::desktop {

class PositionPanel;

class PositionFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { mirrorView, fingerRest };
    explicit PositionFeature(const FeatureContext& context);
    void showDocument() override;

  private:
    void sit(int hour);
    void tellRecord();

    CommandSet<Command> commands_;
    PositionPanel* panel_;
    int hour_ = 0;
    std::optional<core::Vec3> restMm_;  ///< there is one for this tooth
};

}  // namespace handpiece::desktop
