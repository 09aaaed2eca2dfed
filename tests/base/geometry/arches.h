// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Open intraoral scans, drawn at random: arches, rings and crowns with a scalloped, ragged border that is not flat and
/// may tuck in, with more holes beside.

#include <cmath>
#include <random>
#include <string>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/vec.h"
#include "support/random.h"

namespace handpiece::test {

struct OpenScan {
    std::string what;
    TriangleMesh mesh;
    std::size_t borderEdges = 0;  ///< of all its loops that are no holes
};

/// A band of `across` vertices over `along` places, closed in itself or not; a last row that is one point is a crown.
class ScanDrawer {
  public:
    explicit ScanDrawer(std::mt19937_64& generator) : generator_(generator) {}

    /// `edges` around the border, about.
    OpenScan draw(std::size_t edges) {
        static constexpr const char* kNames[] = {"arch", "ring", "crown"};
        const int kind = below(5) < 3 ? 0 : 1 + below(2);
        OpenScan scan;
        scan.what = kNames[kind];
        if (kind == 2)
            drawCrown(scan, std::min<std::size_t>(edges, 240));
        else
            drawBand(scan, edges, kind == 1);
        for (int holes = below(3); holes > 0; --holes)
            punch(scan);
        if (below(2) == 0) scan.mesh = insideOut(std::move(scan.mesh));
        return scan;
    }

  private:
    static constexpr double kPi = 3.14159265358979323846;

    int below(int n) { return static_cast<int>(uniform(generator_, 0, 1) * n); }
    double between(double low, double high) { return uniform(generator_, low, high); }

    void drawBand(OpenScan& scan, std::size_t edges, bool isRing) {
        const std::size_t across = 8 + static_cast<std::size_t>(below(14));
        const std::size_t along = std::max<std::size_t>(14, isRing ? edges / 2 : (edges + 4 - 2 * across) / 2);
        scan.borderEdges = isRing ? 2 * along : 2 * (along - 1) + 2 * (across - 1);
        const double wide = between(18, 27), deep = between(20, 38), half = between(3.5, 6.0), high = between(4, 8),
                     teeth = isRing ? 2.0 * std::floor(between(4, 9)) : between(4, 14), bump = between(0, 3),
                     bulge = between(0, 0.8), tuck = between(-0.3, 0.35), scallop = between(0, 0.3),
                     ragged = between(0, 0.25), cut = between(-0.3, 0.4), wave = between(0, 1.5),
                     phase = between(0, 2 * kPi);
        scan.what += " of " + std::to_string(scan.borderEdges) + " edges, tucked in by " + std::to_string(tuck) +
                     ", scallops " + std::to_string(scallop) + ", ragged " + std::to_string(ragged);
        for (std::size_t i = 0; i < along; ++i) {
            const double u = static_cast<double>(i) / static_cast<double>(isRing ? along : along - 1);
            const double t = isRing ? 2.0 * kPi * u : cut + (kPi - 2.0 * cut) * u;
            const core::Vec3 centre(wide * std::cos(t), deep * std::sin(t), wave * std::sin(2.0 * t + phase));
            const core::Vec3 out = core::Vec3(std::cos(t) / wide, std::sin(t) / deep, 0.0).normalized();
            const double tooth = std::abs(std::sin(teeth * kPi * u)), h = high + bump * tooth, w = half + bulge * tooth;
            for (std::size_t j = 0; j < across; ++j) {
                const double v = static_cast<double>(j) / static_cast<double>(across - 1);
                const double end = tuck + scallop * std::cos(2.0 * teeth * kPi * u + (v > 0.5 ? 0.0 : 1.0));
                const double a = -end + (kPi + 2.0 * end) * v, s = std::sin(a);
                core::Vec3 p =
                    centre - w * std::cos(a) * out + core::Vec3(0, 0, s > 0.0 ? h * std::pow(s, 0.7) : 1.2 * h * s);
                const bool onBorder = j == 0 || j == across - 1 || (!isRing && (i == 0 || i == along - 1));
                p += (onBorder ? ragged : 0.1 * ragged) * between(0, 1) * randomDirection(generator_);
                scan.mesh.vertices.push_back(p);
            }
        }
        const auto at = [&](std::size_t i, std::size_t j) {
            return static_cast<std::uint32_t>(i % along * across + j);
        };
        for (std::size_t i = 0; i + (isRing ? 0 : 1) < along; ++i)
            for (std::size_t j = 0; j + 1 < across; ++j) {
                scan.mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
                scan.mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
            }
    }

    void drawCrown(OpenScan& scan, std::size_t edges) {
        scan.borderEdges = edges;
        const std::size_t rings = 6 + static_cast<std::size_t>(below(20));
        const double radius = between(3, 6), high = between(3, 8), tuck = between(-0.2, 0.5),
                     scallop = between(0, 0.35), ragged = between(0, 0.12), lobes = std::floor(between(2, 6)),
                     cusps = between(0, 1.0);
        scan.what += " of " + std::to_string(edges) + " edges, tucked in by " + std::to_string(tuck) + ", scallops " +
                     std::to_string(scallop) + ", ragged " + std::to_string(ragged);
        scan.mesh.vertices.emplace_back(0, 0, high);
        for (std::size_t r = 1; r <= rings; ++r)
            for (std::size_t i = 0; i < edges; ++i) {
                const double t = 2.0 * kPi * static_cast<double>(i) / static_cast<double>(edges);
                const double end = kPi / 2.0 + tuck + scallop * std::cos(lobes * t);
                const double a = end * static_cast<double>(r) / static_cast<double>(rings);
                core::Vec3 p(radius * std::sin(a) * std::cos(t), radius * std::sin(a) * std::sin(t),
                             high * std::cos(a) + cusps * std::sin(a) * std::cos(a) * std::cos(4.0 * t));
                p += (r == rings ? ragged : 0.0) * between(0, 1) * randomDirection(generator_);
                scan.mesh.vertices.push_back(p);
            }
        const auto at = [&](std::size_t r, std::size_t i) {
            return r == 0 ? 0u : static_cast<std::uint32_t>(1 + (r - 1) * edges + i % edges);
        };
        for (std::size_t r = 0; r < rings; ++r)
            for (std::size_t i = 0; i < edges; ++i) {
                scan.mesh.triangles.push_back({at(r, i), at(r + 1, i), at(r + 1, i + 1)});
                if (r > 0) scan.mesh.triangles.push_back({at(r, i), at(r + 1, i + 1), at(r, i + 1)});
            }
    }

    // Where the scanner has seen nothing.
    void punch(OpenScan& scan) {
        const Triangle& t = scan.mesh.triangles[static_cast<std::size_t>(below(int(scan.mesh.triangles.size())))];
        const core::Vec3 place = scan.mesh.vertices[t[0]];
        const double radius = between(0.3, 2.0);
        scan.mesh = holed(std::move(scan.mesh), [&](const core::Vec3& c) { return (c - place).norm() < radius; });
    }

    std::mt19937_64& generator_;
};

}  // namespace handpiece::test
