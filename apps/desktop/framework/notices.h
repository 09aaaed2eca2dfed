// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the window tells beside the work: a row each with its words, how grave it is, and what takes it back.

#include <QHash>
#include <QObject>
#include <QString>
#include <QStringList>
#include <QTimer>
#include <optional>

namespace handpiece::desktop {

class NoticeBar;

enum class Notice {
    recordingStopped,
    pulpExposed,
    forceLimited,
    stalled,
    deviceFault,
    deviceLost,
    schoolSettings,
    deviceAbsent,
    pedalAbsent,
    pedalLost,
    deviceTrouble,
    outOfBricks,
    recordingIncomplete,
    samplesLost,
    nothingToUndo,
    nothingToRedo,
    nothingToReset,
    notWhileCutting,
    hullOnlyTouches,
    refused,
    neighbourTouched,
    neighbourCut,
    gingivaCut,
    headTouched,
    firstDentine,
    hullNeedsWholeTooth,
    settingsBroken,
    crashed,
    crashedNoRoom,
    onlyTouch,
    codeLater,
    burMissing,
    burLocked,
    helpLocked,
    examRuns,
    handedIn,
    handedInPart,
    otherEngine,
    caseVanished,
    fileLeftOut,
    cacheRenewed,
    cacheNotKept,
    saved,
    timeUp,
    timeOver,
    translationMissing,
    openGlMissing

};
/// What takes notices back; a hint goes by itself as well.
enum class End : unsigned {
    toothOpened = 1,  ///< another one
    pulpHealed = 2,   ///< by an undo or a reset
    toothWhole = 4,
    deviceOpened = 8,
    deviceLetGo = 16,
    troubleOver = 32,
    pedalThere = 64,
    crashSettled = 128,
    recorded = 256,  ///< again
};

/// Its name for scripts and for what a library tells: "device-lost".
[[nodiscard]] QString idOf(Notice notice);
[[nodiscard]] std::optional<Notice> noticeOf(const QString& id);
[[nodiscard]] QStringList noticeIds();
/// In the person's language.
[[nodiscard]] QString noticeText(Notice notice, const QStringList& arguments = {});

/// Tells them in a bar.
class Notices : public QObject {
    Q_OBJECT
  public:
    explicit Notices(NoticeBar* bar);

    /// How long a hint stays.
    int hintMs = 6000;

    void tell(Notice notice, const QStringList& arguments = {});
    void remove(Notice notice);
    void takeBack(End what);
    /// Nothing is told but this.
    [[nodiscard]] bool isFreeFor(Notice notice) const;

  signals:
    /// The notice's own button was pressed.
    void remedyChosen(handpiece::desktop::Notice notice);

  private:
    NoticeBar* bar_;
    QHash<Notice, QTimer*> hints_;  ///< when it goes
};

}  // namespace handpiece::desktop
