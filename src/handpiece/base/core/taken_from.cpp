// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/taken_from.h"

#include <mutex>
#include <utility>

namespace handpiece::core {
namespace {

struct Asked {
    std::mutex mutex;
    std::shared_ptr<const TakenFrom> ask;
};
Asked& asked() {
    static Asked one;
    return one;
}

}  // namespace

TakingFrom::TakingFrom(TakenFrom ask) : ask_(std::make_shared<const TakenFrom>(std::move(ask))) {
    const std::lock_guard lock(asked().mutex);
    asked().ask = ask_;
}

TakingFrom::~TakingFrom() {
    const std::lock_guard lock(asked().mutex);
    if (asked().ask == ask_) asked().ask.reset();
}

std::filesystem::path takenFrom(const std::filesystem::path& file) {
    std::shared_ptr<const TakenFrom> ask;
    {
        const std::lock_guard lock(asked().mutex);
        ask = asked().ask;
    }
    return ask ? (*ask)(file) : file;
}

}  // namespace handpiece::core
