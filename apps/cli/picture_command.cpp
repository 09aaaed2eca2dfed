// SPDX-License-Identifier: Apache-2.0
// handpiece picture: a tooth, an attempt or a moment of a session as a PNG, drawn by the window's renderer.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/inputs.h"
#include "handpiece/app/input/working_position.h"
#include "handpiece/app/simulation/session_player.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/turbine.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/senses/view/occlusal.h"
#include "handpiece/senses/view/renderer.h"
#include "studies/built_in_motion.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

namespace fs = std::filesystem;
using core::Vec3;

constexpr int kMinSide = 16, kMaxSide = 8192;
constexpr double kSectionPixelMm = 0.03;
constexpr double kRateOverS = 0.05;  // what is removed in this time says how many chips fly

struct PictureOptions {
    std::string what, out, view = "oblique", size = "1280x800", quality = "rich", palette = "natural", look = "now",
                           section, eye, target, stereo = "none";
    BurInput bur{"", "mm"};  ///< no name: none
    MeshUnit unit;           ///< of a tooth that is a mesh file
    std::vector<std::string> hide;
    double atS = -1.0, voxelUm = 50.0;
    int position = 0;  // 0: none
    std::size_t threads = 0;
    bool atGiven = false, grid = false, noBur = false, noScenery = false, noScanColours = false, cheeks = false,
         mirror = false, arrows = false, scaleBar = false, noCache = false;
};

std::vector<double> numbers(const std::string& text, std::size_t count, const std::string& option,
                            const std::string& remedy = "write them with commas between, without blanks") {
    std::vector<double> values;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (values.size() < count) {
        double value = 0.0;
        const auto [next, problem] = std::from_chars(at, end, value);
        if (problem != std::errc() || !std::isfinite(value)) break;
        values.push_back(value);
        at = next;
        if (at == end || *at != ',') break;
        ++at;
    }
    if (values.size() != count || at != end)
        throw core::Error(fmt::format("\"{}\" is not {} numbers", text, count), option, remedy);
    return values;
}

Vec3 vectorOf(const std::string& text, const std::string& option) {
    const std::vector<double> v = numbers(text, 3, option);
    return {v[0], v[1], v[2]};
}

view::Viewport sizeOf(const std::string& text) {
    view::Viewport size;
    const char* const end = text.data() + text.size();
    const auto [cross, first] = std::from_chars(text.data(), end, size.width);
    const bool hasTwo = first == std::errc() && cross != end && *cross == 'x';
    const auto [last, second] = hasTwo ? std::from_chars(cross + 1, end, size.height)
                                       : std::from_chars_result{cross, std::errc::invalid_argument};
    if (second != std::errc() || last != end)
        throw core::Error(fmt::format("\"{}\" is no size", text), "--size", "write it as 1280x800");
    for (const int side : {size.width, size.height})
        if (side < kMinSide || side > kMaxSide)
            throw core::Error(fmt::format("a picture of {} x {} pixels", size.width, size.height), "--size",
                              fmt::format("give {} to {} a side", kMinSide, kMaxSide));
    return size;
}

view::Look lookOf(const PictureOptions& o) {
    view::Look look;
    look.quality = view::qualityByName(o.quality);
    look.palette = view::paletteByName(o.palette);
    look.stereo = view::stereoByName(o.stereo);
    if (o.look == "before") {
        look.tooth = view::ToothShown::before;
    } else if (o.look == "ghost") {
        look.tooth = view::ToothShown::ghost;
    } else if (o.look == "removed-depth") {
        look.removedDepthColours = true;
    } else if (o.look != "now") {
        throw core::Error("there is no look of this name", o.look, "there are: now, before, ghost, removed-depth");
    }
    for (const std::string& name : o.hide)
        look.visible[static_cast<std::size_t>(cases::tissueByName(name))] = false;
    look.sectionGrid = o.grid;
    look.contactArrow = look.forceArrow = o.arrows;
    look.scaleBar = o.scaleBar;
    look.cheeks = o.cheeks;
    look.scanColours = !o.noScanColours;
    return look;
}

/// "x", "y", "z": through the middle of the tooth, the half towards the eye taken away; or a plane in numbers.
struct SectionAsked {
    view::Plane plane;
    bool throughMiddle = false;  ///< only the normal's axis is known yet
};

SectionAsked sectionOf(const std::string& text) {
    if (text == "x" || text == "y" || text == "z") return {{Vec3::Unit(text[0] - 'x'), 0.0}, true};
    constexpr const char* kRemedy = "give NX,NY,NZ,OFFSET without blanks, or x, y or z";
    const std::vector<double> v = numbers(text, 4, "--section", kRemedy);
    const Vec3 normal(v[0], v[1], v[2]);
    if (!(normal.norm() > 1e-9)) throw core::Error("a plane needs a direction", "--section", kRemedy);
    return {{normal.normalized(), v[3] / normal.norm()}};
}

view::Plane planeOf(const SectionAsked& asked, const core::Box& bounds, const view::Camera& camera) {
    view::Plane plane = asked.plane;
    if (!asked.throughMiddle) return plane;
    if (plane.normal.dot(camera.forward()) > 0.0) plane.normal = -plane.normal;
    plane.offsetMm = plane.normal.dot(bounds.centre());
    return plane;
}

/// What was asked for, read: nobody waits for a tooth to hear of a typing error.
struct Asked {
    view::Viewport size;
    view::Look look;
    view::StandardView view = view::StandardView::oblique;
    std::optional<Vec3> eyeMm, targetMm;
    std::optional<SectionAsked> section;
    std::optional<instrument::Instrument> bur;
};

Asked read(const PictureOptions& o) {
    Asked asked;
    asked.size = sizeOf(o.size);
    asked.look = lookOf(o);
    asked.view = view::viewByName(o.view);
    if (!o.eye.empty()) asked.eyeMm = vectorOf(o.eye, "--eye");
    if (!o.target.empty()) asked.targetMm = vectorOf(o.target, "--target");
    if (asked.targetMm && !asked.eyeMm) throw core::Error("a target needs an eye", "--target", "give --eye as well");
    if (asked.targetMm && (*asked.targetMm - *asked.eyeMm).norm() < 1e-3)
        throw core::Error("the eye is where it looks at", "--eye", "give two different points");
    if (o.position != 0) input::requireOperatorsHour(o.position, "--position");
    if (o.position != 0 && asked.eyeMm)
        throw core::Error("an eye and a position", "--position", "give one of --eye and --position");
    if (!o.section.empty()) asked.section = sectionOf(o.section);
    const fs::path out(o.out);
    if (out.extension() != ".png") throw core::Error("pictures are written as .png", o.out, "name the output so");
    if (const fs::path folder = out.parent_path(); !folder.empty() && !core::isFolder(folder))
        throw core::Error("there is no such folder", folder.string(), "make it first");
    const bool isSession = fs::path(o.what).extension() == ".h5";
    if (o.atGiven && !isSession)
        throw core::Error("only a session has a time", "--at", "give a session file (.h5), or leave --at out");
    if (isSession && !o.bur.name.empty())
        throw core::Error("a session has its own bur", "--bur", "leave it out, or hide that one with --no-bur");
    if (!o.bur.name.empty()) asked.bur = instrument::makeInstrument(o.bur.name, {}, {}, o.bur.mmPerUnit());
    return asked;
}

/// All that is to be seen, whatever it came from.
struct Subject {
    core::Box bounds;
    view::Standing standing;
    Vec3 down = -Vec3::UnitZ();                   ///< as gravity acts on the patient
    std::shared_ptr<simulation::LiveTooth> live;  ///< null: a mesh alone
    geometry::ColouredMesh mesh;                  ///< that one
    std::vector<cases::Part> scenery, parts;
    std::shared_ptr<const std::vector<cases::PlacedTooth>> others;
    std::shared_ptr<const instrument::Bur> bur;  ///< null: none is shown
    view::BurFinish finish = view::BurFinish::diamond;
    view::Moment moment;
    std::optional<input::WorkingPosition> position;
    std::shared_ptr<simulation::SessionPlayer> session;  ///< owns `live` where it came from there
};

void takeCase(Subject& subject, const std::shared_ptr<const cases::Case>& shared, const PictureOptions& o) {
    const cases::Case& toothCase = *shared;
    subject.standing = view::standingOf(toothCase.fdiNumber, toothCase.buccalSign);
    subject.scenery = cases::surroundings(toothCase);
    subject.parts = toothCase.parts;
    subject.others = std::shared_ptr<const std::vector<cases::PlacedTooth>>(shared, &shared->others);
    subject.down = input::downInCase(toothCase);
    subject.bounds = subject.live->model().outer.bounds();
    if (o.position == 0) return;
    const std::optional<core::Quat> head = input::headInCase(toothCase);
    if (!head)
        throw core::Error("where the head lies is not known: no tooth of the case has a number", "--position",
                          "give the tooth its FDI number in case.toml, or leave --position out");
    subject.position = input::workingPosition(*head, toothCase.fdiNumber < 30, o.position);
}

Subject openSession(const PictureOptions& o) {
    studies::ProgressBar bar("preparing the tooth");
    Subject subject;
    subject.session = std::make_shared<simulation::SessionPlayer>(o.what, !o.noCache, bar.listener());
    simulation::SessionPlayer& player = *subject.session;
    const double atS = o.atGiven ? o.atS : player.durationS();
    if (!(atS >= 0.0 && atS <= player.durationS()))
        throw core::Error(fmt::format("the session has no second {:.3f}", atS), "--at",
                          fmt::format("it is {:.3f} s long", player.durationS()));
    player.seek(std::max(0.0, atS - kRateOverS), bar.listener());
    const auto removed = [&] {
        double sum = 0.0;
        for (const double mm3 : player.sample().removedMm3)
            sum += mm3;
        return sum;
    };
    const double before = removed(), beforeS = player.timeS();
    player.advance(atS, bar.listener());
    bar.finish();
    const messages::HapticSample& s = player.sample();
    subject.live = player.tooth();
    subject.bur = player.station().settings.bur;
    subject.finish = view::finishOf(*subject.bur, player.station().settings.cuttingParameters.name);
    takeCase(subject, std::shared_ptr<const cases::Case>(subject.session, &player.toothCase()), o);
    view::Moment& m = subject.moment;
    m.timeS = s.timeS;
    m.burInTooth.positionMm = {s.proxyPositionMm[0], s.proxyPositionMm[1], s.proxyPositionMm[2]};
    m.burInTooth.orientation =
        core::Quat(s.proxyOrientation[0], s.proxyOrientation[1], s.proxyOrientation[2], s.proxyOrientation[3]);
    m.speedRpm = s.speedRpm;
    if (player.timeS() > beforeS) m.removalMm3S = (removed() - before) / (player.timeS() - beforeS);
    m.tissue = static_cast<cases::Tissue>(s.tissue);
    m.water = s.pedal > 0.0 && s.speedRpm > 0.0;
    m.contactNormal = {s.contactNormal[0], s.contactNormal[1], s.contactNormal[2]};
    m.contact = m.contactNormal.norm() > 0.5;
    m.contactPointMm =
        m.contact ? core::Vec3(s.contactPointMm[0], s.contactPointMm[1], s.contactPointMm[2]) : m.burInTooth.positionMm;
    m.forceN = {s.forceN[0], s.forceN[1], s.forceN[2]};
    return subject;
}

/// The bur as it comes to rest on the tooth, let down along -z over the middle of the crown.
void restBur(Subject& subject, const simulation::SimulationSetup& station, const instrument::Instrument& instrument) {
    subject.bur = instrument.bur;
    subject.finish = view::finishOf(*instrument.bur, instrument.cuttingParameters.name);
    const auto method = contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(station.field), subject.bur);
    core::Pose& pose = subject.moment.burInTooth;
    if (subject.position) pose.orientation = input::handleTowards(pose.orientation, subject.position->toHand);
    const Vec3 middle = subject.bounds.centre();
    pose.positionMm = {middle.x(), middle.y(), subject.bounds.max.z() + 2.0};
    const double reach = subject.bounds.size().z() + 4.0;
    pose.positionMm.z() -= studies::distanceToTouch(*method, pose, -Vec3::UnitZ(), reach);
    subject.moment.contact = true;
    subject.moment.contactPointMm = pose.positionMm;
}

Subject openCase(const PictureOptions& o, const Asked& asked) {
    Subject subject;
    std::optional<cases::OpenAttempt> attempt;
    if (cases::isAttempt(o.what)) attempt = cases::openAttempt(o.what);
    ContactInputs inputs;
    inputs.threads = o.threads;
    inputs.noCache = o.noCache;
    inputs.tooth = o.what;
    inputs.unit = o.unit;
    inputs.voxelUm = attempt ? 1e3 * attempt->attempt.voxelMm : o.voxelUm;
    const tooth::LoadSettings prepare = prepareSettingsOf(inputs);
    const auto toothCase = std::make_shared<const cases::Case>(attempt ? attempt->toothCase : readToothOf(inputs));
    simulation::SimulationSettings settings;
    settings.field = prepare.field;
    studies::ProgressBar bar("preparing the tooth");
    const simulation::SimulationSetup station = simulation::makeSimulation(
        *toothCase, std::move(settings), prepare.useCache, core::part(bar.listener(), 0.0, 0.7));
    tooth::StateDelta state;
    if (attempt) {
        state = tooth::decodeState(attempt->attempt.state, station.teeth(), o.what);
        station.resume(state);
    }
    subject.live = std::make_shared<simulation::LiveTooth>(station, state, core::part(bar.listener(), 0.7, 1.0));
    bar.finish();
    takeCase(subject, toothCase, o);
    if (asked.bur) restBur(subject, station, *asked.bur);
    return subject;
}

Subject openMesh(const PictureOptions& o) {
    Subject subject;
    subject.mesh = o.unit.readColoured(o.what);
    subject.bounds = subject.mesh.mesh.bounds();
    return subject;
}

Subject open(const PictureOptions& o, const Asked& asked) {
    if (fs::path(o.what).extension() == ".h5") return openSession(o);
    // A mesh that only has to be looked at need not be a solid.
    if (geometry::meshFormatOf(o.what) != geometry::MeshFormat::unknown && !asked.bur && !asked.section &&
        o.position == 0) {
        if (o.look != "now")
            throw core::Error("a mesh has not been cut", "--look", "give an attempt or a session, or --look now");
        return openMesh(o);
    }
    return openCase(o, asked);
}

/// Held so that the eye sees in its middle the side of the crown that it does not see: from above the lingual side,
/// else the chewing surface.
view::MirrorPose mirrorFor(const Subject& subject, const view::Camera& camera) {
    const Vec3 size = subject.bounds.size();
    Vec3 crown = subject.bounds.centre();
    crown.z() = subject.bounds.max.z() - 0.25 * size.z();
    const bool fromAbove = camera.forward().z() < -0.85;
    Vec3 level = camera.forward() - Vec3(0.0, 0.0, camera.forward().z());
    level = level.norm() > 1e-6 ? Vec3(level.normalized()) : Vec3(Vec3::UnitY());
    view::MirrorPose pose;
    if (fromAbove) {
        const Vec3 lingual(0.0, subject.standing.buccalSign < 0 ? 1.0 : -1.0, 0.0);
        pose.centreMm = crown + (0.5 * size.y() + 9.0) * lingual;
    } else {
        pose.centreMm = crown + Vec3(0.0, 0.0, 12.0) + (0.5 * size.y() + 3.0) * level;
    }
    // Half way between where the light comes from and where it shall go.
    pose.normal = ((camera.eyeMm - pose.centreMm).normalized() + (crown - pose.centreMm).normalized()).normalized();
    pose.handle = camera.right() + 0.35 * camera.upward();
    return pose;
}

view::Camera cameraFor(const Asked& asked, const Subject& subject, const view::Viewport& each, bool withMirror,
                       std::optional<view::MirrorPose>& mirror) {
    view::Camera camera = view::standardView(asked.view, subject.bounds, subject.standing, each);
    if (subject.position) camera = input::seenFrom(*subject.position, subject.bounds, each);
    if (asked.eyeMm) {
        camera.eyeMm = *asked.eyeMm;
        camera.targetMm = asked.targetMm.value_or(subject.bounds.centre());
        camera.up = subject.standing.up();
    }
    if (!(camera.distanceMm() > 1e-3))
        throw core::Error("the eye is where it looks at", "--eye", "give two different points");
    // Straight up or down with z for up there would be no right: towards the crown as the occlusal view is.
    if (std::abs(camera.up.dot(camera.forward())) > 0.999)
        camera.up = (camera.forward().z() < 0.0 ? 1.0 : -1.0) * view::occlusalUp(subject.standing);
    if (withMirror) {
        mirror = mirrorFor(subject, camera);
        if (!asked.eyeMm) {
            core::Box all = subject.bounds;
            all.extend(mirror->centreMm - Vec3::Constant(0.8 * mirror->radiusMm));
            all.extend(mirror->centreMm + Vec3::Constant(0.8 * mirror->radiusMm));
            camera = view::fitted(camera, all, each);
            mirror = mirrorFor(subject, camera);
        }
    }
    return camera;
}

void picture(const PictureOptions& o) {
    const Asked asked = read(o);
    const view::Viewport size = asked.size;
    view::Look look = asked.look;
    const Subject subject = open(o, asked);
    const view::Viewport each =
        look.stereo == view::Stereo::sideBySide ? view::Viewport{std::max(1, size.width / 2), size.height} : size;
    view::Moment moment = subject.moment;
    const view::Camera camera = cameraFor(asked, subject, each, o.mirror, moment.mirror);
    look.eyeSeparationMm = camera.distanceMm() / 20.0;
    look.bur = look.turbine = subject.bur != nullptr && !o.noBur;
    moment.burShown = look.bur;

    view::Renderer renderer;
    if (subject.live) {
        renderer.setTooth(subject.bounds);
        renderer.updateBricks(subject.live->uncutSurface(), true);
        if (look.removedDepthColours) subject.live->wantRemovedDepths(true);
        subject.live->settle();
        renderer.updateBricks(subject.live->takeNews());
        renderer.setParts(subject.parts);
        if (!o.noScenery) {
            renderer.setOthers(subject.others);
            renderer.setScenery(subject.scenery);
        }
        renderer.setGingivaCuts(subject.live->gingiva().all(), subject.down);
    } else {
        renderer.setMesh(subject.mesh.mesh, cases::Tissue::enamel, subject.mesh.colours);
    }
    if (subject.bur) {
        renderer.setBur(subject.bur->mesh(), subject.bur->lengthMm(), subject.bur->maxRadiusMm(), subject.finish);
        renderer.setTurbine(instrument::turbineMesh());
    }
    if (asked.section) {
        look.cutAway = planeOf(*asked.section, subject.bounds, camera);
        const measure::Section section = subject.live->withProbe([&](const measure::ToothProbe& probe) {
            return probe.section(look.cutAway->normal, look.cutAway->offsetMm, kSectionPixelMm);
        });
        renderer.setSectionFace({*look.cutAway, section.originMm, section.uAxis, section.vAxis, section.mmPerPixel,
                                 section.width, section.height, section.tissue, section.away});
    }
    view::Image image;
    constexpr int kMaxDrawings = 5;  // until it no longer gets finer
    for (int i = 0; i < kMaxDrawings; ++i)
        if (!renderer.draw(camera, size, look, moment, image).refining) break;
    view::writePng(image, o.out);
    fmt::print("{}: {} x {} pixels, drawn by {}\n", o.out, image.width, image.height, renderer.description());
}

}  // namespace

void addPictureCommand(Command& app) {
    Command command = app.subcommand("picture", "A tooth, an attempt or a moment of a session as a PNG");
    const auto options = std::make_shared<PictureOptions>();
    PictureOptions& o = *options;
    command.option("what", o.what, "case, attempt, session (.h5) or mesh (.stl, .ply, .obj)").required();
    command.option("--out", o.out, "picture to write (.png)").required();
    std::string views;
    for (const auto& [view, name] : view::standardViews())
        views += (views.empty() ? "" : ", ") + std::string(name);
    command.option("--view", o.view, "from where: " + views).showDefault();
    command.option("--eye", o.eye, "X,Y,Z of the eye instead [mm, tooth frame]");
    command.option("--target", o.target, "X,Y,Z that it looks at [default: the middle of the tooth]");
    command.option("--position", o.position,
                   "as the operator sees it who sits there: 8 to 12 o'clock, 1 to 4 left-handed");
    command.option("--size", o.size, "WIDTHxHEIGHT in pixels, 16 to 8192 a side").showDefault();
    command.option("--at", o.atS, "second of the session [default: its end]");
    command.option("--look", o.look, "now, before (any cut), ghost (what was cut away as glass), removed-depth")
        .showDefault();
    command.option("--section", o.section,
                   "cut open: x, y or z through the middle, or NX,NY,NZ,OFFSET (what lies beyond goes)");
    command.flag("--grid", o.grid, "millimetre lines on the section");
    command.option("--hide", o.hide, "tissues not to show, by name").delimiter(',');
    command.flag("--no-scenery", o.noScenery, "without other teeth, gingiva and bone");
    command.flag("--no-scan-colours", o.noScanColours,
                 "tissues as they are drawn, not as an intraoral scanner saw them");
    command.flag("--cheeks", o.cheeks, "with the lips and cheeks of the case; else they are held aside");
    command.option("--bur", o.bur.name, "this bur in its handpiece, resting on the middle of the crown");
    addLengthUnit(command, "--bur-unit", o.bur.unit, "unit of a bur that is a mesh file");
    addUnitOptions(command, o.unit, false);
    command.flag("--no-bur", o.noBur, "without the session's bur");
    command.flag("--mirror", o.mirror, "with a mouth mirror that shows the side one does not see");
    command.flag("--arrows", o.arrows, "contact and force (2 mm a newton) as arrows");
    command.flag("--scale-bar", o.scaleBar, "5 mm in steps of 1 mm, at the depth of the target");
    command.option("--palette", o.palette, "natural, textbook, colour-safe").showDefault();
    command.option("--quality", o.quality, "fast, fine, rich").showDefault();
    command.option("--stereo", o.stereo, "none, side-by-side, anaglyph (red-cyan)").showDefault();
    command.option("--voxel", o.voxelUm, "voxel of a case's distance field [um], 10 to 400").showDefault();
    command.flag("--no-cache", o.noCache, "build the field anew and keep nothing");
    command.option("--threads", o.threads, "threads for long work; 0: all cores")
        .check(range(std::size_t{0}, std::size_t{1024}))
        .showDefault();
    command.footer(
        "No display is needed. The same input gives the same picture on the same machine.\n"
        "Examples:\n  handpiece picture molar --view occlusal --out molar.png\n"
        "  handpiece picture out/attempt --section y --grid --scale-bar --out section.png\n"
        "  handpiece picture out/session.h5 --at 12.5 --arrows --out moment.png");
    command.callback([options, command] {
        options->atGiven = command.isGiven("--at");
        picture(*options);
    });
}

}  // namespace handpiece::cli
