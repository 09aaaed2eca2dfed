// SPDX-License-Identifier: Apache-2.0
#include "studies/stability_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace handpiece::studies {
namespace {

constexpr int kCell = 21, kLabels = 122, kGap = 40, kTop = 120, kBottom = 46;
constexpr int kFrictionLabel = 46, kPanelTitle = 250;  ///< px that the words over the columns need

struct Count {
    int all = 0, off = 0, on = 0;  ///< loops; that are not passive
};
using Key = std::tuple<double, double, std::string_view, double, double>;

class Page {
  public:
    Page(int width, int height) {
        svg_ = fmt::format(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
            "font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
            width, height);
    }
    void text(double x, double y, const std::string& words, const char* anchor, int size = 11) {
        svg_ +=
            fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"{}\" font-size=\"{}\" fill=\"#222\">{}</text>\n",
                        x, y, anchor, size, words);
    }
    void cell(double x, double y, int width, int failed, const std::string& title) {
        const char* colour = failed == 0 ? "#4a90c2" : failed < 4 ? "#f0b060" : "#d9661f";
        svg_ += fmt::format(
            "<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{}\" height=\"{}\" fill=\"{}\" stroke=\"#fff\"><title>{}"
            "</title></rect>\n",
            x, y, width, kCell, colour, title);
        if (failed > 0) text(x + 0.5 * width, y + 0.5 * kCell + 4, std::to_string(failed), "middle", 10);
    }
    [[nodiscard]] std::string finish() const { return svg_ + "</svg>\n"; }

  private:
    std::string svg_;
};

}  // namespace

std::string stabilitySvg(const studies::StabilitySweep& sweep, const std::vector<studies::StabilityRow>& rows,
                         studies::LoopMotion motion) {
    const bool touch = motion == studies::LoopMotion::touch;
    const std::vector<double>& rates = touch ? sweep.rateHz : sweep.molarRateHz;
    const std::vector<double>& frictions = touch ? sweep.frictionN : sweep.molarFrictionN;
    std::map<Key, Count> counts;
    Count sum;
    for (const studies::StabilityRow& r : rows) {
        if (r.motion != motion) continue;
        for (Count* c : {&counts[{r.limitNPerMm, r.rateHz, r.hand, r.frictionN, r.delayS}], &sum}) {
            ++c->all;
            c->off += !r.off.holds;
            c->on += !r.on.holds;
        }
    }
    const std::size_t delays = sweep.delayS.size(), columns = sweep.hands.size() * frictions.size() * delays;
    const std::size_t lines = sweep.stiffnessNPerMm.size() * rates.size();
    // With few delays a cell is as wide as the friction's label over it.
    const int wide = std::max(kCell, kFrictionLabel / static_cast<int>(delays));
    const int panel = std::max(static_cast<int>(columns) * wide, kPanelTitle);
    Page page(kLabels + 2 * panel + kGap + 20, kTop + static_cast<int>(lines) * kCell + kBottom);
    page.text(8, 20,
              fmt::format("Stability map, {}: passive or not, {} tissues a cell", studies::nameOf(motion),
                          sweep.tissues.size()),
              "start", 15);
    for (const bool on : {false, true}) {
        const double left = kLabels + (on ? panel + kGap : 0);
        page.text(left, 46,
                  fmt::format("controller {}: {} of {} loops hold", on ? "on" : "off",
                              sum.all - (on ? sum.on : sum.off), sum.all),
                  "start", 13);
        for (std::size_t c = 0; c < columns; ++c) {
            const device::Hand& hand = sweep.hands[c / (delays * frictions.size())];
            const double friction = frictions[c / delays % frictions.size()], delay = sweep.delayS[c % delays];
            const double x = left + static_cast<double>(c) * wide;
            page.text(x + 0.5 * wide, kTop - 8, fmt::format("{:.3g}", 1e3 * delay), "middle");
            if (c % delays == 0)
                page.text(x + 0.5 * wide * static_cast<double>(delays), kTop - 24, fmt::format("{:.2f} N", friction),
                          "middle");
            if (c % (delays * frictions.size()) == 0)
                page.text(x + 0.5 * wide * static_cast<double>(delays * frictions.size()), kTop - 42,
                          std::string(hand.name), "middle");
            std::size_t l = 0;
            for (const double limit : sweep.stiffnessNPerMm)
                for (const double rate : rates) {
                    const Count& count = counts[{limit, rate, hand.name, friction, delay}];
                    const double y = kTop + static_cast<double>(l++) * kCell;
                    page.cell(
                        x, y, wide, on ? count.on : count.off,
                        fmt::format("{} N/mm, {:.0f} Hz, {} hand, {} N, {:.3g} ms: {} of {} not passive", limit, rate,
                                    hand.name, friction, 1e3 * delay, on ? count.on : count.off, count.all));
                }
        }
    }
    std::size_t l = 0;
    for (const double limit : sweep.stiffnessNPerMm)
        for (const double rate : rates)
            page.text(kLabels - 8, kTop + static_cast<double>(l++) * kCell + 15,
                      fmt::format("{:.3g} N/mm, {:.3g} kHz", limit, 1e-3 * rate), "end");
    page.text(8, kTop - 8, "delay [ms]", "start");
    page.text(8, kTop - 24, "friction of the arm", "start");
    page.text(8, kTop - 42, "hand", "start");
    page.text(8, kTop + static_cast<double>(lines) * kCell + 24,
              "blue: every tissue's loop is passive; orange: so many are not, four and more darker; down: stiffness of "
              "enamel, rate",
              "start");
    return page.finish();
}

}  // namespace handpiece::studies
