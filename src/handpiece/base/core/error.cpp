// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/error.h"

#include <utility>

#include "handpiece/base/core/utf8.h"

namespace handpiece::core {

Error::Error(std::string what, std::string where, std::string remedy)
    : problem_(std::move(what)), where_(std::move(where)), remedy_(std::move(remedy)) {
    if (!where_.empty()) message_ = where_ + ": ";
    message_ += problem_;
    if (!remedy_.empty()) message_ += " (" + remedy_ + ")";
    message_ = printable(asUtf8(message_));
}

Error Error::as(std::string id, std::vector<std::string> arguments) && {
    id_ = std::move(id);
    arguments_ = std::move(arguments);
    return std::move(*this);
}

}  // namespace handpiece::core
