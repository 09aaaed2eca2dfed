// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Whom to ask for file names and about unsaved work; tests put their own answers here.

#include <QString>
#include <functional>

class QWidget;

namespace handpiece::desktop {

class Settings;

struct Questions {
    enum class Unsaved { save, discard, cancel };
    Questions(const Settings& settings, QWidget* window);

    std::function<QString(const QString&title, const QString&start, const QString&filter)> fileToOpen, fileToSave;
    std::function<Unsaved()> unsaved;

    /// Where a person's files were last time.
    [[nodiscard]] QString startFolder() const;
    /// A file to read, from startFolder(); empty: cancelled.
    [[nodiscard]] QString open(const QString& title, const QString& filter) const;
    /// A file to write, called so in startFolder() unless it has a folder of its own, with this extension (".stl") if
    /// none is typed.
    [[nodiscard]] QString save(const QString& title, const QString& name, const QString& filter,
                               const QString& extension) const;

  private:
    const Settings& settings_;
};

}  // namespace handpiece::desktop
