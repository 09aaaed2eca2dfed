// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The program's language: English, Japanese, or as the desktop's.

#include <QString>
#include <QStringList>
#include <QTranslator>
#include <memory>

namespace handpiece::desktop {

/// Loads translations into the application. One for a program.
class Language {
  public:
    /// "en", "ja".
    [[nodiscard]] static QStringList codes();
    /// In the language itself: "English", "日本語".
    [[nodiscard]] static QString nameOf(const QString& code);
    /// "system" or a code; widgets made from now on speak it. False when its translation is missing: then English.
    bool use(const QString& code);
    /// Of the two, the one in use.
    [[nodiscard]] const QString& code() const noexcept { return code_; }

  private:
    QString code_ = QStringLiteral("en");
    std::unique_ptr<QTranslator> ours_, qts_;
};

}  // namespace handpiece::desktop
