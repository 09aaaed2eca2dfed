// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/mnemonics.h"

#include <QAction>
#include <QMenu>
#include <QRegularExpression>
#include <QSet>
#include <algorithm>
#include <optional>
#include <vector>

namespace handpiece::desktop {
namespace {

bool isLatin(QChar c) {
    return c.unicode() < 128 && c.isLetterOrNumber();
}

/// The letters of a text in the order in which one would like them: of words first.
std::vector<qsizetype> wished(const QString& text) {
    std::vector<qsizetype> places, others;
    for (qsizetype i = 0; i < text.size(); ++i) {
        if (!isLatin(text[i])) continue;
        const bool isFirst = i == 0 || !text[i - 1].isLetterOrNumber() || (text[i].isUpper() && text[i - 1].isLower());
        (isFirst ? places : others).push_back(i);
    }
    places.insert(places.end(), others.begin(), others.end());
    return places;
}

/// Of "actionSaveAs" and "menuFile" and "actionPanel_gaugeDock": what a person would call it.
QString nameOf(const QAction& action) {
    QString name = action.menu() != nullptr ? action.menu()->objectName() : action.objectName();
    name = name.mid(name.lastIndexOf(QLatin1Char('_')) + 1);
    for (const char* prefix : {"action", "menu"})
        if (name.startsWith(QLatin1String(prefix))) name = name.mid(static_cast<qsizetype>(qstrlen(prefix)));
    return name;
}

std::optional<qsizetype> firstFree(const QString& text, const QSet<QChar>& taken) {
    for (const qsizetype at : wished(text))
        if (!taken.contains(text[at].toUpper())) return at;
    return std::nullopt;
}

/// Before what says that a dialog comes.
QString withBracket(const QString& text, QChar letter) {
    const qsizetype end = text.endsWith(QLatin1String("...")) ? text.size() - 3
                          : text.endsWith(QChar(0x2026))      ? text.size() - 1
                                                              : text.size();
    return text.left(end) + QStringLiteral("(&%1)").arg(letter.toUpper()) + text.mid(end);
}

void give(QAction& action, QSet<QChar>& taken) {
    const QString text = withoutMnemonic(action.text());
    const bool isLatinText =
        std::all_of(text.begin(), text.end(), [](QChar c) { return !c.isLetter() || c.unicode() < 0x250; });
    if (const auto at = isLatinText ? firstFree(text, taken) : std::nullopt) {
        taken.insert(text[*at].toUpper());
        action.setText(menuText(text.left(*at)) + QLatin1Char('&') + menuText(text.mid(*at)));
        return;
    }
    for (const QString& from : {nameOf(action), QStringLiteral("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789")})
        if (const auto at = firstFree(from, taken)) {
            taken.insert(from[*at].toUpper());
            action.setText(withBracket(menuText(text), from[*at]));
            return;
        }
}

}  // namespace

QString withoutMnemonic(const QString& text) {
    static const QRegularExpression bracket(QStringLiteral("\\(&[A-Za-z0-9]\\)"));
    const QString without = QString(text).remove(bracket);
    QString plain;
    for (qsizetype i = 0; i < without.size(); ++i) {
        // Two of them are one that is seen.
        if (without[i] == QLatin1Char('&') && ++i == without.size()) break;
        plain += without[i];
    }
    return plain;
}

QString menuText(QString name) {
    return name.replace(QLatin1Char('&'), QLatin1String("&&"));
}

void giveMnemonics(const QList<QAction*>& entries) {
    QSet<QChar> taken;
    for (QAction* action : entries)
        if (!action->isSeparator() && action->isVisible()) give(*action, taken);
}

QMenu* withMnemonics(QMenu* menu) {
    QObject::connect(menu, &QMenu::aboutToShow, menu, [menu] { giveMnemonics(menu->actions()); });
    // And those that others list only now.
    QObject::connect(
        menu, &QMenu::aboutToShow, menu,
        [menu] {
            if (menu->isVisible()) giveMnemonics(menu->actions());
        },
        Qt::QueuedConnection);
    QObject::connect(menu, &QMenu::aboutToHide, menu, [menu] {
        for (QAction* action : menu->actions())
            if (!action->isSeparator()) action->setText(menuText(withoutMnemonic(action->text())));
    });
    return menu;
}

}  // namespace handpiece::desktop
