// SPDX-License-Identifier: Apache-2.0
// Any text must give a rubric that can be checked, hashed, described, written so that it reads back the same and, where
// it is sound, used, or one core::Error.
#include <cmath>
#include <vector>

#include "fuzz_model.h"
#include "handpiece/assess/score/score.h"

namespace rubric = handpiece::rubric;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return handpiece::fuzz::readText(data, size, [](std::string_view text) {
        const rubric::Rubric read = rubric::parseRubric(text, "fuzz");
        (void)rubric::describe(read, "ja");
        if (rubric::hashOf(read) != rubric::hashOf(rubric::parseRubric(text, "again"))) __builtin_trap();
        const std::string toml = rubric::rubricToml(read);
        const rubric::Rubric back = handpiece::fuzz::mustRead([&] { return rubric::parseRubric(toml, "written"); });
        if (rubric::hashOf(back) != rubric::hashOf(read) || rubric::rubricToml(back) != toml) __builtin_trap();
        bool isSound = true;
        for (const rubric::Finding& f : rubric::check(read))
            if (f.severity == rubric::Severity::error) isSound = false;
        (void)rubric::differences(read, read);
        if (!isSound) return;
        if (!rubric::differences(read, back).empty()) __builtin_trap();
        std::vector<handpiece::measures::Measured> measured;
        const auto take = [&measured](const auto& c) {
            handpiece::measures::Measured m;
            m.kind = c.measure;
            m.of = c.of;
            m.value = c.knots.empty() ? 1.0 : c.knots.back().value;
            m.uncertainty = 0.1;
            measured.push_back(std::move(m));
        };
        if (read.completeness) take(*read.completeness);
        for (const rubric::Criterion& c : read.criteria)
            take(c);
        const auto result = handpiece::score::evaluate(read, measured, {"pointer", 1.0});
        if (!std::isfinite(result.score) || result.score > result.maxScore) __builtin_trap();
    });
}
