// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The machine's score of each returned work, closed until a Desk opens it; computed on all cores, kept on the disk.

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/marking/returned_work.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/progress.h"
#include "handpiece/senses/view/image.h"

namespace handpiece::marking {

/// What the machine found of one work. Nobody but a Desk can look at the result, so that a blind marker's window
/// cannot show it by mistake.
class Scored {
  public:
    /// Why there is no result; none where there is one.
    [[nodiscard]] const std::optional<core::Error>& error() const noexcept { return error_; }
    /// That in a sentence; empty where there is a result.
    [[nodiscard]] std::string problem() const { return error_ ? error_->problem() : std::string(); }
    /// The cut tooth from occlusal; nothing where it could not be drawn.
    [[nodiscard]] const view::Image& picture() const noexcept { return picture_; }

    [[nodiscard]] static Scored failed(core::Error error);
    [[nodiscard]] static Scored of(assessment::Result result, view::Image picture = {});

  private:
    friend class Desk;
    friend struct Kept;
    std::optional<assessment::Result> result_;
    std::optional<core::Error> error_;
    view::Image picture_;
};

/// What the machine makes of one work that can be read.
struct Judged {
    assessment::Result result;
    view::Image picture{};
};
/// The size of its pictures.
inline constexpr int kPictureWidth = 192, kPictureHeight = 144;
/// Reads it, scores it and draws it. `unpacked` as of assessment::readWork(). Throws core::Error.
[[nodiscard]] Judged judgeReturned(const std::filesystem::path& work, const tasks::Task& task,
                                   const rubric::Rubric& rubric, bool prove, bool pictures,
                                   const std::filesystem::path& unpacked = {}, const core::Progress& progress = {});

struct ScoreSettings {
    bool prove = true;  ///< cut sessions again
    bool pictures = true;
    std::filesystem::path kept;  ///< where results are kept by content, exercise, rubric and engine; empty: nowhere
    /// Who judges what is not kept: in another process, say. Its answer is held to exercise and rubric. Empty:
    /// judgeReturned(), here.
    std::function<Judged(const ReturnedWork& work, const core::Progress& progress)> judge{};
};

/// Of one work. What is wrong with it is the answer's problem(); throws core::Error only when cancelled.
[[nodiscard]] Scored scoreReturned(const ReturnedWork& work, const tasks::Task& task, const rubric::Rubric& rubric,
                                   const ScoreSettings& settings, const core::Progress& progress = {});
/// Of all, as many at a time as there are cores (four at most: each holds a tooth). `done` is called once for each,
/// from any thread, one at a time. Throws core::Error when cancelled.
void scoreAll(std::span<const ReturnedWork> works, const tasks::Task& task, const rubric::Rubric& rubric,
              const ScoreSettings& settings, const core::Progress& progress,
              const std::function<void(std::size_t which, Scored scored)>& done);

/// The tooth worked on, as it was cut, from occlusal. Throws core::Error without OpenGL.
[[nodiscard]] view::Image pictureOf(const assessment::Work& work, const view::Standing& standing, int widthPx,
                                    int heightPx);

}  // namespace handpiece::marking
