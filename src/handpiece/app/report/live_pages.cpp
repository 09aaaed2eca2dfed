// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/live_pages.h"

#include <fmt/format.h>

#include <algorithm>

#include "handpiece/app/report/plot.h"
#include "handpiece/app/report/report_html.h"
#include "handpiece/base/config/words.h"

namespace handpiece::report {
namespace {

using config::words;
using Tone = HtmlReport::Tone;

std::string clockText(double seconds) {
    const auto all = static_cast<long>(std::clamp(seconds, 0.0, 1e6));
    return fmt::format("{}:{:02}", all / 60, all % 60);
}

std::string tileHtml(const LiveTile& tile, bool isLink) {
    const std::string alt = escaped(words()("school-live.picture-of", tile.person));
    // Its address changes with it, so that a page that is loaded again shows the new one.
    const std::string picture =
        tile.state == LiveTile::State::gone
            ? fmt::format("<img alt=\"{}\" width=\"480\" height=\"300\">", alt)
            : fmt::format("<img alt=\"{}\" src=\"/live/{}/picture?n={}\" width=\"480\" height=\"300\">", alt,
                          tile.station, tile.sequence);
    const std::string who = fmt::format("<strong>{}</strong> <span class=\"note\">{}</span>", escaped(tile.person),
                                        escaped(tile.stationName));
    return fmt::format("<li class=\"{}\" data-station=\"{}\">{}<div class=\"figures\">{}</div></li>\n",
                       nameOf(tile.state), escaped(tile.station),
                       isLink ? fmt::format("<a href=\"/live/{}\">{}{}</a>", tile.station, picture, who)
                              : fmt::format("{}<p>{}</p>", picture, who),
                       liveFigures(tile));
}

/// The part that apps/web/live keeps up.
std::string liveList(const std::string& feed, bool isLarge, const std::string& tiles) {
    return fmt::format(
        "<p class=\"missing\" id=\"live-none\"{}>{}</p>\n"
        "<ul class=\"tiles{}\" id=\"live\" data-feed=\"{}\" data-silent=\"{}\" data-ended=\"{}\" "
        "data-picture=\"{}\">\n{}</ul>\n"
        "<p id=\"live-trouble\" class=\"bad\" role=\"alert\"></p>\n"
        "<p id=\"live-news\" class=\"unseen\" role=\"status\" aria-live=\"polite\"></p>\n",
        tiles.empty() ? "" : " hidden", escaped(words()("school-live.none")), isLarge ? " large" : "", escaped(feed),
        escaped(words()("school-live.silent")), escaped(words()("school-live.ended")),
        escaped(words()("school-live.picture-of", "{}")), tiles);
}

}  // namespace

const char* nameOf(LiveTile::State state) {
    return state == LiveTile::State::now ? "now" : state == LiveTile::State::late ? "late" : "gone";
}

std::string liveFlagWord(const std::string& flag) {
    const std::string id = "school-live.flag-" + flag;
    return words().has(id) ? words().text(id) : flag;
}

std::string liveFigures(const LiveTile& tile) {
    const double ageS = static_cast<double>(tile.ageMs) / 1000.0;
    std::string html = fmt::format(
        "<p>{}{}</p><p>{} \u00b7 {} \u00b7 <span class=\"age\">{}</span></p>", escaped(tile.exercise),
        tile.isShared ? fmt::format(" <span class=\"note\">{}</span>", escaped(words()("school-live.shared"))) : "",
        escaped(words()("school-live.elapsed", clockText(tile.elapsedS))),
        escaped(words()("school-live.removed", fmt::format("{:.2f}", tile.removedMm3))),
        escaped(tile.state == LiveTile::State::gone
                    ? words()("school-live.gone", fmt::format("{:.0f}", ageS))
                    : words()("school-live.age", fmt::format("{:.1f}", std::max(ageS, 0.0)))));
    if (!tile.flags.empty()) {
        html += "<ul class=\"flags\">";
        for (const std::string& flag : tile.flags)
            html += fmt::format("<li>{}</li>", escaped(liveFlagWord(flag)));
        html += "</ul>";
    }
    return html;
}

std::string liveClassPage(const Looker& who, const school::SchoolClass& schoolClass,
                          const std::vector<LiveTile>& tiles) {
    HtmlReport page = sitePage(words()("school-live.title", schoolClass.name), who);
    page.link("/classes/" + schoolClass.id, schoolClass.name);
    page.paragraph(words()("school-live.about"), Tone::note);
    std::string all;
    for (const LiveTile& tile : tiles)
        all += tileHtml(tile, true);
    page.live(liveList("/classes/" + schoolClass.id + "/live/feed", false, all));
    page.script("/live.js", "{}");
    return page.text();
}

std::string liveStationPage(const Looker& who, const LiveTile& tile, const std::string& schoolClass) {
    HtmlReport page = sitePage(words()("school-live.title", tile.stationName), who);
    page.link("/classes/" + schoolClass + "/live", words()("school-live.all"));
    page.live(liveList("/live/" + tile.station + "/feed", true, tileHtml(tile, false)));
    page.script("/live.js", "{}");
    return page.text();
}

}  // namespace handpiece::report
