// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/edit_landmarks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/case/case_files.h"

namespace handpiece::cases {
namespace {

namespace fs = std::filesystem;

/// case.toml with these landmarks for its own: their tables go, and come at the end.
std::string withLandmarks(const std::string& toml, const std::vector<Landmark>& marks) {
    std::string out;
    bool isMark = false;
    for (std::size_t from = 0; from < toml.size();) {
        const std::size_t end = std::min(toml.find('\n', from), toml.size() - 1) + 1;
        std::string line = toml.substr(from, end - from);
        from = end;
        std::string bare = line;
        std::erase_if(bare, [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; });
        if (bare.starts_with('[')) isMark = bare.starts_with("[[landmark]]");
        if (isMark) continue;
        // Landmarks came with the third.
        if (!marks.empty() && (bare.starts_with("format=1") || bare.starts_with("format=2"))) line = "format = 3\n";
        out += line;
    }
    if (!out.empty() && out.back() != '\n') out += '\n';
    return out + landmarksToml(marks, "landmark");
}

std::vector<std::byte> bytesOf(const std::string& text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

}  // namespace

bool liesOnSurface(LandmarkKind kind) noexcept {
    switch (kind) {
        case LandmarkKind::pulpHorn:
        case LandmarkKind::orifice:
        case LandmarkKind::longAxis:
        case LandmarkKind::pathOfInsertion:
            return false;
        default:
            return true;
    }
}

Landmark moved(const Landmark& mark, std::size_t which, const core::Vec3& toMm, const geometry::TriangleTree& surface) {
    Landmark made = mark;
    made.source = LandmarkSource::set;
    const std::size_t count = mark.pointsMm.size();
    if (which >= count) return made;
    const bool isOnSurface = liesOnSurface(mark.kind);
    const auto onSurface = [&](const core::Vec3& p) { return isOnSurface ? surface.nearest(p).pointMm : p; };
    const core::Vec3 by = toMm - mark.pointsMm[which];
    made.pointsMm[which] = onSurface(toMm);
    if (shapeOf(mark.kind).most <= 2) return made;
    const bool isRing = shapeOf(mark.kind).isRing;
    std::vector<double> share(count, 0.0);
    for (const bool forward : {true, false}) {
        double along = 0.0;
        for (std::size_t step = 1, at = which; step < count; ++step) {
            if (!isRing && at == (forward ? count - 1 : 0)) break;
            const std::size_t next = (at + (forward ? 1 : count - 1)) % count;
            along += (mark.pointsMm[next] - mark.pointsMm[at]).norm();
            if (along >= kLandmarkReachMm) break;
            share[next] = std::max(share[next], 0.5 * (1.0 + core::cos(std::numbers::pi * along / kLandmarkReachMm)));
            at = next;
        }
    }
    for (std::size_t i = 0; i < count; ++i)
        if (i != which && share[i] > 0.0) made.pointsMm[i] = onSurface(mark.pointsMm[i] + share[i] * by);
    return made;
}

Landmark drawn(LandmarkKind kind, const std::string& name, const std::vector<core::Vec3>& placesMm,
               const geometry::TriangleTree& surface) {
    const LandmarkShape shape = shapeOf(kind);
    Landmark made{kind, name, placesMm, LandmarkSource::set};
    if (made.pointsMm.size() > shape.most) made.pointsMm.resize(shape.most);
    if (shape.most == 2 && made.pointsMm.size() == 2 && made.pointsMm[0].z() > made.pointsMm[1].z())
        std::swap(made.pointsMm[0], made.pointsMm[1]);
    if (!liesOnSurface(kind)) return made;
    std::vector<core::Vec3> given = std::move(made.pointsMm);
    for (core::Vec3& p : given)
        p = surface.nearest(p).pointMm;
    const bool isClosed = shape.isRing && given.size() >= shape.least;
    const std::size_t legs = given.empty() ? 0 : isClosed ? given.size() : given.size() - 1;
    double length = 0.0;
    for (std::size_t i = 0; i < legs; ++i)
        length += (given[(i + 1) % given.size()] - given[i]).norm();
    const auto fill = static_cast<double>(shape.most - std::min(shape.most, given.size()));
    const double step = std::max(kLandmarkStepMm, length / std::max(fill, 1.0));
    made.pointsMm.clear();
    for (std::size_t i = 0; i < given.size(); ++i) {
        made.pointsMm.push_back(given[i]);
        if (i >= legs) continue;
        const core::Vec3 way = given[(i + 1) % given.size()] - given[i];
        const int parts = static_cast<int>(way.norm() / step);
        for (int k = 1; k < parts; ++k)
            made.pointsMm.push_back(surface.nearest(given[i] + way * (static_cast<double>(k) / parts)).pointMm);
    }
    return made;
}

void writeLandmarks(const fs::path& casePath, const std::vector<Landmark>& marks) {
    const auto refuse = [&](const std::string& what) {
        return core::Error(what, casePath.string(), "save it as a case of its own");
    };
    std::error_code ec;
    const bool isFolder = fs::is_directory(casePath, ec);
    if (!isFolder && !isPackageName(casePath)) throw refuse("a surface alone holds no landmarks");
    PackageFiles content;
    if (!isFolder) content = readPackage(casePath);
    CaseFiles files = isFolder ? filesInFolder(casePath) : filesInPackage(casePath, content);
    if (!files.has(kCaseFile)) throw refuse("this is no case");
    const std::string text = withLandmarks(tomlIn(files, kCaseFile), marks);
    // What would not be read again is not written.
    const auto readOld = files.read;
    files.read = [&](const std::string& name, std::uint64_t most) {
        return name == kCaseFile ? bytesOf(text) : readOld(name, most);
    };
    if (readCaseFiles(files).landmarks.size() != marks.size())
        throw refuse("its case.toml is written in a way that landmarks cannot be put into");
    if (isFolder) {
        core::writeFile(casePath / kCaseFile, text);
    } else {
        content[kCaseFile] = bytesOf(text);
        writePackage(casePath, content);
    }
}

}  // namespace handpiece::cases
