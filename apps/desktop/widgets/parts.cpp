// SPDX-License-Identifier: Apache-2.0
#include "desktop/widgets/parts.h"

#include <QEvent>
#include <QLocale>
#include <cmath>

#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

QLabel* heading(const QString& text, QWidget* parent) {
    auto* label = new QLabel(text, parent);
    label->setFont(scaledFont(parent->font(), 1.0, true));
    return label;
}

QLabel* note(const QString& text, QWidget* parent, const char* objectName) {
    auto* label = new QuietLabel(text, parent);
    label->setWordWrap(true);
    label->setFont(scaledFont(parent->font(), 0.9));
    if (objectName) label->setObjectName(QString::fromLatin1(objectName));
    return label;
}

QToolButton* iconButton(const QString& iconName, const char* objectName, const QString& name, QWidget* parent,
                        const QString& toolTip) {
    auto* button = named(new QToolButton(parent), objectName, name, toolTip);
    button->setIcon(icon(iconName));
    button->setIconSize({20, 20});
    button->setAutoRaise(true);
    button->setFocusPolicy(Qt::StrongFocus);
    return button;
}

QString quantity(double value, int decimals, const QString& unit) {
    return QLocale().toString(value, 'f', decimals) + QChar(0x00a0) + unit;
}

void QuietLabel::tint() {
    if (tinting_) return;
    tinting_ = true;
    // From the parent's palette: one's own would become paler with every change.
    const QPalette base = parentWidget() ? parentWidget()->palette() : palette();
    QPalette quiet = base;
    quiet.setColor(QPalette::Active, QPalette::WindowText, tonesOf(base).quiet);
    quiet.setColor(QPalette::Inactive, QPalette::WindowText, tonesOf(base).quiet);
    setPalette(quiet);
    tinting_ = false;
}

void QuietLabel::changeEvent(QEvent* event) {
    if (event->type() == QEvent::PaletteChange) tint();
    QLabel::changeEvent(event);
}

void QuietLabel::showEvent(QShowEvent* event) {
    tint();
    QLabel::showEvent(event);
}

double niceStep(double span, int count) {
    if (!(span > 0) || count < 1) return 1.0;
    const double rough = span / count, power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (rough <= factor * power * 1.0001) return factor * power;
    return 10.0 * power;
}

QString rpmText(double rpm) {
    const double step = rpm >= 100000 ? 1000 : rpm >= 1000 ? 100 : 10;
    return QLocale().toString(std::llround(rpm / step) * static_cast<long long>(step));
}

}  // namespace handpiece::desktop
