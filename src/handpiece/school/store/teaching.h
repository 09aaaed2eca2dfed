// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a school's books hold of a teacher's work: desks of markers, marks that were released, rubrics and re-scoring,
/// standards, exemplars. docs/school-teaching.md.

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/school/store/books_room.h"

namespace handpiece::school {

/// A marker's works of an assignment, as they came: their order and codes hang on the seed alone.
struct MarkingDesk {
    std::string assignment{}, marker{};
    std::uint64_t seed = 0;
    Milliseconds made = 0;
    std::vector<std::vector<std::string>> batches{};  ///< ids of attempts; gone ones stay, so that codes stay
};

/// What a marker said of a work under one code. Half of it waits as it was typed.
struct MarkingSheet {
    std::string assignment{}, marker{}, code{}, attempt{};
    std::string content{};  ///< JSON, opaque here
    bool isIn = false;      ///< given, and fixed
    Milliseconds changed = 0;
};

/// A re-scoring of an assignment.
struct Campaign {
    std::string id{}, assignment{}, rubric{}, who{};
    Milliseconds made = 0;
};
/// What was scored as work arrived.
inline constexpr const char* kArrival = "arrival";

/// An attempt with the score that counts.
struct Outcome {
    PushedAttempt pushed{};        ///< without its files and what its station says in detail
    std::optional<Score> score{};  ///< none: the server has not looked at it yet
};

/// One judge's share of borderline students [%] who would have a criterion.
struct AngoffEstimate {
    std::string judge{};
    std::int64_t round = 1;
    std::string criterion{};
    double percent = 0.0;
    friend bool operator==(const AngoffEstimate&, const AngoffEstimate&) = default;
};
struct KeptStandard {
    std::string id{}, assignment{}, method{};  ///< "angoff", "borderline"
    std::string content{};                     ///< JSON, opaque here
    std::string who{};
    Milliseconds made = 0;
};

/// A work that shows how marks are meant, with what was agreed of it.
struct Exemplar {
    std::string attempt{}, assignment{}, content{}, who{};
    Milliseconds made = 0;
};
struct Calibration {
    std::string attempt{}, marker{}, content{};
    Milliseconds made = 0;
};

class Teaching : private BooksRoom {
  public:
    explicit Teaching(Books& books) : BooksRoom(books) {}

    // Exercises, rubrics, assignments.
    [[nodiscard]] std::vector<Pack> packs() const;
    /// By id and version.
    [[nodiscard]] std::vector<RubricVersion> rubrics() const;
    /// Numbered after the last of its id. What is there already, the same, is given back; with other words under the
    /// same hash it is refused ("books-changed"): a version stays as it is.
    RubricVersion addRubric(const RubricVersion& rubric, const Act& act);
    void setTimes(const std::string& assignment, Milliseconds opens, Milliseconds closes, const Act& act);

    // Marking.
    /// The last attempt of each student that the server has looked at, by their ids; without exemplars, whose marks are
    /// known to who marks.
    [[nodiscard]] std::vector<std::string> worksOf(const std::string& assignment) const;
    [[nodiscard]] std::optional<MarkingDesk> desk(const std::string& assignment, const std::string& marker) const;
    /// Empty marker: of all.
    [[nodiscard]] std::vector<MarkingDesk> desks(const std::string& assignment, const std::string& marker = {}) const;
    /// Begins the marker's desk, or adds what came since as a batch of its own; never the marker's own work.
    MarkingDesk takeWorks(const std::string& assignment, const std::string& marker, std::uint64_t seed, const Act& act);
    /// Empty marker: of all.
    [[nodiscard]] std::vector<MarkingSheet> sheets(const std::string& assignment, const std::string& marker = {}) const;
    [[nodiscard]] std::optional<MarkingSheet> sheet(const std::string& assignment, const std::string& marker,
                                                    const std::string& code) const;
    /// With `mark` it is given in, both in one transaction. False: it is in already, and stays as it is.
    bool save(const MarkingSheet& sheet, const std::optional<Mark>& mark, const Act& act);
    [[nodiscard]] std::vector<Mark> marksOn(const std::string& assignment) const;
    /// Markers who lie further apart than this are adjudicated [% of the most points].
    static constexpr double kUsualDifference = 10.0;
    [[nodiscard]] double differenceAllowed(const std::string& assignment) const;
    void setDifferenceAllowed(const std::string& assignment, double percent, const Act& act);
    /// Students see the marks of these from now on, or no longer.
    void release(std::span<const std::string> attempts, bool released, const Act& act);
    [[nodiscard]] bool isReleased(const std::string& attempt) const;
    [[nodiscard]] std::set<std::string> released(const std::string& assignment) const;

    // Re-scoring.
    /// What counts so far goes on to count.
    void add(const Campaign& campaign, const Act& act);
    [[nodiscard]] std::vector<Campaign> campaigns(const std::string& assignment) const;
    [[nodiscard]] std::optional<Campaign> campaign(const std::string& id) const;
    /// Whose scores count; empty: the last ones.
    [[nodiscard]] std::string counting(const std::string& assignment) const;
    /// From now on, and later work is scored by its rubric.
    void setCounting(const std::string& assignment, const std::string& campaign, const Act& act);
    /// Of each attempt the one of this campaign; empty: the one that counts.
    [[nodiscard]] std::vector<Score> scores(const std::string& assignment, const std::string& campaign = {}) const;
    /// Of a class, by person and when they were finished. `withResults`: with the scores' whole results.
    [[nodiscard]] std::vector<Outcome> outcomes(const std::string& schoolClass, bool withResults) const;
    /// Of a person.
    [[nodiscard]] std::vector<Outcome> outcomesOf(const std::string& person, bool withResults) const;

    // Standards.
    /// In the place of what the judge said in that round.
    void setEstimates(const std::string& assignment, std::span<const AngoffEstimate> estimates, const Act& act);
    [[nodiscard]] std::vector<AngoffEstimate> estimates(const std::string& assignment) const;
    void add(const KeptStandard& standard, const Act& act);
    [[nodiscard]] std::vector<KeptStandard> standards(const std::string& assignment) const;

    // Exemplars.
    void set(const Exemplar& exemplar, const Act& act);
    void removeExemplar(const std::string& attempt, const Act& act);
    [[nodiscard]] std::vector<Exemplar> exemplars(const std::string& assignment) const;
    /// The first of a marker is the one that counts. False: there is one.
    bool add(const Calibration& calibration, const Act& act);
    [[nodiscard]] std::vector<Calibration> calibrations(const std::string& assignment) const;

  private:
    [[nodiscard]] std::vector<Outcome> outcomesWhere(const char* condition, const std::string& value,
                                                     bool withResults) const;
    void requireAssignment(const std::string& id) const;
    /// In a transaction that writes: what counts is written down, unless it is.
    void pin(const std::string& assignment, const Act& act);
};

}  // namespace handpiece::school
