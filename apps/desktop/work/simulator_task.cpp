// SPDX-License-Identifier: Apache-2.0
// An exercise from its beginning to its score.
#include <QDateTime>

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
    return wanted;
}

void Simulator::openExercise(const fs::path& path) {
    LoadRequest wanted = request();
    wanted.task = path;
    load(std::move(wanted), tr("Preparing the exercise"));
}

void Simulator::finish() {
    if (job_ || mode_ != Mode::liveSession || !document_.task) return;
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
            done->work = course::finish(left->file.session, task, progress);
        },
        [this, left, done] {
            const Document& document = left->tooth.document;
            for (const RecordingPlace& recording : document.recordings)
                done->recordings.push_back(recording.name);
            done->taskPath = document.taskPath;
            done->finished = QDateTime::currentMSecsSinceEpoch();
            done->began = document.began != 0
                              ? document.began
                              : done->finished - std::llround(1e3 * left->tooth.elapsedS);
            // What was cut lies open as it ended; its marker goes once whoever hears of it has kept the result.
            document_ = {};
            unsaved_ = false;
            emit unsavedChanged(false);
            openSession(done->work.session);
            whenFree([this, done] {
                if (mode_ != Mode::replay) {
                    close();
                } else {
                    seek(replay_->durationS());
                }
                emit finished(*done);
            });
        },
        // Cancelled, or it cannot be judged: the tooth as it was.
        [this, left] { comeBack(left); });
}

}  // namespace handpiece::desktop
