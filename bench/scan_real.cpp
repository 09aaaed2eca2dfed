// SPDX-License-Identifier: Apache-2.0
#include "scan_real.h"

#include <fmt/format.h>

#include <chrono>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/scan/phantom/phantom.h"
#include "handpiece/scan/segmentation/segment.h"
#include "handpiece/scan/surfacing/surfaces.h"
#include "handpiece/scan/volume/read_scan.h"
#include "scan_pictures.h"
#include "scan_truth.h"

namespace handpiece::bench {
namespace {

/// 16 bits, big-endian, x fastest; the spacing is an estimate (see the data's README).
volume::Volume readGe(const std::filesystem::path& file) {
    volume::Volume volume;
    volume.grid.size = {103, 94, 161};
    volume.grid.spacingMm = core::Vec3::Constant(0.133);
    const std::vector<std::byte> bytes = core::readFile(file);
    if (bytes.size() != 2 * volume.grid.count())
        throw core::Error("this is not the tooth of 103 x 94 x 161 voxels", file.string());
    volume.values.resize(volume.grid.count());
    for (std::size_t n = 0; n < volume.values.size(); ++n)
        volume.values[n] =
            static_cast<float>(std::to_integer<int>(bytes[2 * n]) * 256 + std::to_integer<int>(bytes[2 * n + 1]));
    return volume;
}

void tell(const char* name, const volume::Volume& volume, const segmentation::Region& region, double seconds,
          const std::string& pictures, bool segmentOnly) {
    const segmentation::Thresholds& t = region.thresholds;
    fmt::print(
        "{}: {:.2f} s\n  peaks: outside {:g} pulp {:g} dentine {:g} enamel {:g}; tooth from {:g}, enamel from "
        "{:g}; blur {:.3f} mm, noise {:g}\n",
        name, seconds, t.outside, t.pulp, t.dentine, t.enamel, t.toothFrom, t.enamelFrom, region.blurMm, region.noise);
    for (const std::string& note : region.notes)
        fmt::print("  note: {}\n", note);
    const auto tellVolumes = [](const char* of, const std::array<double, cases::kTissueCount>& volumes) {
        for (std::size_t tissue = 1; tissue < volumes.size(); ++tissue)
            if (volumes[tissue] != 0.0)
                fmt::print("  {:<9} {:<11} {:9.2f} mm3\n", of,
                           cases::properties(static_cast<cases::Tissue>(tissue)).name, volumes[tissue]);
    };
    tellVolumes("segment", segmentation::volumesMm3(region));
    if (!pictures.empty()) writePictures(pictures, name, volume, nullptr, region);
    if (segmentOnly) return;
    const auto begin = std::chrono::steady_clock::now();
    const surfacing::Surfaces surfaces = surfacing::makeSurfaces(region);
    fmt::print("  surfaces in {:.2f} s\n",
               std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    tellVolumes("surfaces", volumesOf(surfaces));
}

}  // namespace

void measureReal(const std::filesystem::path& folder, const std::string& pictures, bool segmentOnly) {
    const auto since = [](std::chrono::steady_clock::time_point begin) {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    const volume::Volume ge = readGe(folder / "ge-tooth-ct" / "tooth_103x94x161_uint16_be.raw");
    auto begin = std::chrono::steady_clock::now();
    const segmentation::Region geRegion = segmentation::segment(ge);
    tell("ge-tooth", ge, geRegion, since(begin), pictures, segmentOnly);

    const std::filesystem::path labelFile = folder / "molar-caries" / "molar_labels_34um_cropped.nrrd";
    volume::Scan scan = volume::readScan(labelFile);
    volume::Labels labels = volume::toLabels(scan.volume, labelFile.string());
    fmt::print("\nknown of the molar: decay 6.4, enamel 188, dentine 512 mm3\n");
    begin = std::chrono::steady_clock::now();
    const segmentation::Region molarRegion = segmentation::segmentLabels(labels);
    tell("molar", scan.volume, molarRegion, since(begin), pictures, segmentOnly);
}

}  // namespace handpiece::bench
