// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/overlay.h"

#include <QCoreApplication>
#include <QLineF>
#include <QLocale>
#include <QPainterPath>
#include <QPolygonF>
#include <algorithm>
#include <array>
#include <cmath>

#include "desktop/widgets/pulp_words.h"

namespace handpiece::desktop {

namespace {

// The overlay lies on a picture, not on a window: it brings its own ground with it.
const QColor kGround(18, 21, 26, 190), kEdge(255, 255, 255, 36), kText(238, 240, 243), kFaint(170, 178, 188),
    kLine(255, 214, 90), kSectionLine(110, 200, 255), kLandmark(120, 235, 170), kInside(255, 150, 190);
constexpr double kMargin = 12.0, kPad = 8.0, kRound = 6.0, kLeashPixels = 6.0, kDepthScaleWidth = 90.0;
// Of the picture's height at most: else it hides more than it tells. And what a fitted tooth leaves free above it.
constexpr double kLegendShare = 0.4, kHalfLegendShare = 0.25, kLegendWidthShare = 0.142, kLegendNameShare = 0.085,
                 kLegendLeast = 0.6, kFittedMargin = 0.095, kRowPixels = 54.0;

struct Texts {
    Q_DECLARE_TR_FUNCTIONS(Overlay)
};
QString number(double value, int digits) {
    return QLocale().toString(value, 'f', digits);
}

QColor colourOf(Light light) {
    switch (light) {
        case Light::good:
            return {84, 200, 120};
        case Light::near:
            return {255, 186, 60};
        case Light::harmed:
            return {255, 96, 88};
    }
    return kText;
}

/// "0.31 mm over the pulp · Under 0.5 mm"
QString withWords(const Measurement& left, Light light, const measure::PulpLimits& limits) {
    return left.text() + QStringLiteral(" \u00b7 ") + pulpWords(light, limits);
}

view::Viewport viewportOf(const QRectF& area) {
    return {std::max(1, static_cast<int>(area.width())), std::max(1, static_cast<int>(area.height()))};
}

QFont smaller(QFont font, double by = 1.0) {
    if (font.pointSizeF() > 0) font.setPointSizeF(std::max(7.0, font.pointSizeF() - by));
    return font;
}

QFont bold(QFont font) {
    font.setBold(true);
    return font;
}

/// One picture of the widget, and where points of the tooth are seen in it.
struct Area {
    QRectF box;
    const OverlayState& state;
    mutable std::vector<QRectF> labels{};  // that stand already: the next one makes way
    [[nodiscard]] std::optional<QPointF> at(const core::Vec3& pointMm) const {
        const auto pixel = view::pixelOf(state.camera, viewportOf(box), pointMm);
        if (!pixel) return std::nullopt;
        return QPointF(box.left() + pixel->x(), box.top() + pixel->y());
    }
};

void haloLine(QPainter& p, const QPointF& a, const QPointF& b, const QColor& colour, double width = 1.8) {
    p.setPen(QPen(QColor(0, 0, 0, 150), width + 2.2, Qt::SolidLine, Qt::RoundCap));
    p.drawLine(a, b);
    p.setPen(QPen(colour, width, Qt::SolidLine, Qt::RoundCap));
    p.drawLine(a, b);
}

void dot(QPainter& p, const QPointF& at, const QColor& colour, double radius = 4.0) {
    p.setPen(QPen(QColor(0, 0, 0, 170), 1.4));
    p.setBrush(colour);
    p.drawEllipse(at, radius, radius);
    p.setBrush(Qt::NoBrush);
}

/// A word on the picture itself.
void haloText(QPainter& p, const QPointF& at, const QString& text) {
    QPainterPath path;
    path.addText(at, p.font(), text);
    p.setPen(QPen(QColor(0, 0, 0, 190), 3.0, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
    p.drawPath(path);
    p.fillPath(path, kText);
}

/// A small label beside a point, kept inside the area. `lamp`: a coloured light before the text.
void label(QPainter& p, const Area& where, const QPointF& at, const QString& text, const QColor* lamp = nullptr) {
    const QRectF& area = where.box;
    const QFontMetricsF metrics(p.font());
    const double lampWidth = lamp ? 16.0 : 0.0;
    QRectF box(at.x() + 12, at.y() - metrics.height() - 10, metrics.horizontalAdvance(text) + 14 + lampWidth,
               metrics.height() + 6);
    box.moveLeft(std::clamp(box.left(), area.left() + 4, std::max(area.left() + 4, area.right() - box.width() - 4)));
    box.moveTop(std::clamp(box.top(), area.top() + 4, std::max(area.top() + 4, area.bottom() - box.height() - 4)));
    for (std::size_t tries = 0; tries < 12; ++tries) {
        const auto taken = std::find_if(where.labels.begin(), where.labels.end(),
                                        [&](const QRectF& one) { return one.intersects(box); });
        if (taken == where.labels.end()) break;
        box.moveTop(taken->bottom() + 3);
    }
    where.labels.push_back(box);
    paintPanel(p, box);
    if (lamp) dot(p, {box.left() + 12, box.center().y()}, *lamp, 5.0);
    p.setPen(kText);
    p.drawText(box.adjusted(7 + lampWidth, 0, -7, 0), Qt::AlignVCenter | Qt::AlignLeft, text);
}

void measurement(QPainter& p, const Area& area, const Measurement& one, bool live) {
    const auto from = area.at(one.fromMm), to = area.at(one.toMm);
    if (!from || !to) return;
    if (one.kind == Measurement::Kind::distance) {
        haloLine(p, *from, *to, kLine);
        const QPointF along = *to - *from;
        const double length = std::hypot(along.x(), along.y());
        if (length > 1.0) {  // the jaws of a calliper
            const QPointF jaw = QPointF(-along.y(), along.x()) * (6.0 / length);
            haloLine(p, *from - jaw, *from + jaw, kLine);
            haloLine(p, *to - jaw, *to + jaw, kLine);
        }
        label(p, area, 0.5 * (*from + *to), one.text());
        return;
    }
    if (one.kind == Measurement::Kind::depth) {
        if (!live) dot(p, *from, kLine);
        label(p, area, *from, one.text());
        return;
    }
    const Light light = pulpLight(one.valueMm, area.state.pulpLimits);
    const QColor lamp = colourOf(light);
    if (!live) dot(p, *from, lamp);
    label(p, area, *from, withWords(one, light, area.state.pulpLimits), &lamp);
}

void legend(QPainter& p, const QRectF& area, const OverlayState& state) {
    if (state.legend.empty()) return;
    p.save();
    p.setFont(smaller(p.font(), 0.5));
    const QFontMetricsF metrics(p.font());
    double width = 0.0;
    for (const view::LegendEntry& entry : state.legend)
        width = std::max(width, metrics.horizontalAdvance(tissueText(entry.tissue)));
    // Long names are cut in a small window; in one where little would be left of them there is none.
    const double beside = 24 + 2 * kPad, whole = width;
    width = std::min(width, std::max(kLegendNameShare * area.width(), kLegendWidthShare * area.width() - beside));
    if (width < kLegendLeast * whole) return p.restore();
    const double row = metrics.height() + 4;
    const double height = row * static_cast<double>(state.legend.size()) + 2 * kPad - 4;
    if (height > (state.compare ? kHalfLegendShare : kLegendShare) * area.height()) return p.restore();
    const QRectF box(area.right() - kMargin - width - beside, area.bottom() - kMargin - height, width + beside, height);
    paintPanel(p, box);
    double y = box.top() + kPad;
    for (const view::LegendEntry& entry : state.legend) {
        const QRectF patch(box.left() + kPad, y + (row - 4 - 12) / 2, 16, 12);
        p.setPen(QPen(QColor(0, 0, 0, 120), 1));
        p.setBrush(QColor(entry.colour[0], entry.colour[1], entry.colour[2]));
        p.drawRoundedRect(patch, 2.5, 2.5);
        p.setPen(kText);
        p.drawText(QRectF(patch.right() + 8, y, width + 2, row - 4), Qt::AlignVCenter,
                   metrics.elidedText(tissueText(entry.tissue), Qt::ElideRight, width + 1));
        y += row;
    }
    p.restore();
}

void depthScale(QPainter& p, const QRectF& area, const OverlayState& state) {
    if (!state.removedDepthMostMm) return;
    p.save();
    p.setFont(smaller(p.font(), 0.5));
    const QFontMetricsF metrics(p.font());
    const double most = *state.removedDepthMostMm;
    const double bar = std::clamp(area.height() * 0.32, 80.0, 200.0);
    const QString title = Texts::tr("Removed");
    const double width =
        std::max(metrics.horizontalAdvance(title), 24 + metrics.horizontalAdvance("0.0 mm")) + 2 * kPad;
    const QRectF box(area.right() - kMargin - width, area.top() + kMargin, width,
                     bar + metrics.height() + 3 * kPad + 6);
    paintPanel(p, box);
    p.setPen(kText);
    p.drawText(QRectF(box.left() + kPad, box.top() + kPad - 2, width, metrics.height()), Qt::AlignLeft, title);
    const QRectF strip(box.left() + kPad, box.top() + 2 * kPad + metrics.height(), 14, bar);
    QLinearGradient gradient(strip.topLeft(), strip.bottomLeft());
    for (int i = 0; i <= 12; ++i) {
        const auto colour = view::removedDepthColour(most * i / 12.0, most);
        gradient.setColorAt(i / 12.0, QColor(colour[0], colour[1], colour[2]));
    }
    p.setPen(QPen(kEdge, 1));
    p.setBrush(gradient);
    p.drawRect(strip);
    const double step = most > 2.0 ? 1.0 : 0.5;
    p.setPen(kText);
    for (double mm = 0.0; mm <= most + 1e-9; mm += step) {
        const double y = strip.top() + bar * mm / most;
        p.drawLine(QPointF(strip.right() + 1, y), QPointF(strip.right() + 4, y));
        p.drawText(QRectF(strip.right() + 9, y - metrics.height() / 2, width, metrics.height()), Qt::AlignVCenter,
                   Texts::tr("%1 mm").arg(number(mm, step < 1.0 ? 1 : 0)));
    }
    p.restore();
}

void scaleBar(QPainter& p, const QRectF& area, const OverlayState& state) {
    const ScaleBar bar = scaleBarFor(state.camera, viewportOf(area));
    if (bar.pixels < 8.0) return;
    p.save();
    p.setFont(smaller(p.font(), 0.5));
    const QFontMetricsF metrics(p.font());
    const QString text = Texts::tr("%1 mm").arg(number(bar.mm, bar.mm < 1.0 ? 1 : 0));
    const QRectF box(area.left() + kMargin, area.bottom() - kMargin - metrics.height() - 22, bar.pixels + 2 * kPad + 4,
                     metrics.height() + 22);
    paintPanel(p, box);
    const double y = box.bottom() - 9, left = box.center().x() - bar.pixels / 2;
    p.setRenderHint(QPainter::Antialiasing, false);
    const int parts = bar.mm >= 1.0 && bar.mm <= 10.0 ? static_cast<int>(bar.mm) : 5;
    for (int i = 0; i < parts; ++i) {
        const QRectF part(left + bar.pixels * i / parts, y - 3, bar.pixels / parts, 5);
        p.fillRect(part, i % 2 == 0 ? kText : QColor(70, 78, 88));
    }
    p.setRenderHint(QPainter::Antialiasing, true);
    p.setPen(kText);
    p.drawText(QRectF(box.left(), box.top() + 3, box.width(), metrics.height()), Qt::AlignCenter, text);
    p.restore();
}

constexpr double kRoomForPass = 760.0;

/// Gives where it ends.
double readout(QPainter& p, const QRectF& area, const OverlayState& state) {
    if (!state.hasHand) return area.left() + kMargin;
    struct Chip {
        QString title, value;
        std::optional<QColor> lamp;
    };
    const QColor lampOn(84, 200, 120), lampOff(92, 100, 110), lampAway(255, 186, 60);
    std::vector<Chip> chips;
    const QString pedal = state.pedalLatched ? Texts::tr("stays down")
                          : state.pedalDown  ? Texts::tr("down")
                                             : Texts::tr("up");
    if (state.away)
        chips.push_back({Texts::tr("Bur"), Texts::tr("lifted"), lampAway});
    else
        chips.push_back({Texts::tr("Pedal"), pedal, state.pedalDown ? lampOn : lampOff});
    chips.push_back({Texts::tr("Load"), Texts::tr("%1 N").arg(number(state.loadN, 1)), std::nullopt});
    chips.push_back({Texts::tr("Depth stop"),
                     state.stopMm ? Texts::tr("%1 mm").arg(number(*state.stopMm, 1)) : Texts::tr("off"), std::nullopt});
    // In a small picture it would lie over the tooth; the panel says it too.
    if (area.width() >= kRoomForPass)
        chips.push_back({Texts::tr("Pass"),
                         state.perPassMm ? Texts::tr("%1 mm").arg(number(*state.perPassMm, 1)) : Texts::tr("off"),
                         std::nullopt});
    const QFont plain = smaller(p.font(), 0.5);
    p.save();
    const QFontMetricsF metrics(plain), heavy(bold(plain));
    double x = area.left() + kMargin;
    for (const Chip& chip : chips) {
        const double title = metrics.horizontalAdvance(chip.title), value = heavy.horizontalAdvance(chip.value);
        const double lampWidth = chip.lamp ? 15.0 : 0.0;
        const QRectF box(x, area.top() + kMargin, title + value + 6 + lampWidth + 2 * kPad, metrics.height() + 10);
        paintPanel(p, box);
        if (chip.lamp) dot(p, {box.left() + kPad + 5, box.center().y()}, *chip.lamp, 4.5);
        p.setFont(plain);
        p.setPen(kFaint);
        p.drawText(QRectF(box.left() + kPad + lampWidth, box.top(), title + 2, box.height()), Qt::AlignVCenter,
                   chip.title);
        p.setFont(bold(plain));
        p.setPen(kText);
        p.drawText(QRectF(box.left() + kPad + lampWidth + title + 6, box.top(), value + 4, box.height()),
                   Qt::AlignVCenter, chip.value);
        x = box.right() + 6;
    }
    p.restore();
    return x;
}

/// The plane's frame: its corners a little outside the tooth, in order around.
std::array<core::Vec3, 4> sectionCorners(const OverlayState& state) {
    const core::Box box = state.bounds.grown(1.0);
    const int across = state.section->direction == SectionPlace::Direction::buccoLingual  ? 0
                       : state.section->direction == SectionPlace::Direction::mesioDistal ? 1
                                                                                          : 2;
    const int u = across == 0 ? 1 : 0, v = across == 2 ? 1 : 2;
    const auto corner = [&](bool uHigh, bool vHigh) {
        core::Vec3 point;
        point[across] = state.section->offsetMm;
        point[u] = uHigh ? box.max[u] : box.min[u];
        point[v] = vHigh ? box.max[v] : box.min[v];
        return point;
    };
    return {corner(false, false), corner(true, false), corner(true, true), corner(false, true)};
}

core::Vec3 handlePoint(const OverlayState& state) {
    const auto corners = sectionCorners(state);
    return 0.5 * (corners[2] + corners[3]);
}

void sectionFrame(QPainter& p, const Area& area) {
    if (!area.state.section || area.state.bounds.isEmpty()) return;
    const auto corners = sectionCorners(area.state);
    std::array<QPointF, 4> seen;
    for (std::size_t i = 0; i < 4; ++i) {
        const auto at = area.at(corners[i]);
        if (!at) return;
        seen[i] = *at;
    }
    QPen pen(QColor(kSectionLine.red(), kSectionLine.green(), kSectionLine.blue(), 150), 1.2, Qt::DashLine);
    p.setPen(pen);
    p.setBrush(Qt::NoBrush);
    p.drawPolygon(seen.data(), 4);
    const auto handle = sectionHandle(area.state, viewportOf(area.box));
    if (!handle) return;
    const QPointF at = *handle + area.box.topLeft();
    p.setPen(QPen(QColor(0, 0, 0, 170), 1.5));
    p.setBrush(kSectionLine);
    p.drawEllipse(at, 9, 9);
    p.setPen(QPen(QColor(16, 30, 40), 1.8, Qt::SolidLine, Qt::RoundCap));
    p.drawLine(at + QPointF(-5, 0), at + QPointF(5, 0));
    for (const double side : {-1.0, 1.0}) {
        p.drawLine(at + QPointF(5 * side, 0), at + QPointF(2.2 * side, -2.8));
        p.drawLine(at + QPointF(5 * side, 0), at + QPointF(2.2 * side, 2.8));
    }
    p.setBrush(Qt::NoBrush);
}

void captionIn(QPainter& p, const QRectF& box, const QString& text) {
    paintPanel(p, box);
    p.setPen(kText);
    p.drawText(box, Qt::AlignCenter, text);
}

/// Which half it is, beside the line between them: scale bar and legend have the outer corners.
void caption(QPainter& p, const QRectF& area, const QString& text, Qt::Alignment side) {
    const QFontMetricsF metrics(p.font());
    const double width = metrics.horizontalAdvance(text) + 24, high = metrics.height() + 10;
    const double left = side == Qt::AlignLeft ? area.left() + kMargin : area.right() - kMargin - width;
    captionIn(p, {left, area.bottom() - kMargin - high, width, high}, text);
}

/// What to do, beside what the hand does: the corners are free where the tooth fills the picture.
void hint(QPainter& p, const QRectF& all, const OverlayState& state, double from) {
    if (state.hint.isEmpty() || state.compare) return;
    const QFontMetricsF metrics(p.font());
    const double high = metrics.height() + 10, room = all.width() - 2 * kMargin;
    const QString text = metrics.elidedText(state.hint, Qt::ElideRight, room - 24);
    const double width = metrics.horizontalAdvance(text) + 24;
    const double left = std::max(from, all.center().x() - width / 2);
    const double end = all.right() - kMargin - (state.removedDepthMostMm ? kDepthScaleWidth : 0.0);
    if (left + width <= end) return captionIn(p, {left, all.top() + kMargin, width, high}, text);
    // In a narrow picture under them, clear of the scale of depths.
    captionIn(p,
              {std::max(all.left() + kMargin, std::min(all.center().x() - width / 2, end - width)),
               all.top() + kMargin + high + 6, width, high},
              text);
}

void message(QPainter& p, const QRectF& area, const OverlayState& state) {
    QFont large = bold(p.font());
    if (large.pointSizeF() > 0) large.setPointSizeF(large.pointSizeF() + 2);
    const QRectF room = area.adjusted(area.width() * 0.12, 0, -area.width() * 0.12, 0);
    const QRectF title = QFontMetricsF(large).boundingRect(room, Qt::TextWordWrap | Qt::AlignHCenter, state.message);
    const QRectF text = QFontMetricsF(p.font()).boundingRect(room, Qt::TextWordWrap | Qt::AlignHCenter, state.remedy);
    const double gap = state.remedy.isEmpty() ? 0 : 10;
    double y = area.center().y() - (title.height() + gap + text.height()) / 2;
    p.save();
    p.setFont(large);
    p.setPen(kText);
    p.drawText(QRectF(room.left(), y, room.width(), title.height() + 2), Qt::TextWordWrap | Qt::AlignHCenter,
               state.message);
    p.restore();
    y += title.height() + gap;
    p.setPen(kFaint);
    p.drawText(QRectF(room.left(), y, room.width(), text.height() + 2), Qt::TextWordWrap | Qt::AlignHCenter,
               state.remedy);
}

bool crosses(const QLineF& line, const QRectF& box) {
    if (box.contains(line.p1()) || box.contains(line.p2())) return true;
    const QPolygonF round(box);  // closed
    for (qsizetype i = 0; i + 1 < round.size(); ++i)
        if (line.intersects(QLineF(round[i], round[i + 1]), nullptr) == QLineF::BoundedIntersection) return true;
    return false;
}

/// Beside its place, best where no line runs through it; not at all where others stand already: the list has it.
void landmarkName(QPainter& p, const Area& area, const QPointF& at, const QString& name,
                  const std::vector<QLineF>& lines) {
    const QFontMetricsF metrics(p.font());
    const double width = metrics.horizontalAdvance(name), up = -5, down = 5 + metrics.ascent();
    std::optional<QPointF> best;
    std::ptrdiff_t fewest = 0;
    for (const QPointF by : {QPointF(6, up), QPointF(6, down), QPointF(-6 - width, up), QPointF(-6 - width, down)}) {
        const QRectF box(at + by - QPointF(0, metrics.ascent()), QSizeF(width, metrics.height()));
        if (std::any_of(area.labels.begin(), area.labels.end(), [&](const QRectF& o) { return o.intersects(box); }))
            continue;
        const auto through =
            std::count_if(lines.begin(), lines.end(), [&](const QLineF& line) { return crosses(line, box); });
        if (best && through >= fewest) continue;
        best = by;
        fewest = through;
    }
    if (!best) return;
    area.labels.emplace_back(at + *best - QPointF(0, metrics.ascent()), QSizeF(width, metrics.height()));
    haloText(p, at + *best, name);
}

/// Its points and lines; what was drawn goes to `lines`. The place for its name, when something of it is seen.
std::optional<QPointF> landmark(QPainter& p, const Area& area, const ShownLandmark& one,
                                std::optional<std::size_t> grabbed, std::vector<QLineF>& lines) {
    const QColor colour = one.isSelected ? kLine : one.isInside ? kInside : kLandmark;
    const std::size_t count = one.pointsMm.size();
    const auto seen = [&](std::size_t i) -> std::optional<QPointF> {
        return i < one.hidden.size() && one.hidden[i] ? std::nullopt : area.at(one.pointsMm[i]);
    };
    for (std::size_t i = 0; count > 1 && i < (one.isRing ? count : count - 1); ++i)
        if (const auto a = seen(i), b = seen((i + 1) % count); a && b) {
            haloLine(p, *a, *b, colour, one.isSelected ? 2.2 : 1.3);
            lines.emplace_back(*a, *b);
        }
    if (count == 1)
        if (const auto at = seen(0)) dot(p, *at, colour, one.isSelected ? 4.5 : 3.2);
    if (grabbed)
        if (const auto at = seen(*grabbed)) dot(p, *at, kLine, 5.0);
    // Beside the middle of what is seen of it.
    std::vector<std::size_t> left;
    for (std::size_t i = 0; i < count; ++i)
        if (seen(i)) left.push_back(i);
    return left.empty() ? std::nullopt : seen(left[left.size() / 2]);
}

void landmarks(QPainter& p, const Area& area) {
    p.save();
    p.setFont(smaller(p.font(), 1.5));
    // What a strip covers nobody could read. Names stand over all lines, and the chosen one has its place first.
    const auto& all = area.state.landmarks;
    area.labels.insert(area.labels.end(), area.state.covered.begin(), area.state.covered.end());
    std::vector<QLineF> lines;
    std::vector<std::optional<QPointF>> places;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto& grabbed = area.state.grabbed;
        places.push_back(landmark(
            p, area, all[i], grabbed && grabbed->landmark == i ? std::optional(grabbed->point) : std::nullopt, lines));
    }
    for (std::size_t i = 0; i < all.size(); ++i)
        if (places[i] && all[i].isSelected) label(p, area, *places[i], all[i].name);
    for (std::size_t i = 0; i < all.size(); ++i)
        if (places[i] && !all[i].isSelected) landmarkName(p, area, *places[i], all[i].name, lines);
    p.restore();
}

/// What is said of the marked place: beside the ring, towards the side that has more room, never over it; above or
/// below what lies there already.
void markWords(QPainter& p, const Area& area, const QPointF& at, double ringRadius) {
    const double most = std::min(340.0, 0.45 * area.box.width());
    const bool isRight = at.x() < area.box.center().x();
    const double room = isRight ? area.box.right() - at.x() : at.x() - area.box.left();
    const double gap = ringRadius + 14.0;
    const QFontMetricsF metrics(p.font());
    const QRectF text = metrics.boundingRect(QRectF(0, 0, std::max(80.0, std::min(most, room - gap - 24.0)), 1e4),
                                             Qt::AlignLeft | Qt::TextWordWrap, area.state.markWords);
    QRectF box(0, 0, text.width() + 18.0, text.height() + 12.0);
    box.moveTop(std::clamp(at.y() - box.height() / 2.0, area.box.top() + 4.0,
                           std::max(area.box.top() + 4.0, area.box.bottom() - box.height() - 4.0)));
    box.moveLeft(isRight ? at.x() + gap : at.x() - gap - box.width());
    for (const QRectF& other : area.state.covered) {
        if (!other.intersects(box)) continue;
        const bool isBelow = area.box.bottom() - other.bottom() > box.height() + 12.0;
        box.moveTop(isBelow ? other.bottom() + 6.0 : other.top() - box.height() - 6.0);
    }
    const QPointF end(isRight ? box.left() : box.right(), std::clamp(at.y(), box.top(), box.bottom()));
    haloLine(p, end, {at.x() + (isRight ? 1 : -1) * ringRadius, at.y()}, kLine);
    area.labels.push_back(box);
    paintPanel(p, box);
    p.setPen(kText);
    p.drawText(box.adjusted(9, 6, -9, -6), Qt::AlignLeft | Qt::TextWordWrap, area.state.markWords);
}

/// Whole where it is seen, dashed and paler where the tooth hides it.
void mark(QPainter& p, const Area& area) {
    const auto at = area.state.markMm ? area.at(*area.state.markMm) : std::nullopt;
    if (!at) return;
    constexpr double kRadius = 11.0;
    const bool isHidden = area.state.isMarkHidden;
    QColor colour = kLine;
    if (isHidden) colour.setAlpha(150);
    p.save();
    p.setBrush(Qt::NoBrush);
    p.setPen(QPen(QColor(0, 0, 0, isHidden ? 90 : 150), 4.0));
    p.drawEllipse(*at, kRadius, kRadius);
    p.setPen(QPen(colour, 2.0, isHidden ? Qt::DashLine : Qt::SolidLine));
    p.drawEllipse(*at, kRadius, kRadius);
    p.restore();
    if (!isHidden) dot(p, *at, colour, 2.5);
    if (!area.state.markWords.isEmpty()) markWords(p, area, *at, kRadius);
}

void onTooth(QPainter& p, const Area& area) {
    const OverlayState& state = area.state;
    sectionFrame(p, area);
    landmarks(p, area);
    mark(p, area);
    // Who cuts on wants to see the cavity, and its readings are no longer true.
    for (const Measurement& one : state.pressed ? std::vector<Measurement>{} : state.measurements)
        measurement(p, area, one, false);
    if (state.thinnest && state.tool == Tool::pulp) {
        if (const auto at = area.at(state.thinnest->fromMm)) {
            const Light light = pulpLight(state.thinnest->valueMm, state.pulpLimits);
            const QColor lamp = colourOf(light);
            p.setPen(QPen(lamp, 2));
            p.drawEllipse(*at, 9, 9);
            dot(p, *at, lamp, 3);
            label(p, area, *at, Texts::tr("Thinnest: %1").arg(withWords(*state.thinnest, light, state.pulpLimits)),
                  &lamp);
        }
    }
    if (state.calliperStartMm) {
        const auto from = area.at(*state.calliperStartMm);
        if (from && state.pointerMm) {
            Measurement now;
            now.fromMm = *state.calliperStartMm;
            now.toMm = *state.pointerMm;
            now.valueMm = (now.toMm - now.fromMm).norm();
            measurement(p, area, now, true);
        }
        if (from) dot(p, *from, kLine);
    }
    if (state.reading) measurement(p, area, *state.reading, true);
    if (state.restMm)
        if (const auto at = area.at(*state.restMm)) {
            p.setPen(QPen(kLine, 2));
            p.drawEllipse(*at, 7, 7);
            dot(p, *at, kLine, 2.5);
            label(p, area, *at, Texts::tr("Finger rest"), nullptr);
        }
}

/// From the bur to the pointer, where it has run ahead: tissue holds the bur back, and there it strains to.
void leash(QPainter& p, const Area& area) {
    const OverlayState& state = area.state;
    if (!state.pressed || !state.pointer || !state.burTipMm || !area.box.contains(*state.pointer)) return;
    const auto tip = area.at(*state.burTipMm);
    if (!tip) return;
    const QPointF way = *state.pointer - *tip;
    const double length = std::hypot(way.x(), way.y());
    if (length < kLeashPixels) return;
    p.setPen(QPen(QColor(0, 0, 0, 70), 2.5, Qt::SolidLine, Qt::RoundCap));
    p.drawLine(*tip, *state.pointer);
    p.setPen(QPen(QColor(255, 255, 255, 150), 1.0, Qt::DashLine, Qt::RoundCap));
    p.drawLine(*tip, *state.pointer);
}

/// Open in its middle, where the point is.
void cross(QPainter& p, const QPointF& at) {
    constexpr double kInner = 4.0, kOuter = 14.0;
    for (const QPointF way : {QPointF(1, 0), QPointF(-1, 0), QPointF(0, 1), QPointF(0, -1)})
        haloLine(p, at + kInner * way, at + kOuter * way, kText);
}

}  // namespace

void paintPanel(QPainter& painter, const QRectF& box) {
    painter.setPen(QPen(kEdge, 1));
    painter.setBrush(kGround);
    painter.drawRoundedRect(box.adjusted(0.5, 0.5, -0.5, -0.5), kRound, kRound);
    painter.setBrush(Qt::NoBrush);
}

view::Camera clearOfWriting(const view::Camera& fitted, const view::Viewport& viewport) {
    const double h = viewport.height, free = h - 2 * kRowPixels;
    view::Camera camera = fitted;
    if (free > 0.3 * h)
        camera.eyeMm = camera.targetMm -
                       camera.forward() * (camera.distanceMm() * std::max(1.0, (1 - 2 * kFittedMargin) * h / free));
    return camera;
}

ScaleBar scaleBarFor(const view::Camera& camera, const view::Viewport& viewport) {
    const double mmPerPixel = view::mmPerPixel(camera, viewport, camera.targetMm);
    ScaleBar bar;
    // 5 mm, as a tooth is measured; another length only where that would be too long or too short to read.
    for (const double mm : {5.0, 2.0, 1.0, 0.5, 0.2}) {
        bar = {mm, mm / mmPerPixel};
        if (bar.pixels <= 0.4 * viewport.width) break;
    }
    for (const double mm : {10.0, 20.0, 50.0}) {
        if (bar.pixels >= 24.0) break;
        bar = {mm, mm / mmPerPixel};
    }
    return bar;
}

std::optional<QPointF> sectionHandle(const OverlayState& state, const view::Viewport& viewport) {
    if (!state.section || state.bounds.isEmpty()) return std::nullopt;
    const auto pixel = view::pixelOf(state.camera, viewport, handlePoint(state));
    if (!pixel) return std::nullopt;
    // Near the eye the frame leaves the picture: the handle stays at hand at its edge.
    const double edge = 16.0;
    return QPointF(std::clamp(pixel->x(), edge, std::max(edge, viewport.width - edge)),
                   std::clamp(pixel->y(), edge + 44.0, std::max(edge + 44.0, viewport.height - edge)));
}

void paintOverlay(QPainter& painter, const QRect& whole, const OverlayState& state) {
    painter.save();
    painter.setRenderHint(QPainter::Antialiasing, true);
    const QRectF all(whole);
    if (!state.message.isEmpty()) {
        message(painter, all, state);
        painter.restore();
        return;
    }
    QRectF right = all;
    if (state.compare) {
        const double half = std::floor(all.width() / 2);
        const QRectF left(all.left(), all.top(), half, all.height());
        right = QRectF(all.left() + half, all.top(), half, all.height());
        painter.setClipRect(left);
        onTooth(painter, {left, state, {}});
        caption(painter, left, Texts::tr("Before"), Qt::AlignRight);
        painter.setClipping(false);
        painter.fillRect(QRectF(right.left() - 1, right.top(), 2, right.height()), QColor(0, 0, 0));
        painter.setClipRect(right);
        caption(painter, right, Texts::tr("Now"), Qt::AlignLeft);
    }
    onTooth(painter, {right, state, {}});
    leash(painter, {right, state, {}});
    painter.setClipping(false);
    if (state.cross) cross(painter, *state.cross);
    legend(painter, all, state);
    depthScale(painter, all, state);
    if (state.scaleBar)
        scaleBar(painter, state.compare ? QRectF(all.topLeft(), QSizeF(right.width(), all.height())) : all, state);
    hint(painter, all, state, readout(painter, all, state));
    painter.restore();
}

}  // namespace handpiece::desktop
