// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a ReviewGatherer has seen, before it is written for a page. Private to this room.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/app/report/artist.h"
#include "handpiece/app/report/review.h"
#include "handpiece/app/report/review_around.h"
#include "handpiece/app/report/review_data.h"
#include "handpiece/model/field/brick_index.h"

namespace handpiece::report {

/// Of distances in eight bits: what stands for 0, and how far from it the others reach.
inline constexpr int kMiddle = 128, kMost = 127;
/// Steps a voxel of the page's grid: eight bits reach two and a half voxels.
inline constexpr double kStepsAVoxel = 50.0;

[[nodiscard]] inline std::uint8_t eightBits(double value, double steps) {
    const double rounded = std::floor(value * steps + 0.5);
    return static_cast<std::uint8_t>(std::clamp(rounded, static_cast<double>(-kMost), static_cast<double>(kMost)) +
                                     kMiddle);
}

/// Bricks of the tooth's field on the page's grid: each brings `edge`^3 nodes of its own.
struct PageGrid {
    explicit PageGrid(const field::FieldView& of);
    /// Nodes of both lie at the same places.
    [[nodiscard]] bool isAs(const field::FieldView& other) const;
    [[nodiscard]] double voxelMm() const { return view.voxelMm * stride; }
    [[nodiscard]] std::size_t bricks() const {
        return static_cast<std::size_t>(view.bricks[0]) * static_cast<std::size_t>(view.bricks[1]) *
               static_cast<std::size_t>(view.bricks[2]);
    }
    [[nodiscard]] std::size_t perBrick() const {
        return static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge);
    }
    [[nodiscard]] core::Vec3 placeMm(int x, int y, int z) const {
        return core::Vec3(view.originMm[0], view.originMm[1], view.originMm[2]) + voxelMm() * core::Vec3(x, y, z);
    }
    /// Calls f(x, y, z of the grid, number in the brick) for its own nodes; at the upper ends of the grid those of the
    /// brick's upper faces too.
    template <class F>
    void eachNode(std::uint32_t dense, F&& f) const {
        const auto brick = field::brickAt(view.bricks, dense);
        std::array<int, 3> end{};
        for (std::size_t k = 0; k < 3; ++k)
            end[k] = brick[k] + 1 == view.bricks[k] ? edge + 1 : edge;
        for (int z = 0; z < end[2]; ++z)
            for (int y = 0; y < end[1]; ++y)
                for (int x = 0; x < end[0]; ++x)
                    f(brick[0] * edge + x, brick[1] * edge + y, brick[2] * edge + z,
                      static_cast<std::size_t>(stride * (x + field::kBrickNodes * (y + field::kBrickNodes * z))));
    }

    field::FieldView view;
    int stride = 1, edge = field::kBrickCells;
    std::array<std::int32_t, 3> nodes{};

  private:
    [[nodiscard]] std::int32_t nodesAlong(std::size_t k) const;
    [[nodiscard]] bool isTooLarge() const;
};

struct ChangedAt {
    double timeS = 0.0;
    std::vector<std::uint32_t> bricks;  ///< rising
    std::vector<std::uint8_t> changes;  ///< of each its edge^3 nodes: now less before, modulo 256
};
/// Times are of the whole chain from here on.
struct Pose {
    double timeS;
    core::Vec3 placeMm;
    std::array<double, 4> turn;
};
/// A session of a chain.
struct Sitting {
    std::string name;
    double fromS = 0.0, lengthS = 0.0;
    std::uint64_t lastTick = 0;
};
struct Moment {
    double timeS;
    std::string text;
};
struct Stroke {
    double fromS, toS;
};

struct Gathered {
    Gathered(std::size_t ofEach, const tasks::Task* task);
    void follow(const simulation::SessionPlayer& next, const std::string& name, std::optional<std::uint64_t> untilTick);
    void look();

    [[nodiscard]] double durationS() const {
        return sittings.empty() ? 0.0 : sittings.back().fromS + sittings.back().lengthS;
    }
    [[nodiscard]] std::uint8_t coded(float distanceMm) const {
        return eightBits(static_cast<double>(distanceMm) / grid->voxelMm(), kStepsAVoxel);
    }

    const std::size_t picturesOfEach;
    std::optional<cases::View> view;
    const simulation::SessionPlayer* player = nullptr;  ///< of the session that is played
    std::shared_ptr<const tooth::ToothModel> model;
    std::optional<PageGrid> grid;
    int buccalSign = 1;
    bool isUpper = false;
    std::uint64_t caseKey = 0;
    std::vector<std::string> notes;
    Around around;
    std::vector<Sitting> sittings;
    std::vector<Moment> moments;
    std::vector<Stroke> strokes;
    std::vector<simulation::PlotPoint> points;
    Volume uncut, tissue, now;
    std::vector<bool> isChanged, everChanged;  ///< by dense brick
    std::vector<ChangedAt> keys;
    std::vector<Pose> poses;
    std::vector<std::pair<double, std::shared_ptr<const instrument::Bur>>> burs;
    std::optional<Artist> artist;
    std::vector<Review::Picture> pictures;
    std::size_t looks = 0, picturesNow = 0, picturesAtKey = 0;

  private:
    void takeTooth(const simulation::SessionPlayer& of);
    void addEvents();
    void lookAtTooth(double timeS);
    void draw(double timeS);
    /// Of the uncut tooth.
    [[nodiscard]] std::pair<core::Vec3, core::Vec3> toothBoundsMm() const;
};

}  // namespace handpiece::report
