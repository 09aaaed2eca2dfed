// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The recordings of all sittings, and which of them hold work that nobody saved.

#include <QLockFile>
#include <QString>
#include <QStringList>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "desktop/work/documents.h"

namespace handpiece::desktop {

/// What a marker beside a recording says.
struct SessionNote {
    QString caseFile;                     ///< the tooth's place
    QString title;                        ///< as shown
    QString attemptFile;                  ///< where it was saved last; may be empty
    bool unsaved = false;                 ///< something was cut that no file holds
    std::optional<Starter> starter = {};  ///< that the program makes
    int workedOn = 0;                     ///< the tooth of the case, when it is not its own
    QString exercise = {};                ///< cases::exerciseText(): what was locked stays locked
    QStringList recordings = {};          ///< of the same attempt, before this one
    QString task = {};                    ///< the exercise's file or folder; may be empty
    double beforeS = 0.0;                 ///< worked before this recording began
    qint64 began = 0;                     ///< work on it [ms since 1970]; 0: not known
    QString exam = {};                    ///< sitting of the exam that it is; empty: it is none
};

/// A recording whose program ended without a word.
struct Crashed {
    std::filesystem::path session;
    SessionNote note;
};

/// A folder of SESSION-ID.h5 with SESSION-ID.json (the marker) and SESSION-ID.lock (while its program lives).
class SessionShelf {
  public:
    struct Limits {
        std::size_t sessions = 20;
        std::uint64_t bytes = 2ull << 30;
        std::uint64_t roomBytes = 40ull << 20;  ///< that work which goes on must find free: half an hour's recording
    };
    explicit SessionShelf(std::filesystem::path folder);
    SessionShelf(std::filesystem::path folder, Limits limits);

    /// A name for the next recording, taken for this program until end(). Throws core::Error when the folder cannot be
    /// written.
    [[nodiscard]] std::filesystem::path begin(const SessionNote& note);
    /// A recording that goes on is the one under way, with its marker as it is. Throws core::Error while another
    /// program has it.
    void goOn(const std::filesystem::path& session);
    /// What is known of the recording under way has changed.
    void note(const SessionNote& note);
    /// The recording is closed, and what it holds is saved or given up.
    void end();
    /// The recording is closed, but its marker stays: whoever comes finds what it holds.
    void leave();
    /// The recording under way; empty when there is none.
    [[nodiscard]] const std::filesystem::path& current() const noexcept { return current_; }
    [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }

    /// Recordings with unsaved work whose program is gone, the newest first. Empty ones count as none, and those of an
    /// exam are not among them.
    [[nodiscard]] std::vector<Crashed> crashed() const;
    /// Recordings of exams that were not settled and that no program has under way, the newest first.
    [[nodiscard]] std::vector<Crashed> ofExams() const;
    /// Free where recordings lie, and whether that is enough to go on with one.
    [[nodiscard]] std::uint64_t freeBytes() const;
    [[nodiscard]] std::uint64_t roomBytes() const noexcept { return limits_.roomBytes; }
    [[nodiscard]] bool hasRoom() const { return freeBytes() >= limits_.roomBytes; }
    /// Its work is saved elsewhere by now, or given up: it becomes a recording like any other.
    void settle(const std::filesystem::path& session);
    /// Deletes the oldest recordings beyond the limits, never one with a marker. Returns how many.
    std::size_t tidy();

  private:
    void take(const std::filesystem::path& session);
    /// With a marker, and no program.
    [[nodiscard]] std::vector<Crashed> left() const;

    std::filesystem::path folder_;
    Limits limits_;
    std::filesystem::path current_;
    std::unique_ptr<QLockFile> lock_;
};

}  // namespace handpiece::desktop
