// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What went wrong, for a person: an id, the sentence in the person's language, where, and what to do.

#include <QString>
#include <QStringList>
#include <exception>
#include <filesystem>

#include "handpiece/base/core/error.h"

namespace handpiece::desktop {

/// `id` is empty for what has no translation: then the texts are the library's own, and say so.
struct Problem {
    QString id;
    QStringList arguments;
    QString what, where, remedy;
};

/// In the language of now where its id is known here; else its own words, marked as technical.
[[nodiscard]] Problem problemOf(const core::Error& error);
/// One of the window's own, by its id ("case-vanished", "no-session", ...), in the language of now.
[[nodiscard]] Problem problemById(const QString& id, const QStringList& arguments = {}, const QString& where = {});
/// The ids there are.
[[nodiscard]] QStringList problemIds();

[[nodiscard]] QString toQString(const std::filesystem::path& path);
[[nodiscard]] std::filesystem::path toPath(const QString& text);

}  // namespace handpiece::desktop
