// SPDX-License-Identifier: Apache-2.0
#include "cli/inputs.h"
#include "cli/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/read_notes.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/tick/contact/hull/hull_method.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {

namespace fs = std::filesystem;

namespace {
constexpr std::size_t kMaxThreads = 1024;
}  // namespace

double MeshUnit::mmPerUnit() const {
    return scale * geometry::millimetresPer(geometry::unitByName(name));
}

geometry::TriangleMesh MeshUnit::read(const std::string& file, geometry::ReadNotes* notes) const {
    geometry::ReadNotes found;
    geometry::TriangleMesh mesh = geometry::readMesh(fs::path(file), &found);
    geometry::tellNotes(file, found);
    if (notes) *notes = std::move(found);
    return geometry::scaled(std::move(mesh), mmPerUnit());
}

geometry::ColouredMesh MeshUnit::readColoured(const std::string& file, geometry::ReadNotes* notes) const {
    geometry::ReadNotes found;
    geometry::ColouredMesh read = geometry::readColouredMesh(fs::path(file), &found);
    geometry::tellNotes(file, found);
    if (notes) *notes = std::move(found);
    read.mesh = geometry::scaled(std::move(read.mesh), mmPerUnit());
    return read;
}

void addLengthUnit(Command& command, const char* name, std::string& unit, const char* help) {
    command.option(name, unit, help).showDefault().check(oneOf({"mm", "cm", "m", "inch", "um"}));
}

void addUnitOptions(Command& command, MeshUnit& unit, bool withScale) {
    addLengthUnit(command, "--unit", unit.name, "unit of a mesh file: mm, cm, m, inch or um");
    if (!withScale) return;
    command.option("--scale", unit.scale, "multiplies the coordinates of a mesh file, besides its unit")
        .showDefault()
        .check(range(1e-9, 1e9));
}

cases::Case readToothOf(const ContactInputs& inputs) {
    cases::Case toothCase = cases::readCase(inputs.tooth);
    const double mm = inputs.unit.mmPerUnit();
    if (mm == 1.0) return toothCase;
    if (geometry::meshFormatOf(inputs.tooth) == geometry::MeshFormat::unknown)
        throw core::Error("a case is in millimetres", "--unit", "give a unit only for a mesh file");
    toothCase.outer = geometry::scaled(std::move(toothCase.outer), mm);
    for (cases::Part& part : toothCase.parts)
        part.mesh = geometry::scaled(std::move(part.mesh), mm);
    return toothCase;
}

void addContactOptions(Command& command, ContactInputs& inputs, const MethodRegistry& methods) {
    std::string names = "field (ours, the concave tooth), hull (the paper's convex hull)";
    for (const auto& [name, factory] : methods)
        names += ", " + name;
    command.option("--tooth,--case", inputs.tooth, "case folder, .handpiece file, or mesh file (.stl, .ply, .obj; mm)")
        .required()
        .typeName("PATH");
    addUnitOptions(command, inputs.unit, false);
    addBurOption(command, inputs.bur);
    command.option("--method", inputs.method, "contact method: " + names).showDefault();
    command.option("--voxel", inputs.voxelUm, "voxel of the distance field [um], 10 to 400").showDefault();
    command.flag("--no-cache", inputs.noCache, "build the field anew and keep nothing");
    command.option("--threads", inputs.threads, "threads for long work; 0: all cores").showDefault();
}

tooth::LoadSettings prepareSettingsOf(const ContactInputs& inputs) {
    // A count below zero arrives here as an enormous one.
    if (inputs.threads > kMaxThreads)
        throw core::Error("this many threads are not possible", "--threads", fmt::format("give 0 to {}", kMaxThreads));
    core::setThreadCount(inputs.threads);
    if (!(inputs.voxelUm >= 10.0 && inputs.voxelUm <= 400.0))
        throw core::Error(fmt::format("a voxel of {} um", inputs.voxelUm), "--voxel", "give 10 to 400 um");
    tooth::LoadSettings settings;
    settings.field = simulation::fieldSettingsAt(inputs.voxelUm * 1e-3);
    settings.useCache = !inputs.noCache;
    return settings;
}

std::shared_ptr<const tooth::ToothModel> loadTooth(const ContactInputs& inputs) {
    const tooth::LoadSettings settings = prepareSettingsOf(inputs);
    studies::ProgressBar bar("preparing the tooth");
    return tooth::loadModel(readToothOf(inputs), settings, bar.listener());
}

void addBurOption(Command& command, BurInput& bur) {
    command.option("--bur", bur.name, "bur by name (330, round-4, paper, cylinder-round:1.0x4.0) or mesh file")
        .showDefault();
    addLengthUnit(command, "--bur-unit", bur.unit, "unit of a bur that is a mesh file: mm, cm, m, inch or um");
}

double BurInput::mmPerUnit() const {
    return geometry::millimetresPer(geometry::unitByName(unit));
}

std::shared_ptr<const instrument::Bur> loadBur(const BurInput& bur) {
    return instrument::makeInstrument(bur.name, {}, {}, bur.mmPerUnit()).bur;
}

course::Made exerciseOf(const std::string& given) {
    studies::ProgressBar bar("making the exercise");
    course::Made made = course::openExercise(given, bar.listener());
    bar.finish();
    return made;
}

std::unique_ptr<contact::Method> makeMethod(const std::string& name, const MethodRegistry& extra,
                                            std::shared_ptr<const tooth::ToothModel> tooth,
                                            std::shared_ptr<const instrument::Bur> bur) {
    if (name == "field") return contact::makeFieldMethod(std::move(tooth), std::move(bur));
    if (name == "hull") return contact::makeHullMethod(tooth->outer, bur->mesh());
    if (const auto found = extra.find(name); found != extra.end())
        return found->second(std::move(tooth), std::move(bur));
    std::string names = "field, hull";
    for (const auto& [known, factory] : extra)
        names += ", " + known;
    throw core::Error(fmt::format("there is no contact method called \"{}\"", name), "--method",
                      "choose one of " + names);
}

}  // namespace handpiece::cli
