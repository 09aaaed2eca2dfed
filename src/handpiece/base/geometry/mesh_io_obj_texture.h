// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Colours of an OBJ whose materials are pictures (MTL, map_Kd). Only mesh_io_obj*.cpp include it.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/geometry/mesh_io_formats.h"

namespace handpiece::geometry::formats {

/// Told line by line what an OBJ says of them; looked up at its vertices in the end.
class ObjTexture {
  public:
    /// A line by its key and what is behind it; most say nothing of colours.
    void take(std::string_view key, std::string_view rest);
    /// Corner `word` ("7/1", "7/1/3") of `vertex`, of as many as there were so far; the first that names a place
    /// counts.
    void corner(std::string_view word, std::uint32_t vertex, std::size_t vertices);

    /// Of all vertices; empty, and the reason noted, where they cannot be had. Nothing is noted of an OBJ that has no
    /// pictures.
    [[nodiscard]] VertexColours colours(const Source& source, std::size_t vertices) const;

  private:
    static constexpr std::uint32_t kNone = 0xffffffffu;
    struct At {
        std::uint32_t place = kNone, material = kNone;
        bool isInFace = false;
    };
    void library(std::string_view rest);
    void material(std::string_view rest);
    void place(std::string_view rest);

    std::vector<std::string> libraries_, materials_;
    std::uint32_t material_ = kNone;
    std::vector<std::array<float, 2>> places_;
    std::vector<At> at_;  ///< by vertex, as far as there were corners
    std::size_t wrong_ = 0;
};

}  // namespace handpiece::geometry::formats
