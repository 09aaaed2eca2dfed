// SPDX-License-Identifier: Apache-2.0
// A molar and a bur that nobody here made: a segmented micro-CT of a carious molar, from labels to touch.
//
// HANDPIECE_KEEP_REAL names a folder in which the case is kept as molar/.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/base/geometry/decimate.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/geometry/repair.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "studies/built_in_motion.h"
#include "studies/cutting_motion.h"
#include "support/brute_force_depth.h"
#include "support/random.h"

namespace handpiece::real_data_test {
namespace {

using core::Vec3;

/// A block of voxels, x fastest.
template <class T>
struct Volume {
    std::array<int, 3> size{};
    double spacingMm = 1.0;
    std::vector<T> values;

    [[nodiscard]] std::size_t at(int x, int y, int z) const {
        return static_cast<std::size_t>(x) +
               static_cast<std::size_t>(size[0]) *
                   (static_cast<std::size_t>(y) + static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(z));
    }
};

/// An NRRD of unsigned characters packed by gzip; an empty volume when it is anything else.
Volume<std::uint8_t> readLabels(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::map<std::string, std::string> fields;
    std::string line;
    for (std::getline(file, line); std::getline(file, line) && !line.empty();)
        if (const auto colon = line.find(": "); colon != std::string::npos)
            fields[line.substr(0, colon)] = line.substr(colon + 2);
    std::string packed((std::istreambuf_iterator<char>(file)), {});
    Volume<std::uint8_t> volume;
    std::istringstream(fields["sizes"]) >> volume.size[0] >> volume.size[1] >> volume.size[2];
    std::istringstream(fields["spacings"]) >> volume.spacingMm;
    volume.values.resize(volume.at(0, 0, volume.size[2]));

    z_stream stream{};
    if (inflateInit2(&stream, 16 + MAX_WBITS) != Z_OK) return {};
    stream.next_in = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_in = static_cast<uInt>(packed.size());
    stream.next_out = volume.values.data();
    stream.avail_out = static_cast<uInt>(volume.values.size());
    const int status = inflate(&stream, Z_FINISH);
    const bool whole = status == Z_STREAM_END && stream.avail_out == 0;
    inflateEnd(&stream);
    if (fields["type"] != "uchar" || fields["encoding"] != "gzip" || !whole) return {};
    return volume;
}

/// Voxels of solid, or of one label, in blocks of 2 x 2 x 2, as a share, inside a margin of emptiness.
Volume<float> halved(const Volume<std::uint8_t>& labels, int margin, std::uint8_t only = 0) {
    Volume<float> v;
    for (int a = 0; a < 3; ++a)
        v.size[static_cast<std::size_t>(a)] = (labels.size[static_cast<std::size_t>(a)] + 1) / 2 + 2 * margin;
    v.spacingMm = 2.0 * labels.spacingMm;
    v.values.assign(v.at(0, 0, v.size[2]), 0.0f);
    for (int z = 0; z < labels.size[2]; ++z)
        for (int y = 0; y < labels.size[1]; ++y)
            for (int x = 0; x < labels.size[0]; ++x)
                if (const std::uint8_t label = labels.values[labels.at(x, y, z)];
                    only != 0 ? label == only : label != 0)
                    v.values[v.at(x / 2 + margin, y / 2 + margin, z / 2 + margin)] += 0.125f;
    return v;
}

/// Squared distance [voxels] to the nearest voxel for which `values` is 0, along one line (Felzenszwalb & Huttenlocher
/// 2012).
void parabolas(std::vector<float>& f) {
    const int n = static_cast<int>(f.size());
    std::vector<int> v(f.size());
    std::vector<float> z(f.size() + 1), d(f.size());
    const auto at = [&](int i) { return f[static_cast<std::size_t>(i)]; };
    int k = 0;
    v[0] = 0;
    z[0] = -1e20f;
    z[1] = 1e20f;
    const auto crossing = [&](int q, int p) {
        return ((at(q) + static_cast<float>(q * q)) - (at(p) + static_cast<float>(p * p))) /
               static_cast<float>(2 * (q - p));
    };
    for (int q = 1; q < n; ++q) {
        float s = crossing(q, v[static_cast<std::size_t>(k)]);
        while (s <= z[static_cast<std::size_t>(k)]) {
            --k;
            s = crossing(q, v[static_cast<std::size_t>(k)]);
        }
        ++k;
        v[static_cast<std::size_t>(k)] = q;
        z[static_cast<std::size_t>(k)] = s;
        z[static_cast<std::size_t>(k) + 1] = 1e20f;
    }
    k = 0;
    for (int q = 0; q < n; ++q) {
        while (z[static_cast<std::size_t>(k) + 1] < static_cast<float>(q))
            ++k;
        const int p = v[static_cast<std::size_t>(k)];
        d[static_cast<std::size_t>(q)] = static_cast<float>((q - p) * (q - p)) + at(p);
    }
    f = d;
}

/// Calls `change` on every line of the volume along every axis.
template <class Change>
void alongLines(Volume<float>& v, const Change& change) {
    const std::array<std::size_t, 3> stride{1, v.at(0, 1, 0), v.at(0, 0, 1)};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
        const auto count = static_cast<std::size_t>(v.size[axis]), rows = static_cast<std::size_t>(v.size[b]);
        core::parallelFor(rows * static_cast<std::size_t>(v.size[c]), 64, [&](std::size_t begin, std::size_t end) {
            std::vector<float> line(count);
            for (std::size_t i = begin; i < end; ++i) {
                const std::size_t first = i % rows * stride[b] + i / rows * stride[c];
                for (std::size_t j = 0; j < count; ++j)
                    line[j] = v.values[first + j * stride[axis]];
                change(line);
                for (std::size_t j = 0; j < count; ++j)
                    v.values[first + j * stride[axis]] = line[j];
            }
        });
    }
}

/// Squared distance to the voxels where `isSeed`.
Volume<float> squaredDistance(const Volume<float>& v, const std::function<bool(float)>& isSeed) {
    Volume<float> d = v;
    for (float& x : d.values)
        x = isSeed(x) ? 0.0f : 1e9f;
    alongLines(d, parabolas);
    return d;
}

/// Sets `value` on all voxels that are 6-connected to `start` through voxels where `open`; returns how many.
std::size_t flood(Volume<float>& mask, const std::array<int, 3>& start, float value,
                  const std::function<bool(std::size_t)>& open) {
    std::vector<std::array<int, 3>> stack{start};
    mask.values[mask.at(start[0], start[1], start[2])] = value;
    std::size_t count = 1;
    while (!stack.empty()) {
        const auto p = stack.back();
        stack.pop_back();
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const int step : {-1, 1}) {
                auto q = p;
                q[axis] += step;
                if (q[axis] < 0 || q[axis] >= mask.size[axis]) continue;
                const std::size_t i = mask.at(q[0], q[1], q[2]);
                if (mask.values[i] == value || !open(i)) continue;
                mask.values[i] = value;
                ++count;
                stack.push_back(q);
            }
    }
    return count;
}

/// Fills the largest hollow that the outside reaches only through gaps below 2 `gap` voxels: the pulp, whose apices are
/// narrow. Fissures as narrow are smaller hollows, and stay.
void fillPulp(Volume<float>& v, float gap) {
    const Volume<float> away = squaredDistance(v, [](float x) { return x >= 0.5f; });
    Volume<float> mask = v;
    std::fill(mask.values.begin(), mask.values.end(), 0.0f);
    flood(mask, {0, 0, 0}, 1.0f, [&](std::size_t i) { return away.values[i] > gap * gap; });
    // The distance kept is given back: outside is all that lies within it of what was reached.
    const Volume<float> back = squaredDistance(mask, [](float x) { return x > 0.0f; });
    const auto isHollow = [&](std::size_t i) {
        return v.values[i] < 0.5f && back.values[i] > (gap + 0.5f) * (gap + 0.5f);
    };
    std::size_t largest = 0;
    float pulp = 0.0f, next = 1.0f;
    for (int z = 0; z < v.size[2]; ++z)
        for (int y = 0; y < v.size[1]; ++y)
            for (int x = 0; x < v.size[0]; ++x) {
                const std::size_t i = v.at(x, y, z);
                if (mask.values[i] != 0.0f || !isHollow(i)) continue;
                const std::size_t count = flood(mask, {x, y, z}, ++next, isHollow);
                if (count <= largest) continue;
                largest = count;
                pulp = next;
            }
    for (std::size_t i = 0; i < v.values.size(); ++i)
        if (largest > 0 && mask.values[i] == pulp) v.values[i] = 1.0f;
}

/// Fills what the outside does not reach at all.
void fillHoles(Volume<float>& v) {
    Volume<float> mask = v;
    std::fill(mask.values.begin(), mask.values.end(), 0.0f);
    flood(mask, {0, 0, 0}, 1.0f, [&](std::size_t i) { return v.values[i] < 0.5f; });
    for (std::size_t i = 0; i < v.values.size(); ++i)
        if (mask.values[i] == 0.0f && v.values[i] < 0.5f) v.values[i] = 1.0f;
}

void blur(Volume<float>& v) {
    alongLines(v, [](std::vector<float>& line) {
        float before = line.front();
        for (std::size_t i = 0; i < line.size(); ++i) {
            const float here = line[i], after = i + 1 < line.size() ? line[i + 1] : here;
            line[i] = 0.25f * before + 0.5f * here + 0.25f * after;
            before = here;
        }
    });
}

/// Turned so that +z leaves the crown (the end where enamel lies), the middle at the origin. Returns how.
core::Pose crownUp(geometry::TriangleMesh& mesh, const Volume<std::uint8_t>& labels) {
    constexpr std::uint8_t kEnamel = 2;
    Vec3 enamel = Vec3::Zero(), all = Vec3::Zero();
    double enamelCount = 0.0, allCount = 0.0;
    for (int z = 0; z < labels.size[2]; z += 2)
        for (int y = 0; y < labels.size[1]; y += 2)
            for (int x = 0; x < labels.size[0]; x += 2) {
                const std::uint8_t label = labels.values[labels.at(x, y, z)];
                if (label == 0) continue;
                all += Vec3(x, y, z);
                ++allCount;
                if (label != kEnamel) continue;
                enamel += Vec3(x, y, z);
                ++enamelCount;
            }
    const Vec3 up = (enamel / enamelCount - all / allCount).normalized();
    core::Pose turn;
    turn.orientation = core::rotationBetween(up, Vec3::UnitZ());
    mesh = geometry::transformed(std::move(mesh), turn);
    turn.positionMm = -mesh.bounds().centre();
    mesh = geometry::transformed(std::move(mesh), {turn.positionMm, core::Quat::Identity()});
    return turn;
}

geometry::TriangleMesh drawn(Volume<float> share) {
    for (float& x : share.values)
        x = 0.5f - x;
    geometry::ScalarGrid grid;
    grid.spacingMm = share.spacingMm;
    for (std::size_t a = 0; a < 3; ++a)
        grid.nodes[a] = static_cast<std::uint32_t>(share.size[a]);
    grid.values = share.values;
    return geometry::isosurface(grid);
}

class RealData : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = test::realDataFolder();
        if (folder_.empty()) return;
        const Volume<std::uint8_t> labels = readLabels(folder_ / "molar-caries/molar_labels_34um_cropped.nrrd");
        ASSERT_FALSE(labels.values.empty());
        const double voxelMm3 = std::pow(labels.spacingMm, 3);
        labelledMm3_ = voxelMm3 * static_cast<double>(std::count_if(labels.values.begin(), labels.values.end(),
                                                                    [](std::uint8_t l) { return l != 0; }));
        constexpr float kGap = 6.0f;  // 0.4 mm on each side: an apex is narrower
        Volume<float> share = halved(labels, static_cast<int>(kGap) + 4);
        fillPulp(share, kGap);
        fillHoles(share);
        filledMm3_ = 0.0;
        for (const float x : share.values)
            filledMm3_ += 8.0 * voxelMm3 * static_cast<double>(x);
        blur(share);
        blur(share);
        geometry::TriangleMesh surface = drawn(std::move(share));
        const std::size_t faces = surface.triangles.size();
        const geometry::RepairReport repaired = geometry::repair(surface);  // voxel debris is no part of the tooth
        surface = geometry::decimate(surface, 70000).mesh;
        const core::Pose up = crownUp(surface, labels);
        for (const auto& [label, tissue] :
             {std::pair{std::uint8_t{1}, cases::Tissue::caries}, std::pair{std::uint8_t{2}, cases::Tissue::enamel},
              std::pair{std::uint8_t{3}, cases::Tissue::dentine}}) {
            Volume<float> one = halved(labels, static_cast<int>(kGap) + 4, label);
            blur(one);
            cases::Part part;
            part.tissue = tissue;
            part.name = cases::properties(tissue).name;
            part.priority = cases::properties(tissue).priority;
            part.mesh = geometry::transformed(drawn(std::move(one)), up);
            (void)geometry::repair(part.mesh);
            molar_.parts.push_back(std::move(part));
        }

        molar_.name = "carious molar";
        molar_.outer = std::move(surface);
        std::printf("  drawn with %zu faces, %zu pieces of debris dropped, thinned to %zu\n", faces,
                    repaired.droppedShells, molar_.outer.triangles.size());
        if (const char* keep = std::getenv("HANDPIECE_KEEP_REAL")) {
            cases::writeCase(molar_, std::filesystem::path(keep) / "molar");
        }
        tooth::LoadSettings settings;
        settings.useCache = false;
        settings.field.voxelMm = 0.05;
        tooth_ = tooth::loadModel(molar_, settings);
        std::printf("  field of %zu bricks in %.2f s\n", tooth_->field.brickCount(), tooth_->buildSeconds);
    }
    static void TearDownTestSuite() {
        tooth_.reset();
        molar_ = {};
    }
    void SetUp() override {
        if (folder_.empty()) GTEST_SKIP() << "no real data beside this checkout (../shared/data)";
        ASSERT_TRUE(tooth_);
    }

    static std::vector<std::shared_ptr<const instrument::Bur>> burs() {
        return {std::make_shared<const instrument::Bur>(instrument::makeBur("330")),
                std::make_shared<const instrument::Bur>(
                    instrument::burFromMesh("tapered", geometry::readMesh(folder_ / "tools/tapered_bur.stl")))};
    }

    static inline std::filesystem::path folder_;
    static inline double labelledMm3_ = 0.0, filledMm3_ = 0.0;
    static inline cases::Case molar_;
    static inline std::shared_ptr<const tooth::ToothModel> tooth_;
};

TEST_F(RealData, theMolarIsOneClosedSurfaceOfItsLabelsVolumeAndItsPulp) {
    const geometry::MeshReport report = geometry::inspect(molar_.outer);
    cases::requireSolid(molar_.outer, "the carious molar");
    std::printf(
        "  labels %.1f mm3, with the pulp %.1f; surface %.1f mm3, %.1f mm2, genus %lld, "
        "%.1f x %.1f x %.1f mm\n",
        labelledMm3_, filledMm3_, report.volumeMm3, report.areaMm2, static_cast<long long>(report.genus.value_or(-1)),
        report.boxMm.size().x(), report.boxMm.size().y(), report.boxMm.size().z());
    EXPECT_EQ(report.shells, 1u);
    EXPECT_NEAR(labelledMm3_, 706.4, 1.0);  // decay 6.4, enamel 188, dentine 512
    EXPECT_GT(filledMm3_, 1.005 * labelledMm3_);
    EXPECT_LT(filledMm3_, 1.12 * labelledMm3_);
    EXPECT_NEAR(report.volumeMm3, filledMm3_, 0.005 * filledMm3_);
    const field::DistanceField::Extent extent = tooth_->field.extent();
    EXPECT_NEAR(extent.volumeMm3, report.volumeMm3, 1e-3 * report.volumeMm3);
    EXPECT_NEAR(extent.areaMm2, report.areaMm2, 2e-3 * report.areaMm2);
}

TEST_F(RealData, depthIsThatOfBruteForce) {
    std::mt19937_64 generator(test::seed());
    const core::Box box = tooth_->outer.bounds();
    for (const auto& bur : burs()) {
        const auto method = contact::makeFieldMethod(tooth_, bur);
        std::vector<double> errors;
        double worstDepth = 0.0;
        while (errors.size() < 24) {
            const Vec3 size = box.size();
            core::Pose start;
            start.orientation = core::rotationBetween(
                Vec3::UnitZ(), (Vec3::UnitZ() + 0.4 * test::randomDirection(generator)).normalized());
            start.positionMm = {0.3 * size.x() * test::uniform(generator, -1, 1),
                                0.3 * size.y() * test::uniform(generator, -1, 1), box.max.z() + 1.0};
            const auto touch = studies::firstTouch(*method, start, -Vec3::UnitZ(), size.z());
            if (!touch) continue;
            core::Pose pose = *touch;
            pose.positionMm.z() -= test::uniform(generator, -0.1, 0.5);
            const double ours = method->depth(pose).depthMm;
            errors.push_back(std::abs(ours - test::bruteForceDepth(tooth_->tree, *bur, pose).depthMm));
            worstDepth = std::max(worstDepth, ours);
        }
        std::sort(errors.begin(), errors.end());
        std::printf("  %s, %zu poses, down to %.2f mm: median %.4f um, worst %.4f um\n", bur->name().c_str(),
                    errors.size(), worstDepth, 1e3 * errors[errors.size() / 2], 1e3 * errors.back());
        EXPECT_LT(errors[errors.size() / 2], 7e-5);  // the search ends at kDepthToleranceMm
        EXPECT_LT(errors.back(), 5e-3);
    }
}

TEST_F(RealData, aDroppedBurIsHeldAtTheSurface) {
    for (const auto& bur : burs()) {
        auto method = contact::makeFieldMethod(tooth_, bur);
        const auto probe = contact::makeFieldMethod(tooth_, bur);
        studies::MotionOptions options;
        options.speedMmS = 20.0;
        device::Motion drop = studies::motionByName("drop", *method, tooth_->outer.bounds(), options);
        method->reset();
        const double durationS = drop.durationS();
        loop::HapticLoop haptic(
            {}, std::make_unique<device::SimulatedDevice>(device::SimulatedDeviceSettings{}, std::move(drop)),
            std::move(method), force::defaultParameters());
        double peakN = 0.0, sinksMm = -10.0, lastN = 0.0;
        (void)runSimulated(haptic, durationS, [&](const messages::HapticSample& s) {
            core::Pose proxy;
            proxy.positionMm = Vec3(s.proxyPositionMm.data());
            const auto& q = s.proxyOrientation;
            proxy.orientation = core::Quat(q[0], q[1], q[2], q[3]);
            sinksMm = std::max(sinksMm, probe->depth(proxy).depthMm);
            lastN = Vec3(s.forceN.data()).norm();
            peakN = std::max(peakN, lastN);
        });
        std::printf("  %s dropped: peak %.2f N, at rest %.2f N, the proxy sinks %.2f um at worst\n",
                    bur->name().c_str(), peakN, lastN, 1e3 * sinksMm);
        EXPECT_GT(lastN, 0.2);
        EXPECT_LE(peakN, 3.3);
        EXPECT_LE(sinksMm, 0.002);
    }
}

TEST_F(RealData, aClassOneCavityIsCut) {
    const auto field = std::make_shared<tooth::ToothState>(tooth_);
    const auto bur = burs().front();
    studies::CuttingScene scene;
    scene.toothBounds = tooth_->outer.bounds();
    scene.burRadiusMm = bur->maxRadiusMm();
    studies::CuttingOptions options;
    options.lengthMm = 3.0;
    const auto feeler = contact::makeFieldMethod(tooth_, bur);
    device::Motion motion = studies::cuttingMotionByName("class-one", *feeler, scene, options);
    const double durationS = motion.durationS();
    device::SimulatedDeviceSettings rigid;
    rigid.rigidHand = true;
    loop::Work work{contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(field), bur),
                    std::make_unique<cutting::Cutter>(field, bur, instrument::CuttingParameters{},
                                                      cases::builtInTissues(), cutting::Cutter::Settings{})};
    loop::HapticLoop haptic({}, std::make_unique<device::SimulatedDevice>(rigid, std::move(motion)), std::move(work),
                            force::defaultParameters());
    double peakN = 0.0;
    tooth::TissueVolumes removed{};
    (void)runSimulated(haptic, durationS, [&](const messages::HapticSample& s) {
        peakN = std::max(peakN, Vec3(s.forceN.data()).norm());
        removed = s.removedMm3;
    });
    double total = 0.0;
    const tooth::TissueVolumes left = field->volumesMm3();
    for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
        total += removed[t];
        EXPECT_NEAR(removed[t], tooth_->volumesMm3[t] - left[t], 1e-6);
    }
    std::printf("  cavity of %.3f mm3 (enamel %.3f, dentine %.3f, decay %.3f), peak %.2f N, state %016llx\n", total,
                removed[1], removed[2], removed[4], peakN, static_cast<unsigned long long>(field->stateHash()));
    EXPECT_GT(total, 1.0);
    EXPECT_LT(peakN, 3.3);
}

}  // namespace
}  // namespace handpiece::real_data_test
