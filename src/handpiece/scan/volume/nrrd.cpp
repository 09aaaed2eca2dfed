// SPDX-License-Identifier: Apache-2.0
// NRRD 1 to 5, header attached or detached; raw or gzip. https://teem.sourceforge.net/nrrd/format.html
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "handpiece/scan/volume/header_text.h"
#include "handpiece/scan/volume/samples.h"

namespace handpiece::volume {
namespace {

constexpr std::size_t kMaxHeader = 1 << 18;

const std::map<std::string, SampleType>& typeNames() {
    using enum SampleType;
    static const std::map<std::string, SampleType> names{{"signed char", i8},
                                                         {"int8", i8},
                                                         {"int8_t", i8},
                                                         {"uchar", u8},
                                                         {"unsigned char", u8},
                                                         {"uint8", u8},
                                                         {"uint8_t", u8},
                                                         {"short", i16},
                                                         {"short int", i16},
                                                         {"signed short", i16},
                                                         {"signed short int", i16},
                                                         {"int16", i16},
                                                         {"int16_t", i16},
                                                         {"ushort", u16},
                                                         {"unsigned short", u16},
                                                         {"unsigned short int", u16},
                                                         {"uint16", u16},
                                                         {"uint16_t", u16},
                                                         {"int", i32},
                                                         {"signed int", i32},
                                                         {"int32", i32},
                                                         {"int32_t", i32},
                                                         {"uint", u32},
                                                         {"unsigned int", u32},
                                                         {"uint32", u32},
                                                         {"uint32_t", u32},
                                                         {"longlong", i64},
                                                         {"long long", i64},
                                                         {"long long int", i64},
                                                         {"int64", i64},
                                                         {"int64_t", i64},
                                                         {"ulonglong", u64},
                                                         {"unsigned long long", u64},
                                                         {"unsigned long long int", u64},
                                                         {"uint64", u64},
                                                         {"uint64_t", u64},
                                                         {"float", f32},
                                                         {"double", f64}};
    return names;
}

/// "(a,b,c)", or nothing for "none".
std::optional<core::Vec3> vectorOf(std::string_view text) {
    text = trimmed(text);
    if (text.size() < 2 || text.front() != '(' || text.back() != ')') return {};
    text = text.substr(1, text.size() - 2);
    core::Vec3 v;
    for (int i = 0; i < 3; ++i) {
        const std::size_t comma = i < 2 ? text.find(',') : text.size();
        if (comma == std::string_view::npos) return {};
        const auto number = numberOf(text.substr(0, comma));
        if (!number) return {};
        v[i] = *number;
        text.remove_prefix(std::min(comma + 1, text.size()));
    }
    return v;
}

std::vector<std::string_view> vectorsOf(std::string_view text) {
    std::vector<std::string_view> parts;
    for (std::size_t at = 0; at < text.size();) {
        at = text.find_first_not_of(" \t", at);
        if (at == std::string_view::npos) break;
        const std::size_t end = text[at] == '(' ? text.find(')', at) : text.find_first_of(" \t", at) - 1;
        if (text[at] == '(' && end == std::string_view::npos) break;
        const std::size_t stop = std::min(end, text.size() - 1);
        parts.push_back(text.substr(at, stop - at + 1));
        at = stop + 1;
    }
    return parts;
}

/// From the space that is named to left-posterior-superior, or to axes of the same hand where it is no patient's;
/// nothing for what is not known.
std::optional<core::Vec3> toLps(const std::string& space) {
    if (space == "left-posterior-superior" || space == "lps") return core::Vec3(1, 1, 1);
    if (space == "right-anterior-superior" || space == "ras") return core::Vec3(-1, -1, 1);
    if (space == "left-anterior-superior" || space == "las") return core::Vec3(1, -1, 1);
    if (space == "scanner-xyz" || space == "3d-right-handed") return core::Vec3(1, 1, 1);
    if (space == "3d-left-handed") return core::Vec3(1, 1, -1);
    return {};
}

/// What 3D Slicer calls its segments: Segment3_LabelValue:=46, Segment3_Name:=...
std::vector<LabelName> segmentNames(const std::map<std::string, std::string>& remarks) {
    constexpr std::string_view kValue = "_LabelValue";
    std::vector<LabelName> names;
    for (const auto& [key, text] : remarks) {
        if (!key.ends_with(kValue)) continue;
        const auto value = wholeOf(text);
        const auto name = remarks.find(key.substr(0, key.size() - kValue.size()) + "_Name");
        if (value && *value > 0 && *value <= 255 && name != remarks.end())
            names.push_back({static_cast<int>(*value), name->second});
    }
    std::stable_sort(names.begin(), names.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
    return names;
}

std::optional<double> mmOf(std::string_view unit) {
    static const std::map<std::string, double> units{
        {"um", 1e-3},         {"\xc2\xb5m", 1e-3},  {"\xce\xbcm", 1e-3},   {"micron", 1e-3},      {"microns", 1e-3},
        {"micrometer", 1e-3}, {"micrometre", 1e-3}, {"micrometers", 1e-3}, {"micrometres", 1e-3}, {"mm", 1.0},
        {"millimeter", 1.0},  {"millimetre", 1.0},  {"millimeters", 1.0},  {"millimetres", 1.0},  {"cm", 10.0},
        {"centimeter", 10.0}, {"centimetre", 10.0}, {"centimeters", 10.0}, {"centimetres", 10.0}, {"m", 1000.0},
        {"meter", 1000.0},    {"metre", 1000.0},    {"meters", 1000.0},    {"metres", 1000.0},    {"in", 25.4},
        {"inch", 25.4},       {"inches", 25.4},     {"nm", 1e-6},          {"nanometers", 1e-6},  {"", 1.0}};
    const auto found = units.find(lowered(trimmed(unit)));
    return found == units.end() ? std::nullopt : std::optional(found->second);
}

/// Millimetres of each axis; what is not said is in millimetres. A unit that is not known is put into `unknown`.
core::Vec3 unitsOf(std::string_view text, std::string& unknown) {
    core::Vec3 mm = core::Vec3::Ones();
    std::size_t at = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t open = text.find('"', at),
                          close = open == std::string_view::npos ? open : text.find('"', open + 1);
        if (close == std::string_view::npos) break;
        const std::string_view unit = text.substr(open + 1, close - open - 1);
        at = close + 1;
        if (const auto known = mmOf(unit))
            mm[axis] = *known;
        else
            unknown = shown(unit);
    }
    return mm;
}

}  // namespace

Candidate openNrrd(const Files& files, std::size_t index) {
    Candidate out;
    out.where = files->where(index);
    out.series.format = "NRRD";
    Input input = files->open(index);
    std::string text(std::min<std::uint64_t>(kMaxHeader, input.size()), '\0');
    text.resize(input.readAt(0, text.data(), text.size()));
    const auto wrong = [&](const std::string& what, const std::string& remedy = "save the file again") {
        return core::Error(what, out.where, remedy);
    };
    if (text.rfind("NRRD000", 0) != 0) throw wrong("this is no NRRD file", "name another file");

    std::map<std::string, std::string> fields, remarks;
    std::size_t at = text.find('\n');
    bool ended = false;
    while (at != std::string::npos && at + 1 < text.size()) {
        const std::size_t begin = at + 1;
        at = text.find('\n', begin);
        if (at == std::string::npos) break;
        const std::string_view line = trimmed(std::string_view(text).substr(begin, at - begin));
        if (line.empty()) {
            ended = true;
            break;
        }
        if (line[0] == '#') continue;
        const std::size_t colon = line.find(':');
        if (colon == std::string_view::npos) continue;
        // "key:=value" is a remark of somebody's; of those only the names of 3D Slicer's segments are looked at.
        if (colon + 1 < line.size() && line[colon + 1] == '=') {
            if (line.starts_with("Segment"))
                remarks[std::string(trimmed(line.substr(0, colon)))] = std::string(trimmed(line.substr(colon + 2)));
            continue;
        }
        fields[lowered(trimmed(line.substr(0, colon)))] = std::string(trimmed(line.substr(colon + 1)));
    }
    const auto field = [&](std::initializer_list<const char*> names) -> std::string {
        for (const char* name : names)
            if (const auto found = fields.find(name); found != fields.end()) return found->second;
        return {};
    };
    const std::string dataFile = field({"data file", "datafile"});
    if (!ended && dataFile.empty()) throw wrong("its header does not end", "copy or save the file again");

    out.series.labelNames = segmentNames(remarks);

    Samples samples;
    samples.files = files;
    samples.file = index;
    const auto type = typeNames().find(lowered(field({"type"})));
    if (type == typeNames().end())
        throw wrong(fmt::format("values of the type \"{}\" are not read", shown(field({"type"}))),
                    "save it as short, ushort, uchar or float");
    samples.type = type->second;
    const auto dimension = wholeOf(field({"dimension"}));
    const std::vector<std::string_view> sizes = wordsOf(fields["sizes"]);
    if (dimension && *dimension == 4 && !out.series.labelNames.empty())
        throw wrong("its segments overlap, so that it holds several layers of labels",
                    "export it from 3D Slicer as one label map, or make the segments not overlap");
    if (const std::string kinds = lowered(field({"kinds"}));
        dimension && *dimension == 4 &&
        (kinds.find("rgb") != std::string::npos || kinds.find("color") != std::string::npos))
        throw wrong("its voxels are colours, no grey values or labels", "save one number a voxel");
    if (!dimension || *dimension != 3 || sizes.size() != 3)
        throw wrong(fmt::format("it has {} dimensions, not three", shown(field({"dimension"}))),
                    "save one volume of grey values");
    std::array<std::int64_t, 3> size{};
    for (std::size_t i = 0; i < 3; ++i)
        size[i] = wholeOf(sizes[i]).value_or(0);
    checkSize(size, out.where);
    for (std::size_t i = 0; i < 3; ++i)
        samples.size[i] = static_cast<int>(size[i]);

    const std::string endian = lowered(field({"endian"}));
    if (endian != "little" && endian != "big" && bytesOf(samples.type) > 1)
        throw wrong("its header does not tell the byte order", "add the line \"endian: little\" or \"endian: big\"");
    samples.isBigEndian = endian == "big";
    samples.orderRemedy = fmt::format("set \"endian: {}\" in its header", samples.isBigEndian ? "little" : "big");
    const std::string encoding = lowered(field({"encoding"}));
    if (encoding != "raw" && encoding != "gzip" && encoding != "gz")
        throw wrong(fmt::format("its encoding \"{}\" is not read", shown(encoding)), "save it as raw or gzip");
    samples.isPacked = encoding != "raw";

    if (dataFile.empty()) {
        samples.offset = at + 1;
    } else {
        const auto found = files->find(files->entries()[index].name, dataFile);
        if (!found)
            throw wrong(fmt::format("its data file \"{}\" is missing", shown(dataFile)),
                        "put it beside the header; a list of files is not read");
        samples.file = *found;
    }
    const std::int64_t lines = wholeOf(field({"line skip", "lineskip"})).value_or(0);
    const std::int64_t bytes = wholeOf(field({"byte skip", "byteskip"})).value_or(0);
    Input data = files->open(samples.file);
    if (lines > 0) {
        std::byte c;
        for (std::int64_t n = 0; n < lines && data.readAt(samples.offset, &c, 1) == 1; ++samples.offset)
            n += c == std::byte{'\n'} ? 1 : 0;
    }
    if (bytes == -1 && !samples.isPacked) {
        const std::uint64_t needed = static_cast<std::uint64_t>(size[0] * size[1] * size[2]) * bytesOf(samples.type);
        samples.offset = data.size() > needed ? data.size() - needed : 0;
    } else if (bytes < 0) {
        throw wrong("its byte skip cannot be");
    } else if (samples.isPacked) {
        samples.skip = static_cast<std::uint64_t>(bytes);
    } else {
        samples.offset += static_cast<std::uint64_t>(bytes);
    }

    const std::string space = lowered(field({"space"}));
    const std::optional<core::Vec3> flip = toLps(space);
    std::string unknownUnit;
    const core::Vec3 unit = unitsOf(field({"space units", "units"}), unknownUnit);
    if (const std::string directions = field({"space directions"}); !directions.empty()) {
        const std::vector<std::string_view> parts = vectorsOf(directions);
        core::Mat3 neighbours;
        if (parts.size() != 3) throw wrong("its space directions are not three");
        for (int axis = 0; axis < 3; ++axis) {
            const auto v = vectorOf(parts[static_cast<std::size_t>(axis)]);
            if (!v) throw wrong("its space directions are no vectors");
            neighbours.col(axis) = unit.cwiseProduct(*v).cwiseProduct(flip.value_or(core::Vec3::Ones()));
        }
        setVectors(out, neighbours);
        if (!flip)
            out.sideProblem = space.empty() ? "its header does not name the space of its directions"
                                            : "the space that its header names is not known";
        if (const auto origin = vectorOf(field({"space origin"})); origin && origin->allFinite())
            out.grid.originMm = unit.cwiseProduct(*origin).cwiseProduct(flip.value_or(core::Vec3::Ones()));
    } else {
        out.sideProblem = "its header tells no space directions";
        const std::vector<std::string_view> spacings = wordsOf(fields["spacings"]);
        if (spacings.size() == 3) {
            core::Vec3 spacing;
            for (int i = 0; i < 3; ++i)
                spacing[i] = unit[i] * numberOf(spacings[static_cast<std::size_t>(i)]).value_or(0.0);
            setSpacing(out, spacing);
        } else {
            out.spacingProblem = "its header tells no spacing";
        }
    }
    if (!unknownUnit.empty()) {
        out.spacingProblem = fmt::format("its unit \"{}\" is not known", unknownUnit);
        out.grid.originMm = core::Vec3::Zero();
    }
    setSamples(out, std::move(samples));
    return out;
}

}  // namespace handpiece::volume
