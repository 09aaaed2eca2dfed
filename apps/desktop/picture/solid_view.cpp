// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/solid_view.h"

#include <QEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QToolButton>
#include <QVBoxLayout>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "desktop/widgets/notation.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::desktop {
namespace {

constexpr double kRadPerPixel = 0.01, kKeyRad = 0.15, kWheelFactor = 1.12;
constexpr double kHandlePixels = 6.0, kHandleReach = 14.0, kShownWayMm = 0.9;
constexpr double kMaxSoftwarePixels = 0.9e6;  // more would follow the hand too late

std::array<std::uint8_t, 3> rgb(const QColor& colour) {
    return {static_cast<std::uint8_t>(colour.red()), static_cast<std::uint8_t>(colour.green()),
            static_cast<std::uint8_t>(colour.blue())};
}

}  // namespace

/// All that belongs to the drawing thread, and the latest wish.
struct SolidView::Worker {
    struct Wish {
        std::shared_ptr<const std::vector<cases::Part>> parts;
        std::shared_ptr<const std::vector<view::GlassSurface>> glass;
        core::Box bounds;
        view::Camera camera;
        view::Look look;
        QSize size;
        double ratio = 1.0;
        std::uint64_t number = 0;
    };
    explicit Worker(SolidView* view) : owner(view), thread([this] { run(); }) {}
    ~Worker() {
        {
            const std::lock_guard lock(mutex);
            stop = true;
        }
        wake.notify_all();
        thread.join();
    }
    void set(Wish next) {
        {
            const std::lock_guard lock(mutex);
            next.number = wish.number + 1;
            wish = std::move(next);
        }
        wake.notify_all();
    }
    void tell() {
        // The queue is emptied with the widget, which outlives this thread.
        QMetaObject::invokeMethod(
            owner, [owner = owner] { owner->take(); }, Qt::QueuedConnection);
    }
    void run();

    SolidView* owner;
    std::mutex mutex;
    std::condition_variable wake;
    bool stop = false;
    Wish wish;
    std::uint64_t drawn = 0;
    QImage ready;
    std::uint64_t readyOf = 0;  ///< the wish that it was drawn for
    QString missing;
    std::thread thread;
};

void SolidView::Worker::run() {
    std::unique_ptr<view::Renderer> renderer;
    std::shared_ptr<const std::vector<cases::Part>> shown;
    std::shared_ptr<const std::vector<view::GlassSurface>> glass;
    view::Image image;
    bool refining = false;
    std::uint64_t done = 0;
    for (;;) {
        Wish now;
        {
            std::unique_lock lock(mutex);
            wake.wait(lock, [&] { return stop || refining || wish.number != done; });
            if (stop) return;
            now = wish;
        }
        done = now.number;
        try {
            if (!renderer) {
                renderer = std::make_unique<view::Renderer>();
                renderer->setResponsive(true);
            }
            if (now.parts != shown) {
                shown = now.parts;
                renderer->setTooth(now.bounds);
                // As scenery: it takes open pieces and any tissue.
                static const std::vector<cases::Part> kNone;
                renderer->setScenery(shown ? *shown : kNone);
                glass.reset();  // forgotten with the tooth before
            }
            if (now.glass != glass) {
                glass = now.glass;
                renderer->setGlass(glass ? *glass : std::vector<view::GlassSurface>{});
            }
            double scale = renderer->isSoftware() ? 1.0 : now.ratio;
            const double area = scale * scale * now.size.width() * now.size.height();
            if (renderer->isSoftware() && area > kMaxSoftwarePixels) scale *= std::sqrt(kMaxSoftwarePixels / area);
            view::Moment moment;
            moment.burShown = false;
            const view::Viewport viewport{std::max(1, static_cast<int>(std::lround(scale * now.size.width()))),
                                          std::max(1, static_cast<int>(std::lround(scale * now.size.height())))};
            refining = renderer->draw(now.camera, viewport, now.look, moment, image).refining;
            const std::lock_guard lock(mutex);
            ready = QImage(image.rgba.data(), image.width, image.height, 4 * image.width, QImage::Format_RGBX8888)
                        .convertToFormat(QImage::Format_RGB32);
            readyOf = now.number;
            if (!refining) drawn = now.number;
        } catch (const std::exception& error) {
            refining = false;
            const std::lock_guard lock(mutex);
            missing = QString::fromStdString(core::asError(error).problem());
            drawn = now.number;
        }
        tell();
    }
}

SolidView::SolidView(const char* name, QWidget* parent) : QWidget(parent) {
    placeholder_ = tr("The tooth appears here when its tissues are found");
    setObjectName(QLatin1String(name));
    setAccessibleName(tr("The tooth, to be turned"));
    setToolTip(tr("Drag: turn. Right button: shift. Wheel: nearer. Double click: all of it. Arrow keys turn."));
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    setAttribute(Qt::WA_OpaquePaintEvent);
    look_.bur = look_.turbine = false;
    look_.wet = false;
    look_.debris = look_.spray = false;
    look_.palette = view::Palette::textbook;
    look_.quality = view::Quality::fast;
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(8, 8, 8, 8);
    column->addStretch(1);
    tissues_ = new QHBoxLayout;
    tissues_->setSpacing(4);
    column->addLayout(tissues_);
    tissues_->addStretch(1);
    worker_ = std::make_unique<Worker>(this);
}

SolidView::~SolidView() {
    worker_.reset();
}

bool SolidView::isDrawn() const noexcept {
    const std::lock_guard lock(worker_->mutex);
    return worker_->drawn == worker_->wish.number && worker_->wish.number > 0;
}

void SolidView::setParts(std::shared_ptr<const std::vector<cases::Part>> parts, const core::Box& bounds) {
    const bool another =
        !parts_ || bounds_.isEmpty() ||
        (!bounds.isEmpty() && ((bounds.size() - bounds_.size()).norm() > 0.3 * bounds_.size().norm() ||
                               (bounds.centre() - bounds_.centre()).norm() > 0.2 * bounds_.size().norm()));
    parts_ = std::move(parts);
    bounds_ = bounds;
    makeTissueButtons();
    if (another || !placed_) fit();
    wish();
}

void SolidView::makeTissueButtons() {
    std::vector<cases::Tissue> there;
    for (const cases::Tissue tissue : {cases::Tissue::enamel, cases::Tissue::dentine, cases::Tissue::pulp,
                                       cases::Tissue::caries, cases::Tissue::restoration})
        if (parts_ && std::any_of(parts_->begin(), parts_->end(), [&](const auto& p) { return p.tissue == tissue; }))
            there.push_back(tissue);
    if (there == there_) return;
    there_ = there;
    while (tissues_->count() > 1)
        if (QLayoutItem* item = tissues_->takeAt(0)) {
            delete item->widget();
            delete item;
        }
    int at = 0;
    for (const cases::Tissue tissue : there_) {
        auto* button = named(new QToolButton(this), "", tissueName(tissue), tr("Show or hide this tissue"));
        button->setObjectName(objectName() + QLatin1Char('_') +
                              QString::fromUtf8(cases::properties(tissue).name.data(),
                                                static_cast<qsizetype>(cases::properties(tissue).name.size())));
        button->setText(tissueName(tissue));
        QPixmap swatch(12, 12);
        const auto colour = view::colourOf(tissue, look_.palette);  // as in the picture above it
        swatch.fill(QColor(colour[0], colour[1], colour[2]));
        button->setIcon(swatch);
        button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
        button->setCheckable(true);
        button->setChecked(look_.visible[static_cast<std::size_t>(tissue)]);
        button->setFont(scaledFont(font(), 0.85));
        button->setCursor(Qt::ArrowCursor);
        button->setFocusPolicy(Qt::StrongFocus);
        connect(button, &QToolButton::toggled, this, [this, tissue](bool on) { setTissueShown(tissue, on); });
        tissues_->insertWidget(at++, button);
    }
}

void SolidView::forgetPicture() {
    {
        const std::lock_guard lock(worker_->mutex);
        forgotten_ = worker_->wish.number;
    }
    picture_ = {};
    update();
}

void SolidView::setCaption(const QString& caption, bool isStale) {
    caption_ = caption;
    setAccessibleDescription(caption);
    isStale_ = isStale;
    update();
}

void SolidView::setPlaceholder(const QString& words) {
    placeholder_ = words;
    update();
}

void SolidView::setAxesShown(bool shown, int buccalSign) {
    axesShown_ = shown;
    buccalSign_ = buccalSign;
    update();
}

void SolidView::setTissueShown(cases::Tissue tissue, bool shown) {
    look_.visible[static_cast<std::size_t>(tissue)] = shown;
    wish();
}

void SolidView::lookFrom(view::StandardView from, const view::Standing& standing) {
    if (bounds_.isEmpty()) return;
    camera_ = view::standardView(from, bounds_, standing, {std::max(1, width()), std::max(1, height())});
    placed_ = true;
    wish();
}

void SolidView::setCamera(const view::Camera& camera) {
    camera_ = camera;
    placed_ = true;
    wish();
}

void SolidView::setGlass(std::vector<view::GlassSurface> surfaces) {
    glass_ = surfaces.empty() ? nullptr : std::make_shared<const std::vector<view::GlassSurface>>(std::move(surfaces));
    wish();
}

void SolidView::setHandles(std::vector<SolidHandle> handles) {
    if (isDragging()) {
        if (handles.size() != handles_.size())
            giveUpHandle();
        else
            handles[static_cast<std::size_t>(grabbed_)] = handles_[static_cast<std::size_t>(grabbed_)];
    }
    handles_ = std::move(handles);
    if (hovered_ >= static_cast<int>(handles_.size())) hovered_ = -1;
    update();
}

void SolidView::setHandleText(int handle, const QString& text) {
    handles_.at(static_cast<std::size_t>(handle)).text = text;
    update();
}

std::optional<QPointF> SolidView::handleAt(int handle) const {
    const SolidHandle& one = handles_.at(static_cast<std::size_t>(handle));
    const core::Vec3 place = one.placeMm + (handle == grabbed_ ? movedMm_ : 0.0) * one.way;
    const auto at = view::pixelOf(camera_, {std::max(1, width()), std::max(1, height())}, place);
    return at ? std::optional(QPointF(at->x(), at->y())) : std::nullopt;
}

int SolidView::handleUnder(const QPointF& pointer) const {
    int found = -1;
    double least = kHandleReach;
    for (int i = 0; i < static_cast<int>(handles_.size()); ++i)
        if (const auto at = handleAt(i)) {
            const double far = std::hypot(at->x() - pointer.x(), at->y() - pointer.y());
            if (far < least) least = far, found = i;
        }
    return found;
}

/// As far as the handle's way, seen in the picture, goes with the pointer; seen from its end up is onwards.
double SolidView::movedBy(const QPointF& pointer) const {
    const SolidHandle& one = handles_[static_cast<std::size_t>(grabbed_)];
    const view::Viewport port{std::max(1, width()), std::max(1, height())};
    const double mm = view::mmPerPixel(camera_, port, one.placeMm);
    const core::Vec2 by(pointer.x() - grabbedAt_.x(), pointer.y() - grabbedAt_.y());
    // Of a millimetre, as its place is seen.
    const core::Vec2 perMm(one.way.dot(camera_.right()) / mm, -one.way.dot(camera_.upward()) / mm);
    constexpr double kLeastSeen = 0.2;
    if (perMm.norm() * mm > kLeastSeen) return by.dot(perMm) / perMm.squaredNorm();
    return -by.y() * mm;
}

void SolidView::giveUpHandle() {
    const int was = std::exchange(grabbed_, -1);
    held_ = Qt::NoButton;
    movedMm_ = 0.0;
    update();
    if (was >= 0) emit handleGivenUp(was);
}

void SolidView::drawHandles(QPainter& painter) const {
    const view::Viewport port{std::max(1, width()), std::max(1, height())};
    painter.setFont(scaledFont(font(), 0.95));
    const int named = isDragging() ? grabbed_ : hovered_;
    for (int i = 0; i < static_cast<int>(handles_.size()); ++i) {
        const auto at = handleAt(i);
        if (!at) continue;
        const SolidHandle& one = handles_[static_cast<std::size_t>(i)];
        const core::Vec3 place = one.placeMm + (i == grabbed_ ? movedMm_ : 0.0) * one.way;
        const QColor colour = i == named ? QColor(0xff, 0xd5, 0x4a) : QColor(0xff, 0xff, 0xff);
        for (const double sign : {1.0, -1.0}) {
            const auto end = view::pixelOf(camera_, port, place + sign * kShownWayMm * one.way);
            if (!end) continue;
            const QPointF to(end->x(), end->y());
            painter.setPen(QPen(QColor(0, 0, 0, 150), 4, Qt::SolidLine, Qt::RoundCap));
            painter.drawLine(*at, to);
            painter.setPen(QPen(colour, 2, Qt::SolidLine, Qt::RoundCap));
            painter.drawLine(*at, to);
        }
        painter.setPen(QPen(QColor(0, 0, 0, 190), 1.5));
        painter.setBrush(colour);
        painter.drawEllipse(*at, kHandlePixels, kHandlePixels);
    }
    if (named < 0) return;
    const auto at = handleAt(named);
    const QString& text = handles_[static_cast<std::size_t>(named)].text;
    if (!at || text.isEmpty()) return;
    const QFontMetrics metrics = painter.fontMetrics();
    QRectF box(0, 0, metrics.horizontalAdvance(text) + 14.0, metrics.height() + 6.0);
    box.moveTo(at->x() + 14.0, at->y() - box.height() - 6.0);
    box.moveLeft(std::clamp(box.left(), 2.0, std::max(2.0, width() - box.width() - 2.0)));
    box.moveTop(std::clamp(box.top(), 2.0, std::max(2.0, height() - box.height() - 2.0)));
    painter.setPen(Qt::NoPen);
    painter.setBrush(QColor(0, 0, 0, 190));
    painter.drawRoundedRect(box, 4, 4);
    painter.setPen(QColor(0xff, 0xe9, 0xa8));
    painter.drawText(box, Qt::AlignCenter, text);
}

void SolidView::fit() {
    if (bounds_.isEmpty()) return;
    const view::Viewport viewport{std::max(1, width()), std::max(1, height())};
    if (!placed_)
        camera_ = view::standardView(view::StandardView::oblique, bounds_, 0, viewport);
    else
        camera_ = view::fitted(camera_, bounds_, viewport);
    placed_ = true;
}

void SolidView::wish() {
    if (!isVisible() || !parts_) return update();
    const QColor window = palette().color(QPalette::Window);
    look_.backgroundTop = rgb(isDark(palette()) ? QColor(0x34, 0x3a, 0x42) : mixed(window, Qt::black, 0.32));
    look_.backgroundBottom = rgb(isDark(palette()) ? QColor(0x16, 0x18, 0x1c) : mixed(window, Qt::black, 0.55));
    worker_->set({parts_, glass_, bounds_, camera_, look_, size(), devicePixelRatioF()});
}

void SolidView::take() {
    {
        const std::lock_guard lock(worker_->mutex);
        if (worker_->readyOf > forgotten_) picture_ = worker_->ready;
        missing_ = worker_->missing;
    }
    update();
}

void SolidView::drawAxes(QPainter& painter) const {
    const view::Viewport viewport{std::max(1, width()), std::max(1, height())};
    const double reach = 0.5 * bounds_.size().maxCoeff() + 1.5;
    const QString buccal = tr("Buccal"), lingual = tr("Lingual");
    struct Arrow {
        core::Vec3 along;
        QString name;
        QColor colour;
    };
    const Arrow arrows[] = {
        {core::Vec3::UnitZ(), tr("Occlusal"), QColor(0x6c, 0xb6, 0xff)},
        {core::Vec3::UnitX(), tr("Mesial"), QColor(0xff, 0x8f, 0x6b)},
        {core::Vec3::UnitY(),
         buccalSign_ > 0   ? buccal
         : buccalSign_ < 0 ? lingual
                           : tr("side"),
         QColor(0x7d, 0xdc, 0x8f)},
    };
    painter.setFont(scaledFont(font(), 0.95, true));
    for (const Arrow& arrow : arrows) {
        double length = std::max(reach, std::abs(arrow.along.dot(bounds_.size())) * 0.5 + 2.0);
        const auto from = view::pixelOf(camera_, viewport, bounds_.centre());
        auto to = view::pixelOf(camera_, viewport, bounds_.centre() + length * arrow.along);
        // Shorter, where its end would lie outside the picture.
        for (int i = 0; !to && i < 12; ++i) {
            length *= 0.85;
            to = view::pixelOf(camera_, viewport, bounds_.centre() + length * arrow.along);
        }
        if (!from || !to) continue;
        const QPointF a(from->x(), from->y()), b(to->x(), to->y());
        painter.setPen(QPen(QColor(0, 0, 0, 130), 4, Qt::SolidLine, Qt::RoundCap));
        painter.drawLine(a, b);
        painter.setPen(QPen(arrow.colour, 2, Qt::SolidLine, Qt::RoundCap));
        painter.drawLine(a, b);
        const QPointF way = b - a;
        const double far = std::hypot(way.x(), way.y());
        if (far > 12) {
            const QPointF unit = way / far, side(-unit.y(), unit.x());
            const QPointF head[3] = {b + 9 * unit, b + 5 * side, b - 5 * side};
            painter.setBrush(arrow.colour);
            painter.setPen(Qt::NoPen);
            painter.drawPolygon(head, 3);
        }
        const double wide = painter.fontMetrics().horizontalAdvance(arrow.name), high = painter.fontMetrics().height();
        QRectF label(0, 0, wide + 4, high);
        const QPointF off = far > 1 ? way / far * (14.0 + 0.5 * (std::abs(way.x()) > std::abs(way.y()) ? wide : high))
                                    : QPointF(0, -14);
        label.moveCenter(b + off);
        label.moveLeft(std::clamp(label.left(), 2.0, std::max(2.0, width() - label.width() - 2.0)));
        label.moveTop(std::clamp(label.top(), 2.0, std::max(2.0, height() - label.height() - 2.0)));
        painter.setPen(QColor(0, 0, 0, 170));
        painter.drawText(label.translated(1, 1), Qt::AlignCenter, arrow.name);
        painter.setPen(arrow.colour);
        painter.drawText(label, Qt::AlignCenter, arrow.name);
    }
}

void SolidView::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    QPainter painter(this);
    painter.setRenderHint(QPainter::SmoothPixmapTransform);
    const bool hasPicture = parts_ && !picture_.isNull() && missing_.isEmpty();
    if (hasPicture)
        painter.drawImage(rect(), picture_);
    else
        painter.fillRect(rect(), isDark(palette()) ? QColor(0x24, 0x28, 0x2e)
                                                   : mixed(palette().color(QPalette::Window), Qt::black, 0.45));
    painter.setRenderHint(QPainter::Antialiasing);
    if (hasPicture && axesShown_) drawAxes(painter);
    if (hasPicture) drawHandles(painter);
    painter.setFont(scaledFont(font(), 0.9));
    const QColor pale(0xe8, 0xec, 0xf1);
    if (!caption_.isEmpty()) {
        constexpr int kFlags = Qt::AlignLeft | Qt::AlignTop | Qt::TextWordWrap;
        const QRectF text = painter.boundingRect(QRectF(15, 10, width() - 30.0, height() - 20.0), kFlags, caption_);
        const QRectF box = text.adjusted(-7, -3, 7, 3);
        painter.setPen(Qt::NoPen);
        painter.setBrush(QColor(0, 0, 0, 120));
        painter.drawRoundedRect(box, 4, 4);
        painter.setPen(isStale_ ? QColor(0xf5, 0xb8, 0x3d) : pale);
        painter.drawText(text, kFlags, caption_);
    }
    if (!hasPicture) {
        painter.setPen(pale);
        painter.drawText(
            QRectF(rect()).adjusted(20, 20, -20, -20), Qt::AlignCenter | Qt::TextWordWrap,
            missing_.isEmpty() ? placeholder_ : tr("There is no picture. Technical detail: %1").arg(missing_));
    }
    if (hasFocus()) {
        painter.setPen(QPen(palette().color(QPalette::Highlight), 2));
        painter.setBrush(Qt::NoBrush);
        painter.drawRect(QRectF(rect()).adjusted(1, 1, -1, -1));
    }
}

void SolidView::resizeEvent(QResizeEvent* event) {
    if (placed_ && event->oldSize().isValid()) fit();
    wish();
    QWidget::resizeEvent(event);
}

void SolidView::showEvent(QShowEvent* event) {
    QWidget::showEvent(event);
    if (parts_ && picture_.isNull()) fit();
    wish();
}

void SolidView::changeEvent(QEvent* event) {
    if (event->type() == QEvent::PaletteChange) wish();
    QWidget::changeEvent(event);
}

void SolidView::mousePressEvent(QMouseEvent* event) {
    if (isDragging()) return giveUpHandle();  // another button
    held_ = event->button();
    last_ = event->position();
    if (held_ != Qt::LeftButton) return;
    grabbed_ = handleUnder(last_);
    grabbedAt_ = last_;
    movedMm_ = 0.0;
    if (isDragging()) update();
}

void SolidView::mouseMoveEvent(QMouseEvent* event) {
    if (held_ == Qt::NoButton) {
        if (const int now = handleUnder(event->position()); now != hovered_) {
            hovered_ = now;
            setCursor(hovered_ >= 0 ? Qt::OpenHandCursor : Qt::ArrowCursor);
            update();
        }
        return;
    }
    if (isDragging()) {
        movedMm_ = movedBy(event->position());
        update();
        emit handleDragged(grabbed_, movedMm_);
        return;
    }
    const QPointF by = event->position() - last_;
    last_ = event->position();
    if (held_ == Qt::LeftButton)
        camera_ = view::orbited(camera_, kRadPerPixel * by.x(), -kRadPerPixel * by.y());
    else
        camera_ = view::panned(camera_, {std::max(1, width()), std::max(1, height())}, {by.x(), by.y()});
    wish();
}

void SolidView::mouseReleaseEvent(QMouseEvent* event) {
    if (event->button() != held_) return;
    held_ = Qt::NoButton;
    if (!isDragging()) return;
    const int was = std::exchange(grabbed_, -1);
    const double moved = std::exchange(movedMm_, 0.0);
    // It stands there until it is told anew.
    handles_[static_cast<std::size_t>(was)].placeMm += moved * handles_[static_cast<std::size_t>(was)].way;
    hovered_ = was;
    update();
    emit handleDropped(was, moved);
}

bool SolidView::event(QEvent* event) {
    // While a handle is held Escape is not the dialog's.
    if (event->type() == QEvent::ShortcutOverride && isDragging() &&
        static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape) {
        event->accept();
        return true;
    }
    return QWidget::event(event);
}

void SolidView::focusOutEvent(QFocusEvent* event) {
    if (isDragging()) giveUpHandle();
    QWidget::focusOutEvent(event);
}

void SolidView::leaveEvent(QEvent* event) {
    hovered_ = -1;
    update();
    QWidget::leaveEvent(event);
}

void SolidView::mouseDoubleClickEvent(QMouseEvent* event) {
    Q_UNUSED(event);
    fit();
    wish();
}

void SolidView::wheelEvent(QWheelEvent* event) {
    camera_ = view::zoomed(camera_, {std::max(1, width()), std::max(1, height())},
                           {event->position().x(), event->position().y()},
                           std::pow(kWheelFactor, event->angleDelta().y() / 120.0));
    wish();
    event->accept();
}

void SolidView::keyPressEvent(QKeyEvent* event) {
    switch (event->key()) {
        case Qt::Key_Escape:
            if (!isDragging()) return QWidget::keyPressEvent(event);
            return giveUpHandle();
        case Qt::Key_Left:
            camera_ = view::orbited(camera_, -kKeyRad, 0);
            break;
        case Qt::Key_Right:
            camera_ = view::orbited(camera_, kKeyRad, 0);
            break;
        case Qt::Key_Up:
            camera_ = view::orbited(camera_, 0, kKeyRad);
            break;
        case Qt::Key_Down:
            camera_ = view::orbited(camera_, 0, -kKeyRad);
            break;
        case Qt::Key_Home:
            fit();
            break;
        default:
            return QWidget::keyPressEvent(event);
    }
    wish();
}

}  // namespace handpiece::desktop
