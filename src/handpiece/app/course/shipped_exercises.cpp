// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/course/shipped_exercises.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/config/table.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "handpiece/model/starter/block.h"

namespace handpiece::course {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kToothFaces = 40656;

struct Row {
    const char* id;           ///< also of its rubric
    const char* preparation;  ///< of a block: its kind
    int fdi;                  ///< 0: a block
    const char *bur, *english, *japanese;
};
constexpr const char* kOfBlocks =
    "Cut the figure as the ideal shows it: all of its width and depth, with upright walls, and nothing beside or under "
    "it.";
constexpr const char* kOfBlocksJa =
    "見本どおりの図形を削る。幅と深さは過不足なく、壁は垂直に、周囲と底を削りすぎないこと。";
constexpr std::array kRows = {
    Row{"dexterity-line", "line", 0, "330", kOfBlocks, kOfBlocksJa},
    Row{"dexterity-channel", "channel", 0, "330", kOfBlocks, kOfBlocksJa},
    Row{"dexterity-cross", "cross", 0, "330", kOfBlocks, kOfBlocksJa},
    Row{"dexterity-circle", "circle", 0, "330", kOfBlocks, kOfBlocksJa},
    Row{"dexterity-hollow-circle", "hollow-circle", 0, "330", kOfBlocks, kOfBlocksJa},
    Row{"dexterity-d-circle", "d-circle", 0, "330", kOfBlocks, kOfBlocksJa},
    Row{"dexterity-steps", "steps", 0, "330", kOfBlocks, kOfBlocksJa},
    Row{"46-class-i", "class-one", 46, "330",
        "Open the fissures to an even, flat floor. Leave the marginal ridges and the cusps; let the walls converge a "
        "little occlusally; keep off the pulp.",
        "裂溝に沿って、均一で平らな窩底まで削る。辺縁隆線と咬頭を残し、壁は咬合面に向かってわずかに狭め、歯髄に近づかな"
        "いこと。"},
    Row{"33-class-v", "class-five", 33, "330",
        "Cut the cervical cavity on the labial side: everywhere as deep, with rounded corners. Do not touch the "
        "gingiva.",
        "唇側歯頸部の窩洞を削る。深さは全体で均一に、隅角は丸く。歯肉に触れないこと。"},
    Row{"46-access", "access", 46, "round-2",
        "Open the pulp chamber so that all orifices can be seen and reached; take no more of the walls and nothing of "
        "the "
        "floor.",
        "すべての根管口が見えて届くように髄室を開拡する。壁は必要以上に削らず、髄床底は削らないこと。"},
};

const Row& rowOf(const std::string& id) {
    const auto row = std::find_if(kRows.begin(), kRows.end(), [&](const Row& r) { return id == r.id; });
    if (row == kRows.end())
        throw core::Error(fmt::format("no exercise \"{}\" comes with the program", id), {}, "handpiece exercise list");
    return *row;
}

preparation::Recipe recipe(const std::string& id) {
    const std::string toml = fmt::format("[preparation]\ntemplate = \"{}\"\n", id);
    return preparation::readRecipe(*config::Table::parse(toml, "an exercise of the program").table("preparation"));
}

tasks::Task made(const Row& row, const core::Progress& progress) {
    tasks::Task task;
    if (row.fdi == 0) {
        task = blockTask(row.preparation, 1);
    } else {
        static_cast<cases::Tooth&>(task.toothCase) =
            dentition::makeTooth(row.fdi, {}, {kToothFaces, 0}, core::part(progress, 0.0, 0.9));
        task.toothCase.exercise.emplace();
        task.preparation = recipe(row.preparation);
    }
    task.id = row.id;
    task.ownJudgement = row.fdi != 0;
    const rubric::Rubric judged = rubric::shippedRubric(row.id);
    task.toothCase.exercise->title = judged.title;
    task.toothCase.exercise->instructions = {{"en", row.english}, {"ja", row.japanese}};
    task.toothCase.exercise->bur = row.bur;
    task.rubric = rubric::shippedRubricText(row.id);
    return task;
}

}  // namespace

tasks::Task blockTask(const std::string& kind, int level, const std::string& layers) {
    constexpr std::array kLeewayMm = {0.5, 0.35, 0.2};
    const auto layered = std::find(starter::kBlockLayers.begin(), starter::kBlockLayers.end(), layers);
    if (level < 1 || level > 3 || layered == starter::kBlockLayers.end())
        throw core::Error(fmt::format("no block of level {} and layers \"{}\"", level, layers), {}, "level 1 to 3");
    tasks::Task task;
    task.id = fmt::format("block-{}-{}", kind, level);
    if (layers != "hard") task.id += "-" + layers;
    task.toothCase = starter::makeBlock(static_cast<starter::BlockLayers>(layered - starter::kBlockLayers.begin()));
    task.preparation = recipe("block-" + kind);
    const double leewayMm = kLeewayMm[static_cast<std::size_t>(level - 1)];
    task.preparation->leeway = {leewayMm, leewayMm};
    cases::Exercise exercise;
    exercise.title = {{"en", fmt::format("Block: {}, level {}", kind, level)}};
    exercise.bur = "330";
    cases::View view;
    view.eyeMm = core::Vec3(0.0, -18.0, 30.0);
    exercise.view = view;
    task.toothCase.exercise = exercise;
    return task;
}

const std::vector<Shipped>& shippedExercises() {
    static const std::vector<Shipped> all = [] {
        std::vector<Shipped> list;
        for (const Row& row : kRows)
            list.push_back({row.id, rubric::shippedRubric(row.id).title});
        return list;
    }();
    return all;
}

fs::path shippedExercise(const std::string& id, const fs::path& folder, const core::Progress& progress) {
    const Row& row = rowOf(id);
    const fs::path place = folder / id;
    std::error_code error;
    if (fs::exists(place, error)) {
        try {
            if (tasks::readTask(place).id == id) return place;
        } catch (const core::Error&) {  // damaged: made anew
        }
        fs::remove_all(place, error);
    }
    const tasks::Task task = made(row, progress);
    fs::create_directories(folder, error);
    tasks::writeTask(task, place);
    core::report(progress, 1.0);
    return place;
}

std::vector<Found> exercisesIn(const fs::path& folder, const core::Progress& progress) {
    std::error_code error;
    if (!fs::is_directory(folder, error))
        throw core::Error("there is no such folder", folder.string(), "name one with exercises in it");
    std::vector<fs::path> entries;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
        if (entry.is_directory(error) || cases::isPackageName(entry.path())) entries.push_back(entry.path());
    std::sort(entries.begin(), entries.end());
    std::vector<Found> found;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        core::report(progress, static_cast<double>(i) / static_cast<double>(entries.size()));
        try {
            if (tasks::isTask(entries[i])) found.push_back({entries[i], tasks::readTask(entries[i]), {}});
        } catch (const core::Error& why) {
            found.push_back({entries[i], {}, why});
        }
    }
    return found;
}

}  // namespace handpiece::course
