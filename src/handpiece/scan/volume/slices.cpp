// SPDX-License-Identifier: Apache-2.0
// Pictures that make a scan together: those of one folder and one kind whose names differ in a number.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "handpiece/scan/volume/header_text.h"
#include "handpiece/scan/volume/pictures.h"

namespace handpiece::volume {
namespace {

constexpr std::uint64_t kMaxPicture = 1ull << 30;

struct Slice {
    std::size_t file = 0;
    std::optional<std::int64_t> number;
    PictureKind kind = PictureKind::bmp;
};

struct Key {
    std::string folder;
    PictureKind kind;
    std::string before, after;
    auto operator<=>(const Key&) const = default;
};

PictureKind kindOf(Input& input) {
    std::array<std::uint8_t, 4> head{};
    (void)input.readAt(0, head.data(), head.size());
    if (head[0] == 'B' && head[1] == 'M') return PictureKind::bmp;
    if (head[0] == 0xff && head[1] == 0xd8) return PictureKind::jpeg;
    if (head[0] == 0x89 && head[1] == 'P') return PictureKind::png;
    if ((head[0] == 'I' && head[1] == 'I') || (head[0] == 'M' && head[1] == 'M')) return PictureKind::tiff;
    throw damagedPicture(input, input.size() == 0 ? "it is empty" : "it is no picture in spite of its name");
}

PictureInfo infoOf(Input& input, PictureKind kind) {
    switch (kind) {
        case PictureKind::bmp:
            return bmpInfo(input);
        case PictureKind::jpeg:
            return jpegInfo(input);
        case PictureKind::png:
            return pngInfo(input);
        case PictureKind::tiff:
            break;
    }
    return tiffInfo(input);
}

void readOne(Input& input, PictureKind kind, const PictureInfo& info, float* to) {
    switch (kind) {
        case PictureKind::bmp:
            return readBmp(input, info, to);
        case PictureKind::jpeg:
            return readJpeg(input, info, to);
        case PictureKind::png:
            return readPng(input, info, to);
        case PictureKind::tiff:
            return readTiff(input, info, 0, 1, [to](int) { return to; }, {});
    }
}

std::string nameOf(PictureKind kind) {
    switch (kind) {
        case PictureKind::bmp:
            return "BMP slices";
        case PictureKind::jpeg:
            return "JPEG slices";
        case PictureKind::png:
            return "PNG slices";
        case PictureKind::tiff:
            break;
    }
    return "TIFF slices";
}

/// The last run of digits of a name tells which slice it is.
void split(const std::string& name, Key& key, Slice& slice) {
    std::string stem = name.substr(folderOf(name).size());
    stem.resize(stem.size() - extensionOf(name).size());
    const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
    std::size_t end = stem.size();
    while (end > 0 && !isDigit(stem[end - 1]))
        --end;
    std::size_t begin = end;
    while (begin > 0 && isDigit(stem[begin - 1]) && end - begin < 15)
        --begin;
    key.before = stem.substr(0, begin);
    key.after = stem.substr(end);
    slice.number = wholeOf(std::string_view(stem).substr(begin, end - begin));
}

/// What a density says of a pixel's size, where a program that knew it must have written it: those that screens and
/// printers have are written by programs that know nothing.
std::optional<core::Vec2> pixelOf(const core::Vec2& densityMm) {
    constexpr double kLeastMm = 1e-3, kMostMm = 0.6, kMmPerInch = 25.4, kSame = 1e-3;
    constexpr std::array kUsualPerInch{72,  75,  90,  96,  100, 120, 144, 150, 180,  192,  200,  220,
                                       240, 300, 350, 360, 400, 480, 600, 720, 1200, 1440, 2400, 4800};
    for (const double mm : {densityMm.x(), densityMm.y()}) {
        if (!(mm >= kLeastMm && mm <= kMostMm)) return {};
        for (const int usual : kUsualPerInch)
            if (std::abs(kMmPerInch / mm - usual) < kSame * usual ||
                std::abs(10.0 / mm - std::round(10.0 * usual / kMmPerInch)) < kSame)  // rounded to a centimetre
                return {};
    }
    return densityMm;
}

/// The number behind "key=" at the beginning of a line.
std::optional<double> valueIn(std::string_view text, std::string_view key) {
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = trimmed(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::size_t equals = line.find('=');
        if (equals == std::string_view::npos || lowered(trimmed(line.substr(0, equals))) != key) continue;
        if (const auto value = numberOf(line.substr(equals + 1))) return value;
    }
    return {};
}

struct LogScale {
    double mm = 0.0;    ///< a pixel's size
    double step = 1.0;  ///< from slice to slice, in pixels; NRecon may write only every so many slices
};

/// A voxel's size by the log that Skyscan's scanner and NRecon leave beside the slices; nothing where there is none,
/// or where several disagree. Only its size is looked for.
std::optional<LogScale> logScale(const FileSet& files, const std::string& firstName) {
    constexpr std::uint64_t kMaxLog = 1 << 20;
    constexpr std::size_t kMaxLogs = 64;
    constexpr double kSame = 1e-3;
    const std::string_view own = std::string_view(firstName).substr(folderOf(firstName).size());
    std::optional<LogScale> found;
    std::size_t longest = 0, seen = 0;
    bool isSplit = false;
    for (std::size_t i = 0; i < files.entries().size() && seen < kMaxLogs; ++i) {
        const std::string& name = files.entries()[i].name;
        if (extensionOf(name) != ".log" || folderOf(name) != folderOf(firstName) || files.entries()[i].bytes > kMaxLog)
            continue;
        ++seen;
        std::vector<std::byte> bytes;
        try {
            bytes = files.bytes(i, kMaxLog);
        } catch (const core::Error&) {
            continue;  // what cannot be read tells nothing
        }
        const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        // Of what was reconstructed, which may be coarser than what was taken.
        std::optional<double> um, step;
        if (const std::size_t part = text.find("[Reconstruction]"); part != std::string_view::npos) {
            um = valueIn(text.substr(part), "pixel size (um)");
            step = valueIn(text.substr(part), "section to section step");
        }
        if (!um) um = valueIn(text, "image pixel size (um)");
        if (!um || !isSpacing(*um * 1e-3)) continue;
        // The one that has the slices' own name counts before others.
        std::string_view stem = std::string_view(name).substr(folderOf(name).size());
        stem.remove_suffix(4);
        const std::size_t fits = own.starts_with(stem) ? stem.size() : 0;
        if (found && fits < longest) continue;
        const LogScale one{*um * 1e-3, step.value_or(1.0)};
        isSplit = found && fits == longest &&
                  (isSplit || std::abs(one.mm - found->mm) > kSame * found->mm || one.step != found->step);
        if (!isSplit) found = one;
        longest = fits;
    }
    return isSplit ? std::nullopt : found;
}

/// Slices' distance in pixels by the log and by the slices' numbers, which count all slices or those that were written;
/// nothing where the two cannot both be right.
std::optional<double> stepOf(double logStep, std::int64_t numberStep) {
    const auto gap = static_cast<double>(numberStep);
    if (!(logStep >= 1.0) || !std::isfinite(logStep)) return {};
    if (gap == 1.0) return logStep;
    const double times = gap / logStep;
    return times == std::round(times) ? std::optional(gap) : std::nullopt;
}

void setLogScale(const LogScale& log, std::int64_t numberStep, Candidate& c) {
    const std::optional<double> step = stepOf(log.step, numberStep);
    if (!step) {
        c.spacingProblem = fmt::format(
            "the scanner's log tells the size of a pixel ({:.6g} mm), but its distance of the slices ({:g} pixels) and "
            "their numbers ({} apart) do not fit each other",
            log.mm, log.step, numberStep);
        c.grid.spacingMm.head<2>() = core::Vec2::Constant(log.mm);
        return;
    }
    c.spacingProblem.clear();
    setSpacing(c, core::Vec3(log.mm, log.mm, log.mm * *step));
    c.series.notes.push_back(
        *step == 1.0
            ? fmt::format("the size of a voxel, {:.6g} mm, is that of the scanner's log beside the slices", log.mm)
            : fmt::format("the size of a pixel, {:.6g} mm, is that of the scanner's log beside the slices, which lie "
                          "{:g} pixels ({:.6g} mm) apart {}",
                          log.mm, *step, log.mm * *step,
                          log.step == 1.0 ? "by their numbers: give the spacing where that is wrong" : "by this log"));
}

/// Where nobody says it: by the scanner's log, else by the pictures' own density. `numberStep`: from slice to slice, by
/// their names.
void findSpacing(const FileSet& files, const std::string& firstName, const std::vector<PictureInfo>& infos,
                 std::int64_t numberStep, Candidate& c) {
    if (c.spacingProblem.empty()) return;
    std::vector<std::string>& notes = c.series.notes;
    if (const std::optional<LogScale> log = logScale(files, firstName)) return setLogScale(*log, numberStep, c);
    constexpr double kSame = 1e-3;
    const std::optional<core::Vec2> density = infos.front().densityMm;
    if (!density) return;
    for (const PictureInfo& info : infos)
        if (!info.densityMm || (*info.densityMm - *density).cwiseAbs().maxCoeff() > kSame * density->minCoeff()) return;
    const std::optional<core::Vec2> pixel = pixelOf(*density);
    if (!pixel) {
        c.spacingProblem = fmt::format(
            "pictures do not tell it: their density, {:.4g} dots an inch, is one of screens and printers or cannot be",
            25.4 / density->x());
        return;
    }
    if (std::abs(pixel->x() - pixel->y()) > kSame * pixel->minCoeff()) {
        c.spacingProblem = fmt::format(
            "the pictures tell the size of a pixel ({:.6g} x {:.6g} mm), not how far the "
            "slices are apart",
            pixel->x(), pixel->y());
        c.grid.spacingMm.head<2>() = *pixel;
        return;
    }
    c.spacingProblem.clear();
    setSpacing(c, core::Vec3(pixel->x(), pixel->y(), pixel->x()));
    notes.push_back(
        fmt::format("the size of a pixel, {:.6g} mm, is that of the pictures' density, and the slices are "
                    "taken to lie as far apart: give the spacing where that is wrong",
                    pixel->x()));
}

/// What a scan.toml beside the pictures says; scale of their values.
std::pair<double, double> describeBeside(const FileSet& files, const std::string& name, Candidate& c) {
    try {
        const auto toml = files.find(name, "scan.toml");
        if (!toml) return {1.0, 0.0};
        const Description d = readDescription(files, *toml);
        if (!d.file.empty()) return {1.0, 0.0};  // of raw numbers that lie here too
        apply(d, c);
        if (!d.spacingMm && !c.spacingProblem.empty()) c.spacingProblem = "scan.toml tells no spacing_mm";
        return {d.slope, d.intercept};
    } catch (const core::Error& e) {
        if (!c.problem) c.problem = e;
    }
    return {1.0, 0.0};
}

void scale(float* values, std::size_t count, const std::pair<double, double>& by) {
    if (by.first == 1.0 && by.second == 0.0) return;
    for (std::size_t i = 0; i < count; ++i)
        values[i] = static_cast<float>(by.first * static_cast<double>(values[i]) + by.second);
}

/// A stack in one file.
Candidate pagesOf(const Files& files, std::size_t file, const PictureInfo& info) {
    Candidate c;
    const std::string& name = files->entries()[file].name;
    c.where = files->where(file);
    c.series.format = "TIFF pages";
    c.series.bits = info.bits;
    c.grid.size = {info.columns, info.rows, info.pages};
    c.spacingProblem = "a TIFF does not tell it";
    c.sideProblem = "pages do not tell from which end they are numbered";
    if (info.spacingMm && isSpacing(info.spacingMm->z())) {
        c.spacingProblem.clear();
        setSpacing(c, *info.spacingMm);
    }
    if (info.isColour) c.series.notes.push_back("colour pictures were turned to grey");
    const std::pair<double, double> by = describeBeside(*files, name, c);
    findSpacing(*files, name, {info}, 1, c);
    const std::size_t each = static_cast<std::size_t>(info.columns) * static_cast<std::size_t>(info.rows);
    c.slice = [files, file, info, by, each](int k, float* to) {
        Input in = files->open(file);
        readTiff(in, info, k, 1, [to](int) { return to; }, {});
        scale(to, each, by);
    };
    c.load = [files, file, info, by, each](int first, int count, const SlicePlace& place, const core::Progress& told) {
        Input in = files->open(file);
        float* last = nullptr;
        readTiff(
            in, info, first, count,
            [&](int k) {
                if (last) scale(last, each, by);
                return last = place(k);
            },
            told);
        if (last) scale(last, each, by);
    };
    return c;
}

/// Why these slices make no scan, or nothing.
std::optional<core::Error> wrongWith(const FileSet& files, const std::vector<Slice>& slices,
                                     const std::vector<PictureInfo>& infos) {
    const auto shortName = [&](std::size_t i) {
        const std::string& name = files.entries()[slices[i].file].name;
        return name.substr(folderOf(name).size());
    };
    // The size that most have is the right one.
    std::map<std::pair<int, int>, std::size_t> counts;
    for (const PictureInfo& info : infos)
        ++counts[{info.columns, info.rows}];
    if (counts.size() > 1) {
        const auto most = std::max_element(counts.begin(), counts.end(),
                                           [](const auto& a, const auto& b) { return a.second < b.second; });
        for (std::size_t i = 0; i < infos.size(); ++i)
            if (std::pair(infos[i].columns, infos[i].rows) != most->first)
                return core::Error(
                    fmt::format("the slices have different sizes: {} of them {} x {}, this one {} x {}", most->second,
                                most->first.first, most->first.second, infos[i].columns, infos[i].rows),
                    files.where(slices[i].file), "put slices of one size into a folder of their own");
    }
    std::int64_t step = 0;
    for (std::size_t i = 1; i < slices.size(); ++i) {
        if (!slices[i].number || !slices[i - 1].number) return {};
        const std::int64_t gap = *slices[i].number - *slices[i - 1].number;
        if (gap == 0)
            return core::Error(
                fmt::format("slice {} is there twice, also as \"{}\"", *slices[i].number, shortName(i - 1)),
                files.where(slices[i].file), "remove one of the two");
        step = step == 0 ? gap : std::min(step, gap);
    }
    for (std::size_t i = 1; i < slices.size(); ++i) {
        const std::int64_t gap = *slices[i].number - *slices[i - 1].number;
        if (gap != step)
            return core::Error(
                fmt::format("slices are missing: after \"{}\" comes \"{}\"", shortName(i - 1), shortName(i)),
                files.where(slices[i].file), "put the missing ones there, or number the files without a gap");
    }
    return {};
}

}  // namespace

core::Error damagedPicture(const Input& input, const std::string& why) {
    return core::Error(fmt::format("this picture is damaged: {}", why.empty() ? "it cannot be read" : why),
                       input.where(), "copy or save it again");
}

std::vector<std::byte> wholeOf(Input& input) {
    if (input.size() > kMaxPicture)
        throw core::Error(fmt::format("a picture of {} MB is no slice", input.size() >> 20), input.where(),
                          "name the right file")
            .as("scan-too-large");
    std::vector<std::byte> data(input.size());
    data.resize(input.readAt(0, data.data(), data.size()));
    return data;
}

std::vector<Candidate> findSlices(const Files& files, const std::vector<std::size_t>& which, Failures& failures,
                                  const core::Progress& progress) {
    std::vector<Candidate> found;
    std::map<Key, std::vector<Slice>> groups;
    std::map<std::size_t, PictureInfo> known;
    std::size_t done = 0;
    for (const std::size_t file : which) {
        core::report(progress, 0.5 * static_cast<double>(done++) / static_cast<double>(which.size()));
        const std::string& name = files->entries()[file].name;
        Key key{std::string(folderOf(name)), {}, {}, {}};
        Slice slice;
        slice.file = file;
        try {
            Input input = files->open(file);
            key.kind = slice.kind = kindOf(input);
            if (slice.kind == PictureKind::tiff) {
                const PictureInfo info = tiffInfo(input);
                known[file] = info;
                if (info.pages > 1) {
                    found.push_back(pagesOf(files, file, info));
                    continue;
                }
            }
        } catch (const core::Error& e) {
            // A broken slice among others keeps its place, so that the hole is seen.
            failures.push_back(e);
            continue;
        }
        split(name, key, slice);
        groups[key].push_back(slice);
    }
    // Names without a common pattern: then all of a folder's pictures of a kind belong together.
    if (std::all_of(groups.begin(), groups.end(), [](const auto& g) { return g.second.size() == 1; })) {
        std::map<Key, std::vector<Slice>> merged;
        for (auto& [key, slices] : groups) {
            slices[0].number.reset();
            auto& all = merged[Key{key.folder, key.kind, {}, {}}];
            all.insert(all.end(), slices.begin(), slices.end());
        }
        groups = std::move(merged);
    }
    for (auto& [key, slices] : groups) {
        // Files come in natural order already, but the number alone decides.
        std::stable_sort(slices.begin(), slices.end(), [](const Slice& a, const Slice& b) {
            if (a.number && b.number && *a.number != *b.number) return *a.number < *b.number;
            return a.file < b.file;
        });
        Candidate c;
        const std::string& firstName = files->entries()[slices[0].file].name;
        c.where = slices.size() == 1 || !files->isNamed(0) ? files->where(slices[0].file) : files->where();
        c.series.format = nameOf(key.kind);
        std::vector<PictureInfo> infos;
        for (const Slice& slice : slices) {
            core::report(progress, 0.5 * static_cast<double>(done++) / static_cast<double>(which.size()));
            try {
                Input input = files->open(slice.file);
                const auto old = known.find(slice.file);
                infos.push_back(old != known.end() ? old->second : infoOf(input, slice.kind));
            } catch (const core::Error& e) {
                if (!c.problem) c.problem = e;
            }
        }
        if (infos.empty()) {
            failures.push_back(*c.problem);
            continue;
        }
        if (!c.problem && !failures.empty()) {
            // A slice that could not even be recognised, of the same folder.
            for (const core::Error& e : failures)
                if (slices.size() > 1 && folderOf(e.where()) == folderOf(files->where(slices[0].file))) c.problem = e;
        }
        if (!c.problem) c.problem = wrongWith(*files, slices, infos);
        const PictureInfo info = infos[infos.size() / 2];
        c.grid.size = {info.columns, info.rows, static_cast<int>(slices.size())};
        c.series.bits = info.bits;
        c.spacingProblem = "pictures do not tell it";
        c.sideProblem = "pictures do not tell from which end they are numbered";
        if (std::any_of(infos.begin(), infos.end(), [](const PictureInfo& i) { return i.isColour; }))
            c.series.notes.push_back("colour pictures were turned to grey");
        const std::pair<double, double> by = describeBeside(*files, firstName, c);
        const bool isNumbered = slices.size() > 1 && slices[0].number && slices[1].number;
        findSpacing(*files, firstName, infos, isNumbered ? *slices[1].number - *slices[0].number : 1, c);
        const auto shared = std::make_shared<const std::vector<Slice>>(slices);
        c.slice = [files, shared, info, by](int k, float* to) {
            const Slice& slice = (*shared)[static_cast<std::size_t>(k)];
            Input input = files->open(slice.file);
            readOne(input, slice.kind, info, to);
            scale(to, static_cast<std::size_t>(info.columns) * static_cast<std::size_t>(info.rows), by);
        };
        found.push_back(std::move(c));
    }
    return found;
}

}  // namespace handpiece::volume
