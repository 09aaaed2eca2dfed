// SPDX-License-Identifier: Apache-2.0
#include "school/library.h"

#include "handpiece/app/sandboxed/sandboxed.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/school/store/teaching.h"

namespace handpiece::school_server {

AddedExercise addExercise(school::Books& books, const std::filesystem::path& file, const school::Act& act) {
    const sandboxed::PackedExercise packed = sandboxed::pack(file, kMostExercise);
    const sandboxed::Exercise& e = packed.exercise;
    // Held against what its reader says of it, where that is text alone.
    const rubric::Rubric judged = rubric::parseRubric(e.rubric, file.string() + "/rubric.toml");
    rubric::requireSound(judged);
    const std::string hash =
        school::sha256(std::string_view(reinterpret_cast<const char*>(packed.file.data()), packed.file.size()));
    const school::Upload upload{std::string(32, '0'), hash, packed.file.size()};
    // What came of it before goes on from there.
    const std::uint64_t have = books.received(upload, act.at);
    (void)books.append(upload, have, std::span(packed.file).subspan(have), act.at);
    const std::string rubricHash = rubric::hashText(rubric::hashOf(judged));
    // The same decisions in other words are the version that is there.
    if (!books.rubric(rubricHash))
        (void)school::Teaching(books).addRubric({rubricHash, judged.id, e.rubric, 0, 0}, act);
    const auto english = e.title.find("en");
    books.add(school::Pack{e.hash, hash, e.id, english == e.title.end() ? e.id : english->second, rubricHash, act.at},
              act);
    return {e.id, e.hash, rubricHash};
}

}  // namespace handpiece::school_server
