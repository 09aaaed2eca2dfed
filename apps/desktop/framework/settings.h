// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the program remembers between two starts, and where it keeps things.

#include <QSettings>
#include <QString>
#include <QStringList>
#include <QVariant>
#include <filesystem>
#include <memory>

namespace handpiece::desktop {

/// Where the program keeps things of its own. All below the person's own folders; made when first used.
struct Folders {
    std::filesystem::path settingsFile, sessions, starters;
    /// As QStandardPaths has them (XDG_CONFIG_HOME, XDG_DATA_HOME, XDG_CACHE_HOME).
    [[nodiscard]] static Folders standard();
};

/// Where a person's own files are looked for and put until they choose: Documents where there is such a folder, else
/// what there is and can be written.
[[nodiscard]] QString workFolder();

/// An ini file. A broken one is set aside and told of, never fatal. One thread: the window's.
class Settings {
  public:
    explicit Settings(const std::filesystem::path& file);

    /// Where the broken file lies now; empty when it could be read.
    [[nodiscard]] const QString& setAside() const noexcept { return setAside_; }
    [[nodiscard]] QVariant value(const QString& key, const QVariant& otherwise = {}) const;
    /// A number within limits; `otherwise` for what is none.
    [[nodiscard]] double number(const QString& key, double otherwise, double least, double most) const;
    void set(const QString& key, const QVariant& value);
    void remove(const QString& key);
    /// To the disk; false when that is refused.
    bool sync();

    [[nodiscard]] QStringList recentFiles() const;
    /// First in the list, once, ten at most.
    void addRecent(const QString& file);

  private:
    std::unique_ptr<QSettings> settings_;
    QString setAside_;
};

}  // namespace handpiece::desktop
