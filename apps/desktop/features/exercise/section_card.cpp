// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/exercise/section_card.h"

#include <QLabel>
#include <QLocale>
#include <QPainter>
#include <QVBoxLayout>
#include <cmath>
#include <utility>

#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {
namespace {

constexpr int kSize = 210, kMargin = 8, kLegend = 40;
// What a hand can see: nearer than that a surface is where it should be.
constexpr double kSeenMm = 0.05;

QString mm(double value) {
    return quantity(value, 1, QStringLiteral("mm"));
}

struct Line {
    QColor colour;
    Qt::PenStyle style;
    double width;
};
/// Blue and orange of Okabe & Ito, which every eye tells apart.
Line ownLine(const QPalette& palette) {
    return {isDark(palette) ? QColor(86, 180, 233) : QColor(0, 114, 178), Qt::SolidLine, 2.2};
}
Line idealLine(const QPalette& palette) {
    return {isDark(palette) ? QColor(230, 159, 0) : QColor(176, 96, 0), Qt::DashLine, 1.8};
}
Line uncutLine(const QPalette& palette) {
    return {tonesOf(palette).quiet, Qt::DotLine, 1.2};
}

}  // namespace

SectionCard::SectionCard(QWidget* parent) : QWidget(parent), figures_(new QLabel(this)) {
    named(this, "sectionCard", tr("Section through the place that is shown"));
    figures_->setObjectName(QStringLiteral("sectionFigures"));
    figures_->setTextFormat(Qt::PlainText);
    figures_->setWordWrap(true);
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(kMargin, kSize + kLegend + kMargin, kMargin, kMargin);
    column->addWidget(figures_);
    hide();
}

QString SectionCard::figuresOf(const report::PlaceSection& section) {
    QStringList said;
    if (section.leftMm) {
        const double left = *section.leftMm;
        said << (std::abs(left) < kSeenMm ? tr("As the ideal is here.")
                 : left > 0.0             ? tr("%1 still to be cut here.").arg(mm(left))
                                          : tr("%1 too much cut here.").arg(mm(-left)));
    }
    if (section.ownDeepMm && section.idealDeepMm)
        said << tr("Depth: %1, ideal: %2.").arg(mm(*section.ownDeepMm), mm(*section.idealDeepMm));
    else if (section.ownDeepMm)
        said << tr("Depth: %1.").arg(mm(*section.ownDeepMm));
    return said.join(QLatin1Char('\n'));
}

void SectionCard::setSection(report::PlaceSection section, const report::Bearings& bearings) {
    const auto wordOf = [&](std::string_view side) { return QString::fromStdString(report::sideNoun(bearings, side)); };
    left_ = wordOf(section.leftSide);
    right_ = wordOf(section.rightSide);
    figures_->setText(figuresOf(section));
    setAccessibleDescription(figures_->text());
    section_ = std::move(section);
    updateGeometry();
    update();
}

QSize SectionCard::sizeHint() const {
    const int width = kSize + 2 * kMargin;
    const int words = figures_->text().isEmpty() ? 0 : figures_->heightForWidth(kSize) + kMargin;
    return {width, kSize + kLegend + kMargin + words};
}

QRect SectionCard::drawing() const {
    return {kMargin, kMargin, kSize, kSize};
}

void SectionCard::paintEvent(QPaintEvent*) {
    QPainter p(this);
    p.setRenderHint(QPainter::Antialiasing);
    const Tones tones = tonesOf(palette());
    p.setPen(tones.line);
    p.setBrush(tones.raised);
    p.drawRoundedRect(QRectF(rect()).adjusted(0.5, 0.5, -0.5, -0.5), 6, 6);
    if (!section_) return;
    const QRect box = drawing();
    const double scale = kSize / (2.0 * section_->halfMm);
    const QPointF middle = QRectF(box).center();
    const auto at = [&](const core::Vec2& v) { return middle + scale * QPointF(v.x(), -v.y()); };
    p.save();
    p.setClipRect(box);
    p.fillRect(box, palette().base());
    p.setPen(tones.line);
    for (int i = -static_cast<int>(section_->halfMm); i <= section_->halfMm; ++i) {  // millimetres
        p.drawLine(at({i, -section_->halfMm}), at({i, section_->halfMm}));
        p.drawLine(at({-section_->halfMm, i}), at({section_->halfMm, i}));
    }
    const auto draw = [&](const std::vector<report::SectionLine>& lines, const Line& as) {
        p.setPen(QPen(as.colour, as.width));
        // A pen's dashes would begin anew with each tenth of a millimetre: these lie where the plane has them.
        const double periodMm = as.style == Qt::DotLine ? 0.25 : 0.5;
        for (const report::SectionLine& line : lines) {
            const double along = std::abs((line.from + line.to).sum()) / 2.0;
            if (as.style == Qt::SolidLine || std::fmod(along, periodMm) < 0.6 * periodMm)
                p.drawLine(at(line.from), at(line.to));
        }
    };
    draw(section_->before, uncutLine(palette()));
    draw(section_->own, ownLine(palette()));
    draw(section_->ideal, idealLine(palette()));
    p.setPen(QPen(palette().text().color(), 1.5));
    p.setBrush(Qt::NoBrush);
    p.drawEllipse(middle, 6.0, 6.0);
    p.setPen(palette().text().color());
    const int line = p.fontMetrics().height();
    const QRect edge = box.adjusted(4, kSize - line - 2, -4, -2);
    p.drawText(edge, Qt::AlignLeft | Qt::AlignBottom, left_);
    p.drawText(edge, Qt::AlignRight | Qt::AlignBottom, right_);
    p.restore();
    // What is which, and how large a square is.
    int x = box.left();
    const int y = box.bottom() + 6;
    const auto legend = [&](const Line& as, const QString& words) {
        p.setPen(QPen(as.colour, as.width, as.style));
        p.drawLine(x, y + line / 2, x + 16, y + line / 2);
        p.setPen(palette().text().color());
        p.drawText(QRect(x + 20, y, kSize, line), Qt::AlignLeft | Qt::AlignVCenter, words);
        x += 20 + p.fontMetrics().horizontalAdvance(words) + 10;
    };
    legend(ownLine(palette()), tr("yours"));
    if (!section_->ideal.empty()) legend(idealLine(palette()), tr("ideal"));
    legend(uncutLine(palette()), tr("uncut"));
    p.setPen(tones.quiet);
    p.drawText(QRect(box.left(), y + line, kSize, line), Qt::AlignLeft | Qt::AlignVCenter, tr("A square is 1 mm."));
}

}  // namespace handpiece::desktop
