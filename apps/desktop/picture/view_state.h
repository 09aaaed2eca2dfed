// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the picture widget holds; its events, its tools and its settings share it.

#include <QElapsedTimer>
#include <QPointer>
#include <QTimer>
#include <atomic>
#include <utility>

#include "desktop/picture/help_card.h"
#include "desktop/picture/overlay.h"
#include "desktop/picture/probe_thread.h"
#include "desktop/picture/render_thread.h"
#include "desktop/picture/section_bar.h"
#include "desktop/picture/strip_stack.h"
#include "desktop/picture/view_widget.h"

namespace handpiece::desktop {

/// What a held button or key makes of the pointer's moves.
enum class Drag { none, press, orbit, pan, pivot, section, mirror, landmark };

struct ViewWidget::State {
    explicit State(ViewWidget* of);
    ~State();

    ViewWidget* widget;
    std::shared_ptr<simulation::LiveTooth> tooth;
    core::Box bounds{core::Vec3::Zero(), core::Vec3::Zero()};     // of the tooth
    core::Box eyeBounds{core::Vec3::Zero(), core::Vec3::Zero()};  // of what of it is to be looked at
    view::Standing standing{1};
    std::vector<cases::Tissue> tissues;
    std::shared_ptr<const instrument::Bur> bur;
    std::unique_ptr<input::PointerController> hand;
    view::Look look;
    view::Camera camera;
    KeyBindings bindings;
    exercise::Permissions permissions;
    bool sectionBarShown = true;
    QString problem, remedy;  // why nothing is drawn
    QString waiting;          // for what, while there is no tooth
    bool isSketch = false;
    view::Camera firstEye;                 // as it was first seen
    std::optional<view::Camera> movedEye;  // as a person turned it, for what comes next
    std::optional<Frame> frame;
    bool everPressed = false, everTurned = false;

    // Tools.
    Tool tool = Tool::drill;
    bool compare = false;
    std::optional<view::Camera> wholeEye, halfEye;  // before the halves were fitted, and fitted to them
    std::optional<SectionPlace> section;
    SectionPlace lastSection;
    bool sectionPlaced = false;
    std::optional<view::Camera> beforeSection, facingSection;  // the eye, where it had to go round to see the section
    std::optional<core::Vec3> mirrorCentreMm, restMm;
    bool mirrorView = false;
    std::vector<ShownLandmark> landmarks;
    std::optional<core::Vec3> markMm;
    QString markWords;
    std::optional<LandmarkPoint> grabbed;
    std::vector<Measurement> measurements;
    std::optional<core::Vec3> calliperStartMm, pointerMm;
    std::optional<Measurement> reading, thinnest;
    measure::PulpLimits pulpLimits;

    // The pointer.
    Drag drag = Drag::none;
    int dragCode = 0;  // the button or key that ends it
    Binding::Kind dragKind = Binding::Kind::none;
    QPointF last;                    // where the pointer was
    std::optional<QPointF> pointer;  // over the widget
    std::optional<QPointF> cross;    // in the pointer's place, moved by keys; the mouse takes it away
    bool byMouse = false;            // the bur is where the pointer put it, not where keys moved it
    double wheelRest = 0.0;          // of a notch
    double lastStopMm = input::kFirstStopMm, lastPerPassMm = input::kFirstPerPassMm;

    QPointer<HelpCard> card;
    HelpCard::Commands commands;  // of the window, for the card
    SectionBar* sectionBar = nullptr;
    StripStack* strips = nullptr;
    std::atomic<bool> framePosted{false};
    QTimer watch;  // a hand on its way goes on where no picture is drawn, since nothing seen has changed
    QElapsedTimer followed;

    // Last: their threads call back into what stands above.
    std::unique_ptr<ProbeThread> probe;
    std::unique_ptr<RenderThread> render;

    void take(const cases::Case& toothCase, const core::Box& of);

    // Where things are.
    [[nodiscard]] view::Viewport viewport() const;  // of one picture
    [[nodiscard]] core::Vec2 pixel(const QPointF& position) const;
    /// As the hand has it: no mirror turns that over.
    [[nodiscard]] view::Camera handsEye() const;
    [[nodiscard]] std::optional<measure::Hit> hitAt(const QPointF& position) const;
    /// Behind tooth that is shown.
    [[nodiscard]] bool isHidden(const core::Vec3& pointMm) const;
    [[nodiscard]] std::vector<Measurement> measurementsSeen() const;
    [[nodiscard]] view::Look effectiveLook() const;
    [[nodiscard]] OverlayState overlay() const;
    [[nodiscard]] QString hint() const;
    [[nodiscard]] std::optional<view::MirrorPose> mirrorPose() const;
    [[nodiscard]] core::Vec3 burAxis() const;

    void takeKeptEye() {  // that was moved while there was only a sketch
        if (const auto moved = std::exchange(movedEye, std::nullopt)) {
            camera = *moved;
            eyeMoved();
        }
    }
    void turnHalf();  // the eye, for two pictures or for one again
    /// The section that is laid is seen: its other side is taken away, or the eye goes round to where it does not see
    /// it edge-on. Closed, it goes back, unless somebody has moved it meanwhile.
    void faceSection(SectionPlace& place);
    void turnFromSection();
    void wish();        // tells the drawing thread what is to be seen
    void eyeMoved();    // and the hand, and listeners
    void hoverAgain();  // under the pointer that stood still while the eye moved
    void followHand();
    void followSample(const messages::HapticSample& sample);
    void feelMouth();  // the hand, of this tooth, bur and what stands around
    void takeFrame();
    void layOut();
    [[nodiscard]] bool allows(exercise::Operation operation) const { return permissions.allows(operation); }
    /// The same; an exercise that forbids it is told of.
    [[nodiscard]] bool may(exercise::Operation operation);

    // Input (view_input.cpp; what tools do: view_tools.cpp).
    void begin(Drag what, const Binding& by);
    void end();
    void pressTool(const QPointF& position);
    void moveTo(const QPointF& position, Qt::KeyboardModifiers modifiers);
    void read(const QPointF& position);
    void turnWheel(const QWheelEvent& event);
    void dragBy(const QPointF& pixels);
    bool arrowsDrag(Action action, bool slow);
    void zoomBy(double notches, const QPointF& at);
    void stepLoad(double notches);
    void stepStop(double notches);
    void stepPerPass(double notches);
    void putCross(const QPointF& at);
    [[nodiscard]] bool measures() const;  // by points on the tooth
    bool pickByKeys(Action action, bool slow, bool repeated);
    bool keyAction(Action action, bool slow, bool repeated, const Binding& by);
    bool stepTool(Action action, bool slow);
    void nextMeasure();
    void moveSection(double byMm);
    void dragSection(const QPointF& from, const QPointF& to);
    void dragMirror(const QPointF& from, const QPointF& to);
    void hideLandmarks();  // those behind the tooth
    [[nodiscard]] std::optional<LandmarkPoint> landmarkAt(const QPointF& position) const;
    void dragLandmark(const QPointF& to);
    bool stepLandmark(Action action, bool slow);
    void updateCursor();
};

}  // namespace handpiece::desktop
