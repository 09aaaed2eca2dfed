// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/report_html.h"

#include <gtest/gtest.h>

#include "handpiece/app/report/fidelity_report.h"
#include "handpiece/app/report/plot.h"
#include "handpiece/base/config/words.h"

namespace handpiece::report::report_html_test {
namespace {

fidelity::Report checked() {
    fidelity::Report report;
    report.device.model = "A \"<b>&";
    report.device.driver = "simulated";
    fidelity::Finding f;
    f.id = "servo-period";
    f.value = config::phrase("fidelity.too-few-frames");
    f.verdict = fidelity::Verdict::fail;
    f.against = config::phrase("fidelity.servo-period-against");
    f.remedy = config::phrase("fidelity.off-and-on");
    report.findings = {f};
    report.periodHistogramUs = std::vector<double>(1200, 1.0);
    return report;
}

TEST(FidelityReport, SaysWhatWasFoundInTheProgramsLanguage) {
    const std::string page = fidelityReport(checked());
    EXPECT_NE(page.find("<html lang=\"en\">"), std::string::npos);
    for (const char* part :
         {"Servo period", "too few frames", "switch the device off and on", "<svg", "&lt;b&gt;&amp;"})
        EXPECT_NE(page.find(part), std::string::npos) << part;
    EXPECT_EQ(page.find("<b>"), std::string::npos);
    for (const char* outside : {"src=", "href="})
        EXPECT_EQ(page.find(outside), std::string::npos) << outside;
    config::useLanguage("ja");
    const std::string japanese = fidelityReport(checked());
    config::useLanguage("en");
    EXPECT_NE(japanese.find("<html lang=\"ja\">"), std::string::npos);
    for (const char* part : {"サーボの周期", "フレームが少なすぎます", "デバイスの電源を入れ直してください"})
        EXPECT_NE(japanese.find(part), std::string::npos) << part;
    EXPECT_EQ(japanese.find("Servo period"), std::string::npos);
}

TEST(HtmlReport, NumbersStandRightAndSentencesDoNot) {
    HtmlReport page("p");
    page.table({"what", "how much"}, {{"a", "1.5 mm"}, {"b", "2 mm"}});
    page.table({"what", "why"}, {{"a", "10 Hz are the least that the maker of the device names"}, {"b", "none"}});
    const std::string text = page.text();
    EXPECT_NE(text.find("<th scope=\"col\" class=\"n\">how much</th>"), std::string::npos);
    EXPECT_NE(text.find("<td class=\"n\">1.5 mm</td>"), std::string::npos);
    EXPECT_NE(text.find("<td>10 Hz are"), std::string::npos);
    EXPECT_NE(text.find("<td>none</td>"), std::string::npos);
}

TEST(Plot, ShowsMarksAndHistograms) {
    Plot plot{"t", "x", "y", {{"a", {0.0, 1.0}, {0.0, 1.0}}}, {}, {{0.5, "undo"}}};
    EXPECT_NE(toSvg(plot, false).find("<title>0.50: undo</title>"), std::string::npos);
    std::vector<double> counts(2000, 0.0);
    counts[1000] = 5000.0;
    counts[1999] = 1.0;
    const Histogram histogram = histogramSvg(counts, "h", "us", false);
    EXPECT_EQ(histogram.total, 5001.0);
    EXPECT_EQ(histogram.beyond, 1.0);
    EXPECT_TRUE(histogramSvg({}, "h", "us", false).svg.empty());
}

}  // namespace
}  // namespace handpiece::report::report_html_test
