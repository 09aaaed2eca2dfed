// SPDX-License-Identifier: Apache-2.0
// The landmarks of a tooth: read and written.
#include <fmt/format.h>

#include <algorithm>

#include "handpiece/base/core/error.h"
#include "handpiece/model/case/case_files.h"
#include "handpiece/model/case/toml_text.h"

namespace handpiece::cases {
namespace {

using config::Table;

constexpr std::size_t kMostPoints = 4096;  // of a line

template <class Names>
std::size_t indexOf(const Names& names, std::string_view name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

Landmark readLandmark(const Table& table) {
    table.allowOnly({"kind", "name", "points_mm", "source"});
    const std::string kind = table.text("kind").value_or("");
    const std::size_t k = indexOf(kLandmarkKinds, kind);
    if (k == kLandmarkKinds.size())
        table.fail(fmt::format("there is no landmark \"{}\"", kind),
                   fmt::format("one of {}", fmt::join(kLandmarkKinds, ", ")), "kind");
    const std::string source = table.text("source").value_or("set");
    const std::size_t s = indexOf(kLandmarkSources, source);
    if (s == kLandmarkSources.size())
        table.fail(fmt::format("a landmark's source is \"{}\"", source),
                   fmt::format("one of {}", fmt::join(kLandmarkSources, ", ")), "source");
    Landmark mark{static_cast<LandmarkKind>(k), table.text("name").value_or(""), {}, static_cast<LandmarkSource>(s)};
    const std::vector<double> numbers = table.numbers("points_mm");
    const LandmarkShape shape = shapeOf(mark.kind);
    if (numbers.size() % 3 != 0 || numbers.size() < 3 * shape.least || numbers.size() > 3 * shape.most)
        table.fail(fmt::format("{} numbers for the points of a {}", numbers.size(), kind),
                   shape.least == shape.most ? fmt::format("give {}, three a point", 3 * shape.least)
                                             : fmt::format("give {} at least, three a point", 3 * shape.least),
                   "points_mm");
    for (std::size_t i = 0; i < numbers.size(); i += 3) {
        const core::Vec3 p(numbers[i], numbers[i + 1], numbers[i + 2]);
        if (p.norm() > kFarthestLandmarkMm)
            table.fail(fmt::format("a {} lies {:.0f} mm off the tooth's origin", kind, p.norm()),
                       "landmarks are in the tooth's own frame, in millimetres", "points_mm");
        mark.pointsMm.push_back(p);
    }
    if (shape.most == 2 && shape.least == 2 && (mark.pointsMm[1] - mark.pointsMm[0]).norm() < 1e-3)
        table.fail(fmt::format("the {} has no direction", kind), "give two points that lie apart", "points_mm");
    return mark;
}

}  // namespace

LandmarkShape shapeOf(LandmarkKind kind) noexcept {
    switch (kind) {
        case LandmarkKind::fissure:
        case LandmarkKind::marginalRidge:
        case LandmarkKind::ridge:
            return {2, kMostPoints, false};
        case LandmarkKind::heightOfContour:
        case LandmarkKind::cementoEnamelJunction:
            return {3, kMostPoints, true};
        case LandmarkKind::longAxis:
        case LandmarkKind::pathOfInsertion:
            return {2, 2, false};
        default:
            return {1, 1, false};
    }
}

std::vector<Landmark> readLandmarks(const Table& tooth) {
    std::vector<Landmark> marks;
    for (const Table& entry : tooth.tables("landmark"))
        marks.push_back(readLandmark(entry));
    return marks;
}

std::string landmarksToml(const std::vector<Landmark>& marks, std::string_view key) {
    std::string out;
    for (const Landmark& mark : marks) {
        out += fmt::format("\n[[{}]]\nkind = \"{}\"\n", key, kLandmarkKinds[static_cast<std::size_t>(mark.kind)]);
        if (!mark.name.empty()) out += fmt::format("name = {}\n", tomlText(mark.name));
        out += fmt::format("source = \"{}\"\npoints_mm = [", kLandmarkSources[static_cast<std::size_t>(mark.source)]);
        for (std::size_t i = 0; i < mark.pointsMm.size(); ++i) {
            const core::Vec3& p = mark.pointsMm[i];
            out += fmt::format("{}{:.5f}, {:.5f}, {:.5f}", i == 0 ? "" : ",  ", p.x(), p.y(), p.z());
        }
        out += "]\n";
    }
    return out;
}

}  // namespace handpiece::cases
