// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/field_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <span>
#include <system_error>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/field_builder.h"
#include "handpiece/model/field/stored_tissues.h"

namespace handpiece::field {
namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kByteOrder = 0x01020304;
constexpr char kMagic[8] = {'H', 'P', 'F', 'I', 'E', 'L', 'D', '\n'};

/// The first bytes of a file; everything in the writer's byte order, which the reader checks.
struct Header {
    char magic[8];
    std::uint32_t version, byteOrder;
    std::uint64_t key;
    double voxelMm, bandOutMm, bandInMm;
    double originMm[3];
    std::int32_t bricks[3];
    std::uint32_t reserved;
    std::uint64_t denseBricks, storedBricks, mixedBricks;
    std::uint64_t payloadHash, headerHash;
};
static_assert(sizeof(Header) == 128 && std::is_trivially_copyable_v<Header>);

std::uint64_t headerHashOf(const Header& header) {
    core::Hasher hasher;
    hasher.add(std::as_bytes(std::span(&header, 1)).first(offsetof(Header, headerHash)));
    return hasher.value();
}

/// Some places of a field, other ones each time: whoever makes a false file cannot know which are looked at.
constexpr std::size_t kLookedAt = 1024;
/// A stored distance is exact to float.
constexpr double kRoundingMm = 1e-5;

}  // namespace

/// A field and the sections of its file.
class FieldFile {
  public:
    /// The payload's sections in file order.
    struct Sections : StoredTissues {
        FieldStorage field;

        template <class F>
        void visit(F&& f) {
            f(std::as_writable_bytes(std::span(field.brickIndex)));
            f(std::as_writable_bytes(std::span(field.coarse)));
            f(std::as_writable_bytes(std::span(coarseTissue)));
            f(std::as_writable_bytes(std::span(tissueOfBrick)));
            f(std::as_writable_bytes(std::span(mixedTissues)));
            f(std::as_writable_bytes(std::span(field.values)));
        }
    };

    static Header headerOf(const FieldStorage& field) {
        Header header{};
        std::memcpy(header.magic, kMagic, sizeof kMagic);
        header.version = kVersion;
        header.byteOrder = kByteOrder;
        header.voxelMm = field.settings.voxelMm;
        header.bandOutMm = field.settings.bandOutMm;
        header.bandInMm = field.settings.bandInMm;
        for (int k = 0; k < 3; ++k) {
            header.originMm[k] = field.originMm[k];
            header.bricks[k] = field.bricks[k];
        }
        header.denseBricks = field.coarse.size();
        header.storedBricks = field.brickCount();
        return header;
    }

    /// What Sections::visit would visit, of a field that stays where it is.
    static std::array<std::span<const std::byte>, 6> payloadOf(const FieldStorage& field, const Sections& s) {
        return {std::as_bytes(std::span(field.brickIndex)), std::as_bytes(std::span(field.coarse)),
                std::as_bytes(std::span(s.coarseTissue)),   std::as_bytes(std::span(s.tissueOfBrick)),
                std::as_bytes(std::span(s.mixedTissues)),   std::as_bytes(std::span(field.values))};
    }

    /// The empty grid of the asked field with room for what the header tells; only after the file's length agrees.
    static Sections room(const Header& header, const FieldBuilder& empty) {
        Sections s;
        s.field = FieldBuilder(empty).finish().storage();
        s.coarseTissue.resize(header.denseBricks);
        s.tissueOfBrick.resize(header.storedBricks);
        s.mixedTissues.resize(header.mixedBricks * kBrickValues);
        s.field.values.resize(header.storedBricks * kBrickValues);
        return s;
    }

    /// Bytes of the payload, or nothing when the header is not that of the asked grid or the counts cannot be right.
    static std::optional<std::uint64_t> payloadBytes(const Header& h, const FieldBuilder& empty) {
        const Header asked = headerOf(FieldBuilder(empty).finish().storage());
        const bool sameGrid = h.voxelMm == asked.voxelMm && h.bandOutMm == asked.bandOutMm &&
                              h.bandInMm == asked.bandInMm && std::equal(h.originMm, h.originMm + 3, asked.originMm) &&
                              std::equal(h.bricks, h.bricks + 3, asked.bricks);
        if (!sameGrid || h.denseBricks != asked.denseBricks || h.storedBricks > h.denseBricks ||
            h.mixedBricks > h.storedBricks)
            return std::nullopt;
        return h.denseBricks * 9 + h.storedBricks * (1 + 4 * kBrickValues) + h.mixedBricks * kBrickValues;
    }

    /// Bricks are stored where and only where the band passes, one after the other; outside there is no tissue.
    static bool bricksAreSound(const Sections& s, const FieldBuilder& empty, const TissueSet& known) {
        const FieldStorage& field = s.field;
        const double farthest = core::Vec3(field.bricks[0], field.bricks[1], field.bricks[2]).norm() * empty.brickMm();
        std::int32_t stored = 0;
        for (std::size_t i = 0; i < field.coarse.size(); ++i) {
            const float centre = field.coarse[i];
            if (!(std::abs(centre) <= farthest)) return false;
            if (field.brickIndex[i] != (empty.isStored(centre) ? stored++ : -1)) return false;
            const std::uint8_t tissue = s.coarseTissue[i];
            if (centre < 0.0f ? !known.has(tissue) : tissue != static_cast<std::uint8_t>(cases::Tissue::none))
                return false;
        }
        return static_cast<std::size_t>(stored) == field.brickCount();
    }

    /// No distance differs from that of its brick's centre by more than the way between them.
    static bool valuesAreSound(const FieldStorage& field) {
        std::array<float, kBrickValues> wayMm;
        for (int z = 0, at = 0; z < kBrickNodes; ++z)
            for (int y = 0; y < kBrickNodes; ++y)
                for (int x = 0; x < kBrickNodes; ++x, ++at) {
                    constexpr int kHalf = kBrickCells / 2;
                    const double way = core::Vec3(x - kHalf, y - kHalf, z - kHalf).norm() * field.settings.voxelMm;
                    wayMm[static_cast<std::size_t>(at)] = static_cast<float>(way + kRoundingMm);
                }
        std::atomic<bool> sound{true};
        core::parallelFor(field.brickIndex.size(), 64, [&](std::size_t begin, std::size_t end) {
            bool good = true;
            for (std::size_t i = begin; i < end; ++i) {
                if (field.brickIndex[i] < 0) continue;
                const float* values = &field.values[static_cast<std::size_t>(field.brickIndex[i]) * kBrickValues];
                const float centre = std::abs(field.coarse[i]);
                for (std::size_t node = 0; node < kBrickValues; ++node)
                    good &= std::abs(std::abs(values[node]) - centre) <= wayMm[node];
            }
            if (!good) sound = false;
        });
        return sound;
    }

    /// As the surface itself has it, at some places: each time other ones.
    static bool isOf(const geometry::TriangleTree& tree, const FieldStorage& field, const FieldBuilder& empty) {
        std::mt19937_64 dice(std::random_device{}());
        const auto agrees = [&](const core::Vec3& p, float told) {
            return std::abs(tree.signedDistance(p) - static_cast<double>(told)) <= kRoundingMm;
        };
        for (std::size_t i = 0; i < kLookedAt; ++i) {
            const std::size_t dense = dice() % field.coarse.size();
            if (!agrees(empty.centreMm(dense), field.coarse[dense])) return false;
        }
        for (std::size_t i = 0, looked = 0; i < 64 * kLookedAt && looked < kLookedAt; ++i) {
            const std::size_t dense = dice() % field.coarse.size();
            if (field.brickIndex[dense] < 0) continue;
            ++looked;
            const auto node = static_cast<int>(dice() % kBrickValues);
            const auto [x, y, z] = empty.brickAt(dense);
            const core::Vec3 p = empty.nodeMm(kBrickCells * std::int64_t{x} + node % kBrickNodes,
                                              kBrickCells * std::int64_t{y} + node / kBrickNodes % kBrickNodes,
                                              kBrickCells * std::int64_t{z} + node / (kBrickNodes * kBrickNodes));
            if (!agrees(p, field.values[static_cast<std::size_t>(field.brickIndex[dense]) * kBrickValues +
                                        static_cast<std::size_t>(node)]))
                return false;
        }
        return true;
    }
};

TissueSet::TissueSet(std::initializer_list<cases::Tissue> tissues) {
    for (const cases::Tissue t : tissues)
        bits_ |= 1u << static_cast<unsigned>(t);
}

TissueSet::TissueSet(const cases::Case& toothCase) {
    for (const cases::Part& part : toothCase.parts)
        bits_ |= 1u << static_cast<unsigned>(part.tissue);
    if (toothCase.parts.empty()) bits_ = 1u << static_cast<unsigned>(cases::Tissue::enamel);
}

bool TissueSet::hasAll(std::span<const std::uint8_t> tissues) const {
    return std::all_of(tissues.begin(), tissues.end(), [this](std::uint8_t t) { return has(t); });
}

std::uint64_t hashOf(std::span<const std::byte> data) {
    constexpr std::size_t kPiece = 1 << 20;
    std::vector<std::uint64_t> pieces((data.size() + kPiece - 1) / kPiece);
    core::parallelFor(pieces.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            core::Hasher hasher;
            hasher.add(data.subspan(i * kPiece, std::min(kPiece, data.size() - i * kPiece)));
            pieces[i] = hasher.value();
        }
    });
    core::Hasher hasher;
    hasher.add(std::uint64_t{data.size()});
    for (const std::uint64_t piece : pieces)
        hasher.add(piece);
    return hasher.value();
}

std::uint64_t cacheKey(const cases::Case& toothCase, const FieldSettings& settings) {
    core::Hasher hasher;
    hasher.add(std::string_view("handpiece field"));
    hasher.add(kVersion);
    hasher.add(std::endian::native == std::endian::little);
    hasher.add(settings.voxelMm);
    hasher.add(settings.bandOutMm);
    hasher.add(settings.bandInMm);
    const auto addMesh = [&](const geometry::TriangleMesh& mesh) {
        hasher.add(hashOf(std::as_bytes(std::span(mesh.vertices))));
        hasher.add(hashOf(std::as_bytes(std::span(mesh.triangles))));
    };
    addMesh(toothCase.outer);
    for (const cases::Part& part : toothCase.parts) {
        hasher.add(part.tissue);
        hasher.add(part.priority);
        addMesh(part.mesh);
    }
    return hasher.value();
}

std::vector<std::byte> encodeField(const DistanceField& field, std::uint64_t key) {
    // A field is most of a tooth's memory: not copied, and the bytes in one piece from the start.
    FieldFile::Sections sections;
    static_cast<StoredTissues&>(sections) = StoredTissues::of(field.storage());
    Header header = FieldFile::headerOf(field.storage());
    header.key = key;
    header.mixedBricks = sections.mixedTissues.size() / kBrickValues;
    const auto payload = FieldFile::payloadOf(field.storage(), sections);
    std::size_t bytes = sizeof header;
    for (const std::span<const std::byte> section : payload)
        bytes += section.size();
    std::vector<std::byte> data(sizeof header);
    data.reserve(bytes);
    core::Hasher hasher;
    for (const std::span<const std::byte> section : payload) {
        hasher.add(hashOf(section));
        data.insert(data.end(), section.begin(), section.end());
    }
    header.payloadHash = hasher.value();
    header.headerHash = headerHashOf(header);
    std::memcpy(data.data(), &header, sizeof header);
    return data;
}

std::optional<DistanceField> readFieldFile(const fs::path& path, std::uint64_t key, const geometry::TriangleTree& tree,
                                           const FieldSettings& settings, const TissueSet& tissues) {
    const core::FileStream file = core::openOwnFile(path);
    if (!file) return std::nullopt;
    std::setvbuf(file.get(), nullptr, _IONBF, 0);  // a few large reads, straight into place
    Header header;
    if (std::fread(&header, sizeof header, 1, file.get()) != 1) return std::nullopt;
    if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0 || header.version != kVersion ||
        header.byteOrder != kByteOrder || header.key != key || header.headerHash != headerHashOf(header))
        return std::nullopt;
    const FieldBuilder empty = FieldBuilder::around(tree.bounds(), settings);
    const std::optional<std::uint64_t> payload = FieldFile::payloadBytes(header, empty);
    if (!payload || core::sizeOf(file) != sizeof(Header) + *payload) return std::nullopt;

    FieldFile::Sections sections = FieldFile::room(header, empty);
    core::Hasher hasher;
    bool whole = true;
    sections.visit([&](std::span<std::byte> section) {
        whole = whole && std::fread(section.data(), 1, section.size(), file.get()) == section.size();
        if (whole) hasher.add(hashOf(section));
    });
    const FieldStorage& field = sections.field;
    const bool believed = whole && hasher.value() == header.payloadHash &&
                          FieldFile::bricksAreSound(sections, empty, tissues) && FieldFile::valuesAreSound(field) &&
                          sections.putInto(sections.field, tissues) && FieldFile::isOf(tree, field, empty);
    if (!believed) return std::nullopt;
    return DistanceField(std::move(sections.field));
}

fs::path userCacheFolder() {
    const char* cache = std::getenv("XDG_CACHE_HOME");
    const char* home = std::getenv("HOME");
    if (cache != nullptr && fs::path(cache).is_absolute()) return fs::path(cache) / "handpiece";
    if (home != nullptr && fs::path(home).is_absolute()) return fs::path(home) / ".cache" / "handpiece";
    return {};
}

std::vector<fs::path> cachePlaces(const cases::Case& toothCase, const fs::path& cacheFolder, std::uint64_t key) {
    const std::string name = fmt::format("{:016x}.field", key);
    if (!cacheFolder.empty()) return {cacheFolder / name};
    std::vector<fs::path> places;
    std::error_code ec;
    if (!toothCase.source.empty() && fs::is_directory(toothCase.source, ec))
        places.push_back(toothCase.source / ".handpiece-cache" / name);
    if (const fs::path user = userCacheFolder(); !user.empty()) places.push_back(user / name);
    return places;
}

fs::path writeFieldFile(const std::vector<fs::path>& places, const std::vector<std::byte>& data) {
    for (const fs::path& place : places) {
        std::error_code ec;
        const fs::path folder = place.parent_path();
        fs::create_directories(folder, ec);
        // What another put there stays as it is, and a folder that is a link leads nobody knows where.
        const bool isTaken = fs::exists(fs::symlink_status(place, ec)) && !core::isOurs(place);
        if (!fs::is_directory(folder, ec) || fs::is_symlink(fs::symlink_status(folder, ec)) || isTaken) continue;
        // A file of ours that others could write to would hand its mode on.
        if (!core::openOwnFile(place)) fs::remove(place, ec);
        try {
            core::writeFile(place, data, {.ownerOnly = true, .lasting = false});
            return place;
        } catch (const core::Error&) {
            // Read-only or full: the next place may do, and without a cache the tooth only opens more slowly.
            continue;
        }
    }
    return {};
}

}  // namespace handpiece::field
