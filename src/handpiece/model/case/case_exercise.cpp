// SPDX-License-Identifier: Apache-2.0
// The exercise of a case: read, written, in the student's language.
#include <fmt/format.h>

#include <algorithm>

#include "handpiece/base/core/error.h"
#include "handpiece/model/case/case_files.h"
#include "handpiece/model/case/exercise_table.h"
#include "handpiece/model/case/toml_text.h"

namespace handpiece::cases {
namespace {

using config::Table;

bool isLanguageTag(std::string_view tag) {
    return tag.size() >= 2 && tag.size() <= 35 && std::all_of(tag.begin(), tag.end(), [](char c) {
               return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
           });
}

Texts readTexts(const Table& exercise, std::string_view key) {
    Texts texts;
    const auto table = exercise.table(key);
    if (!table) return texts;
    for (const std::string& language : table->keys()) {
        if (!isLanguageTag(language))
            table->fail(fmt::format("\"{}\" is no language", language), "name languages as en, de, pt-BR", language);
        texts[language] = *table->text(language);
    }
    return texts;
}

core::Vec3 readPoint(const Table& table, std::string_view key) {
    const std::vector<double> v = table.numbers(key);
    if (v.size() != 3) table.fail(fmt::format("\"{}\" is not three numbers", key), {}, key);
    return {v[0], v[1], v[2]};
}

View readView(const Table& table) {
    table.allowOnly({"eye_mm", "target_mm", "up"});
    View view;
    view.eyeMm = readPoint(table, "eye_mm");
    view.targetMm = readPoint(table, "target_mm");
    if (table.has("up")) view.up = readPoint(table, "up");
    const core::Vec3 look = view.targetMm - view.eyeMm;
    if (!(look.norm() >= 1e-3 && look.norm() <= 1e6) || !(view.up.norm() >= 1e-6 && view.up.norm() <= 1e6))
        table.fail("the view looks nowhere", "give an eye that lies off the target, and an upward direction");
    if (!(look.normalized().cross(view.up.normalized()).norm() > 1e-3))
        table.fail("the view's upward direction lies along the look", "give another \"up\"");
    return view;
}

std::string tomlPoint(const core::Vec3& p) {
    return fmt::format("[{}, {}, {}]", tomlNumber(p.x()), tomlNumber(p.y()), tomlNumber(p.z()));
}

std::string tomlTexts(std::string_view name, const Texts& texts) {
    if (texts.empty()) return {};
    std::string out = fmt::format("\n[exercise.{}]\n", name);
    for (const auto& [language, text] : texts)
        out += fmt::format("{} = {}\n", tomlText(language), tomlText(text));
    return out;
}

}  // namespace

std::string_view inLanguage(const Texts& texts, std::string_view language) {
    if (const auto exact = texts.find(std::string(language)); exact != texts.end()) return exact->second;
    if (const auto base = texts.find(std::string(language.substr(0, language.find('-')))); base != texts.end())
        return base->second;
    if (const auto english = texts.find("en"); english != texts.end()) return english->second;
    return texts.empty() ? std::string_view() : std::string_view(texts.begin()->second);
}

Exercise readExercise(const Table& table) {
    table.allowOnly({"title", "instructions", "bur", "allowed_burs", "locked_helps", "view"});
    Exercise e;
    e.title = readTexts(table, "title");
    e.instructions = readTexts(table, "instructions");
    e.bur = table.text("bur").value_or("");
    e.allowedBurs = table.texts("allowed_burs");
    e.lockedHelps = table.texts("locked_helps");
    for (const std::string& help : e.lockedHelps)
        if (std::find(kHelps.begin(), kHelps.end(), help) == kHelps.end())
            table.fail(fmt::format("there is no help \"{}\"", help), fmt::format("one of {}", fmt::join(kHelps, ", ")),
                       "locked_helps");
    if (!e.bur.empty() && !e.allowedBurs.empty() &&
        std::find(e.allowedBurs.begin(), e.allowedBurs.end(), e.bur) == e.allowedBurs.end())
        table.fail(fmt::format("the bur to start with, \"{}\", is not an allowed one", e.bur), "add it to allowed_burs",
                   "bur");
    if (const auto view = table.table("view")) e.view = readView(*view);
    return e;
}

std::string exerciseToml(const Exercise& e) {
    std::string out;
    if (!e.bur.empty()) out += fmt::format("bur = {}\n", tomlText(e.bur));
    if (!e.allowedBurs.empty()) out += fmt::format("allowed_burs = {}\n", tomlList(e.allowedBurs));
    if (!e.lockedHelps.empty()) out += fmt::format("locked_helps = {}\n", tomlList(e.lockedHelps));
    out += tomlTexts("title", e.title);
    out += tomlTexts("instructions", e.instructions);
    if (e.view)
        out += fmt::format("\n[exercise.view]\neye_mm = {}\ntarget_mm = {}\nup = {}\n", tomlPoint(e.view->eyeMm),
                           tomlPoint(e.view->targetMm), tomlPoint(e.view->up));
    return out;
}

std::string exerciseText(const Exercise& exercise) {
    return "[exercise]\n" + exerciseToml(exercise);
}

Exercise parseExercise(std::string_view text, const std::string& where) {
    const Table root = Table::parse(text, where);
    root.allowOnly({"exercise"});
    const auto exercise = root.table("exercise");
    return exercise ? readExercise(*exercise) : Exercise{};
}

}  // namespace handpiece::cases
