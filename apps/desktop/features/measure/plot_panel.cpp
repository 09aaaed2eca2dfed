// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/measure/plot_panel.h"

#include <fmt/format.h>

#include <QBuffer>
#include <QMenu>
#include <QPainter>
#include <QSvgGenerator>
#include <QVBoxLayout>

#include "desktop/features/measure/plot_view.h"
#include "desktop/framework/mnemonics.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/parts.h"

namespace handpiece::desktop {

PlotPanel::PlotPanel(QWidget* parent) : QWidget(parent) {
    setObjectName("plotPanel");
    setAccessibleName(tr("Plots"));
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(6, 6, 6, 6);
    column->setSpacing(4);
    view_ = new PlotView(this);
    column->addWidget(view_, 1);
    auto* row = new QHBoxLayout;
    readout_ = note({}, this, "plotReadout");
    readout_->setWordWrap(false);
    readout_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    pause_ = iconButton("pause", "plotPause", tr("Hold the plots"), this, tr("Hold the plots; what comes is kept"));
    pause_->setCheckable(true);
    save_ = iconButton("save", "plotSave", tr("Save the plots"), this);
    save_->setPopupMode(QToolButton::InstantPopup);
    auto* menu = withMnemonics(new QMenu(save_));
    menu->setObjectName("plotSaveMenu");
    const auto add = [&](const QString& text, const char* format) {
        auto* action = menu->addAction(text, this, [this, format] { emit saveRequested(QString::fromLatin1(format)); });
        action->setObjectName(QStringLiteral("plotSave_") + QString::fromLatin1(format));
    };
    add(tr("Drawing (SVG)…"), "svg");
    add(tr("Picture (PNG)…"), "png");
    add(tr("Table (CSV)…"), "csv");
    save_->setMenu(menu);
    row->addWidget(readout_, 1);
    row->addWidget(pause_);
    row->addWidget(save_);
    column->addLayout(row);
    connect(view_, &PlotView::hovered, readout_, &QLabel::setText);
    connect(pause_, &QToolButton::toggled, this, [this](bool paused) {
        setPaused(paused);
        emit pausedChanged(paused);
    });
}

void PlotPanel::append(const std::vector<simulation::PlotPoint>& points) {
    view_->append(points);
}
void PlotPanel::addEvent(double timeS, const QString& label) {
    view_->addMark(timeS, label);
}
void PlotPanel::clear() {
    view_->clear();
}
void PlotPanel::setForceLimit(double limitN) {
    view_->setForceLimit(limitN);
}
void PlotPanel::setFreeSpeed(double rpm) {
    view_->setFreeSpeed(rpm);
}
bool PlotPanel::paused() const {
    return view_->paused();
}
void PlotPanel::setDetail(Detail detail) {
    view_->setPractice(detail == Detail::practice);
}
double PlotPanel::largestDrawn(int plot) const {
    return view_->largestDrawn(plot);
}

void PlotPanel::setPaused(bool paused) {
    view_->setPaused(paused);
    const QSignalBlocker quiet(pause_);
    pause_->setChecked(paused);
    pause_->setIcon(icon(paused ? "play" : "pause"));
    pause_->setToolTip(paused ? tr("Let the plots go on") : tr("Hold the plots; what comes is kept"));
}

QByteArray PlotPanel::svg(const QSize& size) const {
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    QSvgGenerator generator;
    generator.setOutputDevice(&buffer);
    generator.setSize(size);
    generator.setViewBox(QRect(QPoint(), size));
    generator.setTitle(tr("Force, depth and rotor speed"));
    QPainter painter(&generator);
    view_->draw(painter, size);
    painter.end();
    return bytes;
}

QImage PlotPanel::picture(const QSize& size, double pixelRatio) const {
    QImage image(size * pixelRatio, QImage::Format_RGB32);
    image.setDevicePixelRatio(pixelRatio);
    QPainter painter(&image);
    view_->draw(painter, size);
    return image;
}

QByteArray PlotPanel::csv() const {
    // The same words and figures in every language, so that programs can read them.
    fmt::memory_buffer out;
    fmt::format_to(std::back_inserter(out), "time [s],force [N],depth [mm],speed [rpm],least speed [rpm]");
    for (std::size_t i = 1; i < cases::kTissueCount; ++i)
        fmt::format_to(std::back_inserter(out), ",removed {} [mm3]",
                       cases::properties(static_cast<cases::Tissue>(i)).name);
    fmt::format_to(std::back_inserter(out), ",flags\n");
    for (const auto& p : view_->points()) {
        fmt::format_to(std::back_inserter(out), "{},{},{},{},{}", p.timeS, p.forceN, p.depthMm, p.speedRpm, p.leastRpm);
        for (std::size_t i = 1; i < cases::kTissueCount; ++i)
            fmt::format_to(std::back_inserter(out), ",{}", p.removedMm3[i]);
        fmt::format_to(std::back_inserter(out), ",{}\n", p.flags);
    }
    return {out.data(), static_cast<qsizetype>(out.size())};
}

}  // namespace handpiece::desktop
