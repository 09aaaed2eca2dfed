// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <limits>

#include "handpiece/base/geometry/mesh_io_formats.h"

namespace handpiece::geometry::formats {
namespace {

enum class Type : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class Encoding { ascii, little, big };

std::optional<Type> typeByName(std::string_view name) {
    constexpr std::pair<std::string_view, Type> kNames[] = {
        {"char", Type::int8},     {"int8", Type::int8},       {"uchar", Type::uint8},    {"uint8", Type::uint8},
        {"short", Type::int16},   {"int16", Type::int16},     {"ushort", Type::uint16},  {"uint16", Type::uint16},
        {"int", Type::int32},     {"int32", Type::int32},     {"uint", Type::uint32},    {"uint32", Type::uint32},
        {"float", Type::float32}, {"float32", Type::float32}, {"double", Type::float64}, {"float64", Type::float64}};
    for (const auto& [text, type] : kNames)
        if (text == name) return type;
    return std::nullopt;
}

struct Property {
    std::string_view name;
    Type type;
    std::optional<Type> countType;  ///< a list
};

struct Element {
    std::string_view name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    Encoding encoding = Encoding::ascii;
    std::vector<Element> elements;
    std::size_t bytes = 0;
};

Header readHeader(const Source& source) {
    const std::string_view text = source.text();
    Header header;
    bool formatSeen = false;
    for (std::size_t at = 0;;) {
        const std::size_t end = text.find_first_of("\r\n", at);
        if (end == std::string_view::npos) source.fail("the PLY header has no end", "export or copy the mesh again");
        const std::string_view line = text.substr(at, end - at);
        // "\r\n" is one end of line; the data may begin with a '\n' of its own only after a lone '\r', which nobody
        // writes.
        at = end + (text.substr(end, 2) == "\r\n" ? 2 : 1);
        Words words(line);
        const std::string_view key = words.next();
        if (key == "format") {
            const std::string_view name = words.next();
            formatSeen = true;
            if (name == "ascii")
                header.encoding = Encoding::ascii;
            else if (name == "binary_little_endian")
                header.encoding = Encoding::little;
            else if (name == "binary_big_endian")
                header.encoding = Encoding::big;
            else
                source.fail(fmt::format("the PLY format {} is not known", quoted(name)),
                            "export it as ascii or binary");
        } else if (key == "element") {
            Element element{words.next(), 0, {}};
            if (!parseInteger(words.next(), element.count))
                source.fail(fmt::format("the PLY header gives no count of {}", quoted(element.name)),
                            "export the mesh again");
            header.elements.push_back(std::move(element));
        } else if (key == "property") {
            if (header.elements.empty())
                source.fail("the PLY header has a property before any element", "export the mesh again");
            std::string_view type = words.next();
            Property property{{}, Type::int8, std::nullopt};
            if (type == "list") {
                property.countType = typeByName(words.next());
                if (!property.countType || *property.countType == Type::float32 || *property.countType == Type::float64)
                    source.fail("a list in the PLY header has no whole-number count", "export the mesh again");
                type = words.next();
            }
            const std::optional<Type> known = typeByName(type);
            if (!known) source.fail(fmt::format("the PLY type {} is not known", quoted(type)), "export the mesh again");
            property.type = *known;
            property.name = words.next();
            header.elements.back().properties.push_back(property);
        } else if (key == "end_header") {
            if (!formatSeen) source.fail("the PLY header names no format", "export the mesh again");
            header.bytes = at;
            return header;
        }
    }
}

// Numbers of the body one after another. Every call takes at least a byte of the file, so that no count in the header
// can make the reader run on beyond its end.
class Body {
  public:
    Body(const Source& source, const Header& header)
        : encoding_(header.encoding),
          words_(source.text().substr(header.bytes)),
          at_(source.data.data() + header.bytes),
          end_(source.data.data() + source.data.size()) {}

    /// False when the file has ended or (in text) the next word is not a number.
    bool next(Type type, double& value) {
        if (encoding_ == Encoding::ascii) return parseNumber(words_.next(), value);
        switch (type) {
            case Type::int8:
                return get<std::int8_t>(value);
            case Type::uint8:
                return get<std::uint8_t>(value);
            case Type::int16:
                return get<std::int16_t>(value);
            case Type::uint16:
                return get<std::uint16_t>(value);
            case Type::int32:
                return get<std::int32_t>(value);
            case Type::uint32:
                return get<std::uint32_t>(value);
            case Type::float32:
                return get<float>(value);
            case Type::float64:
                return get<double>(value);
        }
        return false;
    }
    /// What was not taken yet.
    [[nodiscard]] std::string_view rest() const {
        if (encoding_ == Encoding::ascii) return words_.rest();
        return {reinterpret_cast<const char*>(at_), static_cast<std::size_t>(end_ - at_)};
    }

  private:
    template <class T>
    bool get(double& value) {
        if (static_cast<std::size_t>(end_ - at_) < sizeof(T)) return false;
        std::array<std::byte, sizeof(T)> bytes;
        std::memcpy(bytes.data(), at_, sizeof(T));
        if (encoding_ == Encoding::big) std::reverse(bytes.begin(), bytes.end());
        T number;
        std::memcpy(&number, bytes.data(), sizeof(T));
        value = static_cast<double>(number);
        at_ += sizeof(T);
        return true;
    }

    Encoding encoding_;
    Words words_;
    const std::byte* at_;
    const std::byte* end_;
};

class Reader {
  public:
    Reader(const Source& source, VertexColours* colours)
        : source_(source), header_(readHeader(source)), body_(source, header_), colours_(colours) {}

    TriangleMesh read() {
        for (const Element& element : header_.elements) {
            if (element.properties.empty()) continue;  // takes no bytes, whatever its count
            if (element.name == "vertex")
                readVertices(element);
            else if (element.name == "face")
                readFaces(element);
            else
                for (std::uint64_t i = 0; i < element.count; ++i)
                    for (const Property& p : element.properties)
                        readProperty(element, i, p, [](double) {});
        }
        bad_.check(source_, "vertices", "vertex");
        if (colours_ != nullptr) *colours_ = found_.settle(source_, mesh_.vertices.size(), leastScale_, mostScale_);
        if (highest_ > mesh_.vertices.size())
            source_.fail(
                fmt::format("face {} names vertex {} of {}", highestFace_ + 1, highest_, mesh_.vertices.size()),
                "export the mesh again");
        settle(polygons_, mesh_, source_);
        if (noFaces_ > 0)
            source_.note(fmt::format("{} {} fewer than three corners: points and lines are left out", noFaces_,
                                     noFaces_ == 1 ? "face has" : "faces have"));
        for (const Element& element : header_.elements)
            if (element.name == "tristrips" && element.count > 0)
                source_.note("strips of triangles (tristrips) are left out: export it as triangles");
        tellRest();
        if (header_.encoding == Encoding::ascii && body_.rest().empty())
            source_.note(fmt::format("the last line has no end: see that face {} is whole", mesh_.triangles.size()));
        return std::move(mesh_);
    }

  private:
    // Ends of lines and padding say nothing; all else is of somebody's surface.
    void tellRest() const {
        constexpr std::string_view kSpare{" \t\r\n\v\f\0", 7};
        const std::string_view rest = body_.rest();
        const std::size_t from = rest.find_first_not_of(kSpare);
        if (from == std::string_view::npos) return;
        if (const std::string_view more = rest.substr(from);
            more.size() > 3 && more.starts_with("ply") && Words::isSpace(more[3]))
            source_.note(
                fmt::format("several PLY files were glued into one: only the first is read, with {} faces, and the {} "
                            "bytes after it are left out; save each as a file of its own",
                            mesh_.triangles.size(), more.size()));
        else
            source_.note(fmt::format("{} bytes after the {} vertices and {} faces that the header counts are left out",
                                     rest.size(), mesh_.vertices.size(), countOf("face")));
    }

    [[nodiscard]] std::uint64_t countOf(std::string_view name) const {
        std::uint64_t count = 0;
        for (const Element& element : header_.elements)
            if (element.name == name) count += element.count;
        return count;
    }

    [[noreturn]] void failAt(const Element& element, std::uint64_t i) const {
        source_.fail(fmt::format("the file ends (or is no number) in {} {} of {}", element.name.substr(0, 24), i + 1,
                                 element.count),
                     "export or copy the mesh again");
    }

    template <class Take>
    void readProperty(const Element& element, std::uint64_t i, const Property& p, Take take) {
        double value = 0.0;
        if (!p.countType) {
            if (!body_.next(p.type, value)) failAt(element, i);
            take(value);
            return;
        }
        double count = 0.0;
        if (!body_.next(*p.countType, count)) failAt(element, i);
        if (!(count >= 0.0 && count <= 4294967295.0) || count != std::floor(count))
            source_.fail(fmt::format("{} {} has a list of {} values", element.name.substr(0, 24), i + 1, count),
                         "export the mesh again");
        for (std::uint64_t k = 0; k < static_cast<std::uint64_t>(count); ++k) {
            if (!body_.next(p.type, value)) failAt(element, i);
            take(value);
        }
    }

    // Grows with what is really there, not with what the header promises.
    template <class T>
    static void reserve(std::vector<T>& items, std::uint64_t promised, std::size_t fileBytes) {
        items.reserve(std::min<std::uint64_t>(promised, fileBytes / 4));
    }

    /// Which properties are red, green and blue; -1 each unless all three are there and of one type.
    [[nodiscard]] std::array<std::ptrdiff_t, 3> channelsOf(const Element& element) {
        constexpr std::array<std::array<std::string_view, 3>, 2> kNames{
            {{"red", "green", "blue"}, {"diffuse_red", "diffuse_green", "diffuse_blue"}}};
        for (const auto& names : kNames) {
            std::array<std::ptrdiff_t, 3> channel{-1, -1, -1};
            for (std::size_t k = 0; k < element.properties.size(); ++k)
                for (std::size_t c = 0; c < 3; ++c)
                    if (!element.properties[k].countType && element.properties[k].name == names[c])
                        channel[c] = static_cast<std::ptrdiff_t>(k);
            if (channel[0] < 0 || channel[1] < 0 || channel[2] < 0) continue;
            const auto typeOf = [&](std::size_t c) {
                return element.properties[static_cast<std::size_t>(channel[c])].type;
            };
            if (typeOf(0) != typeOf(1) || typeOf(0) != typeOf(2)) continue;
            // A whole 1 is nearly black, and a fraction of 1 is white.
            const bool isWhole = typeOf(0) != Type::float32 && typeOf(0) != Type::float64;
            leastScale_ = isWhole ? 255.0 : 1.0;
            if (typeOf(0) == Type::uint8) mostScale_ = 255.0;
            if (typeOf(0) == Type::int8 || typeOf(0) == Type::int16) {
                source_.note("the colours are left out: on what scale numbers with a sign are is not known");
                continue;
            }
            return channel;
        }
        return {-1, -1, -1};
    }

    void readVertices(const Element& element) {
        std::array<std::ptrdiff_t, 3> axis{-1, -1, -1}, channel{-1, -1, -1};
        if (colours_ != nullptr) channel = channelsOf(element);
        for (std::size_t k = 0; k < element.properties.size(); ++k) {
            const Property& p = element.properties[k];
            if (!p.countType && p.name.size() == 1 && p.name[0] >= 'x' && p.name[0] <= 'z')
                axis[static_cast<std::size_t>(p.name[0] - 'x')] = static_cast<std::ptrdiff_t>(k);
        }
        if (axis[0] < 0 || axis[1] < 0 || axis[2] < 0)
            source_.fail("the vertices have no x, y and z", "export the mesh again");
        if (element.count > kMaxFaces * 3)
            source_.fail(fmt::format("{} vertices are more than are read", element.count));
        reserve(mesh_.vertices, element.count, source_.data.size());
        const bool isText = header_.encoding == Encoding::ascii;
        bool isLineEach = false;
        for (std::uint64_t i = 0; i < element.count; ++i) {
            core::Vec3 v = core::Vec3::Zero(), colour = core::Vec3::Zero();
            const std::string_view text = body_.rest();
            for (std::size_t k = 0; k < element.properties.size(); ++k)
                readProperty(element, i, element.properties[k], [&](double value) {
                    for (int a = 0; a < 3; ++a) {
                        if (axis[static_cast<std::size_t>(a)] == static_cast<std::ptrdiff_t>(k)) v[a] = value;
                        if (channel[static_cast<std::size_t>(a)] == static_cast<std::ptrdiff_t>(k)) colour[a] = value;
                    }
                });
            if (isText) {
                // One value too few, and all that follows would shift by one.
                const std::string_view taken = text.substr(0, text.size() - body_.rest().size());
                const bool isSeveral =
                    taken.find_first_of("\r\n", taken.find_first_not_of(" \t\r\n\v\f")) != taken.npos;
                if (i == 0) isLineEach = !isSeveral;
                if (isLineEach && isSeveral)
                    source_.fail(fmt::format("the line of vertex {} has too few values", i + 1),
                                 "export the mesh again");
            }
            if (channel[0] >= 0) found_.add(colour.x(), colour.y(), colour.z());
            if (!isCoordinate(v.x()) || !isCoordinate(v.y()) || !isCoordinate(v.z())) bad_.add(mesh_.vertices.size());
            mesh_.vertices.push_back(v);
        }
    }

    void readFaces(const Element& element) {
        const auto isCorners = [](const Property& p) {
            return p.countType && (p.name == "vertex_indices" || p.name == "vertex_index");
        };
        if (std::none_of(element.properties.begin(), element.properties.end(), isCorners))
            source_.fail("the faces have no vertex_indices", "export the mesh again");
        reserve(mesh_.triangles, element.count, source_.data.size());
        std::vector<std::uint32_t> corners;
        for (std::uint64_t i = 0; i < element.count; ++i) {
            corners.clear();
            for (const Property& p : element.properties) {
                if (!isCorners(p)) {
                    readProperty(element, i, p, [](double) {});
                    continue;
                }
                readProperty(element, i, p, [&](double value) {
                    if (!(value >= 0.0 && value < 4294967295.0) || value != std::floor(value))
                        source_.fail(fmt::format("face {} names vertex {}", i + 1, value), "export the mesh again");
                    const auto index = static_cast<std::uint32_t>(value);
                    if (index >= highest_) {
                        highest_ = std::uint64_t{index} + 1;
                        highestFace_ = i;
                    }
                    corners.push_back(index);
                });
            }
            if (corners.size() < 3) ++noFaces_;
            polygons_.add(mesh_.triangles, corners);
            if (mesh_.triangles.size() > kMaxFaces)
                source_.fail(fmt::format("more than the {} faces that are read", kMaxFaces));
        }
    }

    const Source& source_;
    Header header_;
    Body body_;
    TriangleMesh mesh_;
    Polygons polygons_;
    BadCoordinates bad_;
    VertexColours* colours_;
    FoundColours found_;
    double leastScale_ = 1.0, mostScale_ = 65535.0;
    std::uint64_t highest_ = 0, highestFace_ = 0, noFaces_ = 0;
};

}  // namespace

TriangleMesh readPly(const Source& source, VertexColours* colours) {
    return Reader(source, colours).read();
}

}  // namespace handpiece::geometry::formats
