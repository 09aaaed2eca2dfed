// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The paper's experiments, run on ours: what the tables and the figures share.

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/app/report/report_html.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/tooth/state_delta.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "handpiece/tick/contact/method.h"
#include "studies/stroboscope.h"
#include "studies/timing.h"

namespace handpiece::studies {

using Json = nlohmann::ordered_json;

/// One surface of the paper's Table II and the two ways to feel it.
struct Surface {
    std::string name;  ///< "6 %"; "plane"
    std::filesystem::path file;
    std::size_t paperVertices = 0, paperFaces = 0, vertices = 0, faces = 0;
    double loadMs = 0.0;  ///< of `file`
    std::shared_ptr<const tooth::ToothModel> tooth;
    std::shared_ptr<contact::Method> field, hull;

    [[nodiscard]] bool isPlane() const { return name == "plane"; }
};

/// Slices that a tooth is made of; without a path the starter tooth is imaged.
struct ScanSource {
    std::filesystem::path path;
    std::optional<double> spacingMm;
    bool labels = false;  ///< tissue numbers, not grey values
};

struct Reproduction {
    bool quick = false, ownTooth = false;
    std::filesystem::path out;
    ScanSource scan;
    std::shared_ptr<const instrument::Bur> bur;
    std::vector<Surface> surfaces;  ///< the plane first, then coarse to fine
    report::HtmlReport report{"Touching and cutting a tooth: the paper's experiments, repeated"};
    Json results;
    std::vector<std::string> remarks;              ///< what did not come out as it should
    std::function<void(const std::string&)> step;  ///< called before each piece of work; throws when cancelled
};

/// Both methods of a surface by their names.
struct NamedMethod {
    const char* name;
    contact::Method* method;
};
[[nodiscard]] std::vector<NamedMethod> methodsOf(const Surface& surface);

/// Where a bur is dropped: the tip's place above the tooth.
struct Place {
    std::string name;  ///< "cusp 1", "fissure"
    core::Vec2 xyMm;
    bool open = true;  ///< no undercut faces the bur
};
/// The highest cusps and the deepest place between them, felt on the field of `surface`.
[[nodiscard]] std::vector<Place> placesOn(const Surface& surface);
// Each adds its part to report and results.
void reproduceTables(Reproduction& r);
void reproduceFigures(Reproduction& r);

/// How long a picture of each mesh takes, drawn anew and read back.
struct DrawTiming {
    std::vector<double> ms;  ///< median, by mesh; empty without OpenGL
    std::string renderer;    ///< what drew
    std::string missing;     ///< why nothing was drawn
};
[[nodiscard]] DrawTiming timeDraw(const Reproduction& r, const std::vector<geometry::TriangleMesh>& meshes);
/// Time to read a mesh file: the fastest of five, so that the file comes from memory as the paper's may have.
[[nodiscard]] double loadMsOf(const std::filesystem::path& file, geometry::TriangleMesh& mesh);

/// What the paper printed of a tooth in Table II.
struct PaperTooth {
    double loadMs, drawMs;
};
[[nodiscard]] PaperTooth paperTooth(const std::string& resolution);

/// Table II of a tooth that comes out of slices.
void reproduceScan(Reproduction& r);

/// One depth query and the cut that follows it in a tick.
struct CutTiming {
    Timing field;     ///< ours, over a sweep in which each tick takes away all that the bur sweeps
    Timing hullAnew;  ///< the hull of all vertices made anew (Qhull) and its depth (EPA), a few times
    double removedMm3 = 0.0;
};
[[nodiscard]] CutTiming timeCut(const Reproduction& r, const Surface& surface, std::size_t count);
/// A surface of enamel throughout, to be cut.
[[nodiscard]] std::shared_ptr<const tooth::ToothModel> wholeOf(const Surface& surface);
/// A stroboscope picture in three dimensions, in the report and as a file beside it; gives the file's name, or null
/// when there is no OpenGL: then the report says so.
Json addStroboscope(Reproduction& r, const std::shared_ptr<const tooth::ToothModel>& uncut,
                    const tooth::StateDelta& state, const Stroboscope& shot, const std::string& file,
                    const std::string& caption);
/// Figure 11.
void reproduceCutPictures(Reproduction& r, const Surface& surface);
/// Figure 12, the same motions cutting and touching: their plots, and a row of results and of the table for each.
void reproduceCutForces(Reproduction& r, const Surface& surface, Json& rows,
                        std::vector<std::vector<std::string>>& cells);

/// "yes" or "no".
[[nodiscard]] inline std::string yesNo(bool yes) {
    return yes ? "yes" : "no";
}

}  // namespace handpiece::studies
