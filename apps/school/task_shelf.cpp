// SPDX-License-Identifier: Apache-2.0
#include "school/task_shelf.h"

#include "handpiece/base/core/file.h"

namespace handpiece::school_server {

std::shared_ptr<const tasks::Task> TaskShelf::of(const school::Books& books, const std::string& hash) {
    constexpr std::size_t kMost = 8;
    const std::lock_guard lock(mutex_);
    if (const auto found = tasks_.find(hash); found != tasks_.end()) return found->second;
    const std::optional<school::Pack> pack = books.pack(hash);
    if (!pack) return nullptr;
    // Read by its name's end; the books have it without one.
    const core::PrivateFolder folder;
    const std::filesystem::path file = folder.path() / "exercise.handpiece";
    std::filesystem::create_symlink(std::filesystem::absolute(books.files().path(pack->file)), file);
    auto task = std::make_shared<const tasks::Task>(tasks::readTask(file));
    if (tasks_.size() >= kMost) tasks_.clear();
    return tasks_[hash] = std::move(task);
}

}  // namespace handpiece::school_server
