// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/commands.h"

#include <QCoreApplication>
#include <QWidgetAction>
#include <algorithm>

#include "desktop/widgets/icon_factory.h"

namespace handpiece::desktop {
namespace {

QString words(const char* source) {
    return QCoreApplication::translate("Commands", source);
}

QString tipOf(const QAction& action) {
    return QStringLiteral("%1 (%2)").arg(action.statusTip(), action.shortcut().toString(QKeySequence::NativeText));
}

}  // namespace

Commands::Commands(QWidget* window) : QObject(window), window_(window) {}

QAction* Commands::add(const CommandRow& row) {
    auto* action = new QAction(words(row.text), window_);
    action->setObjectName(QLatin1String(row.name));
    action->setShortcut(QKeySequence(QLatin1String(row.keys)));
    action->setIcon(icon(QLatin1String(row.icon)));
    action->setCheckable(row.isCheckable);
    action->setStatusTip(words(row.tip));
    action->setToolTip(tipOf(*action));
    if (row.briefText) action->setIconText(words(row.briefText));
    window_->addAction(action);
    ordered_ << action;
    if (row.operation) rules_[action].operation = row.operation;
    for (const Place& at : row.places)
        if (at.shelf != Shelf::none) place(at, action);
    if (row.cardPlace > 0) card_.emplace_back(row.cardPlace, action);
    return action;
}

void Commands::enableWhile(QAction* action, std::function<bool()> can) {
    rules_[action].can = std::move(can);
}

void Commands::refresh(const exercise::Permissions& permissions) {
    for (auto rule = rules_.cbegin(); rule != rules_.cend(); ++rule) {
        QAction* action = rule.key();
        const auto& operation = rule->operation;
        action->setEnabled((!rule->can || rule->can()) && (!operation || permissions.allows(*operation)));
        if (operation)
            action->setToolTip(!permissions.locks(*operation) ? tipOf(*action)
                               : permissions.isExam()
                                   ? words(QT_TRANSLATE_NOOP("Commands", "Not in this exam."))
                                   : words(QT_TRANSLATE_NOOP("Commands", "Locked by this exercise.")));
    }
}

QAction* Commands::placeWidget(const Place& where, QWidget* widget) {
    auto* action = new QWidgetAction(window_);
    action->setDefaultWidget(widget);
    place(where, action);
    return action;
}

std::vector<Commands::Placed> Commands::on(Shelf shelf) const {
    std::vector<Placed> found;
    for (const Placed& placed : placed_)
        if (placed.place.shelf == shelf) found.push_back(placed);
    std::stable_sort(found.begin(), found.end(),
                     [](const Placed& a, const Placed& b) { return a.place.at < b.place.at; });
    return found;
}

std::vector<QAction*> Commands::onCard() const {
    auto sorted = card_;
    std::sort(sorted.begin(), sorted.end());
    std::vector<QAction*> actions;
    for (const auto& [place, action] : sorted)
        actions.push_back(action);
    return actions;
}

}  // namespace handpiece::desktop
