// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/volume/read_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <type_traits>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/scan/volume/candidate.h"
#include "handpiece/scan/volume/header_text.h"
#include "handpiece/scan/volume/window.h"

namespace handpiece::volume {
namespace {

constexpr int kThumbnail = 128;
/// Slices may lie this far beside their place, all over the scan, before they are straightened.
constexpr double kTiltVoxels = 0.25;
constexpr float kLargestValue = 1e12f;
/// No packing of slices gives more voxels a byte; up to kSmallVoxels nobody asks.
constexpr std::uint64_t kMaxVoxelsPerByte = 4096, kSmallVoxels = 1 << 24;

/// The slice, fitted and stretched to 8 bit between its half-percent ends.
void makeThumbnail(const float* slice, int columns, int rows, Series& series) {
    const int longest = std::max(columns, rows), fit = std::min(longest, kThumbnail);
    const int width = std::max(1, columns * fit / longest), height = std::max(1, rows * fit / longest);
    std::vector<float> small(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int x0 = static_cast<int>(static_cast<std::int64_t>(x) * columns / width),
                      x1 = std::max(x0 + 1, static_cast<int>(static_cast<std::int64_t>(x + 1) * columns / width));
            const int y0 = static_cast<int>(static_cast<std::int64_t>(y) * rows / height),
                      y1 = std::max(y0 + 1, static_cast<int>(static_cast<std::int64_t>(y + 1) * rows / height));
            double sum = 0.0;
            for (int j = y0; j < y1; ++j)
                for (int i = x0; i < x1; ++i)
                    sum += static_cast<double>(slice[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) +
                                                     static_cast<std::size_t>(i)]);
            const double mean = sum / ((x1 - x0) * (y1 - y0));
            small[static_cast<std::size_t>(y * width + x)] =
                std::abs(mean) <= kLargestValue ? static_cast<float>(mean) : 0.0f;
        }
    std::vector<float> sorted = small;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t cut = sorted.size() / 200;
    const float low = sorted[cut], high = sorted[sorted.size() - 1 - cut];
    const double scale = high > low ? 255.0 / (static_cast<double>(high) - static_cast<double>(low)) : 0.0;
    series.thumbnailSize = {width, height};
    series.thumbnail.resize(small.size());
    std::transform(small.begin(), small.end(), series.thumbnail.begin(), [&](float v) {
        return static_cast<std::uint8_t>(
            std::lround(std::clamp((static_cast<double>(v) - static_cast<double>(low)) * scale, 0.0, 255.0)));
    });
}

/// What findSeries and readScan both tell of it.
Series describe(const Candidate& candidate, bool isReversed = false) {
    Series series = candidate.series;
    const std::string& why = candidate.sideProblem;
    series.isSideKnown = why.empty() || candidate.grid.size[2] < 2;
    if (isReversed)
        series.notes.push_back("its slices were read from the other end, as was asked for");
    else if (!series.isSideKnown)
        series.notes.push_back(
            fmt::format("left and right may be swapped: {}. If the tooth is a mirror image, have the slices read from "
                        "the other end",
                        why));
    series.size = candidate.grid.size;
    series.slices = candidate.grid.size[2];
    series.isSpacingKnown = candidate.spacingProblem.empty();
    series.spacingMm = series.isSpacingKnown ? candidate.grid.spacingMm : core::Vec3::Zero();
    return series;
}

/// `Block`, here and below: Volume or Labels.
template <class Block>
void reverseSlices(Block& volume) {
    const Grid& grid = volume.grid;
    const std::size_t each = grid.index(0, 0, 1);
    for (int k = 0; 2 * k + 1 < grid.size[2]; ++k)
        std::swap_ranges(volume.values.begin() + static_cast<std::ptrdiff_t>(grid.index(0, 0, k)),
                         volume.values.begin() + static_cast<std::ptrdiff_t>(grid.index(0, 0, k) + each),
                         volume.values.begin() + static_cast<std::ptrdiff_t>(grid.index(0, 0, grid.size[2] - 1 - k)));
}

/// Left-handed grids get their slices in the other order.
template <class Block>
void makeRightHanded(Block& volume, core::Vec3& stepMm) {
    Grid& grid = volume.grid;
    if (grid.axes.determinant() > 0.0) return;
    reverseSlices(volume);
    grid.originMm += stepOf(grid, stepMm) * (grid.size[2] - 1);
    grid.axes.col(2) *= -1.0;
    stepMm *= -1.0;
}

/// Slices that shift from one to the next are put square over each other; what was not scanned gets the lowest value.
/// Between labels there is nothing: of those around the nearest.
template <class Block>
void straighten(Block& volume, Series& series, const core::Vec3& stepMm, std::uint64_t limitBytes,
                const core::Progress& progress) {
    Grid& grid = volume.grid;
    if (stepMm.isZero() || grid.size[2] < 2) return;
    const core::Vec3 local = grid.axes.transpose() * stepMm;
    const core::Vec2 shift(local.x() / grid.spacingMm.x(), local.y() / grid.spacingMm.y());
    const core::Vec2 whole = shift * (grid.size[2] - 1);
    if (whole.cwiseAbs().maxCoeff() < kTiltVoxels) return;
    const std::string where = "the straightened scan";
    Grid to = grid;
    std::array<int, 2> grow{}, first{};
    for (int axis = 0; axis < 2; ++axis) {
        if (!(std::abs(whole[axis]) < 1e5))
            throw core::Error("its slices lie beside each other, not over each other", where,
                              "read it in the program that made it");
        grow[static_cast<std::size_t>(axis)] = static_cast<int>(std::ceil(std::abs(whole[axis])));
        first[static_cast<std::size_t>(axis)] = whole[axis] < 0.0 ? grow[static_cast<std::size_t>(axis)] : 0;
        to.size[static_cast<std::size_t>(axis)] += grow[static_cast<std::size_t>(axis)];
    }
    const std::uint64_t bytes = checkedBytes(to.size, where, limitBytes);
    to.originMm -= grid.axes.col(0) * grid.spacingMm.x() * first[0] + grid.axes.col(1) * grid.spacingMm.y() * first[1];
    decltype(volume.values) values(bytes / sizeof(float),
                                   *std::min_element(volume.values.begin(), volume.values.end()));
    std::atomic<int> done{0};
    core::parallelFor(static_cast<std::size_t>(grid.size[2]), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t slice = begin; slice < end; ++slice) {
            const int k = static_cast<int>(slice);
            for (int j = 0; j < to.size[1]; ++j) {
                const double v = j - first[1] - shift.y() * k;
                const int j0 = static_cast<int>(std::floor(v));
                const float fj = static_cast<float>(v - j0);
                if (v < 0.0 || v > grid.size[1] - 1) continue;
                const int j1 = std::min(j0 + 1, grid.size[1] - 1);
                for (int i = 0; i < to.size[0]; ++i) {
                    const double u = i - first[0] - shift.x() * k;
                    if (u < 0.0 || u > grid.size[0] - 1) continue;
                    const int i0 = static_cast<int>(std::floor(u)), i1 = std::min(i0 + 1, grid.size[0] - 1);
                    const float fi = static_cast<float>(u - i0);
                    const auto& from = volume.values;
                    if constexpr (std::is_same_v<Block, Labels>) {
                        values[to.index(i, j, k)] = from[grid.index(fi < 0.5f ? i0 : i1, fj < 0.5f ? j0 : j1, k)];
                    } else {
                        const float a = from[grid.index(i0, j0, k)] * (1 - fi) + from[grid.index(i1, j0, k)] * fi;
                        const float b = from[grid.index(i0, j1, k)] * (1 - fi) + from[grid.index(i1, j1, k)] * fi;
                        values[to.index(i, j, k)] = a * (1 - fj) + b * fj;
                    }
                }
            }
            core::report(progress, static_cast<double>(++done) / grid.size[2]);
        }
    });
    volume.grid = to;
    volume.values = std::move(values);
    const double slope = core::atan2(core::hypot(local.x(), local.y()), std::abs(local.z())) * 180.0 / M_PI;
    series.notes.push_back(fmt::format("the slices were tilted by {:.1f} degrees and have been straightened", slope));
}

/// What is no number, or no grey value of any scanner, counts as nothing: all that comes after may add and square.
float numberOr0(float value, std::size_t& bad) {
    if (std::abs(value) <= kLargestValue) return value;
    ++bad;
    return 0.0f;
}

std::uint8_t labelOf(float value, const std::string& where) {
    // Programs that keep labels as floats write 11 through a slope now and then.
    constexpr float kWhole = 1e-3f;
    const float whole = std::round(value);
    if (!(whole >= 0.0f && whole <= 255.0f && std::abs(value - whole) <= kWhole))
        throw core::Error(fmt::format("it holds {}, which is no label (whole numbers 0 to 255)", value), where,
                          "read it as a scan, or save the labels as 8-bit whole numbers");
    return static_cast<std::uint8_t>(whole);
}

enum class Kind { other, dicom, dicomdir, picture, nrrd, metaImage, nifti, description, data };

Kind kindOf(const FileSet& files, std::size_t index, std::array<std::uint8_t, 352>& head, std::size_t got) {
    const std::string& name = files.entries()[index].name;
    const std::string extension = extensionOf(name);
    const auto begins = [&](std::string_view magic, std::size_t at = 0) {
        return got >= at + magic.size() && std::memcmp(head.data() + at, magic.data(), magic.size()) == 0;
    };
    if (begins("DICM", 128))
        return lowered(name.substr(folderOf(name).size())) == "dicomdir" ? Kind::dicomdir : Kind::dicom;
    if (begins("BM") && extension != ".raw") return Kind::picture;
    if (begins("\xff\xd8\xff") || begins("\x89PNG")) return Kind::picture;
    if (begins(std::string_view("II*\0", 4)) || begins(std::string_view("MM\0*", 4)) ||
        begins(std::string_view("II+\0", 4)) || begins(std::string_view("MM\0+", 4)))
        return Kind::picture;
    if (begins("NRRD000")) return Kind::nrrd;
    if (begins("n+1", 344) || begins("ni1", 344) || begins("n+2", 4) || begins("ni2", 4)) return Kind::nifti;
    const bool isPackedNifti = lowered(name).ends_with(".nii.gz") || lowered(name).ends_with(".hdr.gz");
    if (begins("\x1f\x8b") && isPackedNifti) return Kind::nifti;
    if (extension == ".mha" || extension == ".mhd") return Kind::metaImage;
    if (extension == ".toml") return Kind::description;
    // DICOM without its preamble: group 0002 or 0008, little endian, and an element of the low ones.
    const bool mayBeBare = extension.empty() || extension == ".dcm" || extension == ".dic" || extension == ".ima";
    if (mayBeBare && got >= 132 && (head[0] == 8 || head[0] == 2) && head[1] == 0 && head[3] == 0) return Kind::dicom;
    if (extension == ".dcm") return Kind::dicom;
    for (const char* picture : {".bmp", ".jpg", ".jpeg", ".png", ".tif", ".tiff"})
        if (extension == picture) return Kind::picture;
    if (extension == ".nrrd" || extension == ".nhdr") return Kind::nrrd;
    if (extension == ".nii" || isPackedNifti) return Kind::nifti;
    if (extension == ".raw" || extension == ".img" || extension == ".bin" || extension == ".zraw") return Kind::data;
    return Kind::other;
}

/// "12 PDF files, 3 folders".
std::string whatIsThere(const FileSet& files) {
    std::map<std::string, int> counts;
    for (const FileSet::Entry& entry : files.entries()) {
        std::string extension = extensionOf(entry.name);
        std::transform(extension.begin(), extension.end(), extension.begin(),
                       [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
        // A long ending is part of a name, and names are nobody's business.
        const bool isKind = extension.size() > 1 && extension.size() <= 6;
        // Slices may be told apart by their endings alone: CThead.1, CThead.2, ...
        const bool isNumber = isKind && extension.find_first_not_of("0123456789", 1) == std::string::npos;
        ++counts[isNumber ? "file with a number for an ending"
                 : isKind ? shown(extension.substr(1)) + " file"
                          : "file without an ending"];
    }
    // The commonest kinds are enough to know what it is.
    constexpr std::size_t kMaxKinds = 8;
    std::vector<std::pair<std::string, int>> kinds(counts.begin(), counts.end());
    std::stable_sort(kinds.begin(), kinds.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    int others = 0;
    for (; kinds.size() > kMaxKinds; kinds.pop_back())
        others += kinds.back().second;
    if (others > 0) kinds.emplace_back("other file", others);
    std::string text;
    for (auto& [name, count] : kinds) {
        if (count != 1) name.insert(name.find("file") + 4, "s");
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
    }
    if (files.folderCount() > 0)
        text += fmt::format("{}{} folder{}", text.empty() ? "" : ", ", files.folderCount(),
                            files.folderCount() == 1 ? "" : "s");
    return text.empty() ? "nothing" : text;
}

/// For notes: the file's own name, so that it can be found, and not where it lies.
std::string brief(const core::Error& error) {
    std::string name = error.where();
    name.erase(0, name.find_last_of('/') + 1);
    return fmt::format("\"{}\", {}", shown(name), error.problem());
}

Candidate choose(std::vector<Candidate>& candidates, const ReadSettings& settings, const std::string& where) {
    if (!settings.series.empty()) {
        for (Candidate& c : candidates)
            if (c.series.id == settings.series) return std::move(c);
        throw core::Error(
            fmt::format("there is no series \"{}\"; there are 1 to {}", shown(settings.series), candidates.size()),
            where, "name one of them");
    }
    if (candidates.size() > 1 && !settings.takeLargest) {
        std::string list;
        for (std::size_t i = 0; i < std::min<std::size_t>(candidates.size(), 6); ++i)
            list += fmt::format("{}{} ({}, {} x {} x {})", i == 0 ? "" : ", ", candidates[i].series.id,
                                candidates[i].series.format, candidates[i].grid.size[0], candidates[i].grid.size[1],
                                candidates[i].grid.size[2]);
        throw core::Error(
            fmt::format("it holds {} series: {}{}", candidates.size(), list, candidates.size() > 6 ? ", ..." : ""),
            where, "say which");
    }
    return std::move(candidates.front());
}

}  // namespace

bool isSpacing(double mm) {
    return std::isfinite(mm) && mm >= 1e-5 && mm <= 1e3;
}

void setSpacing(Candidate& candidate, const core::Vec3& spacingMm) {
    for (int i = 0; i < 3; ++i)
        if (isSpacing(spacingMm[i])) candidate.grid.spacingMm[i] = spacingMm[i];
    if (!isSpacing(spacingMm.x()) || !isSpacing(spacingMm.y()) || !isSpacing(spacingMm.z()))
        candidate.spacingProblem =
            fmt::format("its spacing of {} x {} x {} mm cannot be", spacingMm.x(), spacingMm.y(), spacingMm.z());
}

void setVectors(Candidate& candidate, const core::Mat3& neighboursMm) {
    if (!neighboursMm.allFinite()) {
        candidate.spacingProblem = "its spacing is no number";
        return;
    }
    const core::Vec3 u = neighboursMm.col(0), v = neighboursMm.col(1), w = neighboursMm.col(2);
    if (!isSpacing(u.norm()) || !isSpacing(v.norm()) || !isSpacing(w.norm())) {
        setSpacing(candidate, {u.norm(), v.norm(), w.norm()});
        return;
    }
    const core::Vec3 i = u.normalized(), j = v.normalized();
    if (std::abs(i.dot(j)) > 1e-3)
        throw core::Error("its rows and columns are not at right angles", candidate.where,
                          "resample it onto a straight grid in the program that made it");
    core::Vec3 normal = i.cross(j).normalized();
    if (normal.dot(w) < 0.0) normal = -normal;
    const double along = normal.dot(w);
    constexpr double kFlat = 1e-3;
    if (along < kFlat * w.norm())
        throw core::Error("its directions are damaged: the slices follow each other within their own plane",
                          candidate.where, "save it again in the program that made it");
    setSpacing(candidate, {u.norm(), v.norm(), along});
    if (!candidate.spacingProblem.empty()) return;
    candidate.grid.axes.col(0) = i;
    candidate.grid.axes.col(1) = (j - i * i.dot(j)).normalized();
    candidate.grid.axes.col(2) = normal;
    candidate.stepMm = (w - normal * along).norm() > 1e-9 * along ? w : core::Vec3(core::Vec3::Zero());
}

std::vector<Candidate> findCandidates(const Files& files, const core::Progress& progress) {
    const std::size_t count = files->entries().size();
    if (count == 0 && files->folderCount() == 0)
        throw core::Error("it is empty", files->where(), "name a folder with the slices of a scan")
            .as("no-scan", {"nothing"});
    std::vector<Kind> kinds(count);
    std::optional<std::size_t> only;
    for (std::size_t i = 0; i < count; ++i)
        if (files->isNamed(i)) only = i;
    std::atomic<std::size_t> seen{0};
    core::parallelFor(count, 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            std::array<std::uint8_t, 352> head{};
            std::size_t got = 0;
            try {
                // What lies beside a file that was named is known by its name.
                if (!only || *only == i) got = files->head(i, head.data(), head.size());
            } catch (const core::Error&) {
                got = 0;  // by its name then; whoever reads it will say why it cannot be
            }
            kinds[i] = kindOf(*files, i, head, got);
            core::report(progress, 0.2 * static_cast<double>(++seen) / static_cast<double>(count));
        }
    });

    std::vector<Candidate> found;
    Failures failures;
    std::vector<std::string> notes;
    std::vector<std::size_t> dicom, pictures;
    const auto tryOne = [&](const std::function<Candidate()>& open) {
        try {
            found.push_back(open());
        } catch (const core::Error& e) {
            failures.push_back(e);
        }
    };
    std::vector<std::size_t> listed;
    if (only && kinds[*only] == Kind::dicomdir) {
        int missing = 0;
        listed = listedFiles(*files, *only, missing);
        if (missing > 0)
            notes.push_back(fmt::format("{} file{} that the DICOMDIR lists {} missing", missing,
                                        missing == 1 ? "" : "s", missing == 1 ? "is" : "are"));
        if (listed.empty())
            throw core::Error("none of the files that it lists is there", files->where(),
                              "copy the whole disc, or name the folder with the images")
                .as("no-scan", {"DICOMDIR"});
        dicom = listed;
    }
    for (std::size_t i = 0; i < count && listed.empty(); ++i) {
        // What lies beside a file that was named is there to be referred to, not to be found.
        const bool isBeside = only && *only != i;
        switch (kinds[i]) {
            case Kind::dicom:
                if (!isBeside) dicom.push_back(i);
                break;
            case Kind::picture:
                if (!isBeside) pictures.push_back(i);
                break;
            case Kind::nrrd:
                if (!isBeside) tryOne([&] { return openNrrd(files, i); });
                break;
            case Kind::metaImage:
                if (!isBeside) tryOne([&] { return openMetaImage(files, i); });
                break;
            case Kind::nifti:
                // The .img of a pair is read with its .hdr.
                if (!isBeside && extensionOf(files->entries()[i].name) != ".img")
                    tryOne([&] { return openNifti(files, i); });
                break;
            case Kind::description: {
                if (isBeside && kinds[*only] != Kind::data && kinds[*only] != Kind::other) break;
                const std::string& name = files->entries()[i].name;
                const bool isOurs = name.substr(folderOf(name).size()) == "scan.toml";
                try {
                    const Description d = readDescription(*files, i);
                    // Without a file it tells about slices.
                    if (d.file.empty() && d.size[0] == 0 && only != i) break;
                    if (isBeside && files->entries()[*only].name != d.file) break;
                } catch (const core::Error& e) {
                    if (isOurs || only == i) failures.push_back(e);
                    break;  // some other program's settings
                }
                tryOne([&] { return openRaw(files, i); });
                break;
            }
            case Kind::dicomdir:
            case Kind::data:
            case Kind::other:
                break;
        }
    }
    // Among slices a file with their ending that is none may be one that broke off in its first bytes.
    for (std::size_t i = 0; i < count && listed.empty(); ++i)
        if (kinds[i] == Kind::other && std::any_of(dicom.begin(), dicom.end(), [&](std::size_t slice) {
                return extensionOf(files->entries()[slice].name) == extensionOf(files->entries()[i].name);
            }))
            failures.emplace_back("it is no DICOM file", files->where(i), "copy it again");
    if (!dicom.empty())
        for (Candidate& c : findDicom(files, dicom, failures, core::part(progress, 0.2, 0.9)))
            found.push_back(std::move(c));
    if (!pictures.empty())
        for (Candidate& c : findSlices(files, pictures, failures, core::part(progress, 0.2, 0.9)))
            found.push_back(std::move(c));
    // A photograph or a program's preview beside a scan is no series of its own.
    if (std::any_of(found.begin(), found.end(), [](const Candidate& c) { return c.grid.size[2] > 1; })) {
        const std::size_t before = found.size();
        std::erase_if(found,
                      [](const Candidate& c) { return c.grid.size[2] == 1 && c.series.format.ends_with("slices"); });
        if (const std::size_t singles = before - found.size(); singles > 0)
            notes.push_back(fmt::format("{} single picture{} left out", singles, singles == 1 ? " was" : "s were"));
    }
    if (found.empty()) {
        if (!failures.empty()) throw failures.front();
        const std::string there = whatIsThere(*files);
        if (only && kinds[*only] == Kind::data)
            throw core::Error("raw numbers tell neither their size nor their type", files->where(),
                              "write a scan.toml beside it with file, size, type, byte_order and spacing_mm")
                .as("no-scan", {there});
        throw core::Error(
            fmt::format("no scan is in it: {}", there), files->where(),
            "name a folder, ZIP or file with DICOM, TIFF, BMP, PNG or JPEG slices, NRRD, MetaImage, NIfTI, "
            "or raw numbers with a scan.toml")
            .as("no-scan", {there});
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Candidate& a, const Candidate& b) { return a.grid.count() > b.grid.count(); });
    for (std::size_t i = 0; i < found.size(); ++i) {
        const std::uint64_t voxels = found[i].grid.count();
        if (!found[i].problem && voxels > kSmallVoxels && voxels / kMaxVoxelsPerByte > files->storedBytes()) {
            found[i].problem = core::Error(fmt::format("its {} bytes cannot hold the {} voxels that its headers claim",
                                                       files->storedBytes(), voxels),
                                           found[i].where, "copy or save the scan again");
            found[i].slice = nullptr;
        }
        Series& series = found[i].series;
        series.id = fmt::format("{}", i + 1);
        series.notes.insert(series.notes.end(), notes.begin(), notes.end());
        if (!failures.empty())
            series.notes.push_back(
                failures.size() == 1
                    ? fmt::format("one file was left out: {}", brief(failures.front()))
                    : fmt::format("{} files were left out, the first: {}", failures.size(), brief(failures.front())));
        if (found[i].problem) series.notes.push_back(fmt::format("cannot be read: {}", brief(*found[i].problem)));
    }
    core::report(progress, 0.9);
    return found;
}

std::vector<Series> findSeries(const std::filesystem::path& path, const core::Progress& progress) {
    const std::vector<Candidate> found = findCandidates(FileSet::open(path), progress);
    std::vector<Series> out;
    for (const Candidate& candidate : found) {
        Series series = describe(candidate);
        if (!candidate.spacingProblem.empty())
            series.notes.push_back(fmt::format("the spacing must be given: {}", candidate.spacingProblem));
        const auto& size = candidate.grid.size;
        if (const int by = shrinkingOf(size, ReadSettings{}.limitBytes); by > 1 && !candidate.problem)
            series.notes.push_back(shrinkingText(size, by, ReadSettings{}.limitBytes));
        if (candidate.slice && static_cast<double>(size[0]) * size[1] < 1e8) {
            std::vector<float> slice(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]));
            try {
                candidate.slice(size[2] / 2, slice.data());
                makeThumbnail(slice.data(), size[0], size[1], series);
            } catch (const core::Error& e) {
                series.notes.push_back(fmt::format("its middle slice cannot be shown: {}", brief(e)));
            }
        }
        out.push_back(std::move(series));
        core::report(progress, 0.9 + 0.1 * static_cast<double>(out.size()) / static_cast<double>(found.size()));
    }
    return out;
}

namespace {

template <class Block>
void loadInto(Block& volume, Series& series, const Candidate& candidate, const ReadSettings& settings,
              const core::Progress& progress) {
    Grid whole = candidate.grid;
    core::Vec3 step = candidate.stepMm;
    Window window{{}, whole.size, 1};
    const auto fit = [&] {
        window.by = shrinkingOf(window.count, settings.limitBytes);
        // Of a damaged file there is nothing to shrink.
        (void)checkedBytes(candidate.problem ? window.count : shrunk(window.count, window.by), candidate.where,
                           settings.limitBytes);
    };
    if (!settings.regionMm) fit();
    if (candidate.problem) throw *candidate.problem;
    if (settings.isLabels && candidate.isResampled)
        throw core::Error("its slices lie unevenly, and between numbers of tissues there is nothing", candidate.where,
                          "save the labels with even distances");
    if (settings.spacingMm) {
        for (int i = 0; i < 3; ++i)
            if (!isSpacing((*settings.spacingMm)[i]))
                throw core::Error(fmt::format("a spacing of {} mm cannot be", (*settings.spacingMm)[i]), "spacing",
                                  "give the distance of voxel centres in mm");
        if (!step.isZero()) step *= settings.spacingMm->z() / whole.spacingMm.z();
        whole.spacingMm = *settings.spacingMm;
    } else if (!candidate.spacingProblem.empty()) {
        throw core::Error(fmt::format("the distance of its voxels is not known: {}", candidate.spacingProblem),
                          candidate.where, "give the spacing in mm, for example 0.1")
            .as("no-spacing");
    }
    if (settings.regionMm) {
        window = windowOf(whole, step, *settings.regionMm, candidate.where);
        fit();
    }
    series = describe(candidate, settings.reverseSlices);
    series.isSpacingKnown = true;
    if (window.by > 1) series.notes.push_back(shrinkingText(window.count, window.by, settings.limitBytes));
    Grid& grid = volume.grid;
    grid = whole;
    grid.size = shrunk(window.count, window.by);
    grid.spacingMm *= window.by;
    const core::Vec3 middle =
        core::Vec3(window.first[0], window.first[1], window.first[2]) + core::Vec3::Constant(0.5 * (window.by - 1));
    if (!window.isAll(whole))
        grid.originMm = whole.toMm({middle.x(), middle.y(), step.isZero() ? middle.z() : 0.0}) + step * middle.z();
    step *= window.by;
    Window inFile = window;
    // Which of the file's slices lie there, where they are numbered from the other end.
    if (settings.reverseSlices) inFile.first[2] = whole.size[2] - window.first[2] - grid.size[2] * window.by;
    volume.values.resize(grid.count());
    std::atomic<std::size_t> bad{0};
    const std::size_t each = grid.index(0, 0, 1);
    readWindow(
        candidate, inFile, settings.isLabels,
        [&](int k, const float* slice) {
            std::size_t mine = 0;
            std::transform(slice, slice + each,
                           volume.values.begin() + static_cast<std::ptrdiff_t>(grid.index(0, 0, k)), [&](float value) {
                               if constexpr (std::is_same_v<Block, Labels>)
                                   return labelOf(numberOr0(value, mine), candidate.where);
                               else
                                   return numberOr0(value, mine);
                           });
            bad += mine;
        },
        core::part(progress, 0.0, 0.95));
    if (settings.reverseSlices) reverseSlices(volume);
    if (bad > 0)
        series.notes.push_back(bad == 1 ? std::string("1 value is no number and was read as 0")
                                        : fmt::format("{} values are no numbers and were read as 0", bad.load()));
    makeRightHanded(volume, step);
    straighten(volume, series, step, settings.limitBytes, core::part(progress, 0.95, 1.0));
    series.size = grid.size;
    series.slices = grid.size[2];
    series.spacingMm = grid.spacingMm;
    const auto middleSlice = volume.values.begin() + static_cast<std::ptrdiff_t>(grid.index(0, 0, grid.size[2] / 2));
    const std::vector<float> shown(middleSlice, middleSlice + static_cast<std::ptrdiff_t>(grid.index(0, 0, 1)));
    makeThumbnail(shown.data(), grid.size[0], grid.size[1], series);
    core::report(progress, 1.0);
}

}  // namespace

Scan load(const Candidate& candidate, const ReadSettings& settings, const core::Progress& progress) {
    Scan scan;
    loadInto(scan.volume, scan.series, candidate, settings, progress);
    return scan;
}

Scan readScan(const std::filesystem::path& path, const ReadSettings& settings, const core::Progress& progress) {
    std::vector<Candidate> found = findCandidates(FileSet::open(path), core::part(progress, 0.0, 0.2));
    return load(choose(found, settings, path.string()), settings, core::part(progress, 0.2, 1.0));
}

LabelScan readLabels(const std::filesystem::path& path, ReadSettings settings, const core::Progress& progress) {
    settings.isLabels = true;
    std::vector<Candidate> found = findCandidates(FileSet::open(path), core::part(progress, 0.0, 0.2));
    LabelScan scan;
    loadInto(scan.labels, scan.series, choose(found, settings, path.string()), settings,
             core::part(progress, 0.2, 1.0));
    return scan;
}

Labels toLabels(const Volume& volume, const std::string& where) {
    Labels labels;
    labels.grid = volume.grid;
    labels.values.resize(volume.values.size());
    std::transform(volume.values.begin(), volume.values.end(), labels.values.begin(),
                   [&](float value) { return labelOf(value, where); });
    return labels;
}

}  // namespace handpiece::volume
