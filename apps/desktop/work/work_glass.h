// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// While one works: what is still to be cut as glass, and in stripes what is gone beyond. Made beside everything else.

#include <QElapsedTimer>
#include <QObject>
#include <memory>
#include <vector>

#include "desktop/work/paced_count.h"
#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/assess/task/task.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::desktop {

/// Lives on the window's thread. One thread of its own, behind all others, at most half of the time, and only when
/// something was cut.
class WorkGlass : public QObject {
    Q_OBJECT
  public:
    explicit WorkGlass(QObject* parent = nullptr);
    /// Of this tooth, from now on. A task without a preparation has none.
    void watch(std::shared_ptr<const tasks::Task> task, std::shared_ptr<simulation::LiveTooth> tooth);
    void stop();
    /// So much is gone of the tooth now [mm3]: nothing is made again where it is as before.
    void tell(double removedMm3) { removedMm3_ = removedMm3; }
    [[nodiscard]] bool isWatching() const noexcept { return watched_ != nullptr; }
    /// For ViewWidget::setGlass(): what is left, then what is gone beyond.
    [[nodiscard]] const std::vector<view::GlassSurface>& surfaces() const noexcept { return surfaces_; }

  signals:
    /// surfaces() are others now.
    void changed();

  private:
    struct Watched;
    void make();

    std::shared_ptr<Watched> watched_;
    double removedMm3_ = 0.0, madeMm3_ = -1.0;
    bool isSure_ = false;  ///< made once more since: whoever listens is some milliseconds behind
    PacedCount count_{500};
    std::vector<view::GlassSurface> surfaces_;
};

}  // namespace handpiece::desktop
