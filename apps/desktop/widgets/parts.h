// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Small things that several panels are made of.

#include <QLabel>
#include <QString>
#include <QToolButton>

class QHBoxLayout;

namespace handpiece::desktop {

/// Sets what a test finds a widget by, what a screen reader says and what the mouse shows.
template <class W>
W* named(W* widget, const char* objectName, const QString& accessibleName, const QString& toolTip = {}) {
    widget->setObjectName(QString::fromLatin1(objectName));
    widget->setAccessibleName(accessibleName);
    widget->setToolTip(toolTip.isEmpty() ? accessibleName : toolTip);
    return widget;
}
/// A heading within a panel.
[[nodiscard]] QLabel* heading(const QString& text, QWidget* parent);
/// A quieter, wrapping line.
[[nodiscard]] QLabel* note(const QString& text, QWidget* parent, const char* objectName = nullptr);
/// A flat button with an icon.
[[nodiscard]] QToolButton* iconButton(const QString& iconName, const char* objectName, const QString& name,
                                      QWidget* parent, const QString& toolTip = {});
/// "0.5 mm", "1.25 N": a number in the locale with its unit.
[[nodiscard]] QString quantity(double value, int decimals, const QString& unit);

/// A label in the palette's quiet tone, which follows light and dark.
class QuietLabel : public QLabel {
    Q_OBJECT
  public:
    using QLabel::QLabel;

  protected:
    void changeEvent(QEvent* event) override;
    void showEvent(QShowEvent* event) override;

  private:
    void tint();
    bool tinting_ = false;
};

/// Steps of 1, 2 or 5 times a power of ten, so that about `count` fill `span`.
[[nodiscard]] double niceStep(double span, int count);
/// Drawn digits grouped by the locale: "212,000"; rounded to about three digits so that it reads calmly.
[[nodiscard]] QString rpmText(double rpm);

}  // namespace handpiece::desktop
