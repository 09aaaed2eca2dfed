// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/lesion/lesion.h"

#include <fmt/format.h>

#include <algorithm>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/decimate.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/model/lesion/parts.h"

namespace handpiece::lesion {
namespace {

template <class Kind, std::size_t N>
Kind byName(std::string_view word, const std::array<std::string_view, N>& names, std::string_view what) {
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end())
        throw core::Error(fmt::format("there is no {} \"{}\"", what, word), "--lesion",
                          fmt::format("one of {}", fmt::join(names, ", ")));
    return static_cast<Kind>(found - names.begin());
}

std::string nameOf(const Lesion& lesion) {
    return fmt::format("{}-{}", kSurfaces[static_cast<std::size_t>(lesion.surface)],
                       kFindings[static_cast<std::size_t>(lesion.finding)]);
}

/// The tooth with what lies on it, as finely meshed as before.
geometry::TriangleMesh thickened(const Surfaces& surfaces, const cases::Tooth& tooth, std::span<const Deposit> deposits,
                                 const core::Progress& progress) {
    geometry::IsosurfaceSettings settings;
    settings.lipschitz = 4.0;  // a ragged deposit's edge falls by up to three in one
    settings.spacingMm = 0.085;
    const auto f = [&](const core::Vec3& p) {
        const double outer = surfaces.outer(p);
        double over = 0.0;
        for (const Deposit& d : deposits)
            over = std::max(over, d.thicknessMm(p));
        return outer - over;
    };
    return geometry::decimate(geometry::isosurface(tooth.outer.bounds().grown(0.8), f, settings, progress),
                              tooth.outer.triangles.size())
        .mesh;
}

}  // namespace

std::vector<Lesion> lesionsByName(std::string_view text) {
    std::vector<Lesion> lesions;
    while (!text.empty()) {
        const std::string_view one = text.substr(0, text.find(','));
        const std::size_t colon = one.find(':');
        if (colon == std::string_view::npos)
            throw core::Error(fmt::format("\"{}\" is no lesion", one), "--lesion",
                              "give SURFACE:DEPTH, as occlusal:D2");
        const Lesion lesion{byName<Surface>(one.substr(0, colon), kSurfaces, "surface"),
                            byName<Finding>(one.substr(colon + 1), kFindings, "depth or finding")};
        if (lesion.surface == Surface::root && lesion.finding <= Finding::e2)
            throw core::Error("a root has no enamel", "--lesion", "give D1, D2 or D3");
        lesions.push_back(lesion);
        text.remove_prefix(std::min(text.size(), one.size() + 1));
    }
    return lesions;
}

DepthClass depthClassOf(Finding finding) noexcept {
    constexpr std::array<DepthClass, 5> kClasses = {{{false, 0.0, 0.5},
                                                     {false, 0.5, 1.0},
                                                     {true, 0.0, 1.0 / 3.0},
                                                     {true, 1.0 / 3.0, 2.0 / 3.0},
                                                     {true, 2.0 / 3.0, 1.0}}};
    const auto i = static_cast<std::size_t>(finding);
    return i < kClasses.size() ? kClasses[i] : DepthClass{};
}

void addLesions(cases::Tooth& tooth, std::span<const Lesion> lesions, const Options& options,
                const core::Progress& progress) {
    if (lesions.empty()) return;
    const Surfaces surfaces(tooth);
    std::vector<cases::Part> added;
    std::vector<Deposit> deposits;
    for (std::size_t i = 0; i < lesions.size(); ++i) {
        if (lesions[i].finding == Finding::calculus) {
            deposits.push_back(depositAt(surfaces, tooth, lesions[i].surface, options, i));
            added.push_back(partOf(surfaces, deposits.back(), nameOf(lesions[i]), options));
        } else {
            for (cases::Part& part : partsOf(surfaces, tooth, lesions[i], options, i))
                added.push_back(std::move(part));
        }
        core::report(progress, static_cast<double>(i + 1) / static_cast<double>(lesions.size() + 1));
    }
    geometry::TriangleMesh outer;
    if (!deposits.empty()) outer = thickened(surfaces, tooth, deposits, {});
    if (!deposits.empty()) tooth.outer = std::move(outer);
    std::move(added.begin(), added.end(), std::back_inserter(tooth.parts));
    core::report(progress, 1.0);
}

}  // namespace handpiece::lesion
