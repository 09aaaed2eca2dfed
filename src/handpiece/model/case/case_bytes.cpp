// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/case_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/mesh_bytes.h"
#include "handpiece/model/case/case_files.h"

namespace handpiece::cases {
namespace {

constexpr char kMagic[4] = {'H', 'P', 'C', 'S'};
constexpr std::uint32_t kAlone = 1, kWithOthers = 2, kWithLandmarks = 3;  // versions
constexpr std::uint32_t kMaxParts = 64, kMaxName = 4096, kMaxOthers = 64;

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

void append(std::vector<std::byte>& bytes, double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    append(bytes, static_cast<std::uint32_t>(bits));
    append(bytes, static_cast<std::uint32_t>(bits >> 32));
}
void append(std::vector<std::byte>& bytes, const std::vector<const Part*>& parts) {
    append(bytes, static_cast<std::uint32_t>(parts.size()));
    for (const Part* part : parts) {
        append(bytes, part->name);
        append(bytes, static_cast<std::uint32_t>(part->tissue));
        append(bytes, static_cast<std::uint32_t>(part->priority));
        geometry::appendMesh(bytes, part->mesh);
    }
}
/// Of scenery what is felt: it decides what the hand does.
std::vector<const Part*> feltOf(const Case& toothCase) {
    std::vector<const Part*> felt;
    for (const Part& part : toothCase.scenery)
        if (part.isFelt) felt.push_back(&part);
    return felt;
}
void append(std::vector<std::byte>& bytes, const Tooth& tooth) {
    append(bytes, tooth.name);
    append(bytes, tooth.kind);
    append(bytes, static_cast<std::uint32_t>(tooth.fdiNumber));
    append(bytes, static_cast<std::uint32_t>(tooth.buccalSign + 1));
    geometry::appendMesh(bytes, tooth.outer);
    std::vector<const Part*> parts;
    for (const Part& part : tooth.parts)
        parts.push_back(&part);
    append(bytes, parts);
}
void append(std::vector<std::byte>& bytes, const std::vector<Landmark>& marks) {
    append(bytes, static_cast<std::uint32_t>(marks.size()));
    for (const Landmark& mark : marks) {
        append(bytes, static_cast<std::uint32_t>(mark.kind));
        append(bytes, mark.name);
        append(bytes, static_cast<std::uint32_t>(mark.source));
        append(bytes, static_cast<std::uint32_t>(mark.pointsMm.size()));
        for (const core::Vec3& p : mark.pointsMm)
            for (int k = 0; k < 3; ++k)
                append(bytes, p[k]);
    }
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
    double real() {
        const std::uint64_t low = number(), high = number();
        return std::bit_cast<double>(high << 32 | low);
    }
    std::vector<Part> parts() {
        const std::uint32_t count = number();
        if (count > kMaxParts) refuse(fmt::format("the tooth inside claims {} parts", count));
        std::vector<Part> made;
        for (std::uint32_t i = 0; i < count; ++i) {
            Part& part = made.emplace_back();
            part.name = text();
            const std::uint32_t tissue = number();
            if (tissue == 0 || tissue >= kTissueCount) refuse(fmt::format("there is no tissue {}", tissue));
            part.tissue = static_cast<Tissue>(tissue);
            part.priority = static_cast<int>(number());
            part.mesh = mesh();
        }
        return made;
    }
    void tooth(Tooth& made) {
        made.name = text();
        made.kind = text();
        made.fdiNumber = static_cast<int>(number());
        const std::uint32_t buccal = number();
        if (buccal > 2) refuse("the tooth inside has no such side");
        made.buccalSign = static_cast<int>(buccal) - 1;
        made.outer = mesh();
        made.parts = parts();
        if (made.outer.triangles.empty() && made.parts.empty()) refuse("the tooth inside has no surface");
    }
    std::vector<Landmark> landmarks() {
        const std::uint32_t count = number();
        std::vector<Landmark> made;
        for (std::uint32_t i = 0; i < count; ++i) {
            Landmark& mark = made.emplace_back();
            const std::uint32_t kind = number();
            if (kind >= kLandmarkKindCount) refuse(fmt::format("there is no landmark of kind {}", kind));
            mark.kind = static_cast<LandmarkKind>(kind);
            mark.name = text();
            const std::uint32_t source = number();
            if (source >= kLandmarkSources.size()) refuse(fmt::format("a landmark inside has the source {}", source));
            mark.source = static_cast<LandmarkSource>(source);
            const std::uint32_t points = number();
            const LandmarkShape shape = shapeOf(mark.kind);
            if (points < shape.least || points > shape.most)
                refuse(fmt::format("a {} inside has {} points", kLandmarkKinds[kind], points));
            for (std::uint32_t k = 0; k < points; ++k) {
                const double x = real(), y = real(), z = real();
                const core::Vec3 p(x, y, z);
                if (!(p.norm() <= kFarthestLandmarkMm)) refuse("a landmark inside lies nowhere near its tooth");
                mark.pointsMm.push_back(p);
            }
        }
        return made;
    }
    core::Pose pose() {
        core::Pose pose;
        for (int k = 0; k < 3; ++k)
            pose.positionMm[k] = real();
        for (int k = 0; k < 4; ++k)
            pose.orientation.coeffs()[k] = real();
        if (!pose.isValid()) refuse("a tooth inside stands nowhere");
        return pose;
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
    const std::vector<const Part*> felt = feltOf(toothCase);
    const bool isAlone = toothCase.others.empty() && felt.empty();
    const bool hasLandmarks =
        !toothCase.landmarks.empty() || std::any_of(toothCase.others.begin(), toothCase.others.end(),
                                                    [](const PlacedTooth& o) { return !o.landmarks.empty(); });
    append(bytes, hasLandmarks ? kWithLandmarks : isAlone ? kAlone : kWithOthers);
    append(bytes, static_cast<const Tooth&>(toothCase));
    if (hasLandmarks)
        append(bytes, toothCase.landmarks);
    else if (isAlone)
        return bytes;
    append(bytes, static_cast<std::uint32_t>(toothCase.others.size()));
    for (const PlacedTooth& other : toothCase.others) {
        append(bytes, static_cast<const Tooth&>(other));
        if (hasLandmarks) append(bytes, other.landmarks);
        for (int k = 0; k < 3; ++k)
            append(bytes, other.inCase.positionMm[k]);
        for (int k = 0; k < 4; ++k)
            append(bytes, other.inCase.orientation.coeffs()[k]);
        append(bytes, static_cast<std::uint32_t>(other.isCuttable));
    }
    append(bytes, felt);
    return bytes;
}

Case decodeCase(std::span<const std::byte> bytes, const std::string& where) {
    Reader reader(bytes, where);
    if (std::memcmp(reader.take(4).data(), kMagic, 4) != 0) reader.refuse("there is no tooth inside");
    const std::uint32_t version = reader.number();
    if (version < kAlone || version > kWithLandmarks)
        reader.refuse(fmt::format("the tooth inside is of version {}, this program reads {} to {}", version, kAlone,
                                  kWithLandmarks),
                      "use a newer Handpiece");
    const bool hasLandmarks = version >= kWithLandmarks;
    Case made;
    reader.tooth(made);
    if (hasLandmarks) made.landmarks = reader.landmarks();
    const std::uint32_t others = version >= kWithOthers ? reader.number() : 0;
    if (others > kMaxOthers) reader.refuse(fmt::format("the tooth inside claims {} others", others));
    for (std::uint32_t i = 0; i < others; ++i) {
        PlacedTooth& other = made.others.emplace_back();
        reader.tooth(other);
        if (hasLandmarks) other.landmarks = reader.landmarks();
        other.inCase = reader.pose();
        const std::uint32_t cuttable = reader.number();
        if (cuttable > 1) reader.refuse("a tooth inside is neither to be cut nor not");
        other.isCuttable = cuttable == 1;
    }
    if (version >= kWithOthers) made.scenery = reader.parts();
    for (Part& part : made.scenery)
        part.isFelt = true;
    if (!reader.isAtEnd()) reader.refuse("the tooth inside goes on after its end");
    return made;
}

}  // namespace handpiece::cases
