// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>

#include "handpiece/model/case/case_check.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "handpiece/scan/surfacing/surfaces.h"
#include "scan/surfacing/regions.h"

namespace handpiece::surfacing::case_test {
namespace {

using cases::Tissue;
using test::BallTooth;

/// As Surfaces says: the enamel's part is the whole tooth.
cases::Case caseOf(const Surfaces& surfaces) {
    cases::Case made;
    made.outer = surfaces.outer.mesh;
    made.parts.push_back({"enamel", Tissue::enamel, cases::properties(Tissue::enamel).priority, surfaces.outer.mesh});
    for (const Surface& tissue : surfaces.tissues)
        made.parts.push_back({std::string(cases::properties(tissue.tissue).name), tissue.tissue,
                              cases::properties(tissue.tissue).priority, tissue.mesh});
    return made;
}

tooth::TissueVolumes fieldVolumes(const cases::Case& made, double voxelMm) {
    tooth::LoadSettings settings;
    settings.useCache = false;
    settings.field.voxelMm = voxelMm;
    return tooth::loadModel(made, settings)->volumesMm3;
}

// What a bur will find in the tooth against closed forms, at all faces and at few.
TEST(SurfacesCase, CanBeCutAndHasTheRegionsVolumes) {
    const BallTooth truth;
    const double whole = test::ballMm3(truth.radiusMm), pulp = test::ballMm3(truth.pulpMm);
    const double dentine = test::lensMm3(truth.radiusMm, truth.enamelMm);  // with what lies in it
    const segmentation::Region region = truth.region(0.1);
    // Caries has no simple closed form: counted on a fine grid.
    double caries = 0.0, cariesInDentine = 0.0;
    const double step = 0.04;
    for (double z = 4; z < 8; z += step)
        for (double y = 2; y < 6; y += step)
            for (double x = 2; x < 6; x += step) {
                const core::Vec3 p(x, y, z);
                if (truth.caries()(p) > 0.0) continue;
                caries += step * step * step;
                cariesInDentine += truth.dentine()(p) <= 0.0 ? step * step * step : 0.0;
            }
    const Surfaces full = makeSurfaces(region);
    for (const double percent : {100.0, 12.0}) {
        SCOPED_TRACE(percent);
        const cases::Case made = caseOf(decimated(full, percent));
        for (const cases::CaseFinding& finding : cases::checkCase(made))
            ADD_FAILURE() << finding.part << ": " << finding.what;
        const tooth::TissueVolumes mm3 = fieldVolumes(made, 0.08);
        const auto of = [&](Tissue tissue) { return mm3[static_cast<std::size_t>(tissue)]; };
        EXPECT_NEAR(of(Tissue::pulp) / pulp, 1.0, 0.01);
        EXPECT_NEAR(of(Tissue::caries) / caries, 1.0, 0.01);
        EXPECT_NEAR(of(Tissue::dentine) / (dentine - pulp - cariesInDentine), 1.0, 0.01);
        EXPECT_NEAR(of(Tissue::enamel) / (whole - dentine - caries + cariesInDentine), 1.0, 0.01);
    }
}

TEST(SurfacesCase, OfLabelsCanBeCutToo) {
    const BallTooth truth;
    const Surfaces full = makeSurfaces(truth.region(0.1, true));
    const cases::Case made = caseOf(decimated(full, 25));
    for (const cases::CaseFinding& finding : cases::checkCase(made))
        ADD_FAILURE() << finding.part << ": " << finding.what;
    const tooth::TissueVolumes mm3 = fieldVolumes(made, 0.08);
    const double whole = test::ballMm3(truth.radiusMm), dentine = test::lensMm3(truth.radiusMm, truth.enamelMm);
    EXPECT_NEAR(mm3[static_cast<std::size_t>(Tissue::dentine)] / (dentine - test::ballMm3(truth.pulpMm)), 1.0, 0.02);
    EXPECT_GT(mm3[static_cast<std::size_t>(Tissue::enamel)], 0.9 * (whole - dentine) - test::ballMm3(truth.cariesMm));
}

/// A lesion whose labels are a comb: plates of a voxel with rods across, as noise leaves them at an open surface. Its
/// many tunnels are evened out, and so is the roughness of the tooth's own surface beside it.
segmentation::Region combed(double voxelMm) {
    const BallTooth truth;
    segmentation::Region region = truth.region(voxelMm, true);
    const test::Shape lesion = test::ball(truth.middle + core::Vec3(0.2, 0.1, truth.radiusMm), 1.3),
                      tooth = truth.outer();
    std::vector<float>&outer = region.outer.distanceMm, &caries = region.solids.back().distanceMm;
    const auto set = [&](std::vector<float>& distances, std::size_t at, bool isIn) {
        distances[at] = static_cast<float>(isIn ? -0.5 * voxelMm : 0.5 * voxelMm);
    };
    for (int k = 0; k < region.grid.size[2]; ++k)
        for (int j = 0; j < region.grid.size[1]; ++j)
            for (int i = 0; i < region.grid.size[0]; ++i) {
                const std::size_t at = region.grid.index(i, j, k);
                const core::Vec3 p = voxelMm * core::Vec3(i, j, k);
                const bool isComb = i % 2 == 0 || (j % 3 == 0 && k % 3 == 0);
                // Beside the lesion the tooth is eaten away between the teeth of the comb.
                if (lesion(p) < 0.0 && tooth(p) > -3.5 * voxelMm && !isComb) set(outer, at, false);
                set(caries, at, lesion(p) < 0.0 && isComb && outer[at] < 0.0f);
            }
    return region;
}

// Its surface came out of the tooth as long spikes: evening out moved it, and nothing held it to the tooth again.
TEST(SurfacesCase, CombOfDecayAtTheSurfaceStaysInTheTooth) {
    const Surfaces full = makeSurfaces(combed(0.1));
    const std::array<double, 6> percents{100, 50, 20, 10, 5, 2};
    const std::vector<Surfaces> steps = decimatedSteps(full, percents);
    for (std::size_t i = 0; i < steps.size(); ++i)
        for (const cases::CaseFinding& finding : cases::checkCase(caseOf(steps[i])))
            ADD_FAILURE() << percents[i] << " %: " << finding.part << ": " << finding.what;
}

}  // namespace
}  // namespace handpiece::surfacing::case_test
