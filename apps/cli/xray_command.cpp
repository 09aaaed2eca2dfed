// SPDX-License-Identifier: Apache-2.0
// handpiece xray: a bitewing or periapical radiograph of a case, an attempt or a moment of a session.
#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/commands.h"
#include "handpiece/app/simulation/tissue_export.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/case/case.h"
#include "handpiece/scan/volume/write_radiograph.h"
#include "handpiece/senses/radiograph/radiograph.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct XrayOptions {
    std::string caseFile, view = "bitewing", out, size, noise = "on", filling = "amalgam", bits = "16";
    radiograph::Settings settings;
    double atS = 0.0;
    std::size_t threads = 0;
    bool atGiven = false, noCache = false, json = false;
};

void readSize(const std::string& text, radiograph::Settings& settings) {
    const char* const end = text.data() + text.size();
    const auto [cross, first] = std::from_chars(text.data(), end, settings.width);
    const bool hasTwo = first == std::errc() && cross != end && *cross == 'x';
    const auto [last, second] = hasTwo ? std::from_chars(cross + 1, end, settings.height)
                                       : std::from_chars_result{cross, std::errc::invalid_argument};
    if (second != std::errc() || last != end || settings.width == 0 || settings.height == 0)
        throw core::Error(fmt::format("\"{}\" is no size", text.substr(0, 60)), "--size", "write it as 1200x866");
}

Json toJson(const core::Vec3& v) {
    return {v.x(), v.y(), v.z()};
}

void xray(XrayOptions& o) {
    radiograph::Settings& s = o.settings;
    s.view = radiograph::viewByName(o.view);
    s.filling = radiograph::fillingByName(o.filling);
    if (!o.size.empty()) readSize(o.size, s);
    if (o.noise == "off") s.quanta = 0.0;
    radiograph::check(s);
    const fs::path out = o.out.empty() ? fs::path(o.view + ".png") : fs::path(o.out);
    volume::requireRadiographName(out);
    if (const fs::path folder = out.parent_path(); !folder.empty() && !core::isFolder(folder))
        throw core::Error("there is no such folder", folder.string(), "make it first");
    core::setThreadCount(o.threads);

    if (o.atGiven && fs::path(o.caseFile).extension() != ".h5")
        throw core::Error("only a session has a time", "--at", "give a session file (.h5), or leave --at out");
    if (o.atGiven && !(o.atS >= 0.0))
        throw core::Error(fmt::format("the session has no second {:.3f}", o.atS), "--at", "give seconds from 0 on");
    studies::ProgressBar bar("taking the radiograph");
    const cases::Case toothCase = simulation::readAsCut(o.caseFile, o.atGiven ? std::optional(o.atS) : std::nullopt,
                                                        !o.noCache, core::part(bar.listener(), 0.0, 0.5));
    const radiograph::Radiograph taken = radiograph::take(toothCase, s, core::part(bar.listener(), 0.5, 1.0));
    bar.finish();
    const radiograph::Picture& picture = taken.picture;
    volume::writeRadiograph({picture.width, picture.height, picture.grey, taken.projection.pixelMm, o.view,
                             taken.fdiNumber, s.kv, s.focalSpotMm, s.sourceMm, o.bits == "16"},
                            out);
    if (!o.json) {
        fmt::print("{}: simulated {} of {}, {} x {} pixels of {:g} um, {:g} kV\n", out.string(), o.view, toothCase.name,
                   picture.width, picture.height, s.pixelUm, s.kv);
        return;
    }
    const radiograph::Projection& p = taken.projection;
    const Json told = {{"file", out.string()},
                       {"simulated", true},
                       {"view", o.view},
                       {"fdi", taken.fdiNumber},
                       {"width", picture.width},
                       {"height", picture.height},
                       {"pixel_um", s.pixelUm},
                       {"kv", s.kv},
                       {"focal_spot_mm", s.focalSpotMm},
                       {"source_to_detector_mm", s.sourceMm},
                       {"quanta_per_pixel", s.quanta},
                       {"seed", s.seed},
                       {"detector_centre_mm", toJson(p.centreMm)},
                       {"right", toJson(p.right)},
                       {"up", toJson(p.up)},
                       {"window_centre_attenuation", picture.windowCentre},
                       {"window_width_attenuation", picture.windowWidth}};
    fmt::print("{}\n", told.dump(2));
}

}  // namespace

void addXrayCommand(Command& app) {
    Command command =
        app.subcommand("xray", "A simulated bitewing or periapical radiograph of a case, an attempt or a session");
    const auto options = std::make_shared<XrayOptions>();
    XrayOptions& o = *options;
    radiograph::Settings& s = o.settings;
    command.option("case", o.caseFile, "case folder, .handpiece file, mesh, attempt or session (.h5)").required();
    command.option("--view", o.view, "bitewing or periapical").showDefault();
    command.option("--fdi", s.fdiNumber, "FDI number of the tooth in the middle; else the case's own tooth");
    command.option("--out", o.out, ".png or .dcm (DICOM) to write; else the view's name in this folder");
    command.option("--size", o.size, "of the picture, as 1200x866 [pixels]; else a sensor of 36 x 26 mm");
    command.option("--pixel", s.pixelUm, "edge of a pixel [um]").showDefault();
    command.option("--bits", o.bits, "of a PNG").check(oneOf({"8", "16"})).showDefault();
    command.option("--kv", s.kv, "tube voltage [kV]").showDefault();
    command.option("--focal-spot", s.focalSpotMm, "edge of the focal spot [mm]").showDefault();
    command.option("--distance", s.sourceMm, "from the focal spot to the detector [mm]").showDefault();
    command.option("--blur", s.blurUm, "standard deviation of the detector's spread [um]").showDefault();
    command.option("--noise", o.noise, "on or off").check(oneOf({"on", "off"})).showDefault();
    command.option("--quanta", s.quanta, "that a pixel counts in the open beam").showDefault();
    command.option("--seed", s.seed, "of the noise").showDefault();
    command.option("--filling", o.filling, "what restorations are made of: amalgam or composite").showDefault();
    command.option("--at", o.atS, "second of a session [default: its end]");
    command.flag("--no-cache", o.noCache, "build fields anew and keep nothing");
    command.option("--threads", o.threads, "0: all; the picture is the same at any number").showDefault();
    command.flag("--json", o.json, "tell about it as JSON");
    command.footer(
        "Teeth are imaged as they are: of a case uncut, of an attempt or a session cut; docs/radiographs.md tells "
        "how.\n\n"
        "Examples:\n  handpiece xray molar --view periapical --out molar.png\n"
        "  handpiece xray mouth --view bitewing --fdi 46 --out bitewing.dcm");
    command.callback([options, command] {
        options->atGiven = command.isGiven("--at");
        xray(*options);
    });
}

}  // namespace handpiece::cli
