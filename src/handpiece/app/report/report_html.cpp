// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/report_html.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include "handpiece/app/report/plot.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/file.h"

namespace handpiece::report {

/// apps/web/viewer as one script, its SHA-256, and its style.
extern const char *const kViewerScript, *const kViewerSha256, *const kViewerStyle;

namespace {

constexpr std::string_view kPageStyle = R"(
:root { color-scheme: light dark; }
@page { size: A4; margin: 14mm; }
body { max-width: 900px; margin: 2.2rem auto; padding: 0 1.2rem; color: #1c2430; background: #ffffff;
  font: 15px/1.5 "Helvetica Neue", Arial, "Liberation Sans", "DejaVu Sans", "Noto Sans CJK JP", "IPAGothic", sans-serif; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0 0 0.3rem; }
h2 { font-size: 1.25rem; margin: 2rem 0 0.5rem; padding-bottom: 0.2rem; border-bottom: 1px solid #c9ced6; }
h3 { font-size: 1.02rem; margin: 1.4rem 0 0.3rem; }
.note { color: #59636f; font-size: 0.9rem; } .good { color: #1d7a3f; font-weight: 600; } .bad { color: #c62828; font-weight: 600; }
.missing { border: 1px dashed #8a93a3; padding: 1rem; }
.scroll { overflow-x: auto; margin: 0.8rem 0; }
table { border-collapse: collapse; font-size: 0.86rem; width: 100%; }
caption { text-align: left; color: #59636f; padding-bottom: 0.3rem; }
th { text-align: left; vertical-align: bottom; border-bottom: 1.5px solid #8a93a3; padding: 0.3rem 0.6rem; font-weight: 600; }
td { border-bottom: 1px solid #dfe3e8; padding: 0.25rem 0.6rem; vertical-align: top; } tbody tr:hover { background: #f1f4f8; }
th.n, td.n { text-align: right; } td.n { font-variant-numeric: tabular-nums; white-space: nowrap; }
td.yes { color: #1d7a3f; } td.no { color: #c62828; font-weight: 600; }
.columns { display: grid; grid-template-columns: 1fr 1fr; gap: 0 1.6rem; }
.pictures { display: grid; grid-template-columns: 1fr 1fr; gap: 0.6rem; }
.slices { display: grid; grid-template-columns: 1fr 1fr 1fr; gap: 0.6rem; align-items: end; }
.thirds { display: grid; grid-template-columns: repeat(3, minmax(0, 1fr)); gap: 0.6rem; align-items: end; } .thirds figure { margin: 0; }
.slices img { max-height: 90mm; object-fit: contain; background: #000; }
.frame { border: 1.5px solid #0b62a4; border-radius: 8px; padding: 0.2rem 1.2rem; background: #f2f7fc; }
a { color: #0b62a4; }
figure { margin: 1rem 0; } .pictures figure, .slices figure { margin: 0; }
figure svg, figure img { width: 100%; height: auto; display: block; }
figcaption { color: #59636f; font-size: 0.85rem; margin-top: 0.3rem; }
.chip { display: inline-block; width: 0.9rem; height: 0.9rem; border: 1px solid #59636f; vertical-align: -0.1rem; margin: 0 0.25rem 0 0.8rem; }
code { font: 0.85rem/1.5 "DejaVu Sans Mono", Menlo, monospace; } pre { background: #eef1f5; padding: 0.5rem 0.8rem; overflow-x: auto; }
@media (prefers-color-scheme: dark) {
body { color: #dfe4ec; background: #14181f; } h2 { border-color: #3a4250; } td { border-color: #2a313c; }
tbody tr:hover { background: #1d232d; } .note, caption, figcaption { color: #9aa5b4; } .frame { background: #182230; } pre { background: #1d232d; }
a { color: #6cb6ff; } td.yes, .good { color: #66c98c; } td.no, .bad { color: #ff7b72; } }
@media print { body { font-size: 10.5pt; margin: 0; padding: 0; max-width: none; } h2 { break-after: avoid; }
figure, tr, .frame { break-inside: avoid; } * { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
)";

/// Of a server's pages on top of it.
constexpr std::string_view kSiteStyle = R"(
body { max-width: 1200px; margin-top: 0; }
.skip { position: absolute; left: -99rem; } .skip:focus { left: 0.5rem; top: 0.5rem; background: #ffffff; padding: 0.4rem; }
.site { display: flex; flex-wrap: wrap; gap: 0.3rem 1.2rem; align-items: center; border-bottom: 1px solid #c9ced6; padding: 0.5rem 0; margin-bottom: 1.2rem; }
.site nav { display: flex; flex-wrap: wrap; gap: 0.3rem 1.2rem; flex: 1 1 20rem; } .site nav a { white-space: nowrap; } .site nav a[aria-current] { font-weight: 600; text-decoration: none; color: inherit; }
.site form, .site form p { margin: 0; display: inline; }
input, button, select, textarea { font: inherit; padding: 0.3rem 0.6rem; color: inherit; background: #ffffff; border: 1px solid #767f8c; border-radius: 4px; }
textarea { width: 100%; box-sizing: border-box; } button { cursor: pointer; background: #eef1f5; } button.grave { color: #a41b1b; border-color: #a41b1b; }
:focus-visible, input:focus-within { outline: 3px solid #0b62a4; outline-offset: 1px; }
.field label { display: inline-block; min-width: 11rem; } .tick { display: flex; flex-direction: row-reverse; justify-content: flex-end; gap: 0.4rem; flex-wrap: wrap; }
fieldset { border: 1px solid #c9ced6; border-radius: 6px; margin: 0.8rem 0; } .choice label { margin-right: 1.2rem; }
@media (prefers-color-scheme: dark) { .site, fieldset { border-color: #3a4250; } .skip:focus { background: #14181f; }
input, button, select, textarea { background: #1d232d; border-color: #8a93a3; } button.grave { color: #ff7b72; border-color: #ff7b72; } }
table:not(:has(thead)) { width: auto; } table:not(:has(thead)) td.n { text-align: left; }
.beside { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); gap: 1.4rem; align-items: start; } .beside > figure { position: sticky; top: 0.5rem; }
.part > h2:first-child { margin-top: 0; }
@media (max-width: 900px) { .beside { grid-template-columns: minmax(0, 1fr); } .beside > figure { position: static; } }
@media print { .site { display: none; } }
)";

/// Of live().
constexpr std::string_view kLiveStyle = R"(
body { max-width: none; }
.tiles { list-style: none; padding: 0; display: grid; gap: 1rem; grid-template-columns: repeat(auto-fill, minmax(15rem, 1fr)); }
.tiles.large { grid-template-columns: minmax(0, 48rem); }
.tiles > li { border: 2px solid #c9ced6; border-radius: 8px; padding: 0.4rem; } .tiles p { margin: 0.2rem 0; }
.tiles a { display: block; } .tiles img { width: 100%; height: auto; aspect-ratio: 8 / 5; background: #22262e; display: block; }
.flags { list-style: none; padding: 0; margin: 0.2rem 0; color: #c62828; font-weight: 600; } .unseen { position: absolute; clip-path: inset(50%); }
@media (prefers-color-scheme: dark) { .flags { color: #ff7b72; } .tiles > li { border-color: #3a4250; } }
.tiles > li.late { border-style: dashed; border-color: #b26a00; } .tiles > li.gone { border-style: dotted; border-color: #767f8c; }
.tiles > li.late .age, .tiles > li.gone .age { font-weight: 600; }
)";

std::string base64(std::span<const std::byte> bytes) {
    static constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve(out.size() + (bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(bytes.size() - i, 3);
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k)
            three = three << 8 | (k < left ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            out += k <= left ? kLetters[three >> (18 - 6 * k) & 63] : '=';
    }
    return out;
}

std::string dataAddress(std::span<const std::byte> png) {
    return "data:image/png;base64," + base64(png);
}

/// Of the viewer's script, which was counted out when the program was built.
std::string scriptHash() {
    std::vector<std::byte> bytes;
    for (std::string_view hex = kViewerSha256; hex.size() >= 2; hex.remove_prefix(2)) {
        unsigned value = 0;
        std::from_chars(hex.data(), hex.data() + 2, value, 16);
        bytes.push_back(static_cast<std::byte>(value));
    }
    return base64(bytes);
}

/// As the viewer's clock.
std::string clockText(double timeS) {
    const auto tenths = static_cast<long>(timeS * 10.0 + 0.5);
    return fmt::format("{}:{:04.1f}", tenths / 600, static_cast<double>(tenths % 600) / 10.0);
}

bool isNumber(std::string_view cell) {
    constexpr std::size_t kLongest = 24;  // longer: a sentence that starts with a number
    return !cell.empty() && cell.size() <= kLongest &&
           std::string_view("0123456789-+.").find(cell.front()) != std::string_view::npos;
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

void HtmlReport::paragraph(std::string_view text, Tone tone) {
    constexpr std::array kClasses{"", " class=\"note\"", " class=\"good\"", " class=\"bad\"", " class=\"missing\""};
    body_ += fmt::format("<p{}>{}</p>\n", kClasses[static_cast<std::size_t>(tone)], escaped(text));
}

void HtmlReport::list(const std::vector<std::string>& items) {
    body_ += "<ul>\n";
    for (const std::string& item : items)
        body_ += fmt::format("<li>{}</li>\n", escaped(item));
    body_ += "</ul>\n";
}

void HtmlReport::legend(const std::vector<Chip>& chips) {
    body_ += "<p class=\"note\">";
    for (const Chip& chip : chips)
        body_ += fmt::format("<span class=\"chip\" style=\"background:#{:02x}{:02x}{:02x}\"></span>{}", chip.colour[0],
                             chip.colour[1], chip.colour[2], escaped(chip.name));
    body_ += "</p>\n";
}

void HtmlReport::link(std::string_view address, std::string_view text) {
    body_ += fmt::format("<p><a href=\"{}\">{}</a></p>\n", escaped(address), escaped(text));
}

void HtmlReport::code(std::string_view text) {
    body_ += fmt::format("<pre><code>{}</code></pre>\n", escaped(text));
}

void HtmlReport::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows,
                       std::string_view caption) {
    std::vector<std::vector<Cell>> cells;
    for (const std::vector<std::string>& row : rows) {
        cells.emplace_back();
        for (const std::string& text : row)
            cells.back().push_back({text});
    }
    linkedTable(header, cells, caption);
}

void HtmlReport::linkedTable(const std::vector<std::string>& header, const std::vector<std::vector<Cell>>& rows,
                             std::string_view caption) {
    // A wide table is moved by the keys, too.
    body_ += "<div class=\"scroll\" tabindex=\"0\"><table>";
    if (!caption.empty()) body_ += fmt::format("<caption>{}</caption>", escaped(caption));
    if (!header.empty()) {
        body_ += "<thead><tr>";
        for (std::size_t c = 0; c < header.size(); ++c) {
            const bool numbers = c > 0 && !rows.empty() && std::all_of(rows.begin(), rows.end(), [c](const auto& row) {
                                     return c >= row.size() || row[c].text.empty() || isNumber(row[c].text);
                                 });
            body_ += fmt::format("<th scope=\"col\"{}>{}</th>", numbers ? " class=\"n\"" : "", escaped(header[c]));
        }
        body_ += "</tr></thead>";
    }
    body_ += "<tbody>\n";
    for (const std::vector<Cell>& row : rows) {
        body_ += "<tr>";
        for (std::size_t c = 0; c < row.size(); ++c) {
            const Cell& cell = row[c];
            const std::string_view first = std::string_view(cell.text).substr(0, cell.text.find_first_of(" :,;"));
            const std::string_view kind = c > 0 && isNumber(cell.text) ? " class=\"n\""
                                          : first == "yes"             ? " class=\"yes\""
                                          : first == "no"              ? " class=\"no\""
                                                                       : "";
            body_ += cell.address.empty() ? fmt::format("<td{}>{}</td>", kind, escaped(cell.text))
                                          : fmt::format("<td{}><a href=\"{}\">{}</a></td>", kind, escaped(cell.address),
                                                        escaped(cell.text));
        }
        body_ += "</tr>\n";
    }
    body_ += "</tbody></table></div>\n";
}

void HtmlReport::form(const Form& form) {
    body_ += toHtml(form, ++forms_);
}

void HtmlReport::ofSite(const std::vector<Way>& ways, std::string_view who, const std::optional<Form>& logOut) {
    const auto words = [](const char* id) { return escaped(config::words()(id)); };
    site_ = fmt::format("<a class=\"skip\" href=\"#main\">{}</a>\n<header class=\"site\">", words("school.skip"));
    if (!ways.empty()) site_ += fmt::format("<nav aria-label=\"{}\">", words("school.ways"));
    for (const Way& way : ways)
        site_ += fmt::format("<a href=\"{}\"{}>{}</a> ", escaped(way.address),
                             way.isHere ? " aria-current=\"page\"" : "", escaped(way.text));
    if (!ways.empty()) site_ += "</nav>";
    if (logOut) site_ += fmt::format("<span>{}</span>{}", escaped(who), toHtml(*logOut, 0));
    site_ += "</header>\n";
}

void HtmlReport::script(std::string_view address, std::string_view json) {
    script_ = fmt::format(
        "<script type=\"application/json\" id=\"page-data\">{}</script>\n<script type=\"module\" "
        "src=\"{}\"></script>\n",
        json, escaped(address));
}

void HtmlReport::place(std::string_view id, std::string_view without) {
    body_ += fmt::format("<section id=\"{}\"><p class=\"missing\">{}</p></section>\n", escaped(id), escaped(without));
}

void HtmlReport::progress(double done, double all, std::string_view words) {
    body_ +=
        fmt::format("<p role=\"status\"><progress max=\"{0}\" value=\"{1}\" aria-label=\"{2}\"></progress> {2}</p>\n",
                    all, done, escaped(words));
}

void HtmlReport::keepUp(std::string_view address) {
    body_ += fmt::format("<div id=\"keep-up\" data-from=\"{}\"></div>\n", escaped(address));
}

void HtmlReport::facts(std::string_view caption, const std::vector<std::pair<std::string, std::string>>& rows) {
    std::vector<std::vector<std::string>> cells;
    for (const auto& [what, value] : rows)
        cells.push_back({what, value});
    table({}, cells, caption);
}

void HtmlReport::figure(std::string_view svg, std::string_view caption) {
    // Who does not see it hears its caption.
    std::string drawn(svg);
    constexpr std::string_view kRole = "role=\"img\"";
    const std::size_t at = drawn.find(kRole);
    if (at < drawn.find('>') && drawn.substr(0, drawn.find('>')).find("aria-label") == std::string::npos)
        drawn.insert(at + kRole.size(),
                     fmt::format(" aria-label=\"{}\"", escaped(caption.empty() ? std::string_view(title_) : caption)));
    body_ += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", drawn, escaped(caption));
}

void HtmlReport::picture(const std::filesystem::path& png, std::string_view caption) {
    picture(core::readFile(png), caption);
}

void HtmlReport::picture(std::span<const std::byte> png, std::string_view caption) {
    body_ += fmt::format("<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0}</figcaption></figure>\n",
                         escaped(caption), dataAddress(png));
}

void HtmlReport::picture(const view::Image& image, std::string_view caption) {
    picture(std::span<const std::byte>(view::pngOf(image)), caption);
}

std::size_t HtmlReport::roomForReview() const {
    // A third goes on letters; words, moments and curves' names have a part of their own.
    constexpr std::size_t kText = 120'000;
    const std::size_t taken = body_.size() + std::strlen(kViewerScript) + std::strlen(kViewerStyle) + kText;
    return (kMostPageBytes - std::min(kMostPageBytes, taken)) / 4 * 3;
}

void HtmlReport::review(const Review& review) {
    const auto words = [](const char* id) { return escaped(config::words()(id)); };
    std::string all;
    if (review.data.empty()) {
        all = fmt::format("<p class=\"missing\">{}</p>\n", words("review.too-large"));
    } else {
        hasViewer_ = true;
        all = fmt::format(
            "<section class=\"review\" id=\"review\" data-failed=\"{}\"><p>{}</p></section>\n"
            "<script type=\"application/json\" id=\"review-text\">{}</script>\n"
            "<script type=\"application/octet-stream\" id=\"review-data\">{}</script>\n",
            words("review.failed"), words("review.needs-script"), review.json, base64(review.data));
    }
    if (!review.pictures.empty()) {
        all += fmt::format("<section id=\"review-pictures\"><h3>{}</h3><div class=\"slices\">\n",
                           words("review.pictures"));
        for (const Review::Picture& picture : review.pictures)
            all += fmt::format(
                "<figure data-time=\"{0:.3f}\"><img alt=\"{1}\" src=\"{2}\"><figcaption>{1}</figcaption></figure>\n",
                picture.timeS, escaped(config::words()("review.picture-at", clockText(picture.timeS))),
                dataAddress(picture.png));
        all += "</div></section>\n";
    }
    body_.insert(reviewAt_.value_or(body_.size()), all);
}

void HtmlReport::live(std::string_view html) {
    isLive_ = true;
    body_ += html;
}

void HtmlReport::begin(Group group) {
    constexpr std::array kClasses{"columns", "pictures", "slices", "frame", "thirds", "beside", "part"};
    body_ += fmt::format("<div class=\"{}\">\n", kClasses[static_cast<std::size_t>(group)]);
}

void HtmlReport::end() {
    body_ += "</div>\n";
}

std::string HtmlReport::text() const {
    const bool isSite = !site_.empty();
    const std::string policy =
        fmt::format("default-src 'none'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; form-action '{}'",
                    forms_ > 0 ? "self" : "none") +
        (hasViewer_ ? "; script-src " + viewerInPolicy() : std::string());
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"{}\">\n<head>\n<meta charset=\"utf-8\">\n{}"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n{}"
        "<style>{}{}{}{}{}</style>\n</head>\n<body>\n{}<main id=\"main\">\n{}</main>\n{}{}</body>\n</html>\n",
        config::words().language(),
        isSite ? std::string() : fmt::format("<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n", policy),
        escaped(title_), isLive_ ? "<noscript><meta http-equiv=\"refresh\" content=\"4\"></noscript>\n" : "",
        kPageStyle, svgStyle(), hasViewer_ ? kViewerStyle : "", isSite ? kSiteStyle : "", isLive_ ? kLiveStyle : "",
        site_, body_, hasViewer_ ? fmt::format("<script type=\"module\">{}</script>\n", kViewerScript) : std::string(),
        script_);
}

std::string viewerInPolicy() {
    return fmt::format("'sha256-{}'", scriptHash());
}

}  // namespace handpiece::report
