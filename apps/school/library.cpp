// SPDX-License-Identifier: Apache-2.0
#include "school/library.h"

#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/store/teaching.h"

namespace handpiece::school_server {

AddedExercise addExercise(school::Books& books, const std::filesystem::path& file, const school::Act& act) {
    const tasks::Task task = tasks::readTask(file);
    if (task.rubric.empty())
        throw core::Error("this exercise has no rubric, so its work cannot be scored", file.string(), "give it one")
            .as("exercise-unscored");
    const rubric::Rubric judged = rubric::parseRubric(task.rubric, file.string() + "/rubric.toml");
    rubric::requireSound(judged);
    const core::PrivateFolder folder;
    const std::filesystem::path packed = folder.path() / "exercise.handpiece";
    tasks::writeTask(task, packed);
    const std::vector<std::byte> bytes = core::readFile(packed);
    const std::string hash = school::sha256Of(packed);
    const school::Upload upload{std::string(32, '0'), hash, bytes.size()};
    // What came of it before goes on from there.
    const std::uint64_t have = books.received(upload, act.at);
    (void)books.append(upload, have, std::span(bytes).subspan(have), act.at);
    const std::string rubricHash = rubric::hashText(rubric::hashOf(judged));
    // The same decisions in other words are the version that is there.
    if (!books.rubric(rubricHash))
        (void)school::Teaching(books).addRubric({rubricHash, judged.id, task.rubric, 0, 0}, act);
    const std::string exerciseHash = rubric::hashText(tasks::contentHash(task));
    std::string title = task.id;
    if (task.toothCase.exercise)
        if (const auto english = task.toothCase.exercise->title.find("en");
            english != task.toothCase.exercise->title.end())
            title = english->second;
    books.add(school::Pack{exerciseHash, hash, task.id, title, rubricHash, act.at}, act);
    return {task.id, exerciseHash, rubricHash};
}

}  // namespace handpiece::school_server
