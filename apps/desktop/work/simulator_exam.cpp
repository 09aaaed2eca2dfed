// SPDX-License-Identifier: Apache-2.0
// An exam from its beginning to its end.
#include <algorithm>

#include "desktop/work/simulator.h"

namespace handpiece::desktop {

namespace fs = std::filesystem;

void Simulator::beginExam(const Exam& exam) {
    exam_ = exam;
    isExamLost_ = false;
    openExam();
}

void Simulator::openExam() {
    if (!exam_) return;
    if (job_) {
        job_->cancel();
        whenFree([this] { openExam(); });
        return;
    }
    const std::vector<Crashed> left = shelf_.ofExams();
    const auto mine = std::find_if(
        left.begin(), left.end(), [this](const Crashed& one) { return one.note.exam.toStdString() == exam_->sitting; });
    if (mine != left.end() && !isExamLost_) {
        isExamLost_ = true;  // until it is there
        bringBack(*mine, [this] { isExamLost_ = false; });
        return;
    }
    LoadRequest wanted = request();
    wanted.task = exam_->exercise;
    wanted.exam = exam_->sitting;
    wanted.examLocks = exam_->locked;
    load(std::move(wanted), tr("Preparing the exam"));
}

std::vector<fs::path> Simulator::closeExam() {
    std::vector<fs::path> recordings;
    if (job_ || !exam_ || mode_ != Mode::liveSession) return recordings;
    leftFor_ = std::make_shared<Left>(leaveLiveSession());
    for (const RecordingPlace& place : leftFor_->tooth.document.recordings)
        recordings.push_back(place.in);
    return recordings;
}

void Simulator::goOnWithExam() {
    if (exam_ && leftFor_) comeBack(leftFor_);
}

void Simulator::endExam() {
    if (!exam_) return;
    const std::string sitting = exam_->sitting;
    // What is open of it goes first: its marker stays with it.
    leftFor_.reset();
    close();
    exam_.reset();
    forgetExam(sitting);
    shelf_.tidy();
    emit documentChanged();
}

std::vector<std::string> Simulator::leftExams() const {
    std::vector<std::string> sittings;
    for (const Crashed& one : shelf_.ofExams()) {
        const std::string sitting = one.note.exam.toStdString();
        const bool isKnown = std::find(sittings.begin(), sittings.end(), sitting) != sittings.end();
        if (!isKnown && (!exam_ || exam_->sitting != sitting)) sittings.push_back(sitting);
    }
    return sittings;
}

void Simulator::forgetExam(const std::string& sitting) {
    for (const Crashed& one : shelf_.ofExams())
        if (one.note.exam.toStdString() == sitting) shelf_.settle(one.session);
}

}  // namespace handpiece::desktop
