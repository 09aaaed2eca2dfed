// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/volume/dicom_write.h"

#include <fmt/format.h>

#include "handpiece/base/core/hash.h"
#include "handpiece/scan/volume/dicom_elements.h"

namespace handpiece::volume {

std::uint64_t scanKey(const Volume& volume) {
    core::Hasher hasher;
    for (const int n : volume.grid.size)
        hasher.add(n);
    for (int i = 0; i < 3; ++i) {
        hasher.add(volume.grid.spacingMm[i]);
        hasher.add(volume.grid.originMm[i]);
        for (int j = 0; j < 3; ++j)
            hasher.add(volume.grid.axes(i, j));
    }
    hasher.add(std::as_bytes(std::span(volume.values)));
    return hasher.value();
}

std::vector<std::byte> dicomBytes(std::span<const std::uint16_t> stored, const Grid& grid, int k,
                                  const DicomScale& scale, std::uint64_t key) {
    DicomFile file;
    const core::Vec3 position = grid.toMm({0.0, 0.0, static_cast<double>(k)});
    const core::Mat3& a = grid.axes;
    const std::string sopClass = "1.2.840.10008.5.1.4.1.1.2", instance = dicomUid(key, "slice", k);
    file.text(0x0008, 0x0008, gdcm::VR::CS, "DERIVED\\SECONDARY\\AXIAL");
    file.text(0x0008, 0x0016, gdcm::VR::UI, sopClass);
    file.text(0x0008, 0x0018, gdcm::VR::UI, instance);
    // Required to be there, allowed to be empty: dates, numbers and persons.
    file.text(0x0008, 0x0020, gdcm::VR::DA, "");
    file.text(0x0008, 0x0030, gdcm::VR::TM, "");
    file.text(0x0008, 0x0050, gdcm::VR::SH, "");
    file.text(0x0008, 0x0060, gdcm::VR::CS, "CT");
    file.text(0x0008, 0x0070, gdcm::VR::LO, "Handpiece");
    file.text(0x0008, 0x0090, gdcm::VR::PN, "");
    file.text(0x0010, 0x0010, gdcm::VR::PN, "");
    file.text(0x0010, 0x0020, gdcm::VR::LO, "");
    file.text(0x0010, 0x0030, gdcm::VR::DA, "");
    file.text(0x0010, 0x0040, gdcm::VR::CS, "");
    file.text(0x0012, 0x0062, gdcm::VR::CS, "YES");
    file.text(0x0018, 0x0050, gdcm::VR::DS, dicomDecimal(grid.spacingMm.z()));
    file.text(0x0018, 0x0060, gdcm::VR::DS, "");
    file.text(0x0018, 0x0088, gdcm::VR::DS, dicomDecimal(grid.spacingMm.z()));
    file.text(0x0020, 0x000d, gdcm::VR::UI, dicomUid(key, "study", 0));
    file.text(0x0020, 0x000e, gdcm::VR::UI, dicomUid(key, "series", 0));
    file.text(0x0020, 0x0010, gdcm::VR::SH, "");
    file.text(0x0020, 0x0011, gdcm::VR::IS, "1");
    file.text(0x0020, 0x0012, gdcm::VR::IS, "");
    file.text(0x0020, 0x0013, gdcm::VR::IS, fmt::format("{}", k + 1));
    file.text(0x0020, 0x0032, gdcm::VR::DS,
              dicomDecimal(position.x()) + "\\" + dicomDecimal(position.y()) + "\\" + dicomDecimal(position.z()));
    std::string orientation;
    for (int axis = 0; axis < 2; ++axis)
        for (int i = 0; i < 3; ++i)
            orientation += (orientation.empty() ? "" : "\\") + dicomDecimal(a(i, axis));
    file.text(0x0020, 0x0037, gdcm::VR::DS, orientation);
    file.text(0x0020, 0x0052, gdcm::VR::UI, dicomUid(key, "frame", 0));
    file.text(0x0020, 0x1040, gdcm::VR::LO, "");
    file.number(0x0002, 1);
    file.text(0x0028, 0x0004, gdcm::VR::CS, "MONOCHROME2");
    file.number(0x0010, grid.size[1]);
    file.number(0x0011, grid.size[0]);
    file.text(0x0028, 0x0030, gdcm::VR::DS, dicomDecimal(grid.spacingMm.y()) + "\\" + dicomDecimal(grid.spacingMm.x()));
    file.number(0x0100, 16);
    file.number(0x0101, 16);
    file.number(0x0102, 15);
    file.number(0x0103, scale.isSigned ? 1 : 0);
    file.text(0x0028, 0x0301, gdcm::VR::CS, "NO");
    file.text(0x0028, 0x1052, gdcm::VR::DS, dicomDecimal(scale.intercept));
    file.text(0x0028, 0x1053, gdcm::VR::DS, dicomDecimal(scale.slope));
    file.pixels(stored);
    return file.bytes();
}

}  // namespace handpiece::volume
