// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/job.h"

#include <QMetaObject>

#include "handpiece/base/core/any_error.h"

namespace handpiece::desktop {

Job::Job(QString title, Work work, QObject* parent)
    : QObject(parent), title_(std::move(title)), work_(std::move(work)) {}

Job::~Job() {
    cancel();
    if (thread_.joinable()) thread_.join();
}

void Job::start() {
    thread_ = std::thread([this] { run(); });
}

void Job::abandon(QObject* hearer) {
    disconnect(hearer);
    cancel();
    setParent(hearer);
    if (isOver_) return deleteLater();
    for (const auto end : {&Job::done, &Job::cancelled})
        connect(this, end, this, &QObject::deleteLater);
    connect(this, &Job::failed, this, &QObject::deleteLater);
}

void Job::tell(std::function<void()> what) {
    QMetaObject::invokeMethod(this, std::move(what), Qt::QueuedConnection);
}

void Job::run() {
    const core::Progress progress = [this](double fraction) {
        const int percent = static_cast<int>(100.0 * fraction);
        if (told_.exchange(percent) != percent) tell([this, fraction] { emit progressed(fraction); });
        return !cancelled_.load(std::memory_order_relaxed);
    };
    try {
        core::report(progress, 0.0);
        work_(progress);
        tell([this] {
            isOver_ = true;
            emit done();
        });
    } catch (const std::exception& error) {
        if (cancelled_.load()) {
            tell([this] {
                isOver_ = true;
                emit cancelled();
            });
        } else {
            tell([this, problem = problemOf(core::asError(error))] {
                isOver_ = true;
                emit failed(problem);
            });
        }
    }
}

}  // namespace handpiece::desktop
