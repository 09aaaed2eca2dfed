// SPDX-License-Identifier: Apache-2.0
#include "desktop/program/run_statistics.h"

#include <unistd.h>

#include <QFile>
#include <QJsonDocument>
#include <QJsonObject>
#include <ctime>

namespace handpiece::desktop {
namespace {

/// Three figures behind the point are more than the clock gives.
double rounded(double value) {
    return std::round(1e3 * value) / 1e3;
}

QJsonObject spread(const loop::Spread& s) {
    return {{QStringLiteral("p50"), rounded(s.p50)},
            {QStringLiteral("p99"), rounded(s.p99)},
            {QStringLiteral("p999"), rounded(s.p999)},
            {QStringLiteral("max"), rounded(s.max)}};
}

}  // namespace

std::string runStatistics(const simulation::LiveSessionStatus& liveSession, const sound::PlayerStatus& sound,
                          const PictureStatistics& picture, double firstPictureMs) {
    const QJsonObject tick{
        {QStringLiteral("seconds"), rounded(liveSession.timeS)},
        {QStringLiteral("ticks"), static_cast<qint64>(liveSession.ticks)},
        {QStringLiteral("lateTicks"), static_cast<qint64>(liveSession.lateTicks)},
        {QStringLiteral("missedPeriods"), static_cast<qint64>(liveSession.missedPeriods)},
        {QStringLiteral("samplesLost"), static_cast<qint64>(liveSession.queueOverflow)},
        {QStringLiteral("workUs"), spread(liveSession.allWorkUs)},
        {QStringLiteral("latenessUs"), spread(liveSession.allLatenessUs)},
        {QStringLiteral("schedulingClass"), QString::fromLatin1(rt::nameOf(liveSession.scheduling.scheduling))},
        {QStringLiteral("scheduling"), QString::fromStdString(liveSession.scheduling.line())}};
    const QJsonObject draw{{QStringLiteral("p50"), rounded(picture.drawMs.at(0.5))},
                           {QStringLiteral("p99"), rounded(picture.drawMs.at(0.99))},
                           {QStringLiteral("max"), rounded(picture.drawMs.most())}};
    QJsonObject stages;
    for (std::size_t i = 0; i < kLatencyStages.size(); ++i) {
        const LatencyReport::Stage& stage = picture.latency.stages[i];
        stages[QLatin1String(kLatencyStages[i])] =
            QJsonObject{{QStringLiteral("p50"), rounded(stage.p50Ms)},
                        {QStringLiteral("p99"), rounded(stage.p99Ms)},
                        {QStringLiteral("inSlowest"), rounded(stage.inSlowestMs)}};
    }
    const QJsonObject hand{{QStringLiteral("count"), static_cast<qint64>(picture.latency.count)},
                           {QStringLiteral("p50"), rounded(picture.latency.p50Ms)},
                           {QStringLiteral("p99"), rounded(picture.latency.p99Ms)},
                           {QStringLiteral("max"), rounded(picture.latency.worstMs)},
                           {QStringLiteral("stages"), stages}};
    const QJsonObject drawn{{QStringLiteral("frames"), static_cast<qint64>(picture.drawMs.count())},
                            {QStringLiteral("drawAndReadMs"), draw},
                            {QStringLiteral("handToPictureMs"), hand}};
    const QJsonObject heard{{QStringLiteral("silent"), sound.silent},
                            {QStringLiteral("device"), QString::fromStdString(sound.device)},
                            {QStringLiteral("latencyMs"), rounded(sound.latencyMs)},
                            {QStringLiteral("underruns"), static_cast<qint64>(sound.underruns)}};
    const QJsonObject all{{QStringLiteral("tick"), tick},
                          {QStringLiteral("picture"), drawn},
                          {QStringLiteral("firstPictureMs"), rounded(firstPictureMs)},
                          {QStringLiteral("sound"), heard}};
    return QJsonDocument(all).toJson().toStdString();
}

double sinceProgramStartMs() {
    QFile stat(QStringLiteral("/proc/self/stat"));
    if (!stat.open(QIODevice::ReadOnly)) return 0.0;
    // The name may hold spaces and brackets: fields are counted behind it, and the start is the 22nd of all.
    const QByteArray text = stat.readAll();
    const QList<QByteArray> fields = text.mid(text.lastIndexOf(')') + 2).split(' ');
    timespec now{};
    const double perSecond = static_cast<double>(sysconf(_SC_CLK_TCK));
    if (fields.size() < 20 || clock_gettime(CLOCK_BOOTTIME, &now) != 0 || !(perSecond > 0.0)) return 0.0;
    const double startedS = fields[19].toDouble() / perSecond;
    return 1e3 * (static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) - startedS);
}

}  // namespace handpiece::desktop
