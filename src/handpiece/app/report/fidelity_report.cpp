// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/fidelity_report.h"

#include <algorithm>

#include "handpiece/app/report/plot.h"
#include "handpiece/app/report/report_html.h"
#include "handpiece/base/config/words.h"

namespace handpiece::report {

using config::words;
using fidelity::Finding, fidelity::Verdict;

std::string fidelityReport(const fidelity::Report& r) {
    const auto count = [&](Verdict v) {
        return std::count_if(r.findings.begin(), r.findings.end(), [v](const Finding& f) { return f.verdict == v; });
    };
    const auto orDash = [](const std::string& text) { return text.empty() ? std::string("-") : text; };
    HtmlReport page(words()("fidelity.page-title", r.device.model));
    page.paragraph(words()("fidelity.page-driver", r.device.driver, orDash(r.device.version), orDash(r.device.serial),
                           r.durationS),
                   HtmlReport::Tone::note);
    page.paragraph(r.machine, HtmlReport::Tone::note);
    page.paragraph(
        words()("fidelity.page-sum", r.passed ? words()("fidelity.fit") : words()("fidelity.not-fit"),
                count(Verdict::pass), count(Verdict::warn), count(Verdict::fail), count(Verdict::notMeasured)),
        r.passed ? HtmlReport::Tone::good : HtmlReport::Tone::bad);
    std::vector<std::vector<std::string>> rows;
    for (const Finding& f : r.findings)
        rows.push_back({nameOf(f, words()), words()(fmt::format("fidelity.verdict.{}", idOf(f.verdict))),
                        words()(f.value), words()(f.against), words()(f.remedy)});
    page.table({words()("fidelity.finding"), words()("fidelity.verdict-head"), words()("fidelity.measured"),
                words()("fidelity.held-against"), words()("fidelity.to-do")},
               rows);
    const auto draw = [&](const std::vector<double>& counts, const std::string& title, bool fromZero) {
        const Histogram histogram = histogramSvg(counts, title, words()("fidelity.microseconds"), fromZero);
        if (histogram.svg.empty()) return;
        page.figure(histogram.svg,
                    histogram.beyond > 0.0
                        ? words()("fidelity.histogram-caption-beyond", title, histogram.total, histogram.beyond)
                        : words()("fidelity.histogram-caption", title, histogram.total));
    };
    draw(r.periodHistogramUs, words()("fidelity.periods-of-the-servo"), false);
    draw(r.latenessHistogramUs, words()("fidelity.lateness-of-the-tick"), true);
    page.paragraph(words()("fidelity.page-note"), HtmlReport::Tone::note);
    return page.text();
}

}  // namespace handpiece::report
