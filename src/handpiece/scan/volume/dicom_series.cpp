// SPDX-License-Identifier: Apache-2.0
// DICOM files sorted into series, and their frames along the normal: names and numbers do not tell the order.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>

#include "handpiece/base/core/parallel.h"
#include "handpiece/scan/volume/candidate.h"
#include "handpiece/scan/volume/dicom_header.h"
#include "handpiece/scan/volume/header_text.h"

namespace handpiece::volume {
namespace {

using Header = std::shared_ptr<const DicomHeader>;

/// One frame of one file.
struct Slice {
    std::size_t file = 0;
    int frame = 0;
    Header header;
    DicomPlace place;
    double along = 0.0;  ///< what it is sorted by
};

struct Group {
    std::uint64_t key = 0;
    int rows = 0, columns = 0;
    bool isPlaced = false;
    core::Mat3 axes = core::Mat3::Identity();
    std::vector<Slice> slices;
};

/// Directions of columns, rows and slices, where the file tells two good ones.
std::optional<core::Mat3> axesOf(const DicomPlace& place) {
    if (!place.orientation || !place.positionMm) return {};
    const auto& o = *place.orientation;
    core::Vec3 i(o[0], o[1], o[2]), j(o[3], o[4], o[5]);
    if (std::abs(i.norm() - 1.0) > 0.01 || std::abs(j.norm() - 1.0) > 0.01 || std::abs(i.dot(j)) > 0.01) return {};
    core::Mat3 axes;
    axes.col(0) = i.normalized();
    axes.col(1) = (j - axes.col(0) * axes.col(0).dot(j)).normalized();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return axes;
}

core::Vec3 positionOf(const Slice& s) {
    const auto& p = *s.place.positionMm;
    return {p[0], p[1], p[2]};
}

std::vector<Group> groupsOf(std::vector<Slice> slices) {
    std::vector<Group> groups;
    for (Slice& s : slices) {
        const std::optional<core::Mat3> axes = axesOf(s.place);
        const auto fits = [&](const Group& g) {
            return g.key == s.header->seriesKey && g.rows == s.header->rows && g.columns == s.header->columns &&
                   g.isPlaced == axes.has_value() && (!axes || (g.axes - *axes).cwiseAbs().maxCoeff() < 1e-3);
        };
        // Most slices belong to the group of the slice before.
        auto found = std::find_if(groups.rbegin(), groups.rend(), fits);
        if (found == groups.rend()) {
            groups.push_back({s.header->seriesKey,
                              s.header->rows,
                              s.header->columns,
                              axes.has_value(),
                              axes.value_or(core::Mat3::Identity()),
                              {}});
            found = groups.rbegin();
        }
        found->slices.push_back(std::move(s));
    }
    return groups;
}

class Assembly {
  public:
    Assembly(const Files& files, Group& group, const std::vector<Group>& all, const Failures& failures)
        : files_(files), group_(group), all_(all), failures_(failures) {}

    Candidate make() {
        Candidate c;
        std::vector<Slice>& slices = group_.slices;
        const DicomHeader& first = *slices[0].header;
        c.where = files_->where(slices[0].file);
        c.series.format = "DICOM";
        c.series.modality = first.modality;
        c.series.bits = first.allocated;
        c.grid.size = {first.columns, first.rows, static_cast<int>(slices.size())};
        for (const Slice& s : slices)
            if (const auto why = unreadable(*s.header); why && !c.problem)
                c.problem = core::Error(why->first, files_->where(s.file), why->second);
        sort(c);
        addNotes(c);
        const auto shared = std::make_shared<const std::vector<Slice>>(slices);
        c.slice = [files = files_, shared](int k, float* to) {
            const Slice& s = (*shared)[static_cast<std::size_t>(k)];
            Input input = files->open(s.file);
            readDicomFrame(input, *s.header, s.frame, to);
        };
        if (slices.size() > 1 && slices.front().file == slices.back().file) {
            // All in one file, which may lie packed in a ZIP: opened once.
            c.load = [files = files_, shared](float* to, const core::Progress& progress) {
                Input input = files->open(shared->front().file);
                const DicomHeader& h = *shared->front().header;
                const std::size_t each = static_cast<std::size_t>(h.rows) * static_cast<std::size_t>(h.columns);
                for (std::size_t k = 0; k < shared->size(); ++k) {
                    readDicomFrame(input, h, (*shared)[k].frame, to + k * each);
                    core::report(progress, static_cast<double>(k + 1) / static_cast<double>(shared->size()));
                }
            };
        }
        return c;
    }

  private:
    std::string nameOf(const Slice& s) const {
        const std::string& name = files_->entries()[s.file].name;
        return s.header->frames > 1 ? fmt::format("frame {}", s.frame + 1) : name.substr(folderOf(name).size());
    }

    void sort(Candidate& c) {
        std::vector<Slice>& slices = group_.slices;
        const auto have = [&](auto get) {
            return std::all_of(slices.begin(), slices.end(), [&](const Slice& s) { return get(s).has_value(); });
        };
        const bool byLocation = !group_.isPlaced && slices.size() > 1 &&
                                have([](const Slice& s) { return s.place.locationMm; }) &&
                                slices[0].header->frames == 1;
        const bool byNumber = !group_.isPlaced && !byLocation && slices[0].header->frames == 1 &&
                              have([](const Slice& s) { return s.header->instance; });
        for (std::size_t i = 0; i < slices.size(); ++i) {
            Slice& s = slices[i];
            s.along = group_.isPlaced ? group_.axes.col(2).dot(positionOf(s))
                      : byLocation    ? *s.place.locationMm
                      : byNumber      ? *s.header->instance
                                      : static_cast<double>(i);
        }
        std::stable_sort(slices.begin(), slices.end(),
                         [](const Slice& a, const Slice& b) { return a.along < b.along; });
        const double range = slices.back().along - slices.front().along;
        const double mean = slices.size() > 1 ? range / static_cast<double>(slices.size() - 1) : 0.0;
        if (!c.problem) c.problem = wrongOrder(mean);

        const DicomPlace& place = slices[0].place;
        core::Vec3 spacing = core::Vec3::Zero();
        if (place.spacingMm) spacing = {(*place.spacingMm)[1], (*place.spacingMm)[0], 0.0};
        for (const Slice& s : slices)
            if (!c.problem && s.place.spacingMm && place.spacingMm &&
                (std::abs((*s.place.spacingMm)[0] - (*place.spacingMm)[0]) > 1e-3 * std::abs((*place.spacingMm)[0]) ||
                 std::abs((*s.place.spacingMm)[1] - (*place.spacingMm)[1]) > 1e-3 * std::abs((*place.spacingMm)[1])))
                c.problem = core::Error("its pixels are larger or smaller than those of other slices",
                                        files_->where(s.file), "put it into a folder of its own");
        c.grid.axes = group_.axes;
        if (group_.isPlaced) c.grid.originMm = positionOf(slices[0]);
        if ((group_.isPlaced || byLocation) && slices.size() > 1)
            spacing.z() = mean;
        else
            spacing.z() = place.betweenMm.value_or(slices.size() == 1 ? place.thicknessMm.value_or(0.0) : 0.0);
        if (!place.spacingMm) {
            c.spacingProblem = "the files tell no pixel spacing";
            if (isSpacing(spacing.z())) c.grid.spacingMm.z() = spacing.z();
        } else if (spacing.z() == 0.0 && isSpacing(spacing.x()) && isSpacing(spacing.y())) {
            c.spacingProblem = "the files do not tell the distance of the slices";
            c.grid.spacingMm.head<2>() = spacing.head<2>();
        } else {
            setSpacing(c, spacing);
        }
        if (group_.isPlaced && slices.size() > 1) {
            const core::Vec3 step =
                (positionOf(slices.back()) - positionOf(slices.front())) / static_cast<double>(slices.size() - 1);
            const core::Vec3 beside = step - group_.axes.col(2) * group_.axes.col(2).dot(step);
            if (beside.norm() > 1e-6) c.stepMm = step;
            if (!c.problem && c.spacingProblem.empty()) c.problem = offLine(step, c.grid.spacingMm);
        }
        if (byLocation || byNumber)
            c.series.notes.push_back("the files do not tell where the slices lie: left and right may be swapped");
    }

    /// Doubled and missing slices.
    std::optional<core::Error> wrongOrder(double mean) const {
        const std::vector<Slice>& slices = group_.slices;
        if (slices.size() < 2) return {};
        std::vector<double> gaps;
        for (std::size_t i = 1; i < slices.size(); ++i)
            gaps.push_back(slices[i].along - slices[i - 1].along);
        for (std::size_t i = 0; i < gaps.size(); ++i)
            if (gaps[i] <= std::max(1e-6, 0.02 * mean))
                return core::Error(
                    fmt::format("two slices lie at the same place: this one and \"{}\"", nameOf(slices[i])),
                    files_->where(slices[i + 1].file),
                    "remove one of the two, or put the two scans into folders of their own");
        std::vector<double> sorted = gaps;
        std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
        const double usual = sorted[sorted.size() / 2];
        for (std::size_t i = 0; i < gaps.size(); ++i) {
            if (gaps[i] < 1.5 * usual) continue;
            // What stands in the gap with another size, or could not be read?
            for (const Group& other : all_)
                if (other.key == group_.key && (other.rows != group_.rows || other.columns != group_.columns))
                    for (const Slice& s : other.slices)
                        if (const double at =
                                s.place.positionMm ? group_.axes.col(2).dot(positionOf(s)) : slices[i].along - 1;
                            group_.isPlaced && at > slices[i].along && at < slices[i + 1].along)
                            return core::Error(
                                fmt::format("the slices have different sizes: {} of them {} x {}, this one {} x {}",
                                            slices.size(), group_.columns, group_.rows, other.columns, other.rows),
                                files_->where(s.file), "export the series again with slices of one size");
            if (!failures_.empty()) return failures_.front();
            const auto missing = static_cast<int>(std::lround(std::min(gaps[i] / usual, 1e6))) - 1;
            return core::Error(fmt::format("{} slice{} missing: after \"{}\" comes \"{}\"", missing,
                                           missing == 1 ? " is" : "s are", nameOf(slices[i]), nameOf(slices[i + 1])),
                               files_->where(slices[i + 1].file), "copy or export the whole series again");
        }
        for (std::size_t i = 0; i < gaps.size(); ++i)
            if (std::abs(gaps[i] - usual) > 0.2 * usual)
                return core::Error(fmt::format("its distance to \"{}\" is {:.4g} mm, that of the others {:.4g} mm",
                                               nameOf(slices[i]), gaps[i], usual),
                                   files_->where(slices[i + 1].file), "export the series with even distances");
        return {};
    }

    /// Slices that do not lie on one line.
    std::optional<core::Error> offLine(const core::Vec3& step, const core::Vec3& spacing) const {
        const std::vector<Slice>& slices = group_.slices;
        for (std::size_t k = 0; k < slices.size(); ++k) {
            const core::Vec3 off = group_.axes.transpose() *
                                   (positionOf(slices[k]) - positionOf(slices[0]) - step * static_cast<double>(k));
            if (std::abs(off.x()) > spacing.x() || std::abs(off.y()) > spacing.y() ||
                std::abs(off.z()) > 0.5 * spacing.z())
                return core::Error("this slice lies beside the line of the others", files_->where(slices[k].file),
                                   "export the series again from where it was made");
        }
        return {};
    }

    void addNotes(Candidate& c) const {
        const auto any = [&](bool DicomHeader::*what) {
            return std::any_of(group_.slices.begin(), group_.slices.end(),
                               [&](const Slice& s) { return (*s.header).*what; });
        };
        std::vector<std::string>& notes = c.series.notes;
        if (any(&DicomHeader::hasBurnedInText))
            notes.push_back(
                "the pictures may hold text that names the patient (burned-in annotation): look at every slice");
        if (any(&DicomHeader::isSecondaryCapture))
            notes.push_back(
                "these are pictures of a screen or a film (secondary capture): grey values and burned-in text cannot "
                "be trusted");
        if (const char* by = group_.slices[0].header->frameStep().by)
            notes.push_back(fmt::format("all its slices have one place: they are taken to lie as its {} says", by));
        if (any(&DicomHeader::isLossy)) notes.push_back("the values were compressed with loss");
        if (any(&DicomHeader::isOverview)) notes.push_back("this is an overview picture (localizer)");
        if (group_.slices[0].header->photometric == "MONOCHROME1") notes.push_back("low values are meant to be bright");
    }

    const Files& files_;
    Group& group_;
    const std::vector<Group>& all_;
    const Failures& failures_;
};

}  // namespace

std::vector<std::size_t> listedFiles(const FileSet& files, std::size_t dicomdir, int& missing) {
    Input input = files.open(dicomdir);
    const DicomHeader header = readDicomHeader(input);
    std::map<std::string, std::size_t> byName;
    for (std::size_t i = 0; i < files.entries().size(); ++i)
        byName[lowered(files.entries()[i].name)] = i;
    std::vector<std::size_t> found;
    const std::string folder(folderOf(files.entries()[dicomdir].name));
    for (std::string name : header.files) {
        std::replace(name.begin(), name.end(), '\\', '/');
        const auto at = byName.find(lowered(folder + name));
        if (at == byName.end())
            ++missing;
        else
            found.push_back(at->second);
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

std::vector<Candidate> findDicom(const Files& files, const std::vector<std::size_t>& which, Failures& failures,
                                 const core::Progress& progress) {
    std::vector<Header> headers(which.size());
    std::vector<std::optional<core::Error>> wrong(which.size());
    std::atomic<std::size_t> done{0};
    core::parallelFor(which.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            try {
                Input input = files->open(which[i]);
                headers[i] = std::make_shared<const DicomHeader>(readDicomHeader(input));
            } catch (const core::Error& e) {
                wrong[i] = e;
            }
            core::report(progress, static_cast<double>(++done) / static_cast<double>(which.size()));
        }
    });
    std::vector<Slice> slices;
    int withoutPixels = 0, colour = 0;
    for (std::size_t i = 0; i < which.size(); ++i) {
        if (wrong[i]) {
            failures.push_back(*wrong[i]);
            continue;
        }
        const DicomHeader& h = *headers[i];
        if (h.isFloat) {
            failures.push_back(core::Error("its values are floating-point pixels, which are not read",
                                           files->where(which[i]), "export it with whole numbers"));
        } else if (!h.hasPixels) {
            ++withoutPixels;
        } else if (h.samplesPerPixel != 1 || h.photometric == "PALETTE COLOR") {
            ++colour;
        } else {
            // What cannot be read is told of once: the number of its frames is only a claim.
            const int frames = unreadable(h) ? 1 : h.frames;
            for (int frame = 0; frame < frames; ++frame)
                slices.push_back({which[i], frame, headers[i], h.placeOf(frame), 0.0});
        }
    }
    std::vector<Candidate> found;
    std::vector<Group> groups = groupsOf(std::move(slices));
    for (Group& group : groups)
        found.push_back(Assembly(files, group, groups, failures).make());
    if (found.empty() && failures.empty())
        failures.push_back(
            core::Error(fmt::format("no scan is in it: {} DICOM file{} without pixels, {} with colour pictures",
                                    withoutPixels, withoutPixels == 1 ? "" : "s", colour),
                        files->where(), "name the folder with the slices of the scan")
                .as("no-scan", {"DICOM"}));
    if (colour > 0)
        for (Candidate& c : found)
            c.series.notes.push_back(
                fmt::format("{} colour picture{} left out", colour, colour == 1 ? " was" : "s were"));
    return found;
}

}  // namespace handpiece::volume
