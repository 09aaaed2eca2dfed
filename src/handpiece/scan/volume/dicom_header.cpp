// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/volume/dicom_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/scan/volume/header_text.h"

namespace handpiece::volume {
namespace {

constexpr std::uint32_t kUndefined = 0xffffffffu;
constexpr int kDeepest = 16;
constexpr std::size_t kMaxFragments = 1u << 20, kLongestValue = 4096;
constexpr int kMaxFrames = 100000;

constexpr std::uint32_t tag(std::uint32_t group, std::uint32_t element) {
    return group << 16 | element;
}
constexpr std::uint32_t kItem = tag(0xfffe, 0xe000), kItemEnd = tag(0xfffe, 0xe00d), kSequenceEnd = tag(0xfffe, 0xe0dd);
constexpr std::uint32_t kPixels = tag(0x7fe0, 0x0010);

/// Walks the elements, takes those that a scan needs and passes over all others without reading their values.
class Walker {
  public:
    Walker(Input& input, DicomHeader& header) : input_(input), header_(header) {}

    void walk() {
        std::array<char, 4> magic{};
        std::uint64_t at = 0;
        if (input_.readAt(128, magic.data(), 4) == 4 && std::string_view(magic.data(), 4) == "DICM") at = 132;
        at = metaGroup(at);
        const std::string& syntax = header_.transferSyntax;
        if (syntax == "1.2.840.10008.1.2.1.99")
            throw wrong("its header is packed (deflated), which is not read",
                        "convert it with \"gdcmconv --raw IN OUT\"");
        header_.isBigEndian = syntax == "1.2.840.10008.1.2.2";
        header_.isExplicit = syntax != "1.2.840.10008.1.2";
        if (syntax.empty()) {
            // No meta group: the kind of the first element tells.
            std::array<std::uint8_t, 6> head{};
            (void)input_.readAt(at, head.data(), head.size());
            header_.isExplicit = isVr(head[4], head[5]);
            header_.transferSyntax = header_.isExplicit ? "1.2.840.10008.1.2.1" : "1.2.840.10008.1.2";
        }
        items(at, input_.size(), 0, Context::top);
    }

  private:
    enum class Context { top, shared, perFrame, other };
    struct Element {
        std::uint32_t tag = 0, length = 0;
        std::array<char, 2> vr{};
        std::uint64_t value = 0;
    };

    [[nodiscard]] core::Error wrong(const std::string& what, const std::string& remedy) const {
        return core::Error(what, input_.where(), remedy);
    }
    [[nodiscard]] core::Error ends() const {
        return wrong("this DICOM file ends in its header", "copy or export it again");
    }
    static bool isVr(int a, int b) { return a >= 'A' && a <= 'Z' && b >= 'A' && b <= 'Z'; }

    template <int Bytes>
    std::uint32_t number(std::uint64_t at, bool isBig) {
        std::array<std::uint8_t, 4> b{};
        if (input_.readAt(at, b.data(), Bytes) != Bytes) throw ends();
        std::uint32_t v = 0;
        for (int i = 0; i < Bytes; ++i)
            v |= static_cast<std::uint32_t>(b[static_cast<std::size_t>(isBig ? Bytes - 1 - i : i)]) << 8 * i;
        return v;
    }

    Element element(std::uint64_t at, bool isExplicit, bool isBig) {
        Element e;
        e.tag = tag(number<2>(at, isBig), number<2>(at + 2, isBig));
        if (!isExplicit || e.tag >> 16 == 0xfffe) {
            e.length = number<4>(at + 4, isBig);
            e.value = at + 8;
            return e;
        }
        const std::uint32_t vr = number<2>(at + 4, false);
        e.vr = {static_cast<char>(vr & 0xff), static_cast<char>(vr >> 8)};
        if (!isVr(e.vr[0], e.vr[1]))
            throw wrong("its transfer syntax does not fit what is in it", "export it again from where it was made");
        const std::string_view name(e.vr.data(), 2);
        bool isLong = false;
        for (const char* known : {"OB", "OD", "OF", "OL", "OV", "OW", "SQ", "SV", "UC", "UN", "UR", "UT", "UV"})
            isLong = isLong || name == known;
        e.length = isLong ? number<4>(at + 8, isBig) : number<2>(at + 6, isBig);
        e.value = at + (isLong ? 12 : 8);
        return e;
    }

    std::string text(const Element& e) {
        std::string out(std::min<std::size_t>(e.length, kLongestValue), '\0');
        out.resize(input_.readAt(e.value, out.data(), out.size()));
        return std::string(trimmed(out));
    }
    template <std::size_t N>
    std::optional<std::array<double, N>> decimals(const Element& e) {
        const std::string all = text(e);
        std::string_view rest = all;
        std::array<double, N> out{};
        for (std::size_t i = 0; i < N; ++i) {
            const std::size_t stop = std::min(rest.find('\\'), rest.size());
            const auto v = numberOf(rest.substr(0, stop));
            if (!v || !std::isfinite(*v)) return {};
            out[i] = *v;
            rest.remove_prefix(std::min(stop + 1, rest.size()));
        }
        return out;
    }
    /// However many; none where one of them is no number.
    std::vector<double> allDecimals(const Element& e) {
        std::string all(std::min<std::size_t>(e.length, 1u << 20), '\0');
        all.resize(input_.readAt(e.value, all.data(), all.size()));
        std::vector<double> out;
        for (std::string_view rest = trimmed(all); !rest.empty() && out.size() < kMaxFrames;) {
            const std::size_t stop = std::min(rest.find('\\'), rest.size());
            const auto v = numberOf(trimmed(rest.substr(0, stop)));
            if (!v || !std::isfinite(*v)) return {};
            out.push_back(*v);
            rest.remove_prefix(std::min(stop + 1, rest.size()));
        }
        return out;
    }
    std::optional<double> decimal(const Element& e) {
        const auto one = decimals<1>(e);
        return one ? std::optional((*one)[0]) : std::nullopt;
    }
    int shortOf(const Element& e) {
        return e.length >= 2 ? static_cast<int>(number<2>(e.value, header_.isBigEndian)) : 0;
    }

    std::uint64_t metaGroup(std::uint64_t at) {
        while (at + 8 <= input_.size() && number<2>(at, false) == 2) {
            const Element e = element(at, true, false);
            if (e.tag == tag(2, 0x10)) header_.transferSyntax = text(e);
            if (e.length == kUndefined || e.value + e.length > input_.size()) throw ends();
            at = e.value + e.length;
        }
        return at;
    }

    /// Elements until `end` or the item's end; returns where it stopped.
    std::uint64_t items(std::uint64_t at, std::uint64_t end, int depth, Context context) {
        if (depth > kDeepest) throw wrong("its header is nested too deep", "copy or export it again");
        while (at + 8 <= end && !isDone_) {
            const Element e = element(at, header_.isExplicit, header_.isBigEndian);
            if (e.tag == kItemEnd || e.tag == kSequenceEnd) return e.value;
            if (e.tag == kPixels && context == Context::top) {
                pixels(e);
                isDone_ = true;
                return end;
            }
            // Of undefined length and no sequence: packed pixels, an icon's for instance, whose bytes are no elements.
            const bool isPacked =
                e.length == kUndefined && (e.tag == kPixels || (header_.isExplicit && e.vr != kSq && e.vr != kUn));
            if (isPacked) {
                at = pastFragments(e);
                continue;
            }
            const bool isSequence = e.vr == kSq || e.length == kUndefined || isKnownSequence(e.tag);
            if (isSequence) {
                const bool wasExplicit = header_.isExplicit;
                if (e.vr == kUn) header_.isExplicit = false;  // an unknown sequence is implicit inside
                const bool isWanted = isKnownSequence(e.tag);
                if (e.length != kUndefined && e.value + e.length > input_.size()) throw ends();
                if (!isWanted && e.length != kUndefined) {
                    at = e.value + e.length;
                } else {
                    Context inner = context == Context::top ? Context::other : context;
                    if (e.tag == tag(0x5200, 0x9229)) inner = Context::shared;
                    if (e.tag == tag(0x5200, 0x9230)) inner = Context::perFrame;
                    if (e.tag == tag(0x0004, 0x1220)) inner = Context::shared;
                    if (!isWanted) inner = Context::other;
                    at = sequence(e, depth + 1, inner);
                }
                header_.isExplicit = wasExplicit;
                continue;
            }
            const std::uint64_t next = e.value + e.length;
            if (next > input_.size()) throw ends();
            if (context == Context::top) topElement(e);
            if (context == Context::shared) placeElement(e, header_.place);
            if (context == Context::perFrame && !header_.frame.empty()) placeElement(e, header_.frame.back());
            if (e.tag == tag(0x0004, 0x1500) && context == Context::shared && header_.files.size() < kMaxFragments)
                header_.files.push_back(text(e));
            at = next;
        }
        return at;
    }

    static constexpr std::array<char, 2> kSq{'S', 'Q'}, kUn{'U', 'N'};

    std::uint64_t pastFragments(const Element& e) {
        for (std::uint64_t at = e.value; at + 8 <= input_.size();) {
            const Element item = element(at, header_.isExplicit, header_.isBigEndian);
            if (item.tag == kSequenceEnd) return item.value;
            if (item.tag != kItem || item.length == kUndefined)
                throw wrong("packed pixel data in its header is damaged", "copy or export it again");
            at = item.value + item.length;
        }
        throw ends();
    }

    static bool isKnownSequence(std::uint32_t t) {
        return t == tag(0x5200, 0x9229) || t == tag(0x5200, 0x9230) || t == tag(0x0020, 0x9113) ||
               t == tag(0x0020, 0x9116) || t == tag(0x0028, 0x9110) || t == tag(0x0028, 0x9145) ||
               t == tag(0x0004, 0x1220);
    }

    std::uint64_t sequence(const Element& s, int depth, Context context) {
        std::uint64_t at = s.value;
        const std::uint64_t end = s.length == kUndefined ? input_.size() : s.value + s.length;
        while (at + 8 <= end) {
            const Element item = element(at, header_.isExplicit, header_.isBigEndian);
            if (item.tag == kSequenceEnd) return item.value;
            if (item.tag != kItem) throw wrong("a sequence of its header is damaged", "copy or export it again");
            if (s.tag == tag(0x5200, 0x9230)) {
                if (header_.frame.size() >= kMaxFrames)
                    throw wrong("it claims too many frames", "copy or export it again");
                header_.frame.emplace_back();
            }
            if (item.length == kUndefined) {
                at = items(item.value, end, depth, context);
            } else {
                if (item.value + item.length > end) throw ends();
                (void)items(item.value, item.value + item.length, depth, context);
                at = item.value + item.length;
            }
        }
        if (s.length == kUndefined) throw ends();
        return end;
    }

    void topElement(const Element& e) {
        switch (e.tag) {
            case tag(0x0008, 0x0008):
                header_.isOverview = text(e).find("LOCALIZER") != std::string::npos;
                break;
            case tag(0x0008, 0x0016):
                header_.isSecondaryCapture = text(e).rfind("1.2.840.10008.5.1.4.1.1.7", 0) == 0;
                break;
            case tag(0x0008, 0x0060):
                header_.modality = shown(text(e)).substr(0, 16);
                break;
            case tag(0x0020, 0x000e): {
                core::Hasher hasher;
                hasher.add(text(e));
                header_.seriesKey = hasher.value();
                break;
            }
            case tag(0x0020, 0x0013):
                if (const auto v = decimal(e); v && std::abs(*v) < 1e9) header_.instance = static_cast<int>(*v);
                break;
            case tag(0x0028, 0x0002):
                header_.samplesPerPixel = shortOf(e);
                break;
            case tag(0x0028, 0x0004):
                header_.photometric = shown(text(e)).substr(0, 16);
                break;
            case tag(0x0028, 0x0008):
                if (const auto v = decimal(e))
                    header_.frames = *v >= 1.0 && *v <= kMaxFrames ? static_cast<int>(*v) : 0;
                break;
            case tag(0x0028, 0x0010):
                header_.rows = shortOf(e);
                break;
            case tag(0x0028, 0x0011):
                header_.columns = shortOf(e);
                break;
            case tag(0x0028, 0x0100):
                header_.allocated = shortOf(e);
                break;
            case tag(0x0028, 0x0101):
                header_.stored = shortOf(e);
                break;
            case tag(0x0028, 0x0102):
                header_.high = shortOf(e);
                break;
            case tag(0x0028, 0x0103):
                header_.isSigned = shortOf(e) == 1;
                break;
            case tag(0x0028, 0x0301):
                header_.hasBurnedInText = text(e) == "YES";
                break;
            case tag(0x0028, 0x2110):
                header_.isLossy = text(e) == "01";
                break;
            case tag(0x3004, 0x000c):
                header_.gridOffsetsMm = allDecimals(e);
                break;
            case tag(0x7fe0, 0x0008):
            case tag(0x7fe0, 0x0009):
                header_.isFloat = true;
                break;
            default:
                placeElement(e, header_.place);
        }
    }

    void placeElement(const Element& e, DicomPlace& place) {
        switch (e.tag) {
            case tag(0x0018, 0x0050):
                place.thicknessMm = decimal(e);
                break;
            case tag(0x0018, 0x0088):
                place.betweenMm = decimal(e);
                break;
            case tag(0x0020, 0x0032):
                place.positionMm = decimals<3>(e);
                break;
            case tag(0x0020, 0x0037):
                place.orientation = decimals<6>(e);
                break;
            case tag(0x0020, 0x1041):
                place.locationMm = decimal(e);
                break;
            case tag(0x0028, 0x0030):
                place.spacingMm = decimals<2>(e);
                break;
            case tag(0x0028, 0x1052):
                place.intercept = decimal(e);
                break;
            case tag(0x0028, 0x1053):
                place.slope = decimal(e);
                break;
            default:
                break;
        }
    }

    void pixels(const Element& e) {
        header_.hasPixels = true;
        header_.pixelAt = e.value;
        header_.isEncapsulated = e.length == kUndefined;
        if (!header_.isEncapsulated) {
            header_.pixelBytes = std::min<std::uint64_t>(e.length, input_.size() - std::min(e.value, input_.size()));
            return;
        }
        std::uint64_t at = e.value;
        for (bool isFirst = true; at + 8 <= input_.size(); isFirst = false) {
            const std::uint32_t itemTag = tag(number<2>(at, false), number<2>(at + 2, false)),
                                length = number<4>(at + 4, false);
            if (itemTag == kSequenceEnd) return;
            if (itemTag != kItem || length == kUndefined)
                throw wrong("its packed pixel data is damaged", "copy or export it again");
            at += 8;
            const std::uint64_t has = std::min<std::uint64_t>(length, input_.size() - std::min(at, input_.size()));
            if (isFirst) {
                for (std::uint64_t i = 0; i + 4 <= has && i / 4 < kMaxFragments; i += 4)
                    header_.frameOffsets.push_back(number<4>(at + i, false));
            } else {
                if (header_.fragments.size() >= kMaxFragments)
                    throw wrong("its packed pixel data is damaged", "copy or export it again");
                header_.fragments.push_back({at, length});
            }
            at += length;
        }
    }

    Input& input_;
    DicomHeader& header_;
    bool isDone_ = false;
};

}  // namespace

DicomHeader::FrameStep DicomHeader::frameStep() const {
    const bool hasOwn = std::any_of(frame.begin(), frame.end(), [](const DicomPlace& one) { return one.positionMm; });
    if (frames < 2 || hasOwn || !place.positionMm || !place.orientation) return {};
    if (gridOffsetsMm.size() == static_cast<std::size_t>(frames)) return {"GridFrameOffsetVector"};
    // Few programs write a sign; a minus was meant.
    if (const double mm = place.betweenMm.value_or(0.0); mm != 0.0) return {"SpacingBetweenSlices", mm, mm < 0.0};
    if (const double mm = place.thicknessMm.value_or(0.0); mm != 0.0) return {"SliceThickness", mm, false};
    return {};
}

DicomPlace DicomHeader::placeOf(int index) const {
    DicomPlace all = place;
    if (const FrameStep step = frameStep(); step.by != nullptr && index > 0 && index < frames) {
        const double alongMm =
            step.mm != 0.0 ? index * step.mm : gridOffsetsMm[static_cast<std::size_t>(index)] - gridOffsetsMm[0];
        const std::array<double, 6>& o = *place.orientation;
        // Along a row by down a column.
        const std::array<double, 3> normal{o[1] * o[5] - o[2] * o[4], o[2] * o[3] - o[0] * o[5],
                                           o[0] * o[4] - o[1] * o[3]};
        for (std::size_t k = 0; k < 3; ++k)
            (*all.positionMm)[k] += alongMm * normal[k];
    }
    if (index < 0 || static_cast<std::size_t>(index) >= frame.size()) return all;
    const DicomPlace& own = frame[static_cast<std::size_t>(index)];
    if (own.positionMm) all.positionMm = own.positionMm;
    if (own.orientation) all.orientation = own.orientation;
    if (own.spacingMm) all.spacingMm = own.spacingMm;
    if (own.thicknessMm) all.thicknessMm = own.thicknessMm;
    if (own.betweenMm) all.betweenMm = own.betweenMm;
    if (own.locationMm) all.locationMm = own.locationMm;
    if (own.slope) all.slope = own.slope;
    if (own.intercept) all.intercept = own.intercept;
    return all;
}

DicomHeader readDicomHeader(Input& input) {
    DicomHeader header;
    Walker(input, header).walk();
    if (header.high < 0) header.high = header.stored - 1;
    return header;
}

}  // namespace handpiece::volume
