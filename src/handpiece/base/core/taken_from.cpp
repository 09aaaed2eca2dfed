// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/taken_from.h"

#include <mutex>
#include <utility>

namespace handpiece::core {
namespace {

struct Standing {
    std::mutex mutex;
    std::shared_ptr<const TakenFrom> ask;
};
Standing& standing() {
    static Standing one;
    return one;
}

}  // namespace

TakingFrom::TakingFrom(TakenFrom ask) : ask_(std::make_shared<const TakenFrom>(std::move(ask))) {
    const std::lock_guard lock(standing().mutex);
    standing().ask = ask_;
}

TakingFrom::~TakingFrom() {
    const std::lock_guard lock(standing().mutex);
    if (standing().ask == ask_) standing().ask.reset();
}

std::filesystem::path takenFrom(const std::filesystem::path& file) {
    std::shared_ptr<const TakenFrom> ask;
    {
        const std::lock_guard lock(standing().mutex);
        ask = standing().ask;
    }
    return ask ? (*ask)(file) : file;
}

}  // namespace handpiece::core
