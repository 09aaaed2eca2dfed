// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/draft/draft.h"

#include <utility>

#include "handpiece/base/core/error.h"

namespace handpiece::draft {
namespace {

constexpr const char* kRubricHere = "the rubric";

std::string proposedText(const std::optional<preparation::Recipe>& recipe) {
    return recipe ? rubric::shippedTextFor(recipe->preparation, recipe->side) : std::string();
}

void propose(Content& content) {
    content.rubricText = proposedText(content.preparation);
    content.rubric.reset();
    if (!content.rubricText.empty()) content.rubric = rubric::parseRubric(content.rubricText, kRubricHere);
}

}  // namespace

Content contentOf(const tasks::Task& task) {
    Content content;
    content.id = task.id;
    content.version = task.version;
    content.exercise = task.toothCase.exercise.value_or(cases::Exercise{});
    content.voxelMm = task.voxelMm;
    content.minutes = task.minutes;
    content.preparation = task.preparation;
    content.ownJudgement = task.ownJudgement;
    content.rubricText = task.rubric;
    if (!task.rubric.empty()) content.rubric = rubric::parseRubric(task.rubric, kRubricHere);
    auto tooth = std::make_shared<cases::Case>(task.toothCase);
    tooth->exercise.reset();
    content.tooth = std::move(tooth);
    return content;
}

tasks::Task taskOf(const Content& content) {
    if (!content.tooth) throw core::Error("the exercise has no tooth yet", "the exercise", "choose one");
    tasks::Task task;
    task.id = content.id;
    task.version = content.version;
    task.toothCase = *content.tooth;
    task.toothCase.exercise = content.exercise;
    task.voxelMm = content.voxelMm;
    task.minutes = content.minutes;
    task.preparation = content.preparation;
    task.ownJudgement = content.ownJudgement;
    if (content.rubric) {
        task.rubric = rubric::rubricToml(*content.rubric);
        if (!content.rubricText.empty() &&
            rubric::rubricToml(rubric::parseRubric(content.rubricText, kRubricHere)) == task.rubric)
            task.rubric = content.rubricText;
    }
    return task;
}

bool hasProposedRubric(const Content& content) {
    if (!content.rubric) return true;
    const std::string text = proposedText(content.preparation);
    return !text.empty() &&
           rubric::rubricToml(rubric::parseRubric(text, kRubricHere)) == rubric::rubricToml(*content.rubric);
}

Content withTemplate(Content content, std::string_view id) {
    const bool follows = hasProposedRubric(content);
    if (const preparation::Template* t = preparation::findTemplate(id)) {
        preparation::Recipe recipe;
        recipe.preparation = t->id;
        if (content.preparation) {
            recipe.leeway = content.preparation->leeway;
            recipe.pulpMm = content.preparation->pulpMm;
            recipe.side = content.preparation->side;
        }
        if (!t->hasSide)
            recipe.side.clear();
        else if (recipe.side.empty())
            recipe.side = "mesial";
        content.preparation = std::move(recipe);
    } else {
        content.preparation.reset();
    }
    if (follows) propose(content);
    return content;
}

Content withSide(Content content, std::string_view side) {
    if (!content.preparation) return content;
    const bool follows = content.rubric && hasProposedRubric(content);
    content.preparation->side = side;
    if (follows) propose(content);
    return content;
}

void Draft::change(Content content, std::string_view name) {
    if (name.empty() || name != stepName_) {
        past_.push_back(std::move(now_));
        if (past_.size() > kMostSteps) past_.erase(past_.begin());
    }
    stepName_ = name;
    future_.clear();
    now_ = {std::move(content), ++serial_};
}

void Draft::undo() {
    if (past_.empty()) return;
    future_.push_back(std::exchange(now_, std::move(past_.back())));
    past_.pop_back();
    endStep();
}

void Draft::redo() {
    if (future_.empty()) return;
    past_.push_back(std::exchange(now_, std::move(future_.back())));
    future_.pop_back();
    endStep();
}

void Draft::begin(Content content, const std::filesystem::path& file) {
    now_ = {std::move(content), ++serial_};
    savedSerial_ = serial_;
    past_.clear();
    future_.clear();
    file_ = file;
    endStep();
}

void Draft::noteSaved(const std::filesystem::path& file) {
    savedSerial_ = now_.serial;
    file_ = file;
    endStep();
}

}  // namespace handpiece::draft
