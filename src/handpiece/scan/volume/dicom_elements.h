// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A DICOM file element by element, through GDCM. Private to this room.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gdcmDataElement.h>
#include <gdcmFile.h>

namespace handpiece::volume {

/// A decimal string: at most 16 characters.
[[nodiscard]] std::string dicomDecimal(double value);
/// Under the root for UIDs made of numbers that are unique in themselves (2.25, ISO/IEC 9834-8).
[[nodiscard]] std::string dicomUid(std::uint64_t key, const char* part, int number);

class DicomFile {
  public:
    DicomFile();
    void text(std::uint16_t group, std::uint16_t element, gdcm::VR::VRType vr, std::string value);
    /// A 16-bit number of group 0028.
    void number(std::uint16_t element, int value, gdcm::VR::VRType vr = gdcm::VR::US);
    /// A sequence of one item that holds a code.
    void code(std::uint16_t group, std::uint16_t element, const std::string& value, const std::string& scheme,
              const std::string& meaning);
    void emptySequence(std::uint16_t group, std::uint16_t element);
    void pixels(std::span<const std::uint16_t> stored);
    [[nodiscard]] std::vector<std::byte> bytes();

  private:
    gdcm::SmartPointer<gdcm::File> file_;
};

}  // namespace handpiece::volume
