// SPDX-License-Identifier: Apache-2.0
// handpiece make scan: a tooth whose truth is known, as a scanner would give it.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "cli/commands.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/scan/phantom/phantom.h"
#include "handpiece/scan/volume/write_scan.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kTruthFile = "truth.json";

struct MakeScanOptions {
    std::string kind = "lower-first-molar", caseFile, out, format = "dicom", scanner = "micro-ct";
    std::size_t faces = 68150, threads = 0;
    std::vector<double> turnDeg{0.0, 0.0, 0.0};
    phantom::Settings settings;
};

Json toJson(const core::Vec3& v) {
    return {v.x(), v.y(), v.z()};
}

Json toJson(const core::Quat& q) {
    return {q.w(), q.x(), q.y(), q.z()};
}

std::string name(std::size_t tissue) {
    return std::string(cases::properties(static_cast<cases::Tissue>(tissue)).name);
}

Json truthOf(const MakeScanOptions& o, const cases::Case& imaged, const phantom::Image& image) {
    const phantom::Settings& s = o.settings;
    Json volumes = Json::object(), greys = Json::object(), labels = Json::object();
    for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
        const auto tissue = static_cast<cases::Tissue>(t);
        const std::string called = t == 0 ? "outside" : name(t);
        greys[called] = phantom::greyOf(s.scanner, tissue);
        labels[called] = phantom::labelOf(tissue);
        if (image.volumesMm3[t] > 0.0) volumes[called] = image.volumesMm3[t];
    }
    const volume::Grid& grid = image.volume.grid;
    return {{"format", 1},
            {"case", imaged.name},
            {"kind", imaged.kind},
            {"settings",
             {{"scanner", phantom::nameOf(s.scanner)},
              {"voxel_um", s.voxelUm},
              {"noise", s.noise},
              {"blur_voxels", s.blurVoxels},
              {"ring", s.ring},
              {"metal", s.metal},
              {"margin_mm", s.marginMm},
              {"scenery", s.scenery},
              {"turn_wxyz", toJson(s.turn)},
              {"seed", s.seed}}},
            {"size", grid.size},
            {"spacing_mm", toJson(grid.spacingMm)},
            {"tooth_in_scan",
             {{"position_mm", toJson(image.toothInScan.positionMm)},
              {"orientation_wxyz", toJson(image.toothInScan.orientation)}}},
            {"volumes_mm3", volumes},
            {"grey_values", greys},
            {"labels", labels}};
}

/// "scan" and "scan/" have "scan-truth" beside them.
fs::path truthBeside(const fs::path& out) {
    const fs::path place = core::wholePath(out).lexically_normal();
    const fs::path folder = place.has_filename() ? place : place.parent_path();
    return folder.parent_path() / (folder.filename().string() + "-truth");
}

void writeTruth(const MakeScanOptions& o, const cases::Case& imaged, const phantom::Image& image,
                const fs::path& folder) {
    core::prepareOutputFolder(folder);
    volume::writeLabels(image.truth, folder / "labels.nrrd");
    cases::writeCase(imaged, folder / "case");
    core::writeFile(folder / kTruthFile, truthOf(o, imaged, image).dump(2) + "\n");
}

/// Scan and truth, both or neither.
void writeBoth(const MakeScanOptions& o, const cases::Case& imaged, const phantom::Image& image,
               volume::ScanFormat format, const core::Progress& progress) {
    const fs::path truth = truthBeside(o.out);
    core::Hasher salt;
    salt.add(truth.string());
    salt.add(fs::file_time_type::clock::now().time_since_epoch().count());
    const fs::path beside = fmt::format("{}.{:x}.part", truth.string(), salt.value());
    std::error_code ec;
    const bool isNew = !fs::exists(o.out, ec);
    try {
        writeTruth(o, imaged, image, beside);
        volume::writeScan(image.volume, o.out, format, progress);
        fs::remove_all(truth);
        fs::rename(beside, truth);
    } catch (const fs::filesystem_error& e) {
        fs::remove_all(beside, ec);
        throw core::Error(fmt::format("cannot be written: {}", e.code().message()), truth.string(),
                          "check the folder, its permissions and the free space")
            .as("not-writable", {e.code().message()});
    } catch (...) {
        fs::remove_all(beside, ec);
        if (isNew) fs::remove(o.out, ec);  // Only when nothing is in it.
        throw;
    }
}

void makeScan(MakeScanOptions& o) {
    if (o.out.empty()) throw core::Error("a scan needs a folder", "--out", "name one");
    const volume::ScanFormat format = volume::scanFormatByName(o.format);
    o.settings.scanner = phantom::scannerByName(o.scanner);
    core::requireReplaceable(truthBeside(o.out), kTruthFile);
    const auto about = [&](std::size_t axis, const core::Vec3& direction) {
        return core::rotationAbout(direction, o.turnDeg[axis] * std::numbers::pi / 180.0);
    };
    o.settings.turn = about(2, core::Vec3::UnitZ()) * about(1, core::Vec3::UnitY()) * about(0, core::Vec3::UnitX());
    phantom::check(o.settings);
    core::setThreadCount(o.threads);

    studies::ProgressBar bar("making the scan");
    const core::Progress progress = bar.listener();
    cases::Case imaged = o.caseFile.empty()
                             ? starter::makeTooth(starter::toothKindByName(o.kind), {o.faces, 0, o.settings.scenery},
                                                  core::part(progress, 0.0, 0.5))
                             : cases::readCase(o.caseFile);
    const double begun = o.caseFile.empty() ? 0.5 : 0.0;
    const phantom::Image image = phantom::image(imaged, o.settings, core::part(progress, begun, 0.85));
    if (image.filling) imaged.parts.push_back(*image.filling);
    writeBoth(o, imaged, image, format, core::part(progress, 0.85, 1.0));
    bar.finish();

    const auto& size = image.volume.grid.size;
    fmt::print("{}: {} of {}, {} x {} x {} voxels of {:g} um, {}\n  truth: {}\n", o.out,
               o.settings.scanner == phantom::Scanner::cbct ? "CBCT" : "micro-CT", imaged.name, size[0], size[1],
               size[2], o.settings.voxelUm, o.format, truthBeside(o.out).string());
    for (std::size_t t = 1; t < cases::kTissueCount; ++t)
        if (image.volumesMm3[t] > 0.0) fmt::print("  {:<12} {:>10.2f} mm3\n", name(t), image.volumesMm3[t]);
}

}  // namespace

void addMakeScanCommand(Command& make) {
    Command scan = make.subcommand("scan", "A tooth as CBCT or micro-CT slices, with the truth beside it");
    const auto options = std::make_shared<MakeScanOptions>();
    MakeScanOptions& o = *options;
    phantom::Settings& s = o.settings;
    scan.option("--out", o.out, "folder to write; the truth goes into OUT-truth").required();
    scan.option("--voxel", s.voxelUm, "edge of a voxel [um]").showDefault();
    scan.option("--format", o.format, "one of: dicom, tiff, bmp, jpeg, png, nrrd, raw, metaimage, nifti").showDefault();
    scan.option("--scanner", o.scanner, "micro-ct (0..65535) or cbct (Hounsfield-like)").showDefault();
    scan.option("--kind", o.kind, "tooth that `make tooth` makes").showDefault();
    scan.option("--faces", o.faces, "triangles of its outer surface").showDefault();
    scan.option("--case", o.caseFile, "instead of --kind: a case folder, .handpiece file or mesh");
    scan.option("--noise", s.noise, "standard deviation, as a share of the step from outside to enamel").showDefault();
    scan.option("--blur", s.blurVoxels, "standard deviation of the point spread [voxels]").showDefault();
    scan.option("--ring", s.ring, "rings about the scan's axis, in the unit of --noise").showDefault();
    scan.option("--metal", s.metal, "puts a filling in, with streaks, in the unit of --noise").showDefault();
    scan.option("--margin", s.marginMm, "air around it [mm]").showDefault();
    scan.flag("--scenery", s.scenery, "adjacent teeth, gingiva and bone too");
    scan.option("--turn", o.turnDeg, "of the tooth in the scanner, about x, then y, then z [degrees]")
        .expected(3)
        .delimiter(',');
    scan.option("--seed", s.seed, "of noise, rings and streaks").showDefault();
    scan.option("--threads", o.threads, "0: all; the scan is the same at any number").showDefault();
    scan.footer(
        "Examples:\n  handpiece make scan --voxel 100 --format dicom --out molar-scan\n"
        "  handpiece make scan --kind upper-incisor --scanner cbct --voxel 200 --format nrrd --metal 0.1 --out "
        "incisor\n"
        "  handpiece make scan --case molar --voxel 50 --format tiff --turn 10,20,30 --out turned");
    scan.callback([options] { makeScan(*options); });
}

}  // namespace handpiece::cli
