// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <optional>

#include "handpiece/base/core/error.h"
#include "handpiece/model/field/field_builder.h"
#include "handpiece/model/field/field_cache.h"
#include "handpiece/model/tooth/tooth.h"

namespace handpiece::tooth {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The surface that is felt: the case's outer one, or that of its only part.
const geometry::TriangleMesh& outerOf(const cases::Case& toothCase) {
    if (!toothCase.outer.triangles.empty()) return toothCase.outer;
    if (toothCase.parts.empty())
        throw core::Error("the case has no surface to feel", toothCase.source.string(),
                          "name at least one part in case.toml")
            .as("case-without-surface");
    if (toothCase.parts.size() > 1)
        throw core::Error("a case of several parts needs outer.stl, the whole tooth as one closed surface",
                          toothCase.source.string(), "export the union of its parts and name it in case.toml")
            .as("case-without-surface");
    return toothCase.parts.front().mesh;
}

field::DistanceField buildField(const cases::Case& toothCase, const geometry::TriangleMesh& outer,
                                const geometry::TriangleTree& tree, const field::FieldSettings& settings,
                                const core::Progress& progress) {
    std::vector<geometry::TriangleTree> trees;
    std::vector<field::PartSurface> parts;
    trees.reserve(toothCase.parts.size());
    for (const cases::Part& part : toothCase.parts) {
        const geometry::TriangleTree* partTree = nullptr;
        if (toothCase.parts.size() > 1) partTree = &trees.emplace_back(part.mesh);
        parts.push_back({partTree, part.tissue, part.priority});
        core::report(progress, 0.2);
    }
    const auto later = [&](double fraction) { return !progress || progress(0.2 + 0.8 * fraction); };
    return field::FieldBuilder::fromSurface(outer, tree, parts, settings, later);
}

}  // namespace

std::shared_ptr<const Tooth> prepareTooth(const cases::Case& toothCase, const PrepareSettings& settings,
                                          const core::Progress& progress) {
    const Clock::time_point start = Clock::now();
    core::report(progress, 0.0);
    const geometry::TriangleMesh& outer = outerOf(toothCase);
    const auto finished = [&](geometry::TriangleTree tree, field::DistanceField field, bool fromCache) {
        auto tooth =
            std::make_shared<Tooth>(Tooth{toothCase.name, outer, std::move(tree), std::move(field), fromCache, 0.0});
        tooth->buildSeconds = secondsSince(start);
        core::report(progress, 1.0);
        return tooth;
    };

    const std::uint64_t key = settings.useCache ? field::cacheKey(toothCase, settings.field) : 0;
    std::vector<std::filesystem::path> places;
    if (settings.useCache) places = field::cachePlaces(toothCase, settings.cacheFolder, key);
    std::optional<geometry::TriangleTree> tree;
    if (!places.empty()) tree.emplace(outer);
    for (const std::filesystem::path& place : places)
        // Only surfaces that passed requireSolid() were ever stored.
        if (auto field = field::readFieldFile(place, key, *tree, settings.field, field::TissueSet(toothCase)))
            return finished(std::move(*tree), std::move(*field), true);

    cases::requireSolid(outer, toothCase.source.empty() ? toothCase.name : toothCase.source.string());
    if (toothCase.parts.size() > 1)
        for (const cases::Part& part : toothCase.parts)
            cases::requireSolid(part.mesh, part.name);
    core::report(progress, 0.1);
    if (!tree) tree.emplace(outer);
    field::DistanceField field = buildField(toothCase, outer, *tree, settings.field, progress);
    const auto tooth = finished(std::move(*tree), std::move(field), false);
    if (!places.empty()) (void)field::writeFieldFile(places, field::encodeField(tooth->field, key));
    return tooth;
}

}  // namespace handpiece::tooth
