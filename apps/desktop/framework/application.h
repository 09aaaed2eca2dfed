// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Qt's application, and the last catch of everything that a slot throws.

#include <QApplication>
#include <functional>

#include "handpiece/base/core/error.h"

namespace handpiece::desktop {

/// What a slot throws would end the program, and with it the student's work: here it is told, and the work goes on.
class Application : public QApplication {
  public:
    Application(int& argc, char** argv);
    /// Set it once there is a window to tell in; until then exceptions pass.
    std::function<void(const core::Error&)> whenThrown;

    bool notify(QObject* receiver, QEvent* event) override;
};

}  // namespace handpiece::desktop
