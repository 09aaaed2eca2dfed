// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A session for the viewer in a page (apps/web/viewer): the tooth as it changes, the bur's way, curves, moments.

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "handpiece/app/simulation/session_player.h"
#include "handpiece/assess/score/score.h"
#include "handpiece/assess/task/task.h"

namespace handpiece::report {

/// What a viewer needs. docs/review.md says what is in it.
struct Review {
    std::string json;             ///< in the program's language; no '<' in it, so that it can stand in a page
    std::vector<std::byte> data;  ///< a zlib stream
};

/// Against what the work is held. Null: nothing of it is shown.
struct ReviewedAgainst {
    const tasks::Task* task = nullptr;  ///< its ideal gives the deviation
    const score::Result* result = nullptr;
    const rubric::Rubric* rubric = nullptr;  ///< of the result
    std::size_t session = 0;                 ///< number of this session in the chain that the result is of
};

/// As base64, with the viewer and the rest of its page, it stays under 3 MB.
inline constexpr std::size_t kMostPageBytes = 2'950'000;
inline constexpr std::size_t kMostReviewBytes = 1'300'000;

/// Gathers a session while a player plays it from its beginning to its end. The same bytes at any thread count.
class ReviewGatherer {
  public:
    explicit ReviewGatherer(const simulation::SessionPlayer& player);
    ~ReviewGatherer();
    ReviewGatherer(const ReviewGatherer&) = delete;
    ReviewGatherer& operator=(const ReviewGatherer&) = delete;

    /// To be called every stepS() of the session, from the first tick to the last.
    void look();
    [[nodiscard]] static double stepS();
    /// Of what was seen. `title`: of the page. Throws core::Error: the exercise is of another tooth, or cannot be laid
    /// on it. Where `data` would be more than `mostBytes`, the tooth changes in fewer steps.
    [[nodiscard]] Review review(const std::string& title, const ReviewedAgainst& against = {},
                                std::size_t mostBytes = kMostReviewBytes) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Plays a session from its beginning and gathers it. Throws core::Error as SessionPlayer::compareAll.
[[nodiscard]] Review reviewOf(simulation::SessionPlayer& player, const std::string& title,
                              const ReviewedAgainst& against = {}, const core::Progress& progress = {},
                              std::size_t mostBytes = kMostReviewBytes);

}  // namespace handpiece::report
