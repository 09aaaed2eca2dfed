// SPDX-License-Identifier: Apache-2.0
// GoogleTest inside a Qt application, with settings and data in a folder that goes away.
#include <gtest/gtest.h>

#include <QTemporaryDir>

#include "desktop/framework/application.h"
#include "support/chosen_tests.h"

namespace {

QtMessageHandler others = nullptr;

/// The platform without a screen says at every window what it cannot do: thousands of lines, in which a failure drowns.
void withoutThePlatformsExcuses(QtMsgType type, const QMessageLogContext& context, const QString& text) {
    if (!text.startsWith(QLatin1String("This plugin does not support "))) others(type, context, text);
}

}  // namespace

int main(int argc, char** argv) {
    ::testing::InitGoogleTest(&argc, argv);
    others = qInstallMessageHandler(withoutThePlatformsExcuses);
    const QTemporaryDir home;
    for (const char* name : {"XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME"})
        qputenv(name, home.path().toLocal8Bit());
    handpiece::desktop::Application application(argc, argv);
    QApplication::setApplicationName(QStringLiteral("handpiece-test"));
    QApplication::setQuitOnLastWindowClosed(false);
    return handpiece::test::runChosen(argc, argv);
}
