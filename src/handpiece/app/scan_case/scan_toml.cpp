// SPDX-License-Identifier: Apache-2.0
// A scan's job as a file and back.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "handpiece/app/scan_case/scan_toml.h"
#include "handpiece/base/config/table.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/utf8.h"
#include "handpiece/base/geometry/inspect.h"

namespace handpiece::scan_case {
namespace {

using config::Table;
using core::Vec3;

constexpr std::int64_t kFormat = 1;
constexpr double kMaxMm = 1e4;
constexpr std::uint64_t kMaxJobBytes = 16u << 20;  // marks by hand may be many

std::string quoted(const std::string& text) {
    return nlohmann::json(core::asUtf8(text)).dump();  // TOML's basic strings escape as JSON's do
}

std::string number(double value) {
    std::string text = fmt::format("{}", value);
    if (text.find_first_of(".en") == std::string::npos) text += ".0";
    return text;
}

std::string list(const Vec3& v) {
    return fmt::format("[{}, {}, {}]", number(v.x()), number(v.y()), number(v.z()));
}

/// Lines of "key = value" that leave out what is as by default.
class Lines {
  public:
    void put(std::string_view key, const std::string& value) { text_ += fmt::format("{} = {}\n", key, value); }
    void text(std::string_view key, const std::string& value, const std::string& usual = {}) {
        if (value != usual) put(key, quoted(value));
    }
    void flag(std::string_view key, bool value, bool usual) {
        if (value != usual) put(key, value ? "true" : "false");
    }
    void numberUnless(std::string_view key, double value, double usual) {
        if (value != usual) put(key, number(value));
    }
    void vector(std::string_view key, const std::optional<Vec3>& value) {
        if (value) put(key, list(*value));
    }
    void optional(std::string_view key, const std::optional<double>& value) {
        if (value) put(key, number(*value));
    }
    /// Under a heading, unless there are none.
    [[nodiscard]] std::string under(std::string_view heading) const {
        return text_.empty() ? std::string() : fmt::format("\n{}\n{}", heading, text_);
    }
    [[nodiscard]] const std::string& bare() const { return text_; }

  private:
    std::string text_;
};

std::string segmentationToml(const segmentation::Settings& s) {
    const segmentation::Settings usual;
    Lines lines;
    lines.vector("tooth_at_mm", s.toothAtMm);
    lines.flag("damp", s.damp, usual.damp);
    lines.flag("find_caries", s.findCaries, usual.findCaries);
    lines.numberUnless("spacing_mm", s.spacingMm, usual.spacingMm);
    std::string text = lines.under("[segmentation]");
    if (s.thresholds) {
        const segmentation::Thresholds& t = *s.thresholds;
        Lines values;
        const auto put = [&](std::string_view key, float value) {
            values.put(key, number(static_cast<double>(value)));
        };
        put("outside", t.outside);
        put("pulp", t.pulp);
        put("dentine", t.dentine);
        put("enamel", t.enamel);
        put("tooth_from", t.toothFrom);
        put("enamel_from", t.enamelFrom);
        if (std::isfinite(t.restorationFrom)) put("restoration_from", t.restorationFrom);
        text += values.under("[segmentation.thresholds]");
    }
    for (const segmentation::CutPlane& p : s.cutPlanes)
        text +=
            fmt::format("\n[[segmentation.cut_plane]]\npoint_mm = {}\nnormal = {}\n", list(p.pointMm), list(p.normal));
    for (const segmentation::Mark& m : s.marks)
        text += fmt::format(
            "\n[[segmentation.mark]]\ncentre_mm = {}\nradius_mm = {}\ntissue = {}\n", list(m.centreMm),
            number(m.radiusMm),
            quoted(m.tissue == cases::Tissue::none ? "none" : std::string(cases::properties(m.tissue).name)));
    for (const segmentation::AuthoredLesion& l : s.lesions)
        text += fmt::format("\n[[segmentation.lesion]]\ncentre_mm = {}\nhalf_axes_mm = {}\n", list(l.centreMm),
                            list(l.halfAxesMm));
    return text;
}

// Reading.

double checked(const Table& table, std::string_view key, double value, double low, double high) {
    if (!(value >= low && value <= high))
        table.fail(fmt::format("{} is {}", key, value), fmt::format("give {} to {}", low, high), key);
    return value;
}

void take(const Table& table, std::string_view key, double& value, double low, double high) {
    if (const auto given = table.number(key)) value = checked(table, key, *given, low, high);
}

std::optional<Vec3> vectorOf(const Table& table, std::string_view key) {
    if (!table.has(key)) return {};
    const std::vector<double> v = table.numbers(key);
    if (v.size() != 3) table.fail(fmt::format("{} has {} numbers", key, v.size()), "give three", key);
    for (const double x : v)
        (void)checked(table, key, x, -kMaxMm, kMaxMm);
    return Vec3(v[0], v[1], v[2]);
}

Vec3 vectorNeeded(const Table& table, std::string_view key) {
    const std::optional<Vec3> v = vectorOf(table, key);
    if (!v) table.fail(fmt::format("{} is missing", key), "give three numbers");
    return *v;
}

std::optional<Vec3> directionOf(const Table& table, std::string_view key) {
    const std::optional<Vec3> v = vectorOf(table, key);
    if (v && !(v->norm() > 1e-9)) table.fail(fmt::format("{} is no direction", key), "give one that is not zero", key);
    return v;
}

double numberNeeded(const Table& table, std::string_view key, double low, double high) {
    const std::optional<double> v = table.number(key);
    if (!v) table.fail(fmt::format("{} is missing", key), "add it");
    return checked(table, key, *v, low, high);
}

std::optional<double> optionalNumber(const Table& table, std::string_view key) {
    return table.number(key);
}

segmentation::Thresholds thresholdsOf(const Table& table) {
    table.allowOnly({"outside", "pulp", "dentine", "enamel", "tooth_from", "enamel_from", "restoration_from"});
    segmentation::Thresholds t;
    const auto take = [&](std::string_view key, float& value) {
        value = static_cast<float>(numberNeeded(table, key, -1e9, 1e9));
    };
    take("outside", t.outside);
    take("pulp", t.pulp);
    take("dentine", t.dentine);
    take("enamel", t.enamel);
    take("tooth_from", t.toothFrom);
    take("enamel_from", t.enamelFrom);
    t.restorationFrom =
        static_cast<float>(table.number("restoration_from").value_or(std::numeric_limits<double>::infinity()));
    return t;
}

segmentation::Settings segmentationOf(const Table& table) {
    table.allowOnly({"tooth_at_mm", "damp", "find_caries", "spacing_mm", "thresholds", "cut_plane", "mark", "lesion"});
    segmentation::Settings s;
    s.toothAtMm = vectorOf(table, "tooth_at_mm");
    s.damp = table.flag("damp").value_or(s.damp);
    s.findCaries = table.flag("find_caries").value_or(s.findCaries);
    take(table, "spacing_mm", s.spacingMm, 0.0, 5.0);
    if (const auto thresholds = table.table("thresholds")) s.thresholds = thresholdsOf(*thresholds);
    for (const Table& t : table.tables("cut_plane")) {
        t.allowOnly({"point_mm", "normal"});
        const std::optional<Vec3> normal = directionOf(t, "normal");
        if (!normal) t.fail("normal is missing", "give the direction of what is left out");
        s.cutPlanes.push_back({vectorNeeded(t, "point_mm"), *normal});
    }
    for (const Table& t : table.tables("mark")) {
        t.allowOnly({"centre_mm", "radius_mm", "tissue"});
        const std::string name = t.text("tissue").value_or("none");
        segmentation::Mark mark;
        mark.centreMm = vectorNeeded(t, "centre_mm");
        mark.radiusMm = numberNeeded(t, "radius_mm", 1e-3, 50.0);
        if (name != "none") mark.tissue = cases::tissueByName(name);
        s.marks.push_back(mark);
    }
    for (const Table& t : table.tables("lesion")) {
        t.allowOnly({"centre_mm", "half_axes_mm"});
        const Vec3 half = vectorNeeded(t, "half_axes_mm");
        if (!(half.minCoeff() > 0.0)) t.fail("a half axis is not above zero", "give three lengths", "half_axes_mm");
        s.lesions.push_back({vectorNeeded(t, "centre_mm"), half});
    }
    return s;
}

}  // namespace

std::string readToml(const ScanJob& job) {
    Lines lines;
    lines.text("source", job.source.string());
    lines.text("series", job.series);
    lines.vector("spacing_mm", job.spacingMm);
    lines.flag("reverse_slices", job.reverseSlices, false);
    if (job.regionMm) {
        const auto& [a, b] = *job.regionMm;
        lines.put("region_mm", fmt::format("[{}, {}, {}, {}, {}, {}]", number(a.x()), number(a.y()), number(a.z()),
                                           number(b.x()), number(b.y()), number(b.z())));
    }
    lines.text("grey", job.grey.string());
    lines.flag("labels", job.isLabels, false);
    if (job.labelNumbers)
        lines.text("label_numbers",
                   std::string(segmentation::kLabelNumbers[static_cast<std::size_t>(*job.labelNumbers)]));
    if (!job.labelOrder.empty()) lines.put("label_order", fmt::format("[{}]", fmt::join(job.labelOrder, ", ")));
    return lines.bare();
}

std::string segmentToml(const ScanJob& job) {
    Lines lines;
    lines.optional("tooth_from", job.toothFrom);
    lines.optional("enamel_from", job.enamelFrom);
    return lines.bare() + segmentationToml(job.segmentation);
}

std::string surfaceToml(const ScanJob& job) {
    const ScanJob usual;
    Lines lines;
    lines.text("mesh", job.intraoral.string());
    if (job.intraoralUnit != usual.intraoralUnit) lines.text("unit", job.intraoralUnit);
    lines.numberUnless("reach_mm", job.intraoralReachMm, usual.intraoralReachMm);
    lines.numberUnless("overlap", job.intraoralOverlap, usual.intraoralOverlap);
    if (job.intraoralInScan) {
        const core::Quat& q = job.intraoralInScan->orientation;
        lines.vector("position_mm", job.intraoralInScan->positionMm);
        lines.put("orientation",
                  fmt::format("[{}, {}, {}, {}]", number(q.w()), number(q.x()), number(q.y()), number(q.z())));
    }
    return lines.under("[intraoral]");
}

std::string placeToml(const ScanJob& job) {
    Lines lines;
    lines.vector("occlusal", job.placing.occlusal);
    lines.vector("mesial", job.placing.mesial);
    return lines.under("[placing]");
}

std::string toToml(const ScanJob& job) {
    const ScanJob usual;
    Lines top;
    top.flag("smooth", job.smooth, usual.smooth);
    top.text("name", job.name, usual.name);
    top.text("kind", job.kind);
    if (job.placing.fdiNumber != 0) top.put("fdi", std::to_string(job.placing.fdiNumber));
    top.text("tissues", job.tissuesFile.string());
    top.flag("scenery", job.scenery, usual.scenery);
    top.numberUnless("opening_mm", job.openingMm, usual.openingMm);
    if (job.percents != usual.percents) {
        std::string percents;
        for (const double p : job.percents)
            percents += (percents.empty() ? "" : ", ") + number(p);
        top.put("percents", "[" + percents + "]");
    }
    if (job.faces > 0) top.put("faces", std::to_string(job.faces));
    // Bare keys stand before the first heading.
    const std::string segment = segmentToml(job);
    const std::size_t heading = segment.starts_with('[') ? 0 : segment.find("\n[");
    const std::string bare = segment.substr(0, heading == std::string::npos ? segment.size() : heading);
    return fmt::format(
               "# A scan's way to a case: every decision. handpiece scan case --job FILE repeats it.\nformat = {}\n",
               kFormat) +
           readToml(job) + top.bare() + bare + segment.substr(bare.size()) + surfaceToml(job) + placeToml(job);
}

ScanJob scanJobFromToml(std::string_view text, const std::string& where) {
    const Table table = Table::parse(text, where, kMaxJobBytes);
    if (const std::int64_t format = table.integer("format").value_or(0); format != kFormat)
        table.fail(fmt::format("the job's format is {}, this program reads format {}", format, kFormat),
                   fmt::format("add the line: format = {}", kFormat), "format");
    table.allowOnly({"format",     "source",      "series",        "spacing_mm",  "reverse_slices", "region_mm",
                     "grey",       "labels",      "label_numbers", "label_order", "smooth",         "name",
                     "kind",       "fdi",         "tissues",       "scenery",     "percents",       "faces",
                     "tooth_from", "enamel_from", "segmentation",  "intraoral",   "placing",        "opening_mm"});
    ScanJob job;
    job.source = table.text("source").value_or("");
    job.series = table.text("series").value_or("");
    job.spacingMm = vectorOf(table, "spacing_mm");
    if (job.spacingMm && !(job.spacingMm->minCoeff() > 0.0))
        table.fail("a spacing is not above zero", "give millimetres between voxels", "spacing_mm");
    job.reverseSlices = table.flag("reverse_slices").value_or(false);
    if (table.has("region_mm")) {
        const std::vector<double> v = table.numbers("region_mm");
        if (v.size() != 6)
            table.fail(fmt::format("region_mm has {} numbers", v.size()), "give two corners", "region_mm");
        for (const double x : v)
            (void)checked(table, "region_mm", x, -kMaxMm, kMaxMm);
        job.regionMm = std::array{Vec3(v[0], v[1], v[2]), Vec3(v[3], v[4], v[5])};
    }
    job.grey = table.text("grey").value_or("");
    job.isLabels = table.flag("labels").value_or(false);
    if (const auto numbers = table.text("label_numbers")) job.labelNumbers = segmentation::labelNumbersByName(*numbers);
    for (const double v : table.numbers("label_order")) {
        if (!(v >= 0.0 && v <= 255.0) || v != std::floor(v))
            table.fail("label_order holds what is no whole number from 0 to 255", "give 0 to 7", "label_order");
        job.labelOrder.push_back(static_cast<std::uint8_t>(v));
    }
    job.smooth = table.flag("smooth").value_or(job.smooth);
    job.name = table.text("name").value_or(job.name);
    job.kind = table.text("kind").value_or("");
    job.placing.fdiNumber =
        static_cast<int>(checked(table, "fdi", static_cast<double>(table.integer("fdi").value_or(0)), 0.0, 85.0));
    job.tissuesFile = table.text("tissues").value_or("");
    job.scenery = table.flag("scenery").value_or(false);
    take(table, "opening_mm", job.openingMm, 0.0, dentition::kWidestOpeningMm);
    if (table.has("percents")) {
        job.percents = table.numbers("percents");
        if (job.percents.empty())
            table.fail("no percentage is given", "give one at least, as [100], or leave the line out", "percents");
    }
    for (const double p : job.percents)
        if (!(p > 0.0 && p <= 100.0)) table.fail(fmt::format("{} % is no share", p), "give above 0 to 100", "percents");
    job.faces = static_cast<std::size_t>(
        checked(table, "faces", static_cast<double>(table.integer("faces").value_or(0)), 0.0, 1e8));
    job.toothFrom = optionalNumber(table, "tooth_from");
    job.enamelFrom = optionalNumber(table, "enamel_from");
    if (const auto t = table.table("segmentation")) job.segmentation = segmentationOf(*t);
    if (const auto t = table.table("placing")) {
        t->allowOnly({"occlusal", "mesial"});
        job.placing.occlusal = directionOf(*t, "occlusal");
        job.placing.mesial = directionOf(*t, "mesial");
    }
    if (const auto t = table.table("intraoral")) {
        t->allowOnly({"mesh", "unit", "reach_mm", "overlap", "position_mm", "orientation"});
        job.intraoral = t->text("mesh").value_or("");
        job.intraoralUnit = t->text("unit").value_or("mm");
        if (geometry::unitByName(job.intraoralUnit) == geometry::LengthUnit::unknown)
            t->fail(fmt::format("there is no unit \"{}\"", job.intraoralUnit), "give mm, cm, m, inch or um", "unit");
        take(*t, "reach_mm", job.intraoralReachMm, 0.01, 2.0);
        take(*t, "overlap", job.intraoralOverlap, 0.01, 1.0);
        if (t->has("position_mm") || t->has("orientation")) {
            const std::vector<double> q = t->numbers("orientation");
            core::Pose pose;
            pose.positionMm = vectorNeeded(*t, "position_mm");
            if (q.size() == 4) pose.orientation = core::Quat(q[0], q[1], q[2], q[3]);
            if (q.size() != 4 || !(pose.orientation.norm() > 0.1))
                t->fail("orientation is no quaternion", "give w, x, y, z", "orientation");
            pose.orientation.normalize();
            job.intraoralInScan = pose;
        }
    }
    return job;
}

ScanJob readScanJob(const std::filesystem::path& file) {
    const std::vector<std::byte> bytes = core::readFile(file, kMaxJobBytes);
    return scanJobFromToml({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
}

void writeScanJob(const ScanJob& job, const std::filesystem::path& file) {
    for (const std::string& named :
         {job.source.string(), job.intraoral.string(), job.tissuesFile.string(), job.name, job.kind, job.series})
        if (core::utf8Prefix(named) != named.size())
            throw core::Error("a name of this job cannot be kept in its file: it is no UTF-8", file.string(),
                              "rename the file or folder, or do without the job's file");
    // It names the folder of a patient.
    core::writeFile(file, toToml(job), {.ownerOnly = true});
}

}  // namespace handpiece::scan_case
