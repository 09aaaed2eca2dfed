// SPDX-License-Identifier: Apache-2.0
// A field and a tissue cache in which anything was put in any place, with all sums right again as a forger makes them,
// must be refused or give what nothing trips over. Input: the file it is about, then places and what stands there.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>

#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/field_builder.h"
#include "handpiece/model/field/field_cache.h"
#include "handpiece/model/field/tissue_cache.h"
#include "support/closed_meshes.h"

namespace {

using namespace handpiece;

constexpr std::uint64_t kKey = 7;
constexpr std::size_t kFieldHeader = 128, kFieldCounts = 88, kTissueHeader = 64;

struct Made {
    geometry::TriangleMesh outer = test::bumpyMesh(2, 0.8), inner = test::sphereMesh(2, 0.5);
    geometry::TriangleTree tree{outer}, core{inner};
    field::FieldSettings settings{0.1, 0.1, 0.2};
    field::TissueSet tissues{cases::Tissue::enamel, cases::Tissue::dentine};
    field::DistanceField field{field::FieldStorage{}};
    std::vector<std::byte> fieldFile, tissueFile;
    std::filesystem::path place;

    Made() {
        core::setThreadCount(1);
        const field::PartSurface parts[] = {{&tree, cases::Tissue::enamel, 10}, {&core, cases::Tissue::dentine, 20}};
        field = field::FieldBuilder::fromSurface(outer, tree, parts, settings);
        fieldFile = field::encodeField(field, kKey);
        tissueFile = field::encodeTissues(field::TissueMap::fromParts(field, parts), kKey);
        const std::filesystem::path memory = "/dev/shm";
        place = (std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path()) /
                ("handpiece-fuzz-" + std::to_string(reinterpret_cast<std::uintptr_t>(this)) + "-" +
                 std::to_string(std::filesystem::file_time_type::clock::now().time_since_epoch().count()));
    }
    ~Made() {
        std::error_code left;
        std::filesystem::remove(place, left);
    }
};

std::uint64_t numberAt(const std::vector<std::byte>& file, std::size_t at) {
    std::uint64_t n = 0;
    std::memcpy(&n, &file[at], 8);
    return n;
}
void put(std::vector<std::byte>& file, std::size_t at, std::uint64_t n) {
    std::memcpy(&file[at], &n, 8);
}

void sumUp(std::vector<std::byte>& file, bool isField) {
    if (isField) {
        const std::uint64_t dense = numberAt(file, kFieldCounts), stored = numberAt(file, kFieldCounts + 8),
                            mixed = numberAt(file, kFieldCounts + 16);
        core::Hasher payload;
        std::size_t at = kFieldHeader;
        for (const std::uint64_t bytes : {4 * dense, 4 * dense, dense, stored, 729 * mixed, 4 * 729 * stored}) {
            if (bytes > file.size() - at) break;
            payload.add(field::hashOf(std::span(file).subspan(at, bytes)));
            at += bytes;
        }
        put(file, kFieldHeader - 16, payload.value());
    } else {
        put(file, kTissueHeader - 16, field::hashOf(std::span(file).subspan(kTissueHeader)));
    }
    const std::size_t header = isField ? kFieldHeader : kTissueHeader;
    core::Hasher hasher;
    hasher.add(std::span<const std::byte>(file).first(header - 8));
    put(file, header - 8, hasher.value());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const Made made;
    if (size < 1) return 0;
    const bool isField = (data[0] & 1) != 0, inHeader = (data[0] & 2) != 0;
    std::vector<std::byte> file = isField ? made.fieldFile : made.tissueFile;
    const std::size_t header = isField ? kFieldHeader : kTissueHeader;
    for (std::size_t at = 1; at + 13 <= size; at += 13) {
        std::uint32_t place = 0;
        std::memcpy(&place, data + at, 4);
        const std::size_t room = inHeader ? header - 24 : file.size() - 24;
        std::memcpy(&file[16 + place % (room - 8)], data + at + 5, 1 + data[at + 4] % 8);
    }
    if ((data[0] & 4) != 0 && size > 3) file.resize(file.size() - data[1] % 64);
    sumUp(file, isField);
    core::writeFile(made.place, file, {.ownerOnly = true, .lasting = false});
    if (isField) {
        const auto field = field::readFieldFile(made.place, kKey, made.tree, made.settings, made.tissues);
        if (!field) return 0;
        for (double x = -1.0; x <= 1.0; x += 0.0625) {
            const core::Vec3 p(x, 0.3 * x, 0.5 - x);
            if (!std::isfinite(field->distance(p)) || field->tissueAt(p) > cases::Tissue::dentine) __builtin_trap();
        }
    } else if (const auto map = field::readTissueFile(made.place, made.field, kKey, made.tissues)) {
        for (double x = -1.0; x <= 1.0; x += 0.0625)
            if (map->at({x, 0.3 * x, 0.5 - x}) > cases::Tissue::dentine) __builtin_trap();
    }
    return 0;
}
