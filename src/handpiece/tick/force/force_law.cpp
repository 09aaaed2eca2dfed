// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/force_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "handpiece/base/core/error.h"
#include "handpiece/tick/force/built_in_laws.h"

namespace handpiece::force {
namespace {

struct NamedLaw {
    std::string name;
    LawFactory make;
};

/// By LawId.
std::vector<NamedLaw>& laws() {
    static std::vector<NamedLaw> all{{"proxy", makeProxyLaw}, {"penalty", makePenaltyLaw}};
    return all;
}

}  // namespace

LawId lawByName(std::string_view name) {
    const std::vector<NamedLaw>& all = laws();
    const auto found = std::find_if(all.begin(), all.end(), [&](const NamedLaw& law) { return law.name == name; });
    if (found != all.end()) return static_cast<LawId>(found - all.begin());
    std::string names;
    for (std::size_t i = 0; i < all.size(); ++i)
        names += (i == 0 ? "" : i + 1 == all.size() ? " and " : ", ") + all[i].name;
    throw core::Error(fmt::format("no force is called \"{}\"", name), "force", "there are " + names);
}

const std::string& nameOf(LawId law) {
    return laws().at(static_cast<std::size_t>(law)).name;
}

std::size_t lawCount() {
    return laws().size();
}

LawId addLaw(std::string name, LawFactory make) {
    std::vector<NamedLaw>& all = laws();
    if (std::any_of(all.begin(), all.end(), [&](const NamedLaw& law) { return law.name == name; }))
        throw core::Error(fmt::format("there is a force called \"{}\" already", name), "force", "choose another name");
    all.push_back({std::move(name), std::move(make)});
    return static_cast<LawId>(all.size() - 1);
}

std::vector<std::unique_ptr<ForceLaw>> makeLaws() {
    std::vector<std::unique_ptr<ForceLaw>> made;
    for (const NamedLaw& law : laws())
        made.push_back(law.make());
    return made;
}

KelvinVoigt couplingOf(const LawInput& input) noexcept {
    const Touch& touch = input.touch;
    const Parameters& parameters = input.parameters;
    double stiffness = 0.0, damping = 0.0, friction = 0.0, total = 0.0;
    for (std::size_t i = 0; i < cases::kTissueCount; ++i) {
        const double share = touch.patches.tissueShare[i];
        total += share;
        stiffness += share * parameters.tissues[i].stiffnessFraction;
        damping += share * parameters.tissues[i].dampingNSPerMm;
        friction += share * parameters.tissues[i].friction;
    }
    if (total > 0.0) {
        stiffness /= total;
        damping /= total;
        friction /= total;
    } else {
        // On the surface but with no point within the margin of it: the tissue that holds the proxy.
        const TissueFeel& feel = parameters.tissues[static_cast<std::size_t>(touch.tissue)];
        stiffness = feel.stiffnessFraction;
        damping = feel.dampingNSPerMm;
        friction = feel.friction;
    }
    const Limits& limits = input.limits;
    return {std::min(stiffness * limits.maxStiffnessNPerMm * parameters.stiffnessMultiplier, limits.maxStiffnessNPerMm),
            std::min(damping * parameters.dampingMultiplier, limits.maxDampingNSPerMm), friction};
}

}  // namespace handpiece::force
