// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Long work on a thread of its own, with progress and cancel.

#include <QObject>
#include <QString>
#include <atomic>
#include <functional>
#include <memory>
#include <thread>

#include "desktop/framework/problem.h"
#include "handpiece/base/core/progress.h"

namespace handpiece::desktop {

/// Runs once. Signals come on the thread that made it; after one of done, failed, cancelled there are no more.
class Job : public QObject {
    Q_OBJECT
  public:
    using Work = std::function<void(const core::Progress&)>;
    Job(QString title, Work work, QObject* parent = nullptr);
    /// Cancels and waits.
    ~Job() override;

    void start();
    void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
    /// It is cancelled, `hearer` hears no more of it, and it goes when it has ended, with `hearer` at the latest:
    /// nobody waits. Also for one that is over, out of its own signals as well.
    void abandon(QObject* hearer);
    [[nodiscard]] const QString& title() const noexcept { return title_; }

  signals:
    void progressed(double fraction);
    void done();
    void failed(const handpiece::desktop::Problem& problem);
    void cancelled();

  private:
    void run();
    void tell(std::function<void()> what);

    QString title_;
    Work work_;
    std::atomic<bool> cancelled_{false};
    std::atomic<int> told_{-1};
    bool isOver_ = false;
    std::thread thread_;
};

}  // namespace handpiece::desktop
