// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "handpiece/assess/draft/draft.h"
#include "handpiece/assess/rubric/lint.h"
#include "handpiece/assess/task/target.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/catalogue.h"

namespace handpiece::draft {
namespace {

using rubric::Severity;

using config::Phrase;

template <class... Parts>
Phrase say(const char* id, const Parts&... parts) {
    return {id, {fmt::format("{}", parts)...}};
}
Problem problemOf(Part part, const core::Error& error) {
    return {part, Severity::error, error.problem(), error.remedy(), {}, {}, {}, {}, error.id(), error.arguments()};
}

class Look {
  public:
    explicit Look(const Content& content) : c_(content) {}

    std::vector<Problem> all() {
        if (!c_.tooth) tell(Part::tooth, Severity::error, say("draft.no-tooth"), say("draft.choose-tooth"));
        preparation();
        work();
        judgement();
        texts();
        return std::move(found_);
    }

  private:
    void tell(Part part, Severity severity, Phrase said, Phrase advice) {
        static const config::Words& english = config::Words::in("en");
        found_.push_back(
            {part, severity, english(said), english(advice), {}, {}, std::move(said), std::move(advice), {}, {}});
    }

    void preparation() {
        if (!c_.preparation)
            return tell(Part::preparation, Severity::warning, say("draft.nothing-asked"),
                        say("draft.choose-preparation"));
        try {
            // By the rules of the file.
            (void)preparation::readRecipe(
                *config::Table::parse(preparation::recipeToml(*c_.preparation), "here").table("preparation"));
        } catch (const core::Error& error) {
            found_.push_back(problemOf(Part::preparation, error));
        }
    }

    void bur(const std::string& name) {
        if (instrument::findBur(name) == nullptr)
            tell(Part::work, Severity::error, say("draft.no-bur", name), say("draft.choose-bur"));
    }
    void work() {
        const cases::Exercise& e = c_.exercise;
        for (const std::string& name : e.allowedBurs)
            bur(name);
        if (!e.bur.empty()) {
            bur(e.bur);
            if (!e.allowedBurs.empty() &&
                std::find(e.allowedBurs.begin(), e.allowedBurs.end(), e.bur) == e.allowedBurs.end())
                tell(Part::work, Severity::error, say("draft.first-bur", e.bur), say("draft.allow-bur"));
        }
        if (c_.voxelMm < 0.02 - 1e-9 || c_.voxelMm > 0.4 + 1e-9)
            tell(Part::work, Severity::error, say("draft.voxel", 1e3 * c_.voxelMm), say("draft.voxel-range"));
        if (c_.minutes && !(*c_.minutes > 0.0 && *c_.minutes <= 24 * 60))
            tell(Part::work, Severity::error, say("draft.minutes", *c_.minutes), say("draft.minutes-range"));
        tooWide();
    }
    /// Of the preparation's narrowest place, where a number says it.
    void tooWide() {
        if (!c_.preparation) return;
        const preparation::Template* t = preparation::findTemplate(c_.preparation->preparation);
        if (t == nullptr || std::none_of(t->parameters.begin(), t->parameters.end(),
                                         [](const preparation::Parameter& p) { return p.name == "width_mm"; }))
            return;
        const double widthMm = c_.preparation->number("width_mm");
        std::vector<std::string> burs = c_.exercise.allowedBurs;
        if (burs.empty() && !c_.exercise.bur.empty()) burs.push_back(c_.exercise.bur);
        if (burs.empty()) return;
        const bool fits = std::any_of(burs.begin(), burs.end(), [&](const std::string& name) {
            const instrument::CatalogueEntry* entry = instrument::findBur(name);
            return entry == nullptr || entry->diameterMm <= widthMm + 2.0 * c_.preparation->leeway.sideMm;
        });
        if (!fits) tell(Part::work, Severity::warning, say("draft.too-wide", widthMm), say("draft.thinner"));
    }

    void judgement() {
        if (!c_.rubric)
            return tell(Part::judgement, Severity::remark, say("draft.not-judged"), say("draft.take-rubric"));
        for (rubric::SaidFinding& said : rubric::lint(*c_.rubric)) {
            rubric::Finding& f = said.finding;
            std::string what = f.criterion.empty() ? f.problem : f.criterion + ": " + f.problem;
            found_.push_back({Part::judgement,
                              f.severity,
                              std::move(what),
                              std::move(f.remedy),
                              std::move(f.criterion),
                              std::move(said.about),
                              std::move(said.problem),
                              std::move(said.remedy),
                              {},
                              {}});
        }
    }

    void texts() {
        const bool isId = !c_.id.empty() && c_.id.size() <= 64 && std::all_of(c_.id.begin(), c_.id.end(), [](char ch) {
            return (ch >= 'a' && ch <= 'z') || (ch >= '0' && ch <= '9') || ch == '-';
        });
        if (!isId) tell(Part::texts, Severity::error, say("draft.no-id", c_.id), say("draft.id-range"));
        const auto missing = [](const cases::Texts& all, const char* language) {
            const auto at = all.find(language);
            return at == all.end() || at->second.empty();
        };
        const bool noTitle = missing(c_.exercise.title, "en") && missing(c_.exercise.title, "ja");
        if (noTitle) tell(Part::texts, Severity::warning, say("draft.no-title"), say("draft.give-title"));
        if (missing(c_.exercise.instructions, "en") && missing(c_.exercise.instructions, "ja"))
            tell(Part::texts, Severity::remark, say("draft.no-instructions"), say("draft.give-instructions"));
    }

    const Content& c_;
    std::vector<Problem> found_;
};

}  // namespace

std::vector<Problem> problems(const Content& content) {
    return Look(content).all();
}

std::vector<Problem> problemsOnTooth(const Content& content) {
    std::vector<Problem> found;
    if (!content.tooth || !content.preparation) return found;
    try {
        tasks::requireTarget(taskOf(content));
    } catch (const core::Error& error) {
        found.push_back(problemOf(Part::preparation, error));
    }
    return found;
}

bool hasErrors(const std::vector<Problem>& problems) {
    return std::any_of(problems.begin(), problems.end(),
                       [](const Problem& p) { return p.severity == Severity::error; });
}

}  // namespace handpiece::draft
