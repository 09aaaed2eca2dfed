// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/scan_case/textures.h"

#include <utility>

#include "handpiece/base/geometry/texture.h"
#include "handpiece/scan/volume/colour_picture.h"

namespace handpiece::scan_case {

void readTextures() {
    geometry::readPicturesWith([](const std::filesystem::path& file) {
        volume::ColourPicture read =
            volume::readColourPicture(file, {geometry::kMaxPictureBytes, geometry::kMaxPicturePixels});
        return geometry::Picture{read.columns, read.rows, std::move(read.rgb)};
    });
}

}  // namespace handpiece::scan_case
