// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/settings.h"

#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QRegularExpression>
#include <QStandardPaths>
#include <algorithm>
#include <cmath>

#include "desktop/framework/problem.h"

namespace handpiece::desktop {
namespace {

/// QSettings takes nearly anything for an ini file and loses the rest at the next save: whoever damaged it would like
/// to have it back, so lines are looked at first.
bool isIni(const QString& path) {
    QFile file(path);
    if (!file.exists()) return true;
    if (!file.open(QIODevice::ReadOnly)) return false;
    const QByteArray all = file.readAll();
    if (all.contains('\0')) return false;
    static const QRegularExpression line(QStringLiteral("^\\s*(;.*|#.*|\\[[^\\]]+\\]|[^=\\[\\]]+=.*)?$"));
    for (const QByteArray& row : all.split('\n'))
        if (!line.match(QString::fromUtf8(row).trimmed()).hasMatch()) return false;
    return true;
}

}  // namespace

Folders Folders::standard() {
    const auto at = [](QStandardPaths::StandardLocation location) {
        return toPath(QStandardPaths::writableLocation(location));
    };
    return {at(QStandardPaths::AppConfigLocation) / "handpiece.ini", at(QStandardPaths::AppDataLocation) / "sessions",
            at(QStandardPaths::CacheLocation) / "starter"};
}

QString workFolder() {
    QString made;
    for (const auto location : {QStandardPaths::DocumentsLocation, QStandardPaths::HomeLocation}) {
        const QString folder = QStandardPaths::writableLocation(location);
        if (QFileInfo(folder).isDir() && QFileInfo(folder).isWritable()) return folder;
        if (made.isEmpty() && !folder.isEmpty()) made = folder;
    }
    return !made.isEmpty() && QDir().mkpath(made) ? made : QDir::tempPath();
}

Settings::Settings(const std::filesystem::path& file) {
    const QString path = toQString(file);
    bool broken = !isIni(path);
    if (!broken) {
        settings_ = std::make_unique<QSettings>(path, QSettings::IniFormat);
        broken = settings_->status() == QSettings::FormatError;
    }
    if (broken) {
        settings_.reset();
        setAside_ = path + QStringLiteral(".broken");
        QFile::remove(setAside_);
        if (!QFile::rename(path, setAside_)) setAside_ = path;
        settings_ = std::make_unique<QSettings>(path, QSettings::IniFormat);
    }
}

QVariant Settings::value(const QString& key, const QVariant& otherwise) const {
    return settings_->value(key, otherwise);
}

double Settings::number(const QString& key, double otherwise, double least, double most) const {
    bool ok = false;
    const double v = settings_->value(key).toDouble(&ok);
    return ok && std::isfinite(v) ? std::clamp(v, least, most) : otherwise;
}

void Settings::set(const QString& key, const QVariant& value) {
    settings_->setValue(key, value);
}
void Settings::remove(const QString& key) {
    settings_->remove(key);
}

bool Settings::sync() {
    settings_->sync();
    return settings_->status() == QSettings::NoError;
}

QStringList Settings::recentFiles() const {
    return settings_->value(QStringLiteral("files/recent")).toStringList();
}

void Settings::addRecent(const QString& file) {
    QStringList files = recentFiles();
    files.removeAll(file);
    files.prepend(file);
    set(QStringLiteral("files/recent"), QStringList(files.mid(0, 10)));
}

}  // namespace handpiece::desktop
