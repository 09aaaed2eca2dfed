// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/tooth/field_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <thread>

#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/model/tooth/field_builder.h"
#include "support/closed_meshes.h"
#include "support/random.h"

namespace handpiece::tooth {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kKey = 0x1234567890abcdefull;

struct Made {
    geometry::TriangleMesh mesh = test::bumpyMesh(2, 1.0);
    geometry::TriangleMesh core = test::sphereMesh(2, 0.7);
    geometry::TriangleTree tree{mesh}, coreTree{core};
    ToothField field;
    std::vector<std::byte> data;

    Made() {
        const PartSurface parts[] = {{&tree, Tissue::enamel, 10}, {&coreTree, Tissue::dentine, 20}};
        FieldSettings settings;
        settings.voxelMm = 0.1;
        field = FieldBuilder::fromSurface(mesh, tree, parts, settings);
        data = encodeField(field, tree, kKey);
    }
};

const Made& made() {
    static const Made one;
    return one;
}

std::optional<CachedField> readBack(const fs::path& folder, std::span<const std::byte> data, std::uint64_t key = kKey) {
    core::writeFile(folder / "f", data);
    return readFieldFile(folder / "f", key);
}

TEST(FieldCache, GivesBackWhatWasStored) {
    const test::TemporaryFolder folder;
    const std::optional<CachedField> got = readBack(folder.path(), made().data);
    ASSERT_TRUE(got.has_value());
    EXPECT_EQ(got->field.stateHash(), made().field.stateHash());
    EXPECT_EQ(got->field.settings().bandInMm, made().field.settings().bandInMm);
    const geometry::TriangleTree tree(made().mesh, got->tree);
    std::mt19937_64 g(test::seed());
    for (int i = 0; i < 300; ++i) {
        const core::Vec3 p = test::randomDirection(g) * test::uniform(g, 0.0, 2.0);
        EXPECT_EQ(tree.signedDistance(p), made().tree.signedDistance(p));
        EXPECT_EQ(got->field.tissueAt(p), made().field.tissueAt(p));
    }
}

TEST(FieldCache, TheSameFieldIsTheSameBytes) {
    EXPECT_EQ(encodeField(made().field, made().tree, kKey), made().data);
}

TEST(FieldCache, AnotherKeyIsAnotherTooth) {
    const test::TemporaryFolder folder;
    EXPECT_FALSE(readBack(folder.path(), made().data, kKey + 1).has_value());
}

TEST(FieldCache, TruncatedAnywhereItIsIgnored) {
    const test::TemporaryFolder folder;
    const auto& data = made().data;
    // Every 4 KiB, one byte less than each, and single bytes of the header.
    for (std::size_t size = 4096; size < data.size(); size += 4096)
        for (const std::size_t cut : {size, size - 1})
            EXPECT_FALSE(readBack(folder.path(), std::span(data).first(cut)).has_value()) << cut;
    for (std::size_t size = 0; size < 200; ++size)
        EXPECT_FALSE(readBack(folder.path(), std::span(data).first(size)).has_value()) << size;
    EXPECT_FALSE(readBack(folder.path(), std::span(data).first(data.size() - 1)).has_value());
    std::vector<std::byte> longer = data;
    longer.push_back(std::byte{0});
    EXPECT_FALSE(readBack(folder.path(), longer).has_value());
}

TEST(FieldCache, AFlippedBitIsNoticed) {
    const test::TemporaryFolder folder;
    std::mt19937_64 g(test::seed());
    std::vector<std::byte> data = made().data;
    const auto flip = [&](std::size_t at, int bit) {
        data[at] ^= std::byte{static_cast<unsigned char>(1 << bit)};
        EXPECT_FALSE(readBack(folder.path(), data).has_value()) << at << " bit " << bit;
        data[at] ^= std::byte{static_cast<unsigned char>(1 << bit)};
    };
    for (std::size_t at = 0; at < 144; ++at)
        flip(at, static_cast<int>(g() % 8));
    for (int i = 0; i < 150; ++i)
        flip(g() % data.size(), static_cast<int>(g() % 8));
    EXPECT_TRUE(readBack(folder.path(), data).has_value());
}

TEST(FieldCache, LyingSizesAllocateNothing) {
    // Counts of 2^60 with a header checksum that agrees: the file's own length says no before room is made.
    const test::TemporaryFolder folder;
    for (std::size_t at = 88; at < 128; at += 8) {
        std::vector<std::byte> data = made().data;
        for (const std::uint64_t lie :
             {std::uint64_t{1} << 60, std::uint64_t{1} << 33, ~std::uint64_t{0}, std::uint64_t{0}}) {
            std::memcpy(&data[at], &lie, 8);
            core::Hasher hasher;
            hasher.add(std::span(data).first(136));
            const std::uint64_t hash = hasher.value();
            std::memcpy(&data[136], &hash, 8);
            EXPECT_FALSE(readBack(folder.path(), data).has_value()) << at << ' ' << lie;
        }
    }
}

TEST(FieldCache, WhatIsNoFileOfOursIsIgnored) {
    const test::TemporaryFolder folder;
    EXPECT_FALSE(readFieldFile(folder.path() / "missing", kKey).has_value());
    EXPECT_FALSE(readFieldFile(folder.path(), kKey).has_value());
    EXPECT_FALSE(readBack(folder.path(), std::vector<std::byte>(10000, std::byte{0x55})).has_value());
    EXPECT_FALSE(readBack(folder.path(), std::span<const std::byte>{}).has_value());
}

TEST(FieldCache, KeyDependsOnEverythingThatMatters) {
    Case a;
    a.outer = made().mesh;
    a.parts.push_back({"enamel", Tissue::enamel, 10, made().mesh});
    a.parts.push_back({"dentine", Tissue::dentine, 20, made().core});
    const FieldSettings settings;
    const std::uint64_t key = cacheKey(a, settings);
    EXPECT_EQ(cacheKey(a, settings), key);
    Case b = a;
    b.name = "another name";
    b.scenery.push_back(a.parts[0]);
    EXPECT_EQ(cacheKey(b, settings), key) << "names and scenery are not felt";
    std::vector<std::uint64_t> others;
    FieldSettings other = settings;
    other.voxelMm = 0.051;
    others.push_back(cacheKey(a, other));
    other = settings;
    other.bandInMm = 0.31;
    others.push_back(cacheKey(a, other));
    b = a;
    b.outer.vertices[3].x() += 1e-15;
    others.push_back(cacheKey(b, settings));
    b = a;
    std::rotate(b.outer.triangles[5].begin(), b.outer.triangles[5].begin() + 1, b.outer.triangles[5].end());
    others.push_back(cacheKey(b, settings));
    b = a;
    b.parts[1].priority = 5;
    others.push_back(cacheKey(b, settings));
    b = a;
    b.parts[1].tissue = Tissue::pulp;
    others.push_back(cacheKey(b, settings));
    b = a;
    std::swap(b.parts[0], b.parts[1]);
    others.push_back(cacheKey(b, settings));
    others.push_back(key);
    std::sort(others.begin(), others.end());
    EXPECT_EQ(std::adjacent_find(others.begin(), others.end()), others.end());
}

TEST(FieldCache, ConcurrentWritersAndReadersNeverMix) {
    const test::TemporaryFolder folder;
    const std::vector<fs::path> places{folder.path() / "sub" / "f"};
    std::vector<std::thread> threads;
    std::atomic<int> whole{0}, broken{0};
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (int i = 0; i < 10; ++i) {
                if (writeFieldFile(places, made().data).empty()) ++broken;
                (readFieldFile(places[0], kKey).has_value() ? whole : broken)++;
            }
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(whole, 40);
    EXPECT_EQ(broken, 0);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path() / "sub"), fs::directory_iterator()), 1)
        << "nothing half-written is left";
}

TEST(FieldCache, TheFirstPlaceThatCanBeWritten) {
    const test::TemporaryFolder folder;
    core::writeFile(folder.path() / "file", std::string_view("in the way"));
    const std::vector<fs::path> places{folder.path() / "file" / "under" / "f", folder.path() / "second" / "f"};
    EXPECT_EQ(writeFieldFile(places, made().data), places[1]);
    EXPECT_TRUE(writeFieldFile({places[0]}, made().data).empty());
    EXPECT_TRUE(writeFieldFile({}, made().data).empty());
}

}  // namespace
}  // namespace handpiece::tooth
