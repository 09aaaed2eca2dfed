// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/segmentation/label_key.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/case/fdi.h"

namespace handpiece::segmentation {
namespace {

using What = LabelMeaning::What;

/// A tooth's volume, with room: what is larger is a jaw, what is smaller a speck.
constexpr double kSmallestToothMm3 = 40.0, kLargestToothMm3 = 2500.0;
constexpr std::uint8_t kPulp = 4;

bool isFdi(int n) {
    return cases::isPermanentTooth(n) || cases::isDeciduousTooth(n);
}

/// What ToothFairy 2 and 3 have beside the teeth.
LabelMeaning besideTeeth(int n) {
    if (n == 1) return {What::lowerBone, 0};
    if (n == 2) return {What::upperBone, 0};
    if (n >= 8 && n <= 10) return {What::prosthesis, 0};
    if ((n >= 3 && n <= 7) || (n >= 103 && n <= 105)) return {What::notShown, 0};
    return {};
}

LabelMeaning meaningOf(int n, LabelNumbers numbers) {
    // The nth tooth of four quadrants of eight.
    const auto nth = [](int i) { return 10 * (1 + i / 8) + 1 + i % 8; };
    switch (numbers) {
        case LabelNumbers::tissues:
            return {What::tissue, n};
        case LabelNumbers::fdi:
            if (isFdi(n)) return {What::tooth, n};
            if (isFdi(n - 100)) return {What::pulp, n - 100};
            return besideTeeth(n);
        case LabelNumbers::universal:
            if (n < 1 || n > 32) return {};
            // 1 to 8 and 17 to 24 run towards the midline.
            return {What::tooth, n <= 8 ? 19 - n : n <= 16 ? 12 + n : n <= 24 ? 55 - n : 16 + n};
        case LabelNumbers::consecutive:
            if (n >= 11 && n <= 42) return {What::tooth, nth(n - 11)};
            if (n >= 46 && n <= 77) return {What::pulp, nth(n - 46)};
            if (n >= 43 && n <= 45) return {What::notShown, 0};
            return besideTeeth(n);
    }
    return {};
}

// Names.

std::string plain(std::string_view name) {
    std::string text;
    for (const char c : name) {
        const bool isUpper = c >= 'A' && c <= 'Z';
        text += c == '_' || c == '-' || c == '.' || c == '#' || c == ':' ? ' '
                : isUpper                                                ? static_cast<char>(c + 32)
                                                                         : c;
    }
    return text;
}

/// 3D Slicer's own name for a segment that nobody named, "Segment_11", counts and tells nothing.
bool isCounted(const std::string& text) {
    return text.rfind("segment ", 0) == 0 && text.find_first_not_of("0123456789 ", 8) == std::string::npos;
}

/// A number of two or three figures that stands alone, or behind "fdi", "tooth", "t"; 0: there is none.
int numberIn(const std::string& text) {
    if (isCounted(text)) return 0;
    const auto isDigit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (!isDigit(i) || (i > 0 && isDigit(i - 1))) continue;
        std::size_t end = i;
        while (isDigit(end))
            ++end;
        if (end - i < 2 || end - i > 3) continue;
        const std::string before = text.substr(0, i);
        const auto endsWith = [&](std::string_view word) {
            return before.size() >= word.size() && before.compare(before.size() - word.size(), word.size(), word) == 0;
        };
        const bool isAlone = before.empty() || before.back() == ' ';
        if (!isAlone && !endsWith("fdi") && !endsWith("tooth") && !endsWith("pulp") && before != "t") continue;
        int n = 0;
        for (std::size_t d = i; d < end; ++d)
            n = 10 * n + (text[d] - '0');
        if (isFdi(n) || isFdi(n - 100)) return n;
    }
    return 0;
}

/// "upper right first molar" in any order of its words; 0: it is none.
int fdiByWords(const std::string& text) {
    const auto has = [&](std::string_view word) { return text.find(word) != std::string::npos; };
    const bool isUpper = has("upper") || has("maxillary"), isLower = has("lower") || has("mandibular");
    const bool isRight = has("right"), isLeft = has("left");
    if (isUpper == isLower || isRight == isLeft) return 0;
    const bool isMilk = has("deciduous") || has("primary") || has("milk");
    const int order = has("first") || has("1st")                    ? 1
                      : has("second") || has("2nd")                 ? 2
                      : has("third") || has("3rd") || has("wisdom") ? 3
                                                                    : 0;
    int place = 0;
    if (has("incisor"))
        place = has("central") ? 1 : has("lateral") ? 2 : 0;
    else if (has("premolar") || has("bicuspid"))
        place = order == 1 || order == 2 ? 3 + order : 0;
    else if (has("canine") || has("cuspid"))
        place = 3;
    else if (has("molar"))
        place = order == 0 ? 0 : (isMilk ? 3 : 5) + order;
    if (place == 0 || (isMilk && place > 5)) return 0;
    const int quadrant = isUpper ? (isRight ? 1 : 2) : (isRight ? 4 : 3);
    return 10 * (quadrant + (isMilk ? 4 : 0)) + place;
}

/// What a name says; `isGroup`: of several teeth that are not told apart.
LabelMeaning byName(std::string_view name, bool& isGroup) {
    const std::string text = plain(name);
    const auto has = [&](std::string_view word) { return text.find(word) != std::string::npos; };
    if (has("sinus") || has("canal") || has("nerve") || has("pharynx") || has("airway")) {
        if (!has("root canal")) return {What::notShown, 0};
    }
    if (has("missing") || has("absent") || has("extracted")) return {What::notShown, 0};
    if (has("implant") || has("bridge") || has("pontic")) return {What::prosthesis, 0};
    const bool isPulp = has("pulp") || has("root canal");
    int fdi = numberIn(text);
    if (fdi > 100) fdi -= 100;
    if (fdi == 0) fdi = fdiByWords(text);
    if (fdi != 0) return {isPulp ? What::pulp : What::tooth, fdi};
    if (has("teeth") || has("dentition")) {
        isGroup = true;
        return {};
    }
    if (has("implant") || has("bridge") || has("prosthe")) return {What::prosthesis, 0};
    if (has("enamel")) return {What::tissue, 2};
    if (has("dentin")) return {What::tissue, 3};
    if (isPulp) return {What::tissue, kPulp};
    if (has("caries") || has("carious") || has("decay")) return {What::tissue, 1};
    if (has("filling") || has("restoration")) return {What::tissue, 5};
    if (has("crown")) return {What::prosthesis, 0};
    if (has("gingiva") || has("gum")) return {What::gum, 7};
    if (has("mandib") || has("lower jaw")) return {What::lowerBone, 6};
    if (has("maxill") || has("upper jaw") || has("skull") || has("cranium")) return {What::upperBone, 6};
    if (has("bone")) return {What::tissue, 6};
    return {};
}

/// Numbers behind the same words, "tooth 2" to "tooth 31", of which one is none of FDI's: they are of another way to
/// count, or nobody can tell.
bool areOtherNumbers(const std::vector<std::string>& texts) {
    struct Seen {
        bool hasFdi = false, hasOther = false;
    };
    std::map<std::string, Seen> seen;
    for (const std::string& text : texts) {
        const std::size_t from = text.find_first_of("0123456789");
        if (from == std::string::npos || isCounted(text) || text.find("fdi") != std::string::npos) continue;
        const std::size_t end = std::min(text.find_first_not_of("0123456789", from), text.size());
        if (end - from > 3) continue;
        const int n = std::stoi(text.substr(from, end - from));
        Seen& words = seen[text.substr(0, from) + '#' + text.substr(end)];
        (isFdi(n) || isFdi(n - 100) ? words.hasFdi : words.hasOther) = true;
    }
    return std::any_of(seen.begin(), seen.end(), [](const auto& s) { return s.second.hasFdi && s.second.hasOther; });
}

struct Present {
    std::array<std::size_t, 256> counts{};
    double voxelMm3 = 1.0;
    [[nodiscard]] bool has(int n) const { return n > 0 && n < 256 && counts[static_cast<std::size_t>(n)] > 0; }
    [[nodiscard]] double mm3(int n) const {
        return has(n) ? voxelMm3 * static_cast<double>(counts[static_cast<std::size_t>(n)]) : 0.0;
    }
    [[nodiscard]] int largest() const {
        int most = 0;
        for (int n = 1; n < 256; ++n)
            if (has(n)) most = n;
        return most;
    }
    template <class Is>
    [[nodiscard]] int count(int from, int to, const Is& is) const {
        int number = 0;
        for (int n = from; n <= to; ++n)
            number += has(n) && is(n) ? 1 : 0;
        return number;
    }
};

Present presentIn(const volume::Labels& labels) {
    Present present;
    present.voxelMm3 = labels.grid.voxelMm3();
    for (const std::uint8_t v : labels.values)
        ++present.counts[v];
    present.counts[0] = 0;
    return present;
}

/// None: the numbers alone do not tell.
std::optional<LabelNumbers> numbersOf(const Present& present) {
    const int largest = present.largest();
    if (largest <= 10) return LabelNumbers::tissues;
    const auto any = [](int) { return true; };
    const auto isToothSized = [&](int n) {
        return present.mm3(n) >= kSmallestToothMm3 && present.mm3(n) <= kLargestToothMm3;
    };
    // FDI numbers leave these out, teeth that are counted through do not.
    const int between = present.count(11, 48, [](int n) { return !isFdi(n); });
    const int teeth = present.count(11, 85, isFdi);
    if (between > 0) {
        if (present.count(33, 77, any) > 0 && largest <= 77) return LabelNumbers::consecutive;
        const bool hasJaws = present.mm3(1) > kLargestToothMm3 || present.mm3(2) > kLargestToothMm3;
        return hasJaws && largest <= 77 ? std::optional(LabelNumbers::consecutive) : std::nullopt;
    }
    if (teeth == 0) return LabelNumbers::tissues;
    // 1 to 10 as teeth would be Universal numbers; jaws, canals and sinuses are not that size, all of them.
    const int small = present.count(1, 10, isToothSized), other = present.count(1, 10, any) - small;
    if (largest <= 32 && small >= 3 && other == 0) return std::nullopt;
    return LabelNumbers::fdi;
}

core::Error ambiguous(const std::string& where) {
    return core::Error(
               "its labels may be FDI numbers, Universal numbers (1 to 32) or teeth that are counted "
               "through: they do not tell which",
               where, "say which they are: --numbers fdi, universal or consecutive")
        .as("labels-ambiguous");
}

bool hasTeeth(const LabelKey& key, const Present& present) {
    for (int n = 1; n < 256; ++n)
        if (present.has(n) && key.of[static_cast<std::size_t>(n)].what == What::tooth) return true;
    return false;
}

}  // namespace

LabelNumbers labelNumbersByName(std::string_view name) {
    const auto found = std::find(kLabelNumbers.begin(), kLabelNumbers.end(), name);
    if (found == kLabelNumbers.end())
        throw core::Error("there are no such numbers of labels", std::string(name),
                          fmt::format("give {}", fmt::join(kLabelNumbers, ", ")));
    return static_cast<LabelNumbers>(found - kLabelNumbers.begin());
}

LabelKey labelKeyOf(const volume::Labels& labels, const std::vector<volume::LabelName>& names,
                    std::optional<LabelNumbers> asked, const std::string& where) {
    const Present present = presentIn(labels);
    LabelKey key;
    const auto byNumbers = [&](LabelNumbers numbers) {
        for (int n = 1; n < 256; ++n)
            key.of[static_cast<std::size_t>(n)] = meaningOf(n, numbers);
        key.isMouth = numbers != LabelNumbers::tissues;
    };
    bool isByName = false;
    if (!asked) {
        int groups = 0, teeth = 0, tissues = 0;
        std::vector<std::string> texts;
        std::map<int, int> namesOf;
        for (const volume::LabelName& name : names) {
            if (!present.has(name.value)) continue;
            texts.push_back(plain(name.name));
            if (++namesOf[name.value] == 2)
                key.notes.push_back(
                    fmt::format("label {} has several names in the file: the last one counts", name.value));
            bool isGroup = false;
            const LabelMeaning meaning = byName(name.name, isGroup);
            key.of[static_cast<std::size_t>(name.value)] = meaning;
            groups += isGroup ? 1 : 0;
            teeth += meaning.what == What::tooth ? 1 : 0;
            tissues += meaning.what == What::tissue && (meaning.number == 2 || meaning.number == 3) ? 1 : 0;
        }
        isByName = teeth > 0 || tissues > 0;
        if (teeth > 0 && areOtherNumbers(texts)) throw ambiguous(where);
        if (groups > 0 && !isByName)
            throw core::Error("its labels tell jaws and rows of teeth, but not one tooth from the next", where,
                              "use labels of single teeth, as ToothFairy's or TotalSegmentator's task \"teeth\" has "
                              "them, or segment one tooth of the scan itself")
                .as("labels-no-single-teeth");
        key.isMouth = teeth > 0;
        if (teeth > 0)
            key.notes.emplace_back("which label is which tooth was read from their names in the file");
        else if (isByName) {
            key.notes.emplace_back("which label is which tissue was read from their names in the file");
            // Around one tooth the jaws are bone.
            for (LabelMeaning& m : key.of)
                if (m.what == What::lowerBone || m.what == What::upperBone || m.what == What::gum)
                    m.what = What::tissue;
        } else {
            key.of = {};
        }
    }
    if (!isByName) {
        const std::optional<LabelNumbers> numbers = asked ? asked : numbersOf(present);
        if (!numbers) throw ambiguous(where);
        byNumbers(*numbers);
        if (!asked && numbers == LabelNumbers::consecutive)
            key.notes.emplace_back(
                "the labels count through (19, 20, 29 and 30 are among them, which are no FDI numbers): they were read "
                "as TotalSegmentator's of teeth, 11 to 42");
    }
    if (!key.isMouth) return key;
    if (!hasTeeth(key, present))
        throw core::Error("none of its labels is a tooth by these numbers", where, "say which numbers they are")
            .as("labels-empty");
    std::map<int, std::vector<int>> labelsOf;
    for (int n = 1; n < 256; ++n)
        if (const LabelMeaning& m = key.of[static_cast<std::size_t>(n)]; present.has(n) && m.what == What::tooth)
            labelsOf[m.number].push_back(n);
    for (const auto& [fdi, numbers] : labelsOf)
        if (numbers.size() > 1)
            key.notes.push_back(fmt::format("the labels {} are all called tooth {}: they are taken for one tooth",
                                            fmt::join(numbers, ", "), fdi));
    std::vector<int> unknown;
    for (int n = 1; n < 256; ++n)
        if (present.has(n) && key.of[static_cast<std::size_t>(n)].what == What::unknown) unknown.push_back(n);
    if (!unknown.empty())
        key.notes.push_back(fmt::format("what the {} {} {} is not known: left out",
                                        unknown.size() == 1 ? "label" : "labels", fmt::join(unknown, ", "),
                                        unknown.size() == 1 ? "means" : "mean"));
    return key;
}

namespace {

/// How often each number is there, where few and most are 0: grey values have no such gaps. `odd`: those that are no
/// whole ones from 0 to 255; none where they are an eighth of what is not 0.
std::optional<std::array<std::size_t, 256>> fewNumbers(const volume::Volume& volume, std::size_t& odd) {
    constexpr int kMostNumbers = 100;
    std::array<std::size_t, 256> counts{};
    int numbers = 0;
    odd = 0;
    for (const float v : volume.values) {
        if (!(v >= 0.0f && v <= 255.0f && v == std::floor(v))) {
            if (++odd > volume.values.size() / 8) return std::nullopt;
            continue;
        }
        if (counts[static_cast<std::size_t>(v)]++ == 0 && ++numbers > kMostNumbers) return std::nullopt;
    }
    if (counts[0] < volume.values.size() / 3 || odd > (volume.values.size() - counts[0]) / 8) return std::nullopt;
    return counts;
}

}  // namespace

int unsaidLabels(const volume::Volume& volume, const std::vector<volume::LabelName>& names) {
    // Fewer may be a scan of two or three grey values, a mask for instance; numbers of teeth end at 85, but for one
    // that somebody wrote wrongly.
    constexpr int kFewest = 6, kHighest = 85;
    std::size_t odd = 0;
    const auto counts = fewNumbers(volume, odd);
    if (!counts) return 0;
    int numbers = 0, teeth = 0;
    bool isBeyond = odd > 0;
    for (int n = 1; n < 256; ++n) {
        if ((*counts)[static_cast<std::size_t>(n)] == 0) continue;
        ++numbers;
        teeth += isFdi(n) ? 1 : 0;
        isBeyond = isBeyond || n > kHighest;
    }
    const int others = numbers - teeth + (odd > 0 ? 1 : 0);
    if (isBeyond && (teeth < kFewest || 4 * others > teeth)) return 0;
    return numbers >= (names.empty() ? kFewest : 1) ? numbers : 0;
}

bool looksLikeMouth(const volume::Volume& volume, const std::vector<volume::LabelName>& names) {
    std::size_t unclear = 0;
    const auto few = fewNumbers(volume, unclear);
    if (!few || unclear > 0) return false;
    const std::array<std::size_t, 256>& counts = *few;
    bool isGroup = false;
    const auto isNamed = [&](int n) {
        return std::any_of(names.begin(), names.end(), [&](const volume::LabelName& name) {
            return name.value == n && byName(name.name, isGroup).what == What::tooth;
        });
    };
    int teeth = 0, odd = 0, named = 0;
    for (int n = 1; n < 256; ++n) {
        if (counts[static_cast<std::size_t>(n)] == 0) continue;
        named += isNamed(n) ? 1 : 0;
        const LabelMeaning meaning = meaningOf(n, LabelNumbers::fdi);
        teeth += meaning.what == What::tooth ? 1 : 0;
        odd += meaning.what == What::unknown ? 1 : 0;
    }
    return named > 0 || (teeth >= 2 && odd == 0);
}

std::vector<LabelledTooth> teethOf(const volume::Labels& labels, const LabelKey& key) {
    const volume::Grid& grid = labels.grid;
    // By slices side by side, summed in their order.
    struct Found {
        std::array<int, 3> low{1 << 30, 1 << 30, 1 << 30}, high{-1, -1, -1};
        std::size_t voxels = 0;
        bool hasPulp = false;
    };
    constexpr std::size_t kTeeth = 86;
    std::vector<std::array<Found, kTeeth>> slices(static_cast<std::size_t>(grid.size[2]));
    core::parallelFor(slices.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t slice = from; slice < to; ++slice) {
            const int k = static_cast<int>(slice);
            for (int j = 0; j < grid.size[1]; ++j)
                for (int i = 0; i < grid.size[0]; ++i) {
                    const LabelMeaning meaning = key.of[labels.values[grid.index(i, j, k)]];
                    if (meaning.what != What::tooth && meaning.what != What::pulp) continue;
                    Found& found = slices[slice][static_cast<std::size_t>(meaning.number)];
                    found.low = {std::min(found.low[0], i), std::min(found.low[1], j), k};
                    found.high = {std::max(found.high[0], i), std::max(found.high[1], j), k};
                    ++found.voxels;
                    found.hasPulp = found.hasPulp || meaning.what == What::pulp;
                }
        }
    });
    std::vector<LabelledTooth> teeth;
    for (std::size_t fdi = 0; fdi < kTeeth; ++fdi) {
        LabelledTooth tooth;
        tooth.low = {1 << 30, 1 << 30, 1 << 30};
        tooth.high = {-1, -1, -1};
        for (const auto& slice : slices) {
            const Found& found = slice[fdi];
            if (found.voxels == 0) continue;
            for (std::size_t a = 0; a < 3; ++a) {
                tooth.low[a] = std::min(tooth.low[a], found.low[a]);
                tooth.high[a] = std::max(tooth.high[a], found.high[a]);
            }
            tooth.voxels += found.voxels;
            tooth.hasPulp = tooth.hasPulp || found.hasPulp;
        }
        if (tooth.voxels == 0) continue;
        tooth.fdi = static_cast<int>(fdi);
        tooth.volumeMm3 = static_cast<double>(tooth.voxels) * grid.voxelMm3();
        for (std::size_t a = 0; a < 3; ++a)
            tooth.isCutOff = tooth.isCutOff || tooth.low[a] == 0 || tooth.high[a] + 1 == grid.size[a];
        teeth.push_back(tooth);
    }
    return teeth;
}

}  // namespace handpiece::segmentation
