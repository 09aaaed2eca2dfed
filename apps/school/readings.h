// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What pages show of sessions and exercises, read where it does no harm (app/sandboxed) and kept for who asks next.

#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "handpiece/app/sandboxed/sandboxed.h"
#include "handpiece/school/store/books.h"

namespace handpiece::school_server {

/// Any thread; one reads at a time, a few wait, and further ones are refused ("store-busy"). What a file is at fault
/// for is kept as what it shows is: it is not read again by a look at a page.
class Readings {
  public:
    struct Picture {
        std::vector<std::byte> png;  ///< empty: there is none
        std::string missing;         ///< why
    };
    /// The tooth as this attempt leaves it, from occlusal. `exercise`: its hash; the books have it.
    [[nodiscard]] Picture picture(const school::Books& books, const school::PushedAttempt& attempt,
                                  const std::string& exercise);
    /// The page for the student; `result` and `rubric` are texts of the books. Throws core::Error.
    [[nodiscard]] std::string studentReport(const school::Books& books, const std::string& exercise,
                                            const std::string& result, const std::string& rubric);
    /// What these files of the books hold, by their hashes: whom that accuses is no other machine's word. Waits,
    /// however many do. Throws core::Error.
    [[nodiscard]] sandboxed::Contents contents(const std::vector<std::filesystem::path>& sessions);
    /// Throws core::Error.
    [[nodiscard]] sandboxed::Exercise exercise(const school::Books& books, const std::string& hash);

  private:
    template <class T>
    T kept(std::map<std::string, T>& shelf, const std::string& key, std::size_t most, const std::function<T()>& read);

    static constexpr std::size_t kMostWaiting = 8;
    std::mutex reading_, mutex_, counting_;
    std::size_t waiting_ = 0;                     ///< guarded by `mutex_`, as what follows
    std::map<std::string, Picture> pictures_;     ///< some 50 kB each
    std::map<std::string, std::string> reports_;  ///< some 50 kB each
    std::map<std::string, sandboxed::Exercise> exercises_;
};

}  // namespace handpiece::school_server
