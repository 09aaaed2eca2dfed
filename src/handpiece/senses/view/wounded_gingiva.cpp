// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/wounded_gingiva.h"

#include <algorithm>
#include <cmath>

namespace handpiece::view {
namespace {

using core::Vec3;
using messages::GingivaCut;

// Edges in and about a wound, and where blood may run.
constexpr double kWoundEdgeMm = 0.13, kTrickleEdgeMm = 0.27, kAboutMm = 0.6;
constexpr std::size_t kMostFaces = 80000;  ///< then nothing is made finer
constexpr int kMostRounds = 8;
/// Lips of a wound swell by this much over so wide a rim [a judgement].
constexpr double kSwollenMm = 0.10, kRimMm = 0.5;
constexpr double kBleedsFromMm = 0.03;
/// Blood comes out at this speed, slower and slower: no more than a bleeding that stops by itself [a judgement].
constexpr double kOozesMmS = 0.15, kStopsS = 3.0;
/// A film of thickness h runs down a wall with kRuns * h^2: blood that clots and sticks to wet gingiva is some tens of
/// times as slow as its viscosity alone would have it, about 3 mm/s at 0.15 mm. A film of kStaysMm stays.
constexpr double kRuns = 150.0, kStaysMm = 0.05;
constexpr double kMostShare = 0.1;     ///< of what is on a vertex that goes over one edge in a step
constexpr double kLevels = 0.25;       ///< of the film's thickness that drives it, on a wall
constexpr double kOpaqueMm = 0.5;      ///< film that is coded as 255
constexpr double kSeenFilmMm = 0.004;  ///< less is not drawn anew
constexpr double kFleshMm = 0.10;      ///< what a wound that does not bleed looks like: as so thick a film

Vec3 placeOf(const GpuVertex& v) {
    return {static_cast<double>(v.positionMm[0]), static_cast<double>(v.positionMm[1]),
            static_cast<double>(v.positionMm[2])};
}

Vec3 normalOf(std::uint32_t packed) {
    const auto part = [packed](int shift) {
        const auto i = static_cast<std::int32_t>(packed >> shift & 0x3ffu);
        return static_cast<double>(i > 511 ? i - 1024 : i) / 511.0;
    };
    const Vec3 normal(part(0), part(10), part(20));
    return normal.norm() > 0.0 ? Vec3(normal.normalized()) : Vec3(Vec3::UnitZ());
}

std::uint64_t keyOf(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

bool isIn(const core::Box& box, const Vec3& p) {
    return (p.array() >= box.min.array()).all() && (p.array() <= box.max.array()).all();
}

std::array<float, 3> floats(const Vec3& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

}  // namespace

double depthInBur(const GingivaCut& cut, const Vec3& pMm) {
    const Vec3 fromTip = pMm - core::toVec(cut.tipMm), axis = core::toVec(cut.axis);
    const double up = fromTip.dot(axis), aside = (fromTip - up * axis).norm();
    const double place = std::clamp(up / cut.lengthMm, 0.0, 1.0) * (messages::kBurStations - 1);
    const auto i = std::min(static_cast<std::size_t>(place), messages::kBurStations - 2);
    const double share = place - static_cast<double>(i);
    const double radius = (1.0 - share) * cut.stationRadiusMm[i] + share * cut.stationRadiusMm[i + 1];
    const double in = std::min(radius - aside, up);
    if (in > 0.0 && up < cut.lengthMm) return in;
    const double past = std::max({0.0, -up, up - cut.lengthMm}), out = std::max(0.0, aside - radius);
    return -std::sqrt(past * past + out * out);
}

/// Where the surface is without blood.
Vec3 WoundedGingiva::groundMm(const Vertex& v) {
    if (v.depthMm > 0.0 && v.inward.norm() > 0.0)
        return v.restMm + std::min(v.depthMm, kDeepestMm) * v.inward.normalized();
    return v.restMm + v.outward;
}

void WoundedGingiva::add(std::uint32_t piece, const MeshPiece& mesh) {
    if (!pieces_.try_emplace(piece, false).second) return;
    std::vector<std::uint32_t> number;
    number.reserve(mesh.vertices.size());
    for (const GpuVertex& v : mesh.vertices) {
        const auto [place, isNew] = known_.try_emplace(v.positionMm, static_cast<std::uint32_t>(vertices_.size()));
        if (isNew) {
            vertices_.emplace_back().restMm = placeOf(v);
            vertices_.back().underMm = 0.001f * static_cast<float>(v.removedUm);
        }
        number.push_back(place->second);
    }
    for (const auto& t : mesh.triangles) {
        Face face{{}, {}, piece};
        for (std::size_t k = 0; k < 3; ++k) {
            face.corners[k] = number[t[k]];
            face.normals[k] = normalOf(mesh.vertices[t[k]].normal);
        }
        faces_.push_back(face);
    }
}

void WoundedGingiva::cut(const GingivaCut& cut, const core::Box& fineMm) {
    refine(cut, fineMm);
    open(cut);
    connect();
}

/// Whether an edge is split depends on where it lies alone, so both its faces split it.
void WoundedGingiva::refine(const GingivaCut& cut, const core::Box& fineMm) {
    for (int round = 0; round < kMostRounds && faces_.size() < kMostFaces; ++round) {
        Middles middles;
        const auto ask = [&](std::uint32_t a, std::uint32_t b) {
            const Vec3 middle = 0.5 * (vertices_[a].restMm + vertices_[b].restMm);
            if (!isIn(fineMm, middle)) return;
            const double length = (vertices_[a].restMm - vertices_[b].restMm).norm();
            if (length <= kWoundEdgeMm) return;
            if (length <= kTrickleEdgeMm && depthInBur(cut, middle) < -kAboutMm) return;
            const auto [at, isNew] = middles.try_emplace(keyOf(a, b), static_cast<std::uint32_t>(vertices_.size()));
            if (!isNew) return;
            Vertex v;
            const Vertex &one = vertices_[a], &two = vertices_[b];
            v.restMm = middle;
            v.inward = 0.5 * (one.inward + two.inward);
            v.outward = 0.5 * (one.outward + two.outward);
            v.depthMm = 0.5 * (one.depthMm + two.depthMm);
            v.openedS = std::max(one.openedS, two.openedS);
            v.filmMm = 0.5 * (one.filmMm + two.filmMm);
            v.underMm = 0.5f * (one.underMm + two.underMm);
            vertices_.push_back(v);
        };
        for (const Face& face : faces_)
            for (std::size_t k = 0; k < 3; ++k)
                ask(face.corners[k], face.corners[(k + 1) % 3]);
        if (middles.empty()) return;
        std::vector<Face> finer;
        finer.reserve(faces_.size() + 2 * middles.size());
        for (const Face& face : faces_)
            split(face, middles, finer);
        faces_ = std::move(finer);
    }
}

void WoundedGingiva::split(const Face& face, const Middles& middles, std::vector<Face>& to) {
    std::array<std::uint32_t, 3> middle{};
    std::array<bool, 3> isSplit{};
    int count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto found = middles.find(keyOf(face.corners[k], face.corners[(k + 1) % 3]));
        if (found == middles.end()) continue;
        middle[k] = found->second, isSplit[k] = true, ++count;
    }
    if (count == 0) return to.push_back(face);
    // Corners 0 to 2, and 3 to 5 in the middle of the edges after them.
    const auto put = [&](std::size_t a, std::size_t b, std::size_t c) {
        Face part{{}, {}, face.piece};
        const std::array<std::size_t, 3> abc{a, b, c};
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t k = abc[i];
            part.corners[i] = k < 3 ? face.corners[k] : middle[k - 3];
            part.normals[i] =
                k < 3 ? face.normals[k] : Vec3((face.normals[k - 3] + face.normals[(k - 2) % 3]).normalized());
        }
        to.push_back(part);
    };
    if (count == 3) {
        put(0, 3, 5), put(3, 1, 4), put(5, 4, 2), put(3, 4, 5);
        return;
    }
    std::size_t k = 0;  // turned so that the edge after it is split, and of two the one before it is not
    while (!isSplit[k] || (count == 2 && !isSplit[(k + 1) % 3]))
        ++k;
    const std::size_t a = k, b = (k + 1) % 3, c = (k + 2) % 3;
    if (count == 1)
        put(a, a + 3, c), put(a + 3, b, c);
    else
        put(a, a + 3, c), put(a + 3, b + 3, c), put(a + 3, b, b + 3);
}

void WoundedGingiva::open(const GingivaCut& cut) {
    // Inwards is one direction for a cut: against the mean normal of what it lies in.
    Vec3 out = Vec3::Zero();
    for (const Face& face : faces_)
        for (std::size_t k = 0; k < 3; ++k)
            if (const double depth = depthInBur(cut, vertices_[face.corners[k]].restMm); depth > 0.0)
                out += depth * face.normals[k];
    if (!(out.norm() > 0.0)) return;
    out.normalize();
    for (std::uint32_t i = 0; i < vertices_.size(); ++i) {
        Vertex& v = vertices_[i];
        const double depth = depthInBur(cut, v.restMm);
        if (depth <= -kRimMm) continue;
        if (depth > 0.0) {
            if (depth > v.depthMm + kBleedsFromMm || v.depthMm <= 0.0) v.openedS = cut.timeS;
            v.depthMm = std::max(v.depthMm, depth);
            v.inward -= depth * out;
            continue;
        }
        const double share = -depth / kRimMm, swell = kSwollenMm * 4.0 * share * (1.0 - share);
        if (swell > v.outward.norm()) v.outward = swell * out;
    }
    for (const Face& face : faces_)
        for (const std::uint32_t corner : face.corners)
            if (depthInBur(cut, vertices_[corner].restMm) > -kRimMm) pieces_[face.piece] = true;
}

void WoundedGingiva::connect() {
    for (Vertex& v : vertices_)
        v.normal.setZero(), v.areaMm2 = 0.0;
    std::vector<std::uint64_t> keys;
    keys.reserve(3 * faces_.size());
    for (const Face& face : faces_) {
        const auto& [a, b, c] = face.corners;
        const Vec3 at = groundMm(vertices_[a]);
        const Vec3 twice = (groundMm(vertices_[b]) - at).cross(groundMm(vertices_[c]) - at);
        for (const std::uint32_t corner : face.corners) {
            vertices_[corner].normal += twice;
            vertices_[corner].areaMm2 += twice.norm() / 6.0;
        }
        keys.insert(keys.end(), {keyOf(a, b), keyOf(b, c), keyOf(c, a)});
    }
    for (Vertex& v : vertices_)
        if (v.normal.norm() > 0.0) v.normal.normalize();
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    edges_.clear();
    edges_.reserve(keys.size());
    for (const std::uint64_t key : keys) {
        const auto a = static_cast<std::uint32_t>(key >> 32), b = static_cast<std::uint32_t>(key);
        edges_.push_back({a, b, std::max(0.02, (groundMm(vertices_[a]) - groundMm(vertices_[b])).norm())});
    }
}

void WoundedGingiva::flow(double timeS, double stepS, const Vec3& down) {
    heightMm_.resize(vertices_.size());
    gainMm3_.assign(vertices_.size(), 0.0);
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
        Vertex& v = vertices_[i];
        if (v.depthMm > kBleedsFromMm && timeS >= v.openedS)
            v.filmMm += stepS * kOozesMmS * std::exp((v.openedS - timeS) / kStopsS);
        heightMm_[i] = -down.dot(groundMm(v)) + std::max(kLevels, -down.dot(v.normal)) * v.filmMm;
    }
    for (const Edge& edge : edges_) {
        const bool isDown = heightMm_[edge.from] > heightMm_[edge.to];
        const std::uint32_t from = isDown ? edge.from : edge.to, to = isDown ? edge.to : edge.from;
        const Vertex& upper = vertices_[from];
        const double film = upper.filmMm - kStaysMm;
        if (film <= 0.0) continue;
        constexpr double kWide = 0.6;  // of the edge between two vertices' shares of the surface, by their distance
        const double slope = (heightMm_[from] - heightMm_[to]) / edge.lengthMm;
        const double mm3 = std::min(kRuns * film * film * film * slope * kWide * edge.lengthMm * stepS,
                                    kMostShare * film * upper.areaMm2);
        gainMm3_[from] -= mm3;
        gainMm3_[to] += mm3;
    }
    for (std::size_t i = 0; i < vertices_.size(); ++i)
        if (gainMm3_[i] != 0.0) vertices_[i].filmMm += gainMm3_[i] / std::max(1e-6, vertices_[i].areaMm2);
}

MeshPiece WoundedGingiva::meshOf(std::uint32_t piece, const std::vector<Vec3>& placesMm,
                                 const std::vector<Vec3>& normals) const {
    MeshPiece mesh;
    std::unordered_map<std::uint64_t, std::uint16_t> known;
    for (const Face& face : faces_) {
        if (face.piece != piece) continue;
        std::array<std::uint16_t, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t i = face.corners[k];
            const Vertex& v = vertices_[i];
            const std::uint32_t normal = packedNormal(floats(normals[i].norm() > 0.0 ? normals[i] : face.normals[k]));
            const auto [at, isNew] =
                known.try_emplace(std::uint64_t{i} << 32 | normal, static_cast<std::uint16_t>(mesh.vertices.size()));
            if (isNew) {
                const double red = std::max(v.filmMm, std::min(v.depthMm, kFleshMm));
                mesh.vertices.push_back({floats(placesMm[i]), normal, static_cast<std::uint8_t>(cases::Tissue::gum),
                                         static_cast<std::uint8_t>(255.0 * std::clamp(red / kOpaqueMm, 0.0, 1.0)),
                                         static_cast<std::uint16_t>(std::clamp(1000.0f * v.underMm, 0.0f, 65535.0f))});
            }
            corners[k] = at->second;
        }
        mesh.triangles.push_back(corners);
    }
    return mesh;
}

std::vector<std::pair<std::uint32_t, MeshPiece>> WoundedGingiva::takeChanged(bool all) {
    for (auto& [piece, isChanged] : pieces_)
        isChanged = isChanged || all;
    for (const Face& face : faces_)
        for (const std::uint32_t corner : face.corners)
            if (std::abs(vertices_[corner].filmMm - vertices_[corner].drawnFilmMm) > kSeenFilmMm)
                pieces_[face.piece] = true;
    std::vector<Vec3> placesMm(vertices_.size()), normals(vertices_.size(), Vec3::Zero());
    std::vector<bool> isMoved(vertices_.size()), isBeside(vertices_.size());
    // A film's surface is smoother than what it lies on: half of it is what lies beside.
    std::vector<double> besideMm(vertices_.size()), beside(vertices_.size());
    for (const Edge& edge : edges_) {
        besideMm[edge.from] += vertices_[edge.to].filmMm, beside[edge.from] += 1.0;
        besideMm[edge.to] += vertices_[edge.from].filmMm, beside[edge.to] += 1.0;
    }
    constexpr double kThickestMm = 0.25;  // drawn: thicker it would stand over a wound's edge in spikes
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
        const double mean = beside[i] > 0.0 ? besideMm[i] / beside[i] : 0.0;
        const double filmMm = std::min(kThickestMm, 0.5 * (vertices_[i].filmMm + mean));
        placesMm[i] = groundMm(vertices_[i]) + filmMm * vertices_[i].normal;
        isMoved[i] = (placesMm[i] - vertices_[i].restMm).squaredNorm() > 1e-8;
    }
    for (const Face& face : faces_) {
        const auto& [a, b, c] = face.corners;
        const Vec3 twice = (placesMm[b] - placesMm[a]).cross(placesMm[c] - placesMm[a]);
        const bool any = isMoved[a] || isMoved[b] || isMoved[c];
        for (const std::uint32_t corner : face.corners) {
            normals[corner] += twice;
            if (any) isBeside[corner] = true;
        }
    }
    // Where nothing moved the uncut surface's own normals stay, creases and all.
    for (std::size_t i = 0; i < vertices_.size(); ++i)
        normals[i] = isBeside[i] && normals[i].norm() > 0.0 ? Vec3(normals[i].normalized()) : Vec3(Vec3::Zero());
    for (const Face& face : faces_)
        if (pieces_[face.piece])
            for (const std::uint32_t corner : face.corners)
                vertices_[corner].drawnFilmMm = vertices_[corner].filmMm;
    std::vector<std::pair<std::uint32_t, MeshPiece>> changed;
    for (auto& [piece, isChanged] : pieces_)
        if (std::exchange(isChanged, false)) changed.emplace_back(piece, meshOf(piece, placesMm, normals));
    return changed;
}

}  // namespace handpiece::view
