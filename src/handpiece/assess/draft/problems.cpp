// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "handpiece/assess/draft/draft.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/catalogue.h"

namespace handpiece::draft {
namespace {

using rubric::Severity;

class Look {
  public:
    explicit Look(const Content& content) : c_(content) {}

    std::vector<Problem> all() {
        if (!c_.tooth) tell(Part::tooth, Severity::error, "no tooth is chosen yet", "choose one");
        preparation();
        work();
        judgement();
        texts();
        return std::move(found_);
    }

  private:
    void tell(Part part, Severity severity, std::string what, std::string remedy = {}, std::string criterion = {}) {
        found_.push_back({part, severity, std::move(what), std::move(remedy), std::move(criterion)});
    }
    void tell(Part part, const core::Error& error) { tell(part, Severity::error, error.problem(), error.remedy()); }

    void preparation() {
        if (!c_.preparation)
            return tell(Part::preparation, Severity::warning, "nothing is asked", "choose a preparation");
        try {
            // By the rules of the file.
            (void)preparation::readRecipe(
                *config::Table::parse(preparation::recipeToml(*c_.preparation), "here").table("preparation"));
        } catch (const core::Error& error) {
            tell(Part::preparation, error);
        }
    }

    void bur(const std::string& name) {
        if (instrument::findBur(name) == nullptr)
            tell(Part::work, Severity::error, fmt::format("there is no bur \"{}\"", name),
                 "choose one of the program's: students have no files of yours");
    }
    void work() {
        const cases::Exercise& e = c_.exercise;
        for (const std::string& name : e.allowedBurs)
            bur(name);
        if (!e.bur.empty()) {
            bur(e.bur);
            if (!e.allowedBurs.empty() &&
                std::find(e.allowedBurs.begin(), e.allowedBurs.end(), e.bur) == e.allowedBurs.end())
                tell(Part::work, Severity::error, fmt::format("the first bur, {}, is not allowed", e.bur),
                     "allow it, or choose another");
        }
        if (c_.voxelMm < 0.02 - 1e-9 || c_.voxelMm > 0.4 + 1e-9)
            tell(Part::work, Severity::error, fmt::format("a voxel of {} um", 1e3 * c_.voxelMm), "give 20 to 400 um");
        if (c_.minutes && !(*c_.minutes > 0.0 && *c_.minutes <= 24 * 60))
            tell(Part::work, Severity::error, fmt::format("{} minutes", *c_.minutes),
                 "give more than 0, a day at most");
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
        if (!fits)
            tell(Part::work, Severity::warning, fmt::format("all burs are wider than the {} mm asked for", widthMm),
                 "allow a thinner one, or ask for more width");
    }

    void judgement() {
        if (!c_.rubric)
            return tell(Part::judgement, Severity::remark, "it is not judged", "take a rubric that comes along");
        for (rubric::Finding& f : rubric::check(*c_.rubric))
            tell(Part::judgement, f.severity, f.criterion.empty() ? f.problem : f.criterion + ": " + f.problem,
                 std::move(f.remedy), f.criterion);
    }

    void texts() {
        const bool isId = !c_.id.empty() && c_.id.size() <= 64 && std::all_of(c_.id.begin(), c_.id.end(), [](char ch) {
            return (ch >= 'a' && ch <= 'z') || (ch >= '0' && ch <= '9') || ch == '-';
        });
        if (!isId)
            tell(Part::texts, Severity::error, fmt::format("\"{}\" is no id", c_.id),
                 "1 to 64 small letters, digits and '-'");
        const auto missing = [](const cases::Texts& all, const char* language) {
            const auto at = all.find(language);
            return at == all.end() || at->second.empty();
        };
        const bool noTitle = missing(c_.exercise.title, "en") && missing(c_.exercise.title, "ja");
        if (noTitle) tell(Part::texts, Severity::warning, "it has no title", "give one");
        if (missing(c_.exercise.instructions, "en") && missing(c_.exercise.instructions, "ja"))
            tell(Part::texts, Severity::remark, "it does not say what to do", "give instructions");
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
    for (std::string& what : tasks::problems(taskOf(content)))
        found.push_back({Part::preparation, Severity::error, std::move(what), {}, {}});
    return found;
}

bool hasErrors(const std::vector<Problem>& problems) {
    return std::any_of(problems.begin(), problems.end(),
                       [](const Problem& p) { return p.severity == Severity::error; });
}

}  // namespace handpiece::draft
