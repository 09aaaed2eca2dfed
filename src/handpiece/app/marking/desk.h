// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A marker's desk: returned work, the marker's own marks, overrides with their reasons, comments; the machine's score
/// beside, and hidden from who marks blind. docs/marking.md.

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/app/marking/returned_work.h"
#include "handpiece/app/marking/scoring.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/assess/score/score.h"

namespace handpiece::marking {

/// A marker's own judgement of one criterion, before anything of the machine's is seen.
struct Mark {
    std::string band;              ///< of a criterion that has bands
    std::optional<double> points;  ///< of one without, and of the total
    bool cannotTell = false;       ///< looked at, and not to be judged
    friend bool operator==(const Mark&, const Mark&) = default;
};

/// What the marker says in the machine's place.
struct Override {
    std::string band;              ///< empty: as it was
    std::optional<double> points;  ///< 0 to the criterion's weight; none: those of the band
    std::optional<bool> critical;  ///< none: as it was
    std::string reason;            ///< never blank
    friend bool operator==(const Override&, const Override&) = default;
};

/// Pinned to a criterion, a place, a time, or to none of them.
struct Comment {
    int number = 0;  ///< given by the desk
    std::string criterion, text;
    std::optional<core::Vec3> placeMm;  ///< tooth frame
    std::optional<double> timeS;
    std::optional<std::size_t> session{};  ///< of a chain, that `timeS` is of; none: the last
};

/// Who passes, where the marker decides.
struct Decision {
    bool passed = false;
    std::string reason;  ///< never blank
    friend bool operator==(const Decision&, const Decision&) = default;
};

/// Of one work under one code.
struct Sheet {
    std::map<std::string, Mark> marks;  ///< by criterion, and kTotal
    bool isIn = false;                  ///< given, and fixed
    std::map<std::string, Override> overrides;
    std::vector<Comment> comments;
    std::optional<Decision> decision;
};

/// In place of a criterion's id: of all points together.
inline constexpr const char* kTotal = "total";

/// Criteria that ask for a mark, in the rubric's order; kTotal last, where points are given.
[[nodiscard]] std::vector<std::string> askedOf(const rubric::Rubric& rubric);
/// The most points of one of them.
[[nodiscard]] double mostOf(const rubric::Rubric& rubric, const std::string& id);
/// Throws core::Error, naming `where`: a criterion or band that is not there, points beyond the weight, both or neither
/// of band and points where the criterion asks for one.
void requireMark(const rubric::Rubric& rubric, const std::string& id, const Mark& mark, const std::string& where);

struct DeskSetup {
    std::filesystem::path folder;  ///< of the returned work; the desk's file lies in it
    std::string marker;            ///< name or code
    std::string exercise, exerciseHash;
    rubric::Rubric rubric;
    bool isBlind = false;
    std::optional<std::uint64_t> seed;  ///< of a new desk; none: a random one
};

/// All that a desk's file holds (docs/marking.md#the-file).
struct DeskState {
    std::string marker, exercise, exerciseHash, rubric, rubricHash;
    bool isBlind = false;
    std::uint64_t seed = 0;
    std::vector<std::vector<std::string>> batches;  ///< ids of works, as they came
    std::map<std::string, std::string> names;       ///< of works, by id
    std::map<std::string, Sheet> sheets;            ///< by code
    int nextComment = 1;
};

/// A work on the desk, under its code.
struct DeskItem {
    std::string code, workId;
    bool isRepeat = false;  ///< the work is there under another code, further up
};
/// In the order in which they are marked: a pure function of seed and batches. Blind: a random permutation of the works
/// and of a tenth of each batch again (of the first at least one); else as they came.
[[nodiscard]] std::vector<DeskItem> itemsOf(const DeskState& state);
/// Works whose machine's score stays hidden until all marks are in: those that come twice, and as many others, so that
/// this tells nobody which come twice.
[[nodiscard]] std::vector<std::string> heldBack(const DeskState& state);

/// Where a marker's desk is kept: FOLDER/marking-MARKER.json. Throws core::Error for a name that no file can have.
[[nodiscard]] std::filesystem::path deskFile(const std::filesystem::path& folder, const std::string& marker);
[[nodiscard]] std::string deskJson(const DeskState& state);
/// Throws core::Error: no desk, damaged, of a newer format, hostile sizes.
[[nodiscard]] DeskState parseDesk(std::string_view json, const std::string& where);

/// The machine's score with the marker's words in its place, judged anew by the rubric: points, bands, rules, pass
/// mark. Throws core::Error for an override that cannot be: see Desk::override().
[[nodiscard]] score::Assessment withOverrides(const rubric::Rubric& rubric, const score::Assessment& machine,
                                              const Sheet& sheet);

/// One thread. Every change is on the disk, whole, when the call returns; where that fails the call throws core::Error
/// and nothing has changed. Nothing of the machine's score can be had from it before isRevealed().
class Desk {
  public:
    /// Goes on with the marker's desk in this folder or begins one; work that has come since is added. Throws
    /// core::Error: its file belongs to another exercise, to another rubric and marks are blind, is damaged or of a
    /// newer format; a marker without a name.
    Desk(DeskSetup setup, std::vector<ReturnedWork> works);

    [[nodiscard]] const std::string& marker() const noexcept { return state_.marker; }
    [[nodiscard]] bool isBlind() const noexcept { return state_.isBlind; }
    [[nodiscard]] const rubric::Rubric& rubric() const noexcept { return setup_.rubric; }
    [[nodiscard]] const std::filesystem::path& folder() const noexcept { return setup_.folder; }
    [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }

    /// In the order of marking.
    [[nodiscard]] const std::vector<std::string>& codes() const noexcept { return codes_; }
    [[nodiscard]] bool has(const std::string& code) const { return items_.contains(code); }
    /// The file behind a code. Its name may say whose it is: who marks blind is not shown it.
    [[nodiscard]] const ReturnedWork& work(const std::string& code) const;
    [[nodiscard]] const std::vector<ReturnedWork>& works() const noexcept { return works_; }
    [[nodiscard]] const Sheet& sheet(const std::string& code) const;

    /// Of one of works().
    void take(std::size_t which, Scored scored);
    [[nodiscard]] bool isScored(const std::string& code) const;
    /// Why there is no score; empty where there is one, or none yet. Only that there is none where isRevealed() is
    /// false: names of files and folders would tell whose it is, and which works come twice.
    [[nodiscard]] std::string problem(const std::string& code) const;
    /// That as an error, for other languages; none where problem() is of an override, or empty.
    [[nodiscard]] std::optional<core::Error> error(const std::string& code) const;
    [[nodiscard]] const view::Image& picture(const std::string& code) const;
    /// Whether the machine's score, and which works come twice, may be seen.
    [[nodiscard]] bool isRevealed(const std::string& code) const;
    [[nodiscard]] bool isRepeat(const std::string& code) const;  ///< false until all marks are in
    /// Null: hidden, not there yet, or none.
    [[nodiscard]] const assessment::Result* machine(const std::string& code) const;
    /// With the overrides; none where there is no machine(), or where an override no longer fits the rubric.
    [[nodiscard]] std::optional<score::Assessment> finalScore(const std::string& code) const;
    /// What passes: the marker's decision, else the final score's.
    [[nodiscard]] std::optional<score::Passed> passed(const std::string& code) const;

    // Blind: one's own marks first.

    /// Criteria that ask for a mark, in the rubric's order; kTotal last, where points are given.
    [[nodiscard]] std::vector<std::string> asked() const;
    /// Throws core::Error: the desk is not blind, the mark is in, a criterion or band that is not there, points beyond
    /// the weight, both or neither of band and points where the criterion asks for one.
    void setMark(const std::string& code, const std::string& criterion, const Mark& mark);
    /// Criteria without a mark yet; none of a work that cannot be scored, which may go in without marks.
    [[nodiscard]] std::vector<std::string> missing(const std::string& code) const;
    /// Throws core::Error while something is missing().
    void giveIn(const std::string& code);
    /// Sheets that are in.
    [[nodiscard]] std::size_t countIn() const;
    [[nodiscard]] bool areAllIn() const;

    // What the marker says beside the machine.

    /// Throws core::Error: hidden, no machine's score, a blank reason, nothing said, a band that is not there, points
    /// beyond the weight or of what has none, points missing where the band gives none and nothing was measured.
    void override(const std::string& code, const std::string& criterion, const Override& said);
    void withdraw(const std::string& code, const std::string& criterion);
    /// Returns its number. Throws core::Error for a blank text.
    int comment(const std::string& code, Comment said);
    void removeComment(const std::string& code, int number);
    void decide(const std::string& code, std::optional<Decision> decision);

    /// Of every desk of this exercise and rubric in the folder that marks blind, this one first: what has been given
    /// in.
    struct Others {
        std::vector<DeskState> desks;
        std::vector<std::string> problems;  ///< of files that cannot be read, a sentence each
    };
    [[nodiscard]] Others othersOfFolder() const;
    [[nodiscard]] const DeskState& state() const noexcept { return state_; }

  private:
    template <class Change>
    void change(Change&& change);
    void arrange();
    [[nodiscard]] std::optional<score::Assessment> judge(const std::string& code, std::string& why) const;
    const rubric::Criterion& criterion(const std::string& id) const;
    std::size_t placeOf(const std::string& code) const;

    DeskSetup setup_;
    DeskState state_;
    std::vector<ReturnedWork> works_;
    std::vector<std::optional<Scored>> scored_;  ///< of works_
    std::filesystem::path file_;
    std::uint64_t written_ = 0;  ///< hash of what the file holds, as far as this desk knows; 0: no file
    std::vector<std::string> codes_, held_;
    std::map<std::string, DeskItem> items_;
    std::map<std::string, std::size_t> places_;  ///< of works, by id
};

}  // namespace handpiece::marking
