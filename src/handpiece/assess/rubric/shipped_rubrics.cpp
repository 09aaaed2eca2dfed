// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <utility>

#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/core/error.h"

namespace handpiece::rubric {

// data/rubrics, by name.
#define HANDPIECE_RUBRICS(RUBRIC)                                      \
    RUBRIC("11-class-iii", kRubric_11_class_iii)                       \
    RUBRIC("33-class-v", kRubric_33_class_v)                           \
    RUBRIC("46-access", kRubric_46_access)                             \
    RUBRIC("46-class-i", kRubric_46_class_i)                           \
    RUBRIC("46-class-ii-mo", kRubric_46_class_ii_mo)                   \
    RUBRIC("46-crown", kRubric_46_crown)                               \
    RUBRIC("46-deep-lesion", kRubric_46_deep_lesion)                   \
    RUBRIC("46-onlay", kRubric_46_onlay)                               \
    RUBRIC("block-caries", kRubric_block_caries)                       \
    RUBRIC("block-channel", kRubric_block_channel)                     \
    RUBRIC("block-cross-mirror", kRubric_block_cross_mirror)           \
    RUBRIC("dexterity-channel", kRubric_dexterity_channel)             \
    RUBRIC("dexterity-circle", kRubric_dexterity_circle)               \
    RUBRIC("dexterity-cross", kRubric_dexterity_cross)                 \
    RUBRIC("dexterity-d-circle", kRubric_dexterity_d_circle)           \
    RUBRIC("dexterity-hollow-circle", kRubric_dexterity_hollow_circle) \
    RUBRIC("dexterity-line", kRubric_dexterity_line)                   \
    RUBRIC("dexterity-steps", kRubric_dexterity_steps)                 \
    RUBRIC("own-target", kRubric_own_target)

#define HANDPIECE_DECLARE(name, text) extern const char* const text;
HANDPIECE_RUBRICS(HANDPIECE_DECLARE)
#undef HANDPIECE_DECLARE

namespace {

struct Shipped {
    std::string_view name;
    const char* text;
};
const auto& all() {
#define HANDPIECE_ENTRY(name, text) Shipped{name, text},
    static const std::array list = {HANDPIECE_RUBRICS(HANDPIECE_ENTRY)};
#undef HANDPIECE_ENTRY
    return list;
}

}  // namespace

std::vector<std::string> shippedRubrics() {
    std::vector<std::string> names;
    for (const Shipped& s : all())
        names.emplace_back(s.name);
    return names;
}

std::string_view shippedFor(std::string_view preparation) {
    constexpr std::pair<std::string_view, std::string_view> kFor[] = {
        {"access", "46-access"},
        {"block-channel", "dexterity-channel"},
        {"block-circle", "dexterity-circle"},
        {"block-cross", "dexterity-cross"},
        {"block-d-circle", "dexterity-d-circle"},
        {"block-hollow-circle", "dexterity-hollow-circle"},
        {"block-line", "dexterity-line"},
        {"block-steps", "dexterity-steps"},
        {"class-five", "33-class-v"},
        {"class-one", "46-class-i"},
        {"class-three", "11-class-iii"},
        {"class-two", "46-class-ii-mo"},
        {"crown", "46-crown"},
        {"lesion", "46-deep-lesion"},
        {"onlay", "46-onlay"},
        {"painted", "own-target"},
        {"recorded-work", "own-target"},
    };
    for (const auto& [of, name] : kFor)
        if (of == preparation) return name;
    return {};
}

std::string_view shippedRubricText(std::string_view name) {
    for (const Shipped& s : all())
        if (s.name == name) return s.text;
    throw core::Error(fmt::format("there is no rubric \"{}\"", name.substr(0, 64)), {},
                      fmt::format("give a file, or one of {}", fmt::join(shippedRubrics(), ", ")));
}

namespace {

/// Without these criteria.
std::string without(std::string_view text, std::span<const std::string_view> criteria) {
    std::string out;
    while (!text.empty()) {
        const std::string_view part = text.substr(0, text.find("\n[[", 1));
        text.remove_prefix(part.size());
        const bool isLeftOut = part.starts_with("\n[[criterion]]") &&
                               std::any_of(criteria.begin(), criteria.end(), [&](std::string_view id) {
                                   return part.find(fmt::format("\nid = \"{}\"\n", id)) != std::string_view::npos;
                               });
        if (!isLeftOut) out += part;
    }
    return out;
}

}  // namespace

std::string shippedTextFor(std::string_view preparation, std::string_view side,
                           std::span<const std::string_view> notAsked) {
    const std::string_view name = shippedFor(preparation);
    if (name.empty()) return {};
    const std::string text = without(shippedRubricText(name), notAsked);
    // All that have a side were made for the mesial one.
    if (side != "distal") return text;
    constexpr std::pair<std::string_view, std::string_view> kSwaps[] = {{"mesial", "distal"},
                                                                        {"Mesial", "Distal"},
                                                                        {"distal", "mesial"},
                                                                        {"Distal", "Mesial"},
                                                                        // Cusps stay where they are.
                                                                        {"近心頬側", "近心頬側"},
                                                                        {"遠心頬側", "遠心頬側"},
                                                                        {"近心舌側", "近心舌側"},
                                                                        {"遠心舌側", "遠心舌側"},
                                                                        {"近心", "遠心"},
                                                                        {"遠心", "近心"},
                                                                        {"-mo\"", "-do\""},
                                                                        {" MO", " DO"}};
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        const auto* swap = std::find_if(std::begin(kSwaps), std::end(kSwaps), [&](const auto& s) {
            return std::string_view(text).substr(i, s.first.size()) == s.first;
        });
        if (swap == std::end(kSwaps)) {
            out += text[i++];
        } else {
            out += swap->second;
            i += swap->first.size();
        }
    }
    return out;
}

Rubric shippedRubric(std::string_view name) {
    return parseRubric(shippedRubricText(name), fmt::format("data/rubrics/{}.toml", name));
}

}  // namespace handpiece::rubric
