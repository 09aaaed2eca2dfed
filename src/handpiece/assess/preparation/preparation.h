// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a task asks for, as a few numbers: a template laid onto the tooth of a case by its landmarks.

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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
};
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

    /// The parameter's value. Throws core::Error for one that the template has not.
    [[nodiscard]] double number(std::string_view name) const;
    friend bool operator==(const Recipe&, const Recipe&);
};

/// `[preparation]` of an exercise, and back. Throws core::Error with file and line for what no template has, numbers
/// out of their range, a missing side.
[[nodiscard]] Recipe readRecipe(const config::Table& table);
[[nodiscard]] std::string recipeToml(const Recipe& recipe);

/// A task's zones on a tooth, with what they rest on. Kept alive together.
struct Laid {
    std::shared_ptr<const geometry::TriangleTree> whole;  ///< the uncut surface
    std::shared_ptr<const zones::Zones> zones;
    std::vector<zones::Cavity> cavities;    ///< whose union the target is; none for a crown and for a lesion
    core::Vec3 draw = core::Vec3::UnitZ();  ///< path of draw, out of the tooth, unit
};

/// Throws core::Error: a landmark that is missing (which, and how to set it), a tooth on which there is no room for the
/// template with these numbers, a lesion where there is none.
[[nodiscard]] Laid layOn(const cases::Tooth& tooth, const Recipe& recipe);

}  // namespace handpiece::preparation
