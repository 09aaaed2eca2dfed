// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How the tooth is looked at: standard views, looks, mirror and comparison, the card of keys; the eye's place is kept
/// by tooth.

#include <QTimer>

#include "desktop/framework/feature.h"

namespace handpiece::desktop {

class ViewBar;

class ViewFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command {
        occlusal,
        buccal,
        lingual,
        mesial,
        distal,
        oblique,
        fit,
        goToBur,
        mirror,
        compare,
        help,
        guide
    };
    explicit ViewFeature(const FeatureContext& context);
    void showDocument() override;
    void showTick() override;

  private:
    void addViewsButton();
    void connectEye();
    void recallLook();
    void keepLook(const view::Look& look);
    void rememberEye();
    void recallEye();
    [[nodiscard]] bool isByArm() const;
    [[nodiscard]] core::Pose heldPose() const;

    CommandSet<Command> commands_;
    ViewBar* bar_;
    QTimer eyeTimer_, turnTimer_;
    core::Quat keptTurn_ = core::Quat::Identity();
    bool hasPicture_ = false;
};

}  // namespace handpiece::desktop
