// SPDX-License-Identifier: Apache-2.0
// scan_accuracy: the starter teeth imaged by the phantom scanner, found again, and compared with what they were:
// overlap, surfaces, volumes, time. `scan_accuracy --help` names the options. With --real: the teeth of a folder of
// real scans.
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/starter/starter.h"
#include "scan_pictures.h"
#include "scan_real.h"
#include "scan_truth.h"

namespace handpiece::bench {
namespace {

using cases::Tissue;
using nlohmann::json;

constexpr const char* kHelp =
    "scan_accuracy [--voxel UM,UM...] [--kind molar,premolar,incisor] [--scanner micro-ct,cbct]\n"
    "  [--noise X] [--blur X] [--ring X] [--metal X] [--scenery] [--turned] [--seed N]   as `handpiece make scan`\n"
    "  [--labels]        the truth's labels instead of grey values\n"
    "  [--segment-only]  without making surfaces\n"
    "  [--spacing MM]    of the result\n"
    "  [--pictures DIR]  slices with truth (green) and found (red) outlines\n"
    "  [--json FILE] [--threads N] [--faces N]\n"
    "scan_accuracy --real FOLDER [--pictures DIR]   the teeth of ../shared/data\n";

struct Options {
    std::vector<double> voxelsUm = {50, 100, 200};
    std::vector<std::string> kinds = {"molar"};
    std::vector<std::string> scanners = {"micro-ct"};
    phantom::Settings settings;
    segmentation::Settings segmentation;
    bool labels = false, segmentOnly = false, turned = false;
    std::size_t faces = 68151;
    std::string pictures, jsonFile, real;
};

std::vector<std::string> splitAtCommas(const std::string& text) {
    std::vector<std::string> parts(1);
    for (const char c : text)
        if (c == ',')
            parts.emplace_back();
        else
            parts.back() += c;
    return parts;
}

starter::ToothKind kindByShortName(const std::string& name) {
    if (name == "molar") return starter::ToothKind::lowerFirstMolar;
    if (name == "premolar") return starter::ToothKind::upperPremolar;
    if (name == "incisor") return starter::ToothKind::upperIncisor;
    return starter::toothKindByName(name);
}

Options parsed(int argc, char** argv) {
    Options o;
    for (int n = 1; n < argc; ++n) {
        const std::string_view option = argv[n];
        const auto value = [&]() -> std::string {
            if (n + 1 >= argc) throw core::Error("a value is missing", std::string(option), "see --help");
            return argv[++n];
        };
        const auto number = [&] { return std::strtod(value().c_str(), nullptr); };
        if (option == "--voxel") {
            o.voxelsUm.clear();
            for (const std::string& v : splitAtCommas(value()))
                o.voxelsUm.push_back(std::strtod(v.c_str(), nullptr));
        } else if (option == "--kind") {
            o.kinds = splitAtCommas(value());
        } else if (option == "--scanner") {
            o.scanners = splitAtCommas(value());
        } else if (option == "--noise") {
            o.settings.noise = number();
        } else if (option == "--blur") {
            o.settings.blurVoxels = number();
        } else if (option == "--ring") {
            o.settings.ring = number();
        } else if (option == "--metal") {
            o.settings.metal = number();
        } else if (option == "--scenery") {
            o.settings.scenery = true;
        } else if (option == "--turned") {
            o.turned = true;
        } else if (option == "--seed") {
            o.settings.seed = static_cast<std::uint64_t>(number());
        } else if (option == "--spacing") {
            o.segmentation.spacingMm = number();
        } else if (option == "--faces") {
            o.faces = static_cast<std::size_t>(number());
        } else if (option == "--labels") {
            o.labels = true;
        } else if (option == "--segment-only") {
            o.segmentOnly = true;
        } else if (option == "--pictures") {
            o.pictures = value();
        } else if (option == "--json") {
            o.jsonFile = value();
        } else if (option == "--threads") {
            core::setThreadCount(static_cast<std::size_t>(number()));
        } else if (option == "--real") {
            o.real = value();
        } else if (option == "--help") {
            fmt::print("{}", kHelp);
            std::exit(0);
        } else {
            throw core::Error("this option is not known", std::string(option), "see --help");
        }
    }
    return o;
}

/// Time, processor time and peak memory of a piece of work.
class Cost {
  public:
    Cost() : begin_(std::chrono::steady_clock::now()), cpu_(cpuS()) {
        std::ofstream("/proc/self/clear_refs") << "5";  // Forgets the peak so far.
    }
    [[nodiscard]] json told() const {
        const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
        return {{"s", s}, {"cpu_s", cpuS() - cpu_}, {"peak_mb", peakMb()}};
    }

  private:
    static double cpuS() {
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        const auto seconds = [](const timeval& t) {
            return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
        };
        return seconds(usage.ru_utime) + seconds(usage.ru_stime);
    }
    static double peakMb() {
        std::ifstream status("/proc/self/status");
        for (std::string line; std::getline(status, line);)
            if (line.rfind("VmHWM:", 0) == 0) return std::strtod(line.c_str() + 6, nullptr) / 1024.0;
        return 0.0;
    }
    std::chrono::steady_clock::time_point begin_;
    double cpu_;
};

/// Made once and kept: made again when this program is newer.
cases::Case starterTooth(const std::string& kind, std::size_t faces, bool scenery) {
    namespace fs = std::filesystem;
    const fs::path file =
        fs::path(HANDPIECE_BENCH_CACHE) / fmt::format("case-{}-{}{}.handpiece", kind, faces, scenery ? "-scene" : "");
    std::error_code none;
    if (!fs::exists(file) || fs::last_write_time(file) < fs::last_write_time("/proc/self/exe", none)) {
        fs::create_directories(file.parent_path());
        fmt::print(stderr, "scan_accuracy: making {}\n", file.string());
        cases::writeCase(starter::makeTooth(kindByShortName(kind), {faces, 0, scenery}), file);
    }
    return cases::readCase(file);
}

void tellCost(const char* what, const json& cost) {
    fmt::print("  {:<10} {:7.2f} s {:7.2f} cpu s {:7.0f} MB\n", what, cost["s"].get<double>(),
               cost["cpu_s"].get<double>(), cost["peak_mb"].get<double>());
}

/// Prints a row a solid; distances in voxels of the scan.
json tellErrors(const char* of, const std::array<std::optional<SolidErrors>, kSolidKinds.size()>& errors,
                double voxelMm) {
    json all = json::object();
    fmt::print("  {:<9} {:<8} | true > found: median   p95   max   bias | found > true: median   p95   max  [voxels]\n",
               of, "solid");
    for (const SolidKind kind : kSolidKinds) {
        const auto& e = errors.at(static_cast<std::size_t>(kind));
        if (!e) {
            fmt::print("  {:<9} {:<8} | not there\n", of, nameOf(kind));
            continue;
        }
        const auto& [truth, found] = *e;
        fmt::print("  {:<9} {:<8} | {:20.3f} {:5.2f} {:5.1f} {:+6.3f} | {:20.3f} {:5.2f} {:5.1f}\n", of, nameOf(kind),
                   truth.medianMm / voxelMm, truth.p95Mm / voxelMm, truth.worstMm / voxelMm, truth.biasMm / voxelMm,
                   found.medianMm / voxelMm, found.p95Mm / voxelMm, found.worstMm / voxelMm);
        const auto toldError = [&](const SurfaceError& s) {
            return json{{"points", s.points},
                        {"median_voxels", s.medianMm / voxelMm},
                        {"p95_voxels", s.p95Mm / voxelMm},
                        {"max_voxels", s.worstMm / voxelMm},
                        {"bias_voxels", s.biasMm / voxelMm}};
        };
        all[nameOf(kind)] = {{"true_to_found", toldError(truth)}, {"found_to_true", toldError(found)}};
    }
    return all;
}

json tellVolumes(const char* of, const std::array<double, cases::kTissueCount>& truth,
                 const std::array<double, cases::kTissueCount>& found,
                 const std::array<double, cases::kTissueCount>* dice) {
    json all = json::object();
    for (std::size_t t = 1; t < truth.size(); ++t) {
        if (truth[t] == 0.0 && found[t] == 0.0) continue;
        const auto name = cases::properties(static_cast<Tissue>(t)).name;
        const double percent = truth[t] > 0.0 ? 100.0 * (found[t] / truth[t] - 1.0) : 100.0;
        fmt::print("  {:<9} {:<11} true {:8.2f} mm3  found {:8.2f} mm3  {:+7.2f} %", of, name, truth[t], found[t],
                   percent);
        json& own = all[std::string(name)] = {{"true_mm3", truth[t]}, {"found_mm3", found[t]}, {"percent", percent}};
        if (dice != nullptr) {
            fmt::print("  Dice {:.4f}", (*dice)[t]);
            own["dice"] = (*dice)[t];
        }
        fmt::print("\n");
    }
    return all;
}

/// Where a person would click: dentine (never the pulp) nearest to the middle of the crown.
core::Vec3 inCrown(const phantom::Image& image) {
    const volume::Grid& grid = image.truth.grid;
    const core::Vec3 middle = image.toothInScan.apply(core::Vec3(0.0, 0.0, 3.0));
    core::Vec3 best = middle;
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < grid.size[2]; ++k)
        for (int j = 0; j < grid.size[1]; ++j)
            for (int i = 0; i < grid.size[0]; ++i) {
                if (image.truth.values[grid.index(i, j, k)] != phantom::labelOf(Tissue::dentine)) continue;
                const core::Vec3 p = grid.toMm(core::Vec3(i, j, k));
                if ((p - middle).squaredNorm() >= nearest) continue;
                nearest = (p - middle).squaredNorm();
                best = p;
            }
    return best;
}

json measure(const Options& o, const std::string& kind, const std::string& scanner, double voxelUm) {
    phantom::Settings settings = o.settings;
    settings.scanner = phantom::scannerByName(scanner);
    settings.voxelUm = voxelUm;
    if (o.turned) settings.turn = core::Quat(Eigen::AngleAxisd(0.5, core::Vec3(1.0, 2.0, 3.0).normalized()));
    const cases::Case made = starterTooth(kind, o.faces, settings.scenery);
    const Cost imaging;
    const phantom::Image image = phantom::image(made, settings);
    const auto& size = image.volume.grid.size;
    fmt::print("{} {} {:g} um: {}x{}x{}, noise {:g}, blur {:g}{}{}{}\n", kind, scanner, voxelUm, size[0], size[1],
               size[2], settings.noise, settings.blurVoxels, settings.scenery ? ", scenery" : "",
               settings.metal > 0.0 ? ", metal" : "", o.labels ? ", from labels" : "");
    json row = {{"kind", kind},
                {"scanner", scanner},
                {"voxel_um", voxelUm},
                {"noise", settings.noise},
                {"blur_voxels", settings.blurVoxels},
                {"ring", settings.ring},
                {"metal", settings.metal},
                {"scenery", settings.scenery},
                {"turned", o.turned},
                {"labels", o.labels},
                {"seed", settings.seed},
                {"size", size},
                {"image", imaging.told()}};
    tellCost("image", row["image"]);
    segmentation::Settings wanted = o.segmentation;
    if (settings.scenery) wanted.toothAtMm = inCrown(image);
    const Cost segmenting;
    const segmentation::Region region =
        o.labels ? segmentation::segmentLabels(image.truth, wanted) : segmentation::segment(image.volume, wanted);
    row["segment"] = segmenting.told();
    tellCost("segment", row["segment"]);
    const segmentation::Thresholds& t = region.thresholds;
    fmt::print(
        "  peaks: outside {:g} pulp {:g} dentine {:g} enamel {:g}; tooth from {:g}, enamel from {:g}; blur "
        "{:.3f} mm, noise {:g}\n",
        t.outside, t.pulp, t.dentine, t.enamel, t.toothFrom, t.enamelFrom, region.blurMm, region.noise);
    for (const std::string& note : region.notes)
        fmt::print("  note: {}\n", note);

    const ToothTruth truth(made, image);
    const double voxelMm = voxelUm / 1000.0;
    const auto dice = truth.dice(region);
    row["tissues"] = tellVolumes("segment", image.volumesMm3, segmentation::volumesMm3(region), &dice);
    row["segment_surfaces"] = tellErrors("segment", truth.errors(surfacesOf(region)), voxelMm);
    if (!o.pictures.empty())
        writePictures(o.pictures, fmt::format("{}-{}-{:g}", kind, scanner, voxelUm), image.volume, &image.truth,
                      region);
    if (!o.segmentOnly) {
        const Cost making;
        const surfacing::Surfaces surfaces = surfacing::makeSurfaces(region);
        row["surfacing"] = making.told();
        tellCost("surfaces", row["surfacing"]);
        row["surface_tissues"] = tellVolumes("surfaces", image.volumesMm3, volumesOf(surfaces), nullptr);
        row["surfaces"] = tellErrors("surfaces", truth.errors(surfacesOf(surfaces)), voxelMm);
    }
    fmt::print("\n");
    std::fflush(stdout);
    return row;
}

int run(int argc, char** argv) {
    const Options o = parsed(argc, argv);
    if (!o.real.empty()) {
        measureReal(o.real, o.pictures, o.segmentOnly);
        return 0;
    }
    json rows = json::array();
    for (const std::string& kind : o.kinds)
        for (const std::string& scanner : o.scanners)
            for (const double voxelUm : o.voxelsUm)
                rows.push_back(measure(o, kind, scanner, voxelUm));
    if (!o.jsonFile.empty()) core::writeFile(o.jsonFile, rows.dump(2) + "\n");
    return 0;
}

}  // namespace
}  // namespace handpiece::bench

int main(int argc, char** argv) {
    try {
        return handpiece::bench::run(argc, argv);
    } catch (const handpiece::core::Error& error) {
        fmt::print(stderr, "scan_accuracy: {}\n", error.what());
        return 1;
    }
}
