// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/exercise/exercise_steps.h"

#include <QCoreApplication>
#include <QLocale>
#include <algorithm>

#include "desktop/features/exercise/progress_dialog.h"

namespace handpiece::desktop {

std::optional<Reached> reachedIn(const std::vector<school::Attempt>& attempts) {
    if (attempts.empty()) return {};
    Reached reached;
    for (const school::Attempt& attempt : attempts) {
        if (!areComparable(attempt, attempts.back())) continue;
        ++reached.attempts;
        if (!attempt.isWhole()) continue;
        reached.bestPercent = std::max(reached.bestPercent.value_or(0.0), attempt.percent());
        reached.isPassed = reached.isPassed || attempt.passed == "yes";
    }
    return reached;
}

QString entryWords(const QString& title, const std::optional<Reached>& reached, bool isDue) {
    QString words = title;
    if (reached && reached->bestPercent)
        words = QCoreApplication::translate("ExerciseSteps", "%1 (%2 %)")
                    .arg(title, QLocale().toString(*reached->bestPercent, 'f', 0));
    if (reached && reached->isPassed) words.prepend(QStringLiteral("✓ "));
    return isDue ? QCoreApplication::translate("ExerciseSteps", "%1 (due)").arg(words) : words;
}

QString bestWords(const Reached& reached) {
    const QString count = QLocale().toString(reached.attempts);
    return reached.bestPercent
               ? QCoreApplication::translate("ExerciseSteps", "Best so far: %1 %. Attempts: %2")
                     .arg(QLocale().toString(*reached.bestPercent, 'f', 0), count)
               : QCoreApplication::translate("ExerciseSteps", "Attempts so far: %1; of none could all be measured.")
                     .arg(count);
}

}  // namespace handpiece::desktop
