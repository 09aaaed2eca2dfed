// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/device/pedal_menu.h"

#include <QActionGroup>

#include "desktop/framework/mnemonics.h"

namespace handpiece::desktop {

PedalMenu::PedalMenu(Foot& foot, Settings& settings, Notices& notices, QWidget* window)
    : QObject(window),
      foot_(foot),
      settings_(settings),
      notices_(notices),
      menu_(withMnemonics(new QMenu(tr("Foot pedal"), window))) {
    menu_->setObjectName(QStringLiteral("menuPedal"));
    menu_->setToolTipsVisible(true);
    connect(menu_, &QMenu::aboutToShow, &foot_, &Foot::look);
    connect(&foot_, &Foot::changed, this, &PedalMenu::list);
    connect(&foot_, &Foot::changed, this, [this] {
        if (!foot_.isThere()) return;
        isAsked_ = false;
        notices_.takeBack(End::pedalThere);
    });
    connect(&foot_, &Foot::refused, this, [this](const QString&, const Problem& problem) {
        if (std::exchange(isAsked_, false))
            emit failed(problem);
        else
            notices_.tell(Notice::pedalAbsent, {problem.what, problem.remedy});
    });
    connect(&foot_, &Foot::unplugged, this, [this](const QString& name) { notices_.tell(Notice::pedalLost, {name}); });
    connect(&foot_, &Foot::back, this, [this] { notices_.remove(Notice::pedalLost); });
    list();
}

void PedalMenu::choose(const QString& name) {
    isAsked_ = !name.isEmpty();
    settings_.set(QStringLiteral("work/pedal"), name);
    notices_.takeBack(End::pedalThere);
    foot_.choose(name);
}

/// Made anew: what is connected changes.
void PedalMenu::list() {
    // The actions belong to the group and go with it.
    delete menu_->findChild<QActionGroup*>(QStringLiteral("pedalGroup"));
    menu_->clear();
    auto* group = new QActionGroup(menu_);
    group->setObjectName(QStringLiteral("pedalGroup"));
    const auto add = [this, group](const QString& object, const QString& name, const QString& text) {
        auto* action = new QAction(text, group);
        action->setObjectName(QStringLiteral("actionFoot_") + object);
        action->setToolTip(name.isEmpty() ? tr("The button alone is the pedal")
                                          : tr("Beside the button: the one that is pressed harder counts"));
        action->setStatusTip(action->toolTip());
        action->setCheckable(true);
        action->setChecked(foot_.wanted() == name);
        connect(action, &QAction::triggered, this, [this, name] { choose(name); });
        menu_->addAction(action);
    };
    add(QStringLiteral("none"), {}, tr("No foot pedal"));
    QStringList names = foot_.found();
    if (!foot_.wanted().isEmpty() && !names.contains(foot_.wanted())) names << foot_.wanted();
    for (qsizetype i = 0; i < names.size(); ++i)
        add(QString::number(i + 1), names[i],
            foot_.wanted() == names[i] && !foot_.isThere() ? tr("%1: not there").arg(names[i]) : names[i]);
}

}  // namespace handpiece::desktop
