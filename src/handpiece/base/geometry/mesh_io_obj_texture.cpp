// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/mesh_io_obj_texture.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "handpiece/base/core/file.h"
#include "handpiece/base/core/leads_out.h"
#include "handpiece/base/geometry/texture.h"

namespace handpiece::geometry::formats {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxLibraryBytes = 1 << 20;
constexpr std::size_t kMaxNames = 64;
constexpr std::string_view kBlanks = " \t\v\f\r";

std::string_view trimmed(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::string_view firstWord(std::string_view text) {
    return text.substr(0, text.find_first_of(kBlanks));
}

/// The file's name behind map_Kd's options ("-s 1 1 1", "-clamp on"); names may have blanks in them.
std::string_view fileOf(std::string_view rest) {
    rest = trimmed(rest);
    bool isBehindOption = false;
    while (!rest.empty()) {
        const std::string_view word = firstWord(rest);
        double number = 0.0;
        const bool isValue = isBehindOption && (parseNumber(word, number) || word == "on" || word == "off");
        if (!word.starts_with('-') && !isValue) break;
        isBehindOption = true;
        rest = trimmed(rest.substr(word.size()));
    }
    return rest;
}

/// Beside the mesh, never outside of its folder. Throws core::Error, of which the problem is told, where there is none
/// or it leads out.
fs::path beside(const fs::path& folder, std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    const fs::path file(name);
    const bool escapes = name.empty() || name.find('\0') != std::string::npos || file.is_absolute() ||
                         file.has_root_name() ||
                         std::any_of(file.begin(), file.end(), [](const fs::path& step) { return step == ".."; });
    if (escapes || !core::isThere(folder / file)) throw core::Error("it is not beside the mesh", name);
    if (core::leadsOut(folder, folder / file))
        throw core::Error("it is a link that leads out of the mesh's folder", name);
    return folder / file;
}

/// Material to the file of its picture.
using Pictures = std::map<std::string, std::string, std::less<>>;

void readLibrary(std::string_view text, Pictures& pictures) {
    std::string material;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
        const std::string_view line = trimmed(text.substr(at, end - at)), key = firstWord(line);
        at = end + 1;
        if (key == "newmtl")
            material = trimmed(line.substr(key.size()));
        else if (key == "map_Kd" && pictures.size() < kMaxNames)
            pictures.try_emplace(material, fileOf(line.substr(key.size())));
    }
}

/// Between the four pixels around; a place beyond the picture's edge is on its next copy.
std::array<double, 3> sampled(const Picture& picture, const std::array<float, 2>& place) {
    const auto within = [](double x) { return x < 0.0 || x > 1.0 ? x - std::floor(x) : x; };
    const double x = std::clamp(within(place[0]) * picture.columns - 0.5, 0.0, picture.columns - 1.0),
                 y = std::clamp((1.0 - within(place[1])) * picture.rows - 0.5, 0.0, picture.rows - 1.0);
    const int left = static_cast<int>(x), top = static_cast<int>(y);
    const int right = std::min(left + 1, picture.columns - 1), low = std::min(top + 1, picture.rows - 1);
    const double u = x - left, v = y - top;
    std::array<double, 3> colour{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto pixel = [&](int column, int row) {
            return static_cast<double>(
                picture.rgb[3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(picture.columns) +
                                 static_cast<std::size_t>(column)) +
                            k]);
        };
        colour[k] = (1.0 - v) * ((1.0 - u) * pixel(left, top) + u * pixel(right, top)) +
                    v * ((1.0 - u) * pixel(left, low) + u * pixel(right, low));
    }
    return colour;
}

}  // namespace

void ObjTexture::take(std::string_view key, std::string_view rest) {
    if (key == "vt") place(rest);
    if (key == "usemtl") material(rest);
    if (key == "mtllib") library(rest);
}

void ObjTexture::library(std::string_view rest) {
    if (libraries_.size() < kMaxNames) libraries_.emplace_back(trimmed(rest));
}

void ObjTexture::material(std::string_view rest) {
    const std::string_view name = trimmed(rest);
    const auto found = std::find(materials_.begin(), materials_.end(), name);
    material_ = static_cast<std::uint32_t>(found - materials_.begin());
    if (found != materials_.end()) return;
    if (materials_.size() < kMaxNames)
        materials_.emplace_back(name);
    else
        material_ = kNone;
}

void ObjTexture::place(std::string_view rest) {
    std::array<double, 2> place{};
    for (double& number : place) {
        rest = trimmed(rest);
        const std::string_view word = firstWord(rest);
        rest.remove_prefix(word.size());
        // Beyond this a float knows no place within a picture any more.
        constexpr double kFarthest = 1e4;
        if (!parseNumber(word, number) || !(std::abs(number) <= kFarthest)) {
            ++wrong_;
            number = 0.0;
        }
    }
    places_.push_back({static_cast<float>(place[0]), static_cast<float>(place[1])});
}

void ObjTexture::corner(std::string_view word, std::uint32_t vertex, std::size_t vertices) {
    if (vertex >= vertices) {  // it is still to come, or never will, which who reads the faces tells
        ++wrong_;
        return;
    }
    if (vertex >= at_.size()) at_.resize(std::size_t{vertex} + 1);
    at_[vertex].isInFace = true;
    const std::size_t slash = word.find('/');
    if (slash == std::string_view::npos || material_ == kNone) return;
    word.remove_prefix(slash + 1);
    word = word.substr(0, word.find('/'));
    if (word.empty()) return;
    std::int64_t number = 0;
    if (!parseInteger(word, number)) {
        ++wrong_;
        return;
    }
    const std::int64_t index = number > 0 ? number - 1 : number + static_cast<std::int64_t>(places_.size());
    if (index < 0 || index >= kNone) {
        ++wrong_;
        return;
    }
    if (at_[vertex].place == kNone) at_[vertex] = {static_cast<std::uint32_t>(index), material_};
}

VertexColours ObjTexture::colours(const Source& source, std::size_t vertices) const {
    if (libraries_.empty() || materials_.empty() || places_.empty() || at_.empty()) return {};
    const auto leftOut = [&](const std::string& reason) {
        source.note("the colours are left out: " + reason);
        return VertexColours();
    };
    if (source.folder.empty()) return leftOut("they lie in files beside the mesh");
    Pictures pictures;
    for (const std::string& library : libraries_) {
        try {
            const std::vector<std::byte> bytes = core::readFile(beside(source.folder, library), kMaxLibraryBytes);
            readLibrary({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, pictures);
        } catch (const core::Error& e) {
            return leftOut(fmt::format("{}: {}", formats::quoted(std::string_view(library)), e.problem()));
        }
    }
    if (pictures.empty()) return {};
    const bool hasPlaces = std::all_of(at_.begin(), at_.end(),
                                       [&](const At& at) { return at.place == kNone || at.place < places_.size(); });
    if (wrong_ > 0 || !hasPlaces) return leftOut("some corners name no place in their picture");
    const auto lacking = std::count_if(at_.begin(), at_.end(), [&](const At& at) {
        return at.isInFace && (at.place == kNone || pictures.count(materials_[at.material]) == 0);
    });
    if (lacking > 0) return leftOut(fmt::format("{} of {} vertices have none", lacking, vertices));

    VertexColours colours(vertices);
    for (std::uint32_t m = 0; m < materials_.size(); ++m) {
        const auto named = pictures.find(materials_[m]);
        if (named == pictures.end()) continue;
        try {
            const std::optional<Picture> picture = readPicture(beside(source.folder, named->second));
            if (!picture) return leftOut("this program reads no pictures");
            for (std::size_t v = 0; v < at_.size(); ++v) {
                if (at_[v].place == kNone || at_[v].material != m) continue;
                const std::array<double, 3> colour = sampled(*picture, places_[at_[v].place]);
                for (std::size_t k = 0; k < 3; ++k)
                    colours[v][k] = static_cast<std::uint8_t>(std::floor(colour[k] + 0.5));
            }
        } catch (const core::Error& e) {
            return leftOut(fmt::format("{}: {}", formats::quoted(std::string_view(named->second)), e.problem()));
        }
    }
    return colours;
}

}  // namespace handpiece::geometry::formats
