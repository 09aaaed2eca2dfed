// SPDX-License-Identifier: Apache-2.0
// An exercise from its beginning to its score.
#include <QDateTime>
#include <QLocale>

#include "desktop/work/simulator.h"

namespace handpiece::desktop {

namespace fs = std::filesystem;

/// What the tooth that is open was opened from, to be opened anew.
LoadRequest Simulator::requestAgain() const {
    LoadRequest wanted = request();
    wanted.starter = document_.starter;
    wanted.path = document_.caseFile;
    wanted.fdi = document_.workedOn;
    wanted.task = document_.taskPath;
    wanted.unaided = document_.task && isUnaided(*document_.task);
    return wanted;
}

void Simulator::openExercise(const fs::path& path, bool unaided) {
    if (!may(exercise::Operation::elsewhere)) return;
    LoadRequest wanted = request();
    wanted.task = path;
    wanted.unaided = unaided;
    load(std::move(wanted), tr("Preparing the exercise"));
}

/// While a live session runs.
void Simulator::watchTime() {
    const auto& task = document_.task;
    if (exam_ || !task || !task->minutes || isTimeTold_ || workedS() < 60.0 * *task->minutes) return;
    isTimeTold_ = true;
    isTimeOver_->store(task->isTimeHard, std::memory_order_relaxed);
    tellTimeOver();
}

void Simulator::tellTimeOver() {
    emit noticed(isTimeOver() ? QStringLiteral("time-over") : QStringLiteral("time-up"),
                 {QLocale().toString(*document_.task->minutes)});
}

void Simulator::finish() {
    if (job_ || mode_ != Mode::liveSession || !document_.task || !may(exercise::Operation::elsewhere)) return;
    if (!isRecorded()) {
        emit failed(problemById(QStringLiteral("no-recording")));
        return;
    }
    // Only a recording that was closed is whole.
    const auto left = std::make_shared<Left>(leaveLiveSession());
    const auto done = std::make_shared<Finished>();
    start(
        tr("Scoring your work"),
        [left, done, task = document_.task](const core::Progress& progress) {
            // What was done in sittings before this one belongs to it.
            std::vector<assessment::ChainLink> chain;
            for (const RecordingPlace& place : left->tooth.document.recordings)
                chain.push_back({place.name, place.in, place.packed});
            done->work = course::finish(chain, task, progress);
        },
        [this, left, done] {
            const Document& document = left->tooth.document;
            for (const RecordingPlace& recording : document.recordings)
                done->recordings.push_back(recording.name);
            done->taskPath = document.taskPath;
            done->workedS = left->tooth.elapsedS;
            done->finished = QDateTime::currentMSecsSinceEpoch();
            done->began =
                document.began != 0 ? document.began : done->finished - std::llround(1e3 * left->tooth.elapsedS);
            // What was cut lies open as it ended; its marker goes once whoever hears of it has kept the result.
            document_ = {};
            unsaved_ = false;
            emit unsavedChanged(false);
            emit finished(*done);
            openSession(done->work.session);
            whenFree([this] {
                if (mode_ == Mode::replay)
                    seek(replay_->durationS());
                else if (mode_ == Mode::empty)
                    close();
            });
        },
        // Cancelled, or it cannot be judged: the tooth as it was.
        [this, left] { comeBack(left); });
}

}  // namespace handpiece::desktop
