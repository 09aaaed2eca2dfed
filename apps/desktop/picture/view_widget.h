// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The picture: shows the tooth under the bur, turns mouse and keys into the hand's wishes, and measures.

#include <QImage>
#include <QWidget>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "desktop/picture/help_card.h"
#include "desktop/picture/key_bindings.h"
#include "desktop/picture/latency.h"
#include "desktop/picture/measuring.h"
#include "desktop/picture/overlay.h"
#include "desktop/picture/strip_stack.h"
#include "handpiece/app/exercise/permissions.h"
#include "handpiece/app/input/pointer_controller.h"
#include "handpiece/app/input/working_position.h"
#include "handpiece/app/simulation/live_session.h"
#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/senses/view/camera.h"
#include "handpiece/senses/view/look.h"
#include "handpiece/senses/view/renderer.h"
#include "handpiece/tick/device/pointer_device.h"

namespace handpiece::desktop {

struct OverlayState;

/// A widget for one tooth at a time. It draws in a thread of its own, only when something has changed, and never waits
/// for the tick. Without OpenGL it says so in its place, and all the rest goes on.
class ViewWidget : public QWidget {
    Q_OBJECT
  public:
    explicit ViewWidget(QWidget* parent = nullptr);
    ~ViewWidget() override;

    // What is shown.

    /// Another tooth, with the neighbours of its case. `feed`: a sitting's samples, this widget is its one reader; null
    /// in a replay, where setSample() says where the bur is. Takes pointer and measurements away, fits the camera.
    void setTooth(std::shared_ptr<simulation::LiveTooth> liveTooth, std::shared_ptr<const cases::Case> toothCase,
                  std::shared_ptr<simulation::SampleFeed> feed);
    /// Until another tooth, instead of how it stands in the mouth: in an arm's reach crowns are up, and what the hand
    /// does is to be seen the same way round.
    void setStanding(const view::Standing& standing);
    [[nodiscard]] const view::Standing& standing() const;
    /// Something to look at and to turn until the tooth is there. An eye that was moved stays where it is, also for the
    /// tooth itself.
    void showSketch(const cases::Case& sketch);
    [[nodiscard]] bool hasSketch() const;
    /// The next tooth is looked at as this one is, where somebody turned it.
    void keepEye();
    /// What is said where there is no tooth yet; empty: that none is open.
    void setWaiting(const QString& forWhat);
    void clearTooth();
    [[nodiscard]] bool hasTooth() const;
    /// Mouse and keyboard move the bur from now on. Null: they only turn the view (replay, or a real device).
    void setPointer(std::shared_ptr<device::PointerMailbox> mailbox, const core::Pose& start);
    /// For load, stop and pedal; null without a pointer. Prefer setLoad() and setStop(), which tell listeners.
    [[nodiscard]] input::PointerController* hand() const;
    void setSample(const messages::HapticSample& sample);
    /// Translucent surfaces over the tooth, until another one; none: away with them.
    void setGlass(std::vector<view::GlassSurface> surfaces);
    /// Gingiva that was cut bleeds in the picture until then, or until another tooth.
    void clearBlood();
    [[nodiscard]] bool isBleeding() const;
    /// The newest sample this widget has seen.
    [[nodiscard]] messages::HapticSample sample() const;
    void setBur(std::shared_ptr<const instrument::Bur> bur);
    /// In the bur frame; an empty mesh for none. Not drawn while its head would hide the tip from the eye.
    void setTurbine(const geometry::TriangleMesh& mesh);

    void setLook(const view::Look& look);
    [[nodiscard]] const view::Look& look() const;
    void setCamera(const view::Camera& camera);
    [[nodiscard]] const view::Camera& camera() const;
    void showStandardView(view::StandardView standardView);
    /// As the operator sees it there; the handle turns to the hand.
    void sitAt(const input::WorkingPosition& position);
    /// Only a mirror's picture is seen, left and right changed over; the hand moves as it does.
    void setMirrorView(bool on);
    [[nodiscard]] bool isMirrorView() const;
    /// A finger finds support there; none: nowhere.
    void setRest(std::optional<core::Vec3> pointMm);
    void fitTooth();
    /// The same direction, near the bur.
    void goToBur();

    // Tools.

    void setTool(Tool tool);
    [[nodiscard]] Tool tool() const;
    /// Before and after side by side; one eye for both, which shows the tooth in each half and afterwards is as near as
    /// before.
    void setCompare(bool compare);
    [[nodiscard]] bool isComparing() const;
    /// The section stays while one cuts; none takes it away. Tool::section turns it on.
    void setSection(std::optional<SectionPlace> place);
    [[nodiscard]] std::optional<SectionPlace> section() const;
    void setMirrorShown(bool shown);
    [[nodiscard]] bool isMirrorShown() const;
    void clearMeasurements();
    /// Landmarks over the picture; with Tool::landmarks one is moved by pressing on it, or by the arrow keys.
    void setLandmarks(std::vector<ShownLandmark> landmarks);
    [[nodiscard]] const std::vector<ShownLandmark>& landmarks() const;
    /// That the keys move; none: they move nothing.
    void grabLandmark(std::optional<LandmarkPoint> at);
    [[nodiscard]] std::optional<LandmarkPoint> grabbedLandmark() const;
    /// A ring about a place of the tooth with what is to be said of it, until another tooth; none: away with it.
    void setMark(std::optional<core::Vec3> placeMm, const QString& words = {});
    /// From which thickness over the pulp on a reading is green, and under which it is red.
    void setPulpLimits(const measure::PulpLimits& limits);
    /// All that is written and drawn on the picture now.
    [[nodiscard]] OverlayState written() const;
    /// What is not allowed goes away and stays away, whoever asks for it.
    void setPermissions(const exercise::Permissions& permissions);
    [[nodiscard]] const exercise::Permissions& permissions() const;
    /// The bar by which a section is placed; without it somebody else has such controls.
    void setSectionBarShown(bool shown);
    /// Shown over the picture, which keeps its size: messages, progress.
    void addStrip(QWidget* strip, StripStack::Where where = StripStack::Where::above);

    // The pointer's settings.

    void setLoad(double loadN);
    void setStop(std::optional<double> depthMm);
    /// How deep one stroke goes; none: as deep as the load takes it. Kept for the next hand.
    void setPerPass(std::optional<double> depthMm);
    void latchPedal(bool down);
    void setBindings(const KeyBindings& bindings);
    [[nodiscard]] const KeyBindings& bindings() const;
    /// Pedal up, bur lifted: for a window that is closed or minimised.
    void escape();

    /// The window's own commands that the card of keys tells as well.
    void setHelpCommands(const HelpCard::Commands& commands);
    /// The card of keys and buttons, as they are bound, over the whole window; again: away with it.
    void toggleHelpCard();
    /// What is seen, with all that is written on it.
    [[nodiscard]] QImage snapshot();
    /// The tooth as it was drawn last, with nothing written on it; shared, not copied. Null: nothing is drawn.
    [[nodiscard]] QImage picture() const;
    [[nodiscard]] LatencyReport latency() const;
    void resetLatency();
    /// As it is drawn: look() without what is not allowed.
    [[nodiscard]] view::Look shownLook() const;
    /// What draws, as Renderer::description(); empty until the first picture, and without OpenGL.
    [[nodiscard]] QString rendererDescription() const;

    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override;

  signals:
    void cameraChanged();
    void lookChanged();
    void loadChanged(double loadN);
    void stopChanged(std::optional<double> depthMm);
    void perPassChanged(std::optional<double> depthMm);
    void pedalLatched(bool down);
    void pressedChanged(bool pressed);
    void measured(const handpiece::desktop::Measurement& measurement);
    void frameDrawn(const handpiece::view::FrameReport& report);
    void openGlMissing(const QString& what, const QString& remedy);
    void burStepRequested(int step);
    void speedStepRequested(int step);
    void helpRequested();
    void toolChanged(handpiece::desktop::Tool tool);
    void compareChanged(bool compare);
    void sectionChanged(bool shown);  ///< it came, went or was moved
    void mirrorChanged(bool shown);
    void mirrorViewChanged(bool on);
    void restChanged(bool there);
    void landmarkGrabbed(std::size_t landmark);
    /// To this place: of the surface under the pointer; for what lies inside as far from the eye as it was.
    void landmarkDragged(handpiece::desktop::LandmarkPoint at, const handpiece::core::Vec3& toMm);
    void landmarkDropped();
    void refused(handpiece::exercise::Operation operation);  ///< the exercise locks it

  protected:
    bool event(QEvent* event) override;
    void paintEvent(QPaintEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void keyReleaseEvent(QKeyEvent* event) override;
    void focusOutEvent(QFocusEvent* event) override;
    void enterEvent(QEnterEvent* event) override;
    void leaveEvent(QEvent* event) override;
    void showEvent(QShowEvent* event) override;
    void hideEvent(QHideEvent* event) override;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::desktop
