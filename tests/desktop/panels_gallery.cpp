// SPDX-License-Identifier: Apache-2.0
/// Pictures of every panel in light and dark: panels_gallery FOLDER. For looking at, and for the user guide.

#include <QApplication>
#include <QDir>
#include <QElapsedTimer>
#include <QGridLayout>
#include <QImage>
#include <QLabel>
#include <QLineEdit>
#include <QPainter>
#include <cmath>
#include <cstdio>

#include "desktop/features/drill/drill_bar.h"
#include "desktop/features/drill/parameter_box.h"
#include "desktop/features/drill/welcome_strip.h"
#include "desktop/features/measure/measure_box.h"
#include "desktop/features/measure/plot_panel.h"
#include "desktop/features/measure/volume_bars.h"
#include "desktop/features/replay/replay_bar.h"
#include "desktop/features/sound/sound_control.h"
#include "desktop/features/view/view_bar.h"
#include "desktop/widgets/force_gauge.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/notice_bar.h"
#include "desktop/widgets/status_line.h"
#include "desktop/widgets/theme.h"
#include "desktop/widgets/tooth_chart.h"

using namespace handpiece;
using namespace handpiece::desktop;

namespace {

QString folder, suffix;

void keep(QWidget& widget, const QString& name, const QSize& size = {}) {
    widget.resize(size.isValid() ? size : widget.sizeHint());
    widget.show();
    QApplication::processEvents();
    const double ratio = 1.5;
    QImage image(widget.size() * ratio, QImage::Format_RGB32);
    image.setDevicePixelRatio(ratio);
    widget.render(&image);
    image.save(QDir(folder).filePath(name + suffix + ".png"));
}

std::vector<simulation::PlotPoint> aCut() {
    std::vector<simulation::PlotPoint> points;
    for (int i = 0; i <= 2000; ++i) {
        simulation::PlotPoint p;
        p.timeS = 30 + i * simulation::kPlotStepS;
        const double t = i * simulation::kPlotStepS, on = std::fmod(t, 5.0) > 1.2 && std::fmod(t, 5.0) < 4.4;
        p.forceN =
            static_cast<float>(on * (1.1 + 0.35 * std::sin(9 * t) + 0.12 * std::sin(71 * t)) + (i == 1420 ? 3.0 : 0));
        p.depthMm = static_cast<float>(std::min(1.9, 0.11 * t) * (on ? 1 : 0.4));
        p.speedRpm = static_cast<float>(380000 - on * (90000 + 30000 * std::sin(9 * t)));
        p.leastRpm = p.speedRpm - 2000;
        points.push_back(p);
    }
    return points;
}

void icons() {
    QWidget sheet;
    auto* grid = new QGridLayout(&sheet);
    int i = 0;
    for (const QString& name : iconNames()) {
        auto* picture = new QLabel(&sheet);
        picture->setPixmap(icon(name).pixmap(QSize(32, 32), 2.0));
        picture->setAlignment(Qt::AlignCenter);
        auto* text = new QLabel(name, &sheet);
        text->setFont(scaledFont(sheet.font(), 0.7));
        text->setAlignment(Qt::AlignCenter);
        grid->addWidget(picture, 2 * (i / 10), i % 10);
        grid->addWidget(text, 2 * (i / 10) + 1, i % 10);
        ++i;
    }
    auto* app = new QLabel(&sheet);
    app->setPixmap(applicationIcon().pixmap(QSize(96, 96), 2.0));
    grid->addWidget(app, 0, 10, 6, 1);
    keep(sheet, "icons");
}

void panels() {
    {
        DrillBar bar;
        bar.setBur("330");
        bar.setSpeed(360000);
        bar.setActualSpeed(287000, false);
        keep(bar, "drill_practice", {320, 720});
        auto* search = bar.findChild<QLineEdit*>("burSearch");
        search->setText("diamond");
        bar.setBur(instrument::catalogue().back().name.c_str());
        keep(bar, "drill_diamonds", {480, 820});
        search->clear();
        bar.setBur("330");
        bar.setDetail(Detail::laboratory);
        bar.setAllowedBurs({"330", "245", "round-1/2", "331"});
        bar.setActualSpeed(0, true);
        keep(bar, "drill_laboratory", {360, 760});
    }
    {
        SoundControl sound;
        keep(sound, "sound_practice", {280, 150});
        sound.setDetail(Detail::laboratory);
        sound.setSource(SoundControl::Channel::motor, SoundControl::Source::file, "my-turbine.wav");
        sound.setSource(SoundControl::Channel::cutting, SoundControl::Source::microphone);
        sound.setRecording(SoundControl::Channel::cutting, true);
        sound.setMicrophoneLevel(0.4);
        keep(sound, "sound_laboratory", {320, 330});
    }
    {
        ParameterBox box;
        box.setLimits({}, "Mouse");
        box.setMultipliers({1.4, 1.0, 0.5});
        box.setCutting(ParameterBox::Cutting::begun);
        keep(box, "parameters_laboratory", {380, 640});
        box.setDetail(Detail::practice);
        keep(box, "parameters_practice", {320, 200});
    }
    {
        PlotPanel plot;
        plot.append(aCut());
        plot.addEvent(33.2, "stroke 3");
        plot.addEvent(44.2, "pulp exposed");
        keep(plot, "plot", {520, 420});
        QElapsedTimer timer;
        double least = 1e9;
        QImage image(plot.size(), QImage::Format_RGB32);
        QWidget* view = plot.findChild<QWidget*>("plotView");
        for (int i = 0; i < 60; ++i) {
            timer.start();
            view->render(&image);
            least = std::min(least, double(timer.nsecsElapsed()) * 1e-6);
        }
        std::printf("plot repaint, least of 60: %.2f ms\n", least);
    }
    {
        QWidget row;
        auto* column = new QVBoxLayout(&row);
        for (const auto& [force, detail] : {std::pair(0.7, Detail::practice), std::pair(2.1, Detail::laboratory),
                                            std::pair(3.2, Detail::laboratory)}) {
            auto* gauge = new ForceGauge(&row);
            gauge->setDetail(detail);
            gauge->setForce(force * 1.02, 0.0);
            gauge->setForce(force, 0.1);
            column->addWidget(gauge);
        }
        auto* bars = new VolumeBars(&row);
        using cases::Tissue;
        bars->setLegend(
            {{Tissue::enamel, {244, 241, 230}}, {Tissue::dentine, {226, 199, 140}}, {Tissue::caries, {104, 66, 34}}});
        std::array<double, cases::kTissueCount> mm3{};
        mm3[1] = 6.42;
        mm3[2] = 3.1;
        mm3[3] = 0.04;
        bars->setVolumes(mm3);
        column->addWidget(bars);
        keep(row, "gauges", {280, 480});
    }
    {
        QWidget row;
        auto* column = new QVBoxLayout(&row);
        for (const auto detail : {Detail::practice, Detail::laboratory}) {
            auto* line = new StatusLine(&row);
            line->setDetail(detail);
            StatusFigures figures;
            figures.device = "Mouse";
            figures.rateHz = 1000;
            figures.lateTicks = 12;
            figures.load = 0.08;
            figures.recording = StatusFigures::Recording::on;
            figures.late = detail == Detail::laboratory;
            line->setFigures(figures);
            column->addWidget(line);
        }
        auto* replay = new ReplayBar(&row);
        replay->setDuration(95.4);
        using Kind = ReplayMark::Kind;
        replay->setMarks({{3, Kind::strokeBegin, "Stroke 1"},
                          {14, Kind::strokeEnd, ""},
                          {20, Kind::strokeBegin, "Stroke 2"},
                          {31, Kind::strokeEnd, ""},
                          {40, Kind::undo, "Undo"},
                          {52, Kind::warning, "Pulp exposed"},
                          {60, Kind::change, "Bur 245"}});
        replay->setTime(34.2);
        column->addWidget(replay);
        auto* notice = new NoticeBar(&row);
        notice->add({"a", NoticeBar::Kind::warning,
                     "The disk is full: the session is no longer recorded. What you cut is kept.", "Save as…"});
        column->addWidget(notice);
        auto* hint = new NoticeBar(&row);
        hint->add({"b", NoticeBar::Kind::hint, "The last session ended without saving.", "Bring the tooth back"});
        column->addWidget(hint);
        auto* welcome = new WelcomeStrip(&row);
        column->addWidget(welcome);
        keep(row, "strips", {760, 300});
    }
    {
        ToothChart chart;
        chart.setAvailable({11, 16, 26, 36, 46, 45});
        chart.setChosen(46);
        keep(chart, "chart_fdi", {340, 440});
        chart.setNotation(Notation::palmer);
        chart.setPrimaryShown(true);
        chart.setAvailable({16, 46, 75});
        keep(chart, "chart_palmer_primary", {380, 500});
    }
    {
        MeasureBox box;
        box.setDepth(1.52);
        box.setCalliper(3.27);
        box.setLeftOverPulp(1.4);
        keep(box, "measure_practice", {320, 420});
        box.setDetail(Detail::laboratory);
        box.setLeftOverPulp(0.42);
        box.setDepthStop(1.5);
        box.setSection(true, MeasureBox::Orientation::buccolingual, 0.3);
        keep(box, "measure_laboratory", {320, 420});
    }
    {
        ViewBar bar;
        keep(bar, "views_practice", {300, 540});
        bar.setDetail(Detail::laboratory);
        keep(bar, "views_laboratory", {300, 640});
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: panels_gallery FOLDER\n");
        return 2;
    }
    QApplication application(argc, argv);
    folder = QString::fromLocal8Bit(argv[1]);
    if (!QDir().mkpath(folder)) {
        std::fprintf(stderr, "panels_gallery: cannot make %s\n", argv[1]);
        return 1;
    }
    for (const auto appearance : {Appearance::light, Appearance::dark}) {
        applyTheme(application, appearance);
        suffix = appearance == Appearance::dark ? "_dark" : "_light";
        icons();
        panels();
    }
    return 0;
}
