// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/field_builder.h"

#include <fmt/format.h>

#include <atomic>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"

namespace handpiece::field {

using core::Vec3;

namespace {
constexpr double kMaxDenseBricks = 1 << 25;          // 0.3 GB of index, coarse value and tissue
constexpr std::size_t kMaxStoredBricks = 2'900'000;  // keeps 729 x index within 31 bits, for kernels
}  // namespace

FieldBuilder::FieldBuilder(const core::Box& box, const FieldSettings& settings) {
    const auto refuse = [](const std::string& what, const std::string& remedy) {
        throw core::Error(what, "distance field", remedy);
    };
    if (!(settings.voxelMm > 0.0) || !std::isfinite(settings.voxelMm))
        refuse(fmt::format("a voxel of {} mm makes no grid", settings.voxelMm), "0.025 to 0.1 mm suit a tooth");
    for (const double band : {settings.bandInMm, settings.bandOutMm})
        if (!(band >= 0.0) || !std::isfinite(band))
            refuse(fmt::format("a band of {} mm makes no grid", band), "give 0 or more");
    if (box.isEmpty() || !box.min.allFinite() || !box.max.allFinite())
        refuse("the box to cover is empty or not finite", "");
    field_.settings = settings;
    const double edge = brickMm();
    double total = 1.0;
    for (int k = 0; k < 3; ++k) {
        const double count = std::max(1.0, std::ceil((box.max[k] - box.min[k]) / edge));
        total *= count;
        if (!(total <= kMaxDenseBricks))
            refuse(fmt::format("{:.3g} x {:.3g} x {:.3g} mm at a voxel of {} mm needs too many bricks", box.size().x(),
                               box.size().y(), box.size().z(), settings.voxelMm),
                   "check the unit of the mesh (millimetres), or take larger voxels");
        field_.bricks[k] = static_cast<std::int32_t>(count);
        field_.originMm[k] = 0.5 * (box.min[k] + box.max[k]) - 0.5 * count * edge;
    }
    const auto dense = static_cast<std::size_t>(total);
    field_.brickIndex.assign(dense, -1);
    field_.coarse.assign(dense, 0.0f);
    coarseTissues_.assign(dense, static_cast<std::uint8_t>(cases::Tissue::none));
}

Vec3 FieldBuilder::nodeMm(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const double h = field_.settings.voxelMm;
    return field_.originMm + Vec3(h * static_cast<double>(x), h * static_cast<double>(y), h * static_cast<double>(z));
}

std::array<std::int32_t, 3> FieldBuilder::brickAt(std::size_t dense) const {
    const auto nx = static_cast<std::size_t>(field_.bricks[0]), ny = static_cast<std::size_t>(field_.bricks[1]);
    return {static_cast<std::int32_t>(dense % nx), static_cast<std::int32_t>(dense / nx % ny),
            static_cast<std::int32_t>(dense / (nx * ny))};
}

Vec3 FieldBuilder::centreMm(std::size_t dense) const {
    const auto [x, y, z] = brickAt(dense);
    constexpr int kHalf = kBrickCells / 2;
    return nodeMm(kBrickCells * std::int64_t{x} + kHalf, kBrickCells * std::int64_t{y} + kHalf,
                  kBrickCells * std::int64_t{z} + kHalf);
}

std::int32_t FieldBuilder::storedAt(const std::array<std::int32_t, 3>& brick) const {
    for (std::size_t k = 0; k < 3; ++k)
        if (brick[k] < 0 || brick[k] >= field_.bricks[k]) return -1;
    const auto nx = static_cast<std::size_t>(field_.bricks[0]), ny = static_cast<std::size_t>(field_.bricks[1]);
    return field_.brickIndex[static_cast<std::size_t>(brick[0]) +
                             nx * (static_cast<std::size_t>(brick[1]) + ny * static_cast<std::size_t>(brick[2]))];
}

FieldBuilder FieldBuilder::around(const core::Box& surface, const FieldSettings& settings) {
    // One voxel more than the band, so that the outermost nodes of it have neighbours.
    return {surface.grown(std::max(0.0, settings.bandOutMm) + std::max(0.0, settings.voxelMm)), settings};
}

bool FieldBuilder::isStored(float centreDistanceMm) const {
    // A distance changes by no more than the way gone: beyond half the diagonal the band cannot reach into the brick.
    const double above = field_.settings.bandOutMm + halfDiagonalMm(),
                 below = field_.settings.bandInMm + halfDiagonalMm();
    return centreDistanceMm <= above && centreDistanceMm >= -below;
}

void FieldBuilder::classify(const std::function<double(std::size_t)>& centreDistance) {
    core::parallelFor(denseBricks(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            field_.coarse[i] = static_cast<float>(centreDistance(i));
            field_.brickIndex[i] = isStored(field_.coarse[i]) ? 0 : -1;
        }
    });
}

void FieldBuilder::store() {
    stored_.clear();
    for (std::size_t i = 0; i < denseBricks(); ++i) {
        if (field_.brickIndex[i] < 0) continue;
        field_.brickIndex[i] = static_cast<std::int32_t>(stored_.size());
        stored_.push_back(static_cast<std::uint32_t>(i));
    }
    if (stored_.size() > kMaxStoredBricks)
        throw core::Error(fmt::format("{} bricks would be stored, more than the {} there is room for", stored_.size(),
                                      kMaxStoredBricks),
                          "distance field", "take larger voxels or a narrower band");
    field_.values.resize(stored_.size() * kBrickValues);
    tissues_.resize(stored_.size() * kBrickValues);
}

DistanceField FieldBuilder::finish() && {
    auto tissues = std::make_shared<BrickTissues>(denseBricks());
    for (std::size_t i = 0; i < denseBricks(); ++i)
        tissues->setUniform(i, coarseTissues_[i]);
    for (std::size_t i = 0; i < stored_.size(); ++i) {
        const std::uint8_t* nodes = &tissues_[i * kBrickValues];
        if (std::all_of(nodes, nodes + kBrickValues, [nodes](std::uint8_t t) { return t == *nodes; }))
            tissues->setUniform(stored_[i], *nodes);
        else
            tissues->addMixed(stored_[i], nodes);
    }
    field_.tissues = std::move(tissues);
    return DistanceField(std::move(field_));
}

DistanceField DistanceField::fromFunction(const core::Box& box, const FieldSettings& settings,
                                          const std::function<double(const Vec3&)>& signedDistance,
                                          const std::function<cases::Tissue(const Vec3&)>& tissue,
                                          const core::Progress& progress) {
    FieldBuilder builder(box, settings);
    builder.classify([&](std::size_t dense) { return signedDistance(builder.centreMm(dense)); });
    core::report(progress, 0.1);
    builder.store();
    core::parallelFor(builder.denseBricks(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            if (builder.coarse(i) < 0.0f)
                builder.setCoarseTissue(i, tissue ? tissue(builder.centreMm(i)) : cases::Tissue::enamel);
    });
    std::atomic<std::size_t> done{0};
    const std::size_t count = builder.storedBricks().size();
    core::parallelFor(count, 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto [bx, by, bz] = builder.brickAt(builder.storedBricks()[i]);
            float* value = builder.values(i);
            std::uint8_t* kind = builder.tissues(i);
            for (int z = 0; z < kBrickNodes; ++z)
                for (int y = 0; y < kBrickNodes; ++y)
                    for (int x = 0; x < kBrickNodes; ++x) {
                        const Vec3 p =
                            builder.nodeMm(kBrickCells * std::int64_t{bx} + x, kBrickCells * std::int64_t{by} + y,
                                           kBrickCells * std::int64_t{bz} + z);
                        *value++ = static_cast<float>(signedDistance(p));
                        *kind++ = static_cast<std::uint8_t>(tissue ? tissue(p) : cases::Tissue::enamel);
                    }
        }
        core::report(progress, 0.1 + 0.9 * static_cast<double>(done += end - begin) / static_cast<double>(count));
    });
    return std::move(builder).finish();
}

}  // namespace handpiece::field
