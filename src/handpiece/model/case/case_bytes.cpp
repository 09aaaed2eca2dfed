// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/case_bytes.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstring>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/mesh_bytes.h"

namespace handpiece::cases {
namespace {

constexpr char kMagic[4] = {'H', 'P', 'C', 'S'};
constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kMaxParts = 64, kMaxName = 4096;

void append(std::vector<std::byte>& bytes, std::uint32_t value) {
    for (int i = 0; i < 4; ++i)
        bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
}
void append(std::vector<std::byte>& bytes, const std::string& text) {
    const std::string kept = text.substr(0, kMaxName);
    append(bytes, static_cast<std::uint32_t>(kept.size()));
    const auto* data = reinterpret_cast<const std::byte*>(kept.data());
    bytes.insert(bytes.end(), data, data + kept.size());
}

class Reader {
  public:
    Reader(std::span<const std::byte> bytes, const std::string& where) : bytes_(bytes), where_(where) {}
    [[noreturn]] void refuse(const std::string& what, const char* remedy = "take another copy") const {
        throw core::Error(what, where_, remedy);
    }
    std::span<const std::byte> take(std::size_t size) {
        if (size > bytes_.size()) refuse("the tooth inside ends early");
        const auto taken = bytes_.first(size);
        bytes_ = bytes_.subspan(size);
        return taken;
    }
    std::uint32_t number() {
        std::uint32_t value = 0;
        const auto taken = take(4);
        for (std::size_t i = 0; i < 4; ++i)
            value |= static_cast<std::uint32_t>(taken[i]) << (8 * i);
        return value;
    }
    std::string text() {
        const std::uint32_t size = number();
        if (size > kMaxName) refuse("the tooth inside has a name without end");
        const auto taken = take(size);
        return {reinterpret_cast<const char*>(taken.data()), taken.size()};
    }
    geometry::TriangleMesh mesh() { return geometry::takeMesh(bytes_, where_); }
    [[nodiscard]] bool isAtEnd() const { return bytes_.empty(); }

  private:
    std::span<const std::byte> bytes_;
    const std::string& where_;
};

}  // namespace

std::vector<std::byte> encodeCase(const Case& toothCase) {
    std::vector<std::byte> bytes;
    for (const char c : kMagic)
        bytes.push_back(static_cast<std::byte>(c));
    append(bytes, kVersion);
    append(bytes, toothCase.name);
    append(bytes, toothCase.kind);
    append(bytes, static_cast<std::uint32_t>(toothCase.fdiNumber));
    append(bytes, static_cast<std::uint32_t>(toothCase.buccalSign + 1));
    geometry::appendMesh(bytes, toothCase.outer);
    append(bytes, static_cast<std::uint32_t>(toothCase.parts.size()));
    for (const Part& part : toothCase.parts) {
        append(bytes, part.name);
        append(bytes, static_cast<std::uint32_t>(part.tissue));
        append(bytes, static_cast<std::uint32_t>(part.priority));
        geometry::appendMesh(bytes, part.mesh);
    }
    return bytes;
}

Case decodeCase(std::span<const std::byte> bytes, const std::string& where) {
    Reader reader(bytes, where);
    if (std::memcmp(reader.take(4).data(), kMagic, 4) != 0) reader.refuse("there is no tooth inside");
    const std::uint32_t version = reader.number();
    if (version != kVersion)
        reader.refuse(fmt::format("the tooth inside is of version {}, this program reads {}", version, kVersion),
                      "use a newer Handpiece");
    Case made;
    made.name = reader.text();
    made.kind = reader.text();
    made.fdiNumber = static_cast<int>(reader.number());
    const std::uint32_t buccal = reader.number();
    if (buccal > 2) reader.refuse("the tooth inside has no such side");
    made.buccalSign = static_cast<int>(buccal) - 1;
    made.outer = reader.mesh();
    const std::uint32_t parts = reader.number();
    if (parts > kMaxParts) reader.refuse(fmt::format("the tooth inside claims {} parts", parts));
    for (std::uint32_t i = 0; i < parts; ++i) {
        Part part;
        part.name = reader.text();
        const std::uint32_t tissue = reader.number();
        if (tissue == 0 || tissue >= kTissueCount) reader.refuse(fmt::format("there is no tissue {}", tissue));
        part.tissue = static_cast<Tissue>(tissue);
        part.priority = static_cast<int>(reader.number());
        part.mesh = reader.mesh();
        made.parts.push_back(std::move(part));
    }
    if (!reader.isAtEnd()) reader.refuse("the tooth inside goes on after its end");
    if (made.outer.triangles.empty() && made.parts.empty()) reader.refuse("the tooth inside has no surface");
    return made;
}

}  // namespace handpiece::cases
