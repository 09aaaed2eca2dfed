// SPDX-License-Identifier: Apache-2.0
// The hash of a rubric, what two of them differ in, and one in plain words.
#include <algorithm>
#include <map>
#include <tuple>

#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/hash.h"

namespace handpiece::rubric {
namespace {

/// The shortest that reads back as the same number; no minus of a zero.
std::string number(double value) {
    return fmt::format("{}", value == 0.0 ? 0.0 : value);
}
std::string number(const std::optional<double>& value) {
    return value ? number(*value) : "-";
}
std::string count(const std::optional<std::int64_t>& value) {
    return value ? fmt::format("{}", *value) : "-";
}
std::string sorted(std::vector<std::string> names) {
    std::sort(names.begin(), names.end());
    return fmt::format("{}", fmt::join(names, ","));
}
std::string listed(const std::vector<std::string>& names) {
    return fmt::format("{}", fmt::join(names, ","));
}

std::string bandsText(const Criterion& c) {
    std::vector<std::string> parts;
    for (const Band& b : c.bands)
        parts.push_back(fmt::format("{} {}..{}{}", b.id, number(b.from), number(b.to),
                                    b.points ? " " + number(*b.points) : std::string()));
    return listed(parts);
}
std::string knotsText(const std::vector<Knot>& knots) {
    std::vector<std::string> parts;
    for (const Knot& k : knots)
        parts.push_back(number(k.value) + " " + number(k.points));
    return listed(parts);
}
std::string criticalText(const Criterion& c) {
    return c.critical ? number(c.critical->below) + ".." + number(c.critical->above) : std::string("none");
}
std::string needText(const Condition& n) {
    if (!n.rule.empty()) return "rule " + n.rule;
    return fmt::format("{}..{} in {} of {}", count(n.least), count(n.most), sorted(n.bands),
                       n.of.empty() ? "all" : sorted(n.of));
}
std::string needsText(const Rule& r) {
    std::vector<std::string> parts;
    for (const Condition& n : r.needs)
        parts.push_back(needText(n));
    std::sort(parts.begin(), parts.end());
    return fmt::format("{}", fmt::join(parts, "; "));
}

using Fields = std::vector<std::pair<const char*, std::string>>;

/// Both of criteria and of completeness.
template <class Asks>
Fields measureOf(const Asks& c) {
    return {{"measure", c.measure},       {"unit", c.unit},    {"zone", c.of.zone},
            {"tissue", c.of.tissue},      {"side", c.of.side}, {"statistic", c.of.statistic},
            {"limit", number(c.of.limit)}};
}
Fields fieldsOf(const Criterion& c) {
    Fields fields = measureOf(c);
    const Fields own = {{"weight", number(c.weight)},   {"knots", knotsText(c.knots)},
                        {"bands", bandsText(c)},        {"critical", criticalText(c)},
                        {"devices", sorted(c.devices)}, {"excludes", sorted(c.excludes)}};
    fields.insert(fields.end(), own.begin(), own.end());
    return fields;
}
Fields fieldsOf(const Completeness& c) {
    Fields fields = measureOf(c);
    fields.emplace_back("factors", knotsText(c.knots));
    return fields;
}
Fields fieldsOf(const Rule& r) {
    return {{"needs", needsText(r)}, {"required", r.required ? "yes" : "no"}, {"else_at_most", number(r.elseAtMost)}};
}
Fields fieldsOf(const Step& s) {
    return {{"criteria", listed(s.criteria)}};
}
Fields fieldsOf(const Rubric& r) {
    std::vector<std::string> bands;
    for (const BandName& b : r.bands)
        bands.push_back(b.id);
    return {{"pass_mark", number(r.passMark)}, {"bands, best to worst", listed(bands)}};
}
/// What is only read: no score hangs on it.
Fields wordsOf(const Criterion& c) {
    const auto all = [](const Texts& texts) {
        std::string text;
        for (const auto& [language, words] : texts)
            text += language + ": " + words + "; ";
        return text;
    };
    return {{"title", all(c.title)},
            {"words", all(c.words)},
            {"leaves_out", all(c.leavesOut)},
            {"critical error's title", c.critical ? all(c.critical->title) : std::string()},
            {"status", c.status ? std::string(nameOf(*c.status)) : std::string()},
            {"source", c.source}};
}

std::string shown(const std::string& text) {
    return text.empty() || text == "-" ? "none" : text;
}

void compare(const Fields& before, const Fields& after, const std::string& what, std::vector<std::string>& out) {
    for (std::size_t i = 0; i < before.size(); ++i)
        if (before[i].second != after[i].second)
            out.push_back(fmt::format("{}: {} was {}, is {}", what, before[i].first, shown(before[i].second),
                                      shown(after[i].second)));
}

template <class Entry>
void compareLists(const std::vector<Entry>& before, const std::vector<Entry>& after, const char* what,
                  std::vector<std::string>& out) {
    const auto find = [](const std::vector<Entry>& list, const std::string& id) {
        return std::find_if(list.begin(), list.end(), [&](const Entry& e) { return e.id == id; });
    };
    std::vector<std::string> kept, keptAfter;
    for (const Entry& e : before) {
        const auto now = find(after, e.id);
        if (now == after.end()) {
            out.push_back(fmt::format("{} {}: is gone", what, e.id));
            continue;
        }
        kept.push_back(e.id);
        compare(fieldsOf(e), fieldsOf(*now), fmt::format("{} {}", what, e.id), out);
    }
    for (const Entry& e : after)
        if (find(before, e.id) == before.end())
            out.push_back(fmt::format("{} {}: is new", what, e.id));
        else
            keptAfter.push_back(e.id);
    if (kept != keptAfter)
        out.push_back(fmt::format("{}: their order was {}, is {}", what, listed(kept), listed(keptAfter)));
}

}  // namespace

std::string canonicalText(const Rubric& r) {
    std::string out =
        fmt::format("handpiece rubric 1\nid={}\nversion={}\nstatus={}\n", r.id, r.version, nameOf(r.status));
    const auto add = [&](const std::string& head, const Fields& fields) {
        out += head;
        for (const auto& [key, value] : fields)
            out += fmt::format("{}={}\n", key, value);
    };
    add("", fieldsOf(r));
    // Of one without it there is no word: its hash is that of before there was such.
    if (r.completeness) add("[completeness]\n", fieldsOf(*r.completeness));
    for (const Step& s : r.steps)
        add(fmt::format("[step {}]\n", s.id), fieldsOf(s));
    for (const Criterion& c : r.criteria)
        add(fmt::format("[criterion {}]\n", c.id), fieldsOf(c));
    for (const Rule& rule : r.rules)
        add(fmt::format("[rule {}]\n", rule.id), fieldsOf(rule));
    return out;
}

std::uint64_t hashOf(const Rubric& rubric) {
    core::Hasher hasher;
    hasher.add(canonicalText(rubric));
    return hasher.value();
}

std::string hashText(std::uint64_t hash) {
    return fmt::format("{:016x}", hash);
}

std::vector<std::string> differences(const Rubric& before, const Rubric& after) {
    std::vector<std::string> out;
    const Fields own[] = {
        {{"id", before.id}, {"version", before.version}, {"status", std::string(nameOf(before.status))}},
        {{"id", after.id}, {"version", after.version}, {"status", std::string(nameOf(after.status))}}};
    compare(own[0], own[1], "rubric", out);
    compare(fieldsOf(before), fieldsOf(after), "rubric", out);
    if (before.completeness && after.completeness)
        compare(fieldsOf(*before.completeness), fieldsOf(*after.completeness), "completeness", out);
    else if (before.completeness || after.completeness)
        out.push_back(before.completeness
                          ? "completeness: is gone, points count whatever is done"
                          : fmt::format("completeness: is new, factors {}", knotsText(after.completeness->knots)));
    compareLists(before.steps, after.steps, "step", out);
    compareLists(before.criteria, after.criteria, "criterion", out);
    compareLists(before.rules, after.rules, "rule", out);
    for (const Criterion& c : before.criteria)
        if (const Criterion* now = after.criterion(c.id)) {
            const Fields a = wordsOf(c), b = wordsOf(*now);
            for (std::size_t i = 0; i < a.size(); ++i)
                if (a[i].second != b[i].second)
                    out.push_back(fmt::format("criterion {}: {} is another; no score changes", c.id, a[i].first));
        }
    const auto bandTitles = [](const Rubric& r) {
        std::map<std::string, Texts> titles;
        for (const BandName& b : r.bands)
            titles[b.id] = b.title;
        for (const Step& s : r.steps)
            titles["step " + s.id] = s.title;
        for (const Rule& rule : r.rules)
            titles["rule " + rule.id] = rule.title;
        return titles;
    };
    const auto readOnly = [](const Rubric& r) {
        const Completeness c = r.completeness.value_or(Completeness{});
        return std::tuple(c.title, c.words, c.source);
    };
    if (before.title != after.title || before.words != after.words || before.source != after.source ||
        (before.completeness && after.completeness && readOnly(before) != readOnly(after)) ||
        bandTitles(before) != bandTitles(after))
        out.push_back("rubric: title, words or source are others; no score changes");
    return out;
}

std::string describe(const Rubric& r, std::string_view language) {
    const config::Words& words = config::Words::in(language);
    const auto in = [&](const Texts& texts, const std::string& otherwise) {
        const std::string_view text = cases::inLanguage(texts, language);
        return text.empty() ? otherwise : std::string(text);
    };
    const auto bandTitle = [&](const std::string& id) {
        for (const BandName& b : r.bands)
            if (b.id == id) return in(b.title, id);
        return id;
    };
    const auto interval = [&](const std::optional<double>& from, const std::optional<double>& to) {
        if (from && to) return *from == *to ? number(from) : fmt::format("{} – {}", number(from), number(to));
        return from ? "≥ " + number(from) : to ? "≤ " + number(to) : words("rubric.any");
    };
    std::string out = fmt::format("{} ({} {})\n{}: {}\n", in(r.title, r.id), r.id, r.version, words("rubric.hash"),
                                  hashText(hashOf(r)));
    out += words(fmt::format("rubric.status.{}", nameOf(r.status))) + "\n";
    if (!r.source.empty()) out += fmt::format("{}: {}\n", words("rubric.source"), r.source);
    if (!r.words.empty()) out += in(r.words, {}) + "\n";
    if (r.passMark) out += fmt::format("{}: {} %\n", words("rubric.pass-mark"), number(*r.passMark));
    const auto measured = [&](const auto& c) {
        std::vector<std::string> narrowed;
        for (const std::string& part : {c.of.zone, c.of.tissue, c.of.side, c.of.statistic})
            if (!part.empty()) narrowed.push_back(part);
        if (c.of.limit) narrowed.push_back("> " + number(*c.of.limit));
        return fmt::format("  {}{}{}\n", c.measure,
                           narrowed.empty() ? "" : fmt::format(" ({})", fmt::join(narrowed, ", ")),
                           c.unit.empty() ? "" : " [" + c.unit + "]");
    };
    if (r.completeness) {
        const Completeness& c = *r.completeness;
        std::vector<std::string> knots;
        for (const Knot& k : c.knots)
            knots.push_back(fmt::format("{} = × {}", number(k.value), number(k.points)));
        out += fmt::format("\n{}\n{}  {}\n", in(c.title, words("rubric.completeness")), measured(c),
                           words("rubric.factor", fmt::format("{}", fmt::join(knots, ", "))));
        if (!c.words.empty()) out += fmt::format("  {}\n", in(c.words, {}));
        if (!c.source.empty()) out += fmt::format("  {}: {}\n", words("rubric.source"), c.source);
    }
    const auto criterion = [&](const Criterion& c) {
        out += fmt::format("\n{}  [{}]\n{}", in(c.title, c.id),
                           c.isGraded() ? words("rubric.points", number(c.weight))
                                        : words(c.critical ? "rubric.critical-only" : "rubric.shown"),
                           measured(c));
        for (const Band& b : c.bands)
            out += fmt::format("  {}: {}{}\n", bandTitle(b.id), interval(b.from, b.to),
                               b.points ? fmt::format(" = {} %", number(*b.points)) : "");
        if (!c.knots.empty()) {
            std::vector<std::string> knots;
            for (const Knot& k : c.knots)
                knots.push_back(fmt::format("{} = {} %", number(k.value), number(k.points)));
            out += fmt::format("  {}: {}\n", words("rubric.curve"), fmt::join(knots, ", "));
        }
        if (c.critical) {
            const auto& [below, above, title, line] = *c.critical;
            std::vector<std::string> limits;
            if (below) limits.push_back("< " + number(*below));
            if (above) limits.push_back("> " + number(*above));
            out += fmt::format("  {}: {}{}\n", words("rubric.critical"), fmt::join(limits, ", "),
                               title.empty() ? "" : ": " + in(title, {}));
        }
        if (!c.devices.empty()) out += fmt::format("  {}: {}\n", words("rubric.devices"), listed(c.devices));
        if (!c.excludes.empty()) out += fmt::format("  {}: {}\n", words("rubric.excludes"), listed(c.excludes));
        if (!c.words.empty()) out += fmt::format("  {}\n", in(c.words, {}));
        if (!c.leavesOut.empty()) out += fmt::format("  {}: {}\n", words("rubric.leaves-out"), in(c.leavesOut, {}));
        if (c.status && *c.status != r.status)
            out += fmt::format("  {}\n", words(fmt::format("rubric.status.{}", nameOf(*c.status))));
        if (!c.source.empty()) out += fmt::format("  {}: {}\n", words("rubric.source"), c.source);
    };
    std::vector<std::string> told;
    for (const Step& s : r.steps) {
        out += fmt::format("\n-- {} --\n", in(s.title, s.id));
        for (const std::string& id : s.criteria)
            if (const Criterion* c = r.criterion(id)) criterion(*c), told.push_back(id);
    }
    for (const Criterion& c : r.criteria)
        if (std::find(told.begin(), told.end(), c.id) == told.end()) criterion(c);
    for (const Rule& rule : r.rules) {
        out += fmt::format("\n{}: {}\n", words("rubric.rule"), in(rule.title, rule.id));
        for (const Condition& n : rule.needs)
            if (!n.rule.empty()) {
                out += fmt::format("  {}\n", words("rubric.needs-rule", n.rule));
            } else {
                std::vector<std::string> bands;
                for (const std::string& id : n.bands)
                    bands.push_back(bandTitle(id));
                out += fmt::format("  {}: {}{}\n", fmt::join(bands, ", "),
                                   n.least && n.most ? fmt::format("{} – {}", *n.least, *n.most)
                                   : n.least         ? fmt::format("≥ {}", *n.least)
                                                     : fmt::format("≤ {}", n.most.value_or(0)),
                                   n.of.empty() ? "" : fmt::format(" ({})", fmt::join(n.of, ", ")));
            }
        if (rule.required) out += "  " + words("rubric.required") + "\n";
        if (rule.elseAtMost) out += fmt::format("  {}\n", words("rubric.else-at-most", number(*rule.elseAtMost)));
        if (!rule.source.empty()) out += fmt::format("  {}: {}\n", words("rubric.source"), rule.source);
    }
    return out;
}

}  // namespace handpiece::rubric
