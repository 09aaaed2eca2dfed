// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/session_shelf.h"

#include <QCoreApplication>
#include <QDateTime>
#include <QFile>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QSysInfo>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>

#include "desktop/framework/problem.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;

fs::path beside(const fs::path& session, const char* extension) {
    return fs::path(session).replace_extension(extension);
}

/// Held by a program that lives. A lock of one that died is taken over and given back. Where none can be made, on a
/// full disk, that says nothing of anybody: what a program that died left is offered all the same.
bool isAlive(const fs::path& session) {
    QLockFile lock(toQString(beside(session, ".lock")));
    lock.setStaleLockTime(0);
    if (!lock.tryLock(0)) {
        qint64 pid = 0;
        QString host, name;
        if (lock.error() != QLockFile::LockFailedError) return false;
        // To take over what a dead program left needs room as well.
        const bool isKnown = lock.getLockInfo(&pid, &host, &name) && host == QSysInfo::machineHostName();
        return !isKnown || QFile::exists(QStringLiteral("/proc/%1").arg(pid));
    }
    lock.unlock();
    return false;
}

std::optional<SessionNote> readNote(const fs::path& session) {
    QFile file(toQString(beside(session, ".json")));
    if (!file.open(QIODevice::ReadOnly)) return std::nullopt;
    const QJsonObject o = QJsonDocument::fromJson(file.readAll()).object();
    // A marker cut short by the crash itself still marks.
    SessionNote note{o[QStringLiteral("case")].toString(), o[QStringLiteral("title")].toString(),
                     o[QStringLiteral("attempt")].toString(), o[QStringLiteral("unsaved")].toBool(true)};
    // Markers of before name a kind of tooth that is no longer made: its recording has the tooth itself.
    if (const QJsonObject s = o[QStringLiteral("patient")].toObject(); !s.isEmpty())
        note.starter = Starter{s[QStringLiteral("fdi")].toInt(46),
                               {static_cast<std::uint64_t>(s[QStringLiteral("seed")].toInteger(1)),
                                s[QStringLiteral("age")].toDouble(dentition::Patient{}.ageYears)},
                               static_cast<std::size_t>(s[QStringLiteral("faces")].toInteger()),
                               s[QStringLiteral("mouth")].toBool(true)};
    note.workedOn = o[QStringLiteral("tooth")].toInt();
    note.exercise = o[QStringLiteral("exercise")].toString();
    note.task = o[QStringLiteral("task")].toString();
    note.beforeS = o[QStringLiteral("before_s")].toDouble();
    note.began = o[QStringLiteral("began")].toInteger();
    note.exam = o[QStringLiteral("exam")].toString();
    for (const QJsonValue& name : o[QStringLiteral("recordings")].toArray())
        note.recordings << name.toString();
    return note;
}

void writeNote(const fs::path& session, const SessionNote& note) {
    QJsonObject o;
    o[QStringLiteral("case")] = note.caseFile;
    o[QStringLiteral("title")] = note.title;
    o[QStringLiteral("attempt")] = note.attemptFile;
    o[QStringLiteral("unsaved")] = note.unsaved;
    if (const auto& s = note.starter)
        o[QStringLiteral("patient")] = QJsonObject{{QStringLiteral("fdi"), s->fdi},
                                                   {QStringLiteral("seed"), static_cast<qint64>(s->patient.seed)},
                                                   {QStringLiteral("age"), s->patient.ageYears},
                                                   {QStringLiteral("faces"), static_cast<qint64>(s->faces)},
                                                   {QStringLiteral("mouth"), s->inMouth}};
    if (note.workedOn != 0) o[QStringLiteral("tooth")] = note.workedOn;
    if (!note.task.isEmpty()) o[QStringLiteral("task")] = note.task;
    if (note.beforeS > 0.0) o[QStringLiteral("before_s")] = note.beforeS;
    if (note.began != 0) o[QStringLiteral("began")] = note.began;
    if (!note.exam.isEmpty()) o[QStringLiteral("exam")] = note.exam;
    if (!note.exercise.isEmpty()) o[QStringLiteral("exercise")] = note.exercise;
    if (!note.recordings.isEmpty()) o[QStringLiteral("recordings")] = QJsonArray::fromStringList(note.recordings);
    core::writeFile(beside(session, ".json"), QJsonDocument(o).toJson().toStdString(),
                    {.ownerOnly = true, .lasting = false});
}

std::vector<fs::path> sessionsIn(const fs::path& folder) {
    std::vector<fs::path> sessions;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (entry.path().extension() == ".h5") sessions.push_back(entry.path());
    // Names begin with the time: the newest first.
    std::sort(sessions.rbegin(), sessions.rend());
    return sessions;
}

}  // namespace

SessionShelf::SessionShelf(fs::path folder) : SessionShelf(std::move(folder), Limits{}) {}
SessionShelf::SessionShelf(fs::path folder, Limits limits) : folder_(std::move(folder)), limits_(limits) {}

fs::path SessionShelf::begin(const SessionNote& note) {
    end();
    core::prepareOutputFolder(folder_, true);
    const std::string time = QDateTime::currentDateTime().toString(QStringLiteral("yyyyMMdd-HHmmss-zzz")).toStdString();
    take(folder_ / (time + "-" + std::to_string(QCoreApplication::applicationPid()) + ".h5"));
    writeNote(current_, note);
    return current_;
}

void SessionShelf::goOn(const fs::path& session) {
    end();
    take(session);
}

void SessionShelf::take(const fs::path& session) {
    auto lock = std::make_unique<QLockFile>(toQString(beside(session, ".lock")));
    lock->setStaleLockTime(0);
    if (!lock->tryLock(0)) {
        if (isAlive(session)) throw core::Error("the recording's place is taken", session.string(), "start again");
        const int why = hasRoom() ? EACCES : ENOSPC;
        throw core::Error(std::strerror(why), session.string(), "make room, or check the folder's permissions")
            .as(core::writeErrorId(why), {std::strerror(why)});
    }
    current_ = session;
    lock_ = std::move(lock);
}

std::uint64_t SessionShelf::freeBytes() const {
    // A folder that is yet to be made lies where the first one above it does.
    fs::path there = folder_;
    std::error_code error;
    while (!fs::exists(there, error) && there.has_relative_path())
        there = there.parent_path();
    const fs::space_info space = fs::space(there, error);
    return error ? std::numeric_limits<std::uint64_t>::max() : space.available;
}

void SessionShelf::note(const SessionNote& note) {
    if (!current_.empty()) writeNote(current_, note);
}

void SessionShelf::end() {
    if (current_.empty()) return;
    settle(current_);
    leave();
}

void SessionShelf::leave() {
    current_.clear();
    lock_.reset();
}

std::vector<Crashed> SessionShelf::left() const {
    std::vector<Crashed> found;
    for (const fs::path& session : sessionsIn(folder_)) {
        if (session == current_) continue;
        const auto note = readNote(session);
        if (note && !isAlive(session)) found.push_back({session, *note});
    }
    return found;
}

std::vector<Crashed> SessionShelf::crashed() const {
    std::vector<Crashed> found = left();
    std::erase_if(found, [](const Crashed& one) { return !one.note.unsaved || !one.note.exam.isEmpty(); });
    return found;
}

std::vector<Crashed> SessionShelf::ofExams() const {
    std::vector<Crashed> found = left();
    std::erase_if(found, [](const Crashed& one) { return one.note.exam.isEmpty(); });
    return found;
}

void SessionShelf::settle(const fs::path& session) {
    std::error_code error;
    fs::remove(beside(session, ".json"), error);
}

std::size_t SessionShelf::tidy() {
    std::size_t kept = 0, removed = 0;
    std::uint64_t bytes = 0;
    std::error_code ignored;
    // Killed in the first instant, before anything was recorded.
    for (const auto& entry : fs::directory_iterator(folder_, ignored)) {
        const fs::path session = fs::path(entry.path()).replace_extension();
        if (entry.path().extension() != ".begun" || isAlive(session)) continue;
        fs::remove(entry.path(), ignored);
        for (const char* extension : {".json", ".lock"})
            fs::remove(beside(session, extension), ignored);
    }
    for (const fs::path& session : sessionsIn(folder_)) {
        std::error_code error;
        const std::uint64_t size = fs::file_size(session, error);
        const auto note = readNote(session);
        // A marker that says "saved" was left by a crash with nothing lost.
        const bool holds = note && (note->unsaved || !note->exam.isEmpty() || isAlive(session));
        if (!holds && (kept >= limits_.sessions || bytes + (error ? 0 : size) > limits_.bytes)) {
            fs::remove(session, error);
            if (!error) ++removed;
            for (const char* extension : {".json", ".lock"})
                fs::remove(beside(session, extension), error);
            continue;
        }
        ++kept;
        bytes += error ? 0 : size;
    }
    return removed;
}

}  // namespace handpiece::desktop
