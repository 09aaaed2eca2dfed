// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/haply_state.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

namespace handpiece::drivers {
namespace {

constexpr int kDeepest = 32;

/// Walks over a JSON text once, front to back. After anything that is no JSON everything fails.
class Scanner {
  public:
    explicit Scanner(std::string_view text) noexcept : at_(text.data()), end_(text.data() + text.size()) {}

    [[nodiscard]] bool good() const noexcept { return good_; }
    [[nodiscard]] bool atEnd() noexcept {
        blanks();
        return at_ == end_;
    }
    /// Calls member(key) with the scanner at the member's value, which it must read or skip.
    template <class Member>
    bool object(const Member& member) noexcept {
        if (!open('{')) return false;
        if (close('}')) return true;
        do {
            std::string_view key;
            if (!string(key) || !take(':')) return fail();
            member(key);
            if (!good_) return false;
        } while (take(','));
        return close('}') || fail();
    }
    template <class Element>
    bool array(const Element& element) noexcept {
        if (!open('[')) return false;
        if (close(']')) return true;
        do {
            element();
            if (!good_) return false;
        } while (take(','));
        return close(']') || fail();
    }
    /// Its bytes as they stand; ids of devices hold no escapes.
    bool string(std::string_view& text) noexcept {
        if (!take('"')) return fail();
        const char* const begin = at_;
        for (; at_ < end_; ++at_) {
            if (static_cast<unsigned char>(*at_) < 0x20) return fail();
            if (*at_ == '\\') {
                if (++at_ == end_) return fail();
            } else if (*at_ == '"') {
                text = {begin, static_cast<std::size_t>(at_ - begin)};
                ++at_;
                return true;
            }
        }
        return fail();
    }
    bool number(double& value) noexcept {
        blanks();
        double read = 0.0;
        const bool starts = at_ < end_ && (*at_ == '-' || (*at_ >= '0' && *at_ <= '9'));  // not "inf", not "nan"
        if (!starts) return fail();
        const auto [after, error] = std::from_chars(at_, end_, read);
        if (error != std::errc() || !std::isfinite(read)) return fail();
        at_ = after;
        value = read;
        return true;
    }
    bool boolean(Said& value) noexcept {
        if (word("true")) {
            value = Said::yes;
        } else if (word("false")) {
            value = Said::no;
        } else {
            return skip();  // null: nothing is said
        }
        return true;
    }
    [[nodiscard]] bool isNext(char c) noexcept {
        blanks();
        return at_ < end_ && *at_ == c;
    }
    bool skip() noexcept {
        std::string_view text;
        double value = 0.0;
        if (isNext('{')) return object([&](std::string_view) { skip(); });
        if (isNext('[')) return array([&] { skip(); });
        if (isNext('"')) return string(text);
        if (word("true") || word("false") || word("null")) return true;
        return number(value);
    }

  private:
    bool fail() noexcept {
        good_ = false;
        at_ = end_;
        return false;
    }
    void blanks() noexcept {
        while (at_ < end_ && (*at_ == ' ' || *at_ == '\n' || *at_ == '\t' || *at_ == '\r'))
            ++at_;
    }
    bool take(char c) noexcept {
        if (!isNext(c)) return false;
        ++at_;
        return true;
    }
    bool open(char c) noexcept { return take(c) && ++depth_ <= kDeepest ? true : fail(); }
    bool close(char c) noexcept {
        if (!take(c)) return false;
        --depth_;
        return true;
    }
    bool word(std::string_view w) noexcept {
        blanks();
        if (static_cast<std::size_t>(end_ - at_) < w.size() || std::memcmp(at_, w.data(), w.size()) != 0) return false;
        at_ += w.size();
        return true;
    }

    const char *at_, *end_;
    int depth_ = 0;
    bool good_ = true;
};

template <std::size_t n>
void keep(std::string_view text, std::array<char, n>& out) noexcept {
    out.fill('\0');
    std::copy_n(text.data(), std::min(text.size(), n - 1), out.data());
}

bool isText(Scanner& s, std::string_view& text) noexcept {
    return s.isNext('"') ? s.string(text) : (s.skip(), false);
}

/// {"x": .., "y": .., ..}: how many of the names were there.
template <std::size_t n>
std::size_t readNumbers(Scanner& s, const std::array<std::string_view, n>& names, std::array<double, n>& out) noexcept {
    std::size_t found = 0;
    if (!s.isNext('{')) return s.skip(), found;
    s.object([&](std::string_view key) {
        const auto at = std::find(names.begin(), names.end(), key);
        if (at == names.end() || s.isNext('n')) {  // null: nothing is said
            s.skip();
        } else if (s.number(out[static_cast<std::size_t>(at - names.begin())])) {
            ++found;
        }
    });
    return found;
}

constexpr std::array<std::string_view, 3> kXyz{"x", "y", "z"};
constexpr std::array<std::string_view, 4> kWxyz{"w", "x", "y", "z"};

void readScale(Scanner& s, HaplyArm& arm) noexcept {
    if (!s.isNext('{')) return void(s.skip());
    s.object([&](std::string_view key) {
        if (key != "scale") return void(s.skip());
        std::array<double, 3> scale{1, 1, 1};
        readNumbers(s, kXyz, scale);
        if (scale != std::array<double, 3>{1, 1, 1}) arm.scaled = true;
    });
}

void readArm(Scanner& s, HaplyArm& arm) noexcept {
    std::string_view text;
    s.object([&](std::string_view key) {
        if (key == "device_id") {
            if (isText(s, text)) keep(text, arm.id);
        } else if (key == "config" && s.isNext('{')) {
            s.object([&](std::string_view part) {
                if (part == "type") {
                    if (isText(s, text)) keep(text, arm.type);
                } else if (part == "extended_firmware_version") {
                    if (isText(s, text)) keep(text, arm.firmware);
                } else if (part == "mount") {
                    readScale(s, arm);
                } else if (part == "basis" && s.isNext('{')) {
                    s.object([&](std::string_view name) {
                        if (name != "permutation") return void(s.skip());
                        if (isText(s, text)) keep(text, arm.basis);
                    });
                } else {
                    s.skip();
                }
            });
        } else if (key == "state" && s.isNext('{')) {
            s.object([&](std::string_view part) {
                if (part == "cursor_position") {
                    arm.hasPosition = readNumbers(s, kXyz, arm.positionM) == 3;
                } else if (part == "transform") {
                    readScale(s, arm);
                } else {
                    s.skip();
                }
            });
        } else if (key == "status" && s.isNext('{')) {
            s.object([&](std::string_view part) {
                if (part == "calibrated") {
                    s.boolean(arm.calibrated);
                } else if (part == "in_use") {
                    s.boolean(arm.inUse);
                } else if (part == "power_supply") {
                    s.boolean(arm.powered);
                } else if (part == "ready") {
                    s.boolean(arm.ready);
                } else {
                    s.skip();
                }
            });
        } else {
            s.skip();
        }
    });
}

void readGrip(Scanner& s, HaplyGrip& grip) noexcept {
    std::string_view text;
    const auto bit = [&](unsigned which) {
        Said pressed = Said::nothing;
        s.boolean(pressed);
        if (pressed == Said::yes) grip.buttons |= 1u << which;
    };
    s.object([&](std::string_view key) {
        if (key == "device_id") {
            if (isText(s, text)) keep(text, grip.id);
        } else if (key == "state" && s.isNext('{')) {
            s.object([&](std::string_view part) {
                if (part == "orientation") {
                    grip.hasOrientation = readNumbers(s, kWxyz, grip.orientation) == 4;
                } else if (part == "button") {
                    bit(0);
                } else if (part == "buttons" && s.isNext('{')) {
                    s.object([&](std::string_view name) {
                        if (name == "a" || name == "b" || name == "c") {
                            bit(static_cast<unsigned>(name[0] - 'a'));
                        } else {
                            s.skip();
                        }
                    });
                } else {
                    s.skip();
                }
            });
        } else {
            s.skip();
        }
    });
}

template <class Device, class Read>
void readDevices(Scanner& s, std::array<Device, HaplyState::kMost>& devices, std::size_t& count,
                 const Read& read) noexcept {
    if (!s.isNext('[')) return void(s.skip());
    s.array([&] {
        if (!s.isNext('{') || count == devices.size()) return void(s.skip());
        devices[count] = {};
        read(devices[count]);
        if (devices[count].id[0] != '\0') ++count;
    });
}

}  // namespace

std::string_view textOf(const char* text, std::size_t most) noexcept {
    return {text, static_cast<std::size_t>(std::find(text, text + most, '\0') - text)};
}

const HaplyArm* HaplyState::arm(std::string_view id) const noexcept {
    for (std::size_t i = 0; i < armCount; ++i)
        if (textOf(arms[i].id) == id) return &arms[i];
    return nullptr;
}

const HaplyGrip* HaplyState::grip(std::string_view id) const noexcept {
    for (std::size_t i = 0; i < gripCount; ++i)
        if (textOf(grips[i].id) == id) return &grips[i];
    return nullptr;
}

bool readHaplyState(std::string_view json, HaplyState& state) noexcept {
    state.armCount = state.gripCount = 0;
    state.hasSession = false;
    Scanner s(json);
    s.object([&](std::string_view key) {
        if (key == "inverse3") {
            readDevices(s, state.arms, state.armCount, [&](HaplyArm& arm) { readArm(s, arm); });
        } else if (key == "verse_grip" || key == "wireless_verse_grip") {
            const bool wireless = key.size() > 10;
            readDevices(s, state.grips, state.gripCount, [&](HaplyGrip& grip) {
                grip.wireless = wireless;
                readGrip(s, grip);
            });
        } else {
            if (key == "session_id") state.hasSession = true;
            s.skip();
        }
    });
    return s.good() && s.atEnd();
}

std::size_t writeHaplyForce(std::string_view id, const std::array<double, 3>& forceN, bool newer, char* out,
                            std::size_t room) noexcept {
    char* at = out;
    char* const end = out + room;
    const auto text = [&](std::string_view piece) {
        if (at != nullptr && static_cast<std::size_t>(end - at) >= piece.size()) {
            std::memcpy(at, piece.data(), piece.size());
            at += piece.size();
        } else {
            at = nullptr;
        }
    };
    const auto number = [&](double value) {
        if (at == nullptr) return;
        const auto [after, error] = std::to_chars(at, end, value, std::chars_format::fixed, 6);
        at = error == std::errc() && std::abs(value) < 1e6 ? after : nullptr;
    };
    text(R"({"inverse3":[{"device_id":")");
    text(id);
    text(R"(","commands":{"set_cursor_force":{")");
    text(newer ? "vector" : "values");
    for (std::size_t i = 0; i < 3; ++i) {
        text(i == 0 ? R"(":{"x":)" : i == 1 ? R"(,"y":)" : R"(,"z":)");
        number(forceN[i]);
    }
    text("}}}}]}");
    return at != nullptr ? static_cast<std::size_t>(at - out) : 0;
}

}  // namespace handpiece::drivers
