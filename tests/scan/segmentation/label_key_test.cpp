// SPDX-License-Identifier: Apache-2.0
// What the numbers of labels mean, and one tooth out of them.
#include "handpiece/scan/segmentation/label_key.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "support/error_of.h"

namespace handpiece::segmentation::label_key_test {
namespace {

using core::Vec3;
using test::errorOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using What = LabelMeaning::What;

/// A volume of so many voxels of each number, 1 mm3 each.
volume::Labels counted(const std::map<int, int>& counts) {
    volume::Labels labels;
    for (const auto& [number, count] : counts)
        labels.values.insert(labels.values.end(), static_cast<std::size_t>(count), static_cast<std::uint8_t>(number));
    labels.grid.size = {static_cast<int>(labels.values.size()), 1, 1};
    return labels;
}

std::string told(const LabelKey& key, int n) {
    const LabelMeaning& m = key.of[static_cast<std::size_t>(n)];
    constexpr std::array<const char*, 9> kNames{"unknown",    "tissue", "tooth",      "pulp",     "upper bone",
                                                "lower bone", "gum",    "prosthesis", "not shown"};
    const std::string name = kNames[static_cast<std::size_t>(m.what)];
    return m.what == What::tissue || m.what == What::tooth || m.what == What::pulp
               ? name + " " + std::to_string(m.number)
               : name;
}

LabelKey keyOf(const std::map<int, int>& counts, const std::vector<volume::LabelName>& names = {},
               std::optional<LabelNumbers> asked = {}) {
    return labelKeyOf(counted(counts), names, asked, "labels");
}

TEST(LabelKey, NamesThatCountAreNoFdiNumbers) {
    const auto named = [](const std::string& word, std::initializer_list<int> numbers) {
        std::vector<volume::LabelName> names;
        int value = 1;
        for (const int n : numbers)
            names.push_back({value++, word + std::to_string(n)});
        return names;
    };
    const std::map<int, int> three{{0, 9000}, {1, 400}, {2, 400}, {3, 400}};
    // 19 and 20 are no FDI numbers, so 18 is none either.
    EXPECT_THAT(test::errorOf([&] {
                    (void)keyOf(three, named("Tooth ", {18, 19, 20}));
                }),
                testing::HasSubstr("may be FDI numbers, Universal numbers"));
    EXPECT_THAT(test::errorOf([&] {
                    (void)keyOf(three, named("tooth_", {2, 11, 31}));
                }),
                testing::HasSubstr("may be FDI numbers, Universal numbers"));
    EXPECT_EQ(told(keyOf(three, named("Tooth ", {16, 17, 18})), 3), "tooth 18");
    EXPECT_EQ(told(keyOf(three, named("fdi", {11, 12, 46})), 3), "tooth 46");
    // 3D Slicer's own names for what nobody named.
    EXPECT_FALSE(keyOf(three, named("Segment_", {11, 12, 13})).isMouth);
    const LabelKey twice = keyOf(three, {{1, "tooth 36"}, {2, "fdi36"}, {3, "tooth 37"}, {3, "tooth 38"}});
    EXPECT_THAT(twice.notes, testing::Contains(testing::HasSubstr("labels 1, 2 are all called tooth 36")));
    EXPECT_THAT(twice.notes, testing::Contains(testing::HasSubstr("label 3 has several names")));
    const LabelKey made = keyOf(three, {{1, "Implant 46"}, {2, "47 missing"}, {3, "tooth 45"}});
    EXPECT_EQ(told(made, 1), "prosthesis");
    EXPECT_EQ(told(made, 2), "not shown");
}

TEST(LabelKey, LabelsOfWhichNobodySaidSo) {
    volume::Volume v;
    v.grid.size = {100, 1, 1};
    v.values.assign(100, 0.0f);
    for (int n = 0; n < 28; ++n)
        v.values[static_cast<std::size_t>(n)] = static_cast<float>(1 + n);
    EXPECT_EQ(unsaidLabels(v, {}), 28);
    v.values[99] = 0.5f;
    EXPECT_EQ(unsaidLabels(v, {}), 0);
    v.values[99] = 200.0f;
    EXPECT_EQ(unsaidLabels(v, {}), 0);
    v.values.assign(100, 0.0f);
    v.values[3] = 1.0f;
    EXPECT_EQ(unsaidLabels(v, {}), 0) << "a mask";
    EXPECT_EQ(unsaidLabels(v, {{1, "Segment_1"}}), 1);
    // A mouth's teeth with one number wrong.
    v.values.assign(100, 0.0f);
    for (int n = 11; n <= 18; ++n)
        v.values[static_cast<std::size_t>(n)] = static_cast<float>(n);
    v.values[1] = 99.0f;
    EXPECT_EQ(unsaidLabels(v, {}), 9);
    v.values[1] = 46.5f;
    EXPECT_EQ(unsaidLabels(v, {}), 8);
}

TEST(LabelKey, FdiNumbersWithWhatToothFairyHasBesideThem) {
    const LabelKey key = keyOf({{0, 9000},
                                {1, 50000},
                                {2, 60000},
                                {3, 500},
                                {8, 300},
                                {18, 400},
                                {46, 600},
                                {85, 200},
                                {146, 30},
                                {103, 20},
                                {200, 5}});
    EXPECT_TRUE(key.isMouth);
    EXPECT_EQ(told(key, 1), "lower bone");
    EXPECT_EQ(told(key, 2), "upper bone");
    EXPECT_EQ(told(key, 3), "not shown");
    EXPECT_EQ(told(key, 8), "prosthesis");
    EXPECT_EQ(told(key, 46), "tooth 46");
    EXPECT_EQ(told(key, 85), "tooth 85");
    EXPECT_EQ(told(key, 146), "pulp 46");
    EXPECT_EQ(told(key, 103), "not shown");
    EXPECT_THAT(key.notes, Contains(HasSubstr("the label 200 means is not known")));
}

TEST(LabelKey, TissuesStayTissues) {
    for (const auto& counts : {std::map<int, int>{{0, 100}, {1, 10}, {2, 10}, {3, 10}},
                               std::map<int, int>{{2, 300}, {3, 300}, {4, 20}, {6, 9000}, {8, 500}}}) {
        const LabelKey key = keyOf(counts);
        EXPECT_FALSE(key.isMouth);
        EXPECT_EQ(told(key, 3), "tissue 3");
    }
    EXPECT_FALSE(keyOf({{46, 500}}, {}, LabelNumbers::tissues).isMouth);
}

TEST(LabelKey, TeethCountedThroughAreToldByTheNumbersThatFdiLacks) {
    std::map<int, int> counts{{1, 50000}, {2, 60000}};
    for (int n = 11; n <= 42; ++n)
        counts[n] = 400;
    counts[46] = 20;
    const LabelKey key = keyOf(counts);
    EXPECT_EQ(told(key, 11), "tooth 11");
    EXPECT_EQ(told(key, 19), "tooth 21");
    EXPECT_EQ(told(key, 40), "tooth 46");
    EXPECT_EQ(told(key, 46), "pulp 11");
    EXPECT_THAT(key.notes, Contains(HasSubstr("count through")));
}

TEST(LabelKey, WhatIsAmbiguousIsAsked) {
    std::map<int, int> all;
    for (int n = 1; n <= 32; ++n)
        all[n] = 400;
    EXPECT_THAT(errorOf([&] { (void)keyOf(all); }), HasSubstr("--numbers"));
    EXPECT_EQ(test::errorIdOf([&] { (void)keyOf(all); }), "labels-ambiguous");
    const LabelKey key = keyOf(all, {}, LabelNumbers::universal);
    const std::map<int, int> expected{{1, 18},  {8, 11},  {9, 21},  {16, 28}, {17, 38},
                                      {19, 36}, {24, 31}, {25, 41}, {30, 46}, {32, 48}};
    for (const auto& [number, fdi] : expected)
        EXPECT_EQ(told(key, number), "tooth " + std::to_string(fdi));
    // An upper jaw by Universal numbers, of which eleven and more are FDI numbers too.
    std::map<int, int> upper;
    for (int n = 2; n <= 15; ++n)
        upper[n] = 400;
    EXPECT_EQ(test::errorIdOf([&] { (void)keyOf(upper); }), "labels-ambiguous");
    EXPECT_THAT(errorOf([&] { (void)labelNumbersByName("roman"); }), HasSubstr("universal"));
}

TEST(LabelKey, NamesWin) {
    // As TotalSegmentator, 3D Slicer's users and a dentist write them.
    const LabelKey key = keyOf({{1, 9}, {2, 9}, {3, 9}, {4, 9}, {5, 9}, {6, 9}, {7, 9}, {9, 9}},
                               {{1, "upper_left_central_incisor_fdi21"},
                                {2, "lower_right_first_molar_pulp_fdi146"},
                                {3, "Tooth 36"},
                                {4, "Lower left second premolar"},
                                {5, "mandible"},
                                {6, "Left inferior alveolar canal"},
                                {7, "T48"},
                                {9, "left_maxillary_sinus"}});
    EXPECT_TRUE(key.isMouth);
    EXPECT_EQ(told(key, 1), "tooth 21");
    EXPECT_EQ(told(key, 2), "pulp 46");
    EXPECT_EQ(told(key, 3), "tooth 36");
    EXPECT_EQ(told(key, 4), "tooth 35");
    EXPECT_EQ(told(key, 5), "lower bone");
    EXPECT_EQ(told(key, 6), "not shown");
    EXPECT_EQ(told(key, 7), "tooth 48");
    EXPECT_EQ(told(key, 9), "not shown");
    const LabelKey tissues = keyOf({{1, 9}, {2, 9}, {3, 9}}, {{1, "Enamel"}, {2, "dentin"}, {3, "Pulp"}});
    EXPECT_FALSE(tissues.isMouth);
    EXPECT_EQ(told(tissues, 1), "tissue 2");
    EXPECT_EQ(told(tissues, 3), "tissue 4");
    // Names that say nothing do not count.
    EXPECT_EQ(told(keyOf({{46, 500}, {47, 500}}, {{46, "Segment_1"}, {47, "Segment_2"}}), 46), "tooth 46");
}

TEST(LabelKey, RowsOfTeethAreNoTeeth) {
    const std::vector<volume::LabelName> names{
        {1, "Upper Skull"}, {2, "Mandible"}, {3, "Upper Teeth"}, {4, "Lower Teeth"}, {5, "Mandibular canal"}};
    const std::map<int, int> counts{{1, 90}, {2, 90}, {3, 90}, {4, 90}, {5, 9}};
    EXPECT_EQ(test::errorIdOf([&] { (void)keyOf(counts, names); }), "labels-no-single-teeth");
    EXPECT_THAT(errorOf([&] { (void)keyOf(counts, names); }), HasSubstr("rows of teeth"));
}

TEST(LabelKey, GreyValuesAreNoLabels) {
    volume::Volume volume;
    volume.grid.size = {1000, 1, 1};
    volume.values.assign(1000, 0.0f);
    for (std::size_t i = 0; i < 300; ++i)
        volume.values[i] = static_cast<float>(11 + i % 2);
    EXPECT_TRUE(looksLikeMouth(volume, {}));
    volume.values[500] = 19.0f;  // no FDI number: it must be said that these are labels
    EXPECT_FALSE(looksLikeMouth(volume, {}));
    EXPECT_TRUE(looksLikeMouth(volume, {{19, "tooth 21"}}));
    volume.values[500] = 0.5f;
    EXPECT_FALSE(looksLikeMouth(volume, {}));
    for (std::size_t i = 0; i < 1000; ++i)
        volume.values[i] = static_cast<float>(i % 200);
    EXPECT_FALSE(looksLikeMouth(volume, {}));
}

TEST(ToothAlone, KeepsTheLargestPieceAndTellsTheRest) {
    volume::Labels labels;
    labels.grid.size = {30, 12, 12};
    labels.grid.spacingMm = Vec3::Constant(0.5);
    labels.grid.originMm = Vec3(-3, 4, 5);
    labels.values.assign(labels.grid.count(), 0);
    const auto fill = [&](int from, int to, std::uint8_t label) {
        for (int k = 2; k < 10; ++k)
            for (int j = 2; j < 10; ++j)
                for (int i = from; i < to; ++i)
                    labels.values[labels.grid.index(i, j, k)] = label;
    };
    fill(0, 10, 46);
    fill(4, 6, 146);  // its pulp, through it
    fill(12, 14, 46);
    fill(20, 29, 47);
    labels.values[labels.grid.index(25, 0, 0)] = 11;
    const LabelKey key = labelKeyOf(labels, {}, {}, "labels");
    const std::vector<LabelledTooth> teeth = teethOf(labels, key);
    ASSERT_EQ(teeth.size(), 3u);
    EXPECT_EQ(teeth[0].fdi, 11);
    EXPECT_TRUE(isSpeck(teeth[0]));
    EXPECT_EQ(teeth[1].fdi, 46);
    EXPECT_TRUE(teeth[1].isCutOff);
    EXPECT_TRUE(teeth[1].hasPulp);
    EXPECT_FALSE(teeth[2].isCutOff);
    EXPECT_DOUBLE_EQ(teeth[2].volumeMm3, 9 * 8 * 8 / 8.0);
    const ToothAlone alone46 = alone(labels, key, teeth[1]);
    EXPECT_EQ(alone46.pieces, 2u);
    EXPECT_NEAR(alone46.leftOutMm3, 2 * 8 * 8 / 8.0, 1e-9);
    std::map<int, int> counts;
    for (const std::uint8_t v : alone46.labels.values)
        ++counts[v];
    EXPECT_EQ(counts[2], 8 * 8 * 8);
    EXPECT_EQ(counts[4], 2 * 8 * 8);
    EXPECT_EQ(counts.size(), 3u);
    // It lies where it lay.
    EXPECT_TRUE(alone46.labels.grid.toMm(Vec3(1, 1, 1)).isApprox(labels.grid.toMm(Vec3(0, 2, 2))));
}

/// Slices that lie far apart: the outline goes from one to the next, without steps.
TEST(ToothAlone, FillsInBetweenSlicesFarApart) {
    constexpr double kFar = 0.6, kNear = 0.2;
    for (int axis = 0; axis < 3; ++axis) {
        volume::Labels labels;
        labels.grid.spacingMm = Vec3::Constant(kNear);
        labels.grid.spacingMm[axis] = kFar;
        const Vec3 centre(6.1, 6.2, 6.3), half(4.0, 3.5, 5.0);
        for (std::size_t a = 0; a < 3; ++a)
            labels.grid.size[a] = static_cast<int>(12.6 / labels.grid.spacingMm[static_cast<int>(a)]);
        labels.values.assign(labels.grid.count(), 0);
        const auto inside = [&](const Vec3& p) { return (p - centre).cwiseQuotient(half).squaredNorm() < 1.0; };
        const auto& size = labels.grid.size;
        for (int k = 0; k < size[2]; ++k)
            for (int j = 0; j < size[1]; ++j)
                for (int i = 0; i < size[0]; ++i)
                    if (inside(labels.grid.toMm(Vec3(i, j, k)))) labels.values[labels.grid.index(i, j, k)] = 46;
        const LabelKey key = labelKeyOf(labels, {}, {}, "labels");
        const ToothAlone made = alone(labels, key, teethOf(labels, key).front());
        EXPECT_TRUE(made.isFilledIn);
        const volume::Grid& g = made.labels.grid;
        EXPECT_TRUE(g.spacingMm.isApprox(Vec3::Constant(kNear)));
        int wrong = 0, set = 0;
        for (int k = 0; k < g.size[2]; ++k)
            for (int j = 0; j < g.size[1]; ++j)
                for (int i = 0; i < g.size[0]; ++i) {
                    const bool is = made.labels.values[g.index(i, j, k)] != 0;
                    set += is ? 1 : 0;
                    wrong += is != inside(g.toMm(Vec3(i, j, k))) ? 1 : 0;
                }
        const double volume = 4.0 / 3.0 * M_PI * half.prod();
        EXPECT_NEAR(set * g.voxelMm3(), volume, 0.02 * volume);
        EXPECT_LT(wrong * g.voxelMm3(), 0.035 * volume);
    }
}

}  // namespace
}  // namespace handpiece::segmentation::label_key_test
