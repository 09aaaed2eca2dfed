// SPDX-License-Identifier: Apache-2.0
// What the window keeps between two starts: looks, keys, the eye's place by tooth.
#include <QCryptographicHash>

#include "desktop/view/key_bindings_dialog.h"
#include "panels/view_bar.h"
#include "shell/main_window.h"

namespace handpiece::desktop {
namespace {

QString text(const core::Vec3& v) {
    return QStringLiteral("%1 %2 %3").arg(v.x()).arg(v.y()).arg(v.z());
}
std::optional<core::Vec3> vecOf(const QString& text) {
    const QStringList parts = text.split(QLatin1Char(' '));
    if (parts.size() != 3) return std::nullopt;
    core::Vec3 v;
    for (int k = 0; k < 3; ++k) {
        bool ok = false;
        v[k] = parts[k].toDouble(&ok);
        if (!ok || !std::isfinite(v[k])) return std::nullopt;
    }
    return v;
}

}  // namespace

void MainWindow::recallLook() {
    view::Look look = view_->look();
    const auto number = [this](const char* key, int otherwise, int most) {
        return static_cast<int>(settings_.number(QStringLiteral("look/") + QLatin1String(key), otherwise, 0, most));
    };
    const auto flag = [this](const char* key, bool otherwise) {
        return settings_.value(QStringLiteral("look/") + QLatin1String(key), otherwise).toBool();
    };
    look.quality = static_cast<view::Quality>(number("quality", static_cast<int>(look.quality), 2));
    look.palette = static_cast<view::Palette>(number("palette", static_cast<int>(look.palette), 2));
    look.stereo = static_cast<view::Stereo>(number("stereo", 0, 2));
    look.wet = flag("wet", look.wet);
    look.debris = flag("debris", look.debris);
    look.spray = flag("spray", look.spray);
    look.shadows = flag("shadows", look.shadows);
    look.turbine = flag("turbine", look.turbine);
    look.scaleBar = flag("scaleBar", look.scaleBar);
    view_->setLook(look);
    looks_->setLook(look);
}

void MainWindow::recallBindings() {
    KeyBindings bindings;
    const QVariantMap chosen = settings_.value(QStringLiteral("window/bindings")).toMap();
    bindings.giveWayTo(chosen);
    bindings.fromMap(chosen);
    view_->setBindings(bindings);
    connect((*actions_)["actionBindings"], &QAction::triggered, this, &MainWindow::editBindings);
}

void MainWindow::editBindings() {
    setTouching(false);
    auto* dialog = new KeyBindingsDialog(view_->bindings(), this);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    connect(dialog, &QDialog::accepted, this, [this, dialog] {
        view_->setBindings(dialog->bindings());
        settings_.set(QStringLiteral("window/bindings"), dialog->bindings().toMap());
    });
    dialog->open();
}

namespace {
QString eyeKey(const std::filesystem::path& file) {
    const QByteArray hash = QCryptographicHash::hash(QByteArray::fromStdString(file.string()), QCryptographicHash::Md5);
    return QStringLiteral("eyes/%1").arg(QLatin1String(hash.toHex().left(16)));
}
}  // namespace

void MainWindow::rememberEye() {
    if (!view_->hasTooth() || simulator_.document().caseFile.empty()) return;
    const view::Camera& eye = view_->camera();
    settings_.set(eyeKey(simulator_.document().caseFile),
                  QStringList{text(eye.eyeMm), text(eye.targetMm), text(eye.up)});
}

void MainWindow::recallEye() {
    const QStringList kept = settings_.value(eyeKey(simulator_.document().caseFile)).toStringList();
    std::optional<core::Vec3> eye, target, up;
    if (kept.size() == 3) {
        eye = vecOf(kept[0]);
        target = vecOf(kept[1]);
        up = vecOf(kept[2]);
    }
    view::Camera camera = view_->camera();
    if (eye && target && up && (*eye - *target).norm() > 1.0 && (*eye - *target).norm() < 1000.0 && up->norm() > 0.5) {
        camera.eyeMm = *eye;
        camera.targetMm = *target;
        camera.up = up->normalized();
        view_->setCamera(camera);
    } else if (const auto& exercise = simulator_.toothCase()->exercise; exercise && exercise->view) {
        camera.eyeMm = exercise->view->eyeMm;
        camera.targetMm = exercise->view->targetMm;
        camera.up = exercise->view->up;
        view_->setCamera(camera);
    } else {
        view_->showStandardView(view::StandardView::oblique);
    }
}

}  // namespace handpiece::desktop
