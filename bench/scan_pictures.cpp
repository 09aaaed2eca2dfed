// SPDX-License-Identifier: Apache-2.0
#include "scan_pictures.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "handpiece/senses/view/image.h"

namespace handpiece::bench {
namespace {

using core::Vec3;

constexpr int kSlices = 5;
constexpr int kLongestPixels = 420;

struct Colour {
    std::uint8_t red, green, blue;
};

/// Where a slice lies: u across, v up, both axes of the grid.
struct Plane {
    int u, v, across;
    int at;
};

/// Grey values of the volume's own spread: all but one in two hundred.
std::pair<float, float> window(const volume::Volume& volume) {
    std::vector<float> some;
    const std::size_t step = std::max<std::size_t>(1, volume.values.size() / 200000);
    for (std::size_t n = 0; n < volume.values.size(); n += step)
        some.push_back(volume.values[n]);
    std::sort(some.begin(), some.end());
    const float low = some[some.size() / 200], high = some[some.size() - 1 - some.size() / 200];
    return {low, high > low ? high : low + 1.0f};
}

/// The nearest voxel's value, or what is told outside the grid.
template <class T>
T nearest(const volume::Grid& grid, const std::vector<T>& values, const Vec3& mm, T outside) {
    const Vec3 p = grid.toVoxels(mm);
    int at[3];
    for (int a = 0; a < 3; ++a) {
        at[a] = static_cast<int>(std::lround(p[a]));
        if (at[a] < 0 || at[a] >= grid.size[static_cast<std::size_t>(a)]) return outside;
    }
    return values[grid.index(at[0], at[1], at[2])];
}

class Painter {
  public:
    Painter(const volume::Volume& volume, const volume::Labels* truth, const segmentation::Region& region)
        : volume_(volume), truth_(truth), region_(region), window_(window(volume)) {}

    void paint(const Plane& plane, view::Image& image, int left, int width, int height, double scale) const {
        std::vector<Vec3> places(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                Vec3 ijk;
                ijk[plane.u] = (x + 0.5) / scale - 0.5;
                ijk[plane.v] = (height - 1 - y + 0.5) / scale - 0.5;
                ijk[plane.across] = plane.at;
                const Vec3 mm = volume_.grid.toMm(ijk);
                places[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
                    mm;
                const float value = nearest(volume_.grid, volume_.values, mm, window_.first);
                const auto grey = static_cast<std::uint8_t>(
                    std::clamp(255.0f * (value - window_.first) / (window_.second - window_.first), 0.0f, 255.0f));
                set(image, left + x, y, {grey, grey, grey});
            }
        if (truth_ != nullptr)
            outline(image, left, width, height, {60, 220, 60}, [&](std::size_t n) {
                return static_cast<int>(nearest(truth_->grid, truth_->values, places[n], std::uint8_t{0}));
            });
        const auto paintSolid = [&](const segmentation::Solid& solid, Colour colour) {
            outline(image, left, width, height, colour, [&](std::size_t n) {
                return nearest(region_.grid, solid.distanceMm, places[n], 1.0f) < 0.0f ? 1 : 0;
            });
        };
        paintSolid(region_.outer, {255, 60, 60});
        for (const segmentation::Solid& solid : region_.solids)
            paintSolid(solid, solid.tissue == cases::Tissue::dentine ? Colour{255, 150, 30}
                              : solid.tissue == cases::Tissue::pulp  ? Colour{255, 60, 255}
                                                                     : Colour{255, 255, 60});
    }

  private:
    static void set(view::Image& image, int x, int y, Colour c) {
        std::uint8_t* to = &image.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                            static_cast<std::size_t>(x))];
        to[0] = c.red;
        to[1] = c.green;
        to[2] = c.blue;
        to[3] = 255;
    }
    template <class F>
    static void outline(view::Image& image, int left, int width, int height, Colour colour, F&& labelAt) {
        std::vector<int> labels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
        for (std::size_t n = 0; n < labels.size(); ++n)
            labels[n] = labelAt(n);
        for (int y = 0; y + 1 < height; ++y)
            for (int x = 0; x + 1 < width; ++x) {
                const std::size_t n =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
                if (labels[n] != labels[n + 1] || labels[n] != labels[n + static_cast<std::size_t>(width)])
                    set(image, left + x, y, colour);
            }
    }

    const volume::Volume& volume_;
    const volume::Labels* truth_;
    const segmentation::Region& region_;
    std::pair<float, float> window_;
};

}  // namespace

void writePictures(const std::filesystem::path& folder, const std::string& name, const volume::Volume& volume,
                   const volume::Labels* truth, const segmentation::Region& region) {
    std::filesystem::create_directories(folder);
    const Painter painter(volume, truth, region);
    constexpr const char* kNames[] = {"x", "y", "z"};
    for (int across = 0; across < 3; ++across) {
        Plane plane{across == 0 ? 1 : 0, across == 2 ? 1 : 2, across, 0};
        const auto along = [&](int axis) { return volume.grid.size[static_cast<std::size_t>(axis)]; };
        const double scale =
            std::max(1.0, std::floor(static_cast<double>(kLongestPixels) / std::max(along(plane.u), along(plane.v))));
        const int width = static_cast<int>(along(plane.u) * scale), height = static_cast<int>(along(plane.v) * scale);
        view::Image image;
        image.width = kSlices * width;
        image.height = height;
        image.rgba.assign(4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(height), 0);
        for (int slice = 0; slice < kSlices; ++slice) {
            plane.at = along(across) * (slice + 1) / (kSlices + 1);
            painter.paint(plane, image, slice * width, width, height, scale);
        }
        view::writePng(image, folder / (name + "-" + kNames[across] + ".png"));
    }
}

}  // namespace handpiece::bench
