// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What of a task's zones is gone, a few times a second while one works: counted beside everything else, as the score
/// counts it. The tick knows nothing of it.

#include <QObject>
#include <functional>
#include <memory>
#include <vector>

#include "desktop/work/paced_count.h"
#include "handpiece/app/course/live_card.h"
#include "handpiece/app/course/live_shares.h"
#include "handpiece/assess/preparation/preparation.h"
#include "handpiece/assess/task/task.h"

namespace handpiece::desktop {

using course::LiveShares;

/// Lives on the window's thread. One thread of its own, behind all others, and only when something was cut.
class LiveZones : public QObject {
    Q_OBJECT
  public:
    explicit LiveZones(QObject* parent = nullptr);
    /// Of this tooth, from now on. A task without a preparation is none.
    /// `rubric`: its numbers are taken too; null: shares alone.
    void watch(std::shared_ptr<const tasks::Task> task, std::shared_ptr<simulation::LiveTooth> tooth,
               std::shared_ptr<const rubric::Rubric> rubric = nullptr);
    void stop();
    /// So much is gone of the tooth now [mm3]: nothing is counted again where it is as before.
    void tell(double removedMm3) { removedMm3_ = removedMm3; }

  signals:
    void counted(const handpiece::desktop::LiveShares& shares);
    /// After it, where a rubric was given.
    void valued(const std::vector<handpiece::course::LiveValue>& values);

  private:
    struct Watched;
    void count();
    void value();
    /// `work` beside everything else, then `done` here.
    void run(std::function<void(Watched&, const core::Progress&)> work, std::function<void()> done);

    std::shared_ptr<Watched> watched_;
    double removedMm3_ = 0.0, countedMm3_ = -1.0;
    bool isSure_ = false;  ///< counted once more since: whoever listens is some milliseconds behind
    PacedCount count_{400};
};

}  // namespace handpiece::desktop
