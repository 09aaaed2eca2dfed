// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/volume/dicom_write.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

#include <gdcmDataSet.h>
#include <gdcmFile.h>
#include <gdcmFileMetaInformation.h>
#include <gdcmTrace.h>
#include <gdcmWriter.h>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"

namespace handpiece::volume {
namespace {

/// A decimal string: at most 16 characters.
std::string decimal(double value) {
    for (int digits = 15; digits > 0; --digits)
        if (std::string text = fmt::format("{:.{}g}", value, digits); text.size() <= 16) return text;
    return "0";
}

/// Under the root for UIDs made of numbers that are unique in themselves (2.25, ISO/IEC 9834-8).
std::string uid(std::uint64_t key, const char* part, int number) {
    core::Hasher hasher;
    hasher.add(key);
    hasher.add(std::string_view(part));
    hasher.add(number);
    return fmt::format("2.25.{}", hasher.value());
}

}  // namespace

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
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
    const gdcm::SmartPointer<gdcm::File> file = new gdcm::File;
    gdcm::DataSet& data = file->GetDataSet();
    const auto text = [&](std::uint16_t group, std::uint16_t element, gdcm::VR::VRType vr, std::string value) {
        if (value.size() % 2 != 0) value += vr == gdcm::VR::UI ? '\0' : ' ';
        gdcm::DataElement e(gdcm::Tag(group, element));
        e.SetVR(vr);
        e.SetByteValue(value.data(), gdcm::VL(static_cast<std::uint32_t>(value.size())));
        data.Insert(e);
    };
    const auto number = [&](std::uint16_t element, int value) {
        const char bytes[2] = {static_cast<char>(value & 0xff), static_cast<char>(value >> 8 & 0xff)};
        gdcm::DataElement e(gdcm::Tag(0x0028, element));
        e.SetVR(gdcm::VR::US);
        e.SetByteValue(bytes, 2);
        data.Insert(e);
    };
    const core::Vec3 position = grid.toMm({0.0, 0.0, static_cast<double>(k)});
    const core::Mat3& a = grid.axes;
    const std::string sopClass = "1.2.840.10008.5.1.4.1.1.2", instance = uid(key, "slice", k);
    text(0x0008, 0x0008, gdcm::VR::CS, "DERIVED\\SECONDARY\\AXIAL");
    text(0x0008, 0x0016, gdcm::VR::UI, sopClass);
    text(0x0008, 0x0018, gdcm::VR::UI, instance);
    // Required to be there, allowed to be empty: dates, numbers and persons.
    text(0x0008, 0x0020, gdcm::VR::DA, "");
    text(0x0008, 0x0030, gdcm::VR::TM, "");
    text(0x0008, 0x0050, gdcm::VR::SH, "");
    text(0x0008, 0x0060, gdcm::VR::CS, "CT");
    text(0x0008, 0x0070, gdcm::VR::LO, "Handpiece");
    text(0x0008, 0x0090, gdcm::VR::PN, "");
    text(0x0010, 0x0010, gdcm::VR::PN, "");
    text(0x0010, 0x0020, gdcm::VR::LO, "");
    text(0x0010, 0x0030, gdcm::VR::DA, "");
    text(0x0010, 0x0040, gdcm::VR::CS, "");
    text(0x0012, 0x0062, gdcm::VR::CS, "YES");
    text(0x0018, 0x0050, gdcm::VR::DS, decimal(grid.spacingMm.z()));
    text(0x0018, 0x0060, gdcm::VR::DS, "");
    text(0x0018, 0x0088, gdcm::VR::DS, decimal(grid.spacingMm.z()));
    text(0x0020, 0x000d, gdcm::VR::UI, uid(key, "study", 0));
    text(0x0020, 0x000e, gdcm::VR::UI, uid(key, "series", 0));
    text(0x0020, 0x0010, gdcm::VR::SH, "");
    text(0x0020, 0x0011, gdcm::VR::IS, "1");
    text(0x0020, 0x0012, gdcm::VR::IS, "");
    text(0x0020, 0x0013, gdcm::VR::IS, fmt::format("{}", k + 1));
    text(0x0020, 0x0032, gdcm::VR::DS,
         decimal(position.x()) + "\\" + decimal(position.y()) + "\\" + decimal(position.z()));
    std::string orientation;
    for (int axis = 0; axis < 2; ++axis)
        for (int i = 0; i < 3; ++i)
            orientation += (orientation.empty() ? "" : "\\") + decimal(a(i, axis));
    text(0x0020, 0x0037, gdcm::VR::DS, orientation);
    text(0x0020, 0x0052, gdcm::VR::UI, uid(key, "frame", 0));
    text(0x0020, 0x1040, gdcm::VR::LO, "");
    number(0x0002, 1);
    text(0x0028, 0x0004, gdcm::VR::CS, "MONOCHROME2");
    number(0x0010, grid.size[1]);
    number(0x0011, grid.size[0]);
    text(0x0028, 0x0030, gdcm::VR::DS, decimal(grid.spacingMm.y()) + "\\" + decimal(grid.spacingMm.x()));
    number(0x0100, 16);
    number(0x0101, 16);
    number(0x0102, 15);
    number(0x0103, scale.isSigned ? 1 : 0);
    text(0x0028, 0x0301, gdcm::VR::CS, "NO");
    text(0x0028, 0x1052, gdcm::VR::DS, decimal(scale.intercept));
    text(0x0028, 0x1053, gdcm::VR::DS, decimal(scale.slope));
    std::vector<char> pixels(2 * stored.size());
    for (std::size_t i = 0; i < stored.size(); ++i) {
        pixels[2 * i] = static_cast<char>(stored[i] & 0xff);
        pixels[2 * i + 1] = static_cast<char>(stored[i] >> 8);
    }
    gdcm::DataElement e(gdcm::Tag(0x7fe0, 0x0010));
    e.SetVR(gdcm::VR::OW);
    e.SetByteValue(pixels.data(), gdcm::VL(static_cast<std::uint32_t>(pixels.size())));
    data.Insert(e);

    gdcm::FileMetaInformation& header = file->GetHeader();
    header.SetDataSetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
    header.FillFromDataSet(data);
    gdcm::Writer writer;
    writer.SetFile(*file);
    writer.SetCheckFileMetaInformation(false);
    std::ostringstream out;
    writer.SetStream(out);
    if (!writer.Write()) throw core::Error("cannot be made a DICOM file", "slice", "choose another format");
    const std::string bytes = out.str();
    std::vector<std::byte> result(bytes.size());
    std::memcpy(result.data(), bytes.data(), bytes.size());
    return result;
}

}  // namespace handpiece::volume
