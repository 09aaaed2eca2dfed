// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/report_html.h"

#include <fmt/format.h>

#include <algorithm>

#include "handpiece/app/report/plot.h"
#include "handpiece/app/report/report_figures.h"
#include "handpiece/base/core/file.h"

namespace handpiece::report {
namespace {

constexpr std::string_view kPageStyle = R"(
:root { color-scheme: light dark; }
body { max-width: 900px; margin: 2.5rem auto; padding: 0 1.2rem; color: #1c2430; background: #ffffff;
  font: 16px/1.55 Georgia, "Times New Roman", serif; }
h1, h2, h3, table, figcaption, caption { font-family: "Helvetica Neue", Arial, sans-serif; }
h1 { font-size: 1.9rem; line-height: 1.2; margin-bottom: 0.4rem; }
h2 { font-size: 1.3rem; margin: 2.6rem 0 0.5rem; padding-bottom: 0.25rem; border-bottom: 1px solid #c9ced6; }
h3 { font-size: 1.02rem; margin: 1.6rem 0 0.3rem; }
.note { color: #59636f; font-size: 0.92rem; }
.scroll { overflow-x: auto; margin: 1rem 0; }
table { border-collapse: collapse; font-size: 0.85rem; width: 100%; }
caption { text-align: left; color: #59636f; padding-bottom: 0.4rem; }
th { text-align: left; vertical-align: bottom; border-bottom: 1.5px solid #8a93a3; padding: 0.3rem 0.6rem; font-weight: 600; }
td { border-bottom: 1px solid #dfe3e8; padding: 0.25rem 0.6rem; } tbody tr:hover { background: #f1f4f8; }
td.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
td.yes { color: #1d7a3f; } td.no { color: #c62828; font-weight: 600; }
figure { margin: 1.2rem 0; } figure svg, figure img { width: 100%; height: auto; display: block; }
figcaption { color: #59636f; font-size: 0.85rem; margin-top: 0.4rem; }
@media (prefers-color-scheme: dark) {
body { color: #dfe4ec; background: #14181f; } h2 { border-color: #3a4250; } td { border-color: #2a313c; }
tbody tr:hover { background: #1d232d; } .note, caption, figcaption { color: #9aa5b4; }
td.yes { color: #66c98c; } td.no { color: #ff7b72; } }
@media print { body { max-width: none; } h2, figure, table { break-inside: avoid; } }
)";

bool isNumber(std::string_view cell) {
    return !cell.empty() && std::string_view("0123456789-+.").find(cell.front()) != std::string_view::npos;
}

}  // namespace

HtmlReport::HtmlReport(std::string title) : title_(std::move(title)) {
    body_ = fmt::format("<h1>{}</h1>\n", escaped(title_));
}

void HtmlReport::heading(std::string_view text) {
    body_ += fmt::format("<h2>{}</h2>\n", escaped(text));
}

void HtmlReport::subheading(std::string_view text) {
    body_ += fmt::format("<h3>{}</h3>\n", escaped(text));
}

void HtmlReport::paragraph(std::string_view text, bool isNote) {
    body_ += fmt::format("<p{}>{}</p>\n", isNote ? " class=\"note\"" : "", escaped(text));
}

void HtmlReport::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows,
                       std::string_view caption) {
    body_ += fmt::format("<div class=\"scroll\"><table><caption>{}</caption><thead><tr>", escaped(caption));
    for (const std::string& cell : header)
        body_ += fmt::format("<th>{}</th>", escaped(cell));
    body_ += "</tr></thead><tbody>\n";
    for (const std::vector<std::string>& row : rows) {
        body_ += "<tr>";
        for (std::size_t c = 0; c < row.size(); ++c) {
            const std::string_view kind = c > 0 && isNumber(row[c])     ? " class=\"n\""
                                          : row[c].rfind("yes", 0) == 0 ? " class=\"yes\""
                                          : row[c].rfind("no", 0) == 0  ? " class=\"no\""
                                                                        : "";
            body_ += fmt::format("<td{}>{}</td>", kind, escaped(row[c]));
        }
        body_ += "</tr>\n";
    }
    body_ += "</tbody></table></div>\n";
}

void HtmlReport::figure(std::string_view svg, std::string_view caption) {
    body_ += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", svg, escaped(caption));
}

void HtmlReport::picture(const std::filesystem::path& png, std::string_view caption) {
    const std::vector<std::byte> bytes = core::readFile(png);
    std::vector<std::uint8_t> numbers(bytes.size());
    std::transform(bytes.begin(), bytes.end(), numbers.begin(),
                   [](std::byte b) { return std::to_integer<std::uint8_t>(b); });
    body_ += fmt::format(
        "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
        escaped(caption), report::base64Of(numbers));
}

std::string HtmlReport::text() const {
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n"
        "<style>{}{}</style>\n</head>\n<body>\n{}</body>\n</html>\n",
        escaped(title_), kPageStyle, svgStyle(), body_);
}

}  // namespace handpiece::report
