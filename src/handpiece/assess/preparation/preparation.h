// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a task asks for, as a few numbers: a template laid onto the tooth of a case by its landmarks.

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/assess/preparation/painted.h"
#include "handpiece/assess/preparation/recorded_work.h"
#include "handpiece/assess/zones/cavity.h"
#include "handpiece/assess/zones/zones.h"
#include "handpiece/base/config/table.h"
#include "handpiece/model/case/case.h"

namespace handpiece::preparation {

/// A number of a template, as an editor offers it.
struct Parameter {
    std::string_view name;  ///< with its unit: "depth_mm", "wall_deg"
    double usual, least, most;
    std::string_view says;
};

struct Template {
    std::string_view id;  ///< "class-one"
    std::string_view says;
    std::span<const Parameter> parameters;
    bool hasSide = false;  ///< which proximal side: mesial or distal
    bool isBlock = false;  ///< of a block, not of a tooth
    bool isOwn = false;    ///< its shape is no numbers: recorded work, or a painting
};
inline constexpr std::string_view kRecordedTemplate = "recorded-work", kPaintedTemplate = "painted";
[[nodiscard]] std::span<const Template> templates();
/// Null when there is none.
[[nodiscard]] const Template* findTemplate(std::string_view id);

/// A template with its numbers; what is not named is as usual.
struct Recipe {
    std::string preparation;  ///< a template's id
    std::string side;         ///< "mesial" or "distal" where the template has a side
    std::map<std::string, double, std::less<>> numbers;
    zones::Leeway leeway{0.2, 0.2};
    double pulpMm = 0.0;  ///< all within this of the pulp is protected; 0: the pulp alone

    // Of recorded work and of a painting.
    std::string like{};                              ///< the template that it is meant as, "class-one"; empty: none
    std::optional<core::Vec3> draw{};                ///< path of draw, unit; none: found
    std::shared_ptr<const RecordedWork> recorded{};  ///< of recorded work: comes in a file of its own
    std::uint64_t recordedHash = 0;                  ///< of that file's content
    std::vector<BrushStroke> strokes{};              ///< of a painting

    /// The template by which it is measured and judged.
    [[nodiscard]] const std::string& kind() const { return like.empty() ? preparation : like; }
    /// The parameter's value. Throws core::Error for one that the template has not.
    [[nodiscard]] double number(std::string_view name) const;
    friend bool operator==(const Recipe&, const Recipe&);
};

/// An onlay's numbers of what comes off each cusp, by quarters of the crown: mesial before distal, buccal before
/// lingual.
inline constexpr std::array<std::string_view, 4> kCapNumbers{"cap_mesiobuccal_mm", "cap_distobuccal_mm",
                                                             "cap_mesiolingual_mm", "cap_distolingual_mm"};
/// Criteria of the rubric that comes along which these numbers do not ask for: cusps that stay, boxes that are none.
[[nodiscard]] std::vector<std::string_view> notAsked(const Recipe& recipe);

/// `[preparation]` of an exercise, and back, without the recorded work itself. Throws core::Error with file and line
/// for what no template has, numbers out of their range, a missing side.
[[nodiscard]] Recipe readRecipe(const config::Table& table);
[[nodiscard]] std::string recipeToml(const Recipe& recipe);

/// A task's zones on a tooth, with what they rest on. Kept alive together.
struct Laid {
    std::shared_ptr<const geometry::TriangleTree> whole;  ///< the uncut surface
    std::shared_ptr<const zones::Zones> zones;
    /// Whose union the target is; none for a crown, an onlay, a lesion, recorded work and a painting.
    std::vector<zones::Cavity> cavities;
    core::Vec3 draw = core::Vec3::UnitZ();  ///< path of draw, out of the tooth, unit
    /// Of the fissures' points on the occlusal surface, where the template follows them.
    core::Vec3 fissureMiddleMm = core::Vec3::Zero();
};

/// Throws core::Error: a landmark that is missing (which, and how to set it), a tooth on which there is no room for the
/// template with these numbers, a lesion where there is none, recorded work or paint that does not lie on this tooth.
[[nodiscard]] Laid layOn(const cases::Tooth& tooth, const Recipe& recipe);

}  // namespace handpiece::preparation
