// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/bearings.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"

namespace handpiece::report {
namespace {

using config::words;

/// Nearer to the middle than this share of the way to its border, a place has no side.
constexpr double kMiddleShare = 0.3;
/// What lies along the path of draw says nothing of a side.
constexpr double kAlongDraw = 0.8;

bool isFront(int fdi) {
    return fdi % 10 >= 1 && fdi % 10 <= 3;
}
bool isUpper(int fdi) {
    const int quadrant = fdi / 10 % 4;
    return quadrant == 1 || quadrant == 2;
}

/// As that side is called on this tooth.
std::string wordIn(const char* room, const Bearings& of, std::string_view side) {
    if (side == "buccal" && isFront(of.fdi)) side = "labial";
    if (side == "lingual" && isUpper(of.fdi)) side = "palatal";
    if (side == "occlusal" && isFront(of.fdi)) side = "incisal";
    const std::string id = fmt::format("{}.{}", room, side);
    return words().has(id) ? words().text(id) : std::string();
}

}  // namespace

Bearings bearingsOf(const tasks::Task& task) {
    Bearings bearings;
    bearings.fdi = task.toothCase.fdiNumber;
    bearings.buccalSign = task.toothCase.buccalSign;
    for (const cases::Part& part : task.toothCase.parts)
        for (const core::Vec3& v : part.mesh.vertices)
            bearings.asked.extend(v);
    if (!task.preparation) return bearings;
    try {
        const preparation::Laid laid = preparation::layOn(task.toothCase, *task.preparation);
        bearings.asked = laid.zones->box();
        bearings.draw = laid.draw;
    } catch (const core::Error&) {  // whoever scores it says so
    }
    return bearings;
}

std::string_view sideOf(const Bearings& of, const core::Vec3& placeMm) {
    if (of.fdi == 0 || of.asked.isEmpty()) return {};
    const core::Vec3 off = placeMm - of.asked.centre(), half = 0.5 * of.asked.size();
    constexpr std::array<std::array<std::string_view, 2>, 3> kSides{
        {{"distal", "mesial"}, {"lingual", "buccal"}, {"gingival", "occlusal"}}};
    std::string_view side;
    double most = kMiddleShare;
    for (int k = 0; k < 3; ++k) {
        if (std::abs(of.draw[k]) > kAlongDraw || !(half[k] > 0.0)) continue;
        if (k == 1 && of.buccalSign == 0) continue;
        const double share = off[k] / half[k] * (k == 1 ? of.buccalSign : 1);
        if (std::abs(share) <= most) continue;
        most = std::abs(share);
        side = kSides[static_cast<std::size_t>(k)][share > 0.0 ? 1 : 0];
    }
    return side;
}

std::string sideWord(const Bearings& of, std::string_view side) {
    return wordIn("where", of, side);
}

std::string sideNoun(const Bearings& of, std::string_view side) {
    return wordIn("side", of, side);
}

std::string axisWord(const Bearings& of, std::string_view side) {
    for (const std::string& id :
         {fmt::format("along.{}{}", isFront(of.fdi) ? "front-" : "", side), fmt::format("along.{}", side)})
        if (words().has(id)) return words().text(id);
    return {};
}

}  // namespace handpiece::report
