// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/tooth/field_cache.h"

#include <fmt/format.h>

#include <bit>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <system_error>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"

namespace handpiece::tooth {
namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kByteOrder = 0x01020304;
constexpr char kMagic[8] = {'H', 'P', 'F', 'I', 'E', 'L', 'D', '\n'};
constexpr std::uint8_t kMixedTissues = 255;

/// The first bytes of a file; everything in the writer's byte order, which the reader checks.
struct Header {
    char magic[8];
    std::uint32_t version, byteOrder;
    std::uint64_t key;
    double voxelMm, bandOutMm, bandInMm;
    double originMm[3];
    std::int32_t bricks[3];
    std::uint32_t reserved;
    std::uint64_t denseBricks, storedBricks, mixedBricks, treeNodes, triangles;
    std::uint64_t payloadHash, headerHash;
};
static_assert(sizeof(Header) == 144 && std::is_trivially_copyable_v<Header>);

std::uint64_t headerHashOf(const Header& header) {
    core::Hasher hasher;
    hasher.add(std::as_bytes(std::span(&header, 1)).first(offsetof(Header, headerHash)));
    return hasher.value();
}

struct CloseFile {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};

}  // namespace

/// The one class besides the builder that sees a field's arrays.
class FieldStorage {
  public:
    /// The payload's sections in file order.
    struct Sections {
        ToothField field;
        std::vector<std::uint8_t> tissueOfBrick,
            mixedTissues;  // one tissue a stored brick, or all nodes of the mixed ones
        geometry::TriangleTree::Storage tree;

        template <class F>
        void visit(F&& f) {
            f(std::as_writable_bytes(std::span(field.brickIndex_)));
            f(std::as_writable_bytes(std::span(field.coarse_)));
            f(std::as_writable_bytes(std::span(field.coarseTissue_)));
            f(std::as_writable_bytes(std::span(tissueOfBrick)));
            f(std::as_writable_bytes(std::span(mixedTissues)));
            f(std::as_writable_bytes(std::span(field.values_)));
            f(std::as_writable_bytes(std::span(tree.nodes)));
            f(std::as_writable_bytes(std::span(tree.order)));
        }
    };

    static Header headerOf(const ToothField& field) {
        Header header{};
        std::memcpy(header.magic, kMagic, sizeof kMagic);
        header.version = kVersion;
        header.byteOrder = kByteOrder;
        header.voxelMm = field.settings_.voxelMm;
        header.bandOutMm = field.settings_.bandOutMm;
        header.bandInMm = field.settings_.bandInMm;
        for (int k = 0; k < 3; ++k) {
            header.originMm[k] = field.originMm_[k];
            header.bricks[k] = field.bricks_[k];
        }
        header.denseBricks = field.coarse_.size();
        header.storedBricks = field.brickCount();
        return header;
    }

    static void packTissues(Sections& s) {
        const std::vector<std::uint8_t>& all = s.field.tissue_;
        for (std::size_t i = 0; i < s.field.brickCount(); ++i) {
            const auto first = all.begin() + static_cast<std::ptrdiff_t>(i * kBrickValues);
            const bool uniform = std::all_of(first, first + kBrickValues, [&](std::uint8_t t) { return t == *first; });
            s.tissueOfBrick.push_back(uniform ? *first : kMixedTissues);
            if (!uniform) s.mixedTissues.insert(s.mixedTissues.end(), first, first + kBrickValues);
        }
    }

    static bool unpackTissues(Sections& s) {
        s.field.tissue_.resize(s.tissueOfBrick.size() * kBrickValues);
        std::size_t mixed = 0;
        for (std::size_t i = 0; i < s.tissueOfBrick.size(); ++i) {
            std::uint8_t* out = &s.field.tissue_[i * kBrickValues];
            if (s.tissueOfBrick[i] == kMixedTissues) {
                if ((mixed + 1) * kBrickValues > s.mixedTissues.size()) return false;
                std::copy_n(&s.mixedTissues[mixed++ * kBrickValues], kBrickValues, out);
            } else {
                std::fill_n(out, kBrickValues, s.tissueOfBrick[i]);
            }
        }
        const auto known = [](const std::vector<std::uint8_t>& tissues) {
            return std::all_of(tissues.begin(), tissues.end(), [](std::uint8_t t) { return t < kTissueCount; });
        };
        return mixed * kBrickValues == s.mixedTissues.size() && known(s.field.tissue_) && known(s.field.coarseTissue_);
    }

    /// Room for what the header tells; only after its sizes are proven.
    static Sections room(const Header& header) {
        Sections s;
        s.field.settings_ = {header.voxelMm, header.bandOutMm, header.bandInMm};
        for (int k = 0; k < 3; ++k) {
            s.field.originMm_[k] = header.originMm[k];
            s.field.bricks_[k] = header.bricks[k];
        }
        s.field.brickIndex_.resize(header.denseBricks);
        s.field.coarse_.resize(header.denseBricks);
        s.field.coarseTissue_.resize(header.denseBricks);
        s.tissueOfBrick.resize(header.storedBricks);
        s.mixedTissues.resize(header.mixedBricks * kBrickValues);
        s.field.values_.resize(header.storedBricks * kBrickValues);
        s.tree.nodes.resize(header.treeNodes);
        s.tree.order.resize(header.triangles);
        return s;
    }

    /// Bytes of the payload, or nothing when the counts cannot be right.
    static std::optional<std::uint64_t> payloadBytes(const Header& h) {
        constexpr std::uint64_t kMost = std::uint64_t{1} << 32;
        std::uint64_t dense = 1;
        for (const std::int32_t n : h.bricks) {
            if (n < 1 || static_cast<std::uint64_t>(n) > kMost / dense) return std::nullopt;
            dense *= static_cast<std::uint64_t>(n);
        }
        if (dense != h.denseBricks || h.storedBricks > dense || h.mixedBricks > h.storedBricks || h.treeNodes > kMost ||
            h.triangles > kMost)
            return std::nullopt;
        return dense * 9 + h.storedBricks * (1 + 4 * kBrickValues) + h.mixedBricks * kBrickValues +
               h.treeNodes * sizeof(geometry::TreeNode) + h.triangles * 4;
    }

    static bool indicesAreSound(const Sections& s) {
        const auto stored = static_cast<std::int64_t>(s.tissueOfBrick.size());
        return std::all_of(s.field.brickIndex_.begin(), s.field.brickIndex_.end(),
                           [&](std::int32_t i) { return i >= -1 && i < stored; });
    }
};

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

std::uint64_t cacheKey(const Case& toothCase, const FieldSettings& settings) {
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
    for (const Part& part : toothCase.parts) {
        hasher.add(part.tissue);
        hasher.add(part.priority);
        addMesh(part.mesh);
    }
    return hasher.value();
}

std::vector<std::byte> encodeField(const ToothField& field, const geometry::TriangleTree& tree, std::uint64_t key) {
    FieldStorage::Sections sections{field, {}, {}, tree.storage()};
    FieldStorage::packTissues(sections);
    Header header = FieldStorage::headerOf(field);
    header.key = key;
    header.mixedBricks = sections.mixedTissues.size() / kBrickValues;
    header.treeNodes = sections.tree.nodes.size();
    header.triangles = sections.tree.order.size();
    std::vector<std::byte> data(sizeof header);
    core::Hasher hasher;
    sections.visit([&](std::span<const std::byte> section) {
        hasher.add(hashOf(section));
        data.insert(data.end(), section.begin(), section.end());
    });
    header.payloadHash = hasher.value();
    header.headerHash = headerHashOf(header);
    std::memcpy(data.data(), &header, sizeof header);
    return data;
}

std::optional<CachedField> readFieldFile(const fs::path& path, std::uint64_t key) {
    std::error_code ec;
    if (!fs::is_regular_file(path, ec)) return std::nullopt;
    const std::uint64_t size = fs::file_size(path, ec);
    if (ec || size < sizeof(Header)) return std::nullopt;
    const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.string().c_str(), "rb"));
    if (!file) return std::nullopt;
    std::setvbuf(file.get(), nullptr, _IONBF, 0);  // a few large reads, straight into place
    Header header;
    if (std::fread(&header, sizeof header, 1, file.get()) != 1) return std::nullopt;
    if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0 || header.version != kVersion ||
        header.byteOrder != kByteOrder || header.key != key || header.headerHash != headerHashOf(header))
        return std::nullopt;
    const std::optional<std::uint64_t> payload = FieldStorage::payloadBytes(header);
    if (!payload || size != sizeof(Header) + *payload) return std::nullopt;

    FieldStorage::Sections sections = FieldStorage::room(header);
    core::Hasher hasher;
    bool whole = true;
    sections.visit([&](std::span<std::byte> section) {
        whole = whole && std::fread(section.data(), 1, section.size(), file.get()) == section.size();
        if (whole) hasher.add(hashOf(section));
    });
    if (!whole || hasher.value() != header.payloadHash) return std::nullopt;
    if (!FieldStorage::unpackTissues(sections) || !FieldStorage::indicesAreSound(sections)) return std::nullopt;
    return CachedField{std::move(sections.field), std::move(sections.tree)};
}

std::vector<fs::path> cachePlaces(const Case& toothCase, const fs::path& cacheFolder, std::uint64_t key) {
    const std::string name = fmt::format("{:016x}.field", key);
    if (!cacheFolder.empty()) return {cacheFolder / name};
    std::vector<fs::path> places;
    std::error_code ec;
    if (!toothCase.source.empty() && fs::is_directory(toothCase.source, ec))
        places.push_back(toothCase.source / ".handpiece-cache" / name);
    const char* cache = std::getenv("XDG_CACHE_HOME");
    const char* home = std::getenv("HOME");
    if (cache != nullptr && fs::path(cache).is_absolute()) {
        places.push_back(fs::path(cache) / "handpiece" / name);
    } else if (home != nullptr && fs::path(home).is_absolute()) {
        places.push_back(fs::path(home) / ".cache" / "handpiece" / name);
    }
    return places;
}

fs::path writeFieldFile(const std::vector<fs::path>& places, const std::vector<std::byte>& data) {
    for (const fs::path& place : places) {
        std::error_code ec;
        fs::create_directories(place.parent_path(), ec);
        if (ec) continue;
        try {
            core::writeFile(place, data);
            return place;
        } catch (const core::Error&) {
            // Read-only or full: the next place may do, and without a cache the tooth only opens more slowly.
            continue;
        }
    }
    return {};
}

}  // namespace handpiece::tooth
