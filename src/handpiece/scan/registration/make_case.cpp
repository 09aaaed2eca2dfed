// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/registration/make_case.h"

#include "handpiece/base/core/error.h"
#include "handpiece/model/case/fdi.h"

namespace handpiece::registration {
namespace {

/// +1 where +y is buccal: with +z out of the crown and +x mesial it depends on the side of the jaw alone.
int buccalSignOf(int fdi) {
    const int quadrant = fdi / 10;
    return fdi == 0 ? 0 : quadrant % 2 == 1 ? 1 : -1;
}

}  // namespace

void requireFdi(int fdi) {
    if (fdi != 0 && !cases::isPermanentTooth(fdi) && !cases::isDeciduousTooth(fdi))
        throw core::Error("there is no tooth of this FDI number", std::to_string(fdi), "give 11 to 48 or 51 to 85");
}

cases::Case makeCase(const surfacing::Surfaces& surfaces, const Placed& placed, const CaseText& text,
                     const std::vector<cases::Part>& scenery) {
    requireFdi(text.fdiNumber);
    cases::Case made;
    made.name = text.name;
    made.kind = text.kind;
    made.fdiNumber = text.fdiNumber;
    made.buccalSign = text.buccalSign != 0 ? text.buccalSign : buccalSignOf(text.fdiNumber);
    made.tissuesToml = text.tissuesToml;
    if (!text.tissuesToml.empty()) made.tissues = cases::parseTissues(text.tissuesToml, "the table of tissues");
    made.outer = geometry::transformed(surfaces.outer.mesh, placed.scanInTooth);
    const auto add = [&](const char* name, cases::Tissue tissue, geometry::TriangleMesh mesh) {
        made.parts.push_back({name, tissue, made.tissues.of(tissue).priority, std::move(mesh)});
    };
    // What no other tissue claims is enamel, up to the tooth's own surface.
    add("enamel", cases::Tissue::enamel, made.outer);
    for (const surfacing::Surface& s : surfaces.tissues) {
        if (s.mesh.triangles.empty()) continue;
        const std::string tissue(cases::properties(s.tissue).name);
        add((s.isAuthored ? tissue + " (authored)" : tissue).c_str(), s.tissue,
            geometry::transformed(s.mesh, placed.scanInTooth));
    }
    for (const cases::Part& part : scenery) {
        made.scenery.push_back(part);
        made.scenery.back().mesh = geometry::transformed(part.mesh, placed.scanInTooth);
    }
    return made;
}

}  // namespace handpiece::registration
