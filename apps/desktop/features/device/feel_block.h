// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A block of enamel to be touched with a device that was just set up: a sitting of its own, nothing recorded.

#include <QObject>
#include <QTimer>
#include <memory>

#include "desktop/work/device_manager.h"
#include "handpiece/app/simulation/live_session.h"

namespace handpiece::desktop {

/// Nothing else may have the device meanwhile. Lives on the window's thread; the block is made beside it.
class FeelBlock : public QObject {
    Q_OBJECT
  public:
    explicit FeelBlock(bool realTime, QObject* parent = nullptr);
    ~FeelBlock() override;

    void start(std::shared_ptr<Hand> hand);
    void stop();
    [[nodiscard]] bool isRunning() const noexcept { return liveSession_ != nullptr; }
    [[nodiscard]] const messages::HapticSample& sample() const noexcept { return sample_; }
    [[nodiscard]] const simulation::LiveSessionStatus& status() const noexcept { return status_; }
    /// Of the block: its top lies at z = 0.
    static constexpr double kHalfMm = 5.0, kDepthMm = 5.0;
    [[nodiscard]] static input::ToothPlace place();

  signals:
    void ticked();
    void failed(const handpiece::desktop::Problem& problem);

  private:
    bool realTime_;
    std::unique_ptr<Job> making_;
    std::unique_ptr<simulation::LiveSession> liveSession_;
    std::shared_ptr<simulation::SampleFeed> feed_;
    messages::HapticSample sample_;
    simulation::LiveSessionStatus status_;
    QTimer timer_;
};

}  // namespace handpiece::desktop
