// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/case_bytes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "handpiece/base/core/error.h"
#include "handpiece/model/field/field_cache.h"
#include "support/closed_meshes.h"
#include "support/random.h"

namespace handpiece::cases::case_bytes_test {
namespace {

Case ballInBall() {
    Case made;
    made.name = "ball";
    made.kind = "lower-first-molar";
    made.fdiNumber = 46;
    made.buccalSign = -1;
    made.outer = test::sphereMesh(4, 3.0);
    Part part;
    part.name = "pulp";
    part.tissue = Tissue::pulp;
    part.priority = -7;
    part.mesh = test::sphereMesh(3, 1.0);
    for (core::Vec3& v : part.mesh.vertices)
        v = v.cast<float>().cast<double>();  // as from an STL file
    made.parts.push_back(part);
    return made;
}

TEST(CaseBytes, givesTheSameCaseBack) {
    const Case given = ballInBall();
    const std::vector<std::byte> bytes = encodeCase(given);
    const Case back = decodeCase(bytes, "test");
    EXPECT_EQ(back.name, given.name);
    EXPECT_EQ(back.kind, given.kind);
    EXPECT_EQ(back.fdiNumber, 46);
    EXPECT_EQ(back.buccalSign, -1);
    EXPECT_EQ(back.parts.at(0).name, "pulp");
    EXPECT_EQ(back.parts.at(0).priority, -7);
    EXPECT_EQ(back.outer.triangles, given.outer.triangles);
    // The key covers every vertex and index of every surface.
    EXPECT_EQ(field::cacheKey(back, {}), field::cacheKey(given, {}));
    EXPECT_EQ(encodeCase(back), bytes);
    EXPECT_LT(bytes.size(), given.outer.vertices.size() * 24 + given.outer.triangles.size() * 8 + 10000);
}

/// Two more teeth, one of which is not to be cut.
Case three() {
    Case made = ballInBall();
    PlacedTooth other;
    static_cast<Tooth&>(other) = ballInBall();
    other.fdiNumber = 45;
    other.inCase = {{8.1, 1.0 / 3.0, 0}, core::Quat(Eigen::AngleAxisd(0.1, core::Vec3::UnitY()))};
    made.others.push_back(other);
    other.parts.clear();
    other.isCuttable = false;
    made.others.push_back(other);
    made.scenery = made.parts;
    made.scenery.push_back(made.parts.front());
    made.scenery.back().tissue = Tissue::gum;
    made.scenery.back().isFelt = true;
    return made;
}

TEST(CaseBytes, givesTheOthersBack) {
    const std::vector<std::byte> bytes = encodeCase(three());
    const Case back = decodeCase(bytes, "test");
    ASSERT_EQ(back.others.size(), 2u);
    EXPECT_EQ(caseKey(back), caseKey(three()));
    EXPECT_EQ(back.others[0].fdiNumber, 45);
    EXPECT_FALSE(back.others[1].isCuttable);
    ASSERT_EQ(back.scenery.size(), 1u) << "what is felt";
    EXPECT_TRUE(back.scenery[0].isFelt);
    EXPECT_EQ(back.scenery[0].tissue, Tissue::gum);
    EXPECT_EQ(encodeCase(back), bytes);
    std::mt19937_64 random(test::seed());
    for (int i = 0; i < 100; ++i) {
        const auto kept = static_cast<std::size_t>(test::uniform(random, 0, static_cast<double>(bytes.size() - 1)));
        EXPECT_THROW((void)decodeCase(std::span(bytes).first(kept), "test"), core::Error) << kept;
    }
}

TEST(CaseBytes, givesTheLandmarksBack) {
    const auto mark = [](LandmarkKind kind, const char* name, int points, LandmarkSource source) {
        Landmark made{kind, name, {}, source};
        for (int i = 0; i < points; ++i)
            made.pointsMm.emplace_back(1.0 / 3.0 + i, -0.1 * i, 2.0);
        return made;
    };
    Case alone = ballInBall(), many = three();
    alone.landmarks = {mark(LandmarkKind::longAxis, "", 2, LandmarkSource::set),
                       mark(LandmarkKind::cementoEnamelJunction, "", 48, LandmarkSource::found)};
    many.others[1].landmarks = {mark(LandmarkKind::cuspTip, "mesiobuccal", 1, LandmarkSource::generated)};
    for (const Case& given : {alone, many}) {
        const std::vector<std::byte> bytes = encodeCase(given);
        const Case back = decodeCase(bytes, "test");
        const auto expectSame = [](const Tooth& one, const Tooth& other) {
            ASSERT_EQ(one.landmarks.size(), other.landmarks.size());
            for (std::size_t i = 0; i < one.landmarks.size(); ++i) {
                EXPECT_EQ(one.landmarks[i].kind, other.landmarks[i].kind);
                EXPECT_EQ(one.landmarks[i].name, other.landmarks[i].name);
                EXPECT_EQ(one.landmarks[i].source, other.landmarks[i].source);
                EXPECT_EQ(one.landmarks[i].pointsMm, other.landmarks[i].pointsMm) << "bit for bit";
            }
        };
        expectSame(back, given);
        ASSERT_EQ(back.others.size(), given.others.size());
        for (std::size_t i = 0; i < given.others.size(); ++i)
            expectSame(back.others[i], given.others[i]);
        EXPECT_EQ(encodeCase(back), bytes);
        EXPECT_EQ(caseKey(back), caseKey(given));
        for (std::size_t kept = 0; kept < bytes.size(); kept += 97)
            EXPECT_THROW((void)decodeCase(std::span(bytes).first(kept), "test"), core::Error) << kept;
    }
    // What no case may say is not believed here either.
    alone.landmarks = {mark(LandmarkKind::longAxis, "", 3, LandmarkSource::set)};
    EXPECT_THROW((void)decodeCase(encodeCase(alone), "test"), core::Error);
    alone.landmarks = {mark(LandmarkKind::pit, "", 1, LandmarkSource::set)};
    alone.landmarks[0].pointsMm[0].z() = std::nan("");
    EXPECT_THROW((void)decodeCase(encodeCase(alone), "test"), core::Error);
}

TEST(CaseBytes, WithoutLandmarksAreAsTheyWere) {
    const auto versionOf = [](const Case& c) { return std::to_integer<int>(encodeCase(c).at(4)); };
    EXPECT_EQ(versionOf(ballInBall()), 1);
    EXPECT_EQ(versionOf(three()), 2);
}

TEST(CaseBytes, refusesWhatIsCutOffOrDamaged) {
    const std::vector<std::byte> bytes = encodeCase(ballInBall());
    std::mt19937_64 random(test::seed());
    for (int i = 0; i < 200; ++i) {
        const auto kept = static_cast<std::size_t>(test::uniform(random, 0, static_cast<double>(bytes.size() - 1)));
        EXPECT_THROW((void)decodeCase(std::span(bytes).first(kept), "test"), core::Error) << kept;
    }
    int refused = 0;
    for (int i = 0; i < 500; ++i) {
        std::vector<std::byte> hurt = bytes;
        hurt[static_cast<std::size_t>(test::uniform(random, 0, static_cast<double>(bytes.size() - 1)))] ^=
            std::byte{0xff};
        try {
            (void)decodeCase(hurt, "test");  // another vertex is another tooth, but a tooth
        } catch (const core::Error&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 0);
    std::vector<std::byte> newer = bytes;
    newer[4] = std::byte{2};
    EXPECT_THROW((void)decodeCase(newer, "test"), core::Error);
    newer[4] = std::byte{9};
    EXPECT_THROW((void)decodeCase(newer, "test"), core::Error);
}

}  // namespace
}  // namespace handpiece::cases::case_bytes_test
