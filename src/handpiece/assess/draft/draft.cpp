// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/draft/draft.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "handpiece/base/core/error.h"

namespace handpiece::draft {
namespace {

constexpr const char* kRubricHere = "the rubric";

std::string proposedText(const std::optional<preparation::Recipe>& recipe) {
    if (!recipe) return {};
    return rubric::shippedTextFor(recipe->kind(), recipe->side, preparation::notAsked(*recipe));
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
    content.level = task.level;
    content.isTimeHard = task.isTimeHard;
    content.hasLiveBar = task.hasLiveBar;
    content.drive = task.drive;
    content.speedRpm = task.speedRpm;
    content.preparation = task.preparation;
    content.ownJudgement = task.ownJudgement;
    content.teacherWork = task.teacherWork;
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
    task.level = content.level;
    task.isTimeHard = content.isTimeHard && content.minutes;
    task.hasLiveBar = content.hasLiveBar;
    task.drive = content.drive;
    if (!content.drive.empty()) task.speedRpm = content.speedRpm;
    task.preparation = content.preparation;
    task.ownJudgement = content.ownJudgement;
    task.teacherWork = content.teacherWork;
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

Content withNumber(Content content, std::string_view name, double value) {
    if (!content.preparation) return content;
    // Most numbers change nothing of the rubric.
    const auto before = preparation::notAsked(*content.preparation);
    Content next = content;
    next.preparation->numbers[std::string(name)] = value;
    if (preparation::notAsked(*next.preparation) != before && content.rubric && hasProposedRubric(content))
        propose(next);
    return next;
}

Content withLike(Content content, std::string_view id) {
    if (!content.preparation) return content;
    const bool follows = hasProposedRubric(content);
    preparation::Recipe& recipe = *content.preparation;
    const preparation::Template* like = preparation::findTemplate(id);
    recipe.like = like != nullptr ? id : std::string_view();
    if (like == nullptr || !like->hasSide)
        recipe.side.clear();
    else if (recipe.side.empty())
        recipe.side = "mesial";
    if (follows) propose(content);
    return content;
}

Content withWork(Content content, std::shared_ptr<const cases::Case> tooth,
                 std::shared_ptr<const preparation::RecordedWork> work) {
    if (content.tooth && cases::caseKey(*content.tooth) != cases::caseKey(*tooth))
        throw core::Error(fmt::format("this is work on another tooth than the exercise's: {}", tooth->name),
                          "recorded work", fmt::format("name work on {}, or begin a new exercise", content.tooth->name))
            .as("work-of-another-tooth");
    const std::string before = content.preparation ? content.preparation->kind() : std::string();
    content = withTemplate(std::move(content), preparation::kRecordedTemplate);
    if (!content.tooth) content.tooth = std::move(tooth);
    content.voxelMm = work->voxelMm;
    content.preparation->recordedHash = work->hash();
    content.preparation->recorded = std::move(work);
    const preparation::Template* like = preparation::findTemplate(before);
    return like != nullptr && !like->isOwn && !like->isBlock ? withLike(std::move(content), before) : content;
}

Content beginStroke(Content content, const core::Vec3& onSurfaceMm, double radiusMm, bool erases) {
    if (!content.preparation || content.preparation->preparation != preparation::kPaintedTemplate)
        content = withTemplate(std::move(content), preparation::kPaintedTemplate);
    content.preparation->strokes.push_back({{onSurfaceMm}, radiusMm, erases});
    return content;
}

Content extendStroke(Content content, const core::Vec3& onSurfaceMm) {
    if (!content.preparation || content.preparation->strokes.empty()) return content;
    preparation::BrushStroke& stroke = content.preparation->strokes.back();
    if ((onSurfaceMm - stroke.pointsMm.back()).norm() >= 0.25 * stroke.radiusMm) stroke.pointsMm.push_back(onSurfaceMm);
    return content;
}

void renameCriterion(rubric::Rubric& rubric, std::size_t which, const std::string& id) {
    const std::string before = std::exchange(rubric.criteria.at(which).id, id);
    // Two of a name: what refers to it may mean the other.
    if (rubric.criterion(before) != nullptr) return;
    const auto rename = [&](std::vector<std::string>& names) { std::replace(names.begin(), names.end(), before, id); };
    for (rubric::Criterion& c : rubric.criteria)
        rename(c.excludes);
    for (rubric::Step& step : rubric.steps)
        rename(step.criteria);
    for (rubric::Rule& rule : rubric.rules)
        for (rubric::Condition& need : rule.needs)
            rename(need.of);
}

void removeCriterion(rubric::Rubric& rubric, std::size_t which) {
    const std::string id = rubric.criteria.at(which).id;
    rubric.criteria.erase(rubric.criteria.begin() + static_cast<std::ptrdiff_t>(which));
    restateTotal(rubric);
    if (rubric.criterion(id) != nullptr) return;
    for (rubric::Criterion& c : rubric.criteria)
        std::erase(c.excludes, id);
    for (rubric::Step& step : rubric.steps)
        std::erase(step.criteria, id);
    std::erase_if(rubric.steps, [](const rubric::Step& s) { return s.criteria.empty(); });
    for (rubric::Rule& rule : rubric.rules)
        // Without names a condition would count all.
        std::erase_if(rule.needs, [&](rubric::Condition& n) { return std::erase(n.of, id) > 0 && n.of.empty(); });
    std::erase_if(rubric.rules, [](const rubric::Rule& r) { return r.needs.empty(); });
}

void renameBand(rubric::Rubric& rubric, std::size_t which, const std::string& id) {
    const std::string before = std::exchange(rubric.bands.at(which).id, id);
    if (std::any_of(rubric.bands.begin(), rubric.bands.end(), [&](const auto& b) { return b.id == before; })) return;
    for (rubric::Criterion& c : rubric.criteria)
        for (rubric::Band& band : c.bands)
            if (band.id == before) band.id = id;
    for (rubric::Rule& rule : rubric.rules)
        for (rubric::Condition& need : rule.needs)
            std::replace(need.bands.begin(), need.bands.end(), before, id);
}

void renameRule(rubric::Rubric& rubric, std::size_t which, const std::string& id) {
    const std::string before = std::exchange(rubric.rules.at(which).id, id);
    if (std::any_of(rubric.rules.begin(), rubric.rules.end(), [&](const auto& r) { return r.id == before; })) return;
    for (rubric::Rule& rule : rubric.rules)
        for (rubric::Condition& need : rule.needs)
            if (need.rule == before) need.rule = id;
}

void removeBand(rubric::Rubric& rubric, std::size_t which) {
    const std::string id = rubric.bands.at(which).id;
    rubric.bands.erase(rubric.bands.begin() + static_cast<std::ptrdiff_t>(which));
    if (std::any_of(rubric.bands.begin(), rubric.bands.end(), [&](const auto& b) { return b.id == id; })) return;
    for (rubric::Criterion& c : rubric.criteria)
        std::erase_if(c.bands, [&](const rubric::Band& b) { return b.id == id; });
    for (rubric::Rule& rule : rubric.rules)
        std::erase_if(rule.needs, [&](rubric::Condition& n) { return std::erase(n.bands, id) > 0 && n.bands.empty(); });
    std::erase_if(rubric.rules, [](const rubric::Rule& r) { return r.needs.empty(); });
}

void removeRule(rubric::Rubric& rubric, std::size_t which) {
    const std::string id = rubric.rules.at(which).id;
    rubric.rules.erase(rubric.rules.begin() + static_cast<std::ptrdiff_t>(which));
    if (std::any_of(rubric.rules.begin(), rubric.rules.end(), [&](const auto& r) { return r.id == id; })) return;
    for (rubric::Rule& rule : rubric.rules)
        std::erase_if(rule.needs, [&](const rubric::Condition& n) { return n.rule == id; });
    std::erase_if(rubric.rules, [](const rubric::Rule& r) { return r.needs.empty(); });
}

std::vector<TextPlace> textsOf(rubric::Rubric& rubric) {
    using Kind = TextPlace::Kind;
    std::vector<TextPlace> all{{Kind::title, {}, &rubric.title}, {Kind::words, {}, &rubric.words}};
    for (rubric::BandName& band : rubric.bands)
        all.push_back({Kind::band, band.id, &band.title});
    for (rubric::Criterion& c : rubric.criteria) {
        all.push_back({Kind::criterion, c.id, &c.title});
        all.push_back({Kind::criterionWords, c.id, &c.words});
        all.push_back({Kind::leavesOut, c.id, &c.leavesOut});
        if (c.critical) all.push_back({Kind::criticalError, c.id, &c.critical->title});
    }
    for (rubric::Step& step : rubric.steps)
        all.push_back({Kind::step, step.id, &step.title});
    for (rubric::Rule& rule : rubric.rules)
        all.push_back({Kind::rule, rule.id, &rule.title});
    return all;
}

void restateTotal(rubric::Rubric& rubric) {
    if (!rubric.totalWeight) return;
    rubric.totalWeight = std::accumulate(rubric.criteria.begin(), rubric.criteria.end(), 0.0,
                                         [](double sum, const rubric::Criterion& c) { return sum + c.weight; });
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
