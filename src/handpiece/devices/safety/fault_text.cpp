// SPDX-License-Identifier: Apache-2.0
// What a person types after --inject.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <random>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/devices/safety/injector.h"

namespace handpiece::safety {
namespace {

constexpr std::array<std::string_view, kFaultKinds> kNames{"unplug",  "nan", "jump", "stall", "error",
                                                           "garbage", "hot", "drop", "tick"};
constexpr double kMaxS = 86400.0, kMaxSize = 2147483647.0;
constexpr int kMaxFaults = 100000;
constexpr std::array<double, 5> kErrorCodes{0x0200, 0x0203, 0x0301, 0x0303, 0x0600};

/// One specification and where in it the reading stands.
class Text {
  public:
    explicit Text(const std::string& text) : text_(text) {}

    [[nodiscard]] bool atEnd() {
        skipBlanks();
        return at_ >= text_.size();
    }
    bool take(char c) {
        skipBlanks();
        if (at_ >= text_.size() || text_[at_] != c) return false;
        ++at_;
        return true;
    }
    std::string_view word() {
        skipBlanks();
        const std::size_t from = at_;
        while (at_ < text_.size() && text_[at_] >= 'a' && text_[at_] <= 'z')
            ++at_;
        wordAt_ = from;
        return std::string_view(text_).substr(from, at_ - from);
    }
    double number(const char* what, double least, double most) {
        skipBlanks();
        const std::size_t from = at_;
        const std::string_view rest = std::string_view(text_).substr(at_);
        double value = 0.0;
        std::size_t used = 0;
        if (rest.starts_with("0x") || rest.starts_with("0X")) {
            std::uint32_t code = 0;
            const auto [end, error] = std::from_chars(rest.data() + 2, rest.data() + rest.size(), code, 16);
            used = error == std::errc{} ? static_cast<std::size_t>(end - rest.data()) : 0;
            value = code;
        } else {
            const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
            used = error == std::errc{} ? static_cast<std::size_t>(end - rest.data()) : 0;
        }
        if (used == 0) fail(from, fmt::format("a number is wanted: {}", what));
        if (!(value >= least && value <= most))
            fail(from, fmt::format("{} of {:.6g}; {:.6g} to {:.6g} is possible", what, value, least, most));
        at_ += used;
        return value;
    }
    [[nodiscard]] std::size_t wordAt() const { return wordAt_; }
    [[nodiscard]] std::size_t at() {
        skipBlanks();
        return at_;
    }
    [[noreturn]] void fail(std::size_t where, const std::string& what) const {
        throw core::Error(fmt::format("{} (at character {}: \"{}\" <here> \"{}\")", what, where + 1,
                                      text_.substr(where > 20 ? where - 20 : 0, std::min<std::size_t>(where, 20)),
                                      text_.substr(where, 20)),
                          "faults to inject",
                          fmt::format("write for instance \"unplug@2.5, stall@3:0.2, error@5:0.1=0x0301\" or "
                                      "\"random:100:seed=7:every=0.5:from=2\"; kinds are {}",
                                      fmt::join(kNames, ", ")))
            .as("bad-faults", {what, fmt::format("{}", where + 1)});
    }

  private:
    void skipBlanks() {
        while (at_ < text_.size() && text_[at_] == ' ')
            ++at_;
    }
    const std::string& text_;
    std::size_t at_ = 0, wordAt_ = 0;
};

FaultKind kindOf(const Text& text, std::string_view word) {
    const auto found = std::find(kNames.begin(), kNames.end(), word);
    if (found == kNames.end()) {
        text.fail(text.wordAt(), word.empty() ? std::string("the kind of a fault is wanted")
                                              : fmt::format("no kind of fault is called \"{}\"", word));
    }
    return static_cast<FaultKind>(found - kNames.begin());
}

double uniform(std::mt19937_64& generator, double low, double high) {
    return low + (high - low) * static_cast<double>(generator() >> 11) * 0x1p-53;
}

Fault one(Text& text, FaultKind kind) {
    if (!text.take('@')) text.fail(text.at(), "\"@\" and the time in seconds is wanted");
    Fault fault;
    fault.kind = kind;
    fault.atS = text.number("a time [s]", 0.0, kMaxS);
    if (text.take(':')) fault.lastsS = text.number("a duration [s]", 1e-4, kMaxS);
    if (kind == FaultKind::error) fault.size = 1.0;
    if (text.take('=')) fault.size = text.number("a size", -kMaxSize, kMaxSize);
    return fault;
}

void random(Text& text, std::vector<Fault>& faults) {
    if (!text.take(':')) text.fail(text.at(), "\":\" and a number of faults is wanted");
    const double count = text.number("a number of faults", 1, kMaxFaults);
    double seed = 1, every = 0.5, from = 1.0;
    std::vector<FaultKind> kinds;
    while (text.take(':')) {
        const std::string_view word = text.word();
        const std::size_t at = text.wordAt();
        if (!text.take('=')) text.fail(at, "seed=, every=, from= or kinds= is wanted");
        if (word == "seed") {
            seed = text.number("a seed", 0, 9e15);
        } else if (word == "every") {
            every = text.number("a pause [s]", 1e-3, kMaxS);
        } else if (word == "from") {
            from = text.number("a time [s]", 0.0, kMaxS);
        } else if (word == "kinds") {
            do {
                kinds.push_back(kindOf(text, text.word()));
            } while (text.take('+'));
        } else {
            text.fail(at, fmt::format("\"{}\" is unknown", word));
        }
    }
    if (kinds.empty()) {
        for (std::size_t k = 0; k < kFaultKinds; ++k)
            kinds.push_back(static_cast<FaultKind>(k));
    }
    std::mt19937_64 generator(static_cast<std::uint64_t>(seed));
    double at = from;
    for (int i = 0; i < static_cast<int>(count); ++i) {
        Fault fault;
        fault.kind = kinds[generator() % kinds.size()];
        fault.atS = at;
        const bool stands = fault.kind == FaultKind::stall || fault.kind == FaultKind::tickStall;
        // As many short ones as long ones.
        fault.lastsS = stands ? 0.005 * core::pow(100.0, uniform(generator, 0.0, 1.0))
                              : 0.001 * core::pow(100.0, uniform(generator, 0.0, 1.0));
        if (fault.kind == FaultKind::jump) fault.size = uniform(generator, 0.1, 3.0);
        if (fault.kind == FaultKind::error) fault.size = kErrorCodes[generator() % kErrorCodes.size()];
        if (fault.kind == FaultKind::hot) fault.size = uniform(generator, 1.0, 1.5);
        faults.push_back(fault);
        at += fault.lastsS + every * uniform(generator, 0.5, 1.5);
    }
}

}  // namespace

std::string_view nameOf(FaultKind kind) noexcept {
    const auto at = static_cast<std::size_t>(kind);
    return at < kNames.size() ? kNames[at] : "?";
}

std::vector<Fault> parseFaults(const std::string& specification) {
    Text text(specification);
    std::vector<Fault> faults;
    do {
        const std::string_view word = text.word();
        if (word == "random")
            random(text, faults);
        else
            faults.push_back(one(text, kindOf(text, word)));
    } while (text.take(','));
    if (!text.atEnd()) text.fail(text.at(), "a comma or the end is wanted");
    std::stable_sort(faults.begin(), faults.end(), [](const Fault& a, const Fault& b) { return a.atS < b.atS; });
    return faults;
}

}  // namespace handpiece::safety
