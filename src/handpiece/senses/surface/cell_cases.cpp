// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/surface/cell_cases.h"

namespace handpiece::surface {
namespace {

int edgeBetween(int corner, int other) {
    const int a = (corner ^ other) == 1 ? 0 : (corner ^ other) == 2 ? 1 : 2;
    const int low = corner & other, u = (a + 1) % 3, w = (a + 2) % 3;
    return 4 * a + (low >> u & 1) + 2 * (low >> w & 1);
}

CellCase makeCase(int inside) {  // with its bits for joined faces
    std::array<std::uint8_t, 12> root{};
    for (std::uint8_t e = 0; e < 12; ++e)
        root[e] = e;
    const auto find = [&](std::uint8_t e) {
        while (root[e] != e)
            e = root[e];
        return e;
    };
    const auto isInside = [&](int corner) { return (inside >> corner & 1) != 0; };
    const auto isCrossed = [&](int e) { return isInside(edgeCorner(e)) != isInside(edgeCorner(e) | 1 << (e / 4)); };
    // On every face crossed edges are paired: the two there are, or those round each inside corner, or, where these are
    // joined, round each outside corner.
    for (int face = 0; face < 6; ++face) {
        const std::array<int, 4> corners = faceCorners(face);
        const auto next = [&](std::size_t i) { return edgeBetween(corners[i], corners[(i + 1) % 4]); };
        std::array<int, 4> crossed{};
        std::size_t count = 0;
        for (std::size_t i = 0; i < 4; ++i)
            if (isCrossed(next(i))) crossed[count++] = next(i);
        const auto join = [&](int a, int b) {
            root[find(static_cast<std::uint8_t>(a))] = find(static_cast<std::uint8_t>(b));
        };
        if (count == 2) join(crossed[0], crossed[1]);
        const bool isJoined = (inside >> (8 + face) & 1) != 0;
        if (count == 4)
            for (std::size_t i = 0; i < 4; ++i)
                if (isInside(corners[i]) != isJoined) join(next((i + 3) % 4), next(i));
    }
    CellCase made;
    made.sheetOf.fill(kNoSheet);
    std::array<std::uint8_t, 12> sheetOfRoot;
    sheetOfRoot.fill(kNoSheet);
    for (std::uint8_t e = 0; e < 12; ++e) {
        if (!isCrossed(e)) continue;
        std::uint8_t& sheet = sheetOfRoot[find(e)];
        if (sheet == kNoSheet) sheet = made.sheets++;
        made.sheetOf[e] = sheet;
        made.edges[made.edgeCount++] = e;
    }
    return made;
}

}  // namespace

const std::array<CellCase, kCellCases>& cellCases() {
    static const std::array<CellCase, kCellCases> all = [] {
        std::array<CellCase, kCellCases> cases;
        for (std::size_t i = 0; i < kCellCases; ++i)
            cases[i] = makeCase(static_cast<int>(i));
        return cases;
    }();
    return all;
}

const std::array<std::uint8_t, 256>& ambiguousFaces() {
    static const std::array<std::uint8_t, 256> all = [] {
        std::array<std::uint8_t, 256> faces{};
        for (unsigned bits = 0; bits < 256; ++bits)
            for (int face = 0; face < 6; ++face) {
                const std::array<int, 4> c = faceCorners(face);
                const auto isInside = [&](std::size_t i) { return (bits >> c[i] & 1) != 0; };
                if (isInside(0) == isInside(2) && isInside(1) == isInside(3) && isInside(0) != isInside(1))
                    faces[bits] = static_cast<std::uint8_t>(faces[bits] | 1 << face);
            }
        return faces;
    }();
    return all;
}

const std::array<bool, 256>& plainCases() {
    static const std::array<bool, 256> all = [] {
        std::array<bool, 256> plain;
        for (std::size_t i = 0; i < plain.size(); ++i)
            plain[i] = cellCases()[i].sheets == 1 && ambiguousFaces()[i] == 0;
        return plain;
    }();
    return all;
}

}  // namespace handpiece::surface
