// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/radiograph/radiograph_feature.h"

#include "desktop/features/radiograph/radiograph_dialog.h"
#include "desktop/work/simulator.h"
#include "handpiece/scan/volume/write_radiograph.h"

namespace handpiece::desktop {
namespace {

using Command = RadiographFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::radiograph, "actionRadiograph", QT_TRANSLATE_NOOP("Commands", "Radiograph..."),
     QT_TRANSLATE_NOOP("Commands", "A simulated bitewing or periapical radiograph of the tooth that is open"),
     "picture", "Ctrl+Shift+P", in(Shelf::tools, 30)},
};

}  // namespace

RadiographFeature::RadiographFeature(const FeatureContext& context)
    : Feature(context), commands_(window_.commands(), kCommands), dialog_(new RadiographDialog(&window_)) {
    on(commands_[Command::radiograph], [this] {
        dialog_->show();
        dialog_->raise();
        dialog_->activateWindow();
    });
    window_.commands().enableWhile(commands_[Command::radiograph],
                                   [this] { return simulator_.toothCase() != nullptr; });
    connect(dialog_, &RadiographDialog::saveRequested, this, &RadiographFeature::save);
}

void RadiographFeature::showDocument() {
    dialog_->setTooth(simulator_.toothCase(), simulator_.tooth(), [this] { return simulator_.state(); });
}

void RadiographFeature::save() {
    if (!dialog_->taken()) return;
    const radiograph::Radiograph taken = *dialog_->taken();
    const std::string view(radiograph::nameOf(taken.settings.view));
    const QString file = window_.questions.save(tr("Save the radiograph"), QString::fromStdString(view) + ".png",
                                                tr("PNG (*.png);;DICOM (*.dcm)"), QStringLiteral(".png"));
    if (file.isEmpty()) return;
    try {
        volume::writeRadiograph(
            {taken.picture.width, taken.picture.height, taken.picture.grey, taken.projection.pixelMm, view,
             taken.fdiNumber, taken.settings.kv, taken.settings.focalSpotMm, taken.settings.sourceMm},
            toPath(file));
    } catch (const core::Error& e) {
        window_.showProblem(problemOf(e));
    }
}

}  // namespace handpiece::desktop
