// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/notices.h"

#include <QCoreApplication>
#include <algorithm>
#include <iterator>

#include "desktop/widgets/notice_bar.h"

namespace handpiece::desktop {
namespace {

using Kind = NoticeBar::Kind;

constexpr unsigned operator|(End a, End b) {
    return static_cast<unsigned>(a) | static_cast<unsigned>(b);
}
constexpr unsigned operator|(unsigned a, End b) {
    return a | static_cast<unsigned>(b);
}

constexpr unsigned only(End a) {
    return static_cast<unsigned>(a);
}

struct Row {
    Notice notice;
    const char* id;
    Kind kind;
    const char* words;
    unsigned ends = 0;             ///< of End
    const char* remedy = nullptr;  ///< on its button
    const char* later = nullptr;   ///< on a second button
};
// In the order of Notice.
constexpr Row kRows[] = {
    {Notice::recordingStopped, "recording-stopped", Kind::error,
     QT_TRANSLATE_NOOP("Notices", "This session is not being recorded: %1"), only(End::recorded)},
    {Notice::pulpExposed, "pulp-exposed", Kind::error, QT_TRANSLATE_NOOP("Notices", "The pulp is exposed."),
     End::toothOpened | End::pulpHealed},
    {Notice::forceLimited, "force-limited", Kind::hint,
     QT_TRANSLATE_NOOP("Notices", "The device gives all the force it has.")},
    {Notice::stalled, "stalled", Kind::hint, QT_TRANSLATE_NOOP("Notices", "The bur has stalled: press less.")},
    {Notice::deviceFault, "device-fault", Kind::error, QT_TRANSLATE_NOOP("Notices", "The device reports a fault.")},
    {Notice::deviceLost, "device-lost", Kind::error,
     QT_TRANSLATE_NOOP("Notices", "%1 %2 The mouse holds the handpiece now; nothing that was cut is lost."),
     End::deviceOpened | End::deviceLetGo, QT_TRANSLATE_NOOP("Notices", "Reconnect")},
    {Notice::schoolSettings, "school-settings", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "The school's settings have a mistake. Technical detail: %1")},
    {Notice::deviceAbsent, "device-absent", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "%1 %2 The mouse holds the handpiece."), End::deviceOpened | End::deviceLetGo,
     QT_TRANSLATE_NOOP("Notices", "Try again")},
    {Notice::pedalAbsent, "pedal-absent", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "%1 %2 The button alone is the pedal."), only(End::pedalThere)},
    {Notice::pedalLost, "pedal-lost", Kind::warning,
     QT_TRANSLATE_NOOP("Notices",
                       "The foot pedal %1 was unplugged: it is up. Plugged in again, it counts once it has been up."),
     only(End::pedalThere)},
    {Notice::deviceTrouble, "device-trouble", Kind::error,
     QT_TRANSLATE_NOOP("Notices", "The device gives no force. %1 %2"), End::troubleOver | End::deviceLetGo},
    {Notice::outOfBricks, "out-of-bricks", Kind::error,
     QT_TRANSLATE_NOOP("Notices", "There is no memory left to cut more of this tooth."),
     End::toothOpened | End::toothWhole},
    {Notice::recordingIncomplete, "recording-incomplete", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "The recording has a gap: ticks that are missing: %1"), only(End::toothOpened)},
    {Notice::samplesLost, "samples-lost", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "The computer is too busy. Samples lost: %1"), only(End::toothOpened)},
    {Notice::nothingToUndo, "nothing-to-undo", Kind::hint, QT_TRANSLATE_NOOP("Notices", "There is nothing to undo.")},
    {Notice::nothingToRedo, "nothing-to-redo", Kind::hint, QT_TRANSLATE_NOOP("Notices", "There is nothing to redo.")},
    {Notice::nothingToReset, "nothing-to-reset", Kind::hint, QT_TRANSLATE_NOOP("Notices", "Nothing was cut yet.")},
    {Notice::notWhileCutting, "not-while-cutting", Kind::hint,
     QT_TRANSLATE_NOOP("Notices", "Not while you cut: lift the bur first.")},
    {Notice::hullOnlyTouches, "hull-only-touches", Kind::hint,
     QT_TRANSLATE_NOOP("Notices", "With the convex hull the bur touches and does not cut.")},
    {Notice::refused, "refused", Kind::warning, QT_TRANSLATE_NOOP("Notices", "This could not be done: %1")},
    {Notice::neighbourTouched, "neighbour-touched", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "The adjacent tooth was touched."), End::toothOpened | End::toothWhole},
    {Notice::neighbourCut, "neighbour-cut", Kind::warning, QT_TRANSLATE_NOOP("Notices", "The adjacent tooth was cut."),
     End::toothOpened | End::toothWhole},
    {Notice::gingivaCut, "gingiva-cut", Kind::warning, QT_TRANSLATE_NOOP("Notices", "The bur is in the gingiva."),
     End::toothOpened | End::toothWhole},
    {Notice::headTouched, "head-touched", Kind::hint,
     QT_TRANSLATE_NOOP("Notices", "The handpiece rests on a tooth: the bur is held off.")},
    {Notice::firstDentine, "first-dentine", Kind::hint, QT_TRANSLATE_NOOP("Notices", "The bur has reached dentine.")},
    {Notice::hullNeedsWholeTooth, "hull-needs-whole-tooth", Kind::warning,
     QT_TRANSLATE_NOOP("Notices",
                       "The convex hull knows the whole tooth only, and this one is cut. Reset the tooth first."),
     End::toothOpened | End::toothWhole},
    {Notice::settingsBroken, "settings-broken", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "The settings could not be read and start anew. The old file is kept at %1")},
    {Notice::crashed, "crashed", Kind::warning,
     QT_TRANSLATE_NOOP("Notices",
                       "The last session ended without saving. What was cut of \"%1\" can be brought back, now or "
                       "later with File, Recover."),
     only(End::crashSettled), QT_TRANSLATE_NOOP("Notices", "Bring it back"), QT_TRANSLATE_NOOP("Notices", "Not now")},
    {Notice::crashedNoRoom, "crashed-no-room", Kind::warning,
     QT_TRANSLATE_NOOP("Notices",
                       "The last session ended without saving, and the disk is full: \"%1\" can be brought back once "
                       "%2 MB are free where %3 is (now %4 MB). Nothing is lost. Make room, then try again."),
     only(End::crashSettled), QT_TRANSLATE_NOOP("Notices", "Try again"), QT_TRANSLATE_NOOP("Notices", "Not now")},
    {Notice::onlyTouch, "only-touch", Kind::hint,
     QT_TRANSLATE_NOOP("Notices", "The tooth can be touched now, and cut once it is prepared (%1 % done).")},
    {Notice::codeLater, "code-later", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "Your code goes into what you save from now on. This recording began without it.")},
    {Notice::burMissing, "bur-missing", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "The bur it was cut with, %1, is not at hand: %2 is in its place.")},
    {Notice::burLocked, "bur-locked", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "This exercise does not allow the bur %1.")},
    {Notice::helpLocked, "help-locked", Kind::hint, QT_TRANSLATE_NOOP("Notices", "Not in this exercise: %1.")},
    {Notice::examRuns, "exam-runs", Kind::hint,
     QT_TRANSLATE_NOOP("Notices", "An exam runs: no other work can be opened or kept until it is handed over.")},
    {Notice::handedIn, "handed-in", Kind::hint,
     QT_TRANSLATE_NOOP("Notices", "Handed in: %1, with its tooth. Recordings in it: %2 (%3 MB).")},
    {Notice::handedInPart, "handed-in-part", Kind::warning,
     QT_TRANSLATE_NOOP("Notices",
                       "Handed in: %1, with its tooth. Recordings in it: %2 (%3 MB). Recordings that are no longer "
                       "there, or too large together, and not in it: %4.")},
    {Notice::otherEngine, "other-engine", Kind::warning,
     QT_TRANSLATE_NOOP(
         "Notices", "Recorded by engine revision %1; this program's is %2. What you see is cut again approximately."),
     only(End::toothOpened)},
    {Notice::caseVanished, "case-vanished", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "The tooth you opened is no longer at %1. It was saved together with the attempt."),
     0, QT_TRANSLATE_NOOP("Notices", "Save as...")},
    {Notice::fileLeftOut, "file-left-out", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "Not all of %1 was taken as it is. Technical detail: %2")},
    {Notice::cacheRenewed, "cache-renewed", Kind::hint,
     QT_TRANSLATE_NOOP("Notices", "What was kept at %1 could not be used: it is made anew.")},
    {Notice::cacheNotKept, "cache-not-kept", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "The tooth cannot be kept in %1: the next start makes it again. %2")},
    {Notice::saved, "saved", Kind::hint, QT_TRANSLATE_NOOP("Notices", "Saved: %1")},
    {Notice::timeUp, "time-up", Kind::warning,
     QT_TRANSLATE_NOOP("Notices",
                       "The %1 minutes of this exercise are over. You can go on; the result says by how "
                       "much."),
     only(End::toothOpened)},
    {Notice::timeOver, "time-over", Kind::warning,
     QT_TRANSLATE_NOOP("Notices",
                       "The %1 minutes of this exercise are over: the pedal is dead. Finish to see the result."),
     only(End::toothOpened)},
    {Notice::translationMissing, "translation-missing", Kind::warning,
     QT_TRANSLATE_NOOP("Notices", "There is no translation into this language: the window speaks English.")},
    {Notice::openGlMissing, "opengl-missing", Kind::error,
     QT_TRANSLATE_NOOP("Notices", "There is no picture. Everything else goes on. Technical detail: %1")},
};
constexpr bool inOrder() {
    for (std::size_t i = 0; i < std::size(kRows); ++i)
        if (kRows[i].notice != static_cast<Notice>(i)) return false;
    return std::size(kRows) == static_cast<std::size_t>(Notice::openGlMissing) + 1;
}
static_assert(inOrder(), "one row a notice, in their order");

const Row& rowOf(Notice notice) {
    return kRows[static_cast<std::size_t>(notice)];
}

QString words(const char* source) {
    return source ? QCoreApplication::translate("Notices", source) : QString();
}

}  // namespace

QString idOf(Notice notice) {
    return QLatin1String(rowOf(notice).id);
}

std::optional<Notice> noticeOf(const QString& id) {
    for (const Row& row : kRows)
        if (id == QLatin1String(row.id)) return row.notice;
    return std::nullopt;
}

QStringList noticeIds() {
    QStringList ids;
    for (const Row& row : kRows)
        ids << QLatin1String(row.id);
    return ids;
}

QString noticeText(Notice notice, const QStringList& arguments) {
    const QString text = words(rowOf(notice).words);
    const auto a = [&](int k) { return arguments.value(k); };
    // All at once: an argument may hold a sign of percent itself.
    if (text.contains(QLatin1String("%4"))) return text.arg(a(0), a(1), a(2), a(3));
    if (text.contains(QLatin1String("%3"))) return text.arg(a(0), a(1), a(2));
    if (text.contains(QLatin1String("%2"))) return text.arg(a(0), a(1));
    return text.contains(QLatin1String("%1")) ? text.arg(a(0)) : text;
}

Notices::Notices(NoticeBar* bar) : QObject(bar), bar_(bar) {
    connect(bar, &NoticeBar::remedyChosen, this, [this](const QString& id) {
        if (const auto notice = noticeOf(id)) emit remedyChosen(*notice);
    });
}

void Notices::tell(Notice notice, const QStringList& arguments) {
    const Row& row = rowOf(notice);
    if (notice == Notice::neighbourCut) remove(Notice::neighbourTouched);  // that it was touched as well is no news
    bar_->add({idOf(notice), row.kind, noticeText(notice, arguments), words(row.remedy), words(row.later)});
    if (row.kind != Kind::hint) return;
    // A hint goes by itself: what was refused or saved a while ago is no news.
    QTimer*& timer = hints_[notice];
    if (timer == nullptr) {
        timer = new QTimer(this);
        timer->setSingleShot(true);
        connect(timer, &QTimer::timeout, this, [this, notice] { remove(notice); });
    }
    timer->start(hintMs);
}

void Notices::remove(Notice notice) {
    bar_->remove(idOf(notice));
}

void Notices::takeBack(End what) {
    for (const Row& row : kRows)
        if ((row.ends & static_cast<unsigned>(what)) != 0) remove(row.notice);
}

bool Notices::isFreeFor(Notice notice) const {
    const QString shown = bar_->current();
    return shown.isEmpty() || shown == idOf(notice);
}

}  // namespace handpiece::desktop
