// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/tooth/tooth_model.h"

#include <fmt/format.h>

#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/brick_index.h"

namespace handpiece::tooth {
namespace {

constexpr int kStride[3] = {1, field::kBrickNodes, field::kBrickNodes* field::kBrickNodes};
constexpr double kMaxBandMm = 1.0;
constexpr std::size_t kReserveBytes = std::size_t{256} << 20;

/// How far a centre's value reaches: a bound of the signed distance at node (x, y, z) of a brick.
float boundAt(float centre, const int (&node)[3], double voxelMm) noexcept {
    const double dx = node[0] - field::kBrickCells / 2, dy = node[1] - field::kBrickCells / 2,
                 dz = node[2] - field::kBrickCells / 2;
    const double away = voxelMm * std::sqrt(dx * dx + dy * dy + dz * dz);
    // A hair less than the triangle inequality gives, for the rounding of the centre's value to float.
    const auto magnitude = static_cast<float>(std::max(0.0, std::abs(double{centre}) * (1.0 - 1e-6) - away));
    return centre < 0.0f ? -magnitude : magnitude;
}

/// The value of a node that several bricks hold: that of a stored one, else the tightest of their bounds.
float sharedValue(const field::FieldView& field, const std::array<std::int32_t, 3>& brick,
                  const int (&node)[3]) noexcept {
    float best = 0.0f;
    bool any = false;
    for (int corner = 0; corner < 8; ++corner) {
        std::array<std::int32_t, 3> other = brick;
        int there[3] = {node[0], node[1], node[2]};
        bool holds = true;
        for (std::size_t k = 0; k < 3; ++k) {
            if ((corner >> k & 1) == 0) continue;
            holds = holds && (node[k] == 0 || node[k] == field::kBrickCells);
            other[k] += node[k] == 0 ? -1 : 1;
            there[k] = field::kBrickCells - node[k];
            holds = holds && other[k] >= 0 && other[k] < field.bricks[k];
        }
        if (!holds) continue;
        const std::uint32_t dense = field::denseOf(field.bricks, other);
        if (const std::int32_t stored = field.brickIndex[dense]; stored >= 0)
            return field.values[static_cast<std::size_t>(stored) * field::kBrickValues +
                                static_cast<std::size_t>(there[0] + kStride[1] * there[1] + kStride[2] * there[2])];
        const float bound = boundAt(field.coarse[dense], there, field.voxelMm);
        if (!any || std::abs(bound) > std::abs(best)) best = bound;
        any = true;
    }
    return best;
}

}  // namespace

void ToothModel::uncutBrick(std::uint32_t dense, float* out) const noexcept {
    const field::FieldView view = field.view();
    const auto low = static_cast<float>(-settings.bandMm), high = static_cast<float>(bandOutMm);
    if (const std::int32_t stored = view.brickIndex[dense]; stored >= 0) {
        const float* values = view.values + static_cast<std::size_t>(stored) * field::kBrickValues;
        for (int i = 0; i < field::kBrickValues; ++i) {
            const float up = values[i] < low ? low : values[i];
            out[i] = up > high ? high : up;
        }
        return;
    }
    // A brick that is not stored lies deeper than the field's own band, all of it.
    if (view.coarse[dense] < 0.0f && settings.bandMm <= field.settings().bandInMm * (1.0 - 1e-4)) {
        std::fill_n(out, field::kBrickValues, low);
        return;
    }
    const std::array<std::int32_t, 3> brick = field::brickAt(view.bricks, dense);
    int node[3];
    for (node[2] = 0; node[2] < field::kBrickNodes; ++node[2])
        for (node[1] = 0; node[1] < field::kBrickNodes; ++node[1])
            for (node[0] = 0; node[0] < field::kBrickNodes; ++node[0])
                *out++ = std::clamp(sharedValue(view, brick, node), low, high);
}

TissueVolumes integrateVolumes(const ToothModel& model,
                               const std::function<const float*(std::uint32_t dense)>& valuesOf) {
    const field::FieldView field = model.field.view();
    const auto inverseVoxel = static_cast<float>(field.inverseVoxelMm);
    const double voxelMm3 = field.voxelMm * field.voxelMm * field.voxelMm;
    const std::uint32_t perLayer =
        static_cast<std::uint32_t>(field.bricks[0]) * static_cast<std::uint32_t>(field.bricks[1]);
    std::vector<TissueVolumes> layers(static_cast<std::size_t>(field.bricks[2]), TissueVolumes{});
    core::parallelFor(layers.size(), 1, [&](std::size_t begin, std::size_t end) {
        std::array<float, field::kBrickValues> uncut;
        for (std::size_t layer = begin; layer < end; ++layer)
            for (std::uint32_t i = 0; i < perLayer; ++i) {
                const std::uint32_t dense = static_cast<std::uint32_t>(layer) * perLayer + i;
                const float* values = valuesOf(dense);
                if (values == nullptr) {
                    if (field.brickIndex[dense] < 0 && field.coarse[dense] >= 0.0f) continue;
                    model.uncutBrick(dense, uncut.data());
                    values = uncut.data();
                }
                const std::uint8_t* tissues = model.field.storage().tissues->of(dense);
                // Nodes 0..7 along each axis: the others are the next brick's.
                TissueVolumes sum{};
                for (int z = 0; z < field::kBrickCells; ++z)
                    for (int y = 0; y < field::kBrickCells; ++y)
                        for (int x = 0; x < field::kBrickCells; ++x) {
                            const int at = x + kStride[1] * y + kStride[2] * z;
                            sum[tissues[at]] += occupancy(values[at], inverseVoxel);
                        }
                for (std::size_t k = 0; k < cases::kTissueCount; ++k)
                    layers[layer][k] += sum[k] * voxelMm3;
            }
    });
    TissueVolumes total{};
    for (const TissueVolumes& layer : layers)
        for (std::size_t k = 0; k < cases::kTissueCount; ++k)
            total[k] += layer[k];
    return total;
}

std::shared_ptr<const ToothModel> withTissues(const ToothModel& model, field::TissueMap tissues,
                                              const CutSettings& settings) {
    ToothModel copy{model.name, model.outer, model.tree, model.field};
    copy.fieldHash = model.fieldHash;
    copy.colours = model.colours;
    return withTissues(std::move(copy), std::move(tissues), settings);
}

std::shared_ptr<const ToothModel> withTissues(ToothModel&& model, field::TissueMap tissues,
                                              const CutSettings& settings) {
    const field::FieldSettings& field = model.field.settings();
    const auto refuse = [](const std::string& what, const std::string& remedy) {
        throw core::Error(what, "cutting", remedy);
    };
    model.settings = settings;
    model.bandOutMm = std::max(field.bandOutMm, 3.0 * field.voxelMm);
    double& band = model.settings.bandMm;
    if (band == 0.0) band = std::max(0.2, 3.0 * field.voxelMm);
    const double least = 2.0 * field.voxelMm, most = std::max(kMaxBandMm, 4.0 * field.voxelMm);
    if (!(band >= least && band <= most))
        refuse(fmt::format("a band of {} mm cannot follow a cut at a voxel of {} mm", band, field.voxelMm),
               fmt::format("give {} to {} mm", least, most));
    if (!tissues.isOn(model.field))
        refuse("the tissues were laid out on another grid than the tooth's", "make them from this tooth's field");

    field::FieldStorage& s = model.field.storage();
    std::size_t inside = 0;
    for (std::size_t i = 0; i < s.coarse.size(); ++i)
        if (s.brickIndex[i] < 0 && s.coarse[i] < 0.0f) ++inside;
    // As sessions have counted it from the first.
    constexpr std::size_t kBytesABrick = field::kBrickValues * (sizeof(float) + 1);
    std::size_t& reserve = model.settings.reserveBricks;
    reserve = std::min(inside, reserve == 0 ? kReserveBytes / kBytesABrick : reserve);

    if (model.fieldHash == 0) model.fieldHash = model.field.stateHash();
    model.tissues = std::move(tissues);
    s.tissues = model.tissues.nodes();
    model.volumesMm3 = integrateVolumes(model, [](std::uint32_t) -> const float* { return nullptr; });
    core::Hasher hasher;
    hasher.add(std::string_view("handpiece cut"));
    hasher.add(model.fieldHash);
    hasher.add(model.settings.bandMm);
    hasher.add(model.bandOutMm);
    // Tissues that came later count where they are: a tooth without them keeps the number that it had.
    for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
        const double mm3 = model.volumesMm3[t];
        if (t < cases::kFirstTissueCount)
            hasher.add(mm3);
        else if (mm3 > 0.0)
            hasher.add(t), hasher.add(mm3);
    }
    model.identity = hasher.value();
    return std::make_shared<const ToothModel>(std::move(model));
}

}  // namespace handpiece::tooth
