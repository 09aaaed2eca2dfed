// SPDX-License-Identifier: Apache-2.0
// handpiece agree: how far raters agree.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "handpiece/app/assessment/marks_agreement.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::cli {
namespace {

struct AgreeOptions {
    std::string marks, rubric, plots;
    std::vector<std::string> categories;
    bool json = false;
};

void agree(const AgreeOptions& o) {
    std::vector<std::string> bands;
    if (!o.rubric.empty()) {
        const rubric::Rubric r = rubric::rubricByNameOrFile(o.rubric);
        for (const rubric::BandName& b : r.bands)
            bands.push_back(b.id);
        if (bands.empty()) throw core::Error("it has no bands", o.rubric, "give --categories instead");
    }
    std::vector<assessment::CriterionAgreement> all;
    for (const assessment::MarkTable& table : assessment::readMarks(o.marks)) {
        assessment::MarkScale scale{o.categories};
        // A rubric's bands are for marks that are bands; points stay numbers.
        if (!bands.empty()) {
            const bool hasBand = std::any_of(table.marks.begin(), table.marks.end(), [&](const auto& mark) {
                return mark && std::find(bands.begin(), bands.end(), *mark) != bands.end();
            });
            if (hasBand) scale.categories = bands;
        }
        all.push_back(assessment::agreementOf(table, scale));
    }
    if (!o.plots.empty()) {
        core::prepareOutputFolder(o.plots);
        for (std::size_t c = 0; c < all.size(); ++c)
            for (std::size_t p = 0; p < all[c].pairs.size(); ++p)
                if (all[c].pairs[p].blandAltman && all[c].pairs[p].items > 0)
                    core::writeFile(
                        std::filesystem::path(o.plots) / fmt::format("bland-altman-{}-{}.svg", c + 1, p + 1),
                        assessment::blandAltmanSvg(all[c], all[c].pairs[p]));
    }
    fmt::print("{}", o.json ? assessment::agreementJson(all) : assessment::agreementText(all));
}

}  // namespace

void addAgreeCommand(Command& app) {
    Command command = app.subcommand("agree", "How far raters agree: kappa, ICC, Bland-Altman, Krippendorff's alpha");
    const auto options = std::make_shared<AgreeOptions>();
    AgreeOptions& o = *options;
    command.option("marks", o.marks, "CSV: item,rater,mark and, if there are several, criterion").required();
    const Option rubric =
        command.option("--rubric", o.rubric, "whose bands the marks are: a file, or a shipped one's name");
    command.option("--categories", o.categories, "what marks there are, from best to worst: good,fair,bad")
        .delimiter(',')
        .excludes(rubric);
    command.flag("--json", o.json, "as JSON");
    command.option("--plots", o.plots, "folder for Bland and Altman's plots (SVG)");
    command.footer(
        "Marks that are all numbers are taken as numbers, others as labels; categories say their order, and that of\n"
        "those that nobody gave. What has no variance is undefined, not 1.\n"
        "Example:\n  handpiece agree marks.csv --rubric 46-class-i --json");
    command.callback([options] { agree(*options); });
}

}  // namespace handpiece::cli
