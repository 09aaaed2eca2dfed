// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/scan_feature.h"

#include <QDir>
#include <QFileInfo>

#include "desktop/work/simulator.h"

namespace handpiece::desktop {
namespace {

using Command = ScanFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::anew, "actionNewScan", QT_TRANSLATE_NOOP("Commands", "New case from scan..."),
     QT_TRANSLATE_NOOP("Commands", "Make a tooth to be cut out of a CT: slices, a DICOM folder, a volume"), "views",
     "Ctrl+N", in(Shelf::file, 2), exercise::Operation::elsewhere},
};

/// A folder that is no case, no attempt and no exercise, or a file whose name only scans have.
bool mayBeScan(const QFileInfo& info) {
    if (info.isDir()) {
        const QDir folder(info.absoluteFilePath());
        return !folder.exists(QStringLiteral("case.toml")) && !folder.exists(QStringLiteral("attempt.toml")) &&
               !folder.exists(QStringLiteral("exercise.toml")) && !folder.isEmpty();
    }
    static const QStringList endings{QStringLiteral("nrrd"), QStringLiteral("nhdr"), QStringLiteral("nii"),
                                     QStringLiteral("mha"),  QStringLiteral("mhd"),  QStringLiteral("dcm"),
                                     QStringLiteral("zip"),  QStringLiteral("tif"),  QStringLiteral("tiff")};
    const QString name = info.fileName().toLower();
    return endings.contains(info.suffix().toLower()) || name.endsWith(QLatin1String(".nii.gz")) ||
           name == QLatin1String("dicomdir") || name == QLatin1String("scan.toml");
}

}  // namespace

ScanFeature::ScanFeature(const FeatureContext& context) : Feature(context), commands_(window_.commands(), kCommands) {
    on(commands_[Command::anew], [this] { open(); });
    window_.openersBeside.push_back([this](const QFileInfo& info) {
        if (!mayBeScan(info)) return false;
        open(info.absoluteFilePath());
        return true;
    });
}

void ScanFeature::open(const QString& path) {
    if (!wizard_) {
        wizard_ = new ScanWizard(unfinishedScanFile(), workFolder(), &window_);
        wizard_->setAttribute(Qt::WA_DeleteOnClose);
        connect(wizard_.data(), &ScanWizard::tryNow, this, [this](const QString& place) {
            if (wizard_) wizard_->close();
            window_.raise();
            window_.activateWindow();
            // The wizard wrote it.
            simulator_.outside()->made(toPath(place));
            window_.openFile(place);
        });
    }
    wizard_->show();
    wizard_->raise();
    wizard_->activateWindow();
    if (!path.isEmpty()) wizard_->take(path);
}

}  // namespace handpiece::desktop
