// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/mesh_edges.h"
#include "handpiece/base/geometry/repair_base.h"
#include "handpiece/base/geometry/repair_holes.h"
#include "handpiece/base/geometry/self_intersection.h"

namespace handpiece::geometry {
namespace {

using core::Vec3;

constexpr std::uint32_t kNone = 0xffffffffu;
/// How far the copies of a vertex move apart, as a share of the box's diagonal.
constexpr double kApartShare = 4.0 * kAutomaticWeldShare;
/// A face that repair() made: no part of what came in.
constexpr std::uint32_t kMade = kNone;

class Mender {
  public:
    Mender(TriangleMesh mesh, const RepairSettings& settings) : mesh_(std::move(mesh)), settings_(settings) {}

    /// What comes out is what comes out of it again: every step looks at nothing but the mesh before it, and all of
    /// them are taken until they change nothing.
    TriangleMesh mend(RepairReport& report) {
        report_ = std::move(report);
        close();
        const double closedVolumeMm3 = enclosedVolumeMm3(mesh_);
        mendCrossings();
        tellCrossings();
        std::stable_sort(report_.holes.begin(), report_.holes.end(),
                         [](const ClosedHole& a, const ClosedHole& b) { return a.perimeterMm > b.perimeterMm; });
        requireLittleLost(closedVolumeMm3);
        report = std::move(report_);
        return std::move(mesh_);
    }

  private:
    void close() {
        constexpr int kPasses = 12;  // the second changes something only where damage lies on damage
        for (int pass = 0; pass < kPasses; ++pass) {
            const TriangleMesh before = mesh_;
            const RepairReport reportBefore = report_;
            closeOnce();
            if (mesh_.triangles != before.triangles || mesh_.vertices != before.vertices) continue;
            report_ = reportBefore;
            return;
        }
    }

    void closeOnce() {
        core::Box box;
        for (const Triangle& t : mesh_.triangles)
            for (const std::uint32_t v : t)
                box.extend(mesh_.vertices[v]);
        diagonalMm_ = box.size().norm();
        weldMm_ = settings_.weldMm < 0.0 ? kAutomaticWeldShare * diagonalMm_ : settings_.weldMm;
        weld();
        removeDuplicates();
        if (given_.empty()) noteWhatIsGiven();
        removeFins();
        agree();
        cutApart();
        agree();
        dropDebris();
        closeOpenLoops();
        turnFlatFaces();
        dropFlatShells();
        faceOutwards();
        removeUnusedVertices();
    }

    // Of each face from which shell it came, so that in the end one can tell what of them was lost.
    void noteWhatIsGiven() {
        const Shells shells = shellsOf(mesh_, MeshEdges(mesh_));
        const std::vector<std::uint32_t> depth = nestingOf(mesh_, shells, std::vector<std::uint8_t>(shells.count, 1));
        given_.resize(shells.count);
        source_ = shells.ofFace;
        for (std::size_t f = 0; f < mesh_.triangles.size(); ++f)
            given_[source_[f]].areaMm2 += areaOf(f);
        for (std::size_t s = 0; s < shells.count; ++s)
            given_[s].outermost = depth[s] == 0;
    }

    void closeOpenLoops() {
        const std::size_t before = mesh_.triangles.size();
        if (settings_.base && report_.bases.empty()) report_.bases = addBases(mesh_, settings_.baseDepthMm);
        const std::vector<ClosedHole> holes = closeHoles(mesh_);
        report_.holes.insert(report_.holes.end(), holes.begin(), holes.end());
        report_.addedFaces += mesh_.triangles.size() - before;
        source_.resize(mesh_.triangles.size(), kMade);
    }

    // Debris, sheets around nothing and patches in the place of others are told; of the rest little may be missing.
    void requireLittleLost(double closedVolumeMm3) {
        constexpr double kMaxDebris = 0.1;  // more is no debris, but the thing itself in pieces
        std::vector<double> kept(given_.size(), 0.0);
        for (std::size_t f = 0; f < mesh_.triangles.size(); ++f)
            if (source_[f] != kMade) kept[source_[f]] += areaOf(f);
        double outermost = 0.0, all = 0.0;
        for (std::size_t s = 0; s < given_.size(); ++s) {
            all += given_[s].areaMm2;
            if (!given_[s].outermost) continue;
            outermost += given_[s].areaMm2;
            report_.lostAreaMm2 += std::max(0.0, given_[s].areaMm2 - kept[s] - given_[s].toldMm2);
        }
        if (report_.lostAreaMm2 < 1e-12 * all) report_.lostAreaMm2 = 0.0;  // rounding
        const double mm3 = std::abs(enclosedVolumeMm3(mesh_) - closedVolumeMm3);
        constexpr const char* kEditor = "mend it in a mesh editor";
        if (report_.lostAreaMm2 > kMaxLostShare * outermost)
            throw core::Error(fmt::format("mending would lose {:.4g} mm2 ({:.1f} %) of the surface of {:.4g} mm2",
                                          report_.lostAreaMm2, 100.0 * report_.lostAreaMm2 / outermost, outermost),
                              "mesh", kEditor);
        if (mm3 > kMaxLostShare * std::abs(closedVolumeMm3))
            throw core::Error(fmt::format("mending what crosses would change the volume of {:.4g} mm3 by {:.4g} mm3",
                                          std::abs(closedVolumeMm3), mm3),
                              "mesh", kEditor);
        if (report_.droppedAreaMm2 > kMaxDebris * all)
            throw core::Error(
                fmt::format("the surface lies in pieces: {} of less than {:.3g} % of the largest have {:.1f} % "
                            "of its area together",
                            report_.droppedShells, 100.0 * settings_.debrisAreaShare,
                            100.0 * report_.droppedAreaMm2 / all),
                "mesh", "weld it (--weld), keep the pieces (--keep-debris), or mend it in a mesh editor");
    }

    [[nodiscard]] Vec3 centreOf(std::size_t face) const {
        const Triangle& t = mesh_.triangles[face];
        return (mesh_.vertices[t[0]] + mesh_.vertices[t[1]] + mesh_.vertices[t[2]]) / 3.0;
    }
    [[nodiscard]] double areaOf(std::size_t face) const {
        const Triangle& t = mesh_.triangles[face];
        const Vec3& a = mesh_.vertices[t[0]];
        return 0.5 * (mesh_.vertices[t[1]] - a).cross(mesh_.vertices[t[2]] - a).norm();
    }

    // Removes the faces that are marked; returns how many.
    std::size_t removeFaces(const std::vector<std::uint8_t>& marked) {
        std::size_t kept = 0;
        for (std::size_t f = 0; f < mesh_.triangles.size(); ++f) {
            if (marked[f]) continue;
            if (!source_.empty()) source_[kept] = source_[f];
            mesh_.triangles[kept++] = mesh_.triangles[f];
        }
        const std::size_t removed = mesh_.triangles.size() - kept;
        mesh_.triangles.resize(kept);
        if (!source_.empty()) source_.resize(kept);
        return removed;
    }

    // Each vertex goes to the earliest one within the distance; a grid finds it.
    void weld() {
        const double tolerance = weldMm_;
        // Finer than doubles of this size can tell apart: only equal places are one.
        const double cellMm = std::max({2.0 * tolerance, 1e-12 * diagonalMm_, 1e-300});
        const Vec3 origin = mesh_.bounds().min;
        std::unordered_map<std::uint64_t, std::uint32_t> head;
        head.reserve(mesh_.vertices.size());
        std::vector<std::uint32_t> nextInCell(mesh_.vertices.size(), kNone), becomes(mesh_.vertices.size());
        using Cell = std::array<std::int64_t, 3>;
        const auto cellOf = [&](const Vec3& p) {
            return Cell{static_cast<std::int64_t>((p.x() - origin.x()) / cellMm),
                        static_cast<std::int64_t>((p.y() - origin.y()) / cellMm),
                        static_cast<std::int64_t>((p.z() - origin.z()) / cellMm)};
        };
        const auto keyOf = [](const Cell& c) {
            return static_cast<std::uint64_t>(c[0]) * 0x9E3779B97F4A7C15ull ^
                   static_cast<std::uint64_t>(c[1]) * 0xC2B2AE3D27D4EB4Full ^
                   static_cast<std::uint64_t>(c[2]) * 0x165667B19E3779F9ull;
        };
        std::vector<std::uint8_t> used(mesh_.vertices.size(), 0);
        for (const Triangle& t : mesh_.triangles)
            for (const std::uint32_t v : t)
                used[v] = 1;
        for (std::uint32_t v = 0; v < mesh_.vertices.size(); ++v) {
            becomes[v] = v;
            if (!used[v]) continue;
            const Vec3& p = mesh_.vertices[v];
            const Cell low = cellOf(p - Vec3::Constant(tolerance)), high = cellOf(p + Vec3::Constant(tolerance));
            std::uint32_t earliest = kNone;
            for (std::int64_t z = low[2]; z <= high[2]; ++z)
                for (std::int64_t y = low[1]; y <= high[1]; ++y)
                    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
                        const auto found = head.find(keyOf({x, y, z}));
                        if (found == head.end()) continue;
                        for (std::uint32_t w = found->second; w != kNone; w = nextInCell[w])
                            if ((mesh_.vertices[w] - p).norm() <= tolerance) earliest = std::min(earliest, w);
                    }
            if (earliest != kNone) {
                becomes[v] = earliest;
                ++report_.weldedVertices;
                continue;
            }
            const auto [place, isNew] = head.try_emplace(keyOf(cellOf(p)), v);
            if (!isNew) {
                nextInCell[v] = place->second;
                place->second = v;
            }
        }
        std::vector<std::uint8_t> degenerate(mesh_.triangles.size(), 0);
        for (std::size_t f = 0; f < mesh_.triangles.size(); ++f) {
            for (std::uint32_t& v : mesh_.triangles[f])
                v = becomes[v];
            degenerate[f] = repeatsCorner(mesh_.triangles[f]);
        }
        report_.removedDegenerateFaces += removeFaces(degenerate);
    }

    // Of faces with the same corners one stays; of two back to back inside a wall that others share, none.
    void removeDuplicates() {
        std::vector<std::uint32_t> order(mesh_.triangles.size());
        std::vector<Triangle> key(mesh_.triangles);
        std::iota(order.begin(), order.end(), 0u);
        for (Triangle& t : key)
            std::sort(t.begin(), t.end());
        std::sort(order.begin(), order.end(),
                  [&](std::uint32_t a, std::uint32_t b) { return key[a] != key[b] ? key[a] < key[b] : a < b; });
        std::vector<std::uint8_t> marked(mesh_.triangles.size(), 0);
        std::vector<std::pair<std::size_t, std::size_t>> groups;
        for (std::size_t i = 0, j; i < order.size(); i = j) {
            for (j = i + 1; j < order.size() && key[order[j]] == key[order[i]]; ++j) {
            }
            if (j - i > 1) groups.emplace_back(i, j);
        }
        if (groups.empty()) return;
        const MeshEdges edges(mesh_);
        const auto facesAt = [&](std::uint32_t a, std::uint32_t b) {
            const auto e = std::lower_bound(
                edges.edges().begin(), edges.edges().end(), std::pair(a, b),
                [](const MeshEdges::Edge& edge, const auto& ab) { return std::pair(edge.low, edge.high) < ab; });
            return std::size_t{e->count};
        };
        const auto isEven = [](const Triangle& t) { return (t[0] < t[1]) == ((t[1] < t[2]) == (t[0] < t[2])); };
        for (const auto& [begin, end] : groups) {
            const Triangle& corners = key[order[begin]];
            const std::size_t copies = end - begin;
            std::size_t even = 0, most = 0;
            for (std::size_t i = begin; i < end; ++i)
                even += isEven(mesh_.triangles[order[i]]);
            for (const auto& [a, b] : {std::pair(corners[0], corners[1]), std::pair(corners[1], corners[2]),
                                       std::pair(corners[0], corners[2])})
                most = std::max(most, facesAt(a, b) - copies);
            const bool isWall = 2 * even == copies && most > 1;
            const bool keepEven = 2 * even > copies || (2 * even == copies && isEven(mesh_.triangles[order[begin]]));
            bool kept = isWall;
            for (std::size_t i = begin; i < end; ++i) {
                const bool keep = !kept && isEven(mesh_.triangles[order[i]]) == keepEven;
                kept = kept || keep;
                marked[order[i]] = !keep;
            }
        }
        report_.removedDuplicateFaces += removeFaces(marked);
    }

    // A small sheet that ends in the open and hangs on an edge of three or more faces is no part of a closed surface. A
    // large one is that surface, with a hole somewhere and something stuck to it somewhere else.
    void removeFins() {
        for (bool changed = true; changed;) {
            changed = false;
            const MeshEdges edges(mesh_);
            DisjointSets sets(mesh_.triangles.size());
            for (const MeshEdges::Edge& e : edges.edges())
                if (e.count == 2) sets.join(edges.halfEdges(e)[0] / 3, edges.halfEdges(e)[1] / 3);
            std::vector<std::uint8_t> isOpen(mesh_.triangles.size(), 0);  // by the sheet's first face
            std::vector<std::pair<std::uint32_t, std::uint32_t>>
                forks;                             // sheet, edge; once for each of its faces there
            std::vector<std::uint32_t> facesLeft;  // by edge
            for (const MeshEdges::Edge& e : edges.edges()) {
                facesLeft.push_back(e.count);
                for (const HalfEdge h : edges.halfEdges(e)) {
                    if (e.count == 1) isOpen[sets.find(h / 3)] = 1;
                    if (e.count > 2)
                        forks.emplace_back(sets.find(h / 3), static_cast<std::uint32_t>(facesLeft.size() - 1));
                }
            }
            if (forks.empty()) return;
            std::sort(forks.begin(), forks.end());
            std::vector<double> area(mesh_.triangles.size(), 0.0);
            for (std::uint32_t f = 0; f < mesh_.triangles.size(); ++f)
                area[sets.find(f)] += areaOf(f);
            double left = kMaxLostShare * std::accumulate(area.begin(), area.end(), 0.0) - report_.removedFinAreaMm2;
            std::vector<std::uint32_t> sheets;
            for (const auto& fork : forks)
                if (isOpen[fork.first] && area[fork.first] <= left && (sheets.empty() || sheets.back() != fork.first))
                    sheets.push_back(fork.first);
            // The smallest first, and only while its edges still fork: without the others it may be whole.
            std::stable_sort(sheets.begin(), sheets.end(),
                             [&](std::uint32_t a, std::uint32_t b) { return area[a] < area[b]; });
            std::vector<std::uint8_t> drop(mesh_.triangles.size(), 0), marked(mesh_.triangles.size(), 0);
            for (const std::uint32_t sheet : sheets) {
                const auto [begin, end] =
                    std::equal_range(forks.begin(), forks.end(), std::pair(sheet, 0u),
                                     [](const auto& a, const auto& b) { return a.first < b.first; });
                if (area[sheet] > left ||
                    std::any_of(begin, end, [&](const auto& fork) { return facesLeft[fork.second] < 3; }))
                    continue;
                left -= area[sheet];
                report_.removedFinAreaMm2 += area[sheet];
                for (auto fork = begin; fork != end; ++fork)
                    --facesLeft[fork->second];
                drop[sheet] = 1;
                changed = true;
            }
            for (std::uint32_t f = 0; f < mesh_.triangles.size(); ++f)
                marked[f] = drop[sets.find(f)];
            report_.removedFinFaces += removeFaces(marked);
        }
    }

    void agree() {
        const Orientation orientation = agreeingOrientation(mesh_, MeshEdges(mesh_));
        if (!orientation.orientable)
            throw core::Error("the surface has only one side (like a Moebius strip) and cannot be oriented", "mesh",
                              "cut it open in a mesh editor");
        for (std::size_t f = 0; f < mesh_.triangles.size(); ++f)
            if (orientation.turn[f]) std::swap(mesh_.triangles[f][1], mesh_.triangles[f][2]);
        report_.turnedFaces += orientation.turned;
    }

    // The half-edges of an edge in pairs that belong to one surface: around the edge, the two faces that hold solid
    // between them. What finds no partner stays open.
    void pairUp(const MeshEdges::Edge& e, std::span<const HalfEdge> half, std::vector<HalfEdge>& across) const {
        if (half.size() == 2) {
            across[half[0]] = half[1];
            across[half[1]] = half[0];
            return;
        }
        struct Sheet {
            double angle;
            HalfEdge halfEdge;
            bool upwards;  // runs from the lower to the higher vertex: solid lies before it, seen in growing angle
        };
        const Vec3 axis = (mesh_.vertices[e.high] - mesh_.vertices[e.low]).normalized();
        const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
        std::vector<Sheet> sheets;
        for (const HalfEdge h : half) {
            const Vec3 arm = mesh_.vertices[fromVertex(mesh_, previousHalfEdge(h))] - mesh_.vertices[e.low];
            sheets.push_back({core::atan2(v.dot(arm), u.dot(arm)), h, fromVertex(mesh_, h) == e.low});
        }
        std::sort(sheets.begin(), sheets.end(), [](const Sheet& a, const Sheet& b) {
            return a.angle != b.angle ? a.angle < b.angle : a.halfEdge < b.halfEdge;
        });
        const auto pairAt = [&](std::size_t i, std::size_t j) {
            across[sheets[i].halfEdge] = sheets[j].halfEdge;
            across[sheets[j].halfEdge] = sheets[i].halfEdge;
            sheets.erase(sheets.begin() + static_cast<std::ptrdiff_t>(std::max(i, j)));
            sheets.erase(sheets.begin() + static_cast<std::ptrdiff_t>(std::min(i, j)));
        };
        for (bool found = true; found && sheets.size() > 1;) {
            found = false;
            for (std::size_t i = 0; i < sheets.size() && !found; ++i) {
                const std::size_t j = (i + 1) % sheets.size();
                if (sheets[i].upwards || !sheets[j].upwards) continue;
                pairAt(i, j);
                found = true;
            }
        }
    }

    // Gives every fan of faces around a vertex a vertex of its own, and every pair of faces its own edge.
    void cutApart() {
        constexpr int kPasses = 8;  // an edge between two vertices that stay joined elsewhere needs another pass
        for (int pass = 0; pass < kPasses; ++pass) {
            const MeshEdges edges(mesh_);
            std::vector<HalfEdge> across(3 * mesh_.triangles.size(), kNone);
            std::size_t forks = 0;
            for (const MeshEdges::Edge& e : edges.edges()) {
                pairUp(e, edges.halfEdges(e), across);
                forks += e.count > 2;
            }
            if (pass == 0) report_.splitEdges += forks;
            separateFans(across);
            if (forks == 0) return;
            separateEdges();
        }
        const MeshEdges edges(mesh_);
        const auto forks = std::count_if(edges.edges().begin(), edges.edges().end(),
                                         [](const MeshEdges::Edge& e) { return e.count > 2; });
        if (forks > 0)
            throw core::Error(fmt::format("{} edges of more than two faces could not be cut apart", forks), "mesh",
                              "mend them in a mesh editor");
    }

    void separateFans(const std::vector<HalfEdge>& across) {
        DisjointSets fans(3 * mesh_.triangles.size());
        for (HalfEdge h = 0; h < across.size(); ++h) {
            const HalfEdge other = across[h];
            if (other == kNone || other < h) continue;
            const bool sameWay = fromVertex(mesh_, h) == fromVertex(mesh_, other);
            fans.join(h, sameWay ? other : nextHalfEdge(other));
            fans.join(nextHalfEdge(h), sameWay ? nextHalfEdge(other) : other);
        }
        const std::size_t count = mesh_.vertices.size();
        std::vector<std::uint32_t> ofFan(across.size(), kNone);
        std::vector<std::uint8_t> claimed(count, 0);
        std::vector<std::pair<Vec3, double>> pull;  // of the new vertices: sum of their faces' centres and their number
        for (HalfEdge h = 0; h < across.size(); ++h) {
            const std::uint32_t fan = fans.find(h), v = mesh_.triangles[h / 3][h % 3];
            if (ofFan[fan] == kNone) {
                ofFan[fan] = v;
                if (std::exchange(claimed[v], std::uint8_t{1})) {
                    ofFan[fan] = static_cast<std::uint32_t>(mesh_.vertices.size());
                    mesh_.vertices.push_back(mesh_.vertices[v].eval());
                    pull.emplace_back(Vec3::Zero(), 0.0);
                }
            }
            if (ofFan[fan] >= count) {
                auto& [sum, weight] = pull[ofFan[fan] - count];
                sum += centreOf(h / 3);
                weight += 1.0;
            }
        }
        for (HalfEdge h = 0; h < across.size(); ++h)
            mesh_.triangles[h / 3][h % 3] = ofFan[fans.find(h)];
        for (std::size_t i = 0; i < pull.size(); ++i)
            moveTowards(count + i, pull[i].first / pull[i].second);
        report_.splitVertices += pull.size();
    }

    // Two sheets that meet along an edge whose ends they share anyway: all but the first get a vertex in its middle.
    void separateEdges() {
        const MeshEdges edges(mesh_);
        std::vector<HalfEdge> across(3 * mesh_.triangles.size(), kNone);
        std::vector<std::uint8_t> touched(mesh_.triangles.size(), 0);
        for (const MeshEdges::Edge& e : edges.edges()) {
            if (e.count < 3) continue;
            const std::span<const HalfEdge> half = edges.halfEdges(e);
            if (std::any_of(half.begin(), half.end(), [&](HalfEdge h) { return touched[h / 3] != 0; })) continue;
            for (const HalfEdge h : half)
                touched[h / 3] = 1;
            pairUp(e, half, across);
            for (const HalfEdge h : half) {
                const HalfEdge other = across[h];
                if (h == half[0] || other == half[0] || (other != kNone && other < h)) continue;
                const auto middle = static_cast<std::uint32_t>(mesh_.vertices.size());
                mesh_.vertices.push_back(0.5 * (mesh_.vertices[e.low] + mesh_.vertices[e.high]));
                moveTowards(middle,
                            other == kNone ? centreOf(h / 3) : (0.5 * (centreOf(h / 3) + centreOf(other / 3))).eval());
                splitAt(h, middle);
                if (other != kNone) splitAt(other, middle);
                ++report_.splitVertices;
            }
        }
    }

    void splitAt(HalfEdge h, std::uint32_t middle) {
        Triangle rest = mesh_.triangles[h / 3];
        rest[h % 3] = middle;
        mesh_.triangles[h / 3][nextHalfEdge(h) % 3] = middle;
        mesh_.triangles.push_back(rest);
        source_.push_back(source_[h / 3]);
    }

    void moveTowards(std::size_t vertex, const Vec3& target) {
        const Vec3 way = target - mesh_.vertices[vertex];
        const double length = way.norm(), step = std::max(kApartShare * diagonalMm_, 4.0 * weldMm_);
        if (length > 0.0) mesh_.vertices[vertex] += way * (std::min(step, 0.25 * length) / length);
    }

    void dropShells(const Shells& shells, const std::vector<std::uint8_t>& drop) {
        std::vector<std::uint8_t> marked(mesh_.triangles.size(), 0);
        for (std::size_t f = 0; f < marked.size(); ++f)
            marked[f] = drop[shells.ofFace[f]];
        report_.droppedShells += static_cast<std::size_t>(std::count(drop.begin(), drop.end(), std::uint8_t{1}));
        report_.droppedFaces += removeFaces(marked);
    }

    [[nodiscard]] std::vector<double> areasOf(const Shells& shells) const {
        std::vector<double> area(shells.count, 0.0);
        for (std::size_t f = 0; f < mesh_.triangles.size(); ++f)
            area[shells.ofFace[f]] += areaOf(f);
        return area;
    }

    // The faces' area is told in the report, and no loss.
    void tell(std::size_t face) {
        if (source_[face] != kMade) given_[source_[face]].toldMm2 += areaOf(face);
    }

    void dropDebris() {
        const MeshEdges edges(mesh_);
        const Shells shells = shellsOf(mesh_, edges);
        const std::vector<double> area = areasOf(shells), volume = shellVolumesMm3(mesh_, shells);
        const double largest = area.empty() ? 0.0 : *std::max_element(area.begin(), area.end());
        std::vector<std::uint8_t> drop(shells.count, 0), isOpen(shells.count, 0);
        for (const MeshEdges::Edge& e : edges.edges())
            if (e.count == 1) isOpen[shells.ofFace[edges.halfEdges(e)[0] / 3]] = 1;
        for (std::size_t s = 0; s < shells.count; ++s) {
            drop[s] = area[s] < settings_.debrisAreaShare * largest;
            if (!drop[s]) continue;
            report_.droppedAreaMm2 += area[s];
            if (!isOpen[s]) report_.droppedVolumeMm3 += std::abs(volume[s]);
        }
        // An open piece of something larger is no debris but a loss.
        for (std::size_t f = 0; f < mesh_.triangles.size(); ++f) {
            const std::uint32_t s = shells.ofFace[f];
            if (drop[s] &&
                (!isOpen[s] || source_[f] == kMade || given_[source_[f]].areaMm2 < settings_.debrisAreaShare * largest))
                tell(f);
        }
        dropShells(shells, drop);
    }

    // A face without height has a corner on its longest side: it and the neighbour there become two faces from that
    // corner, which covers the same surface.
    void turnFlatFaces() {
        constexpr double kFlat = 1e-6;  // height over longest side
        constexpr int kPasses = 4;      // a turned neighbour may be flat in its turn
        const auto heightRatio = [&](const Triangle& t, std::size_t side) {
            const Vec3 &a = mesh_.vertices[t[side]], &b = mesh_.vertices[t[(side + 1) % 3]],
                       &c = mesh_.vertices[t[(side + 2) % 3]];
            return (b - a).cross(c - a).norm() / (b - a).squaredNorm();
        };
        const auto longestSide = [&](const Triangle& t) {
            std::array<double, 3> length;
            for (std::size_t k = 0; k < 3; ++k)
                length[k] = (mesh_.vertices[t[(k + 1) % 3]] - mesh_.vertices[t[k]]).squaredNorm();
            return static_cast<std::size_t>(std::max_element(length.begin(), length.end()) - length.begin());
        };
        const auto isFlat = [&](const Triangle& t) { return heightRatio(t, longestSide(t)) < kFlat; };
        for (int pass = 0; pass < kPasses; ++pass) {
            const MeshEdges edges(mesh_);
            std::vector<std::uint8_t> touched(mesh_.triangles.size(), 0);
            std::size_t turned = 0;
            std::set<std::pair<std::uint32_t, std::uint32_t>> added;
            for (const MeshEdges::Edge& e : edges.edges()) {
                if (e.count != 2) continue;
                for (std::size_t k = 0; k < 2; ++k) {
                    const HalfEdge h = edges.halfEdges(e)[k], other = edges.halfEdges(e)[1 - k];
                    Triangle &flat = mesh_.triangles[h / 3], &neighbour = mesh_.triangles[other / 3];
                    if (touched[h / 3] || touched[other / 3] || longestSide(flat) != h % 3 || !isFlat(flat)) continue;
                    const std::uint32_t a = fromVertex(mesh_, h), b = toVertex(mesh_, h),
                                        c = fromVertex(mesh_, previousHalfEdge(h)),
                                        d = fromVertex(mesh_, previousHalfEdge(other));
                    const Triangle one{a, d, c}, two{d, b, c};
                    if (c == d || hasEdge(edges, c, d) || isFlat(one) || isFlat(two) ||
                        !added.emplace(std::min(c, d), std::max(c, d)).second)
                        continue;
                    flat = one;
                    neighbour = two;
                    source_[h / 3] = source_[other / 3] = std::min(source_[h / 3], source_[other / 3]);
                    touched[h / 3] = touched[other / 3] = 1;
                    ++turned;
                }
            }
            report_.turnedFlatFaces += turned;
            if (turned == 0) return;
        }
    }

    [[nodiscard]] static bool hasEdge(const MeshEdges& edges, std::uint32_t a, std::uint32_t b) {
        const std::pair wanted(std::min(a, b), std::max(a, b));
        const auto found =
            std::lower_bound(edges.edges().begin(), edges.edges().end(), wanted,
                             [](const MeshEdges::Edge& e, const auto& ab) { return std::pair(e.low, e.high) < ab; });
        return found != edges.edges().end() && std::pair(found->low, found->high) == wanted;
    }

    // Where a few faces cross, they and a little around them give way to a new patch; solids that overlap stay as they
    // are.
    void mendCrossings() {
        constexpr int kWidestRing = 4;
        constexpr int kMaxPatches = 64;  // each leaves fewer crossings than there were
        report_.crossingFaces = selfIntersections(mesh_).size();
        int ring = 0;
        for (int patches = 0; patches < kMaxPatches && ring <= kWidestRing && report_.crossingFaces > 0;) {
            Mender patched = *this;
            if (patched.patch(ring) && patched.report_.crossingFaces < report_.crossingFaces) {
                *this = std::move(patched);
                ring = 0;
                ++patches;
            } else {
                ++ring;
            }
        }
    }

    void tellCrossings() {
        if (report_.crossingFaces == 0) return;
        const std::vector<CrossingFaces> crossings = selfIntersections(mesh_);
        report_.firstCrossingMm = crossings.front().pointMm;
        report_.crossingMade =
            static_cast<std::size_t>(std::count_if(crossings.begin(), crossings.end(), [&](const CrossingFaces& c) {
                return source_[c.first] == kMade || source_[c.second] == kMade;
            }));
    }

    // Takes the faces that cross, and `rings` of their neighbours, out and closes what is open then. False where that
    // is no local matter.
    bool patch(int rings) {
        constexpr double kLargestShare = 0.05;  // of the faces and of the area
        std::vector<std::uint8_t> marked(mesh_.triangles.size(), 0);
        for (const CrossingFaces& c : selfIntersections(mesh_))
            marked[c.first] = marked[c.second] = 1;
        for (int ring = 0; ring < rings; ++ring)
            growByOneRing(marked);
        std::size_t taken = 0;
        double areaMm2 = 0.0;
        for (std::size_t f = 0; f < marked.size(); ++f) {
            if (!marked[f]) continue;
            ++taken;
            areaMm2 += areaOf(f);
            tell(f);
        }
        if (static_cast<double>(taken) > kLargestShare * static_cast<double>(marked.size()) ||
            areaMm2 > kLargestShare * surfaceAreaMm2(mesh_))
            return false;
        const double volumeMm3 = enclosedVolumeMm3(mesh_);
        report_.removedCrossingFaces += removeFaces(marked);
        report_.removedCrossingAreaMm2 += areaMm2;
        dropOpenScraps(taken);
        try {
            const std::size_t holes = report_.holes.size();
            cutApart();
            closeOpenLoops();
            report_.holes.resize(holes);  // of our own making
            close();
        } catch (const core::Error&) {
            return false;  // this spot cannot be mended so
        }
        report_.crossingFaces = selfIntersections(mesh_).size();
        return std::abs(enclosedVolumeMm3(mesh_) - volumeMm3) <= kMaxLostShare * std::abs(volumeMm3);
    }

    void growByOneRing(std::vector<std::uint8_t>& marked) const {
        std::vector<std::uint8_t> touched(mesh_.vertices.size(), 0);
        for (std::size_t f = 0; f < marked.size(); ++f)
            if (marked[f])
                for (const std::uint32_t v : mesh_.triangles[f])
                    touched[v] = 1;
        for (std::size_t f = 0; f < marked.size(); ++f)
            for (const std::uint32_t v : mesh_.triangles[f])
                marked[f] |= touched[v];
    }

    // Bits that taking faces out has cut loose.
    void dropOpenScraps(std::size_t largestFaces) {
        const MeshEdges edges(mesh_);
        const Shells shells = shellsOf(mesh_, edges);
        std::vector<std::size_t> faces(shells.count, 0);
        for (const std::uint32_t s : shells.ofFace)
            ++faces[s];
        std::vector<std::uint8_t> drop(shells.count, 0), marked(mesh_.triangles.size(), 0);
        for (const MeshEdges::Edge& e : edges.edges()) {
            const std::uint32_t s = shells.ofFace[edges.halfEdges(e)[0] / 3];
            if (e.count == 1 && faces[s] <= largestFaces) drop[s] = 1;
        }
        for (std::size_t f = 0; f < marked.size(); ++f) {
            if (!drop[shells.ofFace[f]]) continue;
            marked[f] = 1;
            report_.removedCrossingAreaMm2 += areaOf(f);
            tell(f);
        }
        report_.removedCrossingFaces += removeFaces(marked);
    }

    // Closed, but around nothing.
    void dropFlatShells() {
        const Shells shells = shellsOf(mesh_, MeshEdges(mesh_));
        const std::vector<double> volume = shellVolumesMm3(mesh_, shells), area = areasOf(shells);
        std::vector<std::uint8_t> drop(shells.count, 0);
        for (std::size_t s = 0; s < shells.count; ++s)
            drop[s] = std::abs(volume[s]) <= 1e-9 * core::pow(area[s], 1.5);
        // A sheet that lay there by itself held nothing; one that was part of something larger is a loss.
        std::vector<double> flatMm2(given_.size(), 0.0);
        for (std::size_t f = 0; f < mesh_.triangles.size(); ++f)
            if (drop[shells.ofFace[f]] && source_[f] != kMade) flatMm2[source_[f]] += areaOf(f);
        for (std::size_t s = 0; s < given_.size(); ++s)
            if (flatMm2[s] > 0.99 * given_[s].areaMm2) given_[s].toldMm2 += flatMm2[s];
        dropShells(shells, drop);
        if (mesh_.triangles.empty())
            throw core::Error("nothing of the mesh encloses a volume", "mesh",
                              "give a surface that is closed but for its holes");
    }

    void faceOutwards() {
        const Shells shells = shellsOf(mesh_, MeshEdges(mesh_));
        const std::vector<double> volume = shellVolumesMm3(mesh_, shells);
        const std::vector<std::uint32_t> depth = nestingOf(mesh_, shells, std::vector<std::uint8_t>(shells.count, 1));
        for (std::size_t f = 0; f < mesh_.triangles.size(); ++f) {
            const std::uint32_t s = shells.ofFace[f];
            if ((volume[s] > 0.0) == (depth[s] % 2 == 0)) continue;
            std::swap(mesh_.triangles[f][1], mesh_.triangles[f][2]);
            ++report_.turnedFaces;
        }
    }

    void removeUnusedVertices() {
        std::vector<std::uint32_t> number(mesh_.vertices.size(), kNone);
        for (const Triangle& t : mesh_.triangles)
            for (const std::uint32_t v : t)
                number[v] = 0;
        std::uint32_t kept = 0;
        for (std::size_t v = 0; v < number.size(); ++v) {
            if (number[v] == kNone) continue;
            mesh_.vertices[kept] = mesh_.vertices[v].eval();
            number[v] = kept++;
        }
        mesh_.vertices.resize(kept);
        for (Triangle& t : mesh_.triangles)
            for (std::uint32_t& v : t)
                v = number[v];
    }

    /// A shell of what came in, welded.
    struct Given {
        double areaMm2 = 0.0, toldMm2 = 0.0;  ///< all of it; what went of it and is told
        bool outermost = true;
    };

    TriangleMesh mesh_;
    RepairSettings settings_;
    double diagonalMm_ = 0.0, weldMm_ = 0.0;
    std::vector<Given> given_;
    std::vector<std::uint32_t> source_;  ///< by face: its shell in given_, or kMade
    RepairReport report_;
};

}  // namespace

RepairReport repair(TriangleMesh& mesh, const RepairSettings& settings) {
    RepairReport report;
    report.before = inspect(mesh);
    if (mesh.triangles.empty()) throw core::Error("the mesh has no faces", "mesh");
    const double diagonalMm = report.before.boxMm.size().norm();
    if (!std::isfinite(settings.weldMm) || settings.weldMm > 0.1 * diagonalMm)
        throw core::Error(
            fmt::format("a welding distance of {} mm would melt a mesh of {:.4g} mm", settings.weldMm, diagonalMm),
            "--weld", "give a distance below the smallest detail");
    if (!std::isfinite(settings.baseDepthMm) || settings.baseDepthMm > 10.0 * diagonalMm)
        throw core::Error(fmt::format("a base {} mm under a mesh of {:.4g} mm", settings.baseDepthMm, diagonalMm),
                          "--base-depth", "give a depth of the size of the mesh at most");
    if (!(settings.debrisAreaShare >= 0.0 && settings.debrisAreaShare <= 1.0))
        throw core::Error("the share of the area below which a shell is debris must be 0 to 1", "debris");
    report.weldMm = settings.weldMm < 0.0 ? kAutomaticWeldShare * diagonalMm : settings.weldMm;
    TriangleMesh mended = Mender(mesh, settings).mend(report);
    report.after = inspect(mended);
    const MeshReport& after = report.after;
    if (!after.closed() || !after.oriented() || after.nonManifoldVertices > 0)
        throw core::Error(fmt::format("the mesh could not be mended: {} open edges, {} edges and {} vertices that are "
                                      "not manifold, {} flipped "
                                      "faces and {} shells inside out are left",
                                      after.openEdges, after.nonManifoldEdges, after.nonManifoldVertices,
                                      after.flippedFaces, after.insideOutShells),
                          "mesh", "mend it in a mesh editor");
    mesh = std::move(mended);
    return report;
}

void requireUncrossed(const RepairReport& report, const RepairSettings& settings, const std::string& where) {
    if (report.crossingFaces == 0) return;
    const core::Vec3& at = report.firstCrossingMm;
    const std::string pairs = fmt::format(
        "{} of faces, the first at ({:.3f}, {:.3f}, {:.3f})",
        report.crossingFaces == 1 ? "a pair" : fmt::format("{} pairs", report.crossingFaces), at.x(), at.y(), at.z());
    if (report.crossingMade == 0)
        throw core::Error("the surface crosses itself, and not only in small spots: " + pairs, where,
                          "unite solids that overlap, or cut out what crosses, in a mesh editor");
    throw core::Error("a hole cannot be closed without crossing the surface: " + pairs, where,
                      settings.base || report.holes.empty()
                          ? "trim the border where it folds under, or close it in a mesh editor"
                          : "stand its border on a base (handpiece mesh repair --base), trim it where it folds under, "
                            "or close it in a mesh editor");
}

}  // namespace handpiece::geometry
