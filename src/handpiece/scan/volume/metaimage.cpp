// SPDX-License-Identifier: Apache-2.0
// MetaImage: .mha with its values inside, .mhd with a file of them beside it. https://itk.org/Wiki/MetaIO/Documentation
#include <fmt/format.h>

#include <cmath>
#include <map>

#include "handpiece/scan/volume/header_text.h"
#include "handpiece/scan/volume/samples.h"

namespace handpiece::volume {
namespace {

constexpr std::size_t kMaxHeader = 1 << 16;

std::optional<SampleType> typeOf(const std::string& name) {
    using enum SampleType;
    static const std::map<std::string, SampleType> names{
        {"MET_CHAR", i8},       {"MET_UCHAR", u8},       {"MET_SHORT", i16}, {"MET_USHORT", u16},
        {"MET_INT", i32},       {"MET_UINT", u32},       {"MET_LONG", i32},  {"MET_ULONG", u32},
        {"MET_LONG_LONG", i64}, {"MET_ULONG_LONG", u64}, {"MET_FLOAT", f32}, {"MET_DOUBLE", f64}};
    const auto found = names.find(name);
    return found == names.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace

Candidate openMetaImage(const Files& files, std::size_t index) {
    Candidate out;
    out.where = files->where(index);
    out.series.format = "MetaImage";
    const auto wrong = [&](const std::string& what, const std::string& remedy = "save the file again") {
        return core::Error(what, out.where, remedy);
    };
    Input input = files->open(index);
    std::string text(std::min<std::uint64_t>(kMaxHeader, input.size()), '\0');
    text.resize(input.readAt(0, text.data(), text.size()));

    std::map<std::string, std::string> fields;
    std::size_t at = 0;
    bool ended = false;
    while (!ended && at < text.size()) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const std::string_view line = std::string_view(text).substr(at, end - at);
        at = end + 1;
        const std::size_t equals = line.find('=');
        if (equals == std::string_view::npos) {
            if (trimmed(line).empty()) continue;
            throw wrong("its header is no list of names and values", "copy or save the file again");
        }
        const std::string key(trimmed(line.substr(0, equals)));
        fields[key] = std::string(trimmed(line.substr(equals + 1)));
        ended = key == "ElementDataFile";  // always the last
    }
    if (!ended) throw wrong("its header does not end with ElementDataFile", "copy or save the file again");
    const auto field = [&](std::initializer_list<const char*> names) -> std::string {
        for (const char* name : names)
            if (const auto found = fields.find(name); found != fields.end()) return found->second;
        return {};
    };
    const auto flag = [&](std::initializer_list<const char*> names) {
        const std::string value = lowered(field(names));
        return value == "true" || value == "1" || value == "yes";
    };
    const auto numbers = [&](std::initializer_list<const char*> names) {
        const std::string value = field(names);
        std::vector<double> list;
        for (const std::string_view word : wordsOf(value))
            list.push_back(numberOf(word).value_or(0.0));
        return list;
    };

    Samples samples;
    samples.files = files;
    samples.file = index;
    const std::vector<double> sizes = numbers({"DimSize"});
    if (wholeOf(field({"NDims"})).value_or(0) != 3 || sizes.size() != 3)
        throw wrong(fmt::format("it has {} dimensions, not three", shown(field({"NDims"}))),
                    "save one volume of grey values");
    if (const std::string channels = field({"ElementNumberOfChannels"}); !channels.empty() && channels != "1")
        throw wrong(fmt::format("it has {} values a voxel, not one{}", shown(channels),
                                channels == "3" || channels == "4" ? ": its voxels are colours" : ""),
                    "save one volume of grey values or labels");
    std::array<std::int64_t, 3> size{};
    for (std::size_t i = 0; i < 3; ++i)
        size[i] = sizes[i] >= 1.0 && sizes[i] < 1e15 ? static_cast<std::int64_t>(sizes[i]) : 0;
    checkSize(size, out.where);
    for (std::size_t i = 0; i < 3; ++i)
        samples.size[i] = static_cast<int>(size[i]);
    const auto type = typeOf(field({"ElementType"}));
    if (!type)
        throw wrong(fmt::format("values of the type \"{}\" are not read", shown(field({"ElementType"}))),
                    "save it as MET_SHORT, MET_USHORT, MET_UCHAR or MET_FLOAT");
    samples.type = *type;
    if (const std::string binary = lowered(field({"BinaryData"})); binary == "false" || binary == "0" || binary == "no")
        throw wrong("its values are written as text (BinaryData = False), which is not read",
                    "save it with binary values");
    samples.isBigEndian = flag({"BinaryDataByteOrderMSB", "ElementByteOrderMSB"});
    samples.orderRemedy =
        fmt::format("set \"BinaryDataByteOrderMSB = {}\" in its header", samples.isBigEndian ? "False" : "True");
    samples.isPacked = flag({"CompressedData"});
    const std::string dataFile = field({"ElementDataFile"});
    if (dataFile == "LOCAL" || dataFile == "Local" || dataFile == "local") {
        samples.offset = std::min<std::uint64_t>(at, input.size());
    } else {
        const auto found = files->find(files->entries()[index].name, dataFile);
        if (!found)
            throw wrong(fmt::format("its data file \"{}\" is missing", shown(dataFile)),
                        "put it beside the header; a list of files is not read");
        samples.file = *found;
        const std::int64_t skip = wholeOf(field({"HeaderSize"})).value_or(0);
        const std::uint64_t has = files->entries()[*found].bytes;
        const std::uint64_t needed = static_cast<std::uint64_t>(size[0] * size[1] * size[2]) * bytesOf(*type);
        if (skip == -1) samples.offset = has > needed ? has - needed : 0;
        if (skip > 0) samples.offset = static_cast<std::uint64_t>(skip);
    }

    core::Mat3 axes = core::Mat3::Identity();
    if (const std::string matrix = field({"TransformMatrix", "Rotation", "Orientation"}); !matrix.empty()) {
        const std::vector<std::string_view> m = wordsOf(matrix);
        for (std::size_t n = 0; n < 9; ++n) {
            const std::optional<double> value = m.size() == 9 ? numberOf(m[n]) : std::nullopt;
            if (!value || !std::isfinite(*value))
                throw wrong("its TransformMatrix is not nine numbers", "write it as nine numbers, or save it again");
            axes(static_cast<int>(n % 3), static_cast<int>(n / 3)) = *value;
        }
        if (axes.colwise().norm().minCoeff() == 0.0) throw wrong("one direction of its TransformMatrix is 0 0 0");
    } else {
        out.sideProblem = "its header tells no TransformMatrix";
    }
    if (const std::vector<double> s = numbers({"ElementSpacing", "ElementSize"}); s.size() == 3) {
        const core::Vec3 spacing(s[0], s[1], s[2]);
        setSpacing(out, spacing);
        if (out.spacingProblem.empty()) setVectors(out, axes * spacing.asDiagonal());
    } else {
        out.spacingProblem = "its header tells no spacing";
    }
    if (const std::vector<double> o = numbers({"Offset", "Position", "Origin"}); o.size() == 3)
        if (const core::Vec3 origin(o[0], o[1], o[2]); origin.allFinite()) out.grid.originMm = origin;
    setSamples(out, std::move(samples));
    return out;
}

}  // namespace handpiece::volume
