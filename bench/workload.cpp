// SPDX-License-Identifier: Apache-2.0
#include "workload.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/tick/contact/hull/hull_method.h"
#include "support/brute_force_depth.h"

namespace handpiece::bench {
namespace {

constexpr int kTicks = 4000, kQuickTicks = 400, kTicksPerReference = 10;
constexpr double kVoxelMm = 0.05;

/// A contact method asked for the depth, or for the depth and all patches.
class MethodQuery final : public Query {
  public:
    MethodQuery(std::unique_ptr<contact::Method> method, bool withPatches)
        : method_(std::move(method)), withPatches_(withPatches) {}
    double depthMm(const core::Pose& burInTooth) override {
        const contact::Depth depth = method_->depth(burInTooth);
        if (withPatches_) method_->patches(burInTooth, patches_);
        return depth.status == contact::Status::beyondReach ? kNoContact : depth.depthMm;
    }

  private:
    std::unique_ptr<contact::Method> method_;
    bool withPatches_;
    contact::PatchSet patches_;
};

}  // namespace

std::span<const Resolution> resolutions() {
    static const std::array<Resolution, 5> all{
        {{"10k", 9760}, {"20k", 19516}, {"41k", 40656}, {"68k", 68151}, {"325k", 325312}}};
    return all;
}

Workload::Workload(bool quick)
    : quick_(quick),
      cache_(std::filesystem::path(HANDPIECE_BENCH_CACHE)),
      bur_(std::make_shared<const instrument::Bur>(instrument::makeBur("paper"))) {
    std::filesystem::create_directories(cache_);
}

// Through a file on purpose: every method sees the coordinates that an STL holds. Made again when this program is newer
// than the file: it may hold another generator.
std::filesystem::path Workload::toothFile(const Resolution& resolution) {
    const std::filesystem::path file = cache_ / fmt::format("molar-{}.stl", resolution.faces);
    std::error_code none;
    if (!std::filesystem::exists(file) ||
        std::filesystem::last_write_time(file) < std::filesystem::last_write_time("/proc/self/exe", none)) {
        fmt::print(stderr, "contact_bench: making {}\n", file.string());
        geometry::writeStl(file, starter::makeOuter(starter::ToothKind::lowerFirstMolar, resolution.faces));
    }
    return file;
}

const geometry::TriangleMesh& Workload::mesh(const Resolution& resolution) {
    const auto found = meshes_.find(resolution.name);
    if (found != meshes_.end()) return found->second;
    return meshes_.emplace(resolution.name, geometry::readMesh(toothFile(resolution))).first->second;
}

PeerInput Workload::peerInput(const Resolution& resolution) {
    return {mesh(resolution), bur_->mesh(), bur_->maxRadiusMm(), bur_->lengthMm()};
}

std::shared_ptr<const tooth::ToothModel> Workload::tooth(const Resolution& resolution, double voxelMm) {
    const std::string key = fmt::format("{} {}", resolution.name, voxelMm);
    if (lastTooth_.first == key) return lastTooth_.second;
    tooth::LoadSettings settings;
    settings.field.voxelMm = voxelMm;
    settings.cacheFolder = cache_;
    lastTooth_ = {key, tooth::loadModel(cases::readCase(toothFile(resolution)), settings)};
    return lastTooth_.second;
}

std::unique_ptr<Query> Workload::exactQuery(const Resolution& resolution, double reachMm) {
    contact::FieldMethodSettings settings;
    settings.reachMm = reachMm;
    return std::make_unique<MethodQuery>(contact::makeFieldMethod(tooth(resolution, kVoxelMm), bur_, settings), false);
}

std::unique_ptr<Query> Workload::fieldQuery(const Resolution& resolution, double voxelMm) {
    contact::FieldMethodSettings settings;
    settings.reachMm = kReachMm;
    return std::make_unique<MethodQuery>(contact::makeFieldMethod(tooth(resolution, voxelMm), bur_, settings), true);
}

std::unique_ptr<Query> Workload::fieldOnlyQuery(const Resolution& resolution, double voxelMm) {
    contact::FieldMethodSettings settings;
    settings.depthSource = contact::DepthSource::field;
    settings.reachMm = kReachMm;
    return std::make_unique<MethodQuery>(contact::makeFieldMethod(tooth(resolution, voxelMm), bur_, settings), false);
}

std::unique_ptr<Query> Workload::hullQuery(const Resolution& resolution) {
    return std::make_unique<MethodQuery>(contact::makeHullMethod(mesh(resolution), bur_->mesh()), false);
}

std::span<const core::Pose> Workload::poses(Way way) {
    std::vector<core::Pose>& poses = poses_[way];
    if (poses.empty()) {
        const Resolution& finest = resolutions()[quick_ ? 0 : 4];
        const std::unique_ptr<Query> exact = exactQuery(finest, contact::FieldMethodSettings{}.reachMm);
        poses = makeTrajectory(way, *exact, mesh(finest), ticks());
    }
    return poses;
}

int Workload::ticks() const {
    return quick_ ? kQuickTicks : kTicks;
}

std::vector<Reference> Workload::referencesOf(const instrument::Bur& bur, const Resolution& resolution,
                                              std::span<const core::Pose> poses) {
    const geometry::TriangleTree tree(mesh(resolution));
    std::vector<Reference> references(poses.size() / kTicksPerReference);
    core::parallelFor(references.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t tick = i * kTicksPerReference;
            references[i] = {tick, test::bruteForceDepth(tree, bur, poses[tick]).depthMm};
        }
    });
    return references;
}

const std::vector<Reference>& Workload::references(const Resolution& resolution, Way way) {
    std::vector<Reference>& references = references_[{resolution.name, way}];
    if (references.empty()) references = referencesOf(*bur_, resolution, poses(way));
    return references;
}

Workload::BurDrag Workload::drag(const std::string& name, const Resolution& resolution, Way way) {
    const auto bur = std::make_shared<const instrument::Bur>(
        name == "mesh" ? instrument::burFromMesh(name, bur_->mesh()) : instrument::makeBur(name));
    BurDrag drag;
    drag.query = std::make_unique<MethodQuery>(contact::makeFieldMethod(tooth(resolution, kVoxelMm), bur), false);
    drag.poses = makeTrajectory(way, *drag.query, mesh(resolution), ticks());
    drag.references = referencesOf(*bur, resolution, drag.poses);
    return drag;
}

}  // namespace handpiece::bench
