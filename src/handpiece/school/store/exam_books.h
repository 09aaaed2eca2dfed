// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the books know of exams: who may sit them and how, packs that were signed, what stations' chains say, and what
/// people decided of it. Signatures are checked by who calls (school/exam). docs/school-exams.md.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/school/store/books_room.h"

namespace handpiece::school {

/// Of an assignment of kind "exam".
struct ExamSettings {
    std::string exam{};
    std::int64_t minutes = 0;
    std::string locked{};  ///< helps, separated by a space
};
struct ExamCandidate {
    std::string exam{}, person{};
    std::string code{};  ///< hash of what is typed at the station
    std::int64_t extraPercent = 0, pauseMinutes = 0;
    std::string helps{};  ///< separated by a space
};
struct ExamInvigilator {
    std::string exam{}, person{}, pin{};  ///< a hash
};
/// That an invigilator was there when a candidate began: a code on paper, each good once.
struct ExamConfirmation {
    std::string exam{}, person{};
    std::int64_t number = 0;  ///< from 1; those of before stay
    std::string hash{};       ///< hashOfPassword()
};
struct ExamPack {
    std::string exam{};
    std::int64_t version = 0;
    std::string hash{}, text{}, key{}, signature{};  ///< SHA-256 of the text; by whose key
    Milliseconds made = 0;
};
/// One of a station's chain, as it came.
struct ExamEntry {
    std::string station{};
    std::int64_t number = 0;
    std::string hash{}, kind{}, sitting{}, text{}, key{}, signature{};
    Milliseconds at = 0, received = 0;
};
struct ExamSitting {
    std::string id{}, exam{}, station{}, person{}, candidate{}, pack{}, invigilator{};
    Milliseconds began = 0;
    std::int64_t number = 0;  ///< of the entry that began it
    std::string state{};      ///< "begun", "given-up", "finished"
    Milliseconds ended = 0;
    /// Number of the code that confirmed its beginning; negative: one that had been used. 0: of a pack of before.
    std::int64_t confirmation = 0;
};
/// Of a sitting, in their order; none is ever changed.
struct ExamDecision {
    std::string id{}, sitting{}, person{};
    std::string kind{};     ///< "confirm", "appeal", "remark" (blind), "decide" (of an appeal)
    std::string verdict{};  ///< "pass", "fail", "void"; of an appeal empty
    double points = 0.0, maxPoints = 0.0;
    std::string words{};
    Milliseconds made = 0;
};

/// All members throw core::Error as Books'.
class ExamBooks : public BooksRoom {
  public:
    explicit ExamBooks(Books& books) : BooksRoom(books), books_(books) {}

    /// Once a station; another key is refused ("books-changed"): it would be another station.
    void addKey(const std::string& station, const std::string& key, Milliseconds now);
    [[nodiscard]] std::string keyOf(const std::string& station) const;

    void set(const ExamSettings& settings, const Act& act);
    [[nodiscard]] std::optional<ExamSettings> settings(const std::string& exam) const;
    /// Again: with the code and the accommodations of now.
    void set(const ExamCandidate& candidate, const Act& act);
    void set(const ExamInvigilator& invigilator, const Act& act);
    [[nodiscard]] std::vector<ExamCandidate> candidates(const std::string& exam) const;
    [[nodiscard]] std::vector<ExamInvigilator> invigilators(const std::string& exam) const;
    /// The next of this person's, after those that are there.
    void add(const ExamConfirmation& confirmation, const Act& act);
    [[nodiscard]] std::vector<ExamConfirmation> confirmations(const std::string& exam) const;
    /// What opens its exercise; `fresh` becomes it where there is none yet.
    [[nodiscard]] std::string openingCode(const std::string& exam, const std::string& fresh, const Act& act);
    [[nodiscard]] std::optional<std::string> openingCode(const std::string& exam) const;
    /// Whose it is or was: a code that was replaced stands in packs that are out.
    [[nodiscard]] std::optional<std::string> personOfCode(const std::string& exam, const std::string& code) const;

    /// The next version. Returns false where it is there already.
    bool add(const ExamPack& pack, const Act& act);
    [[nodiscard]] std::optional<ExamPack> newestPack(const std::string& exam) const;
    [[nodiscard]] std::optional<ExamPack> packByHash(const std::string& hash) const;
    /// Exams that can still be begun, or whose work may still come, with a pack.
    [[nodiscard]] std::vector<std::string> examsOpenAt(Milliseconds now) const;

    struct End {
        std::int64_t number = 0;
        std::string hash{};  ///< empty: there is none yet
    };
    [[nodiscard]] End endOf(const std::string& station) const;
    /// The next of its station's chain, checked by the caller. `begins`: the sitting that it begins; its end is told by
    /// `entry.kind`. `attempt`: what was handed over. False: it is there already, the same. Throws "books-changed"
    /// where another one has its number, "books-unknown" for a gap.
    bool add(const ExamEntry& entry, const ExamSitting* begins, const PushedAttempt* attempt);
    /// From its beginning to its end with all that its station noted in between.
    [[nodiscard]] std::vector<ExamEntry> entriesOf(const std::string& sitting) const;
    [[nodiscard]] std::optional<ExamSitting> sitting(const std::string& id) const;
    [[nodiscard]] std::vector<ExamSitting> sittingsOf(const std::string& exam) const;

    /// What a look at the sessions found; the newest counts.
    void setDoubts(const std::string& sitting, const std::vector<std::string>& doubts, Milliseconds now);
    [[nodiscard]] std::vector<std::string> doubtsOf(const std::string& sitting) const;

    /// Throws "books-invalid" for what cannot be decided in this state: an appeal before there is a decision, a
    /// decision on an appeal without one, a remark by who decided before.
    void add(const ExamDecision& decision, const Act& act);
    [[nodiscard]] std::vector<ExamDecision> decisionsOf(const std::string& sitting) const;

  private:
    void follow(const ExamEntry& entry, const ExamSitting* begins);
    Books& books_;
};

inline constexpr const char* kUnconfirmed = "to be confirmed";
/// The verdict that holds: the last confirmation or decision; kUnconfirmed where there is none, or an appeal is
/// open.
[[nodiscard]] std::string verdictOf(const std::vector<ExamDecision>& decisions);
[[nodiscard]] bool hasOpenAppeal(const std::vector<ExamDecision>& decisions);

}  // namespace handpiece::school
