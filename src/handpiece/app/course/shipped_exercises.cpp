// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/course/shipped_exercises.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "handpiece/app/course/kept_cases.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/fdi.h"
#include "handpiece/model/field/field_cache.h"
#include "handpiece/model/lesion/lesion.h"
#include "handpiece/model/starter/block.h"

namespace handpiece::course {
namespace {

namespace fs = std::filesystem;

/// What it is cut in.
enum class Stand { block, cariousBlock, tooth, deepLesion, arch };
struct Row {
    int number;
    std::string id;  ///< also of its rubric
    int version;     ///< raised with what is asked, and with the teeth
    const char* level;
    double minutes;
    Stand stand;
    int fdi;
    preparation::Recipe recipe;
    std::vector<std::string> burs;  ///< the first is in hand
    std::vector<std::string> locked;
    const char *english, *japanese;
};

preparation::Recipe recipe(const std::string& id, double leewayMm = 0.2,
                           std::map<std::string, double, std::less<>> numbers = {}, const char* side = "") {
    preparation::Recipe recipe;
    recipe.preparation = id;
    recipe.side = side;
    recipe.numbers = std::move(numbers);
    recipe.leeway = {leewayMm, leewayMm};
    return recipe;
}

constexpr std::array kLeewayMm = {0.5, 0.35, 0.2};  // of blocks, by level

/// Tasks, burs (as far as there are such; for the tapered Endo-Z a round-ended cylinder), minutes and levels: the
/// project's list of first exercises (times and levels are its judgement).
const std::vector<Row>& rows() {
    static const std::vector<Row> all = [] {
        std::vector<Row> list{
            {1,
             "block-channel",
             1,
             "beginner",
             10,
             Stand::block,
             0,
             recipe("block-channel"),
             {"330"},
             {},
             "Cut the channel along the figure: even in depth and width, with a flat floor and upright walls, and "
             "nothing beside or under it.",
             "図形どおりに溝を削る。深さと幅は一定に、窩底は平らに、壁は垂直に。周囲と底を削りすぎないこと。"},
            {2,
             "block-cross-mirror",
             1,
             "beginner",
             15,
             Stand::block,
             0,
             recipe("block-cross", 0.35),
             {"330"},
             {"direct-view"},
             "Cut the cross by mirror only: the direct view is locked. All of its width and depth, and nothing beside "
             "or under it.",
             "ミラー視だけで十字を削る（直視はできない）。幅と深さは過不足なく、周囲と底を削りすぎないこと。"},
            {3,
             "block-caries",
             2,
             "beginner",
             15,
             Stand::cariousBlock,
             0,
             recipe("lesion", 0.2, {{"over_pulp_mm", 0.0}}),
             {"round-4", "steel-round-4"},
             {},
             "Take all carious dentine out of the bowl, the soft and the firm, with a round bur at low speed. Leave "
             "the sound dentine around and under it.",
             "ラウンドバーを低速で用い、軟らかい部分からやや硬い部分まで、う蝕象牙質をすべて除去する。周囲と底の健全象"
             "牙"
             "質は残すこと。"},
            {4,
             "46-class-i",
             7,
             "basic",
             30,
             Stand::arch,
             46,
             recipe("class-one", 0.2, {{"ridge_mm", 2.2}}),
             {"330", "245"},
             {},
             "Open the fissures for amalgam, to an even, flat floor. Leave the marginal ridges and the cusps; let the "
             "walls converge a little occlusally; keep off the pulp.",
             "アマルガムのために、裂溝に沿って均一で平らな窩底まで削る。辺縁隆線と咬頭を残し、壁は咬合面に向かってわず"
             "か"
             "に狭め、歯髄に近づかないこと。"},
            {5,
             "46-deep-lesion",
             4,
             "basic",
             30,
             Stand::deepLesion,
             46,
             recipe("lesion"),
             {"330", "round-2", "round-4", "steel-round-4"},
             {},
             "Open the lesion and make its periphery clean and hard, for a composite restoration. Over the pulp leave "
             "the last soft or firm dentine: the pulp must not be exposed.",
             "病変部を開拡し、コンポジットレジン修復のために周辺を硬い歯質まで清掃する。歯髄の上では軟らかい、またはや"
             "や硬い象牙質を残し、露髄させないこと。"},
            {6,
             "46-class-ii-mo",
             5,
             "intermediate",
             45,
             Stand::arch,
             46,
             recipe("class-two", 0.2, {}, "mesial"),
             {"245", "330"},
             {},
             "Cut the occlusal part and a mesial box for amalgam: just free of the contact with 45, with an even axial "
             "wall and a flat gingival floor. Do not touch 45; keep off the pulp.",
             "アマルガムのための 2 級 MO 窩洞。咬合面部と近心の箱形を形成し、45 との接触点からわずかに離す。軸壁は均一"
             "に、歯肉側窩底は平らに。45 に触れず、歯髄に近づかないこと。"},
            {7,
             "11-class-iii",
             6,
             "intermediate",
             30,
             Stand::arch,
             11,
             recipe("class-three", 0.2, {{"axial_mm", 1.1}, {"depth_mm", 1.85}}, "mesial"),
             {"330", "329", "round-1/2"},
             {},
             "Open the mesial contact from the palatal side. Leave the labial enamel. Do not touch 21; keep off the "
             "pulp.",
             "口蓋側から近心の接触点部を開窓する。唇側のエナメル質は残すこと。21 に触れず、歯髄に近づかないこと。"},
            {8,
             "33-class-v",
             9,
             "intermediate",
             25,
             Stand::arch,
             33,
             recipe("class-five", 0.2, {{"over_cervix_mm", 1.2}}),
             {"330"},
             {},
             "Cut the cervical cavity on the labial side: everywhere as deep, with rounded corners. Do not touch the "
             "gingiva.",
             "唇側歯頸部の窩洞を削る。深さは全体で均一に、隅角は丸く。歯肉に触れないこと。"},
            {9,
             "46-crown",
             5,
             "advanced",
             60,
             Stand::arch,
             46,
             recipe("crown"),
             {"856-012", "856-016", "850-014"},
             {},
             "Reduce the crown for a full cast crown, evenly, the functional cusps more. The axial walls converge a "
             "little, with a chamfer all round, just over the gingiva. No undercut; do not touch the teeth beside.",
             "全部鋳造冠のために歯冠を均等に削り、機能咬頭は多めに削る。軸壁はわずかに収束させ、歯肉縁の少し上に全周シ"
             "ャ"
             "ンファーを付ける。アンダーカットをつくらず、隣在歯に触れないこと。"},
            {10,
             "46-access",
             4,
             "advanced",
             45,
             Stand::tooth,
             46,
             recipe("access"),
             {"round-4", "round-2", "881-012"},
             {},
             "Open the pulp chamber so that all orifices can be seen and reached; take no more of the walls and "
             "nothing of the floor.",
             "すべての根管口が見えて届くように髄室を開拡する。壁は必要以上に削らず、髄床底は削らないこと。"}};
        for (const char* kind : {"line", "channel", "cross", "circle", "hollow-circle", "d-circle", "steps"})
            list.push_back({0,
                            fmt::format("dexterity-{}", kind),
                            1,
                            "beginner",
                            10,
                            Stand::block,
                            0,
                            recipe(fmt::format("block-{}", kind), kLeewayMm[0]),
                            {"330"},
                            {},
                            "Cut the figure as the ideal shows it: all of its width and depth, with upright walls, and "
                            "nothing beside or under it.",
                            "見本どおりの図形を削る。幅と深さは過不足なく、壁は垂直に、周囲と底を削りすぎないこと。"});
        return list;
    }();
    return all;
}

const Row& rowOf(const std::string& id) {
    const auto row = std::find_if(rows().begin(), rows().end(), [&](const Row& r) { return id == r.id; });
    if (row == rows().end())
        throw core::Error(fmt::format("no exercise \"{}\" comes with the program", id), {}, "handpiece exercise list");
    return *row;
}

/// All but the caries bowl begin with enamel.
const char* driveOf(const Row& row) {
    return row.stand == Stand::cariousBlock ? "low-speed" : "turbine";
}

cases::View blockView() {
    cases::View view;
    view.eyeMm = core::Vec3(0.0, -18.0, 30.0);
    return view;
}

cases::Exercise exerciseOf(const Row& row) {
    cases::Exercise exercise;
    exercise.title = rubric::shippedRubric(row.id).title;
    exercise.instructions = {{"en", row.english}, {"ja", row.japanese}};
    exercise.bur = row.burs.front();
    exercise.allowedBurs = row.burs;
    exercise.lockedHelps = row.locked;
    return exercise;
}

/// From where one works: a window or a cervical cavity from its side, all else from over the crown.
cases::View viewOf(const Row& row, int buccalSign) {
    if (row.fdi == 0) return blockView();
    const bool isClassThree = row.recipe.preparation == "class-three";
    const bool isFromAside = isClassThree || row.recipe.preparation == "class-five";
    cases::View view;
    view.targetMm = core::Vec3(0.0, 0.0, isClassThree ? 6.5 : 4.0);
    const core::Vec3 aside(0.0, (isClassThree ? -26.0 : 26.0) * buccalSign, 14.0);
    const core::Vec3 above(0.0, 11.0 * buccalSign, 27.0);
    view.eyeMm = view.targetMm + (isFromAside ? aside : above);
    if (cases::isUpperTooth(row.fdi)) view.up = -view.up;
    return view;
}

/// Teeth and gingiva of the jaw of the tooth that is worked on, as a typodont has them.
cases::Case ownArch(cases::Case mouth) {
    const bool isLower = cases::isLowerTooth(mouth.fdiNumber);
    std::erase_if(mouth.others,
                  [&](const cases::PlacedTooth& o) { return cases::isLowerTooth(o.fdiNumber) != isLower; });
    std::erase_if(mouth.scenery,
                  [&](const cases::Part& p) { return p.name != (isLower ? "lower-gingiva" : "upper-gingiva"); });
    mouth.opening = {};
    return mouth;
}

cases::Case standOf(const Row& row, const fs::path& folder, std::size_t faces, const core::Progress& progress) {
    if (row.stand == Stand::block) return starter::makeBlock(starter::BlockLayers::hard);
    if (row.stand == Stand::cariousBlock) return starter::makeBlock(starter::BlockLayers::carious);
    const double toothShare = row.stand == Stand::tooth ? 1.0 : row.stand == Stand::arch ? 0.2 : 0.6;
    cases::Case tooth = keptTooth(row.fdi, {}, faces, folder, core::part(progress, 0.0, toothShare));
    if (row.stand == Stand::deepLesion) {
        lesion::addLesions(tooth, lesion::lesionsByName("occlusal:D3"), {}, core::part(progress, toothShare, 1.0));
    } else if (row.stand == Stand::arch) {
        cases::Case arch = ownArch(keptMouth(row.fdi, {}, folder, core::part(progress, toothShare, 1.0)));
        static_cast<cases::Tooth&>(arch) = std::move(static_cast<cases::Tooth&>(tooth));
        return arch;
    }
    return tooth;
}

tasks::Task taskOf(const Row& row, cases::Case toothCase) {
    tasks::Task task;
    task.id = row.id;
    task.version = row.version;
    task.minutes = row.minutes;
    task.level = row.level;
    task.drive = driveOf(row);
    task.preparation = row.recipe;
    task.ownJudgement = row.fdi != 0;
    task.hasLiveBar = row.number != 0;
    task.rubric = rubric::shippedRubricText(row.id);
    task.toothCase = std::move(toothCase);
    task.toothCase.exercise = exerciseOf(row);
    task.toothCase.exercise->view = viewOf(row, task.toothCase.buccalSign);
    return task;
}

}  // namespace

tasks::Task blockTask(const std::string& kind, int level, const std::string& layers) {
    const auto layered = std::find(starter::kBlockLayers.begin(), starter::kBlockLayers.end(), layers);
    if (level < 1 || level > 3 || layered == starter::kBlockLayers.end())
        throw core::Error(fmt::format("no block of level {} and layers \"{}\"", level, layers), {}, "level 1 to 3");
    if (preparation::findTemplate("block-" + kind) == nullptr)
        throw core::Error(fmt::format("no figure \"{}\" is cut in blocks", kind), {}, "handpiece make block --help");
    tasks::Task task;
    task.id = fmt::format("block-{}-{}", kind, level);
    if (layers != "hard") task.id += "-" + layers;
    task.toothCase = starter::makeBlock(static_cast<starter::BlockLayers>(layered - starter::kBlockLayers.begin()));
    task.drive = "turbine";
    task.preparation = recipe("block-" + kind);
    const double leewayMm = kLeewayMm[static_cast<std::size_t>(level - 1)];
    task.preparation->leeway = {leewayMm, leewayMm};
    cases::Exercise exercise;
    exercise.title = {{"en", fmt::format("Block: {}, level {}", kind, level)}};
    exercise.bur = "330";
    exercise.view = blockView();
    task.toothCase.exercise = exercise;
    return task;
}

const std::vector<Shipped>& shippedExercises() {
    static const std::vector<Shipped> all = [] {
        std::vector<Shipped> list;
        for (const Row& row : rows())
            list.push_back({row.id, row.number, row.fdi, row.stand == Stand::arch, row.level, row.recipe.preparation,
                            row.minutes, driveOf(row), exerciseOf(row)});
        return list;
    }();
    return all;
}

const Shipped& shippedExercise(const std::string& id) {
    return shippedExercises()[static_cast<std::size_t>(&rowOf(id) - rows().data())];
}

Made makeShipped(const std::string& id, const fs::path& folder, const core::Progress& progress, std::size_t faces) {
    const Row& row = rowOf(id);
    const fs::path place = folder / fmt::format("exercises-{}-{}", faces, keptRevision()) / id;
    std::error_code error;
    if (fs::exists(fs::symlink_status(place, error))) {
        try {
            tasks::Task there = tasks::readTask(place);
            // Of before, with other words, numbers or burs: made anew.
            const tasks::Task wanted = taskOf(row, there.toothCase);
            if (there.rubric == wanted.rubric && tasks::taskToml(there) == tasks::taskToml(wanted))
                return {place, std::move(there)};
        } catch (const core::Error&) {  // damaged: made anew
        }
        fs::remove_all(place, error);
    }
    const tasks::Task task = taskOf(row, standOf(row, folder, faces, core::part(progress, 0.0, 0.95)));
    core::report(progress, 0.95);
    fs::create_directories(place.parent_path(), error);
    tasks::writeTask(task, place);  // from here on it is there: too late to cancel
    return {place, tasks::readTask(place)};
}

Made openExercise(const std::string& pathOrId, const core::Progress& progress) {
    const auto& shipped = shippedExercises();
    if (core::isThere(pathOrId) ||
        std::none_of(shipped.begin(), shipped.end(), [&](const Shipped& s) { return s.id == pathOrId; }))
        return {pathOrId, tasks::readTask(pathOrId)};
    const fs::path cache = field::userCacheFolder();
    if (cache.empty())
        throw core::Error("there is no folder to make this exercise in", pathOrId, "set XDG_CACHE_HOME or HOME");
    return makeShipped(pathOrId, cache / "starter", progress);
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
