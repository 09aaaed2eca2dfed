// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/application.h"

#include "desktop/framework/screen_fit.h"
#include "handpiece/base/core/any_error.h"

namespace handpiece::desktop {

Application::Application(int& argc, char** argv) : QApplication(argc, argv) {
    installEventFilter(new ScreenFit(this));
}

bool Application::notify(QObject* receiver, QEvent* event) {
    try {
        return QApplication::notify(receiver, event);
    } catch (const std::exception& error) {
        if (!whenThrown) throw;
        whenThrown(core::asError(error));
        return true;
    }
}

}  // namespace handpiece::desktop
