// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/texture.h"

#include <mutex>
#include <utility>

namespace handpiece::geometry {
namespace {

std::mutex pictureMutex;

PictureReader& pictureReader() {
    static PictureReader reader;
    return reader;
}

}  // namespace

void readPicturesWith(PictureReader reader) {
    const std::lock_guard lock(pictureMutex);
    pictureReader() = std::move(reader);
}

std::optional<Picture> readPicture(const std::filesystem::path& file) {
    PictureReader reader;
    {
        const std::lock_guard lock(pictureMutex);
        reader = pictureReader();
    }
    if (!reader) return std::nullopt;
    return reader(file);
}

}  // namespace handpiece::geometry
