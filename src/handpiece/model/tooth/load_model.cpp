// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>

#include "handpiece/base/core/error.h"
#include "handpiece/base/prepared/prepared_files.h"
#include "handpiece/model/field/field_builder.h"
#include "handpiece/model/field/field_cache.h"
#include "handpiece/model/field/packed_field.h"
#include "handpiece/model/field/tissue_cache.h"
#include "handpiece/model/tooth/kept_model.h"
#include "handpiece/model/tooth/tooth_model.h"

namespace handpiece::tooth {
namespace {

using geometry::TriangleMesh;
using geometry::TriangleTree;

constexpr const char *kField = ".packed-field", *kTissues = ".packed-tissues";

/// The surface that is felt: the case's outer one, or that of its only part.
const TriangleMesh& outerOf(const cases::Case& toothCase) {
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

/// One case on its way to a model: each tree is built once, and only when something is asked of it.
class Loader {
  public:
    Loader(const cases::Case& toothCase, const LoadSettings& settings)
        : case_(toothCase), settings_(settings), outer_(outerOf(toothCase)) {
        if (!settings.useCache) return;
        key_ = field::cacheKey(toothCase, settings.field);
        places_ = field::cachePlaces(toothCase, settings.cacheFolder, key_);
        preparedName_ = fmt::format("{:016x}", key_);
    }

    [[nodiscard]] bool isKept() const {
        std::error_code error;
        return std::any_of(places_.begin(), places_.end(),
                           [&](const std::filesystem::path& place) { return std::filesystem::exists(place, error); }) ||
               (!preparedName_.empty() && prepared::isKnown(preparedName_ + kField));
    }

    field::DistanceField field(const core::Progress& progress) {
        if (!places_.empty()) tree_.emplace(outer_);
        for (const std::filesystem::path& place : places_)
            // Only surfaces that passed requireSolid() were ever stored.
            if (auto found = field::readFieldFile(place, key_, *tree_, settings_.field, field::TissueSet(case_))) {
                fromCache_ = true;
                return std::move(*found);
            }
        if (auto found = preparedField()) {
            fromCache_ = true;
            return std::move(*found);
        }
        cases::requireSolid(outer_, case_.source.empty() ? case_.name : case_.source.string());
        if (case_.parts.size() > 1)
            for (const cases::Part& part : case_.parts)
                cases::requireSolid(part.mesh, part.name);
        core::report(progress, 0.1);
        if (!tree_) tree_.emplace(outer_);
        buildParts(core::part(progress, 0.1, 0.2));
        const bool isCollecting = prepared::isCollecting() && !preparedName_.empty();
        std::vector<std::uint32_t> nearest;
        field::DistanceField made = field::FieldBuilder::fromSurface(
            outer_, *tree_, parts_, settings_.field, core::part(progress, 0.2, 1.0), isCollecting ? &nearest : nullptr);
        if (isCollecting) prepared::keep(preparedName_ + kField, field::packField(made, nearest, key_));
        if (!places_.empty()) (void)field::writeFieldFile(places_, field::encodeField(made, key_));
        return made;
    }

    field::TissueMap tissues(const field::DistanceField& grid, const core::Progress& progress) {
        if (case_.parts.size() <= 1)
            return field::TissueMap::uniform(grid,
                                             case_.parts.empty() ? cases::Tissue::enamel : case_.parts.front().tissue);
        const std::uint64_t key = field::tissueKey(key_);
        std::vector<std::filesystem::path> places = field::cachePlaces(case_, settings_.cacheFolder, key);
        if (!settings_.useCache) places.clear();
        for (std::filesystem::path& place : places) {
            place.replace_extension(".tissues");
            if (auto found = field::readTissueFile(place, grid, key, field::TissueSet(case_))) return std::move(*found);
        }
        if (const auto packed = preparedFile(kTissues)) {
            if (auto found = field::unpackTissues(*packed, grid, key, field::TissueSet(case_)))
                return std::move(*found);
            prepared::refuse(preparedName_ + kTissues);
        }
        if (parts_.empty()) buildParts(core::part(progress, 0.0, 0.1));
        field::TissueMap made = field::TissueMap::fromParts(grid, parts_, core::part(progress, 0.1, 0.9));
        if (prepared::isCollecting() && !preparedName_.empty())
            prepared::keep(preparedName_ + kTissues, field::packTissues(made, key));
        if (!places.empty()) (void)field::writeFieldFile(places, field::encodeTissues(made, key));
        return made;
    }

    [[nodiscard]] ToothModel model(field::DistanceField field) && {
        ToothModel made{case_.name, outer_, std::move(*tree_), std::move(field)};
        made.fromCache = fromCache_;
        geometry::requireOneAVertex(outer_, case_.surfaceColours(), case_.name);
        made.colours = case_.surfaceColours();
        return made;
    }

  private:
    [[nodiscard]] std::optional<std::vector<std::byte>> preparedFile(const char* kind) const {
        return preparedName_.empty() ? std::nullopt : prepared::read(preparedName_ + kind);
    }
    /// Of those that came with the program. What it was made of had passed requireSolid().
    std::optional<field::DistanceField> preparedField() {
        const auto packed = preparedFile(kField);
        if (!packed) return std::nullopt;
        if (!tree_) tree_.emplace(outer_);
        auto found = field::unpackField(*packed, key_, *tree_, settings_.field, field::TissueSet(case_));
        if (!found) prepared::refuse(preparedName_ + kField);
        return found;
    }
    void buildParts(const core::Progress& progress) {
        for (const cases::Part& part : case_.parts) {
            const TriangleTree* tree = nullptr;
            // The enamel's part may be the whole tooth itself; alone, a part is not asked where it lies.
            if (part.mesh.triangles == outer_.triangles && part.mesh.vertices == outer_.vertices)
                tree = &*tree_;
            else if (case_.parts.size() > 1)
                tree = &trees_.emplace_back(part.mesh);
            parts_.push_back({tree, part.tissue, part.priority});
            core::report(progress, static_cast<double>(parts_.size()) / static_cast<double>(case_.parts.size()));
        }
    }

    const cases::Case& case_;
    const LoadSettings& settings_;
    const TriangleMesh& outer_;
    std::uint64_t key_ = 0;
    std::string preparedName_;  ///< empty where no cache is wanted
    std::vector<std::filesystem::path> places_;
    std::optional<TriangleTree> tree_;
    std::deque<TriangleTree> trees_;
    std::vector<field::PartSurface> parts_;
    bool fromCache_ = false;
};

}  // namespace

bool isKept(const cases::Case& toothCase, const LoadSettings& settings) {
    return Loader(toothCase, settings).isKept();
}

std::shared_ptr<const ToothModel> loadModel(const cases::Case& toothCase, const LoadSettings& settings,
                                            const core::Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    core::report(progress, 0.0);
    Loader loader(toothCase, settings);
    field::DistanceField field = loader.field(core::part(progress, 0.0, kDistancesShare));
    core::report(progress, kDistancesShare);
    field::TissueMap tissues = loader.tissues(field, core::part(progress, kDistancesShare, 1.0));
    ToothModel model = std::move(loader).model(std::move(field));
    model.buildSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    auto made = withTissues(std::move(model), std::move(tissues), settings.cut);
    core::report(progress, 1.0);
    return made;
}

}  // namespace handpiece::tooth
