// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/tooth/tissue.h"

#include <fmt/format.h>

#include "handpiece/base/core/error.h"

namespace handpiece::tooth {
namespace {

// In the order of Tissue. docs/physics.md#tissues: fractions and priorities are design choices, the damping is the
// default that a desktop arm renders stably.
constexpr double kDamping = 0.002;
// Friction is a design choice [R]; the rates K are fitted to recalled ones, within a factor of 2 [R].
constexpr TissueTable kTable{{{
    {"none", 0.0, 0.0, 0.0, 0.0, {0, 0, 0}, 0},
    {"enamel", 1.0, kDamping, 0.12, 2.65e-5, {244, 241, 230}, 10},
    {"dentine", 0.6, kDamping, 0.18, 8e-5, {226, 199, 140}, 20},
    {"pulp", 0.04, kDamping, 0.1, 2e-3, {190, 62, 62}, 40},
    {"caries", 0.12, kDamping, 0.25, 4e-4, {104, 66, 34}, 50},
    {"cementum", 0.45, kDamping, 0.18, 9e-5, {214, 190, 150}, 15},
    {"gum", 0.07, kDamping, 0.1, 2e-3, {224, 132, 132}, 5},
    {"bone", 0.3, kDamping, 0.2, 1.2e-4, {232, 220, 196}, 4},
    {"neighbour", 1.0, kDamping, 0.12, 2.65e-5, {236, 232, 220}, 3},
    {"restoration", 0.85, kDamping, 0.15, 5e-5, {168, 176, 186}, 60},
}}};

}  // namespace

const TissueTable& builtInTissues() {
    return kTable;
}

const TissueProperties& properties(Tissue tissue) {
    return kTable.of(tissue);
}

Tissue tissueByName(std::string_view name) {
    std::string known;
    for (std::size_t i = 1; i < kTissueCount; ++i) {
        if (kTable.rows[i].name == name) return static_cast<Tissue>(i);
        known += fmt::format("{}{}", i == 1 ? "" : ", ", kTable.rows[i].name);
    }
    throw core::Error(fmt::format("there is no tissue \"{}\"", name), "tissue", "one of " + known);
}

}  // namespace handpiece::tooth
