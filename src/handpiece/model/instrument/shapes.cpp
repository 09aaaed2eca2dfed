// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/shapes.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/instrument/catalogue.h"

namespace handpiece::instrument {

using core::Vec2;

namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
// Proportions of the heads [R]: ISO 6360 gives diameter and length, makers choose these. docs/burs.md lists them.
constexpr double kInvertedConeHalfAngleRad = 12.0 * kRadPerDeg;
constexpr double kTaperHalfAngleRad = 3.0 * kRadPerDeg;
constexpr double kMinEndRadius = 0.2;       // thinner end of a taper or inverted cone, of the radius
constexpr double kPearTopRadius = 0.7;      // of the radius
constexpr double kFlameTopRadius = 0.6;     // of the radius
constexpr double kFlameBellyHeight = 0.6;   // of the length
constexpr double kNoseRadius = 0.15;        // flame and torpedo, of the radius
constexpr double kTorpedoNoseLength = 1.0;  // of the diameter
constexpr double kMinMm = 0.1, kLargestDiameterMm = 20.0, kLargestLengthMm = 40.0;

ProfilePiece line(const Vec2& from, const Vec2& to) {
    return {from, to, false, Vec2::Zero(), 0.0, true};
}
ProfilePiece arc(const Vec2& from, const Vec2& to, const Vec2& centre, double radiusMm) {
    return {from, to, true, centre, radiusMm, true};
}

/// A polygon from the axis through `corners` and back to the axis at the height of the last corner.
Profile polygon(std::initializer_list<Vec2> corners) {
    Profile profile;
    Vec2 last(0.0, 0.0);
    for (const Vec2& corner : corners) {
        profile.pieces.push_back(line(last, corner));
        last = corner;
    }
    profile.pieces.push_back(line(last, {0.0, last.y()}));
    return profile;
}

void needLength(const char* what, double diameterMm, double lengthMm, double least, double most) {
    // Heads of catalogue size are written with a digit or two: a micrometre beyond the range is rounding.
    if (lengthMm >= least - 1e-9 && lengthMm <= most + 1e-9) return;
    throw core::Error(fmt::format("a {} of diameter {} mm cannot be {} mm long", what, diameterMm, lengthMm),
                      fmt::format("{}x{}", diameterMm, lengthMm),
                      fmt::format("its length can be {:.4g} to {:.4g} mm", least, most));
}

Profile round(double d, double length) {
    needLength("round", d, length, 0.5 * d, d);
    const double r = 0.5 * d;
    if (length >= d - 1e-9) return {{arc({0, 0}, {0, d}, {0, r}, r)}};
    const double neck = std::sqrt(std::max(0.0, r * r - (length - r) * (length - r)));
    return {{arc({0, 0}, {neck, length}, {0, r}, r), line({neck, length}, {0, length})}};
}

Profile invertedCone(double d, double length) {
    const double r = 0.5 * d, slope = core::tan(kInvertedConeHalfAngleRad);
    needLength("inverted-cone", d, length, kMinMm, r * (1.0 - kMinEndRadius) / slope);
    return polygon({{r, 0}, {r - length * slope, length}});
}

Profile cylinderFlat(double d, double length) {
    needLength("cylinder-flat", d, length, kMinMm, kLargestLengthMm);
    return polygon({{0.5 * d, 0}, {0.5 * d, length}});
}

Profile wheel(double d, double length) {
    needLength("wheel", d, length, kMinMm, 0.75 * d);
    return polygon({{0.5 * d, 0}, {0.5 * d, length}});
}

Profile cylinderRound(double d, double length) {
    const double r = 0.5 * d;
    needLength("cylinder-round", d, length, r + 0.01, kLargestLengthMm);
    return {{arc({0, 0}, {r, r}, {0, r}, r), line({r, r}, {r, length}), line({r, length}, {0, length})}};
}

Profile taperFlat(double d, double length) {
    const double r = 0.5 * d, slope = core::tan(kTaperHalfAngleRad);
    needLength("taper-flat", d, length, kMinMm, r * (1.0 - kMinEndRadius) / slope);
    return polygon({{r - length * slope, 0}, {r, length}});
}

Profile taperRound(double d, double length) {
    const double r = 0.5 * d, c = core::cos(kTaperHalfAngleRad), s = core::sin(kTaperHalfAngleRad);
    // Tip ball of radius t tangent to the wall that reaches r at the top: t (1 - s) = r c - length s.
    const double tip = (r * c - length * s) / (1.0 - s);
    needLength("taper-round", d, length, r + 0.01, (r * c - kMinEndRadius * r * (1.0 - s)) / s);
    const Vec2 joint(tip * c, tip * (1.0 - s));
    return {{arc({0, 0}, joint, {0, tip}, tip), line(joint, {r, length}), line({r, length}, {0, length})}};
}

Profile pear(double d, double length) {
    needLength("pear", d, length, d, 8.0 * d);
    // A ball at the tip and a tangent cone that narrows by b to kPearTopRadius: h sin b + q cos b = r.
    const double r = 0.5 * d, h = length - r, q = kPearTopRadius * r;
    const double b = core::atan2(h, q) - core::acos(r / core::hypot(h, q));
    const Vec2 joint(r * core::cos(b), r + r * core::sin(b));
    return {{arc({0, 0}, joint, {0, r}, r), line(joint, {q, length}), line({q, length}, {0, length})}};
}

/// A nose ball and an ogive that reaches radius r, upright, at height `belly`.
std::vector<ProfilePiece> ogive(double r, double belly) {
    const double nose = kNoseRadius * r, h = belly - nose;
    const double big = (r * r + h * h - nose * nose) / (2.0 * (r - nose));
    const Vec2 centre(r - big, belly), tip(0, nose);
    const Vec2 joint = tip + nose * (tip - centre).normalized();
    return {arc({0, 0}, joint, tip, nose), arc(joint, {r, belly}, centre, big)};
}

Profile flame(double d, double length) {
    needLength("flame", d, length, 1.5 * d, 20.0 * d);
    const double r = 0.5 * d, belly = kFlameBellyHeight * length, top = kFlameTopRadius * r, h = length - belly;
    const double big = ((r - top) * (r - top) + h * h) / (2.0 * (r - top));
    Profile profile{ogive(r, belly)};
    profile.pieces.push_back(arc({r, belly}, {top, length}, {r - big, belly}, big));
    profile.pieces.push_back(line({top, length}, {0, length}));
    return profile;
}

Profile torpedo(double d, double length) {
    const double r = 0.5 * d, noseLength = kTorpedoNoseLength * d;
    needLength("torpedo", d, length, noseLength + 0.1, kLargestLengthMm);
    Profile profile{ogive(r, noseLength)};
    profile.pieces.push_back(line({r, noseLength}, {r, length}));
    profile.pieces.push_back(line({r, length}, {0, length}));
    return profile;
}

constexpr double kPaperDiameterMm = 1.0, kPaperLengthMm = 4.0;

Bur paperBur() {
    // 7 rings of 24 points and the two poles: the 170 vertices of Table I, every 15 degrees both ways on the round end.
    const Profile profile = makeProfile(Shape::cylinderRound, kPaperDiameterMm, kPaperLengthMm);
    const double quarter = 0.25 * std::numbers::pi * kPaperDiameterMm;
    return Bur("paper", profile, turnedMesh(profile, 24, quarter / 6.0));
}

std::optional<double> number(std::string_view text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return {};
    return value;
}

std::string listOfNames() {
    std::string list;
    for (const std::string& name : burNames())
        list += list.empty() ? name : ", " + name;
    return list;
}

}  // namespace

const std::vector<ShapeInfo>& shapes() {
    static const std::vector<ShapeInfo> all = {
        {Shape::round, "round", "001", "a ball; shorter than its diameter, cut flat where the neck begins"},
        {Shape::invertedCone, "inverted-cone", "010", "widest at its flat end, narrowing by 12 degrees a side"},
        {Shape::cylinderFlat, "cylinder-flat", "107", "a cylinder with a flat end and a sharp rim"},
        {Shape::cylinderRound, "cylinder-round", "137", "a cylinder with a half ball at its end"},
        {Shape::taperFlat, "taper-flat", "168", "narrowing towards its flat end by 3 degrees a side"},
        {Shape::taperRound, "taper-round", "194", "narrowing towards its round end by 3 degrees a side"},
        {Shape::pear, "pear", "237", "a ball at the end, narrowing straight towards the shank"},
        {Shape::flame, "flame", "243", "slender, bellied, with a small round point"},
        {Shape::torpedo, "torpedo", "288", "a cylinder with a long pointed end"},
        {Shape::wheel, "wheel", "041", "a flat disc with sharp rims"},
    };
    return all;
}

Shape shapeByName(std::string_view name) {
    std::string list;
    for (const ShapeInfo& info : shapes()) {
        if (info.name == name) return info.shape;
        list += (list.empty() ? "" : ", ") + std::string(info.name);
    }
    throw core::Error("there is no bur of this shape", std::string(name), "choose one of " + list);
}

Profile makeProfile(Shape shape, double diameterMm, double lengthMm) {
    if (!(diameterMm >= kMinMm && diameterMm <= kLargestDiameterMm))
        throw core::Error("no bur has this diameter", fmt::format("{} mm", diameterMm),
                          fmt::format("choose {} to {} mm", kMinMm, kLargestDiameterMm));
    if (!(lengthMm >= 0.05 && lengthMm <= kLargestLengthMm))
        throw core::Error("no bur has a head of this length", fmt::format("{} mm", lengthMm),
                          fmt::format("choose {} to {} mm", kMinMm, kLargestLengthMm));
    switch (shape) {
        case Shape::round:
            return round(diameterMm, lengthMm);
        case Shape::invertedCone:
            return invertedCone(diameterMm, lengthMm);
        case Shape::cylinderFlat:
            return cylinderFlat(diameterMm, lengthMm);
        case Shape::cylinderRound:
            return cylinderRound(diameterMm, lengthMm);
        case Shape::taperFlat:
            return taperFlat(diameterMm, lengthMm);
        case Shape::taperRound:
            return taperRound(diameterMm, lengthMm);
        case Shape::pear:
            return pear(diameterMm, lengthMm);
        case Shape::flame:
            return flame(diameterMm, lengthMm);
        case Shape::torpedo:
            return torpedo(diameterMm, lengthMm);
        case Shape::wheel:
            return wheel(diameterMm, lengthMm);
    }
    throw core::Error("this shape has no outline", std::to_string(static_cast<int>(shape)));
}

Bur makeBur(std::string_view name) {
    if (name == "paper") return paperBur();
    if (const CatalogueEntry* known = findBur(name))
        return Bur(known->name, makeProfile(known->shape, known->diameterMm, known->lengthMm));
    const std::size_t colon = name.find(':');
    if (colon == std::string_view::npos)
        throw core::Error("there is no bur of this name", std::string(name),
                          "choose " + listOfNames() + ", or SHAPE:DIAMETERxLENGTH such as cylinder-round:1.0x4.0")
            .as("bur-unknown", {std::string(name)});
    const Shape shape = shapeByName(name.substr(0, colon));
    const std::string_view size = name.substr(colon + 1);
    const std::size_t times = size.find('x');
    const std::optional<double> diameter = number(size.substr(0, times));
    const std::optional<double> length =
        times == std::string_view::npos ? std::nullopt : number(size.substr(times + 1));
    if (!diameter || !length)
        throw core::Error("the size of a bur is DIAMETERxLENGTH in mm", std::string(name),
                          "as in cylinder-round:1.0x4.0");
    return Bur(std::string(name), makeProfile(shape, *diameter, *length));
}

std::vector<std::string> burNames() {
    std::vector<std::string> names{"paper"};
    for (const CatalogueEntry& known : catalogue())
        names.push_back(known.name);
    return names;
}

}  // namespace handpiece::instrument
