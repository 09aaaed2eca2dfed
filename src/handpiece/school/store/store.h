// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a person has done, in one file of their own: exercises, attempts with their results, judgements, comments, and
/// what a school has yet to hear of it. docs/formats/store.md.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/base/core/vec.h"

namespace handpiece::school {

/// Since 1970, UTC. The store has no clock of its own.
using Milliseconds = std::int64_t;

/// 32 hexadecimal digits out of the system's randomness: what is made on two computers never gets one id.
[[nodiscard]] std::string newId();

struct Exercise {
    std::string id;            ///< its own, of exercise.toml
    std::int64_t version = 1;  ///< its own
    std::string hash;          ///< 16 hexadecimal digits
    std::string title;         ///< as shown when it was seen last
    Milliseconds firstSeen = 0, lastSeen = 0;
    std::string place{};  ///< its folder or file when it was seen last, which may be gone by now; empty: as before
};

/// One piece of work that was finished and scored; never changed afterwards.
struct Attempt {
    std::string id;  ///< newId()
    std::string exercise, exerciseHash, rubricHash;
    std::vector<std::string> sessionHashes;  ///< the chain, in order
    std::vector<std::string> recordings;     ///< names of their files, in the same order; they may be gone by now
    Milliseconds began = 0, finished = 0;
    std::string device;
    double motionScale = 1.0;
    double score = 0.0, maxScore = 0.0;  ///< of what could be measured
    double wholeScore = 0.0;             ///< the most of all that is graded; 0: not known
    std::string passed;                  ///< "yes", "no", "teacher"
    bool borderline = false, proven = false;
    std::string result;                  ///< the JSON of the result, whole
    double workedS = 0.0, limitS = 0.0;  ///< without pauses, and what the exercise gives; 0: not known, none

    /// Only such attempts say how good one is: of others a part is missing.
    [[nodiscard]] bool isWhole() const { return wholeScore <= maxScore + 1e-9; }
    /// By how much its exercise's time was passed.
    [[nodiscard]] double lateS() const { return limitS > 0.0 && workedS > limitS ? workedS - limitS : 0.0; }
    [[nodiscard]] double percent() const { return maxScore > 0.0 ? 100.0 * score / maxScore : 0.0; }
};

/// A criterion that was lost, to be shown once more without helps when it is due.
struct Retest {
    std::string exercise, criterion;  ///< its id in the rubric
    std::string attempt;              ///< that lost it, or showed it last
    int step = 0;                     ///< how often it was shown since it was lost
    Milliseconds due = 0;
};

/// What a person thinks of their own work, before they see the result.
struct Judgement {
    std::string attempt;
    double percent = 0.0;  ///< that they expect, 0 to 100
    std::string words;     ///< may be empty
    Milliseconds made = 0;
};

/// Pinned to a place on the tooth and to a time of the recording, where it has them.
struct Comment {
    std::string id;  ///< newId()
    std::string attempt, author, words;
    std::optional<core::Vec3> placeMm;  ///< in the tooth's frame
    std::optional<double> timeS;
    Milliseconds made = 0;
};

/// What a teacher gave back of an attempt, as the file holds it.
struct Returned {
    std::string attempt, marker;
    std::string marks;  ///< docs/formats/returned.md
    Milliseconds made = 0;
};

/// One thing that a school has yet to hear of. Nothing in the outbox is changed or taken out.
struct Outgoing {
    std::int64_t sequence = 0;  ///< grows
    std::string kind;           ///< "attempt", "judgement", "comment", "returned"
    std::string id;             ///< of it; of a judgement and of what was returned its attempt's
    Milliseconds made = 0;
};

/// Survives kill -9, a full disk and a second program; on a network's home folder as well (a rollback journal, no
/// shared memory). One thread each.
///
/// All members throw core::Error: "store-newer" (its version, ours), "store-locked", "store-damaged" (why), "no-space",
/// "not-writable". What was stored before then still stands.
class Store {
  public:
    /// Made where there is none, with its folder; brought to the version of now where it is older. Where the disk is
    /// read-only it can be read. `patience`: how long it waits for another program that writes.
    explicit Store(const std::filesystem::path& file, std::chrono::milliseconds patience = std::chrono::seconds(5));
    ~Store();
    Store(const Store&) = delete;
    Store& operator=(const Store&) = delete;

    /// That the schema of now has.
    static constexpr int kVersion = 4;

    /// Notes that it was there; `firstSeen` of before stays.
    void see(const Exercise& exercise);
    /// By their ids.
    [[nodiscard]] std::vector<Exercise> exercises() const;

    void add(const Attempt& attempt);
    /// And all retests of its exercise, in the place of those that it had: both or neither.
    void add(const Attempt& attempt, const std::vector<Retest>& retests);
    /// By when they are due; empty `exercise`: all.
    [[nodiscard]] std::vector<Retest> retests(const std::string& exercise = {}) const;
    /// Of an attempt that is there, once.
    void add(const Judgement& judgement);
    /// In the order in which they were finished; empty `exercise`: all.
    [[nodiscard]] std::vector<Attempt> attempts(const std::string& exercise = {}) const;
    [[nodiscard]] std::optional<Attempt> attempt(const std::string& id) const;
    [[nodiscard]] std::optional<Judgement> judgementOf(const std::string& attempt) const;

    void add(const Comment& comment);
    [[nodiscard]] std::vector<Comment> commentsOn(const std::string& attempt) const;

    /// Of an attempt that is there, in the place of what the same marker gave back of it before.
    void add(const Returned& returned);
    /// In the order in which they came.
    [[nodiscard]] std::vector<Returned> returnedOf(const std::string& attempt) const;

    /// What follows `sequence`, in its order, `most` at once.
    [[nodiscard]] std::vector<Outgoing> outbox(std::int64_t sequence, std::size_t most = 100) const;

  private:
    void insert(const Attempt& attempt);
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::school
