// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A session for the viewer in a page (apps/web/viewer): the tooth as it changes, the bur's way, curves, moments.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/app/simulation/session_player.h"
#include "handpiece/assess/score/score.h"
#include "handpiece/assess/task/task.h"

namespace handpiece::report {

/// What a viewer needs. docs/review.md says what is in it.
struct Review {
    std::string json;             ///< in the program's language; no '<' in it, so that it can stand in a page
    std::vector<std::byte> data;  ///< a zlib stream; empty: too large for a page
    /// The tooth at a time, for print and for browsers that cannot draw it; the bytes of a PNG file.
    struct Picture {
        double timeS = 0.0;
        std::vector<std::byte> png;
    };
    std::vector<Picture> pictures{};
};

/// Against what the work is held. Null: nothing of it is shown.
struct ReviewedAgainst {
    const tasks::Task* task = nullptr;  ///< its ideal gives the deviation
    const score::Result* result = nullptr;
    const rubric::Rubric* rubric = nullptr;  ///< of the result
};

/// A page with its review stays under 3 MB.
inline constexpr std::size_t kMostPageBytes = 2'950'000;
/// Of data and pictures, before they become letters.
inline constexpr std::size_t kMostReviewBytes = 1'900'000;
/// So many pictures along the way.
inline constexpr std::size_t kReviewPictures = 6;

/// Gathers one session, or a chain in its order, while a player plays each from its beginning to its end. The same
/// bytes at any thread count.
class ReviewGatherer {
  public:
    /// `pictures`: so many are drawn in each session of a player that has a tooth(), as the exercise `task` begins;
    /// none where there is no OpenGL.
    explicit ReviewGatherer(std::size_t pictures = 0, const tasks::Task* task = nullptr);
    ~ReviewGatherer();
    ReviewGatherer(const ReviewGatherer&) = delete;
    ReviewGatherer& operator=(const ReviewGatherer&) = delete;

    /// A session begins: the first, or the next of a chain. What comes after `untilTick` was given up and is left out.
    /// Throws core::Error: it is of another tooth or voxel than those before it.
    void follow(const simulation::SessionPlayer& player, const std::string& name = {},
                std::optional<std::uint64_t> untilTick = {});
    /// To be called every stepS() of the session, from the first tick to the last.
    void look();
    [[nodiscard]] static double stepS();
    /// Stands under the picture: what is not as it was.
    void note(const std::string& text);
    /// Of what was seen. `title`: of the page. Throws core::Error: the exercise is of another tooth, or cannot be laid
    /// on it. Where it would be more than `mostBytes`, it has fewer pictures, and the tooth changes in fewer steps.
    [[nodiscard]] Review review(const std::string& title, const ReviewedAgainst& against = {},
                                std::size_t mostBytes = kMostReviewBytes) const;

  private:
    std::unique_ptr<struct Gathered> gathered_;
};

/// A session of a chain.
struct Reviewed {
    std::filesystem::path path;
    std::string name;
    std::optional<std::uint64_t> untilTick{};  ///< as ReviewGatherer::follow
};
/// Plays a chain in its order and gathers it. Throws core::Error as SessionPlayer, and as ReviewGatherer.
[[nodiscard]] Review reviewOf(std::span<const Reviewed> chain, const std::string& title,
                              const ReviewedAgainst& against = {}, bool pictures = true,
                              std::size_t mostBytes = kMostReviewBytes, const core::Progress& progress = {});

}  // namespace handpiece::report
