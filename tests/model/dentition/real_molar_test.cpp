// SPDX-License-Identifier: Apache-2.0
// Crowns of generated molars beside two real ones: how far apart the surfaces are, and how they bend; and how far the
// two real ones are from each other.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "handpiece/scan/volume/read_scan.h"
#include "support/random.h"

namespace handpiece::dentition::real_molar_test {
namespace {
using core::Vec3;
using geometry::TriangleMesh;

constexpr double kCrownMm = 5.0;  ///< below the highest cusp: what is compared

constexpr double kSpacingMm = 0.133;  ///< of all volumes here

/// How full of tooth each voxel is, from 0 to 1.
struct Filled {
    std::array<std::uint32_t, 3> size{};
    std::vector<double> share;
};

/// All crowns are blurred alike, by a Gaussian of one voxel, before their surfaces are found.
TriangleMesh surfaceOf(Filled filled, const Vec3& origin) {
    constexpr double kWeights[] = {0.40262, 0.24420, 0.05449};  // of one voxel's spread; they sum to 1
    std::size_t step = 1;
    for (const std::uint32_t size : filled.size) {
        const std::vector<double> before = filled.share;
        for (std::size_t i = 0; i < before.size(); ++i) {
            const auto at = static_cast<std::ptrdiff_t>(i / step % size);
            double sum = 0.0;
            for (std::ptrdiff_t k = -2; k <= 2; ++k) {
                const std::ptrdiff_t other = std::clamp<std::ptrdiff_t>(at + k, 0, size - 1);
                sum += kWeights[std::abs(k)] *
                       before[i + static_cast<std::size_t>(other) * step - static_cast<std::size_t>(at) * step];
            }
            filled.share[i] = sum;
        }
        step *= size;
    }
    std::vector<float> values;
    for (const double share : filled.share)
        values.push_back(static_cast<float>((0.5 - share) * 2.0 * kSpacingMm));
    return geometry::isosurface(geometry::ScalarGrid{origin, kSpacingMm, filled.size, values});
}

/// The classic industrial CT of a human molar; 0.133 mm a voxel is an estimate, so sizes are aligned, never compared.
TriangleMesh industrialMolar(const std::filesystem::path& folder) {
    volume::ReadSettings settings;
    settings.spacingMm = Vec3::Constant(kSpacingMm);
    const volume::Volume scan =
        volume::readScan(folder / "ge-tooth-ct" / "tooth_103x94x161_uint8.nrrd", settings).volume;
    Filled filled;
    for (int axis = 0; axis < 3; ++axis)
        filled.size[static_cast<std::size_t>(axis)] =
            static_cast<std::uint32_t>(scan.grid.size[static_cast<std::size_t>(axis)]);
    // The pulp is darker than what the tooth is embedded in.
    for (const float grey : scan.values)
        filled.share.push_back(grey < 10.0f ? 1.0 : std::clamp((static_cast<double>(grey) - 70.0) / 80.0, 0.0, 1.0));
    return surfaceOf(std::move(filled), Vec3::Zero());
}

/// A carious upper molar in micro-CT, four voxels of 34 um to one; its crown looks along the file's x.
TriangleMesh cariousMolar(const std::filesystem::path& folder) {
    const volume::Volume scan = volume::readScan(folder / "molar-caries" / "molar_labels_34um_cropped.nrrd").volume;
    Filled filled;
    for (std::size_t axis = 0; axis < 3; ++axis)
        filled.size[axis] = static_cast<std::uint32_t>(scan.grid.size[(axis + 1) % 3] / 4 + 1);
    filled.share.resize(std::size_t{filled.size[0]} * filled.size[1] * filled.size[2]);
    for (int k = 0; k < scan.grid.size[2]; ++k)
        for (int j = 0; j < scan.grid.size[1]; ++j)
            for (int i = 0; i < scan.grid.size[0]; ++i)
                if (scan.values[scan.grid.index(i, j, k)] > 0.5f)
                    filled.share[(static_cast<std::size_t>(i / 4) * filled.size[1] + static_cast<std::size_t>(k / 4)) *
                                     filled.size[0] +
                                 static_cast<std::size_t>(j / 4)] += 1.0 / 64.0;
    return surfaceOf(std::move(filled), Vec3::Zero());
}

TriangleMesh generated(int fdi, std::uint64_t seed) {
    const ToothForm form(fdi, {seed, 40.0});
    const core::Box box = form.bounds();
    Filled filled;
    for (int axis = 0; axis < 3; ++axis)
        filled.size[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(box.size()[axis] / kSpacingMm) + 2;
    // Below the crown nothing is compared.
    const double from = form.mesialContactMm().z() - 5.0;
    for (std::uint32_t k = 0; k < filled.size[2]; ++k)
        for (std::uint32_t j = 0; j < filled.size[1]; ++j)
            for (std::uint32_t i = 0; i < filled.size[0]; ++i) {
                const Vec3 p = box.min + kSpacingMm * Vec3(i, j, k);
                filled.share.push_back(p.z() < from ? 0.0 : std::clamp(0.5 - form.outer(p) / kSpacingMm, 0.0, 1.0));
            }
    return surfaceOf(std::move(filled), box.min);
}

/// The crown's vertices, from the middle of its box across and the highest point; turned about z.
std::vector<Vec3> crownOf(const TriangleMesh& mesh, double rad, Vec3& size) {
    const double top = mesh.bounds().max.z(), c = core::cos(rad), s = core::sin(rad);
    std::vector<Vec3> crown;
    core::Box box;
    for (const Vec3& v : mesh.vertices)
        if (v.z() > top - kCrownMm) {
            crown.push_back({c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z() - top});
            box.extend(crown.back());
        }
    for (Vec3& v : crown)
        v.x() -= box.centre().x(), v.y() -= box.centre().y();
    size = box.size();
    return crown;
}

/// How the crown bends: a histogram of signed curvature [1/mm] between faces half a millimetre apart, in shares.
constexpr std::size_t kBins = 24;
constexpr double kSharpest = 3.0;
std::array<double, kBins> curvatures(const TriangleMesh& mesh, double& medianTurnDeg) {
    std::mt19937_64 generator(5);
    const double top = mesh.bounds().max.z();
    std::vector<Vec3> at, normal;
    for (const geometry::Triangle& t : mesh.triangles) {
        const Vec3 a = mesh.vertices[t[0]], n = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
        if (a.z() > top - kCrownMm && n.norm() > 1e-9) at.push_back(a), normal.push_back(n.normalized());
    }
    std::array<double, kBins> shares{};
    std::vector<double> turns;
    for (int i = 0; i < 500; ++i) {
        const auto one = static_cast<std::size_t>(test::uniform(generator, 0.0, static_cast<double>(at.size()) - 1.0));
        for (std::size_t j = static_cast<std::size_t>(i % 7); j < at.size(); j += 7) {
            const Vec3 d = at[j] - at[one];
            if (d.norm() < 0.45 || d.norm() > 0.55) continue;
            const double bend = (normal[j] - normal[one]).dot(d) / d.squaredNorm();
            const auto bin = static_cast<std::size_t>(
                std::clamp((bend / kSharpest + 1.0) / 2.0 * static_cast<double>(kBins), 0.0, kBins - 1.0));
            shares[bin] += 1.0;
            turns.push_back(core::acos(std::clamp(normal[j].dot(normal[one]), -1.0, 1.0)) * 180.0 / std::numbers::pi);
        }
    }
    for (double& share : shares)
        share /= static_cast<double>(turns.size());
    std::nth_element(turns.begin(), turns.begin() + static_cast<std::ptrdiff_t>(turns.size() / 2), turns.end());
    medianTurnDeg = turns[turns.size() / 2];
    return shares;
}
/// The share of one histogram that lies elsewhere in the other: 0 the same, 1 nothing in common.
double apart(const std::array<double, kBins>& a, const std::array<double, kBins>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < kBins; ++i)
        sum += 0.5 * std::abs(a[i] - b[i]);
    return sum;
}

/// Distances of the second crown's vertices from the first, turned for the best fit and brought to its width and depth.
struct Fit {
    double median = 1e9, nineTenths = 0.0;
    int degrees = 0;
};
Fit fitted(const TriangleMesh& mesh, const TriangleMesh& other, bool isMirrored) {
    Vec3 size;
    const std::vector<Vec3> crown = crownOf(mesh, 0.0, size);
    const double top = mesh.bounds().max.z();
    TriangleMesh moved = mesh;
    const Vec3 shift = crown.front() - *std::find_if(mesh.vertices.begin(), mesh.vertices.end(),
                                                     [&](const Vec3& v) { return v.z() > top - kCrownMm; });
    for (Vec3& v : moved.vertices)
        v += shift;
    const geometry::TriangleTree tree(moved);
    Fit best;
    const auto tried = [&](int degree) {
        Vec3 otherSize;
        std::vector<double> away;
        const std::vector<Vec3> points = crownOf(other, degree * std::numbers::pi / 180.0, otherSize);
        for (std::size_t i = 0; i < points.size(); i += 37) {
            const Vec3 p(points[i].x() * size.x() / otherSize.x(),
                         (isMirrored ? -1.0 : 1.0) * points[i].y() * size.y() / otherSize.y(), points[i].z());
            away.push_back(std::abs(tree.signedDistance(p)));
        }
        std::sort(away.begin(), away.end());
        if (away[away.size() / 2] < best.median) best = {away[away.size() / 2], away[away.size() * 9 / 10], degree};
    };
    for (int degree = 0; degree < 360; degree += 20)
        tried(degree);
    for (const int off : {-10, -5, 5, 10})
        tried(best.degrees + off);
    return best;
}

TEST(RealMolar, CrownsOfMolarsAreLikeIt) {
    const std::filesystem::path folder = test::realDataFolder();
    if (folder.empty() || !std::filesystem::exists(folder / "ge-tooth-ct") ||
        !std::filesystem::exists(folder / "molar-caries"))
        GTEST_SKIP() << "no real molars here";
    double turn[2];
    const TriangleMesh real[] = {industrialMolar(folder), cariousMolar(folder)};
    const std::array<double, kBins> bends[] = {curvatures(real[0], turn[0]), curvatures(real[1], turn[1])};
    const double yardstick = apart(bends[0], bends[1]);
    Fit each = fitted(real[0], real[1], false);
    if (const Fit other = fitted(real[0], real[1], true); other.median < each.median) each = other;
    fmt::print(
        "the two real ones: {:.2f} / {:.2f} mm apart (half, nine tenths), histograms of curvature {:.2f} apart, "
        "normals turn by {:.0f} and {:.0f} degrees within 0.5 mm in the median\n",
        each.median, each.nineTenths, yardstick, turn[0], turn[1]);
    for (const auto& [fdi, seed] : {std::pair{16, 0}, {16, 2}, {17, 0}, {46, 0}}) {
        const TriangleMesh ours = generated(fdi, static_cast<std::uint64_t>(seed));
        double own = 0.0;
        const std::array<double, kBins> ourBends = curvatures(ours, own);
        fmt::print("{}, seed {}: normals turn by {:.0f} degrees", fdi, seed, own);
        double least = 1e9;
        for (int i = 0; i < 2; ++i) {
            const double histograms = apart(ourBends, bends[i]);
            fmt::print("; from {} histograms {:.2f}", i == 0 ? "industrial CT" : "carious", histograms);
            EXPECT_LT(histograms, 0.15);
            // As wrinkled as nature, within a third.
            EXPECT_NEAR(own, turn[i], turn[i] / 3.0);
            if (fdi == 46) continue;  // both real ones are upper
            Fit fit = fitted(ours, real[i], false);
            if (const Fit other = fitted(ours, real[i], true); other.median < fit.median) fit = other;
            fmt::print(", {:.2f} / {:.2f} mm at {} degrees", fit.median, fit.nineTenths, fit.degrees);
            least = std::min(least, fit.median);
        }
        fmt::print("\n");
        if (fdi != 46) {
            EXPECT_LT(least, 0.4);
        }
    }
}

}  // namespace
}  // namespace handpiece::dentition::real_molar_test
