// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/school/school_feature.h"

#include <QLabel>
#include <QLocale>
#include <QStatusBar>
#include <numeric>

#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"
#include "desktop/work/simulator.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/assess/task/task.h"

namespace handpiece::desktop {
namespace {

using Command = SchoolFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::sharePractice, "actionSharePractice", QT_TRANSLATE_NOOP("Commands", "Let practice be watched"),
     QT_TRANSLATE_NOOP("Commands", "Your teachers may look on while you practise, until you end it or the program"),
     "eye", "Ctrl+Shift+U", in(Shelf::file, 15), kCheckable, exercise::Operation::elsewhere},
};

constexpr const char* kFlags[] = {"neighbour-touched", "neighbour-cut", "gingiva-cut", "head-touched",
                                  "stalled",           "time-over",     "pulp-exposed"};

}  // namespace

SchoolFeature::SchoolFeature(const FeatureContext& context)
    : Feature(context),
      commands_(window_.commands(), kCommands),
      link_(simulator_.folders().sessions.parent_path(), simulator_.folders().sessions, this),
      note_(named(new QLabel, "schoolNote", tr("School"))) {
    window_.statusBar()->addPermanentWidget(note_);
    note_->hide();
    window_.commands().enableWhile(commands_[Command::sharePractice], [this] { return link_.isEnrolled(); });
    connect(commands_[Command::sharePractice], &QAction::toggled, this, [this] {
        showLive();
        showNote();
    });
    connect(&link_, &SchoolLink::changed, this, &SchoolFeature::showNote);
    connect(&simulator_, &Simulator::finished, this, [this] { link_.push(); });
    connect(&simulator_, &Simulator::noticed, this, [this](const QString& id) {
        for (const char* flag : kFlags)
            if (id == QLatin1String(flag) && !flags_.contains(id)) flags_ << id;
    });
    connect(&simulator_, &Simulator::wasReset, this, [this] { flags_.clear(); });
    connect(&timer_, &QTimer::timeout, this, &SchoolFeature::showLive);
    timer_.start(kPeriodMs);
}

void SchoolFeature::showDocument() {
    flags_.clear();
    exerciseHash_.clear();
    link_.begin();
    const auto& task = simulator_.task();
    if (task && link_.isEnrolled()) exerciseHash_ = QString::fromStdString(rubric::hashText(tasks::contentHash(*task)));
    showLive();
    showNote();
}

/// What the school gave to do, or what its student shares; nothing else leaves this window.
bool SchoolFeature::mayBeWatched() const {
    const SchoolStanding& standing = link_.standing();
    // An exam is no practice.
    if (simulator_.exam() || !standing.isConnected || simulator_.mode() != Simulator::Mode::liveSession) return false;
    return commands_[Command::sharePractice]->isChecked() ||
           (!exerciseHash_.isEmpty() && standing.assigned.contains(exerciseHash_));
}

void SchoolFeature::showLive() {
    if (!mayBeWatched()) return link_.rest();
    LiveFigures figures;
    figures.exerciseHash = exerciseHash_;
    figures.title = QString::fromStdString(simulator_.document().name);
    figures.isShared = commands_[Command::sharePractice]->isChecked();
    figures.elapsedS = simulator_.workedS();
    const messages::HapticSample& sample = simulator_.sample();
    figures.removedMm3 = std::accumulate(sample.removedMm3.begin(), sample.removedMm3.end(), 0.0);
    figures.flags = flags_;
    if ((sample.flags & messages::kPressesGingiva) != 0) figures.flags << QStringLiteral("gingiva-pressed");
    link_.show(view_.picture(), figures);
}

void SchoolFeature::showNote() {
    note_->setVisible(link_.isEnrolled());
    const SchoolStanding& standing = link_.standing();
    QStringList parts;
    const bool isWatched = standing.isShown && !standing.watchers.isEmpty();
    if (isWatched)
        parts << tr("watched by %1").arg(QLocale().createSeparatedList(standing.watchers));
    else if (standing.isShown)
        parts << tr("can be watched");
    else
        parts << (standing.isConnected ? tr("connected") : tr("not reached"));
    if (standing.waiting > 0) parts << tr("waiting to send %1").arg(standing.waiting);
    note_->setText(tr("School: %1").arg(QLocale().createSeparatedList(parts)));
    note_->setToolTip(!link_.missing().isEmpty()    ? link_.missing()
                      : !standing.trouble.isEmpty() ? standing.trouble
                                                    : tr("Finished work goes to the school by itself. Work that the "
                                                         "school gave to do, and practice that you share, can be "
                                                         "watched by its teachers."));
    QPalette tinted = window_.palette();
    if (isWatched) tinted.setColor(QPalette::WindowText, tonesOf(tinted).caution);
    note_->setPalette(tinted);
}

}  // namespace handpiece::desktop
