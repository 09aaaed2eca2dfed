// SPDX-License-Identifier: Apache-2.0
// Landmarks of real teeth (../shared/data) beside what their voxels say: the border of enamel and dentine outside, the
// highest places of the crown and of the pulp, all by brute force.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "handpiece/app/scan_case/scan_job.h"
#include "handpiece/scan/landmarks/find_landmarks.h"
#include "support/random.h"

namespace handpiece::landmarks::real_landmarks_test {
namespace {
using cases::Landmark;
using cases::LandmarkKind;
using core::Vec3;

constexpr std::uint8_t kEnamel = 2, kDentine = 3, kOutside = 255;

/// Labels on a grid, the empty voxels that the grid's edge reaches told apart from the hollows.
class Voxels {
  public:
    /// Each second voxel where they are as fine as that.
    explicit Voxels(const volume::Labels& given) {
        const int step = given.grid.spacingMm.x() < 0.05 ? 2 : 1;
        labels_.grid = given.grid;
        labels_.grid.spacingMm *= step;
        for (int& n : labels_.grid.size)
            n = (n + step - 1) / step;
        labels_.values.resize(labels_.grid.count());
        each([&](int i, int j, int k) { at(i, j, k) = given.values[given.grid.index(step * i, step * j, step * k)]; });
        std::vector<std::array<int, 3>> stack;
        const auto open = [&](int i, int j, int k) {
            if (!isIn(i, j, k) || at(i, j, k) != 0) return;
            at(i, j, k) = kOutside;
            stack.push_back({i, j, k});
        };
        const auto& size = labels_.grid.size;
        each([&](int i, int j, int k) {
            if (i == 0 || j == 0 || k == 0 || i + 1 == size[0] || j + 1 == size[1] || k + 1 == size[2]) open(i, j, k);
        });
        while (!stack.empty()) {
            const auto [i, j, k] = stack.back();
            stack.pop_back();
            for (const int d : {-1, 1}) {
                open(i + d, j, k);
                open(i, j + d, k);
                open(i, j, k + d);
            }
        }
    }
    /// Middles [mm, scanner's frame] of the voxels of the tooth (`of` 0: any) that have the outside beside them, and
    /// one of `beside` (0: whatever).
    [[nodiscard]] std::vector<Vec3> outermost(std::uint8_t of, std::uint8_t beside) {
        std::vector<Vec3> found;
        each([&](int i, int j, int k) {
            const std::uint8_t own = at(i, j, k);
            if (of != 0 ? own != of : own == 0 || own == kOutside) return;
            bool isOut = false, isBeside = beside == 0;
            for (int n = 0; n < 27; ++n) {
                const int u = i + n % 3 - 1, v = j + n / 3 % 3 - 1, w = k + n / 9 - 1;
                const std::uint8_t other = isIn(u, v, w) ? at(u, v, w) : kOutside;
                isOut = isOut || other == kOutside;
                isBeside = isBeside || other == beside;
            }
            if (isOut && isBeside) found.push_back(labels_.grid.toMm(Vec3(i, j, k)));
        });
        return found;
    }

  private:
    [[nodiscard]] bool isIn(int i, int j, int k) const {
        const auto& size = labels_.grid.size;
        return i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
    }
    std::uint8_t& at(int i, int j, int k) { return labels_.values[labels_.grid.index(i, j, k)]; }
    template <class Do>
    void each(const Do& todo) {
        for (int k = 0; k < labels_.grid.size[2]; ++k)
            for (int j = 0; j < labels_.grid.size[1]; ++j)
                for (int i = 0; i < labels_.grid.size[0]; ++i)
                    todo(i, j, k);
    }
    volume::Labels labels_;
};

double nearestMm(const Vec3& p, const std::vector<Vec3>& to) {
    double least = 1e300;
    for (const Vec3& q : to)
        least = std::min(least, (q - p).squaredNorm());
    return std::sqrt(least);
}

/// Those of `points` above which there is none within this distance, seen from above; of many alike one.
std::vector<Vec3> tops(const std::vector<Vec3>& points, double withinMm) {
    // A column of cells each keeps its highest.
    std::map<std::pair<int, int>, Vec3> highest;
    constexpr double kCellMm = 0.1;
    for (const Vec3& p : points) {
        const std::pair cell(static_cast<int>(std::floor(p.x() / kCellMm)),
                             static_cast<int>(std::floor(p.y() / kCellMm)));
        const auto [it, isNew] = highest.try_emplace(cell, p);
        if (!isNew && p.z() > it->second.z()) it->second = p;
    }
    std::vector<Vec3> found;
    const int reach = static_cast<int>(withinMm / kCellMm);
    for (const auto& [cell, p] : highest) {
        bool isTop = true;
        for (int v = -reach; v <= reach && isTop; ++v)
            for (int u = -reach; u <= reach && isTop; ++u) {
                const auto other = highest.find({cell.first + u, cell.second + v});
                if (other == highest.end() || other->first == cell) continue;
                const double z = other->second.z();
                if (z > p.z() || (z == p.z() && other->first < cell)) isTop = false;
            }
        if (isTop) found.push_back(p);
    }
    return found;
}

struct Figures {
    double cejHalf = 0, cejNineTenths = 0, cejMost = 0, borderSeen = 0;
    std::vector<double> tipsMm, hornsMm;
    std::map<LandmarkKind, int> found;
};

/// Of the tooth that a scan shows, made into a case without any hint which way it stands.
Figures measured(const scan_case::ScanJob& job) {
    const scan_case::ScanResult result = scan_case::runScanJob(job, {}, nullptr, scan_case::ScanStage::decimate);
    const cases::Case& tooth = result.cases.at(0).toothCase;
    const core::Pose& inTooth = result.placed.scanInTooth;
    // A person's labels where there are some, else those of the segmentation.
    Voxels voxels(result.labels ? *result.labels : segmentation::labelsOf(*result.region));
    std::vector<Vec3> border = voxels.outermost(kDentine, kEnamel), surface = voxels.outermost(0, 0);
    for (std::vector<Vec3>* points : {&border, &surface})
        for (Vec3& p : *points)
            p = inTooth.orientation * p + inTooth.positionMm;
    const double top = tooth.surface().bounds().max.z();
    // Worn and carious places of the crown show dentine too.
    std::erase_if(border, [&](const Vec3& p) { return p.z() > 0.5 * top; });
    EXPECT_GT(border.size(), 100u);

    Figures figures;
    const std::vector<Landmark> found = findLandmarks(tooth);
    const std::vector<Vec3> cusps = tops(surface, 1.0);
    std::vector<Vec3> pulp;
    for (const cases::Part& part : tooth.parts)
        if (part.tissue == cases::Tissue::pulp) pulp = part.mesh.vertices;
    const std::vector<Vec3> horns = tops(pulp, 0.6);
    for (const Landmark& mark : found) {
        ++figures.found[mark.kind];
        const Vec3& p = mark.pointsMm.front();
        if (mark.kind == LandmarkKind::cuspTip) figures.tipsMm.push_back(nearestMm(p, cusps));
        if (mark.kind == LandmarkKind::pulpHorn) figures.hornsMm.push_back(nearestMm(p, horns));
        if (mark.kind != LandmarkKind::cementoEnamelJunction) continue;
        std::vector<double> away;
        for (const Vec3& q : mark.pointsMm)
            away.push_back(nearestMm(q, border));
        std::sort(away.begin(), away.end());
        figures.cejHalf = away[away.size() / 2];
        figures.cejNineTenths = away[away.size() * 9 / 10];
        figures.cejMost = away.back();
        // And of the border, how much has the ring near it.
        std::vector<Vec3> ring;
        for (std::size_t i = 0; i < mark.pointsMm.size(); ++i)
            for (int k = 0; k < 8; ++k)
                ring.push_back(mark.pointsMm[i] +
                               (mark.pointsMm[(i + 1) % mark.pointsMm.size()] - mark.pointsMm[i]) * (k / 8.0));
        figures.borderSeen =
            static_cast<double>(
                std::count_if(border.begin(), border.end(), [&](const Vec3& b) { return nearestMm(b, ring) < 0.5; })) /
            static_cast<double>(border.size());
    }
    fmt::print(
        "  turned by {:.0f} degrees as placed; junction {:.2f} / {:.2f} / {:.2f} mm (half, nine tenths, all) off the "
        "border of "
        "enamel and dentine, {:.0f} % of that within 0.5 mm of it\n",
        turnOfCrown(tooth) * 180.0 / std::numbers::pi, figures.cejHalf, figures.cejNineTenths, figures.cejMost,
        100.0 * figures.borderSeen);
    fmt::print("  cusp tips off the highest voxels about [mm]: {:.2f}\n  horns off the pulp's tops [mm]: {:.2f}\n",
               fmt::join(figures.tipsMm, ", "), fmt::join(figures.hornsMm, ", "));
    for (const Landmark& mark : lackedLandmarks(expectedLandmarks(tooth.fdiNumber), found))
        fmt::print("  not found: {} {}\n", cases::kLandmarkKinds[static_cast<std::size_t>(mark.kind)], mark.name);
    return figures;
}

class RealLandmarks : public testing::Test {
  protected:
    std::filesystem::path folder_ = test::realDataFolder();
    void SetUp() override {
        if (folder_.empty()) GTEST_SKIP() << "no real data beside this checkout (../shared/data)";
    }
};

TEST_F(RealLandmarks, OfACariousUpperMolarInMicroCt) {
    scan_case::ScanJob job;
    job.source = folder_ / "molar-caries/molar_labels_34um_cropped.nrrd";
    job.isLabels = true;
    job.segmentation.spacingMm = 0.08;
    job.placing.fdiNumber = 16;
    Figures figures = measured(job);
    EXPECT_EQ(figures.found[LandmarkKind::cuspTip], 3);
    EXPECT_EQ(figures.found[LandmarkKind::cementoEnamelJunction], 1);
    // Above what was measured (docs/anatomy.md); a part of this ring lies off, and no bound hides it.
    EXPECT_LT(figures.cejHalf, 0.15);
    EXPECT_GT(figures.borderSeen, 0.95);
    for (const double off : figures.tipsMm)
        EXPECT_LT(off, 0.25);
}

TEST_F(RealLandmarks, OfAnUpperMolarInIndustrialCt) {
    scan_case::ScanJob job;
    job.source = folder_ / "ge-tooth-ct/tooth_103x94x161_uint8.nrrd";
    job.spacingMm = Vec3::Constant(0.133);
    job.placing.fdiNumber = 17;
    Figures figures = measured(job);
    EXPECT_EQ(figures.found[LandmarkKind::cementoEnamelJunction], 1);
    EXPECT_LT(figures.cejNineTenths, 0.25);
    EXPECT_GT(figures.borderSeen, 0.95);
    for (const double off : figures.tipsMm)
        EXPECT_LT(off, 0.35);
}

}  // namespace
}  // namespace handpiece::landmarks::real_landmarks_test
