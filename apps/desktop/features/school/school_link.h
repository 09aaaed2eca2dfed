// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The window's side of its school: a program beside it, handpiece-school station, which alone speaks to the network.
/// docs/school-live.md

#include <QImage>
#include <QObject>
#include <QProcess>
#include <QString>
#include <QStringList>
#include <chrono>
#include <filesystem>
#include <memory>

#include "desktop/framework/job.h"

namespace handpiece::desktop {

/// handpiece-school: the one that came with this program, else the one that is found; empty: it is not installed.
[[nodiscard]] QString schoolProgram();

/// As the program beside tells it.
struct SchoolStanding {
    bool isConnected = false;
    bool isShown = false;  ///< the school has a picture of the work that goes on
    bool closely = false;  ///< somebody looks at this station alone
    int waiting = 0;       ///< things that the school has not heard of
    QStringList watchers;  ///< who looks at it, by their names
    QStringList assigned;  ///< hashes of the exercises that the school has given to do
    QString trouble;
};

/// What goes with a picture.
struct LiveFigures {
    QString exerciseHash, title;
    bool isShared = false;
    double elapsedS = 0.0, removedMm3 = 0.0;
    QStringList flags;  ///< as notices are called: "pulp-exposed", ...
};

/// Nothing here waits: what the other program does not take at once is left out.
class SchoolLink : public QObject {
    Q_OBJECT
  public:
    /// `home` has school.json once the station is enrolled; recordings lie in `sessions`.
    SchoolLink(std::filesystem::path home, std::filesystem::path sessions, QObject* parent);
    ~SchoolLink() override;

    [[nodiscard]] bool isEnrolled() const;
    /// Starts the program where the station is enrolled and it does not run. A moment of quiet is the time for it: a
    /// process is made.
    void begin();
    [[nodiscard]] const SchoolStanding& standing() const noexcept { return standing_; }
    /// Why the program does not run; empty while it does.
    [[nodiscard]] const QString& missing() const noexcept { return missing_; }
    [[nodiscard]] qint64 processId() const { return process_.processId(); }

    /// Made small and packed in a thread of its own; left out while the one before is on its way.
    void show(const QImage& picture, const LiveFigures& figures);
    void rest();
    void push();

  signals:
    void changed();

  private:
    void hear();
    void ended();
    void send(const QByteArray& bytes);

    const std::filesystem::path home_, sessions_;
    QProcess process_;
    SchoolStanding standing_;
    QString missing_;
    bool isShowing_ = false, wantsRest_ = false;
    std::unique_ptr<Job> packing_;
};

}  // namespace handpiece::desktop
