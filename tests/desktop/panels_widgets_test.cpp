// SPDX-License-Identifier: Apache-2.0
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QListView>
#include <QMessageBox>
#include <QPushButton>
#include <QRadioButton>
#include <QSlider>
#include <QTableWidget>
#include <QToolButton>
#include <QToolTip>
#include <QtTest>

#include "desktop/features/drill/bur_list.h"
#include "desktop/features/drill/drill_bar.h"
#include "desktop/features/drill/parameter_box.h"
#include "desktop/features/drill/welcome_strip.h"
#include "desktop/features/measure/measure_box.h"
#include "desktop/features/measure/plot_panel.h"
#include "desktop/features/measure/volume_bars.h"
#include "desktop/features/replay/replay_bar.h"
#include "desktop/features/replay/timeline.h"
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

template <class W>
W* part(QWidget& panel, const char* name) {
    auto* found = panel.findChild<W*>(name);
    if (!found) qFatal("no widget %s", name);
    return found;
}
void show(QWidget& widget, QSize size = {360, 700}) {
    widget.resize(size);
    widget.show();
    QVERIFY(QTest::qWaitForWindowExposed(&widget, 60000));
}
/// WCAG 2 contrast.
double contrast(const QColor& a, const QColor& b) {
    const auto light = [](const QColor& c) {
        const auto linear = [](double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
        return 0.2126 * linear(c.redF()) + 0.7152 * linear(c.greenF()) + 0.0722 * linear(c.blueF());
    };
    const double x = light(a), y = light(b);
    return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
}

}  // namespace

class PanelsWidgetsTest : public QObject {
    Q_OBJECT
  private slots:
    void initTestCase() { applyTheme(*static_cast<QApplication*>(QCoreApplication::instance()), Appearance::light); }

    void aBurIsChosenByClickAndOnlyAllowedOnes() {
        DrillBar bar;
        bar.setBur("330");
        show(bar);
        QSignalSpy chosen(&bar, &DrillBar::burChosen);
        auto* list = part<QListView>(bar, "burList");
        QTest::keyClicks(part<QLineEdit>(bar, "burSearch"), "245");
        QVERIFY(list->model()->rowCount() >= 1);
        const QModelIndex index = list->model()->index(0, 0);
        QCOMPARE(index.data(BurModel::nameRole).toString(), QString("245"));
        QTest::mouseClick(list->viewport(), Qt::LeftButton, {}, list->visualRect(index).center());
        QCOMPARE(chosen.size(), 1);
        QCOMPARE(chosen[0][0].toString(), QString("245"));

        bar.setAllowedBurs({"330", "331"});
        QTest::mouseClick(list->viewport(), Qt::LeftButton, {}, list->visualRect(index).center());
        QCOMPARE(chosen.size(), 1);
        QVERIFY(index.data(Qt::ToolTipRole).toString().contains("exercise"));
        QVERIFY(!part<QPushButton>(bar, "burFromFile")->isEnabled());
        bar.setBur("330");
        bar.chooseNext(1);
        QCOMPARE(bar.bur(), QString("331"));
        bar.chooseNext(1);
        QCOMPARE(bar.bur(), QString("330"));
    }
    void whatAFileSaysIsShownAsItIs() {
        const QString said = QStringLiteral("<b>bold</b><img src='/etc/passwd'>");
        QLabel label(said);
        QLabel rich(QStringLiteral("<b>ours</b>"));
        rich.setTextFormat(Qt::RichText);
        QMessageBox box(QMessageBox::Question, said, said);
        box.setInformativeText(said);
        for (QWidget* widget :
             {static_cast<QWidget*>(&label), static_cast<QWidget*>(&rich), static_cast<QWidget*>(&box)})
            widget->show();
        QCOMPARE(label.textFormat(), Qt::PlainText);
        QCOMPARE(rich.textFormat(), Qt::RichText);
        for (const QLabel* part : box.findChildren<QLabel*>())
            QCOMPARE(part->textFormat(), Qt::PlainText);
        QToolTip::showText({10, 10}, said);
        bool found = false;
        for (QWidget* widget : QApplication::topLevelWidgets())
            if (widget->inherits("QTipLabel") && widget->isVisible()) {
                found = true;
                QCOMPARE(qobject_cast<QLabel*>(widget)->textFormat(), Qt::PlainText);
            }
        QVERIFY(found);
        QToolTip::hideText();
    }
    void aBurIsFoundByWhatADentistTypes() {
        DrillBar bar;
        auto* list = part<QListView>(bar, "burList");
        auto* search = part<QLineEdit>(bar, "burSearch");
        for (const auto& entry : instrument::catalogue()) {
            for (const std::string& word : {entry.name, entry.usName, entry.isoNumber}) {
                if (word.empty()) continue;
                search->setText(QString::fromStdString(word));
                bool found = false;
                for (int row = 0; row < list->model()->rowCount(); ++row)
                    found |= list->model()->index(row, 0).data(BurModel::nameRole).toString() ==
                             QString::fromStdString(entry.name);
                QVERIFY2(found, word.c_str());
            }
        }
        search->setText("no such bur");
        QCOMPARE(list->model()->rowCount(), 0);
    }
    void speedIsHeldToTheDrive() {
        DrillBar bar;
        show(bar);
        QSignalSpy set(&bar, &DrillBar::speedSet), drive(&bar, &DrillBar::driveChosen);
        bar.setSpeed(1e9);
        QCOMPARE(bar.speedRpm(), instrument::driveByName("turbine").freeSpeedRpm);
        QCOMPARE(set.size(), 0);
        auto* slider = part<QSlider>(bar, "speedSlider");
        slider->setFocus();
        QTest::keyClick(slider, Qt::Key_Left);
        QCOMPARE(set.size(), 1);
        QCOMPARE(set[0][0].toDouble(), 0.95 * instrument::driveByName("turbine").freeSpeedRpm);
        QTest::mouseClick(part<QRadioButton>(bar, "drive_low-speed"), Qt::LeftButton, {}, {8, 8});
        QCOMPARE(drive.size(), 1);
        QCOMPARE(bar.speedRpm(), instrument::driveByName("low-speed").freeSpeedRpm);
        bar.setActualSpeed(0, true);
        QVERIFY(part<QLabel>(bar, "stallNote")->isVisible());
        bar.setActualSpeed(1000, false);
        QVERIFY(!part<QLabel>(bar, "stallNote")->isVisible());
    }
    void soundTellsWhatIsTurned() {
        SoundControl sound;
        sound.setDetail(Detail::laboratory);
        show(sound);
        QSignalSpy motor(&sound, &SoundControl::motorVolumeChanged), muted(&sound, &SoundControl::mutedChanged);
        QSignalSpy microphone(&sound, &SoundControl::microphoneToggled);
        sound.setVolumes(0.5, 0.2);
        sound.setMuted(true);
        QCOMPARE(motor.size() + muted.size(), 0);
        QTest::keyClick(part<QSlider>(sound, "motorVolume"), Qt::Key_Right);
        QCOMPARE(motor.size(), 1);
        QCOMPARE(motor[0][0].toDouble(), 0.55);
        QTest::mouseClick(part<QToolButton>(sound, "mute"), Qt::LeftButton);
        QCOMPARE(muted.size(), 1);
        QCOMPARE(muted[0][0].toBool(), false);
        sound.setSource(SoundControl::Channel::motor, SoundControl::Source::microphone);
        QTest::mouseClick(part<QPushButton>(sound, "motorRecord"), Qt::LeftButton);
        QCOMPARE(microphone.size(), 1);
        QCOMPARE(microphone[0][1].toBool(), true);
    }
    void clippedValuesAreMarked() {
        ParameterBox box;
        force::Limits limits;
        box.setLimits(limits, "Device");
        box.setMultipliers({2.0, 1.0, 1.0});
        show(box);
        // Enamel asks for twice what the device has, pulp for a tenth.
        const auto enamel = box.springOf(cases::Tissue::enamel), pulp = box.springOf(cases::Tissue::pulp);
        QVERIFY(enamel.clipped());
        QCOMPARE(enamel.givenNPerMm, limits.maxStiffnessNPerMm);
        QCOMPARE(enamel.wantedNPerMm,
                 2 * limits.maxStiffnessNPerMm * cases::properties(cases::Tissue::enamel).stiffnessFraction);
        QVERIFY(!pulp.clipped());
        auto* table = part<QTableWidget>(box, "tissueTable");
        QVERIFY(table->item(0, 1)->text().contains(QChar(0x25b2)));
        QVERIFY(!table->item(2, 1)->text().contains(QChar(0x25b2)));
        QVERIFY(part<QLabel>(box, "clipNote")->text().contains(QChar(0x25b2)));
        QSignalSpy changed(&box, &ParameterBox::multipliersChanged);
        QTest::mouseClick(part<QPushButton>(box, "parametersReset"), Qt::LeftButton);
        QCOMPARE(changed.size(), 1);
        QCOMPARE(changed[0][0].toDouble(), 1.0);
        QVERIFY(!part<QLabel>(box, "clipNote")->text().contains(QChar(0x25b2)));
        box.setMultipliers({99, -1, std::nan("")});
        QCOMPARE(box.multipliers(), (ParameterBox::Multipliers{ParameterBox::kLargest, 0.0, 1.0}));
    }
    void sliderAndSpinBoxAgreeAndTellOnce() {
        ParameterBox box;
        show(box);
        QSignalSpy changed(&box, &ParameterBox::multipliersChanged);
        QTest::keyClick(part<QSlider>(box, "springSlider"), Qt::Key_Right);
        QCOMPARE(changed.size(), 1);
        QCOMPARE(part<QDoubleSpinBox>(box, "springSpin")->value(), 1.05);
        QTest::keyClick(part<QDoubleSpinBox>(box, "frictionSpin"), Qt::Key_Down);
        QCOMPARE(changed.size(), 2);
        QCOMPARE(part<QSlider>(box, "frictionSlider")->value(), 95);
    }
    void whatCannotChangeSaysWhy() {
        ParameterBox box;
        show(box);
        auto* method = part<QComboBox>(box, "contactMethod");
        QVERIFY(method->isEnabled());
        box.setCutting(ParameterBox::Cutting::begun);
        QVERIFY(!method->isEnabled());
        QVERIFY(part<QComboBox>(box, "voxelSize")->isEnabled());
        QVERIFY(part<QLabel>(box, "contactMethodNote")->text().contains("reset"));
        QVERIFY(part<QLabel>(box, "voxelSizeNote")->text().contains("cut again"));
        box.setCutting(ParameterBox::Cutting::stroke);
        QVERIFY(!part<QComboBox>(box, "voxelSize")->isEnabled());
    }
    void plotsKeepEveryPeak() {
        PlotPanel plot;
        show(plot, {300, 300});  // far fewer columns than points
        std::vector<simulation::PlotPoint> points(2000);
        for (std::size_t i = 0; i < points.size(); ++i) {
            points[i].timeS = double(i) * simulation::kPlotStepS;
            points[i].forceN = 0.2f;
        }
        for (const std::size_t peak : {3, 777, 1501, 1999}) {
            auto one = points;
            one[peak].forceN = 3.1f;
            plot.clear();
            plot.append(one);
            QVERIFY(std::abs(plot.largestDrawn(0) - 3.1) < 1e-4);
        }
        plot.setPaused(true);
        points.front().timeS = 20.0;
        points.front().forceN = 9;
        plot.append({points.front()});
        QVERIFY(plot.largestDrawn(0) < 3.2);  // held
        plot.setPaused(false);
        QVERIFY(std::abs(plot.largestDrawn(0) - 9) < 1e-3);
    }
    void plotsAreSaved() {
        PlotPanel plot;
        std::vector<simulation::PlotPoint> points(3);
        for (int i = 0; i < 3; ++i)
            points[std::size_t(i)].timeS = i;
        plot.append(points);
        QCOMPARE(plot.csv().count('\n'), 4);
        QVERIFY(plot.csv().startsWith("time [s],force [N]"));
        QVERIFY(plot.svg().contains("<svg"));
        QCOMPARE(plot.picture({300, 200}, 2.0).size(), QSize(600, 400));
    }
    void gaugeHoldsItsPeakAndSpeaks() {
        ForceGauge gauge;
        gauge.setLimit(3.3);
        gauge.setForce(3.2, 0.0);
        QCOMPARE(gauge.zone(), ForceGauge::Zone::hard);
        QCOMPARE(gauge.words(), QString("Hard"));
        gauge.setForce(0.5, 1.0);
        QCOMPARE(gauge.peakN(), 3.2);
        QCOMPARE(gauge.words(), QString("Light"));
        // About a newton is as usual for a turbine; what is firm there is as usual for a speed-increasing handpiece,
        // whatever the device can give.
        for (const double limitN : {0.9, 3.3, 9.0}) {
            gauge.setLimit(limitN);
            gauge.setPressLimits(instrument::pressLimitsOf("turbine"));
            gauge.setForce(1.0, 1.1);
            QCOMPARE(gauge.words(), QString("As usual"));
            QCOMPARE(gauge.zone(), ForceGauge::Zone::gentle);
            gauge.setForce(1.4, 1.1);
            QCOMPARE(gauge.words(), QString("Firm"));
            QCOMPARE(gauge.zone(), ForceGauge::Zone::firm);
            gauge.setForce(2.1, 1.1);
            QCOMPARE(gauge.zone(), ForceGauge::Zone::hard);
            gauge.setPressLimits(instrument::pressLimitsOf("speed-increasing"));
            gauge.setForce(1.4, 1.1);
            QCOMPARE(gauge.words(), QString("As usual"));
            gauge.setForce(2.1, 1.1);
            QCOMPARE(gauge.words(), QString("Firm"));
        }
        gauge.setLimit(3.3);
        gauge.setPressLimits(instrument::pressLimitsOf("turbine"));
        gauge.setForce(0.5, 2.5);
        QCOMPARE(gauge.peakN(), 0.5);
        gauge.setForce(0.5, 2.6, true);
        QCOMPARE(gauge.words(), QString("More than the device gives"));
        gauge.setForce(0.0, 2.7);
        QCOMPARE(gauge.words(), QString("Not pressed"));
    }
    void gaugeAndLoadSpeakTheSameWords() {
        // Whatever the device can give: the same newtons, the same words.
        for (const auto& [limitN, drive] :
             {std::pair(3.3, "turbine"), {9.0, "turbine"}, {3.3, "low-speed"}, {0.9, "speed-increasing"}}) {
            ForceGauge gauge;
            gauge.setLimit(limitN);
            gauge.setPressLimits(instrument::pressLimitsOf(drive));
            MeasureBox box;
            box.setPressLimits(instrument::pressLimitsOf(drive));
            for (const double loadN : {0.2, 0.6, 1.0, 1.5, 2.3, 2.5, 3.0}) {
                gauge.setForce(loadN, 0.0);
                box.setLoad(loadN);
                QCOMPARE(part<QLabel>(box, "loadReadout")->text(), gauge.words());
            }
        }
    }
    void aHeadingThatADockSaysIsLeftOut() {
        const auto says = [](QWidget& panel, const QString& text) {
            for (const QLabel* label : panel.findChildren<QLabel*>())
                if (label->isVisible() && label->text() == text) return true;
            return false;
        };
        SoundControl sound;
        show(sound);
        QVERIFY(says(sound, "Sound"));
        sound.setHeadingShown(false);
        QVERIFY(!says(sound, "Sound"));
        ParameterBox parameters;
        show(parameters);
        QVERIFY(says(parameters, "What the tooth feels like"));
        parameters.setHeadingShown(false);
        QVERIFY(!says(parameters, "What the tooth feels like"));
        // These two paint theirs: without it the words of the gauge begin where it stood.
        ForceGauge gauge;
        show(gauge, {240, 60});
        const QImage with = gauge.grab().toImage();
        gauge.setHeadingShown(false);
        QVERIFY(gauge.grab().toImage() != with);
        VolumeBars volumes;
        show(volumes, {240, 120});
        const QImage removed = volumes.grab().toImage();
        volumes.setHeadingShown(false);
        QVERIFY(volumes.grab().toImage() != removed);
    }
    void practiceStatusIsOneWord() {
        StatusLine line;
        show(line, {500, 30});
        QCOMPARE(line.word(), QString("Ready"));
        StatusFigures figures;
        figures.recording = StatusFigures::Recording::on;
        line.setFigures(figures);
        QCOMPARE(part<QLabel>(line, "statusWord")->text(), QString("Recording"));
        figures.late = true;
        line.setFigures(figures);
        QCOMPARE(line.word(), QString("Late"));
        QVERIFY(!part<QLabel>(line, "statusRate")->isVisible());
        line.setDetail(Detail::laboratory);
        QVERIFY(part<QLabel>(line, "statusRate")->isVisible());
    }
    void aToothIsChosenByMouseAndKeys() {
        ToothChart chart;
        chart.setAvailable({46, 45, 16});
        show(chart, {340, 440});
        QSignalSpy chosen(&chart, &ToothChart::toothChosen);
        QTest::mouseClick(&chart, Qt::LeftButton, {}, chart.centreOf(46).toPoint());
        QCOMPARE(chosen.takeLast()[0].toInt(), 46);
        QTest::mouseClick(&chart, Qt::LeftButton, {}, chart.centreOf(36).toPoint());
        QCOMPARE(chosen.size(), 0);  // there is none
        QTest::keyClick(&chart, Qt::Key_Escape);
        chart.setChosen(46);
        QTest::keyClick(&chart, Qt::Key_Right);
        QTest::keyClick(&chart, Qt::Key_Return);
        QCOMPARE(chosen.takeLast()[0].toInt(), 45);
        QTest::keyClick(&chart, Qt::Key_Left);
        QTest::keyClick(&chart, Qt::Key_Up);
        QTest::keyClick(&chart, Qt::Key_Space);
        QCOMPARE(chosen.takeLast()[0].toInt(), 16);
        // The patient's right is on the left; upper teeth are above.
        QVERIFY(chart.centreOf(46).x() < chart.centreOf(36).x());
        QVERIFY(chart.centreOf(16).y() < chart.centreOf(46).y());
        chart.setPrimaryShown(true);
        for (const bool primary : {false, true})
            for (const auto& arch : {upperArch(primary), lowerArch(primary)})
                for (const int fdi : arch)
                    QVERIFY(chart.rect().contains(chart.centreOf(fdi).toPoint()));
    }
    void replayScrubsAndSteps() {
        ReplayBar bar;
        bar.setDuration(100);
        using Kind = ReplayMark::Kind;
        bar.setMarks({{10, Kind::strokeBegin, ""}, {20, Kind::strokeEnd, ""}, {40, Kind::strokeBegin, ""}});
        show(bar, {700, 50});
        QSignalSpy seek(&bar, &ReplayBar::seekRequested), play(&bar, &ReplayBar::playRequested);
        auto* line = bar.findChild<Timeline*>();
        QTest::mousePress(line, Qt::LeftButton, {}, {int(line->xOf(50)), 17});
        QTest::mouseRelease(line, Qt::LeftButton, {}, {int(line->xOf(70)), 17});
        QVERIFY(std::abs(bar.timeS() - 70) < 0.5);
        QCOMPARE(seek.first()[1].toBool(), true);
        QCOMPARE(seek.last()[1].toBool(), false);
        QTest::mouseClick(part<QToolButton>(bar, "replayStepBack"), Qt::LeftButton);
        QCOMPARE(bar.timeS(), 40.0);
        QTest::mouseClick(part<QToolButton>(bar, "replayStepBack"), Qt::LeftButton);
        QCOMPARE(bar.timeS(), 10.0);
        QTest::mouseClick(part<QToolButton>(bar, "replayStepForward"), Qt::LeftButton);
        QCOMPARE(bar.timeS(), 40.0);
        QTest::mouseClick(part<QToolButton>(bar, "replayPlay"), Qt::LeftButton);
        QCOMPARE(play.size(), 1);
        QVERIFY(bar.playing());
        seek.clear();
        bar.setTime(1e9);
        QCOMPARE(bar.timeS(), 100.0);
        QCOMPARE(seek.size(), 0);
    }
    void measureSpeaksOfThePulp() {
        MeasureBox box;
        show(box);
        box.setLeftOverPulp(2.5);
        const QString enough = part<QLabel>(box, "pulpWords")->text();
        box.setLeftOverPulp(0.4);
        const QString careful = part<QLabel>(box, "pulpWords")->text();
        box.setLeftOverPulp(0.1);
        const QString danger = part<QLabel>(box, "pulpWords")->text();
        QVERIFY(enough != careful && careful != danger);
        box.setLeftOverPulp({}, true);
        QVERIFY(part<QLabel>(box, "pulpWords")->text().contains("exposed"));
        // As the teacher has it: what was green at 0.87 mm is not where a millimetre is asked for.
        box.setLeftOverPulp(0.87);
        QCOMPARE(part<QLabel>(box, "pulpWords")->text(), QString("0.5 mm or more"));
        box.setPulpLimits({1.0, 0.5});
        box.setLeftOverPulp(0.87);
        QCOMPARE(part<QLabel>(box, "pulpWords")->text(), QString("Under 1 mm"));
        box.setLeftOverPulp(0.4);
        QCOMPARE(part<QLabel>(box, "pulpWords")->text(), QString("Under 0.5 mm"));
        QSignalSpy load(&box, &MeasureBox::loadChanged), stop(&box, &MeasureBox::depthStopChanged),
            section(&box, &MeasureBox::sectionChanged);
        box.setLoad(50);
        QCOMPARE(load.size(), 0);
        QTest::keyClick(part<QSlider>(box, "loadSlider"), Qt::Key_Left);
        QVERIFY(std::abs(load[0][0].toDouble() - 2.9) < 1e-9);
        // On at first.
        QTest::keyClick(part<QCheckBox>(box, "depthStopOn"), Qt::Key_Space);
        QCOMPARE(stop.last()[0].toDouble(), 0.0);
        QTest::keyClick(part<QCheckBox>(box, "depthStopOn"), Qt::Key_Space);
        QCOMPARE(stop.last()[0].toDouble(), 1.5);
        QTest::keyClick(part<QDoubleSpinBox>(box, "depthStop"), Qt::Key_Up);
        QVERIFY(std::abs(stop.last()[0].toDouble() - 1.6) < 1e-9);
        QTest::keyClick(part<QCheckBox>(box, "sectionOn"), Qt::Key_Space);
        QTest::keyClick(part<QSlider>(box, "sectionSlider"), Qt::Key_Right);
        QVERIFY(std::abs(section.last()[2].toDouble() - 0.1) < 1e-9);
        cases::Exercise exercise;
        exercise.lockedHelps = {"cross-section", "depth"};
        box.setPermissions(exercise::permissionsOf(&exercise, exercise::WorkMode::work));
        QCOMPARE(section.last()[0].toBool(), false);
        QVERIFY(!part<QLabel>(box, "depthReadout")->isVisible());
        QVERIFY(!part<QCheckBox>(box, "depthStopOn")->isEnabled());
        QCOMPARE(stop.last()[0].toDouble(), 0.0);
        QVERIFY(!part<QToolButton>(box, "calliperButton")->isEnabled());
    }
    void viewBarChangesTheLook() {
        ViewBar bar;
        bar.setDetail(Detail::laboratory);
        show(bar, {300, 700});
        QSignalSpy look(&bar, &ViewBar::lookChanged), chosen(&bar, &ViewBar::viewChosen);
        QTest::mouseClick(part<QToolButton>(bar, "viewMesial"), Qt::LeftButton);
        QCOMPARE(chosen.size(), 1);
        QCOMPARE(chosen[0][0].value<view::StandardView>(), view::StandardView::mesial);
        QTest::keyClick(part<QCheckBox>(bar, "showTissue_enamel"), Qt::Key_Space);
        QCOMPARE(look.size(), 1);
        QVERIFY(!bar.look().visible[std::size_t(cases::Tissue::enamel)]);
        view::Look other;
        other.eyeSeparationMm = 7;
        other.wet = false;
        bar.setLook(other);
        QCOMPARE(look.size(), 1);
        QTest::keyClick(part<QCheckBox>(bar, "showWet"), Qt::Key_Space);
        QVERIFY(bar.look().wet);
        QCOMPARE(bar.look().eyeSeparationMm, 7.0);
        cases::Exercise exercise;
        exercise.lockedHelps = {"transparency", "scale-bar"};
        bar.setPermissions(exercise::permissionsOf(&exercise, exercise::WorkMode::work));
        QVERIFY(!part<QCheckBox>(bar, "showScaleBar")->isEnabled());
        QVERIFY(!part<QCheckBox>(bar, "showTissue_enamel")->isEnabled());
    }
    void noticesWaitTheirTurn() {
        NoticeBar bar;
        bar.add({"hint", NoticeBar::Kind::hint, "a", ""});
        bar.add({"error", NoticeBar::Kind::error, "b", "Do"});
        bar.add({"hint", NoticeBar::Kind::hint, "a again", ""});
        QCOMPARE(bar.current(), QString("error"));
        QSignalSpy remedy(&bar, &NoticeBar::remedyChosen), gone(&bar, &NoticeBar::dismissed);
        QTest::mouseClick(part<QPushButton>(bar, "noticeRemedy"), Qt::LeftButton);
        QCOMPARE(remedy.size(), 1);
        QCOMPARE(bar.current(), QString("hint"));
        QTest::mouseClick(part<QToolButton>(bar, "noticeClose"), Qt::LeftButton);
        QCOMPARE(gone.size(), 1);
        QVERIFY(bar.isHidden());
    }
    void hintsEndWhenAllIsDone() {
        WelcomeStrip strip;
        QVERIFY(strip.text().contains("left button"));
        QSignalSpy changed(&strip, &WelcomeStrip::doneChanged);
        strip.markDone(WelcomeStrip::Step::cut);
        QVERIFY(strip.done().count(WelcomeStrip::Step::hover));
        strip.markDone(WelcomeStrip::Step::cut);
        QCOMPARE(changed.size(), 1);
        for (const auto step : {WelcomeStrip::Step::orbit, WelcomeStrip::Step::zoom, WelcomeStrip::Step::undo})
            strip.markDone(step);
        QVERIFY(strip.text().isEmpty());
        QVERIFY(strip.isHidden());
    }
    void iconsFollowThePalette() {
        auto& application = *static_cast<QApplication*>(QCoreApplication::instance());
        QVERIFY(iconNames().size() > 50);
        const auto lightness = [](const QString& name) {
            const QImage image = icon(name).pixmap(24, 24).toImage();
            double sum = 0, weight = 0;
            for (int y = 0; y < image.height(); ++y)
                for (int x = 0; x < image.width(); ++x) {
                    const QColor c = image.pixelColor(x, y);
                    sum += c.alphaF() * c.lightnessF();
                    weight += c.alphaF();
                }
            return weight > 20 ? sum / weight : -1.0;
        };
        for (const QString& name : iconNames()) {
            applyTheme(application, Appearance::light);
            const double onLight = lightness(name);
            QVERIFY2(onLight >= 0 && onLight < 0.35, qPrintable(name));
            applyTheme(application, Appearance::dark);
            QVERIFY2(lightness(name) > 0.65, qPrintable(name));
        }
        applyTheme(application, Appearance::light);
        QVERIFY(icon("no such icon").isNull());
    }
    void colouredWordsAreReadable() {
        for (const bool dark : {false, true}) {
            const QPalette palette = themePalette(dark);
            const Tones tones = tonesOf(palette);
            for (const QColor& ground : {palette.color(QPalette::Window), palette.color(QPalette::Base)})
                for (const QColor& word : {tones.good, tones.caution, tones.bad, tones.force, tones.depth, tones.speed,
                                           tones.quiet, palette.color(QPalette::WindowText)})
                    QVERIFY2(contrast(word, ground) >= 4.0, qPrintable(word.name() + " on " + ground.name()));
            QVERIFY(contrast(palette.color(QPalette::HighlightedText), palette.color(QPalette::Highlight)) >= 4.0);
        }
    }
    /// What a screen reader and a script need: a name for everything that can be worked.
    void aBoxIsSeenOnADarkWindow() {
        auto& application = *static_cast<QApplication*>(QCoreApplication::instance());
        for (const Appearance appearance : {Appearance::dark, Appearance::light}) {
            applyTheme(application, appearance);
            QCheckBox box;
            show(box, {40, 30});
            const QImage image = box.grab().toImage();
            const QColor window = box.palette().color(QPalette::Window);
            double most = 1.0;
            for (int y = 0; y < image.height(); ++y)
                for (int x = 0; x < image.width(); ++x)
                    most = std::max(most, contrast(image.pixelColor(x, y), window));
            // Three to one is what WCAG 2 asks of a control's edge; Fusion's own on light stays as it is.
            QVERIFY2(most >= (appearance == Appearance::dark ? 3.0 : 1.5), qPrintable(QString::number(most)));
        }
        applyTheme(application, Appearance::light);
    }
    void everythingHasAName() {
        std::vector<std::unique_ptr<QWidget>> all;
        all.push_back(std::make_unique<DrillBar>());
        all.push_back(std::make_unique<SoundControl>());
        all.push_back(std::make_unique<ParameterBox>());
        all.push_back(std::make_unique<PlotPanel>());
        all.push_back(std::make_unique<MeasureBox>());
        all.push_back(std::make_unique<ViewBar>());
        all.push_back(std::make_unique<ReplayBar>());
        all.push_back(std::make_unique<NoticeBar>());
        all.push_back(std::make_unique<WelcomeStrip>());
        for (const auto& panel : all)
            for (QWidget* widget : panel->findChildren<QWidget*>()) {
                const bool works = qobject_cast<QAbstractButton*>(widget) || qobject_cast<QAbstractSlider*>(widget) ||
                                   qobject_cast<QComboBox*>(widget) || qobject_cast<QAbstractSpinBox*>(widget);
                // Parts of Qt's own widgets have its names.
                if (!works || widget->objectName().startsWith("qt_") || widget->inherits("QScrollBar") ||
                    widget->inherits("QTableCornerButton") || widget->parentWidget()->inherits("QLineEdit") ||
                    widget->parentWidget()->inherits("QTableView"))
                    continue;
                QVERIFY2(!widget->objectName().isEmpty(), widget->metaObject()->className());
                QVERIFY2(!widget->accessibleName().isEmpty(), qPrintable(widget->objectName()));
                QVERIFY2(!widget->toolTip().isEmpty(), qPrintable(widget->objectName()));
            }
    }
};

QTEST_MAIN(PanelsWidgetsTest)
#include "panels_widgets_test.moc"
