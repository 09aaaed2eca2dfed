// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/school/exam_link.h"

#include <QDateTime>
#include <QFileInfo>
#include <QJsonArray>
#include <QJsonDocument>
#include <QLocale>
#include <utility>

#include "desktop/features/school/school_link.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/case/exercise.h"

namespace handpiece::desktop {
namespace {

constexpr qint64 kMostUnreadBytes = 4 << 20;
constexpr int kEndMs = 300;

QString socketPath() {
    return qEnvironmentVariable("HANDPIECE_EXAM_SOCKET", QStringLiteral("/run/handpiece/exam.sock"));
}

QStringList texts(const QJsonValue& list) {
    QStringList all;
    for (const QJsonValue& one : list.toArray())
        all << one.toString();
    return all;
}
qint64 whole(const QJsonObject& of, const char* key) {
    return of[QLatin1String(key)].toInteger();
}
QString inThisLanguage(const QJsonObject& byLanguage) {
    cases::Texts all;
    for (auto it = byLanguage.begin(); it != byLanguage.end(); ++it)
        all[it.key().toStdString()] = it.value().toString().toStdString();
    const std::string_view text = cases::inLanguage(all, QLocale().bcp47Name().toStdString());
    return QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size()));
}

ExamDesk deskOf(const QJsonObject& o) {
    ExamDesk desk;
    desk.sitting = o["sitting"].toString(), desk.title = o["title"].toString();
    desk.nowMs = whole(o, "now_ms"), desk.beganMs = whole(o, "began_ms"), desk.deadlineMs = whole(o, "deadline_ms");
    desk.extraPercent = o["extra_percent"].toInt(), desk.pauseMinutes = o["pause_minutes"].toInt();
    desk.locked = texts(o["locked"]);
    return desk;
}

Problem problemIn(const QJsonObject& o) {
    QStringList arguments = texts(o["arguments"]);
    for (QString& one : arguments)
        one = localClock(one);
    const QString where = o["where"].toString();
    if (const QString id = o["id"].toString(); problemIds().contains(id)) return problemById(id, arguments, where);
    core::Error error(o["problem"].toString().toStdString(), where.toStdString(), o["remedy"].toString().toStdString());
    return problemOf(error);
}

}  // namespace

QString localClock(const QString& text) {
    if (!text.endsWith(QLatin1String(" UTC"))) return text;
    QDateTime at = QDateTime::fromString(text.chopped(4), QStringLiteral("yyyy-MM-dd HH:mm"));
    if (!at.isValid()) return text;
    at.setTimeSpec(Qt::UTC);
    return QLocale().toString(at.toLocalTime(), QLocale::ShortFormat);
}

ExamLink::ExamLink(QObject* parent) : QObject(parent) {
    process_.setProcessChannelMode(QProcess::ForwardedErrorChannel);
    connect(&process_, &QProcess::readyReadStandardOutput, this, &ExamLink::hear);
    const auto isGone = [this] {
        const QString of = std::exchange(asked_, {});
        emit failed(of.isEmpty() ? QStringLiteral("desk") : of, problemById(QStringLiteral("exam-program")));
    };
    connect(&process_, &QProcess::finished, this, isGone);
    connect(&process_, &QProcess::errorOccurred, this, [isGone](QProcess::ProcessError error) {
        if (error == QProcess::FailedToStart) isGone();
    });
}

ExamLink::~ExamLink() {
    end();
}

bool ExamLink::isSetUp() {
    return QFileInfo::exists(socketPath());
}

void ExamLink::begin() {
    if (isRunning()) return;
    const QString path = schoolProgram();
    if (path.isEmpty()) {
        emit failed(QStringLiteral("desk"), problemById(QStringLiteral("exam-program")));
        return;
    }
    process_.start(path, {QStringLiteral("exam"), QStringLiteral("line"), QStringLiteral("--socket"), socketPath()});
}

void ExamLink::end() {
    asked_.clear();
    if (!isRunning()) return;
    const QSignalBlocker quiet(process_);
    process_.closeWriteChannel();
    if (!process_.waitForFinished(kEndMs)) process_.kill();
    process_.waitForFinished(kEndMs);
}

void ExamLink::send(const QJsonObject& line) {
    asked_ = line["kind"].toString();
    begin();
    if (isRunning()) process_.write(QJsonDocument(line).toJson(QJsonDocument::Compact) + '\n');
}

void ExamLink::look(const QString& candidate, const QString& opening) {
    send({{"kind", "look"}, {"candidate", candidate}, {"opening", opening}});
}

void ExamLink::beginExam(const QString& candidate, const QString& invigilator, const QString& pin) {
    send({{"kind", "begin"}, {"candidate", candidate}, {"invigilator", invigilator}, {"pin", pin}});
}

void ExamLink::fetchExercise(const QString& file) {
    send({{"kind", "exercise"}, {"file", file}});
}

void ExamLink::watch(const QString& sitting, const QStringList& recordings) {
    const QString before = asked_;
    send({{"kind", "watch"}, {"sitting", sitting}, {"recordings", QJsonArray::fromStringList(recordings)}});
    asked_ = before;  // it has no answer
}

void ExamLink::finish(const QString& sitting, const QStringList& recordings) {
    send({{"kind", "finish"}, {"sitting", sitting}, {"recordings", QJsonArray::fromStringList(recordings)}});
}

void ExamLink::askEnding(const QString& sitting) {
    send({{"kind", "ending"}, {"sitting", sitting}});
}

void ExamLink::hear() {
    while (process_.canReadLine())
        take(QJsonDocument::fromJson(process_.readLine()).object());
    if (process_.bytesAvailable() > kMostUnreadBytes) process_.kill();  // it speaks another language
}

void ExamLink::take(const QJsonObject& said) {
    const QString kind = said["kind"].toString();
    if (kind == QLatin1String("desk")) {
        emit deskHeard(deskOf(said));
        return;
    }
    if (kind == QLatin1String("problem")) {
        const QString of = said["of"].toString();
        if (of == asked_) asked_.clear();
        emit failed(of, problemIn(said));
        return;
    }
    asked_.clear();
    if (kind == QLatin1String("exam")) {
        ExamOffer offer;
        offer.title = said["title"].toString();
        offer.exercise = inThisLanguage(said["titles"].toObject());
        offer.instructions = inThisLanguage(said["instructions"].toObject());
        offer.timeMs = whole(said, "time_ms"), offer.minutes = said["minutes"].toInt();
        offer.extraPercent = said["extra_percent"].toInt(), offer.pauseMinutes = said["pause_minutes"].toInt();
        offer.again = said["again"].toInt(), offer.locked = texts(said["locked"]);
        emit offered(offer);
    } else if (kind == QLatin1String("begun")) {
        emit begun(deskOf(said));
    } else if (kind == QLatin1String("exercise")) {
        emit exerciseKept(said["file"].toString());
    } else if (kind == QLatin1String("ended")) {
        ExamEnding ending;
        ending.sitting = said["sitting"].toString();
        ending.isGivenUp = said["how"].toString() == QLatin1String("given-up");
        ending.atMs = whole(said, "at_ms"), ending.files = texts(said["files"]);
        ending.entry = said["entry"].toString(), ending.receipt = said["receipt"].toString();
        emit ended(ending);
    }
}

}  // namespace handpiece::desktop
