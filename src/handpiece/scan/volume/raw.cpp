// SPDX-License-Identifier: Apache-2.0
// Numbers without a header, and the scan.toml that describes them or the slices beside it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/config/table.h"
#include "handpiece/scan/volume/header_text.h"
#include "handpiece/scan/volume/samples.h"

namespace handpiece::volume {
namespace {

constexpr std::uint64_t kMaxDescription = 1 << 16;

std::optional<SampleType> typeOf(const std::string& name) {
    using enum SampleType;
    constexpr std::array<std::pair<const char*, SampleType>, 10> kNames{{{"uint8", u8},
                                                                         {"int8", i8},
                                                                         {"uint16", u16},
                                                                         {"int16", i16},
                                                                         {"uint32", u32},
                                                                         {"int32", i32},
                                                                         {"uint64", u64},
                                                                         {"int64", i64},
                                                                         {"float32", f32},
                                                                         {"float64", f64}}};
    for (const auto& [known, type] : kNames)
        if (name == known) return type;
    return {};
}

std::optional<core::Vec3> threeNumbers(const config::Table& table, const char* key) {
    if (!table.has(key)) return {};
    const std::vector<double> list = table.numbers(key);
    if (list.size() != 3) table.fail(fmt::format("\"{}\" is not three numbers", key), "give [x, y, z]", key);
    return core::Vec3(list[0], list[1], list[2]);
}

}  // namespace

Description readDescription(const FileSet& files, std::size_t index) {
    const std::vector<std::byte> bytes = files.bytes(index, kMaxDescription);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (std::any_of(text.begin(), text.end(),
                    [](char c) { return c >= 0 && c < 0x20 && c != '\n' && c != '\r' && c != '\t'; }))
        throw core::Error("this is no text", files.where(index), "mend the file").as("bad-text", {"no text"});
    const config::Table table = config::Table::parse(text, files.where(index));
    table.allowOnly({"format", "file", "size", "type", "byte_order", "header_bytes", "spacing_mm", "origin_mm", "axes",
                     "slope", "intercept"});
    Description d;
    d.where = files.where(index);
    if (const auto format = table.integer("format"); format && *format != 1)
        table.fail(fmt::format("its format is {}, not 1", *format), "use a newer Handpiece", "format");
    d.file = table.text("file").value_or("");
    d.type = table.text("type").value_or("");
    if (table.has("size")) {
        const std::vector<double> size = table.numbers("size");
        if (size.size() != 3) table.fail("\"size\" is not three numbers", "give [columns, rows, slices]", "size");
        for (std::size_t i = 0; i < 3; ++i) {
            if (!(size[i] >= 1.0 && size[i] <= 1e6 && size[i] == std::floor(size[i])))
                table.fail(fmt::format("\"size\" cannot be {}", size[i]), "give [columns, rows, slices]", "size");
            d.size[i] = static_cast<int>(size[i]);
        }
    }
    const std::string order = table.text("byte_order").value_or("little");
    if (order != "little" && order != "big")
        table.fail(fmt::format("\"byte_order\" is \"{}\"", shown(order)), "it must be \"little\" or \"big\"",
                   "byte_order");
    d.isBigEndian = order == "big";
    const std::int64_t header = table.integer("header_bytes").value_or(0);
    if (header < 0)
        table.fail("\"header_bytes\" is negative", "count the bytes before the first value", "header_bytes");
    d.headerBytes = static_cast<std::uint64_t>(header);
    d.spacingMm = threeNumbers(table, "spacing_mm");
    if (d.spacingMm && !(isSpacing(d.spacingMm->x()) && isSpacing(d.spacingMm->y()) && isSpacing(d.spacingMm->z())))
        table.fail("\"spacing_mm\" is no spacing of a scan", "give the distances of voxel centres in mm", "spacing_mm");
    d.originMm = threeNumbers(table, "origin_mm");
    if (table.has("axes")) {
        const std::vector<double> axes = table.numbers("axes");
        if (axes.size() != 9) table.fail("\"axes\" is not nine numbers", "give the directions of i, j and k", "axes");
        core::Mat3 m;
        for (int i = 0; i < 9; ++i)
            m(i % 3, i / 3) = axes[static_cast<std::size_t>(i)];
        if (!(m.transpose() * m).isIdentity(1e-4))
            table.fail("\"axes\" are no three unit directions at right angles", "mend or remove them", "axes");
        d.axes = m;
    }
    d.slope = table.number("slope").value_or(1.0);
    d.intercept = table.number("intercept").value_or(0.0);
    if (d.slope == 0.0) table.fail("\"slope\" is zero", "remove it", "slope");
    return d;
}

void apply(const Description& description, Candidate& candidate) {
    if (description.spacingMm) {
        candidate.spacingProblem.clear();
        setSpacing(candidate, *description.spacingMm);
    }
    if (description.originMm) candidate.grid.originMm = *description.originMm;
    if (description.axes) {
        candidate.grid.axes = *description.axes;
        candidate.sideProblem.clear();
    }
}

Candidate openRaw(const Files& files, std::size_t description) {
    const Description d = readDescription(*files, description);
    const auto wrong = [&](const std::string& what, const std::string& remedy) {
        return core::Error(what, d.where, remedy);
    };
    const std::string example = R"(for example file = "scan.raw", size = [320, 320, 300], type = "uint16", )"
                                R"(byte_order = "little", spacing_mm = [0.1, 0.1, 0.1])";
    if (d.file.empty() || d.size[0] == 0 || d.type.empty())
        throw wrong("it does not tell file, size and type of a scan", example);
    const auto found = files->find(files->entries()[description].name, d.file);
    if (!found) throw wrong(fmt::format("its file \"{}\" is missing", shown(d.file)), "put it beside the description");
    const auto type = typeOf(d.type);
    if (!type)
        throw wrong(fmt::format("values of the type \"{}\" are not read", shown(d.type)),
                    "uint8, int8, uint16, int16, uint32, int32, uint64, int64, float32 or float64");
    Candidate out;
    out.where = files->where(*found);
    out.series.format = "raw";
    Samples samples;
    samples.files = files;
    samples.file = *found;
    samples.offset = d.headerBytes;
    samples.type = *type;
    samples.isBigEndian = d.isBigEndian;
    samples.slope = d.slope;
    samples.intercept = d.intercept;
    samples.size = d.size;
    samples.orderRemedy = fmt::format("set byte_order = \"{}\" in {}", d.isBigEndian ? "little" : "big",
                                      files->entries()[description].name);
    checkSize({d.size[0], d.size[1], d.size[2]}, d.where);
    const std::uint64_t has = files->entries()[*found].bytes;
    const double needed = static_cast<double>(d.size[0]) * d.size[1] * d.size[2] * static_cast<double>(bytesOf(*type));
    const bool isLonger = static_cast<double>(has) > needed + static_cast<double>(d.headerBytes);
    out.spacingProblem = fmt::format("\"{}\" tells no spacing_mm", files->entries()[description].name);
    out.sideProblem = "the description of its numbers tells no axes";
    setSamples(out, std::move(samples));
    if (isLonger)
        out.problem = core::Error(
            fmt::format("it has {} bytes, but {} x {} x {} values of type {} are {:.0f}", has, d.size[0], d.size[1],
                        d.size[2], d.type, needed),
            out.where, fmt::format("mend size, type or header_bytes in {}", files->entries()[description].name));
    apply(d, out);
    return out;
}

}  // namespace handpiece::volume
