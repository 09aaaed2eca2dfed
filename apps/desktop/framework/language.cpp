// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/language.h"

#include <QCoreApplication>
#include <QLibraryInfo>
#include <QLocale>

#include "handpiece/base/config/words.h"

namespace handpiece::desktop {

// Qt 6.4's own Japanese misspells this key: our file has it right, and is asked first.
[[maybe_unused]] static const char* const kMisspelt = QT_TRANSLATE_NOOP("QShortcut", "Backspace");

QStringList Language::codes() {
    return {QStringLiteral("en"), QStringLiteral("ja")};
}

QString Language::nameOf(const QString& code) {
    return code == QLatin1String("ja") ? QStringLiteral("日本語") : QStringLiteral("English");
}

bool Language::use(const QString& wanted) {
    QString code = wanted;
    if (!codes().contains(code))
        code = QLocale::system().language() == QLocale::Japanese ? QStringLiteral("ja") : QStringLiteral("en");
    for (auto* translator : {&ours_, &qts_}) {
        if (*translator) QCoreApplication::removeTranslator(translator->get());
        *translator = std::make_unique<QTranslator>();
    }
    code_ = code;
    config::useLanguage(code.toStdString());
    QLocale::setDefault(QLocale(code == QLatin1String("ja") ? QLocale::Japanese : QLocale::English,
                                code == QLatin1String("ja") ? QLocale::Japan : QLocale::UnitedKingdom));
    // Qt's own texts (OK, Cancel, file dialogs) are missing on some machines: those then stay English.
    if (qts_->load(QStringLiteral("qtbase_") + code, QLibraryInfo::path(QLibraryInfo::TranslationsPath)))
        QCoreApplication::installTranslator(qts_.get());
    const bool loaded = ours_->load(QStringLiteral(":/translations/handpiece_%1.qm").arg(code));
    if (loaded) QCoreApplication::installTranslator(ours_.get());
    const bool complete = code == QLatin1String("en") || (loaded && !ours_->isEmpty());
    return complete;
}

}  // namespace handpiece::desktop
