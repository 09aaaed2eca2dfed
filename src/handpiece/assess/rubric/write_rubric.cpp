// SPDX-License-Identifier: Apache-2.0
// A rubric as its file.
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/case/toml_text.h"

namespace handpiece::rubric {
namespace {

using cases::tomlList;
using cases::tomlText;

/// The shortest that reads back as the same number.
std::string tomlOf(double value) {
    return fmt::format("{}", value);
}

class Writer {
  public:
    void raw(std::string_view key, std::string_view value) { out_ += fmt::format("{} = {}\n", key, value); }
    void text(std::string_view key, const std::string& value) {
        if (!value.empty()) raw(key, tomlText(value));
    }
    void num(std::string_view key, const std::optional<double>& value) {
        if (value) raw(key, tomlOf(*value));
    }
    void list(std::string_view key, const std::vector<std::string>& value) {
        if (!value.empty()) raw(key, tomlList(value));
    }
    void texts(std::string_view key, const Texts& value) {
        if (!value.empty()) raw(key, inlineTexts(value));
    }
    void section(std::string_view name) { out_ += fmt::format("\n[{}]\n", name); }
    void table(std::string_view name) { out_ += fmt::format("\n[[{}]]\n", name); }
    [[nodiscard]] static std::string inlineTexts(const Texts& value) {
        std::vector<std::string> parts;
        for (const auto& [language, words] : value)
            parts.push_back(fmt::format("{} = {}", tomlText(language), tomlText(words)));
        return fmt::format("{{ {} }}", fmt::join(parts, ", "));
    }
    [[nodiscard]] std::string take() { return std::move(out_); }

  private:
    std::string out_;
};

std::string inlineTable(const std::vector<std::string>& parts) {
    return parts.empty() ? std::string("{}") : fmt::format("{{ {} }}", fmt::join(parts, ", "));
}
void add(std::vector<std::string>& parts, const char* key, const std::optional<double>& value) {
    if (value) parts.push_back(fmt::format("{} = {}", key, tomlOf(*value)));
}

void writeMeasure(Writer& w, const std::string& measure, const measures::Selection& of, const std::string& unit) {
    w.text("measure", measure);
    w.text("zone", of.zone);
    w.text("tissue", of.tissue);
    w.text("side", of.side);
    w.text("statistic", of.statistic);
    w.num("limit", of.limit);
    w.text("unit", unit);
}

void writeKnots(Writer& w, const std::vector<Knot>& all) {
    if (all.empty()) return;
    std::vector<std::string> knots;
    for (const Knot& k : all)
        knots.push_back(fmt::format("[{}, {}]", tomlOf(k.value), tomlOf(k.points)));
    w.raw("knots", fmt::format("[{}]", fmt::join(knots, ", ")));
}

void write(Writer& w, const Criterion& c) {
    w.table("criterion");
    w.text("id", c.id);
    writeMeasure(w, c.measure, c.of, c.unit);
    if (c.isGraded()) w.num("weight", c.weight);
    writeKnots(w, c.knots);
    if (!c.bands.empty()) {
        std::string bands = "[\n";
        for (const Band& b : c.bands) {
            std::vector<std::string> parts{"id = " + tomlText(b.id)};
            add(parts, "from", b.from);
            add(parts, "to", b.to);
            add(parts, "points", b.points);
            bands += fmt::format("    {},\n", inlineTable(parts));
        }
        w.raw("bands", bands + "]");
    }
    if (c.critical) {
        std::vector<std::string> parts;
        add(parts, "below", c.critical->below);
        add(parts, "above", c.critical->above);
        if (!c.critical->title.empty()) parts.push_back("title = " + Writer::inlineTexts(c.critical->title));
        w.raw("critical", inlineTable(parts));
    }
    w.list("devices", c.devices);
    w.list("excludes", c.excludes);
    w.texts("title", c.title);
    w.texts("words", c.words);
    w.texts("leaves_out", c.leavesOut);
    if (c.status) w.text("status", std::string(nameOf(*c.status)));
    w.text("source", c.source);
}

std::string tomlOf(const Condition& n) {
    std::vector<std::string> parts;
    if (!n.bands.empty()) parts.push_back("bands = " + tomlList(n.bands));
    if (!n.of.empty()) parts.push_back("of = " + tomlList(n.of));
    if (n.least) parts.push_back(fmt::format("least = {}", *n.least));
    if (n.most) parts.push_back(fmt::format("most = {}", *n.most));
    if (!n.rule.empty()) parts.push_back("rule = " + tomlText(n.rule));
    return inlineTable(parts);
}

}  // namespace

std::string rubricToml(const Rubric& rubric) {
    Writer w;
    w.raw("format", "1");
    w.text("id", rubric.id);
    w.text("version", rubric.version);
    w.texts("title", rubric.title);
    w.texts("words", rubric.words);
    w.text("status", std::string(nameOf(rubric.status)));
    w.text("source", rubric.source);
    w.num("total_weight", rubric.totalWeight);
    w.num("pass_mark", rubric.passMark);
    if (rubric.completeness) {
        const Completeness& c = *rubric.completeness;
        w.section("completeness");
        writeMeasure(w, c.measure, c.of, c.unit);
        writeKnots(w, c.knots);
        w.texts("title", c.title);
        w.texts("words", c.words);
        w.text("source", c.source);
    }
    for (const BandName& b : rubric.bands) {
        w.table("band");
        w.text("id", b.id);
        w.texts("title", b.title);
    }
    for (const Criterion& c : rubric.criteria)
        write(w, c);
    for (const Step& s : rubric.steps) {
        w.table("step");
        w.text("id", s.id);
        w.texts("title", s.title);
        w.list("criteria", s.criteria);
    }
    for (const Rule& r : rubric.rules) {
        w.table("rule");
        w.text("id", r.id);
        w.texts("title", r.title);
        std::vector<std::string> needs;
        for (const Condition& n : r.needs)
            needs.push_back(tomlOf(n));
        w.raw("needs", fmt::format("[{}]", fmt::join(needs, ", ")));
        if (r.required) w.raw("required", "true");
        w.num("else_at_most", r.elseAtMost);
        w.text("source", r.source);
    }
    return w.take();
}

}  // namespace handpiece::rubric
