// SPDX-License-Identifier: Apache-2.0
// A packed field is the field itself again, bit for bit, and a tenth of it.
#include "handpiece/model/field/packed_field.h"

#include <gtest/gtest.h>

#include "handpiece/model/field/field_builder.h"
#include "handpiece/model/field/tissue_cache.h"
#include "support/closed_meshes.h"

namespace handpiece::field::packed_field_test {
namespace {

constexpr std::uint64_t kKey = 0x1234567890abcdefull;
const TissueSet kTissues{cases::Tissue::enamel, cases::Tissue::dentine};

struct Made {
    geometry::TriangleMesh mesh = test::bumpyMesh(3, 2.0);
    geometry::TriangleMesh core = test::sphereMesh(2, 1.4);
    geometry::TriangleTree tree{mesh}, coreTree{core};
    std::vector<PartSurface> parts{{&tree, cases::Tissue::enamel, 10}, {&coreTree, cases::Tissue::dentine, 20}};
    FieldSettings settings;
    std::vector<std::uint32_t> nearest;
    DistanceField field{FieldStorage{}};

    Made() { field = FieldBuilder::fromSurface(mesh, tree, parts, settings, {}, &nearest); }
};
const Made& made() {
    static const Made one;
    return one;
}

std::optional<DistanceField> unpacked(std::span<const std::byte> packed, std::uint64_t key = kKey) {
    return unpackField(packed, key, made().tree, made().settings, kTissues);
}

TEST(PackedField, IsTheSameFieldAgain) {
    const std::vector<std::byte> packed = packField(made().field, made().nearest, kKey),
                                 plain = encodeField(made().field, kKey);
    const std::optional<DistanceField> got = unpacked(packed);
    ASSERT_TRUE(got);
    const FieldStorage &now = got->storage(), &before = made().field.storage();
    EXPECT_EQ(now.values, before.values);
    EXPECT_EQ(now.coarse, before.coarse);
    EXPECT_EQ(now.brickIndex, before.brickIndex);
    EXPECT_EQ(got->stateHash(), made().field.stateHash());
    EXPECT_EQ(encodeField(*got, kKey), plain);
    EXPECT_LT(6 * packed.size(), plain.size()) << packed.size() << " of " << plain.size();
    EXPECT_EQ(packField(made().field, made().nearest, kKey), packed);
}

TEST(PackedField, OfAnotherKeySurfaceOrDamagedItIsNone) {
    const std::vector<std::byte> packed = packField(made().field, made().nearest, kKey);
    EXPECT_FALSE(unpacked(packed, kKey + 1));
    EXPECT_FALSE(unpackField(packed, kKey, made().coreTree, made().settings, kTissues));
    EXPECT_FALSE(unpackField(packed, kKey, made().tree, made().settings, {cases::Tissue::enamel}));
    for (const std::size_t bytes : {std::size_t{0}, std::size_t{15}, std::size_t{40}, packed.size() - 1})
        EXPECT_FALSE(unpacked(std::span(packed).first(bytes))) << bytes;
    // Numbers that no triangle has: where a file is whole and yet of no such surface.
    std::vector<std::uint32_t> other = made().nearest;
    for (std::uint32_t& triangle : other)
        if (triangle != geometry::kNoTriangle) triangle += 1'000'000;
    EXPECT_FALSE(unpacked(packField(made().field, other, kKey)));
    // And nodes that no brick owns, or two.
    other = made().nearest;
    std::fill(other.begin(), other.end(), 0u);
    EXPECT_FALSE(unpacked(packField(made().field, other, kKey)));
}

TEST(PackedField, TissuesComeBackAsWell) {
    const TissueMap map = TissueMap::fromParts(made().field, made().parts);
    const std::vector<std::byte> packed = packTissues(map, kKey), plain = encodeTissues(map, kKey);
    const std::optional<TissueMap> got = unpackTissues(packed, made().field, kKey, kTissues);
    ASSERT_TRUE(got);
    EXPECT_EQ(encodeTissues(*got, kKey), plain);
    EXPECT_LT(2 * packed.size(), plain.size());
    EXPECT_FALSE(unpackTissues(packed, made().field, kKey + 1, kTissues));
    EXPECT_FALSE(unpackTissues(std::span(packed).first(packed.size() / 2), made().field, kKey, kTissues));
    EXPECT_FALSE(unpackTissues(packed, made().field, kKey, {cases::Tissue::enamel}));
}

}  // namespace
}  // namespace handpiece::field::packed_field_test
