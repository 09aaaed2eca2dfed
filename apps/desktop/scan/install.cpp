// SPDX-License-Identifier: Apache-2.0
#include "scan/install.h"

#include <QPointer>

#include "scan/scan_wizard.h"
#include "shell/main_window.h"
#include "shell/settings.h"

namespace handpiece::desktop {

void installScanWizard(MainWindow& window) {
    auto open = std::make_shared<QPointer<ScanWizard>>();
    window.newCaseFromScan = [&window, open](const QString& path) {
        if (!*open) {
            *open = new ScanWizard(unfinishedScanFile(), workFolder(), &window);
            (*open)->setAttribute(Qt::WA_DeleteOnClose);
            QObject::connect(open->data(), &ScanWizard::tryNow, &window, [&window, open](const QString& place) {
                if (*open) (*open)->close();
                window.raise();
                window.activateWindow();
                window.openFile(place);
            });
        }
        (*open)->show();
        (*open)->raise();
        (*open)->activateWindow();
        if (!path.isEmpty()) (*open)->take(path);
    };
}

}  // namespace handpiece::desktop
