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

constexpr int kSize = 210, kMargin = 8, kLegend = 56;
// Shallower than that nothing was cut: a tenth is told as the nearest.
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
    if (!section.ownDeepMm) return {};
    const QString own = mm(*section.ownDeepMm);
    if (!section.idealDeepMm) return tr("Depth: %1.").arg(own);
    if (*section.idealDeepMm > 0.0) return tr("Depth: %1, ideal: %2.").arg(own, mm(*section.idealDeepMm));
    return *section.ownDeepMm < kSeenMm ? QString() : tr("Nothing was to be cut here: %1 deep.").arg(own);
}

void SectionCard::setSection(report::PlaceSection section, const report::Bearings& bearings,
                             const core::Vec3& eyesRight) {
    const auto wordOf = [&](std::string_view side) { return QString::fromStdString(report::sideNoun(bearings, side)); };
    isMirrored_ = section.right.dot(eyesRight) < 0.0;
    left_ = wordOf(isMirrored_ ? section.rightSide : section.leftSide);
    right_ = wordOf(isMirrored_ ? section.leftSide : section.rightSide);
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
    const QPointF place(QRectF(box).center().x(), box.top() + scale * section_->highMm);
    const auto at = [&](const core::Vec2& v) { return place + scale * QPointF(isMirrored_ ? -v.x() : v.x(), -v.y()); };
    p.save();
    p.setClipRect(box);
    p.fillRect(box, palette().base());
    p.setPen(tones.line);
    const double allMm = 2.0 * section_->halfMm;
    for (int i = -static_cast<int>(allMm); i <= static_cast<int>(allMm); ++i) {  // millimetres from the place
        p.drawLine(at({i, -allMm}), at({i, allMm}));
        p.drawLine(at({-allMm, i}), at({allMm, i}));
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
    p.drawEllipse(place, 6.0, 6.0);
    p.setPen(palette().text().color());
    const int line = p.fontMetrics().height();
    const QRect edge = box.adjusted(4, kSize - line - 2, -4, -2);
    for (const auto& [side, words] : {std::pair(Qt::AlignLeft, left_), std::pair(Qt::AlignRight, right_)}) {
        const auto where = side | Qt::AlignBottom;
        p.fillRect(p.boundingRect(edge, static_cast<int>(where), words), palette().base());
        p.drawText(edge, static_cast<int>(where), words);
    }
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
    p.drawText(QRect(box.left(), y + line, kSize, 2 * line), Qt::AlignLeft | Qt::AlignTop,
               tr("A square is 1 mm.") + QLatin1Char('\n') + tr("As you finished it."));
}

}  // namespace handpiece::desktop
