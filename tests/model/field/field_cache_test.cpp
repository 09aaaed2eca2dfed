// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/field_cache.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <map>
#include <thread>

#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/model/field/field_builder.h"
#include "support/closed_meshes.h"
#include "support/random.h"

namespace handpiece::field::field_cache_test {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kKey = 0x1234567890abcdefull;
// As docs/formats/field-cache.md has it.
constexpr std::size_t kSettingsAt = 24, kOriginAt = 48, kBricksAt = 72, kDenseAt = 88, kStoredAt = 96, kMixedAt = 104,
                      kPayloadHashAt = 112, kHeaderBytes = 128;

struct Made {
    geometry::TriangleMesh mesh = test::bumpyMesh(2, 1.0);
    geometry::TriangleMesh core = test::sphereMesh(2, 0.7);
    geometry::TriangleTree tree{mesh}, coreTree{core};
    FieldSettings settings;
    DistanceField field{FieldStorage{}};
    std::vector<std::byte> data;

    Made() {
        const PartSurface parts[] = {{&tree, cases::Tissue::enamel, 10}, {&coreTree, cases::Tissue::dentine, 20}};
        settings.voxelMm = 0.1;
        field = FieldBuilder::fromSurface(mesh, tree, parts, settings);
        data = encodeField(field, kKey);
    }
};

const Made& made() {
    static const Made one;
    return one;
}

const TissueSet kTissues{cases::Tissue::enamel, cases::Tissue::dentine};

std::optional<DistanceField> read(const fs::path& file, std::uint64_t key = kKey) {
    return readFieldFile(file, key, made().tree, made().settings, kTissues);
}

void write(const fs::path& file, std::span<const std::byte> data) {
    core::writeFile(file, data, {.ownerOnly = true, .lasting = false});
}

std::optional<DistanceField> readBack(const fs::path& folder, std::span<const std::byte> data,
                                      std::uint64_t key = kKey) {
    write(folder / "f", data);
    return read(folder / "f", key);
}

TEST(FieldCache, GivesBackWhatWasStored) {
    const test::TemporaryFolder folder;
    const std::optional<DistanceField> got = readBack(folder.path(), made().data);
    ASSERT_TRUE(got.has_value());
    EXPECT_EQ(got->stateHash(), made().field.stateHash());
    EXPECT_EQ(got->settings().bandInMm, made().field.settings().bandInMm);
    std::mt19937_64 g(test::seed());
    for (int i = 0; i < 300; ++i) {
        const core::Vec3 p = test::randomDirection(g) * test::uniform(g, 0.0, 2.0);
        EXPECT_EQ(got->tissueAt(p), made().field.tissueAt(p));
    }
}

TEST(FieldCache, TheSameFieldIsTheSameBytes) {
    const std::vector<std::byte> again = encodeField(made().field, kKey);
    EXPECT_EQ(again, made().data);
    EXPECT_EQ(again.capacity(), again.size()) << "of a large tooth each spare byte counts";
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
    for (std::size_t at = 0; at < kHeaderBytes; ++at)
        flip(at, static_cast<int>(g() % 8));
    for (int i = 0; i < 150; ++i)
        flip(g() % data.size(), static_cast<int>(g() % 8));
    EXPECT_TRUE(readBack(folder.path(), data).has_value());
}

/// The bytes as somebody would leave them who forges a file: with all sums right.
std::vector<std::byte> summed(std::vector<std::byte> data) {
    const auto number = [&data](std::size_t at) {
        std::uint64_t n = 0;
        std::memcpy(&n, &data[at], 8);
        return n;
    };
    const std::uint64_t dense = number(kDenseAt), stored = number(kStoredAt), mixed = number(kMixedAt);
    core::Hasher payload;
    std::size_t at = kHeaderBytes;
    for (const std::uint64_t bytes : {4 * dense, 4 * dense, dense, stored, 729 * mixed, 4 * 729 * stored}) {
        if (bytes > data.size() - at) break;  // sizes that lie: no sum could be right
        payload.add(hashOf(std::span(data).subspan(at, bytes)));
        at += bytes;
    }
    const std::uint64_t sum = payload.value();
    std::memcpy(&data[kPayloadHashAt], &sum, 8);
    core::Hasher header;
    header.add(std::span(data).first(kHeaderBytes - 8));
    const std::uint64_t head = header.value();
    std::memcpy(&data[kHeaderBytes - 8], &head, 8);
    return data;
}

template <class T>
std::vector<std::byte> with(std::size_t at, T value) {
    std::vector<std::byte> data = made().data;
    std::memcpy(&data[at], &value, sizeof value);
    return summed(std::move(data));
}

TEST(FieldCache, SumsThatAreRightProveNothing) {
    const test::TemporaryFolder folder;
    ASSERT_EQ(summed(made().data), made().data) << "this test knows the format";
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    constexpr float kNanF = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
    const std::size_t dense = made().field.view().bricks[0] * made().field.view().bricks[1] *
                              static_cast<std::size_t>(made().field.view().bricks[2]);
    const std::size_t stored = made().field.brickCount();
    const std::size_t index = kHeaderBytes, coarse = index + 4 * dense, coarseTissue = coarse + 4 * dense,
                      tissue = coarseTissue + dense, values = made().data.size() - 4 * 729 * stored;
    std::size_t storedBrick = 0, deepBrick = 0;
    for (std::size_t i = 0; i < dense; ++i) {
        if (made().field.view().brickIndex[i] >= 0) storedBrick = i;
        if (made().field.view().coarse[i] < 0.0f) deepBrick = i;
    }
    const std::map<std::string, std::vector<std::byte>> forged = {
        {"another voxel", with(kSettingsAt, 0.05)},
        {"a voxel of nothing", with(kSettingsAt, 0.0)},
        {"a voxel that is no number", with(kSettingsAt, kNan)},
        {"another band outside", with(kSettingsAt + 8, 7.0)},
        {"a band inside that is no number", with(kSettingsAt + 16, kNan)},
        {"an origin that is no number", with(kOriginAt, kNan)},
        {"an origin elsewhere", with(kOriginAt + 16, 1e30)},
        {"more bricks along x", with(kBricksAt, std::int32_t{1} << 30)},
        {"bricks below zero", with(kBricksAt + 4, std::int32_t{-1})},
        {"an index beyond all bricks", with(index + 4 * storedBrick, static_cast<std::int32_t>(stored))},
        {"an index far below", with(index + 4 * storedBrick, std::numeric_limits<std::int32_t>::min())},
        {"one brick twice", with(index + 4 * storedBrick, std::int32_t{0})},
        {"a brick left out", with(index + 4 * storedBrick, std::int32_t{-1})},
        {"a centre that is no number", with(coarse, kNanF)},
        {"a centre far off", with(coarse, 1e30f)},
        {"a centre inside that is outside", with(coarse, -1.0f)},
        {"no tissue inside", with(coarseTissue + deepBrick, std::uint8_t{0})},
        {"a tissue that the tooth has not", with(coarseTissue + deepBrick, std::uint8_t{7})},
        {"a tissue that there is not", with(tissue, std::uint8_t{200})},
        {"a mixed brick too many", with(tissue, std::uint8_t{255})},
        {"a value that is no number", with(values + 4 * 100, kNanF)},
        {"a value without end", with(values + 4 * (729 * (stored - 1) + 3), kInf)},
        {"a value far off", with(values, -1e20f)},
        {"a value within the band, too far from its neighbours", with(values + 4 * 364, 0.9f)},
    };
    for (const auto& [what, data] : forged)
        EXPECT_FALSE(readBack(folder.path(), data).has_value()) << what;
    // All values a little off: each by itself might be true, the surface says otherwise.
    std::vector<std::byte> shifted = made().data;
    for (std::size_t at = values; at < shifted.size(); at += 4) {
        float value = 0.0f;
        std::memcpy(&value, &shifted[at], 4);
        value += value < 0.0f ? 1e-3f : -1e-3f;
        std::memcpy(&shifted[at], &value, 4);
    }
    EXPECT_FALSE(readBack(folder.path(), summed(shifted)).has_value());
    EXPECT_TRUE(readBack(folder.path(), made().data).has_value());
}

TEST(FieldCache, ForgedAtRandomItGivesTheFieldOrNothing) {
    const test::TemporaryFolder folder;
    std::mt19937_64 g(test::seed());
    int believed = 0;
    for (int i = 0; i < 400; ++i) {
        std::vector<std::byte> data = made().data;
        const std::size_t from = g() % 3 == 0 ? 16 : kHeaderBytes, to = from == 16 ? kHeaderBytes - 16 : data.size();
        for (std::uint64_t k = 1 + g() % 4; k > 0; --k) {
            const std::size_t at = from + g() % (to - from - 8);
            const std::uint64_t anything = g();
            std::memcpy(&data[at], &anything, 1 + g() % 8);
        }
        if (const auto got = readBack(folder.path(), summed(data))) {
            ++believed;  // a tissue in place of another, or a value's last bits: still a field that nothing trips over
            for (int n = 0; n < 50; ++n) {
                const core::Vec3 p = test::randomDirection(g) * test::uniform(g, 0.0, 2.0);
                EXPECT_NEAR(got->distance(p), made().field.distance(p), 1.0);
                EXPECT_TRUE(got->tissueAt(p) <= cases::Tissue::dentine);
            }
        }
    }
    EXPECT_LT(believed, 200);
}

TEST(FieldCache, LyingSizesAllocateNothing) {
    // Counts of 2^60 with a header checksum that agrees: the file's own length says no before room is made.
    const test::TemporaryFolder folder;
    for (const std::size_t at : {kDenseAt, kStoredAt, kMixedAt})
        for (const std::uint64_t lie :
             {std::uint64_t{1} << 60, std::uint64_t{1} << 33, ~std::uint64_t{0}, std::uint64_t{0}})
            EXPECT_FALSE(readBack(folder.path(), with(at, lie)).has_value()) << at << ' ' << lie;
}

TEST(FieldCache, OnlyWhatThisUserAloneWroteIsRead) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "f", elsewhere = folder.path() / "elsewhere";
    ASSERT_TRUE(readBack(folder.path(), made().data).has_value());
    for (const fs::perms who : {fs::perms::group_write, fs::perms::others_write}) {
        fs::permissions(file, who, fs::perm_options::add);
        EXPECT_FALSE(read(file).has_value());
        // Made anew, it is ours alone again.
        EXPECT_EQ(writeFieldFile({file}, made().data), file);
        EXPECT_TRUE(read(file).has_value());
    }
    write(elsewhere, made().data);
    fs::remove(file);
    fs::create_symlink(elsewhere, file);
    EXPECT_FALSE(read(file).has_value()) << "a link";
    EXPECT_EQ(writeFieldFile({file, folder.path() / "own" / "f"}, made().data), folder.path() / "own" / "f");
    EXPECT_TRUE(fs::is_symlink(file)) << "what another put there stays";
    fs::create_directory_symlink(folder.path() / "own", folder.path() / "link");
    EXPECT_TRUE(writeFieldFile({folder.path() / "link" / "f"}, made().data).empty());
    if (::geteuid() != 0) GTEST_SKIP() << "another user's file needs the right to make one";
    fs::remove(file);
    write(file, made().data);
    ASSERT_EQ(::chown(file.c_str(), 65534, 65534), 0);
    EXPECT_FALSE(read(file).has_value());
    EXPECT_EQ(writeFieldFile({file, folder.path() / "own" / "g"}, made().data), folder.path() / "own" / "g");
}

TEST(FieldCache, WhatIsNoFileOfOursIsIgnored) {
    const test::TemporaryFolder folder;
    EXPECT_FALSE(read(folder.path() / "missing").has_value());
    EXPECT_FALSE(read(folder.path()).has_value());
    EXPECT_FALSE(readBack(folder.path(), std::vector<std::byte>(10000, std::byte{0x55})).has_value());
    EXPECT_FALSE(readBack(folder.path(), std::span<const std::byte>{}).has_value());
}

TEST(FieldCache, KeyDependsOnEverythingThatMatters) {
    cases::Case a;
    a.outer = made().mesh;
    a.parts.push_back({"enamel", cases::Tissue::enamel, 10, made().mesh});
    a.parts.push_back({"dentine", cases::Tissue::dentine, 20, made().core});
    const FieldSettings settings;
    const std::uint64_t key = cacheKey(a, settings);
    EXPECT_EQ(cacheKey(a, settings), key);
    cases::Case b = a;
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
    b.parts[1].tissue = cases::Tissue::pulp;
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
                (read(places[0]).has_value() ? whole : broken)++;
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
}  // namespace handpiece::field::field_cache_test
