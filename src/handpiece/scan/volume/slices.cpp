// SPDX-License-Identifier: Apache-2.0
// Pictures that make a scan together: those of one folder and one kind whose names differ in a number.
#include <fmt/format.h>

#include <algorithm>
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
            return readTiff(input, info, 0, 1, to, {});
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
                    Candidate c;
                    c.where = files->where(file);
                    c.series.format = "TIFF pages";
                    c.series.bits = info.bits;
                    c.grid.size = {info.columns, info.rows, info.pages};
                    c.spacingProblem = "a TIFF does not tell it";
                    if (info.spacingMm && isSpacing(info.spacingMm->z())) {
                        c.spacingProblem.clear();
                        setSpacing(c, *info.spacingMm);
                    }
                    if (info.isColour) c.series.notes.push_back("colour pictures were turned to grey");
                    c.slice = [files, file, info](int k, float* to) {
                        Input in = files->open(file);
                        readTiff(in, info, k, 1, to, {});
                    };
                    c.load = [files, file, info](float* to, const core::Progress& told) {
                        Input in = files->open(file);
                        readTiff(in, info, 0, info.pages, to, told);
                    };
                    found.push_back(std::move(c));
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
        if (std::any_of(infos.begin(), infos.end(), [](const PictureInfo& i) { return i.isColour; }))
            c.series.notes.push_back("colour pictures were turned to grey");
        double slope = 1.0, intercept = 0.0;
        if (const auto toml = files->find(firstName, "scan.toml")) {
            try {
                const Description d = readDescription(*files, *toml);
                apply(d, c);
                slope = d.slope;
                intercept = d.intercept;
                if (!d.spacingMm) c.spacingProblem = "scan.toml tells no spacing_mm";
            } catch (const core::Error& e) {
                if (!c.problem) c.problem = e;
            }
        }
        const auto shared = std::make_shared<const std::vector<Slice>>(slices);
        c.slice = [files, shared, info, slope, intercept](int k, float* to) {
            const Slice& slice = (*shared)[static_cast<std::size_t>(k)];
            Input input = files->open(slice.file);
            readOne(input, slice.kind, info, to);
            if (slope == 1.0 && intercept == 0.0) return;
            const std::size_t count = static_cast<std::size_t>(info.columns) * static_cast<std::size_t>(info.rows);
            for (std::size_t i = 0; i < count; ++i)
                to[i] = static_cast<float>(slope * static_cast<double>(to[i]) + intercept);
        };
        found.push_back(std::move(c));
    }
    return found;
}

}  // namespace handpiece::volume
