// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/any_error.h"

#include <fmt/format.h>

#include <filesystem>
#include <new>

namespace handpiece::core {

Error asError(const std::exception& exception) {
    if (const auto* error = dynamic_cast<const Error*>(&exception)) return *error;
    if (dynamic_cast<const std::bad_alloc*>(&exception))
        return Error("there is not enough memory", {},
                     "close other programs, or choose a coarser voxel or a smaller mesh");
    if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&exception))
        return Error(fmt::format("cannot be used: {}", file->code().message()), file->path1().string(),
                     "check the name, its permissions and those of the folders above it");
    return Error(fmt::format("an error of the program itself: {}", exception.what()), {}, "please report it");
}

}  // namespace handpiece::core
