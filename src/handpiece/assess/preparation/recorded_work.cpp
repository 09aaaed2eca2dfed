// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/preparation/recorded_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <tuple>

#include "handpiece/base/core/difference_bytes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/model/field/brick_index.h"
#include "handpiece/senses/surface/closed_surface.h"

namespace handpiece::preparation {
namespace {

using core::Vec3;
using geometry::NearestPoint;
using geometry::TriangleMesh;
using geometry::TriangleTree;

constexpr double kStepMm = 1e-4;
constexpr double kMostMm = 1e4;  // of a coordinate
constexpr double kCos45 = 0.70710678118654752;

std::int64_t stepsOf(double mm) {
    return std::llround(mm / kStepMm);
}

/// Twice the area, along the normal.
Vec3 areaOf(const TriangleMesh& mesh, const geometry::Triangle& t) {
    return (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
}

Vec3 onSteps(const Vec3& v) {
    return {static_cast<double>(stepsOf(v.x())) * kStepMm, static_cast<double>(stepsOf(v.y())) * kStepMm,
            static_cast<double>(stepsOf(v.z())) * kStepMm};
}

/// Where a wall meets a floor the surface has specks that are folded back on themselves, a hundredth of a voxel thick:
/// which side of them is inside cannot be told. Their tips are laid between their neighbours.
void unfold(TriangleMesh& mesh) {
    constexpr double kCosFold = -0.5;
    constexpr int kRounds = 8;
    struct Side {
        std::uint32_t from, to, triangle;
    };
    std::vector<Side> sides;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = mesh.triangles[i][k], b = mesh.triangles[i][(k + 1) % 3];
            sides.push_back({std::min(a, b), std::max(a, b), i});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.from, a.to, a.triangle) < std::tie(b.from, b.to, b.triangle);
    });
    for (int round = 0; round < kRounds; ++round) {
        std::vector<int> folds(mesh.vertices.size(), 0);
        bool isFolded = false;
        for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
            const Side &one = sides[i], &other = sides[i + 1];
            if (one.from != other.from || one.to != other.to) continue;
            const Vec3 a = areaOf(mesh, mesh.triangles[one.triangle]), b = areaOf(mesh, mesh.triangles[other.triangle]);
            if (a.dot(b) >= kCosFold * a.norm() * b.norm()) continue;
            for (const std::uint32_t v : {one.from, one.to})
                isFolded = ++folds[v] >= 2 || isFolded;
        }
        if (!isFolded) return;
        std::vector<Vec3> sums(mesh.vertices.size(), Vec3::Zero());
        std::vector<int> counts(mesh.vertices.size(), 0);
        for (std::size_t i = 0; i < sides.size(); ++i) {
            if (i > 0 && sides[i].from == sides[i - 1].from && sides[i].to == sides[i - 1].to) continue;
            for (const auto& [at, neighbour] : {std::pair(sides[i].from, sides[i].to), {sides[i].to, sides[i].from}})
                if (folds[at] >= 2) sums[at] += mesh.vertices[neighbour], ++counts[at];
        }
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
            if (counts[v] > 0) mesh.vertices[v] = onSteps(sums[v] / counts[v]);
    }
}

/// By how much the field has risen at a place, between the nodes of its cell.
double riseMm(const tooth::ToothMirror& cut, const Vec3& p) {
    const field::FieldView view = cut.model().field.view();
    std::array<std::int32_t, 3> brick{};
    int cell[3];
    double share[3];
    for (int k = 0; k < 3; ++k) {
        const double at = (p[k] - view.originMm[k]) * view.inverseVoxelMm;
        if (!(at >= 0.0 && at < view.bricks[k] * field::kBrickCells)) return 0.0;
        const int whole = static_cast<int>(at);
        brick[static_cast<std::size_t>(k)] = whole / field::kBrickCells;
        cell[k] = whole % field::kBrickCells;
        share[k] = at - whole;
    }
    const std::uint32_t dense = field::denseOf(view.bricks, brick);
    if (!cut.isChanged(dense)) return 0.0;
    std::array<float, field::kBrickValues> before, scratch;
    cut.model().uncutBrick(dense, before.data());
    const float* now = cut.values(dense, scratch.data());
    double rise = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        int node[3];
        for (int k = 0; k < 3; ++k) {
            const int up = corner >> k & 1;
            node[k] = cell[k] + up;
            weight *= up != 0 ? share[k] : 1.0 - share[k];
        }
        const int i = node[0] + field::kBrickNodes * (node[1] + field::kBrickNodes * node[2]);
        rise += weight * (static_cast<double>(now[i]) - static_cast<double>(before[static_cast<std::size_t>(i)]));
    }
    return rise;
}

/// Triangles of what is left, those that were cut first, then two rows of the uncut surface about them. Cut is what
/// lay more than a tenth of a voxel under the surface, as elsewhere.
void takeCut(const TriangleMesh& left, const tooth::ToothMirror& cut, RecordedWork& work) {
    constexpr double kUnder = 0.1;  // voxels
    std::vector<bool> isCut(left.triangles.size()), meetsCut(left.vertices.size(), false);
    for (std::size_t i = 0; i < isCut.size(); ++i) {
        const geometry::Triangle& t = left.triangles[i];
        const Vec3 middle = (left.vertices[t[0]] + left.vertices[t[1]] + left.vertices[t[2]]) / 3.0;
        // Beside a margin the field has risen on uncut surface too, and at an edge of the tooth it is beside its
        // surface.
        isCut[i] =
            riseMm(cut, middle) > kUnder * work.voxelMm && cut.model().field.distance(middle) < -kUnder * work.voxelMm;
        if (isCut[i]) meetsCut[t[0]] = meetsCut[t[1]] = meetsCut[t[2]] = true;
    }
    std::vector<bool> isBeside = meetsCut;
    for (const geometry::Triangle& t : left.triangles)
        if (meetsCut[t[0]] || meetsCut[t[1]] || meetsCut[t[2]]) isBeside[t[0]] = isBeside[t[1]] = isBeside[t[2]] = true;
    constexpr std::uint32_t kNone = 0xffffffffu;
    std::vector<std::uint32_t> to(left.vertices.size(), kNone);
    for (const bool takesCut : {true, false}) {
        for (std::size_t i = 0; i < isCut.size(); ++i) {
            const geometry::Triangle& t = left.triangles[i];
            if (isCut[i] != takesCut || !(isBeside[t[0]] || isBeside[t[1]] || isBeside[t[2]])) continue;
            geometry::Triangle& taken = work.surface.triangles.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                if (to[t[k]] == kNone) {
                    to[t[k]] = static_cast<std::uint32_t>(work.surface.vertices.size());
                    work.surface.vertices.push_back(onSteps(left.vertices[t[k]]));
                }
                taken[k] = to[t[k]];
            }
        }
        if (takesCut) work.cutTriangles = static_cast<std::uint32_t>(work.surface.triangles.size());
    }
    unfold(work.surface);
}

Vec3 drawOf(const RecordedWork& work, int buccalSign) {
    constexpr double kHides = 0.05;
    const double buccal = buccalSign < 0 ? -1.0 : 1.0;
    const std::array<Vec3, 5> ways{Vec3::UnitZ(), buccal * Vec3::UnitY(), -buccal * Vec3::UnitY(), Vec3::UnitX(),
                                   -Vec3::UnitX()};
    std::array<double, 5> hidden{};
    double all = 0.0;
    for (std::size_t i = 0; i < work.cutTriangles; ++i) {
        const Vec3 area = areaOf(work.surface, work.surface.triangles[i]);
        all += area.norm();
        for (std::size_t k = 0; k < ways.size(); ++k)
            hidden[k] += std::max(0.0, -area.dot(ways[k]));
    }
    std::size_t best = 0;
    for (std::size_t k = 0; k < ways.size(); ++k) {
        if (hidden[k] <= kHides * all) return ways[k];
        if (hidden[k] < hidden[best]) best = k;
    }
    return ways[best];
}

// ------------------------------------------------------------------ bytes

constexpr char kMagic[8] = {'H', 'P', 'Z', 'O', 'N', 'E', 'S', '\n'};
constexpr std::uint32_t kVersion = 1, kByteOrder = 0x01020304;
constexpr std::uint32_t kMostVertices = 4'000'000;

struct Header {
    char magic[8];
    std::uint32_t version, byteOrder, vertices, triangles, cutTriangles, reserved;
    double voxelMm, draw[3];
    std::uint64_t payloadBytes, payloadHash, headerHash;
};
static_assert(sizeof(Header) == 88 && std::is_trivially_copyable_v<Header>);

std::uint64_t headerHashOf(const Header& header) {
    core::Hasher hasher;
    hasher.add(std::as_bytes(std::span(&header, 1)).first(offsetof(Header, headerHash)));
    return hasher.value();
}
std::uint64_t hashOf(std::span<const std::byte> bytes) {
    core::Hasher hasher;
    hasher.add(bytes);
    return hasher.value();
}

std::vector<std::byte> payloadOf(const TriangleMesh& mesh) {
    std::vector<std::byte> out;
    std::array<std::int64_t, 3> last{};
    for (const Vec3& v : mesh.vertices)
        for (int k = 0; k < 3; ++k) {
            const std::int64_t steps = stepsOf(v[k]);
            core::appendDifference(out, steps - last[static_cast<std::size_t>(k)]);
            last[static_cast<std::size_t>(k)] = steps;
        }
    std::int64_t before = 0;
    for (const geometry::Triangle& t : mesh.triangles)
        for (const std::uint32_t corner : t) {
            core::appendDifference(out, std::int64_t{corner} - before);
            before = corner;
        }
    return out;
}

/// False where the bytes are no such mesh.
bool readPayload(std::span<const std::byte> data, const Header& header, TriangleMesh& mesh) {
    std::array<std::int64_t, 3> last{};
    mesh.vertices.resize(header.vertices);
    for (Vec3& v : mesh.vertices)
        for (int k = 0; k < 3; ++k) {
            const std::optional<std::int64_t> difference = core::takeDifference(data);
            constexpr auto kMostSteps = static_cast<std::int64_t>(kMostMm / kStepMm);
            if (!difference || std::abs(*difference) > 2 * kMostSteps) return false;
            std::int64_t& steps = last[static_cast<std::size_t>(k)];
            steps += *difference;
            if (std::abs(steps) > kMostSteps) return false;
            v[k] = static_cast<double>(steps) * kStepMm;
        }
    std::int64_t before = 0;
    mesh.triangles.resize(header.triangles);
    for (geometry::Triangle& t : mesh.triangles)
        for (std::uint32_t& corner : t) {
            const std::optional<std::int64_t> difference = core::takeDifference(data);
            if (!difference || *difference < -before || *difference >= std::int64_t{header.vertices} - before)
                return false;
            before += *difference;
            corner = static_cast<std::uint32_t>(before);
        }
    return data.empty();
}

// ------------------------------------------------------------------ distances

class Target {
  public:
    Target(const RecordedWork& work, const Vec3& draw, const zones::Leeway& leeway,
           std::shared_ptr<const TriangleTree> whole)
        : whole_(std::move(whole)),
          cut_(work.surface),
          draw_(draw),
          nearMm_(kNear * work.voxelMm),
          insideMm_(kInside * work.voxelMm),
          sameMm_(kSame * work.voxelMm),
          askedInMm_(2.0 * work.voxelMm + 0.1),
          askedOutMm_(std::max(leeway.sideMm, leeway.floorMm) + askedInMm_) {
        std::array<TriangleMesh, 3> meshes;
        for (TriangleMesh& mesh : meshes)
            mesh.vertices = work.surface.vertices;
        std::vector<Kind> kinds;
        for (std::size_t i = 0; i < work.surface.triangles.size(); ++i) {
            const geometry::Triangle& t = work.surface.triangles[i];
            const Vec3 area = areaOf(work.surface, t);
            kinds.push_back(i >= work.cutTriangles ? kUncut : area.dot(draw) > kCos45 * area.norm() ? kFloor : kWall);
            meshes[kinds.back()].triangles.push_back(t);
        }
        for (const Kind kind : {kWall, kFloor})
            if (!meshes[kind].triangles.empty()) trees_[kind].emplace(meshes[kind]);
        for (const geometry::TreeTriangle& t : cut_.triangles())
            kinds_.push_back(kinds[t.index]);
    }

    [[nodiscard]] zones::PastTarget at(const Vec3& p) const {
        // Of places on the uncut surface and just over it their way into the tooth tells whether the target lies there.
        Vec3 from = p, within = p;
        if (NearestPoint on = whole_->nearest(p, nearMm_); on.triangle != geometry::kNoTriangle) {
            const double outMm = on.distanceMm * whole_->side(p, on);
            if (outMm > 0.0) from = on.pointMm;
            if (outMm > -insideMm_) {
                within = on.pointMm - insideMm_ * whole_->pseudonormal(on.triangle, on.feature);
            }
        }
        // What was taken lies in front of what was cut; of the uncut surface too little is kept to tell.
        const NearestPoint any = cut_.nearest(within);
        NearestPoint to = any;
        Kind kind = kinds_[any.triangle];
        if (kind == kUncut) to = nearestCut(within, kind);
        const bool isIn = to.distanceMm <= any.distanceMm + sameMm_ && cut_.side(within, any) > 0.0;
        if (from != within) to = nearestCut(from, kind);
        const double distance = to.distanceMm, squared = distance * distance;
        if (isIn) {
            if (distance > askedInMm_) return {-distance, -distance, -distance};
            const double other = nearest(kind == kWall ? kFloor : kWall, from).distanceMm;
            const double wall = kind == kWall ? distance : other, floor = kind == kWall ? other : distance;
            return {-wall, -floor, -wall};
        }
        const double under = std::clamp((to.pointMm - from).dot(draw_), 0.0, distance);
        const double past = std::sqrt(std::max(0.0, squared - under * under));
        constexpr double kRoot2 = 2.0 * kCos45;
        if (past > under) return {past, under, std::min(distance, kRoot2 * (past - under))};
        if (distance > askedOutMm_) return {past, under, -under};
        const double toWall = kind == kWall ? distance : nearest(kWall, from).distanceMm;
        const double off = std::sqrt(std::max(0.0, toWall * toWall - squared));
        return {past, under, -std::max(off, kRoot2 * (under - past))};
    }

  private:
    enum Kind : std::uint8_t { kWall, kFloor, kUncut };
    static constexpr double kNear = 0.6, kInside = 0.3;  // voxels
    static constexpr double kSame = 0.4;                 // voxels: as high the rim of a wall may not be known as cut

    [[nodiscard]] NearestPoint nearestCut(const Vec3& p, Kind& kind) const {
        const NearestPoint toWall = nearest(kWall, p), toFloor = nearest(kFloor, p, toWall.distanceMm);
        kind = toFloor.distanceMm < toWall.distanceMm ? kFloor : kWall;
        return kind == kFloor ? toFloor : toWall;
    }

    /// Far where there is none within the bound.
    [[nodiscard]] NearestPoint nearest(Kind kind, const Vec3& p, double boundMm = zones::kFarMm) const {
        NearestPoint to;
        if (trees_[kind]) to = trees_[kind]->nearest(p, boundMm);
        if (to.triangle == geometry::kNoTriangle) to = {zones::kFarMm, p, geometry::kNoTriangle, 0};
        return to;
    }

    std::shared_ptr<const TriangleTree> whole_;
    TriangleTree cut_;
    std::vector<Kind> kinds_;  ///< of cut_'s triangles, in its order
    std::array<std::optional<TriangleTree>, 2> trees_;
    Vec3 draw_;
    double nearMm_, insideMm_, sameMm_;
    double askedInMm_, askedOutMm_;  ///< so near the other kind of surface counts
};

}  // namespace

std::uint64_t RecordedWork::hash() const {
    core::Hasher hasher;
    hasher.add(std::string_view("handpiece recorded work"));
    hasher.add(voxelMm);
    for (int k = 0; k < 3; ++k)
        hasher.add(draw[k]);
    hasher.add(static_cast<std::uint64_t>(surface.vertices.size()));
    hasher.add(cutTriangles);
    hasher.add(std::span<const std::byte>(payloadOf(surface)));
    return hasher.value();
}

RecordedWork recordWork(const tooth::ToothMirror& cut, int buccalSign) {
    RecordedWork work;
    work.voxelMm = cut.model().field.settings().voxelMm;
    takeCut(surface::closedSurface(surface::MirrorSource(cut)), cut, work);
    if (work.cutTriangles == 0)
        throw core::Error("nothing was cut in this work", cut.model().name, "name work in which the target was cut")
            .as("no-work-cut");
    if (work.surface.vertices.size() > kMostVertices)
        throw core::Error("the surface of this work is too large", cut.model().name, "cut it in a larger voxel");
    work.draw = drawOf(work, buccalSign);
    return work;
}

std::vector<std::byte> encodeZones(const RecordedWork& work) {
    const std::vector<std::byte> payload = payloadOf(work.surface);
    Header header{};
    std::memcpy(header.magic, kMagic, sizeof kMagic);
    header.version = kVersion;
    header.byteOrder = kByteOrder;
    header.vertices = static_cast<std::uint32_t>(work.surface.vertices.size());
    header.triangles = static_cast<std::uint32_t>(work.surface.triangles.size());
    header.cutTriangles = work.cutTriangles;
    header.voxelMm = work.voxelMm;
    for (int k = 0; k < 3; ++k)
        header.draw[k] = work.draw[k];
    header.payloadBytes = payload.size();
    header.payloadHash = hashOf(payload);
    header.headerHash = headerHashOf(header);
    std::vector<std::byte> data(sizeof header + payload.size());
    std::memcpy(data.data(), &header, sizeof header);
    std::copy(payload.begin(), payload.end(), data.begin() + sizeof header);
    return data;
}

RecordedWork decodeZones(std::span<const std::byte> data, const std::string& where) {
    const auto error = [&](const std::string& what) {
        return core::Error(what, where, "take an older copy, or record the target again");
    };
    Header header;
    if (data.size() < sizeof kMagic || std::memcmp(data.data(), kMagic, sizeof kMagic) != 0)
        throw error("these bytes are no zones");
    if (data.size() < sizeof header) throw error("the zones are cut short");
    std::memcpy(&header, data.data(), sizeof header);
    if (header.byteOrder != kByteOrder)
        throw error("the zones were written by a machine of another byte order, or are damaged");
    if (header.version > kVersion)
        throw core::Error(fmt::format("the zones are of version {}, this program knows {}", header.version, kVersion),
                          where, "use a newer Handpiece");
    const std::span<const std::byte> payload = data.subspan(sizeof header);
    const Vec3 draw(header.draw[0], header.draw[1], header.draw[2]);
    if (header.version == 0 || header.headerHash != headerHashOf(header)) throw error("the zones are damaged");
    if (payload.size() < header.payloadBytes) throw error("the zones are cut short");
    // Each number takes a byte at least: nothing is made room for that is not there.
    if (payload.size() > header.payloadBytes || hashOf(payload) != header.payloadHash ||
        header.vertices > kMostVertices || header.cutTriangles == 0 || header.cutTriangles > header.triangles ||
        3 * (std::uint64_t{header.vertices} + header.triangles) > header.payloadBytes ||
        !(header.voxelMm >= 1e-3 && header.voxelMm <= 10.0) || !(std::abs(draw.norm() - 1.0) < 1e-6))
        throw error("the zones are damaged");
    RecordedWork work;
    work.cutTriangles = header.cutTriangles;
    work.voxelMm = header.voxelMm;
    work.draw = draw;
    if (!readPayload(payload, header, work.surface)) throw error("the zones are damaged");
    if (work.surface.triangles.empty() || geometry::inspect(work.surface).nonManifoldEdges > 0)
        throw error("the zones are no surface");
    return work;
}

zones::TargetFunction recordedTarget(const RecordedWork& work, const Vec3& draw, const zones::Leeway& leeway,
                                     std::shared_ptr<const TriangleTree> whole) {
    const auto target = std::make_shared<const Target>(work, draw, leeway, std::move(whole));
    return [target](const Vec3& p) { return target->at(p); };
}

}  // namespace handpiece::preparation
