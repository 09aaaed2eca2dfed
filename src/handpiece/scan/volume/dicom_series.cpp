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
    double wobble = 0.0;  ///< largest difference of a slice's directions from `axes`
};

/// Some devices round the orientation of each slice anew: these belong together all the same.
constexpr double kWobble = 0.01, kWobbleTold = 1e-3;
/// Slices may lie this far beside their even place, in distances of slices, before they are resampled.
constexpr double kUneven = 0.1;
/// Distances so much larger than the usual one are no uneven slices any more.
constexpr double kWidestGap = 5.0;
/// What is made of uneven slices has at most so many times as many.
constexpr double kMostResampled = 4.0;

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

/// Of slices whose directions are not all the same.
void takeMeanAxes(Group& group) {
    const auto farthest = [&] {
        double most = 0.0;
        for (const Slice& s : group.slices)
            most = std::max(most, (group.axes - *axesOf(s.place)).cwiseAbs().maxCoeff());
        return most;
    };
    if (farthest() == 0.0) return;
    core::Vec3 i = core::Vec3::Zero(), j = core::Vec3::Zero();
    for (const Slice& s : group.slices) {
        const core::Mat3 axes = *axesOf(s.place);
        i += axes.col(0);
        j += axes.col(1);
    }
    group.axes.col(0) = i.normalized();
    group.axes.col(1) = (j - group.axes.col(0) * group.axes.col(0).dot(j)).normalized();
    group.axes.col(2) = group.axes.col(0).cross(group.axes.col(1));
    group.wobble = farthest();
}

std::vector<Group> groupsOf(std::vector<Slice> slices) {
    std::vector<Group> groups;
    for (Slice& s : slices) {
        const std::optional<core::Mat3> axes = axesOf(s.place);
        const auto fits = [&](const Group& g) {
            return g.key == s.header->seriesKey && g.rows == s.header->rows && g.columns == s.header->columns &&
                   g.isPlaced == axes.has_value() && (!axes || (g.axes - *axes).cwiseAbs().maxCoeff() < kWobble);
        };
        // Most slices belong to the group of the slice before.
        auto found = std::find_if(groups.rbegin(), groups.rend(), fits);
        if (found == groups.rend()) {
            groups.push_back({s.header->seriesKey,
                              s.header->rows,
                              s.header->columns,
                              axes.has_value(),
                              axes.value_or(core::Mat3::Identity()),
                              {},
                              0.0});
            found = groups.rbegin();
        }
        found->slices.push_back(std::move(s));
    }
    for (Group& group : groups)
        if (group.isPlaced) takeMeanAxes(group);
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
        if (!c.problem) c.problem = otherGrey();
        sort(c);
        const bool isTurned = !c.problem && first.photometric == "MONOCHROME1" && turnsGreyOver(c);
        addNotes(c);
        const auto stack = std::make_shared<const Stack>(
            Stack{slices, between_, isTurned,
                  static_cast<std::size_t>(first.rows) * static_cast<std::size_t>(first.columns)});
        c.slice = [files = files_, stack](int k, float* to) {
            stack->read(k, to, [&](int n, float* into) {
                Input input = files->open(stack->slices[static_cast<std::size_t>(n)].file);
                stack->readOne(input, n, into);
            });
        };
        if (slices.size() > 1 && slices.front().file == slices.back().file) {
            // All in one file, which may lie packed in a ZIP: opened once.
            c.load = [files = files_, stack](int from, int count, const SlicePlace& place,
                                             const core::Progress& progress) {
                Input input = files->open(stack->slices.front().file);
                for (int k = from; k < from + count; ++k) {
                    stack->read(k, place(k), [&](int n, float* into) { stack->readOne(input, n, into); });
                    core::report(progress, static_cast<double>(k - from + 1) / count);
                }
            };
        }
        return c;
    }

  private:
    /// Of a slice that is made: the one before its place and the share of the next.
    struct Between {
        int slice = 0;
        float share = 0.0f;
    };
    /// What is read of the files, without the files.
    struct Stack {
        std::vector<Slice> slices;
        std::vector<Between> between;  ///< empty: slice by slice as they are
        bool isTurned = false;         ///< low values are bright
        std::size_t pixels = 0;

        void readOne(Input& input, int n, float* to) const {
            const Slice& s = slices[static_cast<std::size_t>(n)];
            readDicomFrame(input, *s.header, s.frame, to);
            if (!isTurned) return;
            const double ends = s.header->isSigned ? -1.0 : std::ldexp(1.0, s.header->stored) - 1.0;  // least and most
            const double slope = s.place.slope.value_or(1.0) == 0.0 ? 1.0 : s.place.slope.value_or(1.0);
            const double sum = slope * ends + 2.0 * s.place.intercept.value_or(0.0);
            for (std::size_t i = 0; i < pixels; ++i)
                to[i] = static_cast<float>(sum - static_cast<double>(to[i]));
        }
        template <class One>
        void read(int k, float* to, const One& one) const {
            if (between.empty()) return one(k, to);
            const Between& at = between[static_cast<std::size_t>(k)];
            one(at.slice, to);
            if (at.share == 0.0f) return;
            std::vector<float> next(pixels);
            one(at.slice + 1, next.data());
            for (std::size_t i = 0; i < pixels; ++i)
                to[i] += at.share * (next[i] - to[i]);
        }
    };

    /// Slices whose grey values have another meaning than those of most.
    std::optional<core::Error> otherGrey() const {
        const std::vector<Slice>& slices = group_.slices;
        const auto odd = [&](const auto& kindOf) -> const Slice* {
            std::map<int, std::size_t> counts;
            for (const Slice& s : slices)
                ++counts[kindOf(*s.header)];
            const auto most = std::max_element(counts.begin(), counts.end(),
                                               [](const auto& a, const auto& b) { return a.second < b.second; });
            const auto found = std::find_if(slices.begin(), slices.end(),
                                            [&](const Slice& s) { return kindOf(*s.header) != most->first; });
            return found == slices.end() ? nullptr : &*found;
        };
        const std::string remedy =
            "put it into a folder of its own, or export the series again with slices of one kind";
        if (const Slice* s = odd([](const DicomHeader& h) { return h.allocated; }))
            return core::Error(
                fmt::format("its values have {} bits, and those of other slices have not", s->header->allocated),
                files_->where(s->file), remedy);
        if (const Slice* s = odd([](const DicomHeader& h) { return h.photometric == "MONOCHROME1" ? 1 : 0; }))
            return core::Error(fmt::format("its low values are meant to be {}, and those of other slices {}",
                                           s->header->photometric == "MONOCHROME1" ? "bright" : "dark",
                                           s->header->photometric == "MONOCHROME1" ? "dark" : "bright"),
                               files_->where(s->file), remedy);
        return {};
    }

    /// Whether a scan that shall be shown with low values bright is turned over: not where its values rise with density
    /// all the same (Hounsfield units), which the outside tells, as it is the least dense.
    bool turnsGreyOver(Candidate& c) const {
        const Slice& middle = group_.slices[group_.slices.size() / 2];
        const auto columns = static_cast<std::size_t>(group_.columns), rows = static_cast<std::size_t>(group_.rows);
        constexpr std::size_t kMostPixels = 1 << 24;
        std::vector<float> values, border;
        try {
            if (columns * rows > kMostPixels) return true;
            values.resize(columns * rows);
            Input input = files_->open(middle.file);
            readDicomFrame(input, *middle.header, middle.frame, values.data());
        } catch (const core::Error&) {
            return true;  // whoever reads it will be told why not
        }
        for (std::size_t y = 0; y < rows; ++y)
            for (std::size_t x = 0; x < columns; ++x)
                if (x == 0 || y == 0 || x + 1 == columns || y + 1 == rows) border.push_back(values[y * columns + x]);
        const auto ranked = [](std::vector<float>& of, double share) {
            const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(of.size() - 1));
            std::nth_element(of.begin(), of.begin() + at, of.end());
            return static_cast<double>(of[static_cast<std::size_t>(at)]);
        };
        const double low = ranked(values, 0.005), high = ranked(values, 0.995), outside = ranked(border, 0.5);
        constexpr double kDark = 0.35;
        const bool isTurned = !(outside < low + kDark * (high - low));
        c.series.notes.push_back(isTurned
                                     ? "low values are meant to be bright (MONOCHROME1): they were turned over"
                                     : "low values are said to be bright (MONOCHROME1), yet the outside is dark: they "
                                       "were left as they are");
        return isTurned;
    }

    /// Slices at uneven distances: where between them even ones are taken from.
    void resample(Candidate& c, double range) {
        const std::vector<Slice>& slices = group_.slices;
        std::vector<double> gaps;
        for (std::size_t i = 1; i < slices.size(); ++i)
            gaps.push_back(slices[i].along - slices[i - 1].along);
        const auto widest = std::max_element(gaps.begin(), gaps.end());
        const double least = *std::min_element(gaps.begin(), gaps.end());
        const std::ptrdiff_t widestAt = widest - gaps.begin();
        const double most = *widest;
        // As fine as the finer of them, and not as two that happen to lie near each other.
        std::sort(gaps.begin(), gaps.end());
        const double fine = gaps[gaps.size() / 10];
        const auto count = static_cast<double>(slices.size());
        const auto made =
            static_cast<int>(std::clamp(std::round(range / fine) + 1.0, count, std::floor(kMostResampled * count)));
        const double stepMm = range / (made - 1);
        constexpr double kSame = 1e-6;
        std::size_t at = 0;
        for (int k = 0; k < made; ++k) {
            const double along = slices.front().along + stepMm * k;
            while (at + 2 < slices.size() && slices[at + 1].along <= along)
                ++at;
            double share = std::clamp((along - slices[at].along) / (slices[at + 1].along - slices[at].along), 0.0, 1.0);
            if (share < kSame) share = 0.0;
            between_.push_back(share > 1.0 - kSame ? Between{static_cast<int>(at) + 1, 0.0f}
                                                   : Between{static_cast<int>(at), static_cast<float>(share)});
        }
        c.grid.size[2] = made;
        c.isResampled = true;
        c.series.notes.push_back(
            fmt::format("its {} slices lie {:.3g} to {:.3g} mm apart, the widest gap behind slice {}: {} slices {:.4g} "
                        "mm apart were made of them",
                        slices.size(), least, most, widestAt + 1, made, stepMm));
    }

    /// Whether the slices' places are not those of even distances.
    bool isUneven(double mean) const {
        const std::vector<Slice>& slices = group_.slices;
        for (std::size_t i = 0; i < slices.size(); ++i)
            if (std::abs(slices[i].along - slices[0].along - mean * static_cast<double>(i)) > kUneven * mean)
                return true;
        return false;
    }

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
        const bool isMeasured = group_.isPlaced || byLocation;
        if (!c.problem) c.problem = wrongOrder(mean, isMeasured);
        if (isMeasured && !c.problem && slices.size() > 2 && isUneven(mean)) resample(c, range);
        const double even = c.grid.size[2] > 1 ? range / (c.grid.size[2] - 1) : 0.0;

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
        if (isMeasured && slices.size() > 1)
            spacing.z() = even;
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
            const core::Vec3 whole = positionOf(slices.back()) - positionOf(slices.front());
            const core::Vec3 step = whole / static_cast<double>(c.grid.size[2] - 1);
            const core::Vec3 beside = step - group_.axes.col(2) * group_.axes.col(2).dot(step);
            if (beside.norm() > 1e-6) c.stepMm = step;
            if (!c.problem && c.spacingProblem.empty()) c.problem = offLine(whole, c.grid.spacingMm);
        }
        if (!group_.isPlaced)
            c.sideProblem = slices[0].header->frames > 1 ? "the file does not tell where its frames lie"
                                                         : "the files do not tell where the slices lie";
        else if (!slices[0].header->frameStep().tellsSide)
            c.sideProblem = "the file does not tell whether its slices are counted upwards or downwards";
    }

    /// Doubled and missing slices. `isMeasured`: they are sorted by millimetres.
    std::optional<core::Error> wrongOrder(double mean, bool isMeasured) const {
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
            if (isMeasured && !isHole(gaps, i, usual)) continue;
            const auto missing = static_cast<int>(std::lround(std::min(gaps[i] / usual, 1e6))) - 1;
            return core::Error(fmt::format("{} slice{} missing: after \"{}\" comes \"{}\"", missing,
                                           missing == 1 ? " is" : "s are", nameOf(slices[i]), nameOf(slices[i + 1])),
                               files_->where(slices[i + 1].file), "copy or export the whole series again");
        }
        for (std::size_t i = 0; i < gaps.size(); ++i)
            if (gaps[i] > kWidestGap * usual)
                return core::Error(fmt::format("its distance to \"{}\" is {:.4g} mm, that of the others {:.4g} mm",
                                               nameOf(slices[i]), gaps[i], usual),
                                   files_->where(slices[i + 1].file), "export the series with even distances");
        return {};
    }

    /// A wide gap in which slices are missing, rather than a scan that is coarser there: a whole number of slices would
    /// fill it, only few such gaps lie in a row, and the slices' numbers, where they count, do not go on over it.
    bool isHole(const std::vector<double>& gaps, std::size_t at, double usual) const {
        constexpr double kWide = 1.5, kWhole = 0.15;
        constexpr std::size_t kFew = 2;
        const double ratio = gaps[at] / usual;
        if (std::abs(ratio - std::round(ratio)) > kWhole) return false;
        const auto isWide = [&](std::size_t i) { return gaps[i] >= kWide * usual; };
        std::size_t row = 1;
        for (std::size_t i = at; i > 0 && isWide(i - 1); --i)
            ++row;
        for (std::size_t i = at + 1; i < gaps.size() && isWide(i); ++i)
            ++row;
        if (row > kFew) return false;
        const Slice &before = group_.slices[at], &behind = group_.slices[at + 1];
        const bool goesOn = before.header->frames == 1 && before.header->instance && behind.header->instance &&
                            std::abs(*behind.header->instance - *before.header->instance) == 1;
        return !goesOn;
    }

    /// Slices that do not lie on the line from the first to the last.
    std::optional<core::Error> offLine(const core::Vec3& whole, const core::Vec3& spacing) const {
        const std::vector<Slice>& slices = group_.slices;
        const double range = slices.back().along - slices.front().along;
        for (const Slice& s : slices) {
            const core::Vec3 off = group_.axes.transpose() * (positionOf(s) - positionOf(slices[0]) -
                                                              whole * ((s.along - slices[0].along) / range));
            if (std::abs(off.x()) > spacing.x() || std::abs(off.y()) > spacing.y())
                return core::Error("this slice lies beside the line of the others", files_->where(s.file),
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
            notes.push_back(
                fmt::format("the file tells the place of its first slice only: the others are taken to follow at the "
                            "distance that it tells ({})",
                            by));
        if (any(&DicomHeader::isLossy)) notes.push_back("the values were compressed with loss");
        if (any(&DicomHeader::isOverview)) notes.push_back("this is an overview picture (localizer)");
        if (group_.wobble > kWobbleTold)
            notes.push_back(fmt::format("the directions of its slices differ by up to {:.1g}: their mean was taken",
                                        group_.wobble));
    }

    const Files& files_;
    Group& group_;
    const std::vector<Group>& all_;
    const Failures& failures_;
    std::vector<Between> between_;
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
    for (Candidate& c : found) {
        if (colour > 0)
            c.series.notes.push_back(
                fmt::format("{} colour picture{} left out", colour, colour == 1 ? " was" : "s were"));
        // A report, or a slice that broke off in its header.
        if (withoutPixels > 0)
            c.series.notes.push_back(fmt::format("{} DICOM file{} left out: no pixels are in {}", withoutPixels,
                                                 withoutPixels == 1 ? " was" : "s were",
                                                 withoutPixels == 1 ? "it" : "them"));
    }
    return found;
}

}  // namespace handpiece::volume
