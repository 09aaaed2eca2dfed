// SPDX-License-Identifier: Apache-2.0
#include "desktop/program/widget_map.h"

#include <QAbstractButton>
#include <QAbstractItemView>
#include <QAbstractSpinBox>
#include <QApplication>
#include <QComboBox>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QMenuBar>
#include <QMessageBox>
#include <QMetaEnum>
#include <QPlainTextEdit>
#include <QSaveFile>
#include <QStatusBar>
#include <QTabBar>
#include <QTimer>
#include <QToolBar>
#include <utility>

namespace handpiece::desktop {
namespace {

constexpr int kEveryMs = 200;

/// The buttons of a question have none: what they stand for, in any language.
QString nameOf(const QWidget& widget) {
    const QString name = widget.objectName();
    const auto* button = qobject_cast<const QAbstractButton*>(&widget);
    const auto* box = qobject_cast<const QMessageBox*>(widget.window());
    if (!name.isEmpty() || button == nullptr || box == nullptr) return name;
    const auto standard = box->standardButton(const_cast<QAbstractButton*>(button));
    if (standard == QMessageBox::NoButton) return name;
    return QLatin1String("button/") +
           QString::fromLatin1(QMetaEnum::fromType<QMessageBox::StandardButtons>().valueToKey(standard));
}

struct Map {
    QJsonObject places, texts;
    QJsonArray on, off, windows;

    void place(const QString& name, const QWidget& in, const QRect& area) {
        const QPoint at = in.mapToGlobal(area.topLeft());
        const double ratio = in.devicePixelRatioF();
        places.insert(name, QJsonArray{at.x() * ratio, at.y() * ratio, area.width() * ratio, area.height() * ratio});
    }

    void addAction(const QAction& action, const QWidget& in, const QRect& area) {
        const QString name = action.menu() != nullptr ? action.menu()->objectName() : action.objectName();
        if (name.isEmpty()) return;
        place(name, in, area);
        texts.insert(name, action.text());
        if (action.isChecked()) on.append(name);
        if (!action.isEnabled()) off.append(name);
    }

    void add(const QWidget& widget) {
        const QString name = nameOf(widget);
        if (widget.isWindow())
            windows.append(name.isEmpty() ? QString::fromLatin1(widget.metaObject()->className()) : name);
        if (const auto* menu = qobject_cast<const QMenu*>(&widget))
            for (QAction* action : menu->actions())
                addAction(*action, *menu, menu->actionGeometry(action));
        if (const auto* bar = qobject_cast<const QMenuBar*>(&widget))
            for (QAction* action : bar->actions())
                addAction(*action, *bar, bar->actionGeometry(action));
        if (const auto* bar = qobject_cast<const QToolBar*>(&widget))
            for (QAction* action : bar->actions())
                if (const QWidget* button = bar->widgetForAction(action); button != nullptr && button->isVisible())
                    addAction(*action, *button, button->rect());
        if (const auto* tabs = qobject_cast<const QTabBar*>(&widget))
            for (int i = 0; i < tabs->count(); ++i)
                place(QStringLiteral("tab/") + tabs->tabText(i), *tabs, tabs->tabRect(i));
        if (name.isEmpty() || name.startsWith(QLatin1String("qt_"))) return;
        place(name, widget, widget.rect());
        QString text = widget.accessibleDescription();
        if (const auto* label = qobject_cast<const QLabel*>(&widget)) text = label->text();
        if (const auto* line = qobject_cast<const QLineEdit*>(&widget)) text = line->text();
        if (const auto* edit = qobject_cast<const QPlainTextEdit*>(&widget)) text = edit->toPlainText();
        if (const auto* spin = qobject_cast<const QAbstractSpinBox*>(&widget)) text = spin->text();
        if (const auto* box = qobject_cast<const QComboBox*>(&widget)) text = box->currentText();
        if (const auto* button = qobject_cast<const QAbstractButton*>(&widget)) {
            text = button->text();
            if (button->isChecked()) on.append(name);
        }
        if (const auto* bar = qobject_cast<const QStatusBar*>(&widget)) text = bar->currentMessage();
        if (widget.isWindow()) text = widget.windowTitle();
        texts.insert(name, text);
        if (!widget.isEnabled()) off.append(name);
        if (const auto* list = qobject_cast<const QAbstractItemView*>(&widget)) addCells(name, *list);
    }

    void addCells(const QString& name, const QAbstractItemView& list) {
        const QAbstractItemModel* model = list.model();
        const QRect window = list.viewport()->rect();
        for (int row = 0; model != nullptr && row < model->rowCount(list.rootIndex()); ++row) {
            const QModelIndex cell = model->index(row, 0, list.rootIndex());
            const QRect area = list.visualRect(cell);
            if (window.contains(area.center()))
                place(name + QLatin1Char('/') + cell.data().toString(), *list.viewport(), area);
        }
    }
};

QByteArray mapNow(const std::function<QJsonObject()>& hand) {
    Map map;
    for (const QWidget* widget : QApplication::allWidgets())
        if (widget->isVisible() && !widget->visibleRegion().isEmpty()) map.add(*widget);
    QJsonObject all{
        {"places", map.places}, {"texts", map.texts}, {"on", map.on}, {"off", map.off}, {"windows", map.windows}};
    if (hand) all.insert("hand", hand());
    return QJsonDocument(all).toJson(QJsonDocument::Compact);
}

}  // namespace

void writeWidgetMap(QObject* parent, const QString& file, std::function<QJsonObject()> hand) {
    auto* timer = new QTimer(parent);
    QObject::connect(timer, &QTimer::timeout, parent, [file, hand = std::move(hand)] {
        QSaveFile out(file);
        if (!out.open(QIODevice::WriteOnly)) return;
        out.write(mapNow(hand));
        out.commit();
    });
    timer->start(kEveryMs);
}

}  // namespace handpiece::desktop
