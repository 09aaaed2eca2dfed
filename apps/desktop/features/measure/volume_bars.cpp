// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/measure/volume_bars.h"

#include <QHelpEvent>
#include <QLocale>
#include <QPainter>
#include <QPainterPath>
#include <QToolTip>
#include <algorithm>
#include <cmath>

#include "desktop/widgets/notation.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

namespace {

QColor colourOfEntry(const view::LegendEntry& entry) {
    return {entry.colour[0], entry.colour[1], entry.colour[2]};
}

QString volumeText(double mm3) {
    return quantity(mm3, mm3 >= 100 ? 0 : mm3 >= 10 ? 1 : 2, VolumeBars::tr("mm³"));
}

/// End of the bars' scale: 1, 2 or 5 times a power of ten, so that bars do not crawl at every sample.
double scaleEnd(double most) {
    double end = 1.0;
    while (end < most) {
        for (const double factor : {2.0, 5.0, 10.0})
            if (end * factor >= most) return end * factor;
        end *= 10;
    }
    return end;
}

}  // namespace

VolumeBars::VolumeBars(QWidget* parent) : QWidget(parent) {
    setObjectName("volumeBars");
    setAccessibleName(tr("Removed of each tissue"));
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

void VolumeBars::setVolumes(const std::array<double, cases::kTissueCount>& removedMm3) {
    if (locked_) return;
    const std::size_t before = rows().size();
    bool changed = false;
    for (std::size_t i = 0; i < removedMm3.size(); ++i)
        changed |= std::abs(removedMm3[i] - removedMm3_[i]) >= 0.005;
    if (!changed) return;
    removedMm3_ = removedMm3;
    QStringList words;
    for (const auto& row : rows())
        words << tissueName(row.tissue) + " " + volumeText(removedMm3_[static_cast<std::size_t>(row.tissue)]);
    setAccessibleDescription(words.join(", "));
    if (rows().size() != before) updateGeometry();
    update();
}

void VolumeBars::setLegend(const std::vector<view::LegendEntry>& entries) {
    entries_ = entries;
    updateGeometry();
    update();
}

void VolumeBars::setDetail(Detail detail) {
    detail_ = detail;
    updateGeometry();
    update();
}

void VolumeBars::setHeadingShown(bool shown) {
    headingShown_ = shown;
    update();
}

void VolumeBars::setLocked(bool locked) {
    if (locked == locked_) return;
    locked_ = locked;
    // Nothing of them is kept that a screen reader or a tooltip could tell.
    removedMm3_ = {};
    setAccessibleDescription(locked ? tr("This exercise hides the volumes.") : QString());
    update();
}

std::vector<view::LegendEntry> VolumeBars::rows() const {
    if (locked_) return {};
    std::vector<view::LegendEntry> rows;
    for (const auto& entry : entries_)
        if (cases::properties(entry.tissue).cuttingMm2PerN > 0) rows.push_back(entry);
    for (std::size_t i = 1; i < cases::kTissueCount; ++i) {
        const auto tissue = static_cast<cases::Tissue>(i);
        if (removedMm3_[i] <= 0 ||
            std::any_of(rows.begin(), rows.end(), [tissue](const auto& row) { return row.tissue == tissue; }))
            continue;
        rows.push_back({tissue, cases::properties(tissue).colour});
    }
    return rows;
}

QSize VolumeBars::sizeHint() const {
    return {220, minimumSizeHint().height()};
}

QSize VolumeBars::minimumSizeHint() const {
    const int line = fontMetrics().height() + 8;
    return {160, static_cast<int>(std::max<std::size_t>(1, rows().size()) + 1) * line + 4};
}

void VolumeBars::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const Tones tones = tonesOf(palette());
    const QColor textColour = palette().color(QPalette::WindowText);
    const auto shown = rows();
    const double line = fontMetrics().height() + 8;
    double most = 0, total = 0, nameWidth = 0;
    for (const auto& row : shown) {
        most = std::max(most, removedMm3_[static_cast<std::size_t>(row.tissue)]);
        nameWidth = std::max(nameWidth, static_cast<double>(fontMetrics().horizontalAdvance(tissueName(row.tissue))));
    }
    for (const double volume : removedMm3_)
        total += volume;
    nameWidth = std::min(nameWidth + 8, width() * 0.45);
    const double valueWidth = fontMetrics().horizontalAdvance(QStringLiteral("0000.00 mm³")), end = scaleEnd(most);

    if (locked_) {
        painter.setPen(tones.quiet);
        painter.drawText(rect().adjusted(2, 0, -2, 0), Qt::AlignLeft | Qt::AlignVCenter | Qt::TextWordWrap,
                         tr("This exercise hides the volumes."));
        return;
    }
    painter.setFont(scaledFont(font(), 1.0, true));
    painter.setPen(textColour);
    painter.drawText(QRectF(2, 0, width() - 4.0, line), Qt::AlignLeft | Qt::AlignVCenter,
                     headingShown_ ? tr("Removed") : tr("Total"));
    painter.drawText(QRectF(2, 0, width() - 4.0, line), Qt::AlignRight | Qt::AlignVCenter, volumeText(total));
    painter.setFont(font());
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const double volume = removedMm3_[static_cast<std::size_t>(shown[i].tissue)],
                     top = line * static_cast<double>(i + 1);
        painter.setPen(textColour);
        painter.drawText(QRectF(2, top, nameWidth, line), Qt::AlignLeft | Qt::AlignVCenter,
                         tissueName(shown[i].tissue));
        painter.drawText(QRectF(2, top, width() - 4.0, line), Qt::AlignRight | Qt::AlignVCenter, volumeText(volume));
        const QRectF bar(nameWidth + 4, top + line / 2 - 5, std::max(8.0, width() - nameWidth - valueWidth - 14), 10);
        QPainterPath round;
        round.addRoundedRect(bar, 3, 3);
        painter.fillPath(round, tones.line);
        painter.save();
        painter.setClipPath(round);
        const QRectF filled(bar.left(), bar.top(), bar.width() * std::clamp(volume / end, 0.0, 1.0), bar.height());
        painter.fillRect(filled, colourOfEntry(shown[i]));
        painter.restore();
        // Enamel is nearly white: an outline keeps it apart from a light window.
        painter.setPen(QPen(mixed(tones.line, tones.quiet, 0.5), 1));
        painter.drawPath(round);
    }
    if (shown.empty()) {
        painter.setPen(tones.quiet);
        painter.drawText(QRectF(2, line, width() - 4.0, line), Qt::AlignLeft | Qt::AlignVCenter, tr("Nothing yet"));
    }
}

bool VolumeBars::event(QEvent* event) {
    if (event->type() == QEvent::ToolTip) {
        auto* help = static_cast<QHelpEvent*>(event);
        const int row = help->pos().y() / (fontMetrics().height() + 8) - 1;
        const auto shown = rows();
        if (row >= 0 && row < static_cast<int>(shown.size())) {
            const auto tissue = shown[static_cast<std::size_t>(row)].tissue;
            QToolTip::showText(help->globalPos(),
                               tr("%1: %2 cut away since the tooth was whole")
                                   .arg(tissueName(tissue), volumeText(removedMm3_[static_cast<std::size_t>(tissue)])));
        } else {
            QToolTip::showText(help->globalPos(), locked_ ? tr("This exercise hides the volumes.")
                                                          : tr("What was cut away since the tooth was whole"));
        }
        return true;
    }
    return QWidget::event(event);
}

}  // namespace handpiece::desktop
