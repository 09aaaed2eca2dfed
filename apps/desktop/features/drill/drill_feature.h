// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The handpiece at work: bur, drive and speed, what the tooth feels like, how hard is pressed, undo, the keys that
/// hold it, and the first steps of a newcomer.

#include "desktop/features/drill/welcome_strip.h"
#include "desktop/framework/feature.h"
#include "handpiece/base/messages/haptic_sample.h"

namespace handpiece::desktop {

class DrillBar;
class ForceGauge;
class ParameterBox;

class DrillFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { undo, redo, reset, touch, cut, pedal, bindings, firstSteps };
    explicit DrillFeature(const FeatureContext& context);
    void showDocument() override;
    void showTick() override;

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    void addDocks();
    void connectCommands();
    void connectPanels();
    void connectWelcome();
    void keepShown();
    void recallBindings();
    void editBindings();
    void setTouching(bool touching);
    void tellStep(WelcomeStrip::Step step);
    void showFirstSteps();
    void showSettings();
    void keepSettings();
    void takeBack();
    [[nodiscard]] bool isComingOut() const;
    void takeBackNotices(const messages::HapticSample& sample);

    CommandSet<Command> commands_;
    DrillBar* bar_;
    ForceGauge* gauge_;
    ParameterBox* parameters_;
    WelcomeStrip* welcome_;
    bool wasOpen_ = false, wasCut_ = false;  ///< pulp and tooth, as last shown
    bool touching_ = false;
    bool hasMoved_ = false;                      ///< the mouse, over the picture
    int undosWhenOut_ = 0;                       ///< asked for while the bur comes out
    std::optional<WelcomeStrip::Step> gesture_;  ///< that is being dealt with: what moves the eye now
};

}  // namespace handpiece::desktop
