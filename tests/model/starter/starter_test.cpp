// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/starter/starter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/starter/paper.h"

namespace handpiece::starter::starter_test {
namespace {

using core::Vec3;
using geometry::Triangle;
using geometry::TriangleMesh;
using geometry::TriangleTree;

/// Teeth take seconds to make: each once, for all tests.
const cases::Case& molar() {
    static const cases::Case made = makeTooth(ToothKind::lowerFirstMolar, {9760, 0, false});
    return made;
}
const TriangleMesh& fineOuter() {
    static const TriangleMesh made = makeOuter(ToothKind::lowerFirstMolar, 68151);
    return made;
}

std::string asMade(const cases::Case& c) {
    core::Hasher hash;
    const auto add = [&](const TriangleMesh& mesh) {
        for (const Vec3& v : mesh.vertices)
            for (int axis = 0; axis < 3; ++axis)
                hash.add(v[axis]);
        for (const Triangle& t : mesh.triangles)
            for (const std::uint32_t v : t)
                hash.add(v);
    };
    add(c.outer);
    for (const auto* parts : {&c.parts, &c.scenery})
        for (const cases::Part& part : *parts)
            add(part.mesh);
    return std::to_string(hash.value());
}

void expectSolid(const TriangleMesh& mesh, std::size_t faces) {
    const geometry::MeshReport report = geometry::inspect(mesh);
    if (faces > 0) {
        EXPECT_EQ(report.faces, faces);
    }
    EXPECT_TRUE(report.closed());
    EXPECT_TRUE(report.oriented());
    EXPECT_EQ(report.nonManifoldVertices, 0u);
    EXPECT_EQ(report.degenerateFaces, 0u);
    EXPECT_EQ(report.shells, 1u);
    EXPECT_GT(report.volumeMm3, 0.0);
    EXPECT_EQ(report.unit.unit, geometry::LengthUnit::millimetre);
    EXPECT_TRUE(geometry::selfIntersections(mesh, 1).empty());
}

/// The highest z over a grid of (x, y), -inf beside the tooth.
class HeightField {
  public:
    HeightField(const TriangleMesh& mesh, double spacing) : spacing_(spacing) {
        const core::Box box = mesh.bounds();
        for (int axis = 0; axis < 2; ++axis) {
            first_[axis] = static_cast<int>(std::ceil(box.min[axis] / spacing));
            count_[axis] = static_cast<int>(std::floor(box.max[axis] / spacing)) - first_[axis] + 1;
        }
        z_.assign(static_cast<std::size_t>(count_[0] * count_[1]), -INFINITY);
        for (const Triangle& t : mesh.triangles) {
            const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
            const double area = cross(b - a, c - a);
            if (std::abs(area) < 1e-12) continue;
            const auto from = [&](int axis) {
                return static_cast<int>(std::ceil(std::min({a[axis], b[axis], c[axis]}) / spacing));
            };
            const auto to = [&](int axis) {
                return static_cast<int>(std::floor(std::max({a[axis], b[axis], c[axis]}) / spacing));
            };
            for (int x = from(0); x <= to(0); ++x)
                for (int y = from(1); y <= to(1); ++y) {
                    const Vec3 p(x * spacing, y * spacing, 0.0);
                    const double u = cross(b - p, c - p) / area, v = cross(c - p, a - p) / area, w = 1.0 - u - v;
                    if (u < -1e-9 || v < -1e-9 || w < -1e-9) continue;
                    double& z = z_[index(x, y)];
                    z = std::max(z, u * a.z() + v * b.z() + w * c.z());
                }
        }
    }
    /// At the grid point nearest to (x, y).
    [[nodiscard]] double at(double x, double y) const {
        return z_[index(static_cast<int>(std::lround(x / spacing_)), static_cast<int>(std::lround(y / spacing_)))];
    }
    /// Grid points above `fromZ` that nothing within `radius` overtops.
    [[nodiscard]] std::vector<Vec3> peaks(double fromZ, double radius) const {
        const int reach = static_cast<int>(radius / spacing_);
        std::vector<Vec3> found;
        for (int j = 0; j < count_[1]; ++j)
            for (int i = 0; i < count_[0]; ++i) {
                const double z = z_[static_cast<std::size_t>(j * count_[0] + i)];
                bool highest = z > fromZ;
                for (int v = std::max(0, j - reach); highest && v <= std::min(count_[1] - 1, j + reach); ++v)
                    for (int u = std::max(0, i - reach); highest && u <= std::min(count_[0] - 1, i + reach); ++u)
                        if (std::hypot(u - i, v - j) * spacing_ <= radius)
                            highest = z_[static_cast<std::size_t>(v * count_[0] + u)] <= z;
                if (highest) found.emplace_back((first_[0] + i) * spacing_, (first_[1] + j) * spacing_, z);
            }
        return found;
    }

  private:
    static double cross(const Vec3& a, const Vec3& b) { return a.x() * b.y() - a.y() * b.x(); }
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>((y - first_[1]) * count_[0] + x - first_[0]);
    }
    double spacing_;
    int first_[2], count_[2];
    std::vector<double> z_;
};

/// Closed outlines where the plane at `z` cuts the mesh: joined edges, counted by following them.
std::size_t outlinesAt(const TriangleMesh& mesh, double z) {
    using Edge = std::pair<std::uint32_t, std::uint32_t>;
    std::map<Edge, std::vector<Edge>> joints;
    for (const Triangle& t : mesh.triangles) {
        std::vector<Edge> cut;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = t[i], b = t[(i + 1) % 3];
            if ((mesh.vertices[a].z() < z) != (mesh.vertices[b].z() < z)) cut.push_back(std::minmax(a, b));
        }
        if (cut.size() != 2) continue;
        joints[cut[0]].push_back(cut[1]);
        joints[cut[1]].push_back(cut[0]);
    }
    std::size_t outlines = 0;
    while (!joints.empty()) {
        ++outlines;
        std::vector<Edge> open{joints.begin()->first};
        while (!open.empty()) {
            const Edge edge = open.back();
            open.pop_back();
            const auto found = joints.find(edge);
            if (found == joints.end()) continue;
            open.insert(open.end(), found->second.begin(), found->second.end());
            joints.erase(found);
        }
    }
    return outlines;
}

TEST(Starter, MolarIsASolidOfGenusZeroWithExactlyTheFacesAskedFor) {
    expectSolid(molar().outer, 9760);
    EXPECT_EQ(geometry::inspect(molar().outer).genus, 0);
    expectSolid(fineOuter(), 68152);  // odd counts become even: a closed surface has no other
    EXPECT_EQ(geometry::inspect(fineOuter()).genus, 0);
}

TEST(Starter, OtherTeethAreSolidsToo) {
    for (const ToothKind kind : {ToothKind::upperIncisor, ToothKind::upperPremolar}) {
        SCOPED_TRACE(infoOf(kind).name);
        const TriangleMesh outer = makeOuter(kind, 6001);
        expectSolid(outer, 6002);
        EXPECT_EQ(geometry::inspect(outer).genus, 0);
    }
}

TEST(Starter, ShapeDoesNotDependOnTheFaceCount) {
    const double coarse = geometry::enclosedVolumeMm3(molar().outer), fine = geometry::enclosedVolumeMm3(fineOuter());
    EXPECT_NEAR(coarse / fine, 1.0, 0.005);
    EXPECT_NEAR(geometry::surfaceAreaMm2(molar().outer) / geometry::surfaceAreaMm2(fineOuter()), 1.0, 0.02);
    // A first molar: crown about 11 x 10.5 mm, 20 to 23 mm long.
    const Vec3 size = fineOuter().bounds().size();
    EXPECT_NEAR(size.x(), 11.0, 0.5);
    EXPECT_NEAR(size.y(), 10.5, 0.5);
    EXPECT_NEAR(size.z(), 21.5, 1.5);
}

TEST(Starter, TissuesAreSolidsInsideOneAnother) {
    const cases::Case& c = molar();
    ASSERT_EQ(c.parts.size(), 4u);
    std::map<std::string, const TriangleMesh*> part;
    for (const cases::Part& p : c.parts) {
        SCOPED_TRACE(p.name);
        part[p.name] = &p.mesh;
        expectSolid(p.mesh, 0);
        EXPECT_EQ(p.name, cases::properties(p.tissue).name);
        EXPECT_EQ(p.priority, cases::properties(p.tissue).priority);
    }
    const auto farthestOut = [&](const TriangleMesh& inner, const TriangleMesh& outer) {
        const TriangleTree tree(outer);
        double farthest = -INFINITY;
        for (const Vec3& v : inner.vertices)
            farthest = std::max(farthest, tree.signedDistance(v));
        return farthest;
    };
    EXPECT_LT(farthestOut(*part.at("pulp"), *part.at("dentine")), 0.0);
    EXPECT_LT(farthestOut(*part.at("dentine"), c.outer), 0.1);
    EXPECT_LT(farthestOut(*part.at("enamel"), c.outer), 0.1);
    EXPECT_LT(farthestOut(*part.at("caries"), c.outer), 0.2);
    EXPECT_GT(geometry::enclosedVolumeMm3(*part.at("dentine")), geometry::enclosedVolumeMm3(*part.at("pulp")));
    // Enamel caps the crown, the dentine goes down into the roots.
    EXPECT_GT(part.at("enamel")->bounds().max.z(), 6.0);
    EXPECT_GT(part.at("enamel")->bounds().min.z(), -2.0);
    EXPECT_LT(part.at("dentine")->bounds().min.z(), -13.0);
}

TEST(Starter, MolarHasFiveCuspsTwoRootsAndFissures) {
    const HeightField height(fineOuter(), 0.1);
    const std::vector<Vec3> cusps = height.peaks(4.5, 0.9);
    for (const Vec3& cusp : cusps)
        RecordProperty("cusp", testing::PrintToString(cusp.transpose()));
    EXPECT_EQ(cusps.size(), 5u);
    const auto onSide = [&](double sign) {
        return std::count_if(cusps.begin(), cusps.end(), [&](const Vec3& p) { return sign * p.y() > 0.5; });
    };
    const int buccal = infoOf(ToothKind::lowerFirstMolar).buccalSign;
    EXPECT_EQ(onSide(buccal), 3) << "two buccal cusps and the distal one";
    EXPECT_EQ(onSide(-buccal), 2) << "two lingual cusps";

    EXPECT_EQ(outlinesAt(fineOuter(), 2.0), 1u);
    EXPECT_EQ(outlinesAt(fineOuter(), -10.0), 2u) << "two roots";

    // Across the central groove, and along x across the lingual and the mesiobuccal one.
    struct Crossing {
        double x, y, acrossX, acrossY;
    };
    for (const Crossing& c :
         {Crossing{1.5, -0.05, 0, 1}, {-0.4, 0.08, 0, 1}, {-2.4, 0.12, 0, 1}, {0.28, 1.5, 1, 0}, {0.92, -2.0, 1, 0}}) {
        SCOPED_TRACE(testing::Message() << "at (" << c.x << ", " << c.y << ")");
        double bottom = INFINITY;
        for (double s = -0.25; s <= 0.25; s += 0.05)
            bottom = std::min(bottom, height.at(c.x + s * c.acrossX, c.y + s * c.acrossY));
        for (const double side : {-0.6, 0.6})
            EXPECT_GT(height.at(c.x + side * c.acrossX, c.y + side * c.acrossY), bottom + 0.3);
    }
}

TEST(Starter, IsTheSameAtAnyThreadCount) {
    const std::size_t before = core::threadCount();
    const std::string first = asMade(molar());
    core::setThreadCount(before == 1 ? 2 : 1);
    const std::string second = asMade(makeTooth(ToothKind::lowerFirstMolar, {9760, 0, false}));
    core::setThreadCount(0);
    EXPECT_EQ(first, second);
}

TEST(Starter, SceneHasNeighboursGumAndBone) {
    const cases::Case c = makeTooth(ToothKind::upperIncisor, {2000, 2000, true});
    std::map<std::string, const cases::Part*> scenery;
    for (const cases::Part& p : c.scenery) {
        SCOPED_TRACE(p.name);
        scenery[p.name] = &p;
        EXPECT_TRUE(geometry::inspect(p.mesh).closed());
    }
    ASSERT_EQ(scenery.size(), 4u);
    EXPECT_EQ(scenery.at("gum")->tissue, cases::Tissue::gum);
    EXPECT_EQ(scenery.at("bone")->tissue, cases::Tissue::bone);
    EXPECT_GT(scenery.at("mesial-neighbour")->mesh.bounds().centre().x(), 5.0);
    EXPECT_LT(scenery.at("distal-neighbour")->mesh.bounds().centre().x(), -5.0);
    for (const cases::Part& p : c.parts)
        EXPECT_EQ(p.mesh.triangles.size(), 2000u) << p.name;
}

TEST(Starter, RefusesUnknownNamesAndFaceCountsPlainly) {
    EXPECT_EQ(toothKindByName("upper-premolar"), ToothKind::upperPremolar);
    try {
        (void)toothKindByName("wisdom");
        FAIL();
    } catch (const core::Error& e) {
        EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr("wisdom"), testing::HasSubstr("lower-first-molar"),
                                             testing::HasSubstr("upper-incisor"), testing::HasSubstr("--kind")));
    }
    for (const std::size_t faces : {std::size_t{0}, kMinFaces - 1, kMaxFaces + 1}) {
        EXPECT_THROW((void)makeOuter(ToothKind::upperIncisor, faces), core::Error) << faces;
        EXPECT_THROW((void)makeTooth(ToothKind::upperIncisor, {faces, 0, false}), core::Error) << faces;
    }
    EXPECT_THROW((void)makeTooth(ToothKind::upperIncisor, {2000, 3, false}), core::Error);
    EXPECT_THROW((void)makeOuter(ToothKind::upperIncisor, 2000, [](double) { return false; }), core::Error)
        << "cancelled";
}

TEST(Paper, ResolutionsAreThoseOfTableTwo) {
    ASSERT_EQ(paperResolutions().size(), 5u);
    for (const PaperResolution& r : paperResolutions().first(2)) {
        SCOPED_TRACE(r.name);
        const TriangleMesh made = r.faces == 9760 ? molar().outer : makeOuter(ToothKind::lowerFirstMolar, r.faces);
        EXPECT_NEAR(static_cast<double>(made.triangles.size()) / static_cast<double>(r.faces), 1.0, 0.01);
        EXPECT_NEAR(static_cast<double>(made.vertices.size()) / static_cast<double>(r.vertices), 1.0, 0.01);
    }
}

TEST(Paper, PlaneIsThatOfTableTwo) {
    const TriangleMesh plane = makePlane(10.0);
    EXPECT_EQ(plane.vertices.size(), kPaperPlane.vertices);
    EXPECT_EQ(plane.triangles.size(), kPaperPlane.faces);
    EXPECT_NEAR(geometry::surfaceAreaMm2(plane), 100.0, 1e-9);
    for (const Triangle& t : plane.triangles) {
        const Vec3 &a = plane.vertices[t[0]], &b = plane.vertices[t[1]], &c = plane.vertices[t[2]];
        ASSERT_GT((b - a).cross(c - a).z(), 0.0);
        ASSERT_EQ(a.z(), 0.0);
    }
    const TriangleMesh slab = makePlaneSlab(10.0, 2.0);
    expectSolid(slab, 672);  // top, bottom and 4 x 12 x 2 around
    EXPECT_NEAR(geometry::enclosedVolumeMm3(slab), 200.0, 1e-9);
    EXPECT_THROW((void)makePlane(0.0), core::Error);
    EXPECT_THROW((void)makePlaneSlab(10.0, -1.0), core::Error);
    EXPECT_THROW((void)makePlaneSlab(NAN, 1.0), core::Error);
}

}  // namespace
}  // namespace handpiece::starter::starter_test
