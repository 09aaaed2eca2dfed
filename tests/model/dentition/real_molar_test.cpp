// SPDX-License-Identifier: Apache-2.0
// Crowns of generated upper molars beside that of a real one: how far apart the surfaces are, and how they bend.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <numbers>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "support/random.h"

namespace handpiece::dentition {
namespace {
using core::Vec3;
using geometry::TriangleMesh;

constexpr double kCrownMm = 5.0;  ///< below the highest cusp: what is compared

/// The classic industrial CT of a human molar; 0.133 mm a voxel is an estimate, so sizes are aligned, never compared.
TriangleMesh realMolar(const std::filesystem::path& path) {
    constexpr std::uint32_t kX = 103, kY = 94, kZ = 161;
    constexpr double kSpacingMm = 0.133, kOutside = 110.0;
    std::ifstream file(path, std::ios::binary);
    std::string line;
    while (std::getline(file, line) && !line.empty()) {
    }
    std::vector<char> raw(std::size_t{kX} * kY * kZ);
    file.read(raw.data(), static_cast<std::streamsize>(raw.size()));
    std::vector<float> values;
    for (const char c : raw) {
        const auto grey = static_cast<double>(static_cast<unsigned char>(c));
        // The pulp is darker than what the tooth is embedded in.
        values.push_back(static_cast<float>(
            grey < 10.0 ? -kSpacingMm : std::clamp((kOutside - grey) / 40.0, -1.0, 1.0) * kSpacingMm));
    }
    return geometry::isosurface(geometry::ScalarGrid{Vec3::Zero(), kSpacingMm, {kX, kY, kZ}, values});
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

/// How much the normal turns between faces half a millimetre apart on the crown [degrees], at these shares of all.
std::array<double, 3> bends(const TriangleMesh& mesh) {
    std::mt19937_64 generator(5);
    const double top = mesh.bounds().max.z();
    std::vector<Vec3> at, normal;
    for (const geometry::Triangle& t : mesh.triangles) {
        const Vec3 a = mesh.vertices[t[0]], n = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
        if (a.z() > top - kCrownMm && n.norm() > 1e-9) at.push_back(a), normal.push_back(n.normalized());
    }
    std::vector<double> angles;
    for (int i = 0; i < 400; ++i) {
        const auto one = static_cast<std::size_t>(test::uniform(generator, 0.0, static_cast<double>(at.size()) - 1.0));
        for (std::size_t j = i % 7; j < at.size(); j += 7)
            if (const double d = (at[j] - at[one]).norm(); d > 0.45 && d < 0.55)
                angles.push_back(core::acos(std::clamp(normal[j].dot(normal[one]), -1.0, 1.0)) * 180.0 /
                                 std::numbers::pi);
    }
    std::sort(angles.begin(), angles.end());
    const auto share = [&](double s) {
        return angles[static_cast<std::size_t>(s * static_cast<double>(angles.size() - 1))];
    };
    return {share(0.25), share(0.5), share(0.9)};
}

TEST(RealMolar, CrownsOfUpperMolarsAreLikeIt) {
    const std::filesystem::path folder = test::realDataFolder();
    const std::filesystem::path path = folder / "ge-tooth-ct" / "tooth_103x94x161_uint8.nrrd";
    if (folder.empty() || !std::filesystem::exists(path)) GTEST_SKIP() << "no real molar here";
    const TriangleMesh real = realMolar(path);
    const auto bendsReal = bends(real);
    fmt::print("real: normals turn by {:.0f} / {:.0f} / {:.0f} degrees within 0.5 mm (quarter, half, nine tenths)\n",
               bendsReal[0], bendsReal[1], bendsReal[2]);
    for (const int fdi : {16, 26, 17}) {
        const ToothForm form(fdi, {0, 40.0});
        geometry::IsosurfaceSettings settings;
        settings.spacingMm = 0.133;
        settings.lipschitz = ToothForm::kLipschitz;
        const TriangleMesh ours = geometry::isosurface(
            form.bounds(), [&](const Vec3& p) { return form.outer(p); }, settings);
        Vec3 size;
        const std::vector<Vec3> crown = crownOf(ours, 0.0, size);
        TriangleMesh moved = ours;
        const Vec3 shift =
            crown.front() - *std::find_if(ours.vertices.begin(), ours.vertices.end(),
                                          [&](const Vec3& v) { return v.z() > ours.bounds().max.z() - kCrownMm; });
        for (Vec3& v : moved.vertices)
            v += shift;
        const geometry::TriangleTree tree(moved);
        double best = 1e9, worst = 0.0;
        for (int degree = 0; degree < 360; degree += 10) {
            Vec3 realSize;
            const std::vector<Vec3> points = crownOf(real, degree * std::numbers::pi / 180.0, realSize);
            std::vector<double> away;
            for (std::size_t i = 0; i < points.size(); i += 11) {
                const Vec3 p(points[i].x() * size.x() / realSize.x(), points[i].y() * size.y() / realSize.y(),
                             points[i].z());
                away.push_back(std::abs(tree.signedDistance(p)));
            }
            std::sort(away.begin(), away.end());
            const double median = away[away.size() / 2];
            if (median < best) best = median, worst = away[away.size() * 9 / 10];
        }
        const auto b = bends(ours);
        fmt::print(
            "{}: surfaces {:.2f} mm apart in the median, {:.2f} at nine tenths; normals turn by {:.0f} / {:.0f} / "
            "{:.0f} degrees\n",
            fdi, best, worst, b[0], b[1], b[2]);
        EXPECT_LT(best, 0.6);
        // As wrinkled as nature, within a third.
        EXPECT_NEAR(b[1], bendsReal[1], bendsReal[1] / 3.0);
    }
}

}  // namespace
}  // namespace handpiece::dentition
