// SPDX-License-Identifier: Apache-2.0
#include "device/install.h"

#include <QPointer>

#include "device/device_page.h"
#include "device/first_plug_in.h"
#include "shell/main_window.h"

namespace handpiece::desktop {
namespace {

template <class Dialog>
void bringForward(Dialog* dialog) {
    dialog->show();
    dialog->raise();
    dialog->activateWindow();
}

}  // namespace

void installDeviceDialogs(MainWindow& window, Simulator& simulator, Settings& settings, bool realTime) {
    auto page = std::make_shared<QPointer<DevicePage>>();
    window.openDevicePage = [&window, &simulator, &settings, page] {
        if (!*page) {
            *page = new DevicePage(
                simulator, settings,
                [&window](const QString& title, const QString& start, const QString& filter) {
                    return window.questions.fileToSave(title, start, filter);
                },
                &window);
            (*page)->setAttribute(Qt::WA_DeleteOnClose);
        }
        bringForward(page->data());
    };
    auto steps = std::make_shared<QPointer<FirstPlugIn>>();
    window.setUpDevice = [&window, &simulator, steps, realTime] {
        if (!simulator.hands().current()) return;
        if (!*steps) {
            *steps = new FirstPlugIn(simulator, realTime, &window);
            (*steps)->setAttribute(Qt::WA_DeleteOnClose);
        }
        bringForward(steps->data());
    };
}

}  // namespace handpiece::desktop
