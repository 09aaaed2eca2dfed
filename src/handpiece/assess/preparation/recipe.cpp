// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "handpiece/assess/preparation/preparation.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash_text.h"

namespace handpiece::preparation {
namespace {

// Sizes as taught; docs/assessment.md says from where, and which are recalled.
constexpr std::array kClassOne{
    Parameter{"depth_mm", 1.75, 0.5, 4.0, "from the fissure's floor to the pulpal floor"},
    Parameter{"width_mm", 1.2, 0.4, 5.0, "isthmus, at the floor"},
    Parameter{"ridge_mm", 2.0, 0.5, 4.0, "left of marginal ridges and of the buccal and lingual walls"},
    Parameter{"wall_deg", -3.0, -10.0, 15.0, "of each wall against the path of draw; negative converges occlusally"}};
constexpr std::array kClassTwo{
    Parameter{"depth_mm", 1.5, 0.5, 4.0, "from the fissure's floor to the pulpal floor"},
    Parameter{"width_mm", 1.75, 0.4, 5.0, "isthmus, at the floor"},
    Parameter{"ridge_mm", 2.0, 0.5, 4.0, "left of the other marginal ridge and of the buccal and lingual walls"},
    Parameter{"wall_deg", -3.0, -10.0, 15.0, "of each wall against the path of draw; negative converges occlusally"},
    Parameter{"axial_mm", 1.5, 0.5, 4.0, "from the contact to the axial wall"},
    Parameter{"box_width_mm", 3.9, 1.0, 8.0, "of the box, buccolingually, at its floor"},
    Parameter{"under_contact_mm", 2.0, 0.2, 4.0, "from the contact down to the gingival floor"}};
constexpr std::array kClassThree{
    Parameter{"height_mm", 2.5, 0.5, 6.0, "incisogingivally"},
    Parameter{"axial_mm", 1.0, 0.3, 3.0, "from the contact to the axial wall"},
    Parameter{"depth_mm", 1.75, 0.5, 6.0, "from the palatal side towards the labial one, at the contact"},
    Parameter{"corner_mm", 0.4, 0.0, 2.0, "radius of the outline's corners"},
    Parameter{"labial_mm", 0.5, 0.0, 2.0, "of the labial surface that must stay"}};
constexpr std::array kClassFive{
    Parameter{"width_mm", 4.5, 1.0, 10.0, "mesiodistally"}, Parameter{"height_mm", 2.5, 0.5, 8.0, "incisogingivally"},
    Parameter{"axial_mm", 1.0, 0.3, 3.0, "under the uncut surface, the shortest way"},
    Parameter{"over_cervix_mm", 0.75, 0.0, 5.0, "from the cemento-enamel junction to the gingival wall"},
    Parameter{"corner_mm", 0.6, 0.0, 3.0, "radius of the outline's corners"}};
constexpr std::array kCrown{
    Parameter{"occlusal_mm", 1.5, 0.3, 3.0, "reduction on top"},
    Parameter{"margin_mm", 0.5, 0.2, 2.0, "width of the margin"},
    Parameter{"convergence_deg", 12.0, 0.0, 40.0, "total, of opposite walls"},
    Parameter{"over_cervix_mm", 0.95, 0.0, 4.0, "from the cemento-enamel junction to the margin"}};
constexpr std::array kAccess{
    Parameter{"round_mm", 0.6, 0.2, 2.0, "outline round horns and orifices"},
    Parameter{"wall_deg", 2.0, -5.0, 20.0, "of each wall against the path of draw"},
    Parameter{"shell_mm", 0.5, 0.0, 2.0, "under the surface of root and furcation that must stay"}};
constexpr std::array kOnlay{
    Parameter{"depth_mm", 1.5, 1.0, 4.0, "from the fissure's floor to the pulpal floor"},
    Parameter{"width_mm", 2.0, 1.0, 5.0, "isthmus, at the floor"},
    Parameter{"ridge_mm", 1.6, 0.5, 4.0, "left of the other marginal ridge and of the walls that stay"},
    Parameter{"wall_deg", 6.0, 0.0, 15.0, "of each wall against the path of draw; all open occlusally"},
    Parameter{"axial_mm", 1.5, 0.0, 4.0, "from the contact to the axial wall; 0: no box"},
    Parameter{"other_axial_mm", 0.0, 0.0, 4.0, "of a box on the other side; 0: none"},
    Parameter{"box_width_mm", 3.9, 1.0, 8.0, "of the box, buccolingually, at its floor"},
    Parameter{"under_contact_mm", 2.0, 0.2, 4.0, "from the contact down to the gingival floor"},
    Parameter{"cap_mesiobuccal_mm", 1.75, 0.0, 3.0, "off that cusp, square to its surface; 0: it stays"},
    Parameter{"cap_distobuccal_mm", 1.75, 0.0, 3.0, "off that cusp, square to its surface; 0: it stays"},
    Parameter{"cap_mesiolingual_mm", 0.0, 0.0, 3.0, "off that cusp, square to its surface; 0: it stays"},
    Parameter{"cap_distolingual_mm", 0.0, 0.0, 3.0, "off that cusp, square to its surface; 0: it stays"},
    Parameter{"shoulder_mm", 1.0, 0.0, 3.0, "from the capped cusp's top down to its outer margin"}};
constexpr std::array kLesion{
    Parameter{"over_pulp_mm", 0.5, 0.0, 3.0, "carious tissue nearer to the pulp than this is not asked for"}};
constexpr std::array kPainted{Parameter{"depth_mm", 1.0, 0.1, 6.0, "under what is painted, the shortest way"}};
constexpr std::array kStroke{Parameter{"depth_mm", 1.5, 0.2, 6.0, "under the block's top"},
                             Parameter{"width_mm", 1.2, 0.4, 6.0, "of the groove"},
                             Parameter{"length_mm", 8.0, 1.0, 14.0, "of the groove, or across the figure"}};
constexpr std::array kRing{Parameter{"depth_mm", 1.5, 0.2, 6.0, "under the block's top"},
                           Parameter{"diameter_mm", 6.0, 1.0, 10.0, "outer"},
                           Parameter{"inner_mm", 3.0, 0.0, 9.0, "what is left standing in the middle"}};
constexpr std::array kDisc{Parameter{"depth_mm", 1.5, 0.2, 6.0, "under the block's top"},
                           Parameter{"diameter_mm", 5.0, 1.0, 10.0, "of the circle"}};
constexpr std::array kSteps{Parameter{"depth_mm", 1.0, 0.2, 2.0, "of the first step; each further one as much deeper"},
                            Parameter{"width_mm", 3.0, 1.0, 6.0, "across"},
                            Parameter{"length_mm", 9.0, 3.0, 14.0, "of the three together"}};

constexpr std::array kTemplates{
    Template{"access", "endodontic access from the pulp's own horns and orifices", kAccess},
    Template{"block-channel", "a straight channel", kStroke, false, true},
    Template{"block-circle", "a round, filled", kDisc, false, true},
    Template{"block-cross", "two grooves that cross", kStroke, false, true},
    Template{"block-d-circle", "half a round, filled", kDisc, false, true},
    Template{"block-hollow-circle", "a round groove about an island", kRing, false, true},
    Template{"block-line", "a straight groove", kStroke, false, true},
    Template{"block-steps", "three floors, each deeper than the one before", kSteps, false, true},
    Template{"class-five", "cervical, on the buccal or labial side", kClassFive},
    Template{"class-one", "occlusal, along the tooth's own fissures", kClassOne},
    Template{"class-three", "proximal of a front tooth, from the palatal or lingual side", kClassThree, true},
    Template{"class-two", "occlusal with a proximal box", kClassTwo, true},
    Template{"crown", "full crown with a margin all round", kCrown},
    Template{"lesion", "all carious tissue, short of the pulp", kLesion},
    Template{"onlay", "occlusal with proximal boxes or none, and cusps capped", kOnlay, true},
    Template{kPaintedTemplate, "what is painted on the tooth", kPainted, false, false, true},
    Template{kRecordedTemplate, "what somebody took away", {}, false, false, true}};

const Parameter* parameterOf(const Template& t, std::string_view name) {
    const auto at =
        std::find_if(t.parameters.begin(), t.parameters.end(), [&](const Parameter& p) { return p.name == name; });
    return at == t.parameters.end() ? nullptr : &*at;
}

}  // namespace

std::span<const Template> templates() {
    return kTemplates;
}

const Template* findTemplate(std::string_view id) {
    const auto at = std::find_if(kTemplates.begin(), kTemplates.end(), [&](const Template& t) { return t.id == id; });
    return at == kTemplates.end() ? nullptr : &*at;
}

double Recipe::number(std::string_view name) const {
    if (const auto given = numbers.find(name); given != numbers.end()) return given->second;
    const Template* t = findTemplate(preparation);
    const Parameter* parameter = t != nullptr ? parameterOf(*t, name) : nullptr;
    if (parameter == nullptr)
        throw core::Error(fmt::format("preparation \"{}\" has no number \"{}\"", preparation, name), "preparation", "");
    return parameter->usual;
}

std::vector<std::string_view> notAsked(const Recipe& recipe) {
    if (recipe.kind() != "onlay") return {};
    Recipe usual;
    usual.preparation = "onlay";
    const Recipe& of = recipe.preparation == "onlay" ? recipe : usual;
    const auto has = [&](std::string_view name) { return of.number(name) > 0.0; };
    std::vector<std::string_view> out;
    const auto leaveOut = [&](std::string_view id, bool isAsked) {
        if (!isAsked) out.push_back(id);
    };
    const bool mb = has("cap_mesiobuccal_mm"), db = has("cap_distobuccal_mm"), ml = has("cap_mesiolingual_mm"),
               dl = has("cap_distolingual_mm");
    leaveOut("cusp-mesiobuccal", mb), leaveOut("cusp-distobuccal", db);
    leaveOut("cusp-mesiolingual", ml), leaveOut("cusp-distolingual", dl);
    leaveOut("shoulder-buccal", mb || db), leaveOut("shoulder-lingual", ml || dl);
    leaveOut("wall-buccal", !(mb && db)), leaveOut("wall-lingual", !(ml && dl));
    leaveOut("axial-depth", has("axial_mm")), leaveOut("other-axial-depth", has("other_axial_mm"));
    return out;
}

bool operator==(const Recipe& a, const Recipe& b) {
    return a.preparation == b.preparation && a.side == b.side && a.numbers == b.numbers &&
           a.leeway.sideMm == b.leeway.sideMm && a.leeway.floorMm == b.leeway.floorMm && a.pulpMm == b.pulpMm &&
           a.like == b.like && a.draw == b.draw && a.recordedHash == b.recordedHash && a.strokes == b.strokes;
}

Recipe readRecipe(const config::Table& table) {
    Recipe recipe;
    const auto id = table.text("template");
    std::vector<std::string_view> ids;
    for (const Template& t : kTemplates)
        ids.push_back(t.id);
    const Template* t = id ? findTemplate(*id) : nullptr;
    if (t == nullptr)
        table.fail(id ? fmt::format("there is no preparation \"{}\"", *id) : "the preparation has no template",
                   fmt::format("one of {}", fmt::join(ids, ", ")), id ? "template" : "");
    recipe.preparation = *id;
    if (t->isOwn && table.has("like")) {
        recipe.like = *table.text("like");
        const Template* like = findTemplate(recipe.like);
        if (like == nullptr || like->isOwn || like->isBlock)
            table.fail(fmt::format("there is no preparation \"{}\" to be like", recipe.like),
                       "name one of a tooth, as in like = \"class-one\"", "like");
    }
    const Template* kind = findTemplate(recipe.kind());
    const bool hasSide = kind->hasSide;
    const auto within = [&](std::string_view key, double least, double most) {
        const double value = *table.number(key);
        if (!(value >= least && value <= most))
            table.fail(fmt::format("\"{}\" is {}", key, value), fmt::format("give {} to {}", least, most), key);
        return value;
    };
    for (const std::string& key : table.keys()) {
        if (key == "template") continue;
        if (key == "side") {
            recipe.side = table.text("side").value_or("");
            if (!hasSide || (recipe.side != "mesial" && recipe.side != "distal"))
                table.fail(fmt::format("\"{}\" is no side of this preparation", recipe.side),
                           hasSide ? "mesial or distal" : "take it out: this template has none", "side");
        } else if (key == "leeway_side_mm") {
            recipe.leeway.sideMm = within(key, 0.0, 3.0);
        } else if (key == "leeway_floor_mm") {
            recipe.leeway.floorMm = within(key, 0.0, 3.0);
        } else if (key == "pulp_mm") {
            recipe.pulpMm = within(key, 0.0, 3.0);
        } else if (t->isOwn && key == "like") {
            continue;
        } else if (t->isOwn && key == "draw") {
            const std::vector<double> way = table.numbers(key);
            const core::Vec3 draw =
                way.size() == 3 ? core::Vec3(way[0], way[1], way[2]) : core::Vec3(core::Vec3::Zero());
            if (!(draw.norm() >= 0.5 && draw.norm() <= 2.0))
                table.fail("this is no path of draw", "three numbers, of length 1, as in draw = [0, 0, 1]", key);
            // One that is unit already stays to the bit: written and read again it is the same exercise.
            constexpr double kUnit = 1e-12;
            recipe.draw = std::abs(draw.squaredNorm() - 1.0) < kUnit ? draw : draw.normalized();
        } else if (*id == kPaintedTemplate && key == "stroke") {
            recipe.strokes = readStrokes(table);
        } else if (*id == kRecordedTemplate && key == "zones_hash") {
            const std::string hash = *table.text(key);
            const std::optional<std::uint64_t> value = core::readHash(hash);
            if (!value)
                table.fail(fmt::format("\"{}\" is no hash", hash.substr(0, 32)), "sixteen hexadecimal digits", key);
            recipe.recordedHash = *value;
        } else if (const Parameter* parameter = parameterOf(*t, key)) {
            recipe.numbers[key] = within(key, parameter->least, parameter->most);
        } else {
            std::vector<std::string_view> names;
            for (const Parameter& p : t->parameters)
                names.push_back(p.name);
            table.fail(fmt::format("preparation \"{}\" has no \"{}\"", *id, key),
                       fmt::format("it has {}", fmt::join(names, ", ")), key);
        }
    }
    if (hasSide && recipe.side.empty())
        table.fail("the preparation does not say on which side", "add side = \"mesial\" or \"distal\"");
    if (*id == kRecordedTemplate && !table.has("zones_hash"))
        table.fail("the recorded work has no hash", "make it with handpiece exercise new --from-work");
    if (*id == kPaintedTemplate && recipe.strokes.empty())
        table.fail("nothing is painted", "add [[preparation.stroke]] with radius_mm and points_mm");
    return recipe;
}

std::string recipeToml(const Recipe& recipe) {
    std::string out = fmt::format("[preparation]\ntemplate = \"{}\"\n", recipe.preparation);
    if (!recipe.side.empty()) out += fmt::format("side = \"{}\"\n", recipe.side);
    for (const auto& [name, value] : recipe.numbers)
        out += fmt::format("{} = {}\n", name, value);
    out += fmt::format("leeway_side_mm = {}\nleeway_floor_mm = {}\n", recipe.leeway.sideMm, recipe.leeway.floorMm);
    if (recipe.pulpMm > 0.0) out += fmt::format("pulp_mm = {}\n", recipe.pulpMm);
    if (!recipe.like.empty()) out += fmt::format("like = \"{}\"\n", recipe.like);
    if (recipe.draw) out += fmt::format("draw = [{}, {}, {}]\n", recipe.draw->x(), recipe.draw->y(), recipe.draw->z());
    if (recipe.preparation == kRecordedTemplate) out += fmt::format("zones_hash = \"{:016x}\"\n", recipe.recordedHash);
    return out + strokesToml(recipe.strokes, "preparation");
}

}  // namespace handpiece::preparation
