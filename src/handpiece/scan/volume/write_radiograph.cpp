// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/volume/write_radiograph.h"

#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/scan/volume/dicom_radiograph.h"
#include "handpiece/scan/volume/pictures.h"

namespace handpiece::volume {

void requireRadiographName(const std::filesystem::path& file) {
    if (file.extension() != ".png" && file.extension() != ".dcm")
        throw core::Error("radiographs are written as .png or .dcm (DICOM)", file.string(), "name the output so");
}

void writeRadiograph(const RadiographFile& radiograph, const std::filesystem::path& file) {
    requireRadiographName(file);
    if (radiograph.width <= 0 || radiograph.height <= 0 || radiograph.width > 65535 || radiograph.height > 65535 ||
        radiograph.grey.size() !=
            static_cast<std::size_t>(radiograph.width) * static_cast<std::size_t>(radiograph.height))
        throw core::Error("the radiograph has no size that can be written", file.string(), "take it again");
    if (file.extension() == ".dcm") {
        core::writeFile(file, dicomRadiographBytes(radiograph));
    } else if (radiograph.isWide) {
        core::writeFile(file, pngBytes(radiograph.grey, radiograph.width, radiograph.height));
    } else {
        std::vector<std::uint8_t> narrow(radiograph.grey.size());
        for (std::size_t p = 0; p < narrow.size(); ++p)
            narrow[p] = static_cast<std::uint8_t>((radiograph.grey[p] + 128) / 257);
        core::writeFile(file, pngBytes(narrow, radiograph.width, radiograph.height));
    }
}

}  // namespace handpiece::volume
