// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/this_language.h"

#include <QLocale>

namespace handpiece::desktop {

QString inThisLanguage(const cases::Texts& texts) {
    const std::string_view text = cases::inLanguage(texts, QLocale().bcp47Name().toStdString());
    return QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size()));
}

}  // namespace handpiece::desktop
