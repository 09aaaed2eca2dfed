// SPDX-License-Identifier: Apache-2.0
#include "desktop/widgets/legend.h"

#include <QLocale>
#include <QPainter>

#include "desktop/widgets/notation.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

Legend::Legend(QWidget* parent) : QWidget(parent) {
    setObjectName("legend");
    setAccessibleName(tr("Legend"));
    setToolTip(tr("What the colours mean"));
}

void Legend::setEntries(const std::vector<view::LegendEntry>& entries) {
    entries_ = entries;
    QStringList names;
    for (const auto& entry : entries_)
        names << tissueName(entry.tissue);
    setAccessibleDescription(names.join(", "));
    updateGeometry();
    update();
}

void Legend::setDepthScale(double mostMm, const std::vector<std::array<std::uint8_t, 3>>& colours) {
    mostMm_ = mostMm;
    scale_ = colours;
    updateGeometry();
    update();
}

QSize Legend::sizeHint() const {
    return minimumSizeHint();
}

QSize Legend::minimumSizeHint() const {
    const int line = fontMetrics().height() + 6;
    if (mostMm_ > 0) return {150, 2 * line + 26};
    int width = 90;
    for (const auto& entry : entries_)
        width = std::max(width, fontMetrics().horizontalAdvance(tissueName(entry.tissue)) + 44);
    return {width, static_cast<int>(std::max<std::size_t>(1, entries_.size())) * line + 12};
}

void Legend::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const Tones tones = tonesOf(palette());
    const QColor textColour = palette().color(QPalette::WindowText);
    // It may lie over the picture: a ground of its own keeps it readable.
    QColor ground = palette().color(QPalette::Window);
    ground.setAlphaF(0.9f);
    painter.setPen(QPen(tones.line, 1));
    painter.setBrush(ground);
    painter.drawRoundedRect(QRectF(rect()).adjusted(0.5, 0.5, -0.5, -0.5), 6, 6);
    const double line = fontMetrics().height() + 6;
    if (mostMm_ > 0) {
        painter.setPen(textColour);
        painter.drawText(QRectF(8, 4, width() - 16.0, line), Qt::AlignLeft | Qt::AlignVCenter, tr("Removed depth"));
        const QRectF bar(8, line + 6, width() - 16.0, 14);
        QLinearGradient gradient(bar.topLeft(), bar.topRight());
        for (std::size_t i = 0; i < scale_.size(); ++i)
            gradient.setColorAt(scale_.size() > 1 ? double(i) / double(scale_.size() - 1) : 0.0,
                                QColor(scale_[i][0], scale_[i][1], scale_[i][2]));
        painter.setBrush(gradient);
        painter.setPen(QPen(mixed(tones.line, tones.quiet, 0.5), 1));
        painter.drawRoundedRect(bar, 3, 3);
        painter.setPen(textColour);
        const QRectF under(8, bar.bottom() + 2, width() - 16.0, line);
        painter.drawText(under, Qt::AlignLeft | Qt::AlignVCenter, QStringLiteral("0"));
        painter.drawText(under, Qt::AlignHCenter | Qt::AlignVCenter, QLocale().toString(mostMm_ / 2, 'g', 3));
        painter.drawText(under, Qt::AlignRight | Qt::AlignVCenter, quantity(mostMm_, 1, tr("mm")));
        return;
    }
    double top = 6;
    for (const auto& entry : entries_) {
        painter.setPen(QPen(mixed(tones.line, tones.quiet, 0.6), 1));
        painter.setBrush(QColor(entry.colour[0], entry.colour[1], entry.colour[2]));
        painter.drawRoundedRect(QRectF(10, top + line / 2 - 6.5, 18, 13), 3, 3);
        painter.setPen(textColour);
        painter.drawText(QRectF(36, top, width() - 40.0, line), Qt::AlignLeft | Qt::AlignVCenter,
                         tissueName(entry.tissue));
        top += line;
    }
}

}  // namespace handpiece::desktop
