// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/questions.h"

#include <QDir>
#include <QFileDialog>
#include <QFileInfo>

#include "desktop/framework/settings.h"

namespace handpiece::desktop {

Questions::Questions(const Settings& settings, QWidget* window) : settings_(settings) {
    fileToOpen = [window](const QString& title, const QString& start, const QString& filter) {
        return QFileDialog::getOpenFileName(window, title, start, filter);
    };
    fileToSave = [window](const QString& title, const QString& start, const QString& filter) {
        return QFileDialog::getSaveFileName(window, title, start, filter);
    };
}

QString Questions::startFolder() const {
    // The folder of last time may be gone: a stick that was pulled out.
    const QString last = settings_.value(QStringLiteral("files/folder")).toString();
    return !last.isEmpty() && QFileInfo(last).isDir() ? last : workFolder();
}

QString Questions::open(const QString& title, const QString& filter) const {
    return fileToOpen(title, startFolder(), filter);
}

QString Questions::save(const QString& title, const QString& name, const QString& filter,
                        const QString& extension) const {
    QString file = fileToSave(title, QDir(startFolder()).filePath(name), filter);
    if (!file.isEmpty() && QFileInfo(file).suffix().isEmpty()) file += extension;
    return file;
}

}  // namespace handpiece::desktop
