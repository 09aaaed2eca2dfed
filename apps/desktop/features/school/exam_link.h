// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The window's side of this station's exams: a program beside it, handpiece-school exam line, which speaks to the
/// service that holds them. docs/school-exams.md

#include <QElapsedTimer>
#include <QJsonObject>
#include <QObject>
#include <QProcess>
#include <QString>
#include <QStringList>

#include "desktop/framework/problem.h"

namespace handpiece::desktop {

/// Who is at an exam here, as the service tells it every second.
struct ExamDesk {
    QString sitting;  ///< empty: nobody
    QString title;
    qint64 nowMs = 0, beganMs = 0, deadlineMs = 0;  ///< by the service's clock [since 1970]
    int extraPercent = 0, pauseMinutes = 0;         ///< that this candidate has, in the deadline
    QStringList locked;
};

/// What would be begun by a candidate's code.
struct ExamOffer {
    QString title, exercise, instructions;
    qint64 timeMs = 0;  ///< with what follows
    int minutes = 0, extraPercent = 0, pauseMinutes = 0;
    int again = 0;  ///< how often this code was used here before
    QStringList locked;
};

/// What became of a sitting.
struct ExamEnding {
    QString sitting;
    bool isGivenUp = false;  ///< else it was handed over
    qint64 atMs = 0;
    QStringList files;  ///< SHA-256 of what was handed over
    QString entry;      ///< that the station signed
    QString receipt;    ///< that the school signed; empty: it has not come yet
};

/// Nothing here waits.
class ExamLink : public QObject {
    Q_OBJECT
  public:
    explicit ExamLink(QObject* parent);
    ~ExamLink() override;

    /// Whether this station has, or had, a service for exams.
    [[nodiscard]] static bool isSetUp();
    /// Starts the program where it does not run; failed() where it is not there.
    void begin();
    void end();
    [[nodiscard]] bool isRunning() const { return process_.state() != QProcess::NotRunning; }
    [[nodiscard]] qint64 processId() const { return process_.processId(); }

    void look(const QString& candidate, const QString& opening);
    void beginExam(const QString& candidate, const QString& invigilator, const QString& pin);
    void fetchExercise(const QString& file);
    /// Says how far they are from now on, until the exam ends.
    void watch(const QString& sitting, const QStringList& recordings);
    void finish(const QString& sitting, const QStringList& recordings);
    void askEnding(const QString& sitting);

  signals:
    void deskHeard(const handpiece::desktop::ExamDesk& desk);
    void offered(const handpiece::desktop::ExamOffer& offer);
    void begun(const handpiece::desktop::ExamDesk& desk);
    void exerciseKept(const QString& file);
    void ended(const handpiece::desktop::ExamEnding& ending);
    /// `of`: what was asked for, as the lines name it; "desk": the service does not answer by itself.
    void failed(const QString& of, const handpiece::desktop::Problem& problem);

  private:
    void hear();
    void take(const QJsonObject& said);
    void send(const QJsonObject& line);

    QProcess process_;
    QString asked_;  ///< what an answer is waited for; empty: nothing
};

/// "2026-11-26 15:08 UTC" becomes this place's time; all else stays.
[[nodiscard]] QString localClock(const QString& text);

}  // namespace handpiece::desktop
