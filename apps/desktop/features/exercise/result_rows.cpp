// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/exercise/result_rows.h"

#include <QCoreApplication>
#include <QLocale>
#include <QStringList>
#include <algorithm>

#include "desktop/features/exercise/assessment_words.h"
#include "handpiece/app/report/advice.h"

namespace handpiece::desktop {
namespace {

QString phrased(const char* text) {
    return QCoreApplication::translate("Assessment", text);
}

/// Of the spectral arc length: the smoothest reach has -1.4; from where on a hand counts as even is a judgement of the
/// project (docs/assessment.md).
constexpr double kEven = -2.5, kFairlyEven = -5.0;

QString evenness(double value) {
    const char* words = value >= kEven         ? QT_TRANSLATE_NOOP("Assessment", "even (%1)")
                        : value >= kFairlyEven ? QT_TRANSLATE_NOOP("Assessment", "fairly even (%1)")
                                               : QT_TRANSLATE_NOOP("Assessment", "uneven (%1)");
    return phrased(words).arg(QLocale().toString(value, 'f', 1));
}

QString minutes(double seconds) {
    const auto whole = static_cast<qint64>(seconds + 0.5);
    return phrased(QT_TRANSLATE_NOOP("Assessment", "%1:%2 min"))
        .arg(whole / 60)
        .arg(whole % 60, 2, 10, QLatin1Char('0'));
}

QString fromStd(const std::string& text) {
    return QString::fromStdString(text);
}

/// What keeps a row from all its points, the weightiest first.
QString whyNot(const course::FinishedWork& work, const score::CriterionScore& c, const report::Advice& advice) {
    if (c.standing == score::Standing::leftOut)
        return phrased(QT_TRANSLATE_NOOP("Assessment", "not judged with this device"));
    if (c.standing != score::Standing::judged) return saidWords(c.reason);
    QStringList why;
    if (c.critical == score::Verdict::yes) why << phrased(QT_TRANSLATE_NOOP("Assessment", "critical error"));
    const bool isBest = work.rubric.bands.empty() || c.band.empty() || c.band == work.rubric.bands.front().id;
    if (!isBest) why << bandTitle(work.rubric, c.band);
    if (!advice.fault.empty()) why << fromStd(advice.fault);
    if (c.borderline)
        why << phrased(QT_TRANSLATE_NOOP("Assessment", "at the border, within ± %1: the teacher decides"))
                   .arg(QLocale().toString(c.uncertainty, 'g', 2));
    if (c.points && c.ownPoints - *c.points >= 0.05)
        why << phrased(QT_TRANSLATE_NOOP("Assessment", "%1 points times %2: the work is not finished"))
                   .arg(QLocale().toString(c.ownPoints, 'f', 1), QLocale().toString(*c.points / c.ownPoints, 'f', 2));
    return why.join(QLatin1Char('\n'));
}

}  // namespace

QString plainValue(const score::CriterionScore& c) {
    if (!c.value) return phrased(QT_TRANSLATE_NOOP("Assessment", "not measured"));
    if (c.measure == "smoothness") return evenness(*c.value);
    if (c.unit == "s") return minutes(*c.value);
    if (c.unit == "mm" && *c.value < 20.0)
        return QLocale().toString(*c.value, 'f', 2) + QStringLiteral(" mm");  // as finely as it is asked
    return fromStd(report::amountText(*c.value, c.unit));
}

ResultRow resultRow(const course::FinishedWork& work, const score::CriterionScore& c) {
    ResultRow row;
    row.name = titleOf(work.rubric, c.id);
    row.value = plainValue(c);
    row.exact = valueWords(c);
    const report::Advice advice = report::adviceOf(c, work.rubric, work.bearings);
    if (const rubric::Criterion* asks = work.rubric.criterion(c.id))
        row.asked = fromStd(report::wantedText(report::wantedOf(*asks, work.rubric), asks->unit));
    row.points = c.points            ? pointsWords(*c.points, c.maxPoints)
                 : c.maxPoints > 0.0 ? phrased(QT_TRANSLATE_NOOP("Assessment", "not counted"))
                                     : QString();
    row.why = whyNot(work, c, advice);
    row.advice = fromStd(advice.words);
    row.exercise = advice.exercise == work.task->id ? std::string() : advice.exercise;
    row.at = advice.at != nullptr ? advice.at : report::placeOf(c, report::Off::no);
    return row;
}

QString placeWords(const ResultRow& row) {
    QString words =
        row.asked.isEmpty()
            ? phrased(QT_TRANSLATE_NOOP("Assessment", "%1: %2")).arg(row.name, row.value)
            : phrased(QT_TRANSLATE_NOOP("Assessment", "%1: %2, asked: %3")).arg(row.name, row.value, row.asked);
    return row.advice.isEmpty() ? words : words + QLatin1Char('\n') + row.advice;
}

QString criticalWords(const course::FinishedWork& work, const score::CriticalError& error) {
    const auto& all = work.result.assessment.criteria;
    const auto of = std::find_if(all.begin(), all.end(), [&](const auto& c) { return c.id == error.criterion; });
    return fromStd(of == all.end() ? report::whatHappened(work.rubric, error.criterion)
                                   : report::whatHappened(work.rubric, *of, work.bearings));
}

}  // namespace handpiece::desktop
