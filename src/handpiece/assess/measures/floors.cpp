// SPDX-License-Identifier: Apache-2.0
// The floors of a preparation, from what the path of draw sees.
#include <algorithm>
#include <cmath>

#include "handpiece/assess/measures/cut_tooth.h"

namespace handpiece::measures {
namespace {
using core::Vec3;

constexpr double kMostStepMm = 0.5;     // between neighbours of one floor
constexpr double kLeastAreaMm2 = 0.1;   // of a floor
constexpr double kFlatCos = 0.9659258;  // 15 degrees
constexpr double kCornerMm = 0.004;     // a ring of the floor lies in the corner when its mean stands higher than this
constexpr double kLeastFlatShare = 0.2;
constexpr double kCappedCos = 0.9396926;  // 20 degrees: inclines of capped cusps are steeper
constexpr double kFissureStepMm = 0.1;
constexpr double kPulpalShare = 0.3;  // of the largest floor's area: a higher floor is no mere step then

/// Normals of planes through five by five places, where enough of them are of the floor.
Vec3 localNormal(const HeightMap& map, const std::vector<int>& label, int mine, int node) {
    const int i = node % map.width, j = node / map.width;
    Vec3 places[25];
    std::size_t count = 0;
    for (int dj = -2; dj <= 2; ++dj)
        for (int di = -2; di <= 2; ++di) {
            if (i + di < 0 || j + dj < 0 || i + di >= map.width || j + dj >= map.height) continue;
            const int other = map.at(i + di, j + dj);
            if (label[static_cast<std::size_t>(other)] == mine) places[count++] = map.drawOf(other);
        }
    if (count < 12) return Vec3::Zero();
    const Plane plane = planeThrough({places, count});
    return plane.isFound ? Vec3(-plane.slope.x(), -plane.slope.y(), 1.0).normalized() : Vec3(Vec3::Zero());
}

Plane through(const HeightMap& map, const std::vector<int>& nodes) {
    std::vector<Vec3> places;
    places.reserve(nodes.size());
    for (const int node : nodes)
        places.push_back(map.drawOf(node));
    return planeThrough(places);
}

/// Steps to the nearest place that is not of the floor, by rings.
std::vector<int> ringsOf(const HeightMap& map, const std::vector<int>& label, int mine, const Floor& floor) {
    std::vector<int> ring(map.nodes.size(), 0);
    std::vector<int> front, next;
    const auto isOther = [&](int i, int j) {
        return i < 0 || j < 0 || i >= map.width || j >= map.height ||
               label[static_cast<std::size_t>(map.at(i, j))] != mine;
    };
    for (const int node : floor.nodes) {
        const int i = node % map.width, j = node / map.width;
        if (isOther(i - 1, j) || isOther(i + 1, j) || isOther(i, j - 1) || isOther(i, j + 1)) {
            ring[static_cast<std::size_t>(node)] = 1;
            front.push_back(node);
        }
    }
    for (int step = 2; !front.empty(); ++step) {
        next.clear();
        for (const int node : front) {
            const int i = node % map.width, j = node / map.width;
            const int to[4][2] = {{i - 1, j}, {i + 1, j}, {i, j - 1}, {i, j + 1}};
            for (const auto& t : to) {
                if (isOther(t[0], t[1])) continue;
                int& there = ring[static_cast<std::size_t>(map.at(t[0], t[1]))];
                if (there != 0) continue;
                there = step;
                next.push_back(map.at(t[0], t[1]));
            }
        }
        front.swap(next);
    }
    return ring;
}

void findFlat(const HeightMap& map, const std::vector<int>& label, int mine, double noiseMm, Floor& floor) {
    // A first plane through what is about as steep as most of it.
    std::vector<Vec3> normals;
    std::vector<double> x, y;
    for (const int node : floor.nodes) {
        normals.push_back(localNormal(map, label, mine, node));
        if (normals.back().isZero()) continue;
        x.push_back(normals.back().x() / normals.back().z());
        y.push_back(normals.back().y() / normals.back().z());
    }
    if (x.empty()) return;
    Vec3 normal = Vec3(medianOf(x), medianOf(y), 1.0).normalized();
    Plane plane;
    for (int round = 0; round < 4; ++round) {
        std::vector<int> alike;
        for (std::size_t i = 0; i < floor.nodes.size(); ++i)
            if (normals[i].dot(normal) > kFlatCos) alike.push_back(floor.nodes[i]);
        plane = through(map, alike);
        if (!plane.isFound) return;
        normal = Vec3(-plane.slope.x(), -plane.slope.y(), 1.0).normalized();
    }
    // From the walls inwards until no ring stands higher than the middle: there the corner ends.
    const std::vector<int> ring = ringsOf(map, label, mine, floor);
    int rings = 0;
    for (const int node : floor.nodes)
        rings = std::max(rings, ring[static_cast<std::size_t>(node)]);
    std::vector<std::vector<int>> of(static_cast<std::size_t>(rings) + 1);
    for (const int node : floor.nodes)
        of[static_cast<std::size_t>(ring[static_cast<std::size_t>(node)])].push_back(node);
    std::vector<int> kept;
    const auto least = static_cast<std::size_t>(kLeastFlatShare * static_cast<double>(floor.nodes.size()));
    int first = rings + 1;
    while (first > 1 && kept.size() < std::max<std::size_t>(least, 9)) {
        --first;
        const auto& more = of[static_cast<std::size_t>(first)];
        kept.insert(kept.end(), more.begin(), more.end());
    }
    for (; first > 1; --first) {
        plane = through(map, kept);
        if (!plane.isFound) break;
        const auto& more = of[static_cast<std::size_t>(first - 1)];
        double mean = 0.0;
        for (const int node : more) {
            const Vec3 q = map.drawOf(node);
            mean += q.z() - plane.of(q.x(), q.y());
        }
        if (!more.empty() && mean / static_cast<double>(more.size()) > kCornerMm + 2.0 * noiseMm + 0.5 * plane.rms)
            break;
        kept.insert(kept.end(), more.begin(), more.end());
    }
    std::sort(kept.begin(), kept.end());
    floor.plane = through(map, kept);
    if (!floor.plane.isFound) return;
    for (const int node : kept)
        if (ring[static_cast<std::size_t>(node)] > first) floor.inner.push_back(node);
    floor.flat = std::move(kept);
    std::vector<Vec3> places;
    for (const int node : floor.flat)
        places.push_back(map.drawOf(node));
    floor.unevenMm = rmsAboutCurve(places);
}

/// Which of them lies under most of the fissures.
std::size_t underFissures(const HeightMap& map, const DrawFrame& frame, std::span<const cases::Landmark> landmarks,
                          const std::vector<Floor>& floors) {
    std::vector<int> under;
    for (const cases::Landmark& mark : landmarks) {
        if (mark.kind != cases::LandmarkKind::fissure) continue;
        for (std::size_t k = 0; k + 1 < mark.pointsMm.size(); ++k) {
            const Vec3 &a = mark.pointsMm[k], &b = mark.pointsMm[k + 1];
            const int pieces = std::max(1, static_cast<int>(std::ceil((b - a).norm() / kFissureStepMm)));
            for (int i = 0; i < pieces; ++i) {
                const Vec3 q = frame.to(a + (b - a) * (static_cast<double>(i) / pieces));
                const auto u = std::lround((q.x() - map.u0) / kProbeMm), v = std::lround((q.y() - map.v0) / kProbeMm);
                if (u >= 0 && v >= 0 && u < map.width && v < map.height)
                    under.push_back(map.at(static_cast<int>(u), static_cast<int>(v)));
            }
        }
    }
    std::size_t best = 0;
    std::ptrdiff_t most = -1;
    for (std::size_t i = 0; i < floors.size(); ++i) {
        const std::vector<int>& its = floors[i].nodes;
        const auto count = std::count_if(under.begin(), under.end(),
                                         [&](int node) { return std::binary_search(its.begin(), its.end(), node); });
        if (count > most) most = count, best = i;
    }
    return best;
}

}  // namespace

void CutTooth::findFloors() {
    const HeightMap& map = heights();
    std::vector<int> label(map.nodes.size(), 0);
    std::vector<Floor> floors;
    const double facesCos = p_.isCapped ? kCappedCos : kSin45;
    const auto isOf = [&](int node) {
        const HeightMap::Node& n = map.nodes[static_cast<std::size_t>(node)];
        return n.isCut && n.n.dot(frame_.w) > facesCos;
    };
    std::vector<int> stack;
    int labels = 0;
    for (int seed = 0; seed < static_cast<int>(map.nodes.size()); ++seed) {
        if (label[static_cast<std::size_t>(seed)] != 0 || !isOf(seed)) continue;
        Floor floor;
        ++labels;
        label[static_cast<std::size_t>(seed)] = labels;
        stack.assign(1, seed);
        while (!stack.empty()) {
            const int node = stack.back();
            stack.pop_back();
            floor.nodes.push_back(node);
            const int i = node % map.width, j = node / map.width;
            for (int dj = -1; dj <= 1; ++dj)
                for (int di = -1; di <= 1; ++di) {
                    if (i + di < 0 || j + dj < 0 || i + di >= map.width || j + dj >= map.height) continue;
                    const int other = map.at(i + di, j + dj);
                    if (label[static_cast<std::size_t>(other)] != 0 || !isOf(other)) continue;
                    if (std::abs(map.nodes[static_cast<std::size_t>(other)].now -
                                 map.nodes[static_cast<std::size_t>(node)].now) > kMostStepMm)
                        continue;
                    label[static_cast<std::size_t>(other)] = labels;
                    stack.push_back(other);
                }
        }
        floor.areaMm2 = kProbeMm * kProbeMm * static_cast<double>(floor.nodes.size());
        if (floor.areaMm2 < kLeastAreaMm2) continue;
        std::sort(floor.nodes.begin(), floor.nodes.end());
        findFlat(map, label, labels, p_.noiseMm, floor);
        floors.push_back(std::move(floor));
    }
    std::stable_sort(floors.begin(), floors.end(),
                     [](const Floor& a, const Floor& b) { return a.nodes.size() > b.nodes.size(); });
    // The pulpal one comes first: a wide box makes a gingival floor that is larger and lies lower.
    // Beside capped cusps shoulders are floors too: there it is the one under most of the fissures.
    if (!floors.empty()) {
        std::size_t pulpal = p_.isCapped ? underFissures(map, frame_, p_.landmarks, floors) : 0;
        for (std::size_t i = 1; !p_.isCapped && i < floors.size(); ++i)
            if (floors[i].plane.isFound && floors[pulpal].plane.isFound &&
                floors[i].areaMm2 > kPulpalShare * floors.front().areaMm2 &&
                floors[i].plane.at > floors[pulpal].plane.at + kLowerMm)
                pulpal = i;
        std::rotate(floors.begin(), floors.begin() + static_cast<std::ptrdiff_t>(pulpal),
                    floors.begin() + static_cast<std::ptrdiff_t>(pulpal) + 1);
    }
    floors_ = std::move(floors);
}

}  // namespace handpiece::measures
