// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/ray_tissues.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>

#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::cases::ray_tissues_test {
namespace {

using Role = RaySurface::Role;

/// Where the ray is in a surface: pairs of places.
struct Lies {
    RaySurface surface;
    std::vector<std::pair<double, double>> in;
};

bool holds(const Lies& lies, double at) {
    return std::any_of(lies.in.begin(), lies.in.end(), [&](const auto& i) { return i.first < at && at < i.second; });
}

/// The rule as the header words it, point by point; no value: air. A gap is Tissue::none.
std::optional<Tissue> tissueAt(const std::vector<Lies>& scene, double at) {
    const auto outerOf = [&](std::uint32_t tooth) -> const Lies* {
        for (const Lies& l : scene)
            if (l.surface.role == Role::outer && l.surface.tooth == tooth) return &l;
        return nullptr;
    };
    const Lies* best = nullptr;
    bool inOuter = false;
    for (const Lies& l : scene) {
        if (!holds(l, at)) continue;
        if (l.surface.role == Role::outer) inOuter = true;
        if (l.surface.role != Role::part) continue;
        const Lies* outer = outerOf(l.surface.tooth);
        if (outer != nullptr && !holds(*outer, at)) continue;
        if (best == nullptr || l.surface.priority >= best->surface.priority) best = &l;
    }
    if (best != nullptr) return best->surface.tissue;
    if (inOuter)
        for (const Lies& l : scene) {
            if (l.surface.role != Role::outer || !holds(l, at)) continue;
            const bool hasParts = std::any_of(scene.begin(), scene.end(), [&](const Lies& p) {
                return p.surface.role == Role::part && p.surface.tooth == l.surface.tooth;
            });
            return hasParts ? Tissue::none : Tissue::enamel;
        }
    for (const Lies& l : scene)
        if (l.surface.role == Role::scenery && holds(l, at) &&
            (best == nullptr || l.surface.priority >= best->surface.priority))
            best = &l;
    return best != nullptr ? std::optional(best->surface.tissue) : std::nullopt;
}

TEST(RayTissues, AreAsTheRuleHasThemPointByPoint) {
    const std::uint64_t seed = test::seed();
    std::mt19937_64 random(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    for (int round = 0; round < 400; ++round) {
        std::vector<Lies> scene;
        const auto add = [&](Role role, std::uint32_t tooth) {
            RaySurface s;
            s.name = "s" + std::to_string(scene.size());
            s.tissue = static_cast<Tissue>(1 + random() % (kTissueCount - 1));
            s.priority = static_cast<int>(random() % 3);
            s.role = role;
            s.tooth = tooth;
            Lies lies{s, {}};
            double at = test::uniform(random, 0.0, 5.0);
            for (std::size_t n = random() % 3; n < 3; ++n) {
                const double to = at + test::uniform(random, 0.1, 3.0);
                lies.in.push_back({at, to});
                at = to + test::uniform(random, 0.1, 2.0);
            }
            scene.push_back(lies);
        };
        for (std::uint32_t tooth = 0; tooth < 3; ++tooth) {
            if (random() % 3 != 0) add(Role::outer, tooth);
            for (std::size_t parts = random() % 4; parts > 0; --parts)
                add(Role::part, tooth);
        }
        for (std::size_t parts = random() % 3; parts > 0; --parts)
            add(Role::scenery, 0);
        std::vector<RaySurface> surfaces;
        std::vector<RayCrossing> crossings;
        for (const Lies& l : scene) {
            for (const auto& [from, to] : l.in) {
                crossings.push_back({from, static_cast<std::uint32_t>(surfaces.size()), 1});
                crossings.push_back({to, static_cast<std::uint32_t>(surfaces.size()), -1});
            }
            surfaces.push_back(l.surface);
        }
        std::sort(crossings.begin(), crossings.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
        RayTissues::Work work;
        std::vector<RayStretch> found;
        RayTissues(surfaces).follow(
            crossings,
            [](std::uint32_t, double from, double to, const RayStretch* before, const RayStretch* after, auto& out) {
                EXPECT_TRUE(before == nullptr || before->to == from);
                EXPECT_TRUE(after == nullptr || after->from == to);
                out.push_back({from, to, Tissue::none, false});
            },
            work, found);
        for (std::size_t n = 1; n < found.size(); ++n)
            EXPECT_LE(found[n - 1].to, found[n].from);
        for (int n = 0; n < 200; ++n) {
            const double at = test::uniform(random, 0.0, 20.0);
            std::optional<Tissue> here;
            for (const RayStretch& s : found)
                if (s.from < at && at < s.to) here = s.tissue;
            EXPECT_EQ(here, tissueAt(scene, at)) << "round " << round << " at " << at;
        }
    }
}

TEST(RayTissues, ASurfaceThatIsNotLeftIsOpen) {
    const RayTissues tissues({{"enamel", Tissue::enamel, 1, Role::part, 0}});
    RayTissues::Work work;
    std::vector<RayStretch> found;
    const std::vector<RayCrossing> crossings = {{1.0, 0, 1}, {2.0, 0, -1}, {3.0, 0, 1}};
    const std::string error = test::errorOf([&] { tissues.follow(crossings, {}, work, found); });
    EXPECT_THAT(error, testing::AllOf(testing::HasSubstr("enamel"), testing::HasSubstr("not closed")));
}

}  // namespace
}  // namespace handpiece::cases::ray_tissues_test
