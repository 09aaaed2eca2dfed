// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/school/school_link.h"

#include <QBuffer>
#include <QCoreApplication>
#include <QElapsedTimer>
#include <QFileInfo>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QStandardPaths>

namespace handpiece::desktop {
namespace {

constexpr QSize kTile(480, 300), kClose(960, 600);
constexpr int kQuality = 75;
/// A program that takes nothing any more has so much to take, and gets no more.
constexpr qint64 kMostWaitingBytes = 1 << 20;
constexpr int kPatienceMs = 300;

QByteArray lineOf(const QJsonObject& json) {
    return QJsonDocument(json).toJson(QJsonDocument::Compact) + '\n';
}

QByteArray packed(const QImage& picture, const QSize& most) {
    QByteArray jpeg;
    QBuffer buffer(&jpeg);
    buffer.open(QIODevice::WriteOnly);
    picture.scaled(most, Qt::KeepAspectRatio, Qt::SmoothTransformation).save(&buffer, "JPEG", kQuality);
    return jpeg;
}

}  // namespace

QString schoolProgram() {
    const QString name = QStringLiteral("handpiece-school");
    const QString beside = QCoreApplication::applicationDirPath() + QLatin1Char('/') + name;
    return QFileInfo(beside).isExecutable() ? beside : QStandardPaths::findExecutable(name);
}

SchoolLink::SchoolLink(std::filesystem::path home, std::filesystem::path sessions, QObject* parent)
    : QObject(parent), home_(std::move(home)), sessions_(std::move(sessions)) {
    process_.setProcessChannelMode(QProcess::ForwardedErrorChannel);
    connect(&process_, &QProcess::readyReadStandardOutput, this, &SchoolLink::hear);
    connect(&process_, &QProcess::finished, this, &SchoolLink::ended);
    connect(&process_, &QProcess::errorOccurred, this, [this](QProcess::ProcessError error) {
        if (error == QProcess::FailedToStart) ended();
    });
}

SchoolLink::~SchoolLink() {
    packing_.reset();
    process_.disconnect(this);
    if (process_.state() == QProcess::NotRunning) return;
    process_.closeWriteChannel();
    // What it was just sending goes on from there next time.
    if (!process_.waitForFinished(kPatienceMs)) process_.kill();
    process_.waitForFinished(kPatienceMs);
}

bool SchoolLink::isEnrolled() const {
    std::error_code ec;
    return std::filesystem::is_regular_file(home_ / "school.json", ec);
}

void SchoolLink::begin() {
    if (process_.state() != QProcess::NotRunning || !isEnrolled()) return;
    const QString path = schoolProgram();
    if (path.isEmpty()) {
        missing_ = tr("The school's part of the program is not installed (handpiece-school).");
        emit changed();
        return;
    }
    missing_.clear();
    process_.start(path, {QStringLiteral("station"), QStringLiteral("--home"), toQString(home_),
                          QStringLiteral("--sessions"), toQString(sessions_)});
    emit changed();
}

void SchoolLink::send(const QByteArray& bytes) {
    if (process_.state() == QProcess::Running && process_.bytesToWrite() < kMostWaitingBytes) process_.write(bytes);
}

void SchoolLink::show(const QImage& picture, const LiveFigures& figures) {
    if (process_.state() != QProcess::Running || picture.isNull() || packing_ || process_.bytesToWrite() > 0) return;
    wantsRest_ = false;
    QElapsedTimer captured;
    captured.start();
    const auto jpeg = std::make_shared<QByteArray>();
    packing_ = std::make_unique<Job>(QString(), [jpeg, picture, most = standing_.closely ? kClose : kTile](
                                                    const core::Progress&) { *jpeg = packed(picture, most); });
    connect(packing_.get(), &Job::done, this, [this, jpeg, figures, captured] {
        packing_.release()->deleteLater();
        if (wantsRest_ || jpeg->isEmpty()) return;
        send(lineOf({{"kind", "live"},
                     {"person", ""},
                     {"assignment", ""},
                     {"exercise_hash", figures.exerciseHash},
                     {"title", figures.title.left(60)},
                     {"shared", figures.isShared},
                     {"elapsed_s", figures.elapsedS},
                     {"removed_mm3", figures.removedMm3},
                     {"flags", QJsonArray::fromStringList(figures.flags)},
                     {"age_ms", captured.elapsed()},
                     {"bytes", jpeg->size()}}) +
             *jpeg);
        isShowing_ = true;
    });
    connect(packing_.get(), &Job::failed, this, [this] { packing_.release()->deleteLater(); });
    packing_->start();
}

void SchoolLink::rest() {
    wantsRest_ = true;
    if (std::exchange(isShowing_, false)) send(lineOf({{"kind", "rest"}}));
}

void SchoolLink::push() {
    send(lineOf({{"kind", "push"}}));
}

void SchoolLink::hear() {
    while (process_.canReadLine()) {
        const QJsonObject json = QJsonDocument::fromJson(process_.readLine()).object();
        if (json.isEmpty()) continue;
        SchoolStanding now;
        now.isConnected = json["connected"].toBool(), now.isShown = json["shown"].toBool();
        now.closely = json["closely"].toBool(), now.waiting = json["waiting"].toInt();
        for (const QJsonValue& one : json["watchers"].toArray())
            now.watchers << one.toObject()["name"].toString();
        for (const QJsonValue& one : json["assigned"].toArray())
            now.assigned << one.toString();
        now.trouble = json["trouble"].toString();
        standing_ = now;
        emit changed();
    }
    if (process_.bytesAvailable() > kMostWaitingBytes) process_.kill();  // it speaks another language
}

void SchoolLink::ended() {
    standing_ = {};
    isShowing_ = false;
    missing_ = tr("The school's part of the program has ended; it begins again with the next tooth.");
    emit changed();
}

}  // namespace handpiece::desktop
