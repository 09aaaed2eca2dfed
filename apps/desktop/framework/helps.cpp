// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/helps.h"

#include <QCoreApplication>
#include <array>

namespace handpiece::desktop {
namespace {

// In the order of Help.
constexpr std::array<const char*, cases::kHelps.size()> kHelpWords{
    QT_TRANSLATE_NOOP("Exercise", "Undo, redo, reset"),
    QT_TRANSLATE_NOOP("Exercise", "Reset"),
    QT_TRANSLATE_NOOP("Exercise", "Depths, calliper, depth stop"),
    QT_TRANSLATE_NOOP("Exercise", "Colours of the tissues, legend"),
    QT_TRANSLATE_NOOP("Exercise", "Section"),
    QT_TRANSLATE_NOOP("Exercise", "Hidden tissues, the tooth before, before and after"),
    QT_TRANSLATE_NOOP("Exercise", "First steps, hints, landmarks, depth stop"),
    QT_TRANSLATE_NOOP("Exercise", "Removed volumes, report"),
    QT_TRANSLATE_NOOP("Exercise", "Mouth mirror"),
    QT_TRANSLATE_NOOP("Exercise", "Scale bar"),
    QT_TRANSLATE_NOOP("Exercise", "Chart of the mouth"),
    QT_TRANSLATE_NOOP("Exercise", "Calliper"),
    QT_TRANSLATE_NOOP("Exercise", "Before and after"),
    QT_TRANSLATE_NOOP("Exercise", "Direct view: work by mirror"),
};

// In the order of exercise::Operation.
constexpr std::array<const char*, exercise::kOperationCount> kOperationWords{
    QT_TRANSLATE_NOOP("Exercise", "undo"),
    QT_TRANSLATE_NOOP("Exercise", "redo"),
    QT_TRANSLATE_NOOP("Exercise", "reset"),
    QT_TRANSLATE_NOOP("Exercise", "depth stop"),
    QT_TRANSLATE_NOOP("Exercise", "depths"),
    QT_TRANSLATE_NOOP("Exercise", "measuring a depth"),
    QT_TRANSLATE_NOOP("Exercise", "measuring to the pulp"),
    QT_TRANSLATE_NOOP("Exercise", "calliper"),
    QT_TRANSLATE_NOOP("Exercise", "removed depth"),
    QT_TRANSLATE_NOOP("Exercise", "colours of the tissues"),
    QT_TRANSLATE_NOOP("Exercise", "section"),
    QT_TRANSLATE_NOOP("Exercise", "hidden tissues"),
    QT_TRANSLATE_NOOP("Exercise", "before and after"),
    QT_TRANSLATE_NOOP("Exercise", "mouth mirror"),
    QT_TRANSLATE_NOOP("Exercise", "direct view"),
    QT_TRANSLATE_NOOP("Exercise", "change between direct view and mirror"),
    QT_TRANSLATE_NOOP("Exercise", "scale bar"),
    QT_TRANSLATE_NOOP("Exercise", "chart of the mouth"),
    QT_TRANSLATE_NOOP("Exercise", "hints"),
    QT_TRANSLATE_NOOP("Exercise", "removed volumes"),
    QT_TRANSLATE_NOOP("Exercise", "report"),
    QT_TRANSLATE_NOOP("Exercise", "other work"),
};

}  // namespace

std::optional<Help> helpOf(std::string_view name) {
    for (std::size_t i = 0; i < cases::kHelps.size(); ++i)
        if (cases::kHelps[i] == name) return static_cast<Help>(i);
    return std::nullopt;
}

QString helpWords(Help help) {
    return QCoreApplication::translate("Exercise", kHelpWords[static_cast<std::size_t>(help)]);
}

QString operationWords(exercise::Operation operation) {
    return QCoreApplication::translate("Exercise", kOperationWords[static_cast<std::size_t>(operation)]);
}

}  // namespace handpiece::desktop
