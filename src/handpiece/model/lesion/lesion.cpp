// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/lesion/lesion.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/decimate.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/model/case/fdi.h"
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

/// Each of a list with commas.
template <class Visit>
void eachOf(std::string_view text, const Visit& visit) {
    while (!text.empty()) {
        const std::string_view one = text.substr(0, text.find(','));
        visit(one);
        text.remove_prefix(std::min(text.size(), one.size() + 1));
    }
}

Lesion lesionByName(std::string_view one) {
    const std::size_t colon = one.find(':');
    if (colon == std::string_view::npos)
        throw core::Error(fmt::format("\"{}\" is no lesion", one.substr(0, 60)), "--lesion",
                          "give SURFACE:DEPTH, as occlusal:D2");
    const Lesion lesion{byName<Surface>(one.substr(0, colon), kSurfaces, "surface"),
                        byName<Finding>(one.substr(colon + 1), kFindings, "depth or finding")};
    if (lesion.surface == Surface::root && lesion.finding <= Finding::e2)
        throw core::Error("a root has no enamel", "--lesion", "give D1, D2 or D3");
    return lesion;
}

}  // namespace

std::vector<Lesion> lesionsByName(std::string_view text) {
    std::vector<Lesion> lesions;
    eachOf(text, [&](std::string_view one) { lesions.push_back(lesionByName(one)); });
    return lesions;
}

MouthLesions mouthLesionsByName(std::string_view text) {
    MouthLesions lesions;
    eachOf(text, [&](std::string_view one) {
        int fdi = 0;
        const char* const end = one.data() + one.size();
        const auto [colon, problem] = std::from_chars(one.data(), end, fdi);
        if (problem != std::errc() || colon == end || *colon != ':')
            throw core::Error(fmt::format("\"{}\" is no lesion of a tooth", one.substr(0, 60)), "--lesion",
                              "give FDI:SURFACE:DEPTH, as 46:occlusal:D2");
        if (!cases::isPermanentTooth(fdi))
            throw core::Error(fmt::format("{} is no permanent tooth", fdi), "--lesion", "give 11 to 48");
        lesions[fdi].push_back(lesionByName(one.substr(static_cast<std::size_t>(colon - one.data()) + 1)));
    });
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
    if (!deposits.empty()) {
        tooth.outerColours = geometry::coloursFrom(tooth.surface(), tooth.surfaceColours(), outer);
        tooth.outer = std::move(outer);
    }
    std::move(added.begin(), added.end(), std::back_inserter(tooth.parts));
    core::report(progress, 1.0);
}

void addLesions(cases::Case& mouth, const MouthLesions& lesions, const Options& options,
                const core::Progress& progress) {
    std::vector<std::pair<cases::Tooth*, const std::vector<Lesion>*>> teeth;
    for (const auto& [fdi, found] : lesions) {
        cases::Tooth* tooth = mouth.fdiNumber == fdi ? &mouth : nullptr;
        for (cases::PlacedTooth& other : mouth.others)
            if (other.fdiNumber == fdi) tooth = &other;
        if (tooth == nullptr)
            throw core::Error(fmt::format("the mouth has no tooth {}", fdi), "--lesion", "give one of its FDI numbers");
        teeth.emplace_back(tooth, &found);
    }
    for (std::size_t i = 0; i < teeth.size(); ++i) {
        Options own = options;
        own.seed = options.seed * 100 + static_cast<std::uint64_t>(teeth[i].first->fdiNumber);
        const auto count = static_cast<double>(teeth.size());
        addLesions(*teeth[i].first, *teeth[i].second, own,
                   core::part(progress, static_cast<double>(i) / count, static_cast<double>(i + 1) / count));
    }
}

}  // namespace handpiece::lesion
