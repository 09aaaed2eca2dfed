// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Works that are lent to who cuts them again: out of the books, or by a school's server (remote_work.h).

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/app/sandboxed/sandboxed.h"
#include "handpiece/school/store/books.h"

namespace handpiece::school_server {

inline constexpr school::Milliseconds kLeaseMs = 120'000;  ///< renewed meanwhile: after a crash another takes over then

/// One work, to be cut again and told of.
class LentWork {
  public:
    virtual ~LentWork() = default;
    /// How often it was lent; this one too.
    [[nodiscard]] virtual std::int64_t turn() const = 0;
    /// sandboxed::questionOf()
    [[nodiscard]] virtual const std::string& question() const = 0;
    /// Brings them here where they are elsewhere; there as long as this is.
    [[nodiscard]] virtual sandboxed::Files files(const core::Progress& progress) = 0;
    /// False: its lease ran out, and it is another's by now.
    [[nodiscard]] virtual bool renew() = 0;
    /// Not where another was quicker.
    virtual void enter(sandboxed::Proof proof, const core::Progress& progress) = 0;
    /// For another, or for later. It costs the work a turn where it `counts`.
    virtual void giveBack(school::Milliseconds pause, bool counts) = 0;
};

/// Where a worker has its works from.
class WorkSource {
  public:
    virtual ~WorkSource() = default;
    /// Nothing: none waits.
    [[nodiscard]] virtual std::unique_ptr<LentWork> take() = 0;
};

struct BooksPlace {
    std::filesystem::path data;
    std::string database{};
};
/// Of books that this process reads and writes itself.
[[nodiscard]] std::unique_ptr<WorkSource> worksOf(BooksPlace place, std::function<school::Milliseconds()> clock);

/// A job and what has to be there to do it.
struct TakenJob {
    school::Job job;
    std::string question;
    std::vector<std::string> sessions;  ///< SHA-256 of each
    std::string exercise;               ///< of its file
};
/// The next one that can be done, lent to `worker`; what can not is refused here.
[[nodiscard]] std::optional<TakenJob> takeJob(school::Books& books, const std::string& worker,
                                              school::Milliseconds now);
/// Of sessions and exercise.
[[nodiscard]] std::vector<std::string> filesOf(const school::Books& books, const school::Job& job);
/// What its worker found. False: another was quicker.
bool enterProof(school::Books& books, const school::Job& job, sandboxed::Proof proof, const std::string& worker,
                school::Milliseconds now);

}  // namespace handpiece::school_server
