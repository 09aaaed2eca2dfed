// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/tissue_cache.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/prepared/packed_bytes.h"

namespace handpiece::field {
namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kByteOrder = 0x01020304;
constexpr char kMagic[8] = {'H', 'P', 'T', 'I', 'S', 'S', 'U', '\n'};

/// The first bytes of a file; everything in the writer's byte order, which the reader checks.
struct Header {
    char magic[8];
    std::uint32_t version, byteOrder;
    std::uint64_t key;
    std::uint64_t bricks, mixedBricks, layers;
    std::uint64_t payloadHash, headerHash;
};
static_assert(sizeof(Header) == 64 && std::is_trivially_copyable_v<Header>);

std::uint64_t headerHashOf(const Header& header) {
    core::Hasher hasher;
    hasher.add(std::as_bytes(std::span(&header, 1)).first(offsetof(Header, headerHash)));
    return hasher.value();
}

}  // namespace

/// The one class besides the map itself that sees its arrays.
class TissueStorage {
  public:
    /// The payload's sections in file order.
    struct Sections {
        std::vector<std::uint8_t> uniform;
        std::vector<std::uint32_t> mixed;  ///< dense index of each mixed brick, rising
        std::vector<std::uint8_t> rest, layerCount, nodes, layerTissue;
        std::vector<std::int8_t> values;

        explicit Sections(const Header& h)
            : uniform(h.bricks),
              mixed(h.mixedBricks),
              rest(h.mixedBricks),
              layerCount(h.mixedBricks),
              nodes(h.mixedBricks * kBrickValues),
              layerTissue(h.layers),
              values(h.layers * kBrickValues) {}

        template <class F>
        void visit(F&& f) {
            f(std::as_writable_bytes(std::span(mixed)));
            f(std::as_writable_bytes(std::span(uniform)));
            f(std::as_writable_bytes(std::span(rest)));
            f(std::as_writable_bytes(std::span(layerCount)));
            f(std::as_writable_bytes(std::span(layerTissue)));
            f(std::as_writable_bytes(std::span(nodes)));
            f(std::as_writable_bytes(std::span(values)));
        }
    };

    static Header headerOf(const TissueMap& map) {
        Header header{};
        std::memcpy(header.magic, kMagic, sizeof kMagic);
        header.version = kVersion;
        header.byteOrder = kByteOrder;
        header.bricks = map.nodes_->start.size();
        header.mixedBricks = map.ranges_.size();
        header.layers = map.layers_.size();
        return header;
    }

    static Sections sectionsOf(const TissueMap& map) {
        Sections s(headerOf(map));
        for (std::size_t i = 0, at = 0; i < s.uniform.size(); ++i) {
            s.uniform[i] = static_cast<std::uint8_t>(map.ofBrick(static_cast<std::uint32_t>(i)));
            if (map.nodes_->isMixed(i)) s.mixed[at++] = static_cast<std::uint32_t>(i);
        }
        for (std::size_t i = 0; i < map.ranges_.size(); ++i) {
            s.rest[i] = static_cast<std::uint8_t>(map.ranges_[i].rest);
            s.layerCount[i] = static_cast<std::uint8_t>(map.ranges_[i].count);
        }
        s.nodes.assign(map.nodes_->nodes.begin() + BrickTissues::kShared, map.nodes_->nodes.end());
        for (std::size_t i = 0; i < map.layers_.size(); ++i)
            s.layerTissue[i] = static_cast<std::uint8_t>(map.layers_[i].tissue);
        s.values = map.values_;
        return s;
    }

    static std::optional<TissueMap> mapOf(Sections&& s, const DistanceField& grid, const TissueSet& known) {
        if (!known.hasAll(s.rest) || !known.hasAll(s.nodes) || !known.hasAll(s.layerTissue)) return std::nullopt;
        TissueMap map(grid);
        auto nodes = std::make_shared<BrickTissues>(s.uniform.size());
        nodes->nodes.reserve(BrickTissues::kShared + s.nodes.size());
        for (std::size_t i = 0; i < s.uniform.size(); ++i) {
            if (s.uniform[i] != 0 && !known.has(s.uniform[i])) return std::nullopt;
            nodes->setUniform(i, s.uniform[i]);
        }
        map.values_ = std::move(s.values);
        for (std::size_t i = 0; i < s.mixed.size(); ++i) {
            if (s.mixed[i] >= s.uniform.size() || (i > 0 && s.mixed[i] <= s.mixed[i - 1]) || s.uniform[s.mixed[i]] != 0)
                return std::nullopt;
            nodes->addMixed(s.mixed[i], &s.nodes[i * kBrickValues]);
            const std::size_t first = map.layers_.size();
            if (s.layerCount[i] == 0 || first + s.layerCount[i] > s.layerTissue.size()) return std::nullopt;
            map.ranges_.push_back(
                {static_cast<std::uint32_t>(first), s.layerCount[i], static_cast<cases::Tissue>(s.rest[i])});
            for (std::size_t k = first; k < first + s.layerCount[i]; ++k)
                map.layers_.push_back(
                    {static_cast<cases::Tissue>(s.layerTissue[k]), map.values_.data() + k * kBrickValues});
        }
        if (map.layers_.size() != s.layerTissue.size()) return std::nullopt;
        map.nodes_ = std::move(nodes);
        return isSound(map, grid) ? std::optional(std::move(map)) : std::nullopt;
    }

    /// There is tissue where the field has any, and a node is of the first layer that contains it.
    static bool isSound(const TissueMap& map, const DistanceField& grid) {
        const FieldView view = grid.view();
        for (std::uint32_t i = 0; i < map.nodes_->start.size(); ++i) {
            const bool matters = view.brickIndex[i] >= 0 || view.coarse[i] < 0.0f, mixed = map.nodes_->isMixed(i);
            const std::uint8_t* nodes = map.nodes_->of(i);
            if (matters != (mixed || *nodes != 0)) return false;
            if (!mixed) continue;
            const TissueMap::Layers all = map.layers(i);
            for (std::size_t node = 0; node < kBrickValues; ++node) {
                const auto inside = std::find_if(all.layers.begin(), all.layers.end(),
                                                 [&](const TissueMap::Layer& l) { return l.values[node] < 0; });
                const cases::Tissue tissue = inside == all.layers.end() ? all.rest : inside->tissue;
                if (nodes[node] != static_cast<std::uint8_t>(tissue)) return false;
            }
        }
        return true;
    }
};

std::uint64_t tissueKey(std::uint64_t fieldKey) {
    core::Hasher hasher;
    hasher.add(std::string_view("handpiece tissues"));
    hasher.add(kVersion);
    hasher.add(fieldKey);
    return hasher.value();
}

std::vector<std::byte> encodeTissues(const TissueMap& map, std::uint64_t key) {
    Header header = TissueStorage::headerOf(map);
    header.key = key;
    std::vector<std::byte> data(sizeof header);
    TissueStorage::sectionsOf(map).visit(
        [&](std::span<const std::byte> section) { data.insert(data.end(), section.begin(), section.end()); });
    header.payloadHash = hashOf(std::span(data).subspan(sizeof header));
    header.headerHash = headerHashOf(header);
    std::memcpy(data.data(), &header, sizeof header);
    return data;
}

namespace {

bool isWanted(const Header& header, const DistanceField& grid, std::uint64_t key, std::uint64_t bytes) {
    if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0 || header.version != kVersion ||
        header.byteOrder != kByteOrder || header.key != key || header.headerHash != headerHashOf(header))
        return false;
    const std::size_t dense = grid.storage().coarse.size();
    return header.bricks == dense && header.mixedBricks <= dense && header.layers <= 255 * header.mixedBricks &&
           bytes == sizeof header + header.bricks + header.mixedBricks * (4 + 2 + kBrickValues) +
                        header.layers * (1 + kBrickValues);
}

std::optional<TissueMap> mapFrom(const Header& header, std::span<const std::byte> payload, const DistanceField& grid,
                                 const TissueSet& tissues) {
    if (hashOf(payload) != header.payloadHash) return std::nullopt;
    TissueStorage::Sections sections(header);
    std::size_t at = 0;
    sections.visit([&](std::span<std::byte> section) {
        std::copy_n(payload.begin() + static_cast<std::ptrdiff_t>(at), section.size(), section.begin());
        at += section.size();
    });
    return TissueStorage::mapOf(std::move(sections), grid, tissues);
}

/// Distances of layers change little from node to node: the differences pack better. They stand last.
template <class F>
void overDistances(std::span<std::byte> file, std::uint64_t layers, F&& f) {
    const std::span<std::byte> values = file.last(static_cast<std::size_t>(layers) * kBrickValues);
    f(reinterpret_cast<std::uint8_t*>(values.data()), values.size());
}

constexpr std::uint64_t kMostBytes = 1ull << 30;

}  // namespace

std::optional<TissueMap> readTissueFile(const fs::path& path, const DistanceField& grid, std::uint64_t key,
                                        const TissueSet& tissues) {
    const core::FileStream file = core::openOwnFile(path);
    Header header;
    if (!file || std::fread(&header, sizeof header, 1, file.get()) != 1 ||
        !isWanted(header, grid, key, core::sizeOf(file)))
        return std::nullopt;
    std::vector<std::byte> payload(core::sizeOf(file) - sizeof header);
    if (std::fread(payload.data(), 1, payload.size(), file.get()) != payload.size()) return std::nullopt;
    return mapFrom(header, payload, grid, tissues);
}

std::vector<std::byte> packTissues(const TissueMap& map, std::uint64_t key) {
    std::vector<std::byte> file = encodeTissues(map, key);
    overDistances(file, TissueStorage::headerOf(map).layers, [](std::uint8_t* values, std::size_t count) {
        for (std::size_t i = count; i-- > 1;)
            values[i] = static_cast<std::uint8_t>(values[i] - values[i - 1]);
    });
    std::vector<std::byte> packed;
    prepared::pack(file, packed);
    return packed;
}

std::optional<TissueMap> unpackTissues(std::span<const std::byte> packed, const DistanceField& grid, std::uint64_t key,
                                       const TissueSet& tissues) {
    std::optional<std::vector<std::byte>> file = prepared::unpack(packed, kMostBytes);
    Header header;
    if (!file || !packed.empty() || file->size() < sizeof header) return std::nullopt;
    std::memcpy(&header, file->data(), sizeof header);
    if (!isWanted(header, grid, key, file->size())) return std::nullopt;
    overDistances(*file, header.layers, [](std::uint8_t* values, std::size_t count) {
        for (std::size_t i = 1; i < count; ++i)
            values[i] = static_cast<std::uint8_t>(values[i] + values[i - 1]);
    });
    return mapFrom(header, std::span(*file).subspan(sizeof header), grid, tissues);
}

}  // namespace handpiece::field
