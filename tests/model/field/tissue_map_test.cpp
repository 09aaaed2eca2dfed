// SPDX-License-Identifier: Apache-2.0
/// @file
/// Tissues all through the tooth: against closed forms, against the exact distances to the parts.

#include <gtest/gtest.h>

#include <cstring>

#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/field_builder.h"
#include "handpiece/model/field/part_tissues.h"
#include "handpiece/model/field/tissue_cache.h"
#include "support/closed_meshes.h"
#include "support/cut_support.h"

namespace handpiece::field::tissue_map_test {
namespace {

using core::Vec3;
using handpiece::test::randomDirection;
using handpiece::test::uniform;

constexpr double kVoxel = 0.05;

DistanceField ballField(double radius) {
    const double edge = radius + 0.3;
    return DistanceField::fromFunction({Vec3::Constant(-edge), Vec3::Constant(edge)}, FieldSettings{},
                                       [&](const Vec3& p) { return p.norm() - radius; });
}

void expectSame(const TissueMap& a, const TissueMap& b, const DistanceField& field) {
    for (std::uint32_t dense = 0; dense < tooth::in_test::denseCount(field); ++dense) {
        ASSERT_EQ(a.ofBrick(dense), b.ofBrick(dense));
        const TissueMap::Layers one = a.layers(dense), two = b.layers(dense);
        ASSERT_EQ(one.layers.size(), two.layers.size());
        ASSERT_EQ(one.rest, two.rest);
        for (std::size_t k = 0; k < one.layers.size(); ++k) {
            ASSERT_EQ(one.layers[k].tissue, two.layers[k].tissue);
            ASSERT_TRUE(std::equal(one.layers[k].values, one.layers[k].values + kBrickValues, two.layers[k].values));
        }
        const std::uint8_t* nodes = a.nodes()->of(dense);
        ASSERT_TRUE(std::equal(nodes, nodes + kBrickValues, b.nodes()->of(dense)));
    }
}

/// Where the map changes tissue along a ray, by bisection between two tissues.
double boundaryAlong(const TissueMap& map, const Vec3& from, const Vec3& direction, double low, double high) {
    const cases::Tissue first = map.at(from + low * direction);
    for (int i = 0; i < 30; ++i) {
        const double middle = 0.5 * (low + high);
        (map.at(from + middle * direction) == first ? low : high) = middle;
    }
    return low;
}

TEST(TissueMap, BoundariesAreSmoothBelowAVoxel) {
    const DistanceField field = ballField(2.0);
    const Vec3 normal = Vec3(0.3, -0.5, 0.8).normalized();
    const std::vector<TissueMap::PartFunction> parts{
        {[](const Vec3& p) { return p.norm() - 1.3; }, cases::Tissue::dentine, 1},
        {[&](const Vec3& p) { return normal.dot(p) + 0.4; }, cases::Tissue::caries, 2}};
    const TissueMap map = TissueMap::fromFunctions(field, parts, cases::Tissue::enamel);
    std::mt19937_64 generator(handpiece::test::seed());
    double worstBall = 0.0, worstPlane = 0.0;
    int balls = 0, planes = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vec3 d = randomDirection(generator);
        if (1.0 * normal.dot(d) > -0.2) {
            worstBall = std::max(worstBall, std::abs(boundaryAlong(map, Vec3::Zero(), d, 1.2, 1.4) - 1.3));
            ++balls;
        }
        if (normal.dot(d) < -0.5) {
            const double wanted = 0.4 / -normal.dot(d);
            worstPlane = std::max(
                worstPlane,
                std::abs(boundaryAlong(map, Vec3::Zero(), d, wanted - 0.1, wanted + 0.1) - wanted) * -normal.dot(d));
            ++planes;
        }
    }
    ASSERT_GT(balls, 100);
    ASSERT_GT(planes, 100);
    EXPECT_LT(worstBall, 0.1 * kVoxel);
    EXPECT_LT(worstPlane, 0.1 * kVoxel);
    EXPECT_EQ(map.tissues(), (std::vector{cases::Tissue::enamel, cases::Tissue::dentine, cases::Tissue::caries}));
    EXPECT_EQ(map.at({100, 0, 0}), cases::Tissue::none);
}

TEST(TissueMap, NodesLayersAndPointsTellTheSame) {
    const DistanceField field = ballField(1.5);
    const std::vector<TissueMap::PartFunction> parts{
        {[](const Vec3& p) { return (p - Vec3(0.5, 0, 0)).norm() - 0.7; }, cases::Tissue::dentine, 1},
        {[](const Vec3& p) { return (p - Vec3(0.5, 0.2, 0)).norm() - 0.3; }, cases::Tissue::pulp, 2},
        {[](const Vec3& p) { return (p - Vec3(0.5, 0.7, 0)).norm() - 0.4; }, cases::Tissue::caries, 2}};
    const TissueMap map = TissueMap::fromFunctions(field, parts, cases::Tissue::enamel);
    const FieldView view = field.view();
    std::size_t mixed = 0, triple = 0;
    for (std::uint32_t dense = 0; dense < tooth::in_test::denseCount(field); ++dense) {
        const std::uint8_t* nodes = map.nodes()->of(dense);
        const TissueMap::Layers layers = map.layers(dense);
        EXPECT_EQ(map.nodes()->isMixed(dense), !layers.layers.empty());
        if (!map.nodes()->isMixed(dense)) continue;
        ++mixed;
        triple += layers.layers.size() >= 2;
        const auto brick = field::brickAt(view.bricks, dense);
        for (int i = 0; i < kBrickValues; ++i) {
            const int node[3] = {i % 9, i / 9 % 9, i / 81};
            cases::Tissue byLayers = layers.rest;
            for (const TissueMap::Layer& layer : layers.layers)
                if (layer.values[i] < 0) {
                    byLayers = layer.tissue;
                    break;
                }
            EXPECT_EQ(static_cast<cases::Tissue>(nodes[i]), byLayers);
            Vec3 p;
            for (int k = 0; k < 3; ++k)
                p[k] = view.originMm[k] + view.voxelMm * (8 * brick[static_cast<std::size_t>(k)] + node[k]);
            // Of equal priorities the later wins.
            cases::Tissue wanted = cases::Tissue::enamel;
            for (const std::size_t part : {std::size_t{2}, std::size_t{1}, std::size_t{0}})
                if (parts[part].signedDistance(p) < -1e-6) {
                    wanted = parts[part].tissue;
                    break;
                } else if (parts[part].signedDistance(p) < 1e-6) {
                    wanted = byLayers;
                    break;
                }
            EXPECT_EQ(byLayers, wanted);
        }
    }
    EXPECT_GT(mixed, 50u);
    EXPECT_GT(triple, 5u);
}

TEST(TissueMap, PartsGiveWhatTheirSurfacesBound) {
    // Enamel all over, dentine in it, caries across the outer surface: as cases are.
    const geometry::TriangleMesh outer = handpiece::test::bumpyMesh(4, 2.0),
                                 inner = handpiece::test::sphereMesh(4, 1.2);
    geometry::TriangleMesh decay = handpiece::test::sphereMesh(3, 0.6);
    for (Vec3& v : decay.vertices)
        v += Vec3(1.5, 0.3, 0.2);
    const geometry::TriangleTree outerTree(outer), innerTree(inner), decayTree(decay);
    const std::vector<PartSurface> parts{{&outerTree, cases::Tissue::enamel, 10},
                                         {&innerTree, cases::Tissue::dentine, 20},
                                         {&decayTree, cases::Tissue::caries, 30}};
    const DistanceField field = FieldBuilder::fromSurface(outer, outerTree, parts, FieldSettings{});
    const TissueMap map = TissueMap::fromParts(field, parts);
    const PartTissues exact(parts);
    std::mt19937_64 generator(handpiece::test::seed());
    std::size_t asked = 0, nearBoundary = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3 p = randomDirection(generator) * uniform(generator, 0.0, 2.4);
        if (!(outerTree.signedDistance(p) < 0.05)) continue;
        double boundary = 1.0;
        for (const PartSurface& part : parts)
            boundary = std::min(boundary, std::abs(part.tree->signedDistance(p)));
        if (boundary < 0.15 * kVoxel) {
            ++nearBoundary;
            continue;
        }
        ++asked;
        // Outside the tooth the nearest part counts, and near a tie between two of them either will do.
        if (outerTree.signedDistance(p) > 0.0 && decayTree.signedDistance(p) > 0.0 &&
            std::abs(outerTree.signedDistance(p) - decayTree.signedDistance(p)) < kVoxel)
            continue;
        EXPECT_EQ(map.at(p), exact.at(p)) << p.transpose();
    }
    EXPECT_GT(asked, 10000u);
    EXPECT_LT(nearBoundary, asked / 10);
    // And the same bits with one thread.
    core::setThreadCount(1);
    const TissueMap alone = TissueMap::fromParts(field, parts);
    core::setThreadCount(0);
    expectSame(map, alone, field);
}

TEST(TissueMap, UniformIsOneTissueEverywhere) {
    const DistanceField field = ballField(0.8);
    const TissueMap map = TissueMap::uniform(field, cases::Tissue::bone);
    EXPECT_EQ(map.tissues(), std::vector{cases::Tissue::bone});
    EXPECT_EQ(map.at(Vec3::Zero()), cases::Tissue::bone);
    EXPECT_EQ(map.nodes()->mixedBricks(), 0u);
    EXPECT_TRUE(map.isOn(field));
    EXPECT_FALSE(map.isOn(ballField(1.0)));
}

TEST(TissueCache, GivesBackTheMapOrNothing) {
    const DistanceField field = ballField(1.0);
    const TissueMap::PartFunction part{[](const Vec3& p) { return p.norm() - 0.6; }, cases::Tissue::dentine, 1};
    const TissueMap map = TissueMap::fromFunctions(field, std::span(&part, 1), cases::Tissue::enamel);
    const handpiece::test::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "x.tissues";
    EXPECT_FALSE(readTissueFile(file, field, 7, {cases::Tissue::enamel, cases::Tissue::dentine}));
    const std::vector<std::byte> good = encodeTissues(map, 7);
    const auto write = [&file](const std::vector<std::byte>& data) {
        core::writeFile(file, data, {.ownerOnly = true, .lasting = false});
    };
    write(good);
    const std::optional<TissueMap> back =
        readTissueFile(file, field, 7, {cases::Tissue::enamel, cases::Tissue::dentine});
    ASSERT_TRUE(back);
    expectSame(*back, map, field);
    EXPECT_EQ(back->at({0.59, 0, 0}), cases::Tissue::dentine);
    EXPECT_FALSE(readTissueFile(file, field, 8, {cases::Tissue::enamel, cases::Tissue::dentine}));
    EXPECT_FALSE(readTissueFile(file, ballField(1.8), 7, {cases::Tissue::enamel, cases::Tissue::dentine}));
    std::mt19937_64 generator(handpiece::test::seed());
    for (int i = 0; i < 200; ++i) {
        std::vector<std::byte> bad = good;
        if (i % 4 == 0) {
            bad.resize(generator() % bad.size());
        } else {
            bad[generator() % (i % 4 == 1 ? bad.size() : std::size_t{64})] ^= std::byte{1} << (generator() % 8);
        }
        write(bad);
        EXPECT_FALSE(readTissueFile(file, field, 7, {cases::Tissue::enamel, cases::Tissue::dentine}));
    }
}

TEST(TissueCache, SumsThatAreRightProveNothing) {
    const DistanceField field = ballField(1.0);
    const TissueMap::PartFunction part{[](const Vec3& p) { return p.norm() - 0.6; }, cases::Tissue::dentine, 1};
    const TissueMap map = TissueMap::fromFunctions(field, std::span(&part, 1), cases::Tissue::enamel);
    const TissueSet known{cases::Tissue::enamel, cases::Tissue::dentine};
    const handpiece::test::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "x.tissues";
    const std::vector<std::byte> good = encodeTissues(map, 7);
    // docs/formats/tissue-cache.md
    constexpr std::size_t kCountsAt = 24, kTissueHashAt = 48, kTissueHeaderBytes = 64;
    std::uint64_t counts[3];
    std::memcpy(counts, &good[kCountsAt], sizeof counts);
    const std::uint64_t bricks = counts[0], mixed = counts[1], layers = counts[2];
    const auto readSummed = [&](std::vector<std::byte> data) {
        const std::uint64_t payload = hashOf(std::span(data).subspan(kTissueHeaderBytes));
        std::memcpy(&data[kTissueHashAt], &payload, 8);
        core::Hasher head;
        head.add(std::span<const std::byte>(data).first(kTissueHeaderBytes - 8));
        const std::uint64_t hash = head.value();
        std::memcpy(&data[kTissueHeaderBytes - 8], &hash, 8);
        core::writeFile(file, data, {.ownerOnly = true, .lasting = false});
        return readTissueFile(file, field, 7, known);
    };
    ASSERT_TRUE(readSummed(good));
    const std::size_t ofBrick = kTissueHeaderBytes + 4 * mixed, rest = ofBrick + bricks, count = rest + mixed,
                      layerTissue = count + mixed, nodes = layerTissue + layers;
    const auto refused = [&](std::size_t at, auto value, const char* what) {
        std::vector<std::byte> data = good;
        std::memcpy(&data[at], &value, sizeof value);
        EXPECT_FALSE(readSummed(std::move(data))) << what;
    };
    std::uint32_t firstMixed = 0;
    std::memcpy(&firstMixed, &good[kTissueHeaderBytes], 4);
    std::size_t inside = 0;
    while (map.ofBrick(static_cast<std::uint32_t>(inside)) == cases::Tissue::none)
        ++inside;
    for (const std::uint64_t lie : {std::uint64_t{0}, std::uint64_t{1} << 33, std::uint64_t{1} << 61})
        for (const std::size_t at : {kCountsAt, kCountsAt + 8, kCountsAt + 16})
            refused(at, lie, "a count that lies");
    refused(kTissueHeaderBytes, std::uint32_t{0xffffffffu}, "a brick beyond all");
    refused(kTissueHeaderBytes + 4, firstMixed, "a brick twice");
    refused(ofBrick + inside, std::uint8_t{0}, "no tissue inside");
    refused(ofBrick + inside, std::uint8_t{6}, "a tissue that the tooth has not");
    refused(ofBrick + firstMixed, std::uint8_t{1}, "a mixed brick of one tissue");
    refused(rest, std::uint8_t{200}, "a rest that there is not");
    refused(count, std::uint8_t{0}, "a brick without layers");
    refused(count, std::uint8_t{255}, "more layers than there are");
    refused(layerTissue, std::uint8_t{10}, "a layer of what there is not");
    refused(nodes + 3, std::uint8_t{4}, "a node of another tissue");
    std::vector<std::byte> swapped = good;
    for (std::size_t i = 0; i < 729; ++i) {
        std::byte& node = swapped[nodes + i];
        node = node == std::byte{1} ? std::byte{2} : std::byte{1};
    }
    EXPECT_FALSE(readSummed(swapped)) << "nodes that are not of their layers";
    // At random: a map that nothing trips over, or none.
    std::mt19937_64 generator(handpiece::test::seed());
    for (int i = 0; i < 300; ++i) {
        std::vector<std::byte> data = good;
        const std::size_t from = i % 2 == 0 ? kCountsAt : kTissueHeaderBytes,
                          to = i % 2 == 0 ? kTissueHashAt : data.size();
        const std::uint64_t anything = generator();
        std::memcpy(&data[from + generator() % (to - from - 8)], &anything, 1 + generator() % 8);
        const auto got = readSummed(std::move(data));
        for (int k = 0; got && k < 30; ++k)
            EXPECT_TRUE(got->at(randomDirection(generator) * uniform(generator, 0.0, 1.2)) <= cases::Tissue::dentine);
    }
    core::writeFile(file, good, {.ownerOnly = true, .lasting = false});
    std::filesystem::permissions(file, std::filesystem::perms::others_write, std::filesystem::perm_options::add);
    EXPECT_FALSE(readTissueFile(file, field, 7, known)) << "a file that anybody may have written";
}

TEST(TissueMap, IsOfACasesTissues) {
    const handpiece::test::TemporaryFolder folder;
    cases::Case toothCase;
    toothCase.name = "bumpy";
    toothCase.outer = handpiece::test::bumpyMesh(3, 2.0);
    toothCase.parts = {{"enamel", cases::Tissue::enamel, 10, toothCase.outer},
                       {"dentine", cases::Tissue::dentine, 20, handpiece::test::sphereMesh(3, 1.2)}};
    tooth::LoadSettings settings;
    settings.cacheFolder = folder.path();
    const auto files = [&] {
        std::size_t count = 0;
        for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
            count += entry.path().extension() == ".tissues";
        return count;
    };
    settings.useCache = false;
    const auto plain = tooth::loadModel(toothCase, settings);
    EXPECT_EQ(files(), 0u);
    settings.useCache = true;
    const auto built = tooth::loadModel(toothCase, settings);
    EXPECT_EQ(files(), 1u);
    const auto again = tooth::loadModel(toothCase, settings);
    expectSame(built->tissues, plain->tissues, plain->field);
    expectSame(again->tissues, plain->tissues, plain->field);
    EXPECT_EQ(again->volumesMm3, plain->volumesMm3);
    const double dentine = geometry::enclosedVolumeMm3(toothCase.parts[1].mesh),
                 all = geometry::enclosedVolumeMm3(toothCase.outer);
    EXPECT_NEAR(again->volumesMm3[static_cast<std::size_t>(cases::Tissue::dentine)], dentine, 5e-3 * dentine);
    EXPECT_NEAR(again->volumesMm3[static_cast<std::size_t>(cases::Tissue::enamel)], all - dentine, 2e-3 * all);
    // Alone, a part is all of it.
    toothCase.parts.pop_back();
    const auto alone = tooth::loadModel(toothCase, settings);
    EXPECT_EQ(alone->tissues.tissues(), std::vector{cases::Tissue::enamel});
    EXPECT_EQ(files(), 1u);
}

}  // namespace
}  // namespace handpiece::field::tissue_map_test
