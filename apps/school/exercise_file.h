// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An exercise of the books as a file.

#include <filesystem>
#include <string>

#include "handpiece/base/core/file.h"
#include "handpiece/school/store/books.h"

namespace handpiece::school_server {

/// There as long as this is. Read by its name's end; the books have it without one.
class ExerciseFile {
  public:
    explicit ExerciseFile(const std::filesystem::path& file) { isAt(file); }
    /// By the exercise's hash; path() is empty where the books have none.
    ExerciseFile(const school::Books& books, const std::string& hash) {
        if (const std::optional<school::Pack> pack = books.pack(hash)) isAt(books.files().path(pack->file));
    }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    void isAt(const std::filesystem::path& file) {
        path_ = folder_.path() / "exercise.handpiece";
        std::filesystem::create_symlink(std::filesystem::absolute(file), path_);
    }

    core::PrivateFolder folder_;
    std::filesystem::path path_;
};

}  // namespace handpiece::school_server
