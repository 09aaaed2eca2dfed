// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/marks_agreement.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "handpiece/app/report/assessment_words.h"
#include "handpiece/app/report/plot.h"
#include "handpiece/base/core/error.h"

namespace handpiece::assessment {
namespace {

using agreement::Bootstrap;
using agreement::Estimate;
using agreement::Level;
using Json = nlohmann::ordered_json;
using Values = std::vector<std::optional<double>>;

constexpr double kMostMark = 1e9;

std::optional<double> numberOf(const std::string& mark) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(mark.data(), mark.data() + mark.size(), value);
    if (error != std::errc() || end != mark.data() + mark.size() || !(std::abs(value) <= kMostMark)) return {};
    return value;
}

const char* nameOf(Level level) {
    switch (level) {
        case Level::nominal:
            return "nominal";
        case Level::ordinal:
            return "ordinal";
        case Level::interval:
            return "interval";
        case Level::ratio:
            return "ratio";
    }
    return "";
}

/// Rows of items, drawn.
Values drawn(const Values& values, std::size_t raters, std::span<const std::size_t> places) {
    Values out;
    out.reserve(places.size() * raters);
    for (const std::size_t item : places)
        out.insert(out.end(), values.begin() + static_cast<std::ptrdiff_t>(item * raters),
                   values.begin() + static_cast<std::ptrdiff_t>((item + 1) * raters));
    return out;
}

Alpha alphaOf(const Values& values, std::size_t raters, Level level, std::size_t draws) {
    Alpha alpha{level, agreement::krippendorffAlpha(values, raters, level), {}};
    if (alpha.estimate.value)
        alpha.bootstrap = agreement::bootstrap(
            values.size() / raters, agreement::seedOf(values, raters), draws, [&](std::span<const std::size_t> places) {
                return agreement::krippendorffAlpha(drawn(values, raters, places), raters, level).value;
            });
    return alpha;
}

void addIcc(CriterionAgreement& out, const Values& values, std::size_t raters, std::size_t draws) {
    std::vector<double> whole;
    for (std::size_t i = 0; i < values.size() / raters; ++i) {
        const auto row = std::span(values).subspan(i * raters, raters);
        if (std::all_of(row.begin(), row.end(), [](const auto& v) { return v.has_value(); }))
            for (const auto& v : row)
                whole.push_back(*v);
    }
    out.icc = agreement::icc(whole, raters);
    if (!out.icc->two1.value) return;
    const Values same(whole.begin(), whole.end());
    out.iccBootstrap = agreement::bootstrap(
        whole.size() / raters, agreement::seedOf(same, raters), draws, [&](std::span<const std::size_t> places) {
            std::vector<double> rows;
            for (const std::size_t item : places)
                rows.insert(rows.end(), whole.begin() + static_cast<std::ptrdiff_t>(item * raters),
                            whole.begin() + static_cast<std::ptrdiff_t>((item + 1) * raters));
            return agreement::icc(rows, raters).two1.value;
        });
}

Json toJson(const std::optional<agreement::Interval>& interval) {
    return interval ? Json{interval->low, interval->high} : Json(nullptr);
}
Json orNull(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}
Json toJson(const Estimate& e) {
    return {{"value", orNull(e.value)},
            {"standard_error", orNull(e.standardError)},
            {"ci95", toJson(e.interval)},
            {"reason", e.reason}};
}
Json toJson(const Bootstrap& b) {
    return {{"ci95", toJson(b.interval)}, {"undefined_draws", b.undefined}, {"seed", fmt::format("{:016x}", b.seed)}};
}
Json toJson(const agreement::BlandAltman& b) {
    return {{"items", b.count},
            {"bias", orNull(b.bias)},
            {"sd", orNull(b.spread)},
            {"low", orNull(b.low)},
            {"high", orNull(b.high)},
            {"bias_ci95", toJson(b.biasInterval)},
            {"low_ci95", toJson(b.lowInterval)},
            {"high_ci95", toJson(b.highInterval)},
            {"reason", b.reason}};
}

std::string told(const Estimate& e) {
    if (!e.value) return "undefined: " + e.reason;
    std::string text = fmt::format("{:.4f}", *e.value);
    if (e.interval) text += fmt::format(" (95 % {:.4f} to {:.4f})", e.interval->low, e.interval->high);
    return text;
}

}  // namespace

CriterionAgreement agreementOf(const MarkTable& table, const MarkScale& scale, std::size_t draws) {
    CriterionAgreement out;
    out.criterion = table.criterion;
    out.raters = table.raters;
    out.items = table.items.size();
    const std::size_t raters = table.raters.size();
    const auto wrong = [&](const std::string& mark, const std::string& remedy) {
        throw core::Error(fmt::format("\"{}\" is not on the scale{}", mark,
                                      table.criterion.empty() ? "" : fmt::format(" of \"{}\"", table.criterion)),
                          table.where, remedy);
    };
    out.areNumbers = scale.categories.empty() && std::all_of(table.marks.begin(), table.marks.end(),
                                                             [](const auto& m) { return !m || numberOf(*m); });
    out.isOrdered = out.areNumbers || !scale.categories.empty();
    out.categories = scale.categories;
    if (!out.areNumbers && scale.categories.empty()) {
        std::set<std::string> labels;
        for (const auto& m : table.marks)
            if (m) labels.insert(*m);
        out.categories.assign(labels.begin(), labels.end());
    }
    Values values(table.marks.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!table.marks[i]) continue;
        ++out.marks;
        const std::string& mark = *table.marks[i];
        if (out.areNumbers) {
            values[i] = numberOf(mark);
        } else {
            const auto at = std::find(out.categories.begin(), out.categories.end(), mark);
            if (at == out.categories.end()) wrong(mark, fmt::format("one of {}", fmt::join(out.categories, ", ")));
            values[i] = static_cast<double>(at - out.categories.begin());
        }
    }
    for (std::size_t i = 0; i < out.items; ++i) {
        const auto row = std::span(values).subspan(i * raters, raters);
        out.wholeItems += std::all_of(row.begin(), row.end(), [](const auto& v) { return v.has_value(); }) ? 1 : 0;
    }
    for (std::size_t a = 0; a < raters; ++a)
        for (std::size_t b = a + 1; b < raters; ++b) {
            RaterPair pair;
            pair.first = table.raters[a];
            pair.second = table.raters[b];
            std::vector<double> first, second;
            for (std::size_t i = 0; i < out.items; ++i)
                if (values[i * raters + a] && values[i * raters + b]) {
                    first.push_back(*values[i * raters + a]);
                    second.push_back(*values[i * raters + b]);
                }
            pair.items = first.size();
            if (out.areNumbers) {
                pair.blandAltman = agreement::blandAltman(first, second);
                for (std::size_t i = 0; i < first.size(); ++i) {
                    pair.means.push_back(0.5 * (first[i] + second[i]));
                    pair.differences.push_back(first[i] - second[i]);
                }
            } else {
                const std::size_t n = out.categories.size();
                const auto places = [](const std::vector<double>& marks) {
                    return std::vector<std::size_t>(marks.begin(), marks.end());
                };
                const std::vector<std::size_t> counts = agreement::countsOf(places(first), places(second), n);
                pair.kappa = agreement::kappa(counts, n, agreement::Weights::none);
                if (out.isOrdered) {
                    pair.linear = agreement::kappa(counts, n, agreement::Weights::linear);
                    pair.quadratic = agreement::kappa(counts, n, agreement::Weights::quadratic);
                }
            }
            out.pairs.push_back(std::move(pair));
        }
    std::vector<Level> levels = {Level::nominal};
    if (out.areNumbers)
        levels = {Level::ordinal, Level::interval, Level::ratio};
    else if (out.isOrdered)
        levels = {Level::nominal, Level::ordinal};
    for (const Level level : levels)
        out.alphas.push_back(alphaOf(values, raters, level, draws));
    if (out.areNumbers) addIcc(out, values, raters, draws);
    return out;
}

std::string agreementJson(std::span<const CriterionAgreement> all) {
    Json json = {{"schema", "handpiece-agreement-1"}, {"criteria", Json::array()}};
    for (const CriterionAgreement& c : all) {
        Json one = {{"criterion", c.criterion.empty() ? Json(nullptr) : Json(c.criterion)},
                    {"scale", c.areNumbers  ? "numbers"
                              : c.isOrdered ? "ordered categories"
                                            : "categories"},
                    {"categories", c.categories},
                    {"raters", c.raters},
                    {"items", c.items},
                    {"marks", c.marks},
                    {"items_marked_by_all", c.wholeItems},
                    {"alpha", Json::object()}};
        for (const Alpha& a : c.alphas) {
            Json alpha = toJson(a.estimate);
            alpha["ci95"] = toJson(a.bootstrap.interval);
            alpha["bootstrap"] = toJson(a.bootstrap);
            one["alpha"][nameOf(a.level)] = std::move(alpha);
        }
        if (c.icc) {
            Json icc = Json::object();
            const std::pair<const char*, const Estimate*> six[] = {{"1,1", &c.icc->one1},   {"2,1", &c.icc->two1},
                                                                   {"3,1", &c.icc->three1}, {"1,k", &c.icc->oneK},
                                                                   {"2,k", &c.icc->twoK},   {"3,k", &c.icc->threeK}};
            for (const auto& [name, estimate] : six)
                icc[name] = toJson(*estimate);
            if (c.iccBootstrap) icc["2,1"]["bootstrap"] = toJson(*c.iccBootstrap);
            icc["mean_squares"] = {{"between_items", c.icc->betweenItems},
                                   {"within_items", c.icc->withinItems},
                                   {"between_raters", c.icc->betweenRaters},
                                   {"error", c.icc->error}};
            one["icc"] = std::move(icc);
        }
        one["pairs"] = Json::array();
        for (const RaterPair& p : c.pairs) {
            Json pair = {{"raters", {p.first, p.second}}, {"items", p.items}};
            if (p.kappa) pair["kappa"] = toJson(*p.kappa);
            if (p.linear) pair["kappa_linear"] = toJson(*p.linear);
            if (p.quadratic) pair["kappa_quadratic"] = toJson(*p.quadratic);
            if (p.blandAltman) pair["bland_altman"] = toJson(*p.blandAltman);
            one["pairs"].push_back(std::move(pair));
        }
        json["criteria"].push_back(std::move(one));
    }
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string agreementText(std::span<const CriterionAgreement> all) {
    std::string out;
    for (const CriterionAgreement& c : all) {
        out +=
            fmt::format("{}{} items, {} raters, {} marks, {} items marked by all\n",
                        c.criterion.empty() ? "" : c.criterion + ": ", c.items, c.raters.size(), c.marks, c.wholeItems);
        for (const Alpha& a : c.alphas) {
            Estimate e = a.estimate;
            e.interval = a.bootstrap.interval;
            out += fmt::format("  alpha, {:<22}{}\n", nameOf(a.level), told(e));
        }
        if (c.icc) {
            out += fmt::format("  {:<29}{}\n", "ICC(2,1)", told(c.icc->two1));
            out += fmt::format("  {:<29}{}\n", "ICC(3,1)", told(c.icc->three1));
        }
        for (const RaterPair& p : c.pairs) {
            out += fmt::format("  {} and {}, {} items\n", p.first, p.second, p.items);
            if (p.kappa) out += fmt::format("    {:<27}{}\n", "kappa", told(*p.kappa));
            if (p.linear) out += fmt::format("    {:<27}{}\n", "weighted kappa, linear", told(*p.linear));
            if (p.quadratic) out += fmt::format("    {:<27}{}\n", "weighted kappa, quadratic", told(*p.quadratic));
            if (p.blandAltman) {
                const agreement::BlandAltman& b = *p.blandAltman;
                out += b.bias ? fmt::format("    {:<27}{:.4f}, limits of agreement {:.4f} to {:.4f}\n", "bias", *b.bias,
                                            *b.low, *b.high)
                              : fmt::format("    {:<27}undefined: {}\n", "bias", b.reason);
            }
        }
    }
    return out;
}

std::string blandAltmanSvg(const CriterionAgreement& of, const RaterPair& pair) {
    report::Plot plot;
    const std::string& name = of.title.empty() ? of.criterion : of.title;
    plot.title = fmt::format("{}{} − {}", name.empty() ? "" : name + ": ", pair.first, pair.second);
    plot.xLabel = report::said("mean of both");
    plot.yLabel = report::said("difference");
    report::Series marks;
    marks.x = pair.means;
    marks.y = pair.differences;
    marks.line = false;
    marks.markers = true;
    plot.series.push_back(std::move(marks));
    if (pair.blandAltman && pair.blandAltman->bias && *pair.blandAltman->low == *pair.blandAltman->high)
        plot.limits = {{*pair.blandAltman->bias, report::said("bias, ±1.96 sd")}};
    else if (pair.blandAltman && pair.blandAltman->bias)
        plot.limits = {{*pair.blandAltman->bias, report::said("bias")},
                       {*pair.blandAltman->low, "−1.96 sd"},
                       {*pair.blandAltman->high, "+1.96 sd"}};
    return report::toSvg(plot, true);
}

}  // namespace handpiece::assessment
