// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An exercise while a teacher makes it: what it holds so far, steps back, what is wrong with it.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/assess/preparation/preparation.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/assess/task/task.h"
#include "handpiece/base/config/words.h"
#include "handpiece/model/case/case.h"

namespace handpiece::draft {

/// All of an exercise, cheap to copy.
struct Content {
    std::string id = "exercise";
    std::int64_t version = 1;
    std::shared_ptr<const cases::Case> tooth;  ///< null: not chosen yet. Its own `exercise` counts for nothing
    cases::Exercise exercise;                  ///< texts, burs, locks, view
    double voxelMm = 0.05;
    std::optional<double> minutes;
    std::string level;               ///< of tasks::kLevels; empty: not said
    bool isTimeHard = false;         ///< work ends with the minutes
    bool hasLiveBar = false;         ///< what is removed of the target is shown during the work
    std::string drive;               ///< of instrument::drives(); empty: the student's choice
    std::optional<double> speedRpm;  ///< that it is set to; none: its own
    std::optional<preparation::Recipe> preparation;
    bool ownJudgement = false;  ///< a student says what they expect before they see the result
    std::optional<rubric::Rubric> rubric;
    std::string rubricText;  ///< as read: written again, with its comments, while it means the same
    std::shared_ptr<const std::vector<std::byte>> teacherWork;  ///< as a task has it
};
/// Throws core::Error for a rubric that is none.
[[nodiscard]] Content contentOf(const tasks::Task& task);
/// Throws core::Error without a tooth.
[[nodiscard]] tasks::Task taskOf(const Content& content);

/// Another preparation, its numbers as usual, and the rubric that comes along for it; one that was changed stays. A
/// template that does not exist: none.
[[nodiscard]] Content withTemplate(Content content, std::string_view id);
/// The other proximal side; the rubric that came along follows.
[[nodiscard]] Content withSide(Content content, std::string_view side);
/// A number of the template; the rubric that came along follows where another part is asked for by it.
[[nodiscard]] Content withNumber(Content content, std::string_view name, double value);
/// As which template a target of one's own is measured and judged; empty: as none. The rubric that came along follows.
[[nodiscard]] Content withLike(Content content, std::string_view id);
/// What somebody cut becomes what is asked for: with the tooth that was cut and the voxel it was cut in. Throws
/// core::Error where the content has another tooth already.
[[nodiscard]] Content withWork(Content content, std::shared_ptr<const cases::Case> tooth,
                               std::shared_ptr<const preparation::RecordedWork> work);
/// A stroke of the brush over the tooth's surface begins at a place of it [tooth frame]; another preparation than a
/// painting becomes one. A whole stroke is one step back: Draft::change() by the same name.
[[nodiscard]] Content beginStroke(Content content, const core::Vec3& onSurfaceMm, double radiusMm, bool erases);
/// The last stroke goes on to there; no place is kept that lies nearer than a quarter of the brush to the last.
[[nodiscard]] Content extendStroke(Content content, const core::Vec3& onSurfaceMm);
/// True while the rubric is that which comes along for the preparation, or there is none.
[[nodiscard]] bool hasProposedRubric(const Content& content);

/// Another name: what refers to it follows.
void renameCriterion(rubric::Rubric& rubric, std::size_t which, const std::string& id);
/// Likewise of a band and a rule.
void renameBand(rubric::Rubric& rubric, std::size_t which, const std::string& id);
void renameRule(rubric::Rubric& rubric, std::size_t which, const std::string& id);
/// With what refers to it; a rule without needs goes too.
void removeBand(rubric::Rubric& rubric, std::size_t which);
void removeRule(rubric::Rubric& rubric, std::size_t which);

/// A text of a rubric, by language.
struct TextPlace {
    enum class Kind { title, words, band, step, criterion, criterionWords, leavesOut, criticalError, rule };
    Kind kind;
    std::string id;  ///< of band, step, criterion, rule
    rubric::Texts* texts;
};
/// All there may be, in the order of the file.
[[nodiscard]] std::vector<TextPlace> textsOf(rubric::Rubric& rubric);

/// With what refers to it; a step without criteria and a rule without needs go too.
void removeCriterion(rubric::Rubric& rubric, std::size_t which);
/// A sum of weights that the rubric states is that which they have.
void restateTotal(rubric::Rubric& rubric);

/// The parts of an exercise in which something can be wrong.
enum class Part { tooth, preparation, work, judgement, texts };
struct Problem {
    Part part = Part::tooth;
    rubric::Severity severity = rubric::Severity::error;  ///< an error: students cannot have it like this
    std::string what, remedy;
    std::string criterion{};               ///< of the rubric, the one it is about; empty: all of it
    config::Phrase about{};                ///< of the rubric: the criterion, step or rule
    config::Phrase said{}, advice{};       ///< `what` and `remedy` to be said in any language; empty: see `error`
    std::string error{};                   ///< core::Error::id()
    std::vector<std::string> arguments{};  ///< of the error
};
/// What can be told at once.
[[nodiscard]] std::vector<Problem> problems(const Content& content);
/// Whether the preparation lies on the tooth; up to seconds, on any thread. Empty without tooth or preparation.
[[nodiscard]] std::vector<Problem> problemsOnTooth(const Content& content);
[[nodiscard]] bool hasErrors(const std::vector<Problem>& problems);

/// With steps back. One thread.
class Draft {
  public:
    /// The most steps back that are kept.
    static constexpr std::size_t kMostSteps = 200;

    [[nodiscard]] const Content& now() const noexcept { return now_.content; }
    /// A step; changes one after the other that have the same name, such as typing in one field, are one.
    void change(Content content, std::string_view name = {});
    [[nodiscard]] bool canUndo() const noexcept { return !past_.empty(); }
    [[nodiscard]] bool canRedo() const noexcept { return !future_.empty(); }
    void undo();
    void redo();
    /// The next change is a step of its own.
    void endStep() { stepName_.clear(); }

    /// Changed since it was begun, opened or saved.
    [[nodiscard]] bool isUnsaved() const noexcept { return now_.serial != savedSerial_; }
    /// Where it was opened or saved; empty: nowhere yet.
    [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
    /// Another exercise, without steps back. `file` may be empty.
    void begin(Content content, const std::filesystem::path& file = {});
    /// What it holds now is what `file` holds.
    void noteSaved(const std::filesystem::path& file);

  private:
    struct State {
        Content content;
        std::uint64_t serial = 0;
    };
    State now_;
    std::vector<State> past_, future_;
    std::uint64_t serial_ = 0, savedSerial_ = 0;
    std::string stepName_;
    std::filesystem::path file_;
};

}  // namespace handpiece::draft
