// SPDX-License-Identifier: Apache-2.0
#include "desktop/widgets/tooth_chart.h"

#include <QHelpEvent>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QToolTip>
#include <algorithm>
#include <cmath>

#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

namespace {

/// How much wider than its tooth the ring is that shows where the keyboard is.
constexpr double kRing = 1.16;
/// Sizes along and across the arch [mm], by place from the midline: usual crown sizes, rounded, for a drawing only.
constexpr double kAlong[2][8] = {{8.5, 6.5, 7.5, 7.0, 6.8, 10.2, 9.8, 8.8},
                                 {5.3, 5.8, 6.8, 7.0, 7.1, 11.2, 10.6, 10.0}};
constexpr double kAcross[2][8] = {{7.0, 6.2, 8.0, 9.0, 9.0, 11.0, 11.0, 10.0},
                                  {6.0, 6.3, 7.6, 7.8, 8.2, 10.4, 10.0, 9.6}};
constexpr double kAlongPrimary[5] = {6.2, 5.2, 6.8, 7.4, 9.2}, kAcrossPrimary[5] = {5.0, 4.8, 6.2, 7.6, 8.8};

/// Crown from above, 1 wide and 1 deep, buccal up: an incisor's bar, a canine's drop, a premolar's oval, a molar's
/// square.
QPainterPath crown(int place, bool primary, QPainterPath& grooves) {
    const bool molar = primary ? place >= 4 : place >= 6, premolar = !primary && (place == 4 || place == 5);
    QPainterPath path;
    if (molar) {
        path.moveTo(0, -0.5);
        path.cubicTo(0.2, -0.56, 0.46, -0.54, 0.5, -0.28);
        path.cubicTo(0.53, -0.05, 0.53, 0.05, 0.5, 0.28);
        path.cubicTo(0.46, 0.54, 0.2, 0.56, 0, 0.48);
        path.cubicTo(-0.2, 0.56, -0.46, 0.54, -0.5, 0.28);
        path.cubicTo(-0.53, 0.05, -0.53, -0.05, -0.5, -0.28);
        path.cubicTo(-0.46, -0.54, -0.2, -0.56, 0, -0.5);
        grooves.moveTo(-0.3, 0.02);
        grooves.lineTo(0.3, 0.02);
        grooves.moveTo(0.02, 0.02);
        grooves.lineTo(0.05, -0.3);
        grooves.moveTo(-0.04, 0.02);
        grooves.lineTo(-0.04, 0.3);
    } else if (premolar) {
        path.addEllipse(QPointF(0, 0), 0.48, 0.5);
        grooves.moveTo(-0.22, 0.02);
        grooves.quadTo(0, 0.1, 0.22, 0.02);
    } else if (place == 3) {
        path.moveTo(0, -0.5);
        path.cubicTo(0.34, -0.48, 0.52, -0.2, 0.46, 0.06);
        path.cubicTo(0.4, 0.34, 0.18, 0.5, 0, 0.5);
        path.cubicTo(-0.18, 0.5, -0.4, 0.34, -0.46, 0.06);
        path.cubicTo(-0.52, -0.2, -0.34, -0.48, 0, -0.5);
    } else {
        path.moveTo(-0.5, -0.28);
        path.cubicTo(-0.3, -0.5, 0.3, -0.5, 0.5, -0.28);
        path.cubicTo(0.5, 0.0, 0.3, 0.46, 0, 0.48);
        path.cubicTo(-0.3, 0.46, -0.5, 0.0, -0.5, -0.28);
    }
    return path;
}

}  // namespace

ToothChart::ToothChart(QWidget* parent) : QWidget(parent) {
    setObjectName("toothChart");
    setAccessibleName(tr("Tooth chart"));
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    layOut();
}

QSize ToothChart::sizeHint() const {
    return {330, 420};
}
QSize ToothChart::minimumSizeHint() const {
    return {230, 290};
}

void ToothChart::setNotation(Notation notation) {
    notation_ = notation;
    update();
}

void ToothChart::setPrimaryShown(bool shown) {
    primary_ = shown;
    layOut();
    update();
}

void ToothChart::setAvailable(const std::set<int>& teeth) {
    available_ = teeth;
    update();
}

void ToothChart::setDrawings(std::map<int, ToothDrawing> drawings) {
    drawings_ = std::move(drawings);
    layOut();
    update();
}

void ToothChart::setMarks(std::map<int, QString> marks) {
    marks_ = std::move(marks);
    update();
}

void ToothChart::setChosen(int fdi) {
    chosen_ = focused_ = fdi;
    setAccessibleDescription(toothName(fdi));
    update();
}

QPointF ToothChart::centreOf(int fdi) const {
    for (const Place& place : places_)
        if (place.fdi == fdi) return place.centre;
    return {};
}

void ToothChart::layOut() {
    places_.clear();
    const double line = QFontMetricsF(font()).height(), margin = line * 1.5;
    const double w = width() - 2 * margin, h = height() - 2 * line * 1.3;
    if (w < 50 || h < 50) return;
    const auto place = [&](const std::vector<int>& teeth, bool upper, bool primary) {
        const std::size_t half = teeth.size() / 2;
        // Each half-arch is walked from the midline along an ellipse by the sizes of its teeth.
        const double inset = primary ? 0.56 : 1.0, depth = h / 2 - line * 0.55;
        // Half-widths of the ellipse to the teeth's middles: the widest tooth stays inside.
        const double a = (w / 2 - w * 0.06) * inset, b = (depth - depth * 0.06) * (primary ? 0.66 : 1.0);
        constexpr int kSamples = 720;
        std::vector<double> length(kSamples + 1, 0.0);
        const auto at = [&](double t) { return QPointF(a * std::sin(t), -b * std::cos(t)); };
        const double end = M_PI / 2 * 0.985;
        for (int i = 1; i <= kSamples; ++i) {
            const QPointF step = at(end * i / kSamples) - at(end * (i - 1) / kSamples);
            length[std::size_t(i)] = length[std::size_t(i) - 1] + std::hypot(step.x(), step.y());
        }
        double along = 0;
        const auto sizeOf = [](std::size_t i, const double* wide, const double* deep) {
            return std::pair(wide[i], deep[i]);
        };
        double sum = 0;
        for (std::size_t i = 0; i < half; ++i)
            sum += primary ? kAlongPrimary[i] : kAlong[upper ? 0 : 1][i];
        const double scale = length.back() / sum;
        for (std::size_t i = 0; i < half; ++i) {
            const auto [wide, deep] = primary ? sizeOf(i, kAlongPrimary, kAcrossPrimary)
                                              : sizeOf(i, kAlong[upper ? 0 : 1], kAcross[upper ? 0 : 1]);
            const double middle = along + wide * scale / 2;
            along += wide * scale;
            const auto found = std::lower_bound(length.begin(), length.end(), middle) - length.begin();
            const double t = end * static_cast<double>(found) / kSamples;
            for (const bool left : {false, true}) {  // the patient's left is on the right of the picture
                const QPointF p = at(t), out(std::sin(t) / a, -std::cos(t) / b);
                const double outLength = std::hypot(out.x(), out.y());
                QPointF normal = out / outLength;
                QPointF centre = p;
                if (!left) {
                    centre.setX(-centre.x());
                    normal.setX(-normal.x());
                }
                if (!upper) {
                    centre.setY(-centre.y());
                    normal.setY(-normal.y());
                }
                const double seam = line * (primary ? 0.9 : 0.55);
                centre += QPointF(width() / 2.0, height() / 2.0 + (upper ? -seam : seam));
                QTransform transform;
                transform.translate(centre.x(), centre.y());
                transform.rotateRadians(std::atan2(normal.x(), -normal.y()));
                const double size = scale * 0.93;
                QPainterPath outline, grooves;
                const int number = static_cast<int>(i) + 1;
                const int fdi = teeth[left ? half + i : half - 1 - i];
                const double most = std::min(deep, wide * 1.35);
                if (const auto own = drawings_.find(fdi); own != drawings_.end()) {
                    const QRectF box = own->second.outline.boundingRect();
                    const double fits = std::min({1.0, 1.08 * wide / box.width(), 1.08 * most / box.height()}) * size;
                    // Buccal is out of the arch, mesial towards its middle.
                    transform.scale(left == upper ? -fits : fits, -fits);
                    transform.translate(-box.center().x(), -box.center().y());
                    outline.addPolygon(own->second.outline);
                    outline.closeSubpath();
                    for (const QPolygonF& groove : own->second.grooves)
                        grooves.addPolygon(groove);
                } else {
                    transform.scale(wide * size, most * size);
                    outline = crown(number, primary, grooves);
                }
                // Clear of the ring round the tooth that has the keyboard.
                const double reach = most * size / 2 * kRing + 4 +
                                     std::abs(normal.x()) * 0.5 * fontMetrics().horizontalAdvance("46") +
                                     std::abs(normal.y()) * 0.35 * line;
                places_.push_back({fdi, centre, transform.map(outline), transform.map(grooves),
                                   primary ? centre - normal * reach : centre + normal * reach});
            }
        }
    };
    place(upperArch(false), true, false);
    place(lowerArch(false), false, false);
    if (primary_) {
        place(upperArch(true), true, true);
        place(lowerArch(true), false, true);
    }
}

void ToothChart::resizeEvent(QResizeEvent* event) {
    layOut();
    QWidget::resizeEvent(event);
}

const ToothChart::Place* ToothChart::at(const QPointF& point) const {
    for (const Place& place : places_)
        if (place.outline.contains(point)) return &place;
    // The label belongs to its tooth.
    for (const Place& place : places_)
        if (QLineF(place.label, point).length() < fontMetrics().height() * 0.7) return &place;
    return nullptr;
}

void ToothChart::choose(int fdi) {
    if (!available_.contains(fdi)) return;
    setChosen(fdi);
    emit toothChosen(fdi);
}

void ToothChart::mousePressEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton) return QWidget::mousePressEvent(event);
    if (const Place* place = at(event->position())) {
        focused_ = place->fdi;
        choose(place->fdi);
        update();
    }
}

void ToothChart::mouseMoveEvent(QMouseEvent* event) {
    const Place* place = at(event->position());
    const int over = place ? place->fdi : 0;
    if (over == hovered_) return;
    hovered_ = over;
    setCursor(available_.contains(over) ? Qt::PointingHandCursor : Qt::ArrowCursor);
    update();
}

void ToothChart::leaveEvent(QEvent* event) {
    hovered_ = 0;
    update();
    QWidget::leaveEvent(event);
}

void ToothChart::moveFocus(int along, bool otherArch) {
    const auto arches = [](bool primary) { return std::pair(upperArch(primary), lowerArch(primary)); };
    if (toothLabel(focused_, Notation::fdi).isEmpty()) focused_ = available_.empty() ? 11 : *available_.begin();
    const bool primary = focused_ > 50;
    const auto [upper, lower] = arches(primary);
    const auto inUpper = std::find(upper.begin(), upper.end(), focused_);
    const bool isUpper = inUpper != upper.end();
    const auto& own = isUpper ? upper : lower;
    const auto index = static_cast<int>(std::find(own.begin(), own.end(), focused_) - own.begin());
    const auto& target = otherArch ? (isUpper ? lower : upper) : own;
    focused_ = target[static_cast<std::size_t>(std::clamp(index + along, 0, static_cast<int>(target.size()) - 1))];
    setAccessibleDescription(toothName(focused_));
    update();
}

void ToothChart::keyPressEvent(QKeyEvent* event) {
    const bool upper = focused_ / 10 == 1 || focused_ / 10 == 2 || focused_ / 10 == 5 || focused_ / 10 == 6;
    switch (event->key()) {
        case Qt::Key_Left:
            return moveFocus(-1, false);
        case Qt::Key_Right:
            return moveFocus(1, false);
        case Qt::Key_Up:
            return moveFocus(0, !upper);
        case Qt::Key_Down:
            return moveFocus(0, upper);
        case Qt::Key_Return:
        case Qt::Key_Enter:
        case Qt::Key_Space:
            return choose(focused_);
        default:
            return QWidget::keyPressEvent(event);
    }
}

bool ToothChart::event(QEvent* event) {
    if (event->type() == QEvent::ToolTip) {
        auto* help = static_cast<QHelpEvent*>(event);
        if (const Place* place = at(help->pos())) {
            QString words = tr("%1 (FDI %2, Universal %3)")
                                .arg(toothName(place->fdi), toothLabel(place->fdi, Notation::fdi),
                                     toothLabel(place->fdi, Notation::universal));
            if (!available_.contains(place->fdi)) words += "\n" + tr("There is no such tooth to open.");
            if (const auto mark = marks_.find(place->fdi); mark != marks_.end()) words += "\n" + mark->second;
            QToolTip::showText(help->globalPos(), words);
        } else {
            QToolTip::hideText();
        }
        return true;
    }
    if (event->type() == QEvent::FontChange) layOut();
    return QWidget::event(event);
}

void ToothChart::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const Tones tones = tonesOf(palette());
    const QColor textColour = palette().color(QPalette::WindowText), window = palette().color(QPalette::Window);
    const QColor accent = palette().color(QPalette::Highlight);
    const bool dark = isDark(palette());
    const QColor ivory = dark ? QColor(0xd9d3c3) : QColor(0xfffdf5);

    painter.setPen(QPen(tones.line, 1, Qt::DashLine));
    painter.drawLine(QPointF(width() / 2.0, 8), QPointF(width() / 2.0, height() - 8.0));
    painter.drawLine(QPointF(8, height() / 2.0), QPointF(width() - 8.0, height() / 2.0));
    painter.setFont(scaledFont(font(), 0.85));
    painter.setPen(tones.quiet);
    if (!primary_) {
        const double side = fontMetrics().height() * 1.5;
        const QRectF middle(width() * 0.27, height() / 2.0 - side, width() * 0.46, 2 * side);
        painter.drawText(middle, Qt::AlignLeft | Qt::AlignVCenter, tr("Right"));
        painter.drawText(middle, Qt::AlignRight | Qt::AlignVCenter, tr("Left"));
        painter.drawText(QRectF(0, height() * 0.28, width(), side), Qt::AlignCenter, tr("Upper"));
        painter.drawText(QRectF(0, height() * 0.72 - side, width(), side), Qt::AlignCenter, tr("Lower"));
    }
    for (const Place& place : places_) {
        const bool free = available_.contains(place.fdi), chosen = place.fdi == chosen_, over = place.fdi == hovered_;
        QColor fill = free ? ivory : QColor(Qt::transparent);
        if (free && over) fill = mixed(ivory, accent, 0.35);
        if (chosen) fill = accent;
        painter.setPen(QPen(chosen ? accent.darker(130)
                            : free ? accent
                                   : mixed(window, textColour, 0.3),
                            chosen || free ? 1.8 : 1.0, chosen || free ? Qt::SolidLine : Qt::DotLine));
        painter.setBrush(fill);
        painter.drawPath(place.outline);
        painter.setBrush(Qt::NoBrush);
        painter.setPen(QPen(chosen ? QColor(0xffffff)
                            : free ? QColor(0x8a8270)
                                   : mixed(window, textColour, 0.25),
                            1.0));
        if (free || chosen) painter.drawPath(place.grooves);
        if (marks_.contains(place.fdi)) {  // there is more
            painter.setPen(QPen(window, 1.2));
            painter.setBrush(accent);
            painter.drawEllipse(place.centre, 3.6, 3.6);
            painter.setBrush(Qt::NoBrush);
        }
        if (hasFocus() && place.fdi == focused_) {
            painter.setPen(QPen(textColour, 1.2, Qt::DotLine));
            QTransform wider;
            wider.translate(place.centre.x(), place.centre.y());
            wider.scale(kRing, kRing);
            wider.translate(-place.centre.x(), -place.centre.y());
            painter.drawPath(wider.map(place.outline));
        }
        painter.setFont(scaledFont(font(), place.fdi > 50 ? 0.72 : 0.85, free));
        painter.setPen(free ? textColour : mixed(window, textColour, 0.55));
        painter.drawText(QRectF(place.label.x() - 20, place.label.y() - 10, 40, 20), Qt::AlignCenter,
                         toothLabel(place.fdi, notation_));
    }
}

}  // namespace handpiece::desktop
