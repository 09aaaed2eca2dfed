// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/position/position_feature.h"

#include "desktop/features/position/position_panel.h"
#include "desktop/work/simulator.h"
#include "handpiece/app/input/working_position.h"

namespace handpiece::desktop {
namespace {

using Command = PositionFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::mirrorView, "actionMirrorView", QT_TRANSLATE_NOOP("Commands", "Work by mirror"),
     QT_TRANSLATE_NOOP("Commands", "See only the mirror's picture: left and right are changed over, the hand is not"),
     "mirror", "Ctrl+Shift+V", in(Shelf::tools, 16), kCheckable, exercise::Operation::mirrorView},
    {Command::fingerRest, "actionFingerRest", QT_TRANSLATE_NOOP("Commands", "Finger rest"),
     QT_TRANSLATE_NOOP("Commands", "Support the hand on the nearest other tooth: it moves less and turns about there"),
     "touch", "Ctrl+Shift+F", in(Shelf::tools, 17), kCheckable},
};

}  // namespace

PositionFeature::PositionFeature(const FeatureContext& context)
    : Feature(context), commands_(window_.commands(), kCommands), panel_(new PositionPanel) {
    window_.docks().add({"positionDock",
                         tr("Working position"),
                         35,
                         {{Detail::laboratory, Qt::LeftDockWidgetArea, 35, 700, "drillDock"}}},
                        panel_);
    connect(panel_, &PositionPanel::chosen, this, &PositionFeature::sit);
    on(commands_[Command::mirrorView], [this] { view_.setMirrorView(commands_[Command::mirrorView]->isChecked()); });
    on(commands_[Command::fingerRest], [this] {
        const bool wanted = commands_[Command::fingerRest]->isChecked();
        view_.setRest(wanted ? restMm_ : std::nullopt);
    });
    connect(&view_, &ViewWidget::mirrorViewChanged, this, [this](bool on) {
        commands_[Command::mirrorView]->setChecked(on);
        tellRecord();
    });
    connect(&view_, &ViewWidget::restChanged, this, [this](bool there) {
        commands_[Command::fingerRest]->setChecked(there);
        tellRecord();
    });
    window_.commands().enableWhile(commands_[Command::mirrorView],
                                   [this] { return simulator_.mode() != Simulator::Mode::empty; });
    window_.commands().enableWhile(commands_[Command::fingerRest], [this] { return simulator_.mailbox() && restMm_; });
}

void PositionFeature::showDocument() {
    hour_ = 0;
    panel_->setHour(0);
    // An exercise may be for work by mirror; each recording says so from its beginning.
    view_.setMirrorView(simulator_.permissions().locks(exercise::Operation::directView));
    commands_[Command::mirrorView]->setChecked(view_.isMirrorView());
    const auto& toothCase = simulator_.toothCase();
    restMm_ = toothCase ? input::fingerRest(*toothCase) : std::nullopt;
    if (toothCase)
        panel_->setTooth(toothCase->fdiNumber, input::headInCase(*toothCase).has_value());
    else
        panel_->setTooth(0, false);
    // From its beginning each recording says how one works: what it does not tell, nobody can measure.
    tellRecord();
}

void PositionFeature::sit(int hour) {
    const auto& toothCase = simulator_.toothCase();
    const auto head = toothCase ? input::headInCase(*toothCase) : std::nullopt;
    if (!head) return;
    view_.sitAt(input::workingPosition(*head, toothCase->fdiNumber < 30, hour));
    hour_ = hour;
    panel_->setHour(hour);
    tellRecord();
}

void PositionFeature::tellRecord() {
    simulator_.noteWorkingWay(hour_, view_.isMirrorView(), commands_[Command::fingerRest]->isChecked());
}

}  // namespace handpiece::desktop
