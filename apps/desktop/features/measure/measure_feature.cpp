// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/measure/measure_feature.h"

#include <QBuffer>
#include <QStatusBar>
#include <algorithm>

#include "desktop/features/measure/measure_box.h"
#include "desktop/features/measure/pass_row.h"
#include "desktop/features/measure/plot_panel.h"
#include "desktop/features/measure/volume_bars.h"
#include "desktop/picture/section_bar.h"
#include "desktop/work/simulator.h"
#include "handpiece/app/input/pointer_controller.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/instrument/turbine.h"

namespace handpiece::desktop {
namespace {

using exercise::Operation;

constexpr int kReadoutMs = 100;

using Command = MeasureFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::distance, "actionMeasure", QT_TRANSLATE_NOOP("Commands", "Measure a distance"),
     QT_TRANSLATE_NOOP("Commands", "Calliper: click two points of the tooth"), "calliper", "Ctrl+D",
     in(Shelf::tools, 10), in(Shelf::toolBar, 21), brief(QT_TRANSLATE_NOOP("Commands", "Distance")), kCheckable,
     Operation::calliper},
    {Command::depth, "actionDepth", QT_TRANSLATE_NOOP("Commands", "Measure a depth"),
     QT_TRANSLATE_NOOP("Commands", "Click a cut place: how far it lies below the uncut surface"), "depth",
     "Ctrl+Shift+D", in(Shelf::tools, 11), in(Shelf::toolBar, 22), brief(QT_TRANSLATE_NOOP("Commands", "Depth")),
     kCheckable, Operation::depthTool},
    {Command::pulp, "actionPulp", QT_TRANSLATE_NOOP("Commands", "Measure to the pulp"),
     QT_TRANSLATE_NOOP("Commands", "Click a cut place: remaining dentine thickness over the pulp"), "measure", "Ctrl+U",
     in(Shelf::tools, 12), in(Shelf::toolBar, 23), brief(QT_TRANSLATE_NOOP("Commands", "To pulp")), kCheckable,
     Operation::pulpTool},
    {Command::section, "actionSection", QT_TRANSLATE_NOOP("Commands", "Section"),
     QT_TRANSLATE_NOOP("Commands", "Cut the picture open to look inside"), "section", "Ctrl+X", in(Shelf::tools, 13),
     in(Shelf::toolBar, 24), kCheckable, Operation::section},
    {Command::clear, "actionClearMeasurements", QT_TRANSLATE_NOOP("Commands", "Clear measurements"),
     QT_TRANSLATE_NOOP("Commands", "Take all measurements away"), "close", "Ctrl+Shift+X", in(Shelf::tools, 16)},
};
constexpr std::pair<Command, Tool> kTools[] = {
    {Command::distance, Tool::calliper}, {Command::depth, Tool::depth}, {Command::pulp, Tool::pulp}};

SectionPlace::Direction directionOf(MeasureBox::Orientation orientation) {
    switch (orientation) {
        case MeasureBox::Orientation::mesiodistal:
            return SectionPlace::Direction::mesioDistal;
        case MeasureBox::Orientation::horizontal:
            return SectionPlace::Direction::horizontal;
        default:
            return SectionPlace::Direction::buccoLingual;
    }
}

MeasureBox::Orientation orientationOf(SectionPlace::Direction direction) {
    switch (direction) {
        case SectionPlace::Direction::mesioDistal:
            return MeasureBox::Orientation::mesiodistal;
        case SectionPlace::Direction::horizontal:
            return MeasureBox::Orientation::horizontal;
        default:
            return MeasureBox::Orientation::buccolingual;
    }
}

/// Throws core::Error with the same sentences as all other files.
void writeBytes(const QString& file, const QByteArray& bytes) {
    core::writeFile(toPath(file), std::string_view(bytes.constData(), static_cast<std::size_t>(bytes.size())));
}

}  // namespace

MeasureFeature::MeasureFeature(const FeatureContext& context)
    : Feature(context),
      commands_(window_.commands(), kCommands),
      box_(new MeasureBox),
      volumes_(new VolumeBars),
      plots_(new PlotPanel) {
    Docks& docks = window_.docks();
    docks.add({"measureDock",
               tr("Measure"),
               50,
               {{Detail::practice, Qt::RightDockWidgetArea, 40, 0, nullptr, 0, false},
                {Detail::laboratory, Qt::RightDockWidgetArea, 50, 480, "parameterDock"}}},
              box_);
    docks.add({"volumesDock",
               tr("Removed"),
               60,
               {{Detail::practice, Qt::RightDockWidgetArea, 50, 140},
                {Detail::laboratory, Qt::BottomDockWidgetArea, 90, 290, nullptr, 230}}},
              volumes_);
    docks.add({"plotDock", tr("Plots"), 90, {{Detail::laboratory, Qt::BottomDockWidgetArea, 80, 290, nullptr, 620}}},
              plots_);
    volumes_->setHeadingShown(false);  // the dock's title says it
    // The panel has the same controls.
    connect(&docks, &Docks::detailChanged, &view_,
            [this](Detail detail) { view_.setSectionBarShown(detail != Detail::practice); });
    box_->setPulpLimits(simulator_.pulpLimits());
    view_.setPulpLimits(simulator_.pulpLimits());
    const auto isOpen = [this] { return simulator_.mode() != Simulator::Mode::empty; };
    for (const Command command : {Command::distance, Command::depth, Command::pulp, Command::section})
        window_.commands().enableWhile(commands_[command], isOpen);
    connectTools();
    connectSection();
    connectPlots();
    connect(&view_, &ViewWidget::lookChanged, this, &MeasureFeature::showLegend);
    readouts_.setInterval(kReadoutMs);
    connect(&readouts_, &QTimer::timeout, this, &MeasureFeature::showReadouts);
}

void MeasureFeature::connectTools() {
    // As they were in the hand last: after a restart, after a crash, in a window of another language.
    box_->setLoad(
        settings_.number(QStringLiteral("work/loadN"), box_->loadN(), MeasureBox::kMinLoadN, MeasureBox::kMaxLoadN));
    if (settings_.value(QStringLiteral("work/depthStopOn")).isValid())
        box_->keepDepthStop(settings_.value(QStringLiteral("work/depthStopOn")).toBool(),
                            settings_.number(QStringLiteral("work/depthStopMm"), MeasureBox::kFirstStopMm,
                                             MeasureBox::kLeastStopMm, MeasureBox::kMaxStopMm));
    if (settings_.value(QStringLiteral("work/perPassMm")).isValid()) {
        const double mm = settings_.number(QStringLiteral("work/perPassMm"), 0.0, 0.0, input::kMaxPerPassMm);
        box_->passRow()->setDepth(mm > 0.0 ? std::optional(mm) : std::nullopt);
    }
    // The first record begins with it.
    simulator_.noteHand(box_->depthStopMm().has_value(), box_->passRow()->depthMm());
    const auto keepStop = [this](double stopMm) {
        // What an exercise withholds is off there, and as it was afterwards.
        if (!simulator_.permissions().allows(Operation::depthStop)) return;
        settings_.set(QStringLiteral("work/depthStopOn"), stopMm > 0.0);
        if (stopMm > 0.0) settings_.set(QStringLiteral("work/depthStopMm"), stopMm);
    };
    const auto keepLoad = [this](double loadN) { settings_.set(QStringLiteral("work/loadN"), loadN); };
    connect(&view_, &ViewWidget::loadChanged, this, keepLoad);
    connect(box_, &MeasureBox::loadChanged, this, keepLoad);
    connect(box_, &MeasureBox::depthStopChanged, this, keepStop);
    // The load and the depth stop: wheel in the picture, sliders in the box.
    connect(&view_, &ViewWidget::loadChanged, box_, &MeasureBox::setLoad);
    connect(box_, &MeasureBox::loadChanged, &view_, &ViewWidget::setLoad);
    connect(&view_, &ViewWidget::stopChanged, this, [this, keepStop](std::optional<double> depthMm) {
        box_->setDepthStop(depthMm.value_or(0.0));
        keepStop(depthMm.value_or(0.0));
        noteHand();
    });
    connect(box_, &MeasureBox::depthStopChanged, this, [this](double stopMm) {
        view_.setStop(stopMm > 0.0 ? std::optional<double>(stopMm) : std::nullopt);
        noteHand();
    });
    connect(&view_, &ViewWidget::perPassChanged, this, [this](std::optional<double> depthMm) {
        box_->passRow()->setDepth(depthMm);
        noteHand();
    });
    connect(box_->passRow(), &PassRow::changed, &view_, &ViewWidget::setPerPass);
    const auto keepPass = [this](std::optional<double> depthMm) {
        settings_.set(QStringLiteral("work/perPassMm"), depthMm.value_or(0.0));
    };
    connect(&view_, &ViewWidget::perPassChanged, this, keepPass);
    connect(box_->passRow(), &PassRow::changed, this, keepPass);
    // The picture decides; the actions follow.
    for (const auto& [command, tool] : kTools)
        on(commands_[command], [this, t = tool](bool isOn) { view_.setTool(isOn ? t : Tool::drill); });
    connect(&view_, &ViewWidget::toolChanged, this, [this](Tool now) {
        for (const auto& [command, tool] : kTools)
            commands_[command]->setChecked(now == tool);
        box_->setCalliperActive(now == Tool::calliper);
    });
    connect(box_, &MeasureBox::calliperToggled, this,
            [this](bool isOn) { view_.setTool(isOn ? Tool::calliper : Tool::drill); });
    on(commands_[Command::clear], [this] {
        view_.clearMeasurements();
        box_->setCalliper({});
        probedDepthMm_.reset();
        probedLeftMm_.reset();
    });
    connect(&view_, &ViewWidget::measured, this, [this](const Measurement& m) {
        if (m.kind == Measurement::Kind::distance) box_->setCalliper(m.valueMm);
        if (m.kind == Measurement::Kind::depth) probedDepthMm_ = m.valueMm;
        if (m.kind == Measurement::Kind::pulp) probedLeftMm_ = m.valueMm;
        window_.statusBar()->showMessage(m.text(), 8000);
    });
}

/// The pointer's hand has one; an arm has none, whatever the panel says.
void MeasureFeature::connectSection() {
    on(commands_[Command::section], [this](bool isOn) {
        if (!isOn && view_.tool() == Tool::section) view_.setTool(Tool::drill);
        view_.setSection(isOn ? std::optional(SectionPlace{}) : std::nullopt);
    });
    connect(&view_, &ViewWidget::sectionChanged, this, &MeasureFeature::takeSection);
    connect(box_, &MeasureBox::sectionChanged, this,
            [this](bool on, MeasureBox::Orientation orientation, double offsetMm) {
                SectionPlace next = view_.section().value_or(SectionPlace{});
                const bool turned = next.direction != directionOf(orientation);
                next.direction = directionOf(orientation);
                // Another direction begins in the middle of the tooth.
                next.offsetMm = turned ? toothBounds().centre()[axisAcross(next.direction)] : offsetMm;
                view_.setSection(on ? std::optional(next) : std::nullopt);
                takeSection();
            });
}

void MeasureFeature::connectPlots() {
    connect(&simulator_, &Simulator::plotted, plots_, &PlotPanel::append);
    connect(&simulator_, &Simulator::noticed, this, [this](const QString& id) {
        if (id == idOf(Notice::pulpExposed)) plots_->addEvent(simulator_.sample().timeS, tr("Pulp"));
    });
    connect(plots_, &PlotPanel::saveRequested, this, &MeasureFeature::savePlot);
    const auto showLimits = [this] {
        plots_->setForceLimit(simulator_.capability().maxForceN);
        const std::string drive = simulator_.driveName().toStdString();
        plots_->setFreeSpeed(instrument::driveByName(drive).freeSpeedRpm);
        box_->setPressLimits(instrument::pressLimitsOf(drive));
    };
    connect(&simulator_, &Simulator::settingsChanged, this, showLimits);
    connect(&simulator_.hands(), &DeviceManager::changed, this, showLimits);
    connect(&simulator_, &Simulator::documentChanged, this, showLimits);
    showLimits();
}

void MeasureFeature::showDocument() {
    plots_->clear();
    readouts_.stop();
    if (simulator_.tooth() && simulator_.toothCase()) {
        const exercise::Permissions now = simulator_.permissions();
        box_->setPermissions(now);
        volumes_->setLocked(now.locks(Operation::volumes));
        showLegend();
        takeSection();
        box_->setCalliper({});
        probedDepthMm_.reset();
        probedLeftMm_.reset();
        // The hand that holds this tooth's bur presses and stops as the panel says.
        isFittingHand_ = true;
        view_.setLoad(box_->loadN());
        view_.setStop(box_->depthStopMm());
        view_.setPerPass(box_->passRow()->depthMm());
        isFittingHand_ = false;
        noteHand();
        readouts_.start();
    }
}

/// What holds the mouse's hand back; an arm has none of it.
void MeasureFeature::noteHand() {
    if (isFittingHand_) return;
    const input::PointerController* const hand = view_.hand();
    simulator_.noteHand(hand && hand->stopMm(), hand ? hand->perPassMm() : std::nullopt);
}

void MeasureFeature::showTick() {
    const messages::HapticSample& sample = simulator_.sample();
    tooth::TissueVolumes removed{};
    std::copy(sample.removedMm3.begin(), sample.removedMm3.end(), removed.begin());
    volumes_->setVolumes(removed);
}

void MeasureFeature::showLegend() {
    if (simulator_.toothCase())
        volumes_->setLegend(view::legendOf(presentTissues(*simulator_.toothCase()), view_.shownLook().palette));
}

core::Box MeasureFeature::toothBounds() const {
    return simulator_.tooth() ? simulator_.tooth()->model().outer.bounds()
                              : core::Box{core::Vec3::Constant(-10.0), core::Vec3::Constant(10.0)};
}

void MeasureFeature::takeSection() {
    const std::optional<SectionPlace> place = view_.section();
    commands_[Command::section]->setChecked(place.has_value());
    const SectionPlace shown = place.value_or(SectionPlace{});
    const core::Box bounds = toothBounds();
    const int axis = axisAcross(shown.direction);
    box_->setSectionRange(bounds.min[axis], bounds.max[axis]);
    box_->setSection(place.has_value(), orientationOf(shown.direction), shown.offsetMm);
}

/// Depth under the bur's tip while it touches, else what was measured last; a tenth of a second is quick enough to
/// read.
void MeasureFeature::showReadouts() {
    if (!window_.isVisible() || !simulator_.tooth()) return;
    const messages::HapticSample sample = view_.sample();
    const bool mayRead = view_.permissions().allows(exercise::Operation::depthReadout);
    if (sample.tick == 0 || sample.depthMm < -0.05 || !mayRead) {
        box_->setDepth(mayRead ? probedDepthMm_ : std::nullopt);
        box_->setLeftOverPulp(mayRead ? probedLeftMm_ : std::nullopt,
                              mayRead && probedLeftMm_ && *probedLeftMm_ <= 0.0);
        return;
    }
    // Who cuts on makes what was measured a thing of the past.
    if (sample.pedal > 0.0) {
        probedDepthMm_.reset();
        probedLeftMm_.reset();
    }
    const core::Vec3 tip = core::toVec(sample.proxyPositionMm);
    struct Read {
        double depthMm;
        std::optional<double> leftMm;
    };
    const Read read = simulator_.tooth()->withProbe([&](const measure::ToothProbe& probe) {
        return Read{probe.depthBelowUncutMm(tip), probe.leftOverPulpMm(tip)};
    });
    box_->setDepth(std::max(0.0, read.depthMm));
    box_->setLeftOverPulp(read.leftMm, read.leftMm && *read.leftMm <= 0.0);
}

void MeasureFeature::savePlot(const QString& format) {
    const QString file = window_.questions.save(tr("Save the plots"), QStringLiteral("plots.") + format,
                                                QStringLiteral("%1 (*.%1)").arg(format), QLatin1Char('.') + format);
    if (file.isEmpty()) return;
    try {
        if (format == QLatin1String("png")) {
            QByteArray bytes;
            QBuffer buffer(&bytes);
            buffer.open(QIODevice::WriteOnly);
            plots_->picture().save(&buffer, "PNG");
            writeBytes(file, bytes);
        } else {
            writeBytes(file, format == QLatin1String("svg") ? plots_->svg() : plots_->csv());
        }
        window_.tellSaved(file);
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
    }
}

}  // namespace handpiece::desktop
