// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/volume/dicom_radiograph.h"

#include <fmt/format.h>

#include "handpiece/base/core/hash.h"
#include "handpiece/scan/volume/dicom_elements.h"

namespace handpiece::volume {
namespace {

std::uint64_t keyOf(const RadiographFile& r) {
    core::Hasher hasher;
    for (const int n : {r.width, r.height, r.fdiNumber})
        hasher.add(n);
    for (const double x : {r.pixelMm, r.kv, r.focalSpotMm, r.sourceMm})
        hasher.add(x);
    hasher.add(std::string_view(r.view));
    hasher.add(std::as_bytes(r.grey));
    return hasher.value();
}

/// "R", "L", or "U" for unknown, by the FDI quadrant (5 to 8: deciduous).
const char* lateralityOf(int fdi) {
    switch (fdi / 10) {
        case 1:
        case 4:
        case 5:
        case 8:
            return "R";
        case 2:
        case 3:
        case 6:
        case 7:
            return "L";
        default:
            return "U";
    }
}

/// Where rows and columns run to, seen from the tube: of front teeth from the front, of the others from their side.
std::string orientationOf(int fdi) {
    const char side = lateralityOf(fdi)[0];
    if (side == 'U') return "";
    if (fdi % 10 <= 3) return "L\\F";
    return side == 'R' ? "A\\F" : "P\\F";
}

}  // namespace

std::vector<std::byte> dicomRadiographBytes(const RadiographFile& r) {
    using gdcm::VR;
    const std::uint64_t key = keyOf(r);
    const std::string sides = dicomDecimal(r.pixelMm) + "\\" + dicomDecimal(r.pixelMm);
    const std::string tooth = r.fdiNumber != 0 ? fmt::format(", tooth {} (FDI)", r.fdiNumber) : "";
    DicomFile file;
    file.text(0x0008, 0x0008, VR::CS, "DERIVED\\SECONDARY");
    file.text(0x0008, 0x0016, VR::UI, "1.2.840.10008.5.1.4.1.1.1.3");  // Digital Intra-Oral X-Ray, For Presentation
    file.text(0x0008, 0x0018, VR::UI, dicomUid(key, "radiograph", 0));
    // Required to be there, allowed to be empty: dates, numbers and persons.
    file.text(0x0008, 0x0020, VR::DA, "");
    file.text(0x0008, 0x0030, VR::TM, "");
    file.text(0x0008, 0x0050, VR::SH, "");
    file.text(0x0008, 0x0060, VR::CS, "IO");
    file.text(0x0008, 0x0068, VR::CS, "FOR PRESENTATION");
    file.text(0x0008, 0x0070, VR::LO, "Handpiece");
    file.text(0x0008, 0x0090, VR::PN, "");
    file.text(0x0008, 0x103e, VR::LO, fmt::format("SIMULATED {}", r.view));
    file.text(0x0008, 0x1090, VR::LO, "Handpiece (simulation)");
    file.text(0x0008, 0x2111, VR::ST, "SIMULATED: computed from a model, no person was exposed" + tooth);
    file.code(0x0008, 0x2218, "661005", "SCT", "Jaw region");
    file.text(0x0010, 0x0010, VR::PN, "");
    file.text(0x0010, 0x0020, VR::LO, "");
    file.text(0x0010, 0x0030, VR::DA, "");
    file.text(0x0010, 0x0040, VR::CS, "");
    file.text(0x0012, 0x0062, VR::CS, "YES");
    file.text(0x0018, 0x0060, VR::DS, dicomDecimal(r.kv));
    file.text(0x0018, 0x1110, VR::DS, dicomDecimal(r.sourceMm));
    file.text(0x0018, 0x1164, VR::DS, sides);
    file.text(0x0018, 0x1190, VR::DS, dicomDecimal(r.focalSpotMm));
    file.text(0x0018, 0x1508, VR::CS, "");
    file.text(0x0018, 0x7004, VR::CS, "SCINTILLATOR");
    file.text(0x0020, 0x000d, VR::UI, dicomUid(key, "study", 0));
    file.text(0x0020, 0x000e, VR::UI, dicomUid(key, "series", 0));
    file.text(0x0020, 0x0010, VR::SH, "");
    file.text(0x0020, 0x0011, VR::IS, "1");
    file.text(0x0020, 0x0013, VR::IS, "1");
    file.text(0x0020, 0x0020, VR::CS, orientationOf(r.fdiNumber));
    file.text(0x0020, 0x0062, VR::CS, lateralityOf(r.fdiNumber));
    file.number(0x0002, 1);
    file.text(0x0028, 0x0004, VR::CS, "MONOCHROME2");
    file.number(0x0010, r.height);
    file.number(0x0011, r.width);
    file.text(0x0028, 0x0030, VR::DS, sides);
    file.number(0x0100, 16);
    file.number(0x0101, 16);
    file.number(0x0102, 15);
    file.number(0x0103, 0);
    file.text(0x0028, 0x0301, VR::CS, "YES");
    file.text(0x0028, 0x1040, VR::CS, "LOG");
    file.number(0x1041, -1, VR::SS);  // less signal, larger value
    file.text(0x0028, 0x1050, VR::DS, "32768");
    file.text(0x0028, 0x1051, VR::DS, "65536");
    file.text(0x0028, 0x1052, VR::DS, "0");
    file.text(0x0028, 0x1053, VR::DS, "1");
    file.text(0x0028, 0x1054, VR::LO, "US");
    file.text(0x0028, 0x2110, VR::CS, "00");
    file.emptySequence(0x0040, 0x0555);
    file.text(0x2050, 0x0020, VR::CS, "IDENTITY");
    file.pixels(r.grey);
    return file.bytes();
}

}  // namespace handpiece::volume
