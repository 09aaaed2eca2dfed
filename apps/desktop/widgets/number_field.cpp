// SPDX-License-Identifier: Apache-2.0
#include "desktop/widgets/number_field.h"

#include <QKeySequence>

namespace handpiece::desktop {

QString plainFigures(QString text, bool commaIsPoint) {
    constexpr char16_t kZero = 0xff10, kNine = 0xff19, kPoint = 0xff0e, kComma = 0xff0c, kFullStop = 0x3002,
                       kMinus = 0xff0d, kLongVowel = 0x30fc, kMathMinus = 0x2212;
    for (QChar& c : text) {
        const char16_t at = c.unicode();
        if (at >= kZero && at <= kNine)
            c = QChar(static_cast<char16_t>(u'0' + (at - kZero)));
        else if (at == kPoint || at == kFullStop)
            c = QLatin1Char('.');
        else if (at == kMinus || at == kLongVowel || at == kMathMinus)
            c = QLatin1Char('-');
        else if (at == kComma)
            c = QLatin1Char(',');
        if (commaIsPoint && c == QLatin1Char(',')) c = QLatin1Char('.');
    }
    return text;
}

bool isOfCommand(const QKeyEvent& key) {
    if (key.key() >= Qt::Key_F1 && key.key() <= Qt::Key_F35) return true;
    if ((key.modifiers() & (Qt::ControlModifier | Qt::AltModifier)) == 0) return false;
    if (key.key() < Qt::Key_A || key.key() > Qt::Key_Z) return false;
    for (const auto edits : {QKeySequence::SelectAll, QKeySequence::Copy, QKeySequence::Cut, QKeySequence::Paste,
                             QKeySequence::Undo, QKeySequence::Redo})
        if (key.matches(edits)) return false;
    return true;
}

}  // namespace handpiece::desktop
