// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/measures/cut_tooth.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/simd.h"
#include "handpiece/model/field/brick_index.h"

namespace handpiece::measures {

using core::Vec3;
using field::kBrickCells;
using field::kBrickNodes;
using field::kBrickValues;

namespace {

DrawFrame frameOf(const Axes& axes) {
    DrawFrame frame;
    frame.w = axes.draw;
    // Mesial; where that lies along the path of draw, occlusal.
    Vec3 u = axes.mesial - axes.mesial.dot(frame.w) * frame.w;
    if (!(u.norm() > kSin45)) u = axes.longAxis - axes.longAxis.dot(frame.w) * frame.w;
    frame.u = u.normalized();
    frame.v = frame.w.cross(frame.u);
    return frame;
}

}  // namespace

CutTooth::CutTooth(const Preparation& preparation) : p_(preparation), frame_(frameOf(preparation.axes)) {
    const tooth::ToothModel& model = whole();
    const field::FieldStorage& uncut = model.field.storage();
    const auto dense = static_cast<std::uint32_t>(uncut.coarse.size());
    std::array<float, kBrickValues> values;
    for (std::uint32_t i = 0; i < dense; ++i) {
        if (!p_.cut->isChanged(i)) continue;
        // A brick that was cut and restored comes as a changed one.
        model.uncutBrick(i, values.data());
        if (std::memcmp(values.data(), p_.cut->values(i, nullptr), tooth::kBrickBytes) != 0) changed_.push_back(i);
    }
    // Of the field as it is only what is near a cut.
    isKept_.assign(dense, false);
    for (const std::uint32_t i : changed_) {
        const auto b = field::brickAt(uncut.bricks, i);
        for (int dz = -1; dz <= 1; ++dz)
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const std::array<std::int32_t, 3> to{b[0] + dx, b[1] + dy, b[2] + dz};
                    bool isIn = true;
                    for (std::size_t k = 0; k < 3; ++k)
                        isIn = isIn && to[k] >= 0 && to[k] < uncut.bricks[k];
                    if (isIn) isKept_[field::denseOf(uncut.bricks, to)] = true;
                }
    }
    field::FieldStorage s;
    s.settings = uncut.settings;
    s.settings.bandInMm = std::min(s.settings.bandInMm, model.settings.bandMm);
    s.originMm = uncut.originMm;
    std::copy(std::begin(uncut.bricks), std::end(uncut.bricks), s.bricks);
    s.brickIndex.assign(dense, -1);
    s.coarse = uncut.coarse;
    s.tissues = uncut.tissues;
    s.heldTo = field::FieldReach{model.bandOutMm, model.settings.bandMm};
    for (std::uint32_t i = 0; i < dense; ++i) {
        if (!isKept_[i] || (uncut.brickIndex[i] < 0 && !p_.cut->isChanged(i))) continue;
        s.brickIndex[i] = static_cast<std::int32_t>(s.values.size() / kBrickValues);
        s.values.resize(s.values.size() + kBrickValues);
        float* to = s.values.data() + s.values.size() - kBrickValues;
        const float* from = p_.cut->values(i, to);
        if (from != to) std::memcpy(to, from, tooth::kBrickBytes);
    }
    now_.emplace(std::move(s));
}

CutTooth::Look::Look(const CutTooth& tooth)
    : tooth_(tooth),
      now_(*tooth.now_, core::simdLevel()),
      before_(tooth.whole().field, core::simdLevel()),
      cutMm_(tooth.cutMm()) {}

bool CutTooth::isNearCut(const Vec3& p) const {
    const field::FieldStorage& s = now_->storage();
    const double perBrick = 1.0 / (kBrickCells * s.settings.voxelMm);
    std::array<std::int32_t, 3> brick{};
    for (int k = 0; k < 3; ++k) {
        const double at = std::floor((p[k] - s.originMm[k]) * perBrick);
        if (!(at >= 0.0 && at < s.bricks[k])) return false;
        brick[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(at);
    }
    return isKept_[field::denseOf(s.bricks, brick)];
}

double CutTooth::nearlyNow(const Vec3& p) const {
    return isNearCut(p) ? now_->distance(p) : whole().field.distance(p);
}

double CutTooth::Look::now(const Vec3& p) {
    return tooth_.isNearCut(p) ? now_.distance(p) : tooth_.whole().field.distance(p);
}

std::optional<double> CutTooth::Look::cast(const Vec3& from, const Vec3& along, double farMm) {
    const double least = 0.02 * tooth_.voxelMm();
    double t = 0.0, d = now(from);
    if (d < 0.0) return 0.0;
    while (t < farMm) {
        const double before = t, dBefore = d;
        // In the air a value is never more than the distance, but for some microns beside edges.
        t = std::min(t + std::max(0.9 * d, least), farMm);
        d = now(from + t * along);
        if (d >= 0.0) continue;
        double low = before, high = t, atLow = dBefore, atHigh = d;
        for (int i = 0; i < 30 && high - low > 1e-7; ++i) {
            // False position, halving every third time.
            const double share = i % 3 == 2 ? 0.5 : std::clamp(atLow / (atLow - atHigh), 0.02, 0.98);
            const double middle = low + share * (high - low), value = now(from + middle * along);
            (value < 0.0 ? high : low) = middle;
            (value < 0.0 ? atHigh : atLow) = value;
        }
        return 0.5 * (low + high);
    }
    return {};
}

const std::vector<SurfacePoint>& CutTooth::cutPoints() {
    if (cutPoints_) return *cutPoints_;
    const double h = voxelMm();
    const field::FieldStorage& s = now_->storage();
    std::vector<std::vector<SurfacePoint>> found(changed_.size());
    core::parallelFor(changed_.size(), 8, [&](std::size_t begin, std::size_t end) {
        Look look(*this);
        for (std::size_t i = begin; i < end; ++i) {
            const float* values = p_.cut->values(changed_[i], nullptr);
            const auto brick = field::brickAt(s.bricks, changed_[i]);
            for (int z = 0; z < kBrickCells; ++z)
                for (int y = 0; y < kBrickCells; ++y)
                    for (int x = 0; x < kBrickCells; ++x)
                        for (int axis = 0; axis < 3; ++axis) {
                            const int here = x + kBrickNodes * (y + kBrickNodes * z);
                            const int there = here + (axis == 0   ? 1
                                                      : axis == 1 ? kBrickNodes
                                                                  : kBrickNodes * kBrickNodes);
                            double low = 0.0, high = 1.0, atLow = static_cast<double>(values[here]),
                                   atHigh = static_cast<double>(values[there]);
                            if ((atLow < 0.0) == (atHigh < 0.0)) continue;
                            const int node[3] = {x, y, z};
                            Vec3 base;
                            for (int k = 0; k < 3; ++k)
                                base[k] =
                                    s.originMm[k] + h * (kBrickCells * brick[static_cast<std::size_t>(k)] + node[k]);
                            Vec3 p = base;
                            for (int step = 0; step < 8 && high - low > 1e-6; ++step) {
                                const double t =
                                    low + std::clamp(atLow / (atLow - atHigh), 0.001, 0.999) * (high - low);
                                p[axis] = base[axis] + t * h;
                                const double value = look.now(p);
                                if (std::abs(value) < 1e-7) break;
                                ((value < 0.0) == (atLow < 0.0) ? low : high) = t;
                                ((value < 0.0) == (atLow < 0.0) ? atLow : atHigh) = value;
                            }
                            if (!look.isCut(p)) continue;
                            const Vec3 n = look.normalNow(p);
                            const double met = n.cwiseAbs().sum();
                            if (!(met > 0.5)) continue;
                            found[i].push_back({p, n, h * h / met});
                        }
        }
    });
    cutPoints_.emplace();
    for (const auto& some : found)
        cutPoints_->insert(cutPoints_->end(), some.begin(), some.end());
    return *cutPoints_;
}

const HeightMap& CutTooth::heights() {
    if (heights_) return *heights_;
    HeightMap map;
    core::Box box;
    for (const SurfacePoint& point : cutPoints())
        box.extend(frame_.to(point.p));
    if (!box.isEmpty()) {
        map.u0 = box.min.x() - 0.5 * kProbeMm;
        map.v0 = box.min.y() - 0.5 * kProbeMm;
        map.width = static_cast<int>(std::ceil((box.max.x() - map.u0) / kProbeMm)) + 1;
        map.height = static_cast<int>(std::ceil((box.max.y() - map.v0) / kProbeMm)) + 1;
    }
    map.nodes.resize(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height));
    const core::Box bounds = whole().tree.bounds();
    double top = -1e300, bottom = 1e300;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p((corner & 1) != 0 ? bounds.max.x() : bounds.min.x(),
                     (corner & 2) != 0 ? bounds.max.y() : bounds.min.y(),
                     (corner & 4) != 0 ? bounds.max.z() : bounds.min.z());
        top = std::max(top, frame_.w.dot(p) + 0.1);
        bottom = std::min(bottom, frame_.w.dot(p) - 0.1);
    }
    core::parallelFor(static_cast<std::size_t>(map.height), 4, [&](std::size_t begin, std::size_t end) {
        Look look(*this);
        for (std::size_t j = begin; j < end; ++j)
            for (int i = 0; i < map.width; ++i) {
                const Vec3 from = frame_.from({map.uOf(i), map.vOf(static_cast<int>(j)), top});
                const geometry::RayMeeting met = whole().tree.firstMeeting(from, -frame_.w, top - bottom);
                if (met.triangle == geometry::kNoTriangle) continue;
                HeightMap::Node& node = map.nodes[static_cast<std::size_t>(map.at(i, static_cast<int>(j)))];
                node.before = top - met.distanceMm;
                Vec3 p = from - met.distanceMm * frame_.w;
                if (look.now(p) < cutMm()) {
                    node.now = node.before;
                    node.isMet = true;
                    node.n = look.normalBefore(p);
                    continue;
                }
                const auto on = look.cast(p, -frame_.w, node.before - bottom);
                if (!on) continue;
                p -= *on * frame_.w;
                node.now = node.before - *on;
                node.n = look.normalNow(p);
                node.isMet = true;
                node.isCut = look.isCut(p);
            }
    });
    heights_ = std::move(map);
    return *heights_;
}

const zones::RemovedVolumes& CutTooth::removedVolumes() {
    if (!removedVolumes_) removedVolumes_ = zones::removedVolumes(*p_.zones, *p_.cut);
    return *removedVolumes_;
}

const zones::WholeVolumes& CutTooth::wholeVolumes() {
    if (!wholeVolumes_) wholeVolumes_ = zones::wholeVolumes(*p_.zones, whole());
    return *wholeVolumes_;
}

Form CutTooth::form() {
    if (p_.form != Form::found) return p_.form;
    if (form_) return *form_;
    // Walls that face one another belong to a cavity.
    Vec3 middle = Vec3::Zero();
    double area = 0.0, outwards = 0.0;
    for (const SurfacePoint& point : cutPoints()) {
        middle += point.areaMm2 * point.p;
        area += point.areaMm2;
    }
    if (area > 0.0) middle /= area;
    for (const SurfacePoint& point : cutPoints()) {
        if (std::abs(point.n.dot(frame_.w)) > kSin45) continue;
        Vec3 off = point.p - middle;
        off -= off.dot(frame_.w) * frame_.w;
        outwards += point.areaMm2 * off.dot(point.n);
    }
    form_ = outwards > 0.0 ? Form::crown : Form::cavity;
    return *form_;
}

const std::vector<Floor>& CutTooth::floors() {
    if (!floors_) findFloors();
    return *floors_;
}

const std::vector<WallStation>& CutTooth::walls() {
    if (!walls_) findWalls();
    return *walls_;
}

}  // namespace handpiece::measures
