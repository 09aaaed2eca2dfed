// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/review_data.h"

#include <zlib.h>

#include "handpiece/base/core/error.h"

namespace handpiece::report {

std::vector<std::uint8_t> differencesOf(const Volume& volume) {
    std::vector<std::uint8_t> out(volume.values.size());
    const auto at = [&](int x, int y, int z) -> int {
        return x < 0 || y < 0 || z < 0 ? 0 : volume.values[volume.index(x, y, z)];
    };
    std::size_t i = 0;
    for (int z = 0; z < volume.nodes[2]; ++z)
        for (int y = 0; y < volume.nodes[1]; ++y)
            for (int x = 0; x < volume.nodes[0]; ++x, ++i)
                out[i] = static_cast<std::uint8_t>(volume.values[i] - at(x - 1, y, z) - at(x, y - 1, z) -
                                                   at(x, y, z - 1) + at(x - 1, y - 1, z) + at(x - 1, y, z - 1) +
                                                   at(x, y - 1, z - 1) - at(x - 1, y - 1, z - 1));
    return out;
}

std::vector<std::uint8_t> stepsOf(const std::vector<std::uint8_t>& values) {
    std::vector<std::uint8_t> out(values.size());
    std::uint8_t before = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        out[i] = static_cast<std::uint8_t>(values[i] - before);
        before = values[i];
    }
    return out;
}

std::vector<std::uint8_t> planesOf(const std::vector<std::vector<std::uint16_t>>& rows) {
    std::vector<std::uint8_t> out;
    for (const std::vector<std::uint16_t>& row : rows)
        for (const int shift : {0, 8}) {
            std::uint16_t before = 0;
            for (const std::uint16_t value : row) {
                out.push_back(static_cast<std::uint8_t>(static_cast<std::uint16_t>(value - before) >> shift));
                before = value;
            }
        }
    return out;
}

std::vector<std::byte> compressed(std::span<const std::vector<std::uint8_t>* const> sections) {
    std::vector<std::uint8_t> all;
    for (const std::vector<std::uint8_t>* section : sections)
        all.insert(all.end(), section->begin(), section->end());
    uLongf size = compressBound(static_cast<uLong>(all.size()));
    std::vector<std::byte> out(size);
    if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, all.data(), static_cast<uLong>(all.size()), 9) != Z_OK)
        throw core::Error("the review cannot be compressed: out of memory");
    out.resize(size);
    return out;
}

}  // namespace handpiece::report
