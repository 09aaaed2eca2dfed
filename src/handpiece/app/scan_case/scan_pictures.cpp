// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/scan_case/scan_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::scan_case {
namespace {

constexpr double kSectionPixelMm = 0.03;
constexpr double kFinestFieldMm = 0.05, kCoarsestFieldMm = 0.1;
constexpr int kSliceWidth = 420;  ///< pixels of a slice's picture, at least
using core::Vec3;

std::array<std::uint8_t, 3> colourOf(cases::Tissue tissue) {
    return tissue == cases::Tissue::none ? std::array<std::uint8_t, 3>{90, 220, 255}
                                         : view::colourOf(tissue, view::Palette::textbook);
}

/// The scan's value at a place, trilinear.
double greyAt(const volume::Volume& v, const Vec3& mm) {
    const Vec3 at = v.grid.toVoxels(mm);
    double sum = 0.0;
    std::array<int, 3> low{};
    std::array<double, 3> part{};
    for (std::size_t a = 0; a < 3; ++a) {
        const double x = std::clamp(at[static_cast<Eigen::Index>(a)], 0.0, v.grid.size[a] - 1.0);
        low[a] = std::min(static_cast<int>(x), std::max(0, v.grid.size[a] - 2));
        part[a] = x - low[a];
    }
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        std::array<int, 3> ijk = low;
        for (std::size_t a = 0; a < 3; ++a) {
            const bool isHigh = (corner >> a & 1) != 0;
            weight *= isHigh ? part[a] : 1.0 - part[a];
            if (isHigh) ijk[a] = std::min(ijk[a] + 1, v.grid.size[a] - 1);
        }
        if (weight > 0.0) sum += weight * static_cast<double>(v.values[v.grid.index(ijk[0], ijk[1], ijk[2])]);
    }
    return sum;
}

/// A solid's value in voxel coordinates of the region, bilinear in the slice.
class SolidSlice {
  public:
    SolidSlice(const volume::Grid& grid, const std::vector<float>& distances, int axis, int at)
        : grid_(grid), distances_(distances), axis_(axis), at_(at) {}
    [[nodiscard]] double value(double u, double v) const {
        const int i = std::clamp(static_cast<int>(u), 0, std::max(0, size(0) - 2));
        const int j = std::clamp(static_cast<int>(v), 0, std::max(0, size(1) - 2));
        const double x = u - i, y = v - j;
        return (1 - x) * (1 - y) * node(i, j) + x * (1 - y) * node(i + 1, j) + (1 - x) * y * node(i, j + 1) +
               x * y * node(i + 1, j + 1);
    }
    [[nodiscard]] int size(int which) const { return grid_.size[static_cast<std::size_t>(along(which))]; }
    [[nodiscard]] Vec3 voxel(double u, double v) const {
        Vec3 ijk = Vec3::Zero();
        ijk[axis_] = at_;
        ijk[along(0)] = u;
        ijk[along(1)] = v;
        return ijk;
    }

  private:
    /// The axes of the picture: its columns and rows.
    [[nodiscard]] int along(int which) const {
        if (axis_ == 2) return which == 0 ? 0 : 1;
        if (axis_ == 1) return which == 0 ? 0 : 2;
        return which == 0 ? 1 : 2;
    }
    [[nodiscard]] double node(int i, int j) const {
        std::array<int, 3> ijk{};
        ijk[static_cast<std::size_t>(axis_)] = at_;
        ijk[static_cast<std::size_t>(along(0))] = std::min(i, size(0) - 1);
        ijk[static_cast<std::size_t>(along(1))] = std::min(j, size(1) - 1);
        return static_cast<double>(distances_[grid_.index(ijk[0], ijk[1], ijk[2])]);
    }
    const volume::Grid& grid_;
    const std::vector<float>& distances_;
    int axis_, at_;
};

NamedPicture sliceOf(const ScanResult& result, int axis) {
    const segmentation::Region& region = *result.region;
    const volume::Grid& grid = region.grid;
    // Through the middle of the tooth.
    const Vec3 middle = grid.toVoxels(result.full->outer.mesh.bounds().centre());
    const int at =
        std::clamp(static_cast<int>(std::lround(middle[axis])), 0, grid.size[static_cast<std::size_t>(axis)] - 1);
    std::vector<std::pair<cases::Tissue, SolidSlice>> solids;
    solids.emplace_back(cases::Tissue::none, SolidSlice(grid, region.outer.distanceMm, axis, at));
    for (const segmentation::Solid& s : region.solids)
        solids.emplace_back(s.tissue, SolidSlice(grid, s.distanceMm, axis, at));
    const SolidSlice& outer = solids.front().second;
    const int scale = std::max(1, (kSliceWidth + outer.size(0) - 1) / outer.size(0));
    NamedPicture made;
    made.image.width = scale * outer.size(0);
    made.image.height = scale * outer.size(1);
    made.image.rgba.resize(4 * static_cast<std::size_t>(made.image.width) *
                           static_cast<std::size_t>(made.image.height));
    const segmentation::Thresholds& t = region.thresholds;
    const double low = std::min(static_cast<double>(t.outside), static_cast<double>(t.pulp));
    const double high = static_cast<double>(t.enamel) + 0.25 * (static_cast<double>(t.enamel) - low);
    for (int y = 0; y < made.image.height; ++y)
        for (int x = 0; x < made.image.width; ++x) {
            const double u = (x + 0.5) / scale - 0.5;
            // Slices across stand as in the scan, rows downwards; the other two with the slices' order upwards.
            const double v = axis == 2 ? (y + 0.5) / scale - 0.5 : outer.size(1) - 0.5 - (y + 0.5) / scale;
            std::uint8_t* pixel =
                &made.image.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(made.image.width) +
                                      static_cast<std::size_t>(x))];
            std::array<double, 3> colour{};
            if (!result.labels) {
                const double grey = 255.0 * (greyAt(result.scan->volume, grid.toMm(outer.voxel(u, v))) - low) /
                                    std::max(high - low, 1e-9);
                colour.fill(std::clamp(grey, 0.0, 255.0));
            }
            cases::Tissue inside = cases::Tissue::none;
            std::optional<std::array<std::uint8_t, 3>> line;
            for (const auto& [tissue, slice] : solids) {
                const double mm =
                    slice.value(std::clamp(u, 0.0, outer.size(0) - 1.0), std::clamp(v, 0.0, outer.size(1) - 1.0));
                if (mm > 0.0) inside = tissue == cases::Tissue::none ? cases::Tissue::enamel : tissue;
                // A line of about one and a half pixels.
                if (std::abs(mm) < 0.75 * grid.spacingMm.x() / scale) line = colourOf(tissue);
            }
            if (result.labels && inside != cases::Tissue::none) {
                const auto own = colourOf(inside);
                for (std::size_t c = 0; c < 3; ++c)
                    colour[c] = 0.6 * own[c];
            }
            for (std::size_t c = 0; c < 3; ++c)
                pixel[c] = line ? (*line)[c] : static_cast<std::uint8_t>(colour[c]);
            pixel[3] = 255;
        }
    constexpr std::array<const char*, 3> kAcross{"columns", "rows", "slices"};
    made.caption = fmt::format("across the scan's {}, through the middle of the tooth; {:.1f} mm wide",
                               kAcross[static_cast<std::size_t>(axis)], outer.size(0) * grid.spacingMm.x());
    return made;
}

class Artist {
  public:
    Artist(const cases::Case& toothCase, double voxelMm, int width, int height, const core::Progress& progress)
        : standing_(view::standingOf(toothCase.fdiNumber, toothCase.buccalSign)), viewport_{width, height} {
        simulation::SimulationSettings settings;
        settings.field.voxelMm = voxelMm;
        settings.tissues = toothCase.tissues;
        const simulation::SimulationSetup station =
            simulation::makeSimulation(toothCase, std::move(settings), false, core::part(progress, 0.0, 0.6));
        live_ =
            std::make_unique<simulation::LiveTooth>(station.tooth, tooth::StateDelta{}, core::part(progress, 0.6, 0.8));
        bounds_ = station.tooth->outer.bounds();
        renderer_.setTooth(bounds_);
        renderer_.updateBricks(live_->uncutSurface(), true);
        renderer_.setParts(toothCase.parts);
        renderer_.setScenery(toothCase.scenery);
        look_.quality = view::Quality::fine;
        look_.palette = view::Palette::textbook;
        look_.bur = look_.turbine = look_.debris = look_.spray = false;
        look_.scaleBar = true;
        look_.backgroundTop = look_.backgroundBottom = {236, 239, 243};
        look_.visible[static_cast<std::size_t>(cases::Tissue::neighbour)] = false;
        look_.visible[static_cast<std::size_t>(cases::Tissue::bone)] = false;
        look_.visible[static_cast<std::size_t>(cases::Tissue::gum)] = false;
        moment_.burShown = false;
    }
    NamedPicture view(view::StandardView from, std::string caption) {
        return drawn(view::standardView(from, bounds_, standing_, viewport_), std::move(caption));
    }
    NamedPicture section(const Vec3& normal, view::StandardView from, std::string caption) {
        const view::Camera camera = view::standardView(from, bounds_, standing_, viewport_);
        const Vec3 towards = normal.dot(camera.forward()) > 0.0 ? Vec3(-normal) : normal;
        const view::Plane plane{towards, towards.dot(bounds_.centre())};
        const measure::Section s = live_->withProbe([&](const measure::ToothProbe& probe) {
            return probe.section(plane.normal, plane.offsetMm, kSectionPixelMm);
        });
        renderer_.setSectionFace(
            {plane, s.originMm, s.uAxis, s.vAxis, s.mmPerPixel, s.width, s.height, s.tissue, s.away});
        look_.cutAway = plane;
        look_.sectionGrid = true;
        NamedPicture made = drawn(camera, std::move(caption));
        look_.cutAway.reset();
        look_.sectionGrid = false;
        return made;
    }
    NamedPicture scenery(const std::vector<cases::Part>& parts) {
        core::Box all = bounds_;
        for (const cases::Part& part : parts)
            for (const Vec3& v : part.mesh.vertices)
                all.extend(v);
        for (const cases::Tissue t : {cases::Tissue::neighbour, cases::Tissue::bone, cases::Tissue::gum})
            look_.visible[static_cast<std::size_t>(t)] = true;
        return drawn(view::standardView(view::StandardView::buccal, all, standing_, viewport_),
                     "with what stands around it");
    }

  private:
    NamedPicture drawn(const view::Camera& camera, std::string caption) {
        NamedPicture made;
        made.caption = std::move(caption);
        constexpr int kMaxDrawings = 8;  // until it no longer gets finer
        for (int i = 0; i < kMaxDrawings; ++i)
            if (!renderer_.draw(camera, viewport_, look_, moment_, made.image).refining) break;
        return made;
    }
    view::Renderer renderer_;
    std::unique_ptr<simulation::LiveTooth> live_;
    core::Box bounds_;
    view::Standing standing_;
    view::Viewport viewport_;
    view::Look look_;
    view::Moment moment_;
};

}  // namespace

std::vector<NamedPicture> slicesOf(const ScanResult& result) {
    std::vector<NamedPicture> pictures;
    for (const int axis : {2, 1, 0})
        pictures.push_back(sliceOf(result, axis));
    return pictures;
}

std::vector<NamedPicture> viewsOf(const ScanResult& result, int width, int height, const core::Progress& progress) {
    const auto finest = std::max_element(result.cases.begin(), result.cases.end(),
                                         [](const auto& a, const auto& b) { return a.percent < b.percent; });
    using view::StandardView;
    // Half the scan's voxel shows all that it holds.
    const double voxelMm = std::clamp(0.5 * result.region->grid.spacingMm.x(), kFinestFieldMm, kCoarsestFieldMm);
    Artist artist(finest->toothCase, voxelMm, width, height, core::part(progress, 0.0, 0.8));
    const bool isGuessed = result.placed.isMesialGuessed;
    std::vector<NamedPicture> pictures;
    for (const auto& [from, name] : view::standardViews())
        pictures.push_back(artist.view(
            from,
            fmt::format(
                "{}{}", name,
                isGuessed && from != StandardView::occlusal && from != StandardView::oblique ? " (as guessed)" : "")));
    core::report(progress, 0.9);
    pictures.push_back(
        artist.section(Vec3::UnitX(), StandardView::mesial, "cut open across mesial, lines every millimetre"));
    pictures.push_back(
        artist.section(Vec3::UnitY(), StandardView::buccal, "cut open across buccal, lines every millimetre"));
    if (!finest->toothCase.scenery.empty()) pictures.push_back(artist.scenery(finest->toothCase.scenery));
    core::report(progress, 1.0);
    return pictures;
}

}  // namespace handpiece::scan_case
