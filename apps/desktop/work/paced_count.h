// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What is counted beside the work, again and again, in a thread of its own: at most half of the time.

#include <QObject>
#include <QTimer>
#include <functional>
#include <memory>

#include "desktop/framework/job.h"

namespace handpiece::desktop {

class PacedCount : public QObject {
    Q_OBJECT
  public:
    explicit PacedCount(int pauseMs, QObject* parent = nullptr);

    void start();
    /// What is under way is given up: nobody hears of it.
    void stop();
    [[nodiscard]] bool isBusy() const noexcept { return job_ != nullptr; }
    /// `work` off the window's thread, then `done` on it. What fails stops it: there is nothing to count. `work` asks
    /// the progress between its steps, or the program ends only after all of them.
    void run(std::function<void(const core::Progress&)> work, std::function<void()> done);

  signals:
    void due();

  private:
    int pauseMs_;
    std::unique_ptr<Job> job_;
    QTimer timer_;
};

}  // namespace handpiece::desktop
