// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A station's side of exams, in a folder that no student's account can read or write: the packs, the station's key,
/// the chain of what happened, and sessions that were handed over. No network and no clock of its own.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/school/exam/chain.h"
#include "handpiece/school/people/throttle.h"

namespace handpiece::exam {

/// How this station belongs to a school. The server's key is pinned here at enrolment.
struct StationIdentity {
    std::string server{}, station{}, key{}, serverKey{};
};
/// Throw core::Error "not-enrolled" and "exam-damaged".
[[nodiscard]] StationIdentity stationIn(const std::filesystem::path& folder);
void keepStation(const StationIdentity& identity, const std::filesystem::path& folder);

/// Checks signature and content, and that the exercise is the one that is named, and keeps both: whole or not at all.
/// An older version than the one that is there is refused ("exam-older"). Throws as openedPack();
/// "exam-exercise-other". `exercise`: a file that is moved away; empty: it is there already.
Pack installPack(const std::filesystem::path& folder, const Signed& pack, const std::filesystem::path& exercise);
struct Installed {
    Pack pack;
    Signed text;
    std::filesystem::path exercise;  ///< where it is, or will be once it is opened
    bool isSealed = false;
};
/// Those that hold; the others' reasons go into `problems`.
[[nodiscard]] std::vector<Installed> packsIn(const std::filesystem::path& folder, std::vector<std::string>& problems);
/// Sealed or not.
[[nodiscard]] bool hasExercise(const std::filesystem::path& folder, const Pack& pack);

/// Opens the exercise of a pack that is here. Throws core::Error "exam-seal".
void openExercise(const std::filesystem::path& folder, const Pack& pack, const std::string& typedCode);

/// Somebody at an exam, or who was.
struct Sitting {
    std::string id{};
    Installed exam{};
    Candidate candidate{};
    Milliseconds began = 0, deadline = 0;
    std::int64_t again = 0;
};

/// One service a folder: another one is refused. One thread.
class Invigilation {
  public:
    /// Reads and checks the chain, and adds that the service started. Throws core::Error: "exam-chain" where what is
    /// there is not what this station wrote; "exam-busy": another service works here.
    Invigilation(std::filesystem::path folder, Milliseconds now);
    Invigilation(const Invigilation&) = delete;
    Invigilation& operator=(const Invigilation&) = delete;

    [[nodiscard]] const StationIdentity& identity() const { return identity_; }
    /// Who is at work just now, also after the service was started again.
    [[nodiscard]] const std::optional<Sitting>& sitting() const { return sitting_; }

    /// What would be begun by this code, for the invigilator to look at: with no id. The code says which exam.
    /// `rubricFormat`: what this program knows. Throws core::Error: "exam-running", "exam-candidate-unknown",
    /// "exam-early", "exam-expired", "exam-sealed" (before it was opened), and requireFitting()'s.
    [[nodiscard]] Sitting look(const std::string& candidateCode, std::int64_t rubricFormat, Milliseconds now) const;
    /// Throws as look(), and "exam-invigilator" (not known, or another confirmation code), "exam-confirmation-used",
    /// "exam-wait" (too many wrong ones).
    /// `from`: wrong codes of others than these make them wait no longer.
    const Sitting& begin(const std::string& candidateCode, const std::string& invigilator, const std::string& code,
                         std::int64_t rubricFormat, Milliseconds now, const std::string& from = {});
    /// Throw core::Error "exam-none" where nobody is at work, or `id` is another sitting.
    void checkpoint(const std::string& id, std::int64_t part, std::int64_t ticks, const std::string& inputs,
                    Milliseconds now);
    /// Where a recording is put by who hands it over.
    [[nodiscard]] std::filesystem::path placeFor(const std::string& id, std::int64_t part) const;
    /// With the recordings that lie in their places; `works`: their assessment::workHash(). Returns the entry.
    Signed finish(const std::string& id, const std::vector<std::string>& works, Milliseconds now);
    /// Without work: an invigilator says so.
    void giveUp(const std::string& id, const std::string& invigilator, const std::string& code, Milliseconds now,
                const std::string& from = {});

    /// The exam that an opening code is of, by an invigilator. Throws core::Error "exam-seal", "exam-wait".
    void open(const std::string& typedCode, Milliseconds now, const std::string& from = {});

    [[nodiscard]] ChainEnd end() const { return end_; }
    /// What follows `number`, `most` at once.
    [[nodiscard]] std::vector<Signed> entriesAfter(std::int64_t number, std::size_t most) const;
    /// The entry that ended this sitting. Throws core::Error "exam-none" where none did.
    [[nodiscard]] Signed endOf(const std::string& sitting) const;
    /// A recording that was handed over, by its SHA-256; empty: it is not here.
    [[nodiscard]] std::filesystem::path fileOf(const std::string& sitting, const std::string& sha256) const;

  private:
    Signed add(Entry entry);
    void follow(const Entry& entry);
    /// Returns what the entry says of it.
    std::string requireInvigilator(const Pack& pack, const Candidate& candidate, const std::string& person,
                                   const std::string& code, Milliseconds now, const std::string& from);
    void requirePatience(const std::string& who, Milliseconds now);
    const Sitting& current(const std::string& id) const;

    const std::filesystem::path folder_;
    StationIdentity identity_;
    SigningKey key_;
    ChainEnd end_{};
    std::optional<Sitting> sitting_;
    std::vector<std::pair<std::string, std::string>> begun_;  ///< exam and candidate, each time
    std::set<std::pair<std::string, std::string>> spent_;     ///< candidate and confirmation
    school::Throttle guesses_;
};

}  // namespace handpiece::exam
