// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/volume/dicom_elements.h"

#include <fmt/format.h>

#include <cstring>
#include <sstream>

#include <gdcmDataSet.h>
#include <gdcmFileMetaInformation.h>
#include <gdcmItem.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmTrace.h>
#include <gdcmWriter.h>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"

namespace handpiece::volume {
namespace {

gdcm::DataElement textElement(std::uint16_t group, std::uint16_t element, gdcm::VR::VRType vr, std::string value) {
    if (value.size() % 2 != 0) value += vr == gdcm::VR::UI ? '\0' : ' ';
    gdcm::DataElement e(gdcm::Tag(group, element));
    e.SetVR(vr);
    e.SetByteValue(value.data(), gdcm::VL(static_cast<std::uint32_t>(value.size())));
    return e;
}

}  // namespace

std::string dicomDecimal(double value) {
    for (int digits = 15; digits > 0; --digits)
        if (std::string text = fmt::format("{:.{}g}", value, digits); text.size() <= 16) return text;
    return "0";
}

std::string dicomUid(std::uint64_t key, const char* part, int number) {
    core::Hasher hasher;
    hasher.add(key);
    hasher.add(std::string_view(part));
    hasher.add(number);
    return fmt::format("2.25.{}", hasher.value());
}

DicomFile::DicomFile() : file_(new gdcm::File) {
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
}

void DicomFile::text(std::uint16_t group, std::uint16_t element, gdcm::VR::VRType vr, std::string value) {
    file_->GetDataSet().Insert(textElement(group, element, vr, std::move(value)));
}

void DicomFile::number(std::uint16_t element, int value, gdcm::VR::VRType vr) {
    const char bytes[2] = {static_cast<char>(value & 0xff), static_cast<char>(value >> 8 & 0xff)};
    gdcm::DataElement e(gdcm::Tag(0x0028, element));
    e.SetVR(vr);
    e.SetByteValue(bytes, 2);
    file_->GetDataSet().Insert(e);
}

void DicomFile::code(std::uint16_t group, std::uint16_t element, const std::string& value, const std::string& scheme,
                     const std::string& meaning) {
    gdcm::Item item;
    item.SetVLToUndefined();
    item.GetNestedDataSet().Insert(textElement(0x0008, 0x0100, gdcm::VR::SH, value));
    item.GetNestedDataSet().Insert(textElement(0x0008, 0x0102, gdcm::VR::SH, scheme));
    item.GetNestedDataSet().Insert(textElement(0x0008, 0x0104, gdcm::VR::LO, meaning));
    const gdcm::SmartPointer<gdcm::SequenceOfItems> sequence = new gdcm::SequenceOfItems;
    sequence->SetLengthToUndefined();
    sequence->AddItem(item);
    gdcm::DataElement e(gdcm::Tag(group, element));
    e.SetVR(gdcm::VR::SQ);
    e.SetValue(*sequence);
    e.SetVLToUndefined();
    file_->GetDataSet().Insert(e);
}

void DicomFile::emptySequence(std::uint16_t group, std::uint16_t element) {
    const gdcm::SmartPointer<gdcm::SequenceOfItems> sequence = new gdcm::SequenceOfItems;
    sequence->SetLengthToUndefined();
    gdcm::DataElement e(gdcm::Tag(group, element));
    e.SetVR(gdcm::VR::SQ);
    e.SetValue(*sequence);
    e.SetVLToUndefined();
    file_->GetDataSet().Insert(e);
}

void DicomFile::pixels(std::span<const std::uint16_t> stored) {
    std::vector<char> bytes(2 * stored.size());
    for (std::size_t i = 0; i < stored.size(); ++i) {
        bytes[2 * i] = static_cast<char>(stored[i] & 0xff);
        bytes[2 * i + 1] = static_cast<char>(stored[i] >> 8);
    }
    gdcm::DataElement e(gdcm::Tag(0x7fe0, 0x0010));
    e.SetVR(gdcm::VR::OW);
    e.SetByteValue(bytes.data(), gdcm::VL(static_cast<std::uint32_t>(bytes.size())));
    file_->GetDataSet().Insert(e);
}

std::vector<std::byte> DicomFile::bytes() {
    gdcm::FileMetaInformation& header = file_->GetHeader();
    header.SetDataSetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
    header.FillFromDataSet(file_->GetDataSet());
    gdcm::Writer writer;
    writer.SetFile(*file_);
    writer.SetCheckFileMetaInformation(false);
    std::ostringstream out;
    writer.SetStream(out);
    if (!writer.Write()) throw core::Error("cannot be made a DICOM file", "picture", "choose another format");
    const std::string bytes = out.str();
    std::vector<std::byte> result(bytes.size());
    std::memcpy(result.data(), bytes.data(), bytes.size());
    return result;
}

}  // namespace handpiece::volume
