// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/slice_view.h"

#include <QApplication>
#include <QLocale>
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>

#include "desktop/features/scan/tissue_colours.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

using segmentation::Region;
using segmentation::Solid;

namespace {

constexpr double kMaxZoom = 40.0, kZoomStep = 1.2;
// A wish, not a law: a window narrower than this share of what there is shows noise only.
constexpr float kMinWindow = 1e-4f;

const QColor kCrossColours[3] = {QColor(0x5db8f5), QColor(0x7ddc8f), QColor(0xffa65c)};  // axial, coronal, sagittal

/// Lines where the values, a plane of width x height, are zero: marching squares, ends by linear interpolation.
std::vector<QLineF> zeroLines(const std::vector<float>& values, int width, int height) {
    std::vector<QLineF> lines;
    const auto at = [&](int x, int y) {
        return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    };
    for (int y = 0; y + 1 < height; ++y)
        for (int x = 0; x + 1 < width; ++x) {
            const float c[4] = {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)};
            QPointF ends[4];
            int count = 0;
            for (int e = 0; e < 4; ++e) {
                const float a = c[e], b = c[(e + 1) % 4];
                if ((a > 0) == (b > 0)) continue;
                const double t = double(a) / (double(a) - double(b));
                static constexpr int kX[5] = {0, 1, 1, 0, 0}, kY[5] = {0, 0, 1, 1, 0};
                ends[count++] = {x + kX[e] + t * (kX[e + 1] - kX[e]), y + kY[e] + t * (kY[e + 1] - kY[e])};
            }
            if (count >= 2) lines.emplace_back(ends[0], ends[1]);
            if (count == 4) lines.emplace_back(ends[2], ends[3]);
        }
    return lines;
}

}  // namespace

SliceView::SliceView(Direction direction, QWidget* parent) : QWidget(parent), direction_(direction) {
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    setCursor(Qt::CrossCursor);
    setAttribute(Qt::WA_OpaquePaintEvent);
    switch (direction) {
        case Direction::axial:
            u_ = 0, v_ = 1, w_ = 2;
            setObjectName(QStringLiteral("sliceAxial"));
            setAccessibleName(tr("Slice across (axial)"));
            break;
        case Direction::coronal:
            u_ = 0, v_ = 2, w_ = 1;
            setObjectName(QStringLiteral("sliceCoronal"));
            setAccessibleName(tr("Slice along, from the front (coronal)"));
            break;
        case Direction::sagittal:
            u_ = 1, v_ = 2, w_ = 0;
            setObjectName(QStringLiteral("sliceSagittal"));
            setAccessibleName(tr("Slice along, from the side (sagittal)"));
            break;
    }
    setToolTip(
        tr("Wheel: through the slices. Ctrl and wheel: nearer. Right button: brightness and contrast. Middle button: "
           "shift. Double click: all of the slice."));
}

void SliceView::setScan(std::shared_ptr<const volume::Volume> scan) {
    scan_ = std::move(scan);
    fit();
    greyStale_ = overlayStale_ = true;
    update();
}

void SliceView::setRegion(std::shared_ptr<const Region> region) {
    region_ = std::move(region);
    overlayStale_ = true;
    update();
}

void SliceView::setDecisions(const segmentation::Settings& decisions) {
    decisions_ = decisions;
    update();
}

void SliceView::setCross(const core::Vec3& mm) {
    const int before = slice();
    crossMm_ = mm;
    if (slice() != before) greyStale_ = overlayStale_ = true;
    tell();
    update();
}

void SliceView::setWindow(float black, float white) {
    black_ = black;
    white_ = std::max(white, black + kMinWindow);
    greyStale_ = true;
    update();
}

void SliceView::setTool(SliceTool tool, double radiusMm, cases::Tissue tissue) {
    tool_ = tool;
    radiusMm_ = radiusMm;
    tissue_ = tissue;
    update();
}

void SliceView::setFillShown(bool shown) {
    fillShown_ = shown;
    update();
}

void SliceView::fit() {
    zoom_ = 1.0;
    shiftMm_ = {};
    update();
}

int SliceView::slice() const {
    if (!scan_) return 0;
    return std::clamp(static_cast<int>(std::lround(scan_->grid.toVoxels(crossMm_)[w_])), 0, scan_->grid.size[w_] - 1);
}

void SliceView::tell() {
    if (!scan_) return;
    setAccessibleDescription(tr("slice %1 of %2").arg(slice() + 1).arg(scan_->grid.size[w_]));
}

// ---- where things lie

double SliceView::pixelsPerMm() const {
    if (!scan_) return 1.0;
    const volume::Grid& g = scan_->grid;
    return zoom_ * std::min(width() / (g.size[u_] * g.spacingMm[u_]), height() / (g.size[v_] * g.spacingMm[v_]));
}

/// From mm along the slice's two axes to pixels: in the two slices along, the last slice is on top when it lies
/// headwards.
QPointF SliceView::pixelOfMm(const QPointF& mm) const {
    const volume::Grid& g = scan_->grid;
    const double scale = pixelsPerMm();
    const double up = v_ == 2 && g.axes(2, 2) >= 0 ? -1.0 : 1.0;
    const QPointF middle(0.5 * (g.size[u_] - 1) * g.spacingMm[u_] + shiftMm_.x(),
                         0.5 * (g.size[v_] - 1) * g.spacingMm[v_] + shiftMm_.y());
    return {0.5 * width() + scale * (mm.x() - middle.x()), 0.5 * height() + up * scale * (mm.y() - middle.y())};
}

QPointF SliceView::inSlice(const core::Vec3& mm) const {
    const core::Vec3 along = scan_->grid.axes.transpose() * (mm - scan_->grid.originMm);
    return {along[u_], along[v_]};
}

QPointF SliceView::pixelOf(const core::Vec3& mm) const {
    return scan_ ? pixelOfMm(inSlice(mm)) : QPointF();
}

core::Vec3 SliceView::pointAt(const QPointF& pixel) const {
    if (!scan_) return core::Vec3::Zero();
    const volume::Grid& g = scan_->grid;
    const double scale = pixelsPerMm();
    const double up = v_ == 2 && g.axes(2, 2) >= 0 ? -1.0 : 1.0;
    core::Vec3 ijk;
    ijk[u_] = 0.5 * (g.size[u_] - 1) + (shiftMm_.x() + (pixel.x() - 0.5 * width()) / scale) / g.spacingMm[u_];
    ijk[v_] = 0.5 * (g.size[v_] - 1) + (shiftMm_.y() + up * (pixel.y() - 0.5 * height()) / scale) / g.spacingMm[v_];
    ijk[w_] = slice();
    for (const int axis : {u_, v_})
        ijk[axis] = std::clamp(ijk[axis], 0.0, double(g.size[axis] - 1));
    return g.toMm(ijk);
}

// ---- what is drawn

void SliceView::makeGrey() {
    greyStale_ = false;
    const volume::Grid& g = scan_->grid;
    const int width = g.size[u_], height = g.size[v_], at = slice();
    grey_ = QImage(width, height, QImage::Format_Grayscale8);
    const float scale = 255.0f / (white_ - black_);
    std::array<int, 3> ijk{};
    ijk[static_cast<std::size_t>(w_)] = at;
    const std::size_t strides[3] = {1, static_cast<std::size_t>(g.size[0]),
                                    static_cast<std::size_t>(g.size[0]) * static_cast<std::size_t>(g.size[1])};
    for (int y = 0; y < height; ++y) {
        uchar* row = grey_.scanLine(y);
        const std::size_t start =
            strides[w_] * static_cast<std::size_t>(at) + strides[v_] * static_cast<std::size_t>(y);
        for (int x = 0; x < width; ++x) {
            const float value = (scan_->values[start + strides[u_] * static_cast<std::size_t>(x)] - black_) * scale;
            row[x] = static_cast<uchar>(std::clamp(value, 0.0f, 255.0f));
        }
    }
}

void SliceView::makeOverlay() {
    overlayStale_ = false;
    contours_.clear();
    fill_ = QImage();
    if (!region_) return;
    const volume::Grid& r = region_->grid;
    core::Vec3 ijk = core::Vec3::Zero();
    ijk[w_] = slice();
    const double level = r.toVoxels(scan_->grid.toMm(ijk))[w_];
    if (!(level >= 0 && level <= r.size[w_] - 1)) return;
    const int low = std::min(static_cast<int>(level), std::max(0, r.size[w_] - 2));
    const int high = std::min(low + 1, r.size[w_] - 1);
    const float share = static_cast<float>(level - low);
    const int width = r.size[u_], height = r.size[v_];
    const std::size_t strides[3] = {1, static_cast<std::size_t>(r.size[0]),
                                    static_cast<std::size_t>(r.size[0]) * static_cast<std::size_t>(r.size[1])};
    const auto planeOf = [&](const Solid& solid) {
        std::vector<float> plane(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const std::size_t in =
                    strides[u_] * static_cast<std::size_t>(x) + strides[v_] * static_cast<std::size_t>(y);
                plane[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
                    (1.0f - share) * solid.distanceMm[in + strides[w_] * static_cast<std::size_t>(low)] +
                    share * solid.distanceMm[in + strides[w_] * static_cast<std::size_t>(high)];
            }
        return plane;
    };
    const QPointF origin = inSlice(r.originMm);
    const auto addLines = [&](const std::vector<float>& plane, cases::Tissue tissue, bool isAuthored) {
        Contour contour{tissue, isAuthored, zeroLines(plane, width, height)};
        for (QLineF& line : contour.lines)
            line = {origin.x() + line.x1() * r.spacingMm[u_], origin.y() + line.y1() * r.spacingMm[v_],
                    origin.x() + line.x2() * r.spacingMm[u_], origin.y() + line.y2() * r.spacingMm[v_]};
        contours_.push_back(std::move(contour));
    };
    fill_ = QImage(width, height, QImage::Format_ARGB32_Premultiplied);
    fill_.fill(Qt::transparent);
    const std::vector<float> outer = planeOf(region_->outer);
    const auto paint = [&](const std::vector<float>& plane, cases::Tissue tissue) {
        QColor colour = tissueColour(tissue);
        colour.setAlphaF(0.32f);
        const QRgb pixel = qPremultiply(colour.rgba());
        for (int y = 0; y < height; ++y) {
            auto* row = reinterpret_cast<QRgb*>(fill_.scanLine(y));
            for (int x = 0; x < width; ++x) {
                const std::size_t n =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
                if (plane[n] < 0 && outer[n] < 0) row[x] = pixel;
            }
        }
    };
    paint(outer, cases::Tissue::enamel);
    addLines(outer, cases::Tissue::enamel, false);
    for (const Solid& solid : region_->solids) {
        const std::vector<float> plane = planeOf(solid);
        paint(plane, solid.tissue);
        addLines(plane, solid.tissue, solid.isAuthored);
    }
}

void SliceView::drawDecisions(QPainter& painter) const {
    const double scale = pixelsPerMm();
    const core::Vec3 normal = scan_->grid.axes.col(w_);
    core::Vec3 ijk = core::Vec3::Zero();
    ijk[w_] = slice();
    const core::Vec3 inPlane = scan_->grid.toMm(ijk);
    painter.setBrush(Qt::NoBrush);
    for (const segmentation::Mark& mark : decisions_.marks) {
        const double away = (mark.centreMm - inPlane).dot(normal);
        const double r2 = mark.radiusMm * mark.radiusMm - away * away;
        if (r2 <= 0) continue;
        painter.setPen(QPen(tissueColour(mark.tissue), 1.2, Qt::DotLine));
        painter.drawEllipse(pixelOf(mark.centreMm), scale * std::sqrt(r2), scale * std::sqrt(r2));
    }
    for (const segmentation::AuthoredLesion& lesion : decisions_.lesions) {
        // The ellipsoid's axes are the scanner's: seen along one of the grid's it is drawn as for parallel axes.
        const core::Vec3 half = scan_->grid.axes.transpose().cwiseAbs() * lesion.halfAxesMm;
        const double away = (lesion.centreMm - inPlane).dot(normal) / std::max(1e-6, half[w_]);
        const double share = 1.0 - away * away;
        if (share <= 0) continue;
        painter.setPen(QPen(tissueColour(cases::Tissue::caries), 1.6, Qt::DashLine));
        painter.drawEllipse(pixelOf(lesion.centreMm), scale * half[u_] * std::sqrt(share),
                            scale * half[v_] * std::sqrt(share));
    }
    for (const segmentation::CutPlane& cut : decisions_.cutPlanes) {
        // Where the plane meets this slice, and short lines on the side that is left out.
        const core::Vec3 along = cut.normal.cross(normal);
        if (along.norm() < 1e-3) continue;
        core::Vec3 within = cut.normal - normal * normal.dot(cut.normal);
        const core::Vec3 on = inPlane + (cut.pointMm - inPlane) - normal * (cut.pointMm - inPlane).dot(normal);
        const double lift = (cut.pointMm - on).dot(cut.normal) / within.squaredNorm();
        const core::Vec3 middle = on + lift * within;
        const core::Vec3 direction = along.normalized();
        within.normalize();
        painter.setPen(QPen(QColor(0xff6b6b), 1.6));
        constexpr double kReachMm = 200.0, kEveryMm = 2.0;
        painter.drawLine(pixelOf(middle - kReachMm * direction), pixelOf(middle + kReachMm * direction));
        painter.setPen(QPen(QColor(0xff6b6b), 0.8));
        for (double s = -30.0; s <= 30.0; s += kEveryMm)
            painter.drawLine(pixelOf(middle + s * direction), pixelOf(middle + s * direction + 0.8 * within));
    }
}

void SliceView::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    QPainter painter(this);
    painter.fillRect(rect(), QColor(0x0c, 0x0e, 0x11));
    if (!scan_) return;
    if (greyStale_) makeGrey();
    if (overlayStale_) makeOverlay();
    painter.setRenderHint(QPainter::SmoothPixmapTransform);
    const volume::Grid& g = scan_->grid;
    const auto drawImage = [&](const QImage& image, const QPointF& firstMm, double du, double dv) {
        // A transform of its own: the image may stand upside down.
        const QPointF a = pixelOfMm(firstMm - QPointF(0.5 * du, 0.5 * dv));
        const QPointF b = pixelOfMm(firstMm + QPointF((image.width() - 0.5) * du, (image.height() - 0.5) * dv));
        painter.save();
        painter.translate(a);
        painter.scale((b.x() - a.x()) / image.width(), (b.y() - a.y()) / image.height());
        painter.drawImage(0, 0, image);
        painter.restore();
    };
    drawImage(grey_, {0, 0}, g.spacingMm[u_], g.spacingMm[v_]);
    painter.setRenderHint(QPainter::Antialiasing);
    if (region_ && !fill_.isNull() && fillShown_)
        drawImage(fill_, inSlice(region_->grid.originMm), region_->grid.spacingMm[u_], region_->grid.spacingMm[v_]);
    for (const Contour& contour : contours_) {
        painter.setPen(QPen(tissueColour(contour.tissue), 1.5, contour.isAuthored ? Qt::DashLine : Qt::SolidLine));
        std::vector<QLineF> lines;
        lines.reserve(contour.lines.size());
        for (const QLineF& line : contour.lines)
            lines.emplace_back(pixelOfMm(line.p1()), pixelOfMm(line.p2()));
        painter.drawLines(lines.data(), static_cast<int>(lines.size()));
    }
    drawDecisions(painter);

    // The cross, open in the middle, in the colours of the slices it stands for.
    const QPointF cross = pixelOf(crossMm_);
    const auto colourOf = [](int axis) { return kCrossColours[axis == 2 ? 0 : axis == 1 ? 1 : 2]; };
    constexpr double kGap = 7.0;
    QColor across = colourOf(v_), down = colourOf(u_);
    across.setAlphaF(0.75f);
    down.setAlphaF(0.75f);
    painter.setPen(QPen(across, 1));
    painter.drawLine(QPointF(0, cross.y()), QPointF(cross.x() - kGap, cross.y()));
    painter.drawLine(QPointF(cross.x() + kGap, cross.y()), QPointF(width(), cross.y()));
    painter.setPen(QPen(down, 1));
    painter.drawLine(QPointF(cross.x(), 0), QPointF(cross.x(), cross.y() - kGap));
    painter.drawLine(QPointF(cross.x(), cross.y() + kGap), QPointF(cross.x(), height()));

    if (hovering_ && (tool_ == SliceTool::brush || tool_ == SliceTool::lesion)) {
        painter.setPen(
            QPen(tool_ == SliceTool::lesion ? tissueColour(cases::Tissue::caries) : tissueColour(tissue_), 1.5));
        painter.setBrush(Qt::NoBrush);
        painter.drawEllipse(hover_, radiusMm_ * pixelsPerMm(), radiusMm_ * pixelsPerMm());
    }
    if (held_ == Qt::LeftButton && tool_ == SliceTool::cut) {
        painter.setPen(QPen(QColor(0xff6b6b), 2));
        painter.drawLine(from_, last_);
    }

    // Name and place, and the frame in the colour of this slice's line in the others.
    const QString name = direction_ == Direction::axial     ? tr("Axial")
                         : direction_ == Direction::coronal ? tr("Coronal")
                                                            : tr("Sagittal");
    painter.setFont(scaledFont(font(), 0.9));
    const auto label = [&](const QRectF& area, int flags, const QString& text, const QColor& colour) {
        painter.setPen(QColor(0, 0, 0, 180));
        painter.drawText(area.translated(1, 1), flags, text);
        painter.setPen(colour);
        painter.drawText(area, flags, text);
    };
    const QRectF inner = QRectF(rect()).adjusted(8, 5, -8, -5);
    const QColor own = kCrossColours[static_cast<int>(direction_)];
    label(inner, Qt::AlignLeft | Qt::AlignTop, name, own);
    label(inner, Qt::AlignRight | Qt::AlignTop, QStringLiteral("%1 / %2").arg(slice() + 1).arg(g.size[w_]),
          QColor(0xd8, 0xde, 0xe6));
    painter.setPen(QPen(hasFocus() ? palette().color(QPalette::Highlight) : own.darker(190), hasFocus() ? 2 : 1));
    painter.setBrush(Qt::NoBrush);
    painter.drawRect(QRectF(rect()).adjusted(0.5, 0.5, -0.5, -0.5));
}

// ---- what the hand does

void SliceView::step(int slices) {
    if (!scan_) return;
    core::Vec3 ijk = scan_->grid.toVoxels(crossMm_);
    ijk[w_] = std::clamp(slice() + slices, 0, scan_->grid.size[w_] - 1);
    emit crossMoved(scan_->grid.toMm(ijk));
}

void SliceView::use(const QPointF& at) {
    const core::Vec3 point = pointAt(at);
    switch (tool_) {
        case SliceTool::look:
        case SliceTool::cut:
            emit crossMoved(point);
            break;
        case SliceTool::pick:
            emit crossMoved(point);
            emit picked(point);
            break;
        case SliceTool::brush:
            emit painted({point});
            break;
        case SliceTool::lesion:
            emit lesionPlaced(point);
            break;
    }
}

void SliceView::mousePressEvent(QMouseEvent* event) {
    if (!scan_ || held_ != Qt::NoButton) return;
    held_ = event->button();
    from_ = last_ = event->position();
    if (held_ == Qt::LeftButton && tool_ != SliceTool::cut) use(from_);
    update();
}

void SliceView::mouseMoveEvent(QMouseEvent* event) {
    if (!scan_) return;
    const QPointF at = event->position(), by = at - last_;
    hover_ = at;
    hovering_ = true;
    if (held_ == Qt::LeftButton) {
        if (tool_ == SliceTool::look) emit crossMoved(pointAt(at));
        if (tool_ == SliceTool::brush) {
            // A stroke is a row of balls, half a radius apart: close enough to be even, far enough to be few.
            constexpr int kMaxBalls = 100;
            const double apart = std::max(2.0, 0.5 * radiusMm_ * pixelsPerMm()), far = std::hypot(by.x(), by.y());
            const int balls = std::min(kMaxBalls, static_cast<int>(far / apart));
            if (balls == 0) return update();
            std::vector<core::Vec3> points;
            for (int i = 1; i <= balls; ++i)
                points.push_back(pointAt(last_ + by * (double(i) / balls)));
            emit painted(points);
        }
    } else if (held_ == Qt::RightButton) {
        const float unit = (white_ - black_) / 200.0f;
        const float middle = 0.5f * (black_ + white_) + static_cast<float>(by.y()) * unit;
        const float half = std::max(kMinWindow, 0.5f * (white_ - black_) + static_cast<float>(by.x()) * unit);
        emit windowDragged(middle - half, middle + half);
    } else if (held_ == Qt::MiddleButton) {
        const double scale = pixelsPerMm();
        const double up = v_ == 2 && scan_->grid.axes(2, 2) >= 0 ? -1.0 : 1.0;
        shiftMm_ -= QPointF(by.x() / scale, up * by.y() / scale);
    }
    last_ = at;
    update();
}

void SliceView::mouseReleaseEvent(QMouseEvent* event) {
    if (event->button() != held_) return;
    const bool left = held_ == Qt::LeftButton;
    held_ = Qt::NoButton;
    if (!scan_ || !left) return;
    last_ = event->position();
    const QPointF way = last_ - from_;
    if (tool_ == SliceTool::cut && std::hypot(way.x(), way.y()) > 8.0)
        emit cutDrawn(pointAt(from_), pointAt(last_), scan_->grid.axes.col(w_));
    if (tool_ == SliceTool::brush) emit strokeEnded();
    update();
}

void SliceView::wheelEvent(QWheelEvent* event) {
    if (!scan_) return;
    const double steps = event->angleDelta().y() / 120.0;
    if (event->modifiers() & Qt::ControlModifier) {
        const core::Vec3 under = pointAt(event->position());
        zoom_ = std::clamp(zoom_ * std::pow(kZoomStep, steps), 1.0, kMaxZoom);
        const QPointF off = event->position() - pixelOf(under);
        const double up = v_ == 2 && scan_->grid.axes(2, 2) >= 0 ? -1.0 : 1.0;
        shiftMm_ -= QPointF(off.x() / pixelsPerMm(), up * off.y() / pixelsPerMm());
        if (zoom_ <= 1.0) shiftMm_ = {};
        update();
    } else if (steps != 0) {
        step(steps > 0 ? 1 : -1);
    }
    event->accept();
}

void SliceView::keyPressEvent(QKeyEvent* event) {
    if (!scan_) return QWidget::keyPressEvent(event);
    const QPointF cross = pixelOf(crossMm_);
    const double voxel = pixelsPerMm() * scan_->grid.spacingMm[u_];
    const double far = event->modifiers() & Qt::ShiftModifier ? 10.0 : 1.0;
    const auto go = [&](double x, double y) { emit crossMoved(pointAt(cross + far * voxel * QPointF(x, y))); };
    switch (event->key()) {
        case Qt::Key_Left:
            return go(-1, 0);
        case Qt::Key_Right:
            return go(1, 0);
        case Qt::Key_Up:
            return go(0, -1);
        case Qt::Key_Down:
            return go(0, 1);
        case Qt::Key_PageUp:
            return step(static_cast<int>(far));
        case Qt::Key_PageDown:
            return step(-static_cast<int>(far));
        case Qt::Key_Plus:
        case Qt::Key_Minus:
            zoom_ = std::clamp(zoom_ * (event->key() == Qt::Key_Plus ? kZoomStep : 1.0 / kZoomStep), 1.0, kMaxZoom);
            if (zoom_ <= 1.0) shiftMm_ = {};
            return update();
        case Qt::Key_Home:
            return fit();
        case Qt::Key_Return:
        case Qt::Key_Enter:
            use(cross);
            if (tool_ == SliceTool::brush) emit strokeEnded();
            return;
        default:
            QWidget::keyPressEvent(event);
    }
}

void SliceView::leaveEvent(QEvent* event) {
    hovering_ = false;
    update();
    QWidget::leaveEvent(event);
}

void SliceView::focusInEvent(QFocusEvent* event) {
    update();
    QWidget::focusInEvent(event);
}
void SliceView::focusOutEvent(QFocusEvent* event) {
    update();
    QWidget::focusOutEvent(event);
}

}  // namespace handpiece::desktop
