// SPDX-License-Identifier: Apache-2.0
// handpiece rubric: how work is judged, as a file: checked, shown, compared, its hash.
#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"

namespace handpiece::cli {
namespace {

using rubric::Rubric;

void check(const std::vector<std::string>& names) {
    std::size_t errors = 0;
    for (const std::string& name : names) {
        const Rubric r = rubric::rubricByNameOrFile(name);
        std::size_t own = 0;
        for (const rubric::Finding& f : rubric::check(r)) {
            const char* severity = f.severity == rubric::Severity::error     ? "error"
                                   : f.severity == rubric::Severity::warning ? "warning"
                                                                             : "remark";
            fmt::print("{}: {}: {}{}\n", severity, f.where, f.problem, f.remedy.empty() ? "" : " (" + f.remedy + ")");
            own += f.severity == rubric::Severity::error ? 1 : 0;
        }
        if (own == 0)
            fmt::print("{}: {} criteria, {}\n", r.where, r.criteria.size(), rubric::hashText(rubric::hashOf(r)));
        errors += own;
    }
    if (errors > 0)
        throw core::Error(fmt::format("{} error{}", errors, errors == 1 ? "" : "s"), {}, "each is told above");
}

void show(const std::string& name, bool json) {
    if (name.empty()) {
        for (const std::string& shipped : rubric::shippedRubrics())
            fmt::print("{:<26}{}\n", shipped,
                       cases::inLanguage(rubric::shippedRubric(shipped).title, config::words().language()));
        return;
    }
    const Rubric r = rubric::rubricByNameOrFile(name);
    fmt::print("{}", json ? assessment::rubricJson(r) : rubric::describe(r, config::words().language()));
}

void diff(const std::string& before, const std::string& after) {
    const Rubric a = rubric::rubricByNameOrFile(before), b = rubric::rubricByNameOrFile(after);
    // Of two criteria of one name nobody could say which has changed.
    requireSound(a);
    requireSound(b);
    const std::vector<std::string> all = rubric::differences(a, b);
    for (const std::string& sentence : all)
        fmt::print("{}\n", sentence);
    if (all.empty()) fmt::print("nothing differs\n");
    fmt::print("{}\n", rubric::hashOf(a) == rubric::hashOf(b) ? "scores are the same: the hash is"
                                                              : "scores may be others: the hash is another");
}

}  // namespace

void addRubricCommand(Command& app) {
    Command rubrics = app.subcommand("rubric", "How work is judged: check a rubric, show it, compare two, its hash");
    rubrics.requireSubcommand();

    Command checking = rubrics.subcommand("check", "Say what is wrong with rubrics");
    const auto names = std::make_shared<std::vector<std::string>>();
    checking.option("rubric", *names, "files (.toml), or names of shipped ones").required();
    checking.footer(
        "Ends with 1 when there is an error; warnings and remarks are told.\nExample:\n  handpiece rubric check "
        "own.toml");
    checking.callback([names] { check(*names); });

    Command showing = rubrics.subcommand("show", "A rubric in plain words; without one, the names of the shipped");
    const auto shown = std::make_shared<std::string>();
    const auto json = std::make_shared<bool>(false);
    showing.option("rubric", *shown, "a file (.toml), or the name of a shipped one");
    showing.flag("--json", *json, "as JSON");
    showing.footer("Example:\n  handpiece --language ja rubric show 46-class-i");
    showing.callback([shown, json] { show(*shown, *json); });

    Command comparing = rubrics.subcommand("diff", "What a second rubric changes of a first");
    const auto before = std::make_shared<std::string>(), after = std::make_shared<std::string>();
    comparing.option("before", *before, "a file (.toml), or the name of a shipped one").required();
    comparing.option("after", *after, "likewise").required();
    comparing.footer("Example:\n  handpiece rubric diff 46-class-i own.toml");
    comparing.callback([before, after] { diff(*before, *after); });

    Command hashing = rubrics.subcommand("hash", "The hash of what decides: scores of the same hash can be compared");
    const auto hashed = std::make_shared<std::string>();
    const auto canonical = std::make_shared<bool>(false);
    hashing.option("rubric", *hashed, "a file (.toml), or the name of a shipped one").required();
    hashing.flag("--text", *canonical, "the text that is hashed instead");
    hashing.footer(
        "Comments, words and the spelling of numbers change nothing.\nExample:\n  handpiece rubric hash own.toml");
    hashing.callback([hashed, canonical] {
        const Rubric r = rubric::rubricByNameOrFile(*hashed);
        fmt::print("{}", *canonical ? rubric::canonicalText(r) : rubric::hashText(rubric::hashOf(r)) + "\n");
    });
}

}  // namespace handpiece::cli
