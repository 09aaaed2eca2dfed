// SPDX-License-Identifier: Apache-2.0
#include "school/picture_shelf.h"

#include <fmt/format.h>

#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/marking/scoring.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::school_server {

PictureShelf::Drawn PictureShelf::of(const school::Books& books, const school::PushedAttempt& attempt,
                                     const tasks::Task& task) {
    constexpr std::size_t kMost = 200;  // some 50 kB each
    constexpr int kWidth = 640, kHeight = 480;
    const std::lock_guard lock(mutex_);
    if (const auto found = drawn_.find(attempt.attempt.id); found != drawn_.end()) return found->second;
    Drawn drawn;
    try {
        std::vector<assessment::ChainLink> chain;
        for (const std::string& file : attempt.files)
            chain.push_back({fmt::format("{}.h5", chain.size() + 1), books.files().path(file)});
        // Whether it is proven the server has found already: what is seen here is what the last session left.
        const assessment::Work work = assessment::readChain(chain, task, false);
        const core::PrivateFolder folder;
        const std::filesystem::path file = folder.path() / "picture.png";
        view::writePng(marking::pictureOf(work, task.toothCase.buccalSign, kWidth, kHeight), file);
        drawn.png = core::readFile(file);
    } catch (const std::exception& error) {
        // Without OpenGL, or a session that cannot be read: a page without a picture is still a page.
        drawn.missing = core::asError(error).problem();
    }
    if (drawn_.size() >= kMost) drawn_.clear();
    return drawn_[attempt.attempt.id] = std::move(drawn);
}

}  // namespace handpiece::school_server
