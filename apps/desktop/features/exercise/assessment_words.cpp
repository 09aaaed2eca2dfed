// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/exercise/assessment_words.h"

#include <QCoreApplication>
#include <QLocale>
#include <QStringList>
#include "handpiece/app/report/assessment_words.h"

namespace handpiece::desktop {
namespace {

QString said(const char* text) {
    return QCoreApplication::translate("Assessment", text);
}

QString number(double value, int decimals) {
    return QLocale().toString(value, 'f', decimals);
}

/// As many decimals as the uncertainty bears.
int decimalsFor(double uncertainty) {
    return uncertainty >= 10.0 ? 0 : uncertainty >= 1.0 ? 1 : uncertainty >= 0.1 ? 2 : 3;
}

}  // namespace

QString titleOf(const rubric::Rubric& rubric, const std::string& criterion) {
    const rubric::Criterion* found = rubric.criterion(criterion);
    return found && !found->title.empty() ? inThisLanguage(found->title) : QString::fromStdString(criterion);
}

QString bandTitle(const rubric::Rubric& rubric, const std::string& band) {
    for (const rubric::BandName& name : rubric.bands)
        if (name.id == band) return inThisLanguage(name.title);
    return QString::fromStdString(band);
}

QString whatIsJudged(const rubric::Rubric& rubric) {
    QStringList lines;
    if (rubric.completeness && !rubric.completeness->words.empty()) lines << inThisLanguage(rubric.completeness->words);
    for (const rubric::Criterion& c : rubric.criteria) {
        if (!c.isGraded() && !c.critical) continue;
        QString line = titleOf(rubric, c.id);
        const QString unit = QString::fromStdString(c.unit);
        if (!rubric.bands.empty())
            for (const rubric::Band& band : c.bands)
                if (band.id == rubric.bands.front().id) {
                    const QString name = bandTitle(rubric, band.id);
                    if (band.from && band.to)
                        line += said(QT_TRANSLATE_NOOP("Assessment", "; %1: %2 to %3 %4"))
                                    .arg(name, number(*band.from, 2), number(*band.to, 2), unit);
                    else if (band.from)
                        line += said(QT_TRANSLATE_NOOP("Assessment", "; %1: at least %2 %3"))
                                    .arg(name, number(*band.from, 2), unit);
                    else if (band.to)
                        line += said(QT_TRANSLATE_NOOP("Assessment", "; %1: at most %2 %3"))
                                    .arg(name, number(*band.to, 2), unit);
                }
        if (c.isGraded()) line = said(QT_TRANSLATE_NOOP("Assessment", "%1 (%2 points)")).arg(line, number(c.weight, 0));
        if (c.critical)
            line +=
                said(QT_TRANSLATE_NOOP("Assessment", "; critical error: %1")).arg(inThisLanguage(c.critical->title));
        lines << line;
    }
    return lines.join(QLatin1Char('\n'));
}

QString valueWords(const score::CriterionScore& c) {
    if (!c.value) return {};
    const int decimals = decimalsFor(c.uncertainty);
    QString words = number(*c.value, decimals);
    if (c.uncertainty > 0.0) words += QStringLiteral(" ± ") + number(c.uncertainty, decimals);
    return c.unit.empty() ? words : words + QLatin1Char(' ') + QString::fromStdString(c.unit);
}

QString saidWords(const std::string& english) {
    return QString::fromStdString(report::said(english));
}

QString passedWords(score::Passed passed) {
    switch (passed) {
        case score::Passed::yes:
            return said(QT_TRANSLATE_NOOP("Assessment", "Passed"));
        case score::Passed::no:
            return said(QT_TRANSLATE_NOOP("Assessment", "Not passed"));
        case score::Passed::teacher:
            return said(QT_TRANSLATE_NOOP("Assessment", "The teacher decides"));
    }
    return {};
}

QString pointsWords(double points, double most) {
    return said(QT_TRANSLATE_NOOP("Assessment", "%1 of %2")).arg(number(points, 1), number(most, 1));
}

}  // namespace handpiece::desktop
