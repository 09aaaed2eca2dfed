// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/replay/replay_feature.h"

#include "desktop/features/replay/replay_bar.h"
#include "desktop/widgets/status_line.h"
#include "desktop/work/simulator.h"
#include "handpiece/record/session/event_watch.h"

namespace handpiece::desktop {
namespace {

using Command = ReplayFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::open, "actionOpenSession", QT_TRANSLATE_NOOP("Commands", "Open recording..."),
     QT_TRANSLATE_NOOP("Commands", "Open a recorded session to watch it"), "replay", "Ctrl+H", in(Shelf::file, 20),
     exercise::Operation::elsewhere},
    {Command::watch, "actionReplay", QT_TRANSLATE_NOOP("Commands", "Replay"),
     QT_TRANSLATE_NOOP("Commands", "Watch what you have done so far; closing the replay brings the tooth back"),
     "replay", "Ctrl+Y", in(Shelf::file, 21), in(Shelf::toolBar, 41), onCard(6), exercise::Operation::elsewhere},
    {Command::keep, "actionKeepRecording", QT_TRANSLATE_NOOP("Commands", "Keep recording..."),
     QT_TRANSLATE_NOOP("Commands", "Every session is recorded; keep a copy of this one"), "record", "Ctrl+K",
     in(Shelf::file, 22), in(Shelf::toolBar, 40), brief(QT_TRANSLATE_NOOP("Commands", "Record")),
     exercise::Operation::elsewhere},
};

}  // namespace

ReplayFeature::ReplayFeature(const FeatureContext& context)
    : Feature(context), commands_(window_.commands(), kCommands), bar_(new ReplayBar) {
    window_.addBelow(bar_);
    bar_->hide();
    connect(bar_, &ReplayBar::playRequested, &simulator_, &Simulator::play);
    connect(bar_, &ReplayBar::seekRequested, &simulator_, [this](double timeS) { simulator_.seek(timeS); });
    connect(bar_, &ReplayBar::speedChosen, &simulator_, &Simulator::setReplaySpeed);
    connect(bar_, &ReplayBar::closeRequested, &simulator_, [this] { simulator_.closeReplay(); });
    connectCommands();
    window_.statusFields.push_back([this](StatusFigures& figures) {
        if (simulator_.mode() != Simulator::Mode::liveSession) return;
        const auto& recording = simulator_.status().recording;
        figures.recording = recording.recording && !simulator_.recording().empty() ? StatusFigures::Recording::on
                                                                                   : StatusFigures::Recording::stopped;
        figures.recordingNote = QString::fromStdString(recording.message);
    });
}

void ReplayFeature::connectCommands() {
    on(commands_[Command::open], [this] {
        window_.openFile(window_.questions.fileToOpen(tr("Open recording"), toQString(Folders::standard().sessions),
                                                      tr("Recordings (*.h5);;All files (*)")));
    });
    on(commands_[Command::watch], [this] { simulator_.replayThis(); });
    on(commands_[Command::keep], [this] { keep(); });
    const auto isRecorded = [this] { return !simulator_.isBusy() && simulator_.isRecorded(); };
    Commands& commands = window_.commands();
    commands.enableWhile(commands_[Command::open], [this] { return !simulator_.isBusy(); });
    commands.enableWhile(commands_[Command::keep], isRecorded);
    commands.enableWhile(commands_[Command::watch], [this, isRecorded] {
        return isRecorded() || (simulator_.mode() == Simulator::Mode::review && !simulator_.isBusy());
    });
}

void ReplayFeature::showDocument() {
    const bool replay = simulator_.mode() == Simulator::Mode::replay;
    bar_->setVisible(replay);
    if (replay && simulator_.replay()) showMarks();
}

void ReplayFeature::showMarks() {
    const ReplayDriver& driver = *simulator_.replay();
    bar_->setDuration(driver.durationS());
    std::vector<ReplayMark> marks;
    for (const session::Event& event : driver.events()) {
        using Kind = ReplayMark::Kind;
        Kind kind = Kind::other;
        if (event.name == session::nameOf(session::EventName::keyFrame) ||
            event.name == session::nameOf(session::EventName::scheduling))
            continue;
        if (event.name == session::nameOf(session::EventName::strokeBegin)) kind = Kind::strokeBegin;
        if (event.name == session::nameOf(session::EventName::strokeEnd)) kind = Kind::strokeEnd;
        if (event.name == session::nameOf(session::EventName::undo) ||
            event.name == session::nameOf(session::EventName::redo) ||
            event.name == session::nameOf(session::EventName::reset))
            kind = Kind::undo;
        if (event.name == session::nameOf(session::EventName::burChange) ||
            event.name == session::nameOf(session::EventName::parameterChange) ||
            event.name == session::nameOf(session::EventName::resume))
            kind = Kind::change;
        if (event.name == session::nameOf(session::EventName::pulpExposure) ||
            event.name == session::nameOf(session::EventName::neighbourTouched) ||
            event.name == session::nameOf(session::EventName::neighbourCut) ||
            event.name == session::nameOf(session::EventName::gingivaCut) ||
            event.name == session::nameOf(session::EventName::fault))
            kind = Kind::warning;
        marks.push_back({static_cast<double>(event.tick) / driver.rateHz(), kind, eventText(event.name)});
    }
    bar_->setMarks(marks);
    bar_->setTime(0.0);
    bar_->setPlaying(false);
}

void ReplayFeature::showTick() {
    if (simulator_.mode() != Simulator::Mode::replay || !simulator_.replay()) return;
    view_.setSample(simulator_.sample());
    const ReplayNow now = simulator_.replay()->now();
    bar_->setTime(now.timeS);
    bar_->setPlaying(now.playing);
}

void ReplayFeature::keep() {
    if (!simulator_.isRecorded()) {
        window_.showProblem(problemById(QStringLiteral("no-recording")));
        return;
    }
    const QString file = window_.questions.save(tr("Keep the recording"), toQString(simulator_.recording().filename()),
                                                tr("Recording (*.h5)"), QStringLiteral(".h5"));
    if (!file.isEmpty()) simulator_.copyRecording(toPath(file));
}

QString ReplayFeature::eventText(const std::string& name) {
    using session::EventName;
    const std::pair<EventName, QString> known[] = {{EventName::strokeBegin, tr("Stroke begins")},
                                                   {EventName::strokeEnd, tr("Stroke ends")},
                                                   {EventName::burChange, tr("Another bur")},
                                                   {EventName::firstDentine, tr("Dentine reached")},
                                                   {EventName::pulpExposure, tr("Pulp exposed")},
                                                   {EventName::neighbourTouched, tr("Adjacent tooth touched")},
                                                   {EventName::neighbourCut, tr("Adjacent tooth cut")},
                                                   {EventName::gingivaCut, tr("Gingiva cut")},
                                                   {EventName::headTouched, tr("Handpiece on a tooth")},
                                                   {EventName::workingWay, tr("Another way of working")},
                                                   {EventName::stall, tr("Bur stalled")},
                                                   {EventName::forceLimit, tr("Pressed too hard")},
                                                   {EventName::undo, tr("Undo")},
                                                   {EventName::redo, tr("Redo")},
                                                   {EventName::reset, tr("Reset")},
                                                   {EventName::parameterChange, tr("Settings changed")},
                                                   {EventName::fault, tr("Fault")},
                                                   {EventName::resume, tr("Gone on with")},
                                                   {EventName::end, tr("End")}};
    for (const auto& [event, text] : known)
        if (name == session::nameOf(event)) return text;
    return QString::fromStdString(name);
}

}  // namespace handpiece::desktop
