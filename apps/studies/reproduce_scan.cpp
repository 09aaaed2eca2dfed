// SPDX-License-Identifier: Apache-2.0
// Table II once more, from slices: the paper's teeth came out of a scanner, so do these.
#include <fmt/format.h>

#include <chrono>
#include <limits>

#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/starter/paper.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/scan/phantom/phantom.h"
#include "handpiece/scan/segmentation/segment.h"
#include "handpiece/scan/surfacing/surfaces.h"
#include "handpiece/scan/volume/read_scan.h"
#include "studies/reproduce.h"

namespace handpiece::studies {
namespace {

/// Of the starter tooth, when no scan is given.
constexpr double kVoxelUm = 100.0, kQuickVoxelUm = 200.0;

struct Slices {
    segmentation::Region region;
    std::string what;
};

Slices segmented(const Reproduction& r) {
    const ScanSource& source = r.scan;
    if (source.path.empty()) {
        phantom::Settings settings;
        settings.voxelUm = r.quick ? kQuickVoxelUm : kVoxelUm;
        const phantom::Image image = phantom::image(starter::makeTooth(starter::ToothKind::lowerFirstMolar), settings);
        return {
            segmentation::segment(image.volume),
            fmt::format("the starter molar, imaged by the phantom scanner with voxels of {:.0f} um", settings.voxelUm)};
    }
    volume::ReadSettings settings;
    settings.takeLargest = true;
    if (source.spacingMm) settings.spacingMm = core::Vec3::Constant(*source.spacingMm);
    const volume::Scan scan = volume::readScan(source.path, settings);
    return {source.labels ? segmentation::segmentLabels(volume::toLabels(scan.volume, source.path.string()))
                          : segmentation::segment(scan.volume),
            fmt::format("the scan given, {} x {} x {} voxels", scan.series.size[0], scan.series.size[1],
                        scan.series.size[2])};
}

}  // namespace

double loadMsOf(const std::filesystem::path& file, geometry::TriangleMesh& mesh) {
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 5; ++i) {
        const auto start = std::chrono::steady_clock::now();
        mesh = geometry::readMesh(file);
        const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
        best = std::min(best, ms.count());
    }
    return best;
}

void reproduceScan(Reproduction& r) {
    using Seconds = std::chrono::duration<double>;
    const auto begun = std::chrono::steady_clock::now();
    r.step("a tooth from slices");
    const Slices slices = segmented(r);
    const auto segmentedAt = std::chrono::steady_clock::now();
    r.step("its surface");
    const surfacing::Surfaces full = surfacing::makeSurfaces(slices.region);
    const auto surfacedAt = std::chrono::steady_clock::now();

    const auto resolutions = starter::paperResolutions();
    static_assert(surfacing::kTableTwoPercents.size() == 5);
    std::vector<geometry::TriangleMesh> meshes;
    std::vector<double> loadMs, errorUm;
    for (const double percent : surfacing::kTableTwoPercents) {
        r.step(fmt::format("the scanned tooth at {:.0f} %", percent));
        const surfacing::Surfaces at = surfacing::decimated(full, percent);
        const std::filesystem::path file = r.out / "teeth" / fmt::format("scanned-{:03.0f}.stl", percent);
        geometry::writeMesh(file, at.outer.mesh);
        geometry::TriangleMesh read;
        loadMs.push_back(loadMsOf(file, read));
        errorUm.push_back(1000.0 * at.outer.errorBoundMm);
        meshes.push_back(std::move(read));
    }
    const Seconds segmenting = segmentedAt - begun, surfacing = surfacedAt - segmentedAt;
    const DrawTiming drawing = timeDraw(r, meshes);

    Json rows = Json::array();
    std::vector<std::vector<std::string>> cells;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        const PaperTooth paper = paperTooth(std::string(resolutions[i].name));
        const std::size_t vertices = meshes[i].vertices.size(), faces = meshes[i].triangles.size();
        const bool drawn = i < drawing.ms.size();
        rows.push_back({{"resolution", resolutions[i].name},
                        {"vertices", vertices},
                        {"faces", faces},
                        {"paper_vertices", resolutions[i].vertices},
                        {"paper_faces", resolutions[i].faces},
                        {"error_bound_um", errorUm[i]},
                        {"load_ms", loadMs[i]},
                        {"paper_load_ms", paper.loadMs},
                        {"draw_ms", drawn ? Json(drawing.ms[i]) : Json()},
                        {"paper_draw_ms", paper.drawMs}});
        cells.push_back({std::string(resolutions[i].name), fmt::format("{}", resolutions[i].vertices),
                         fmt::format("{}", vertices), fmt::format("{}", resolutions[i].faces), fmt::format("{}", faces),
                         fmt::format("{:.1f}", errorUm[i]), fmt::format("{:.0f}", paper.loadMs),
                         fmt::format("{:.2f}", loadMs[i]), fmt::format("{:.0f}", paper.drawMs),
                         drawn ? fmt::format("{:.1f}", drawing.ms[i]) : "no OpenGL"});
    }
    r.results["table2_scanned"] = {{"source", slices.what},
                                   {"segmentation_s", segmenting.count()},
                                   {"surfaces_s", surfacing.count()},
                                   {"rows", std::move(rows)}};
    r.report.heading("Table II from slices");
    r.report.table({"resolution", "vertices, paper", "ours", "faces, paper", "ours", "surface moved by at most [um]",
                    "load [ms], paper", "ours", "draw [ms], paper", "ours"},
                   cells,
                   fmt::format("The outer surface of {}: thinned to the paper's percentages of its own faces. Tissues "
                               "from slices in {:.1f} s{}, all surfaces in {:.1f} s.",
                               slices.what, segmenting.count(), r.scan.path.empty() ? " (imaging included)" : "",
                               surfacing.count()));
}

}  // namespace handpiece::studies
