// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/stl.h>

#include "handpiece/base/core/error.h"
#include "handpiece/model/dentition/mouth.h"
#include "handpiece/model/lesion/lesion.h"
#include "python/arrays.h"
#include "python/bind.h"
#include "python/long_work.h"
#include "studies/made_tooth.h"

namespace handpiece::python {
namespace {

/// A surface of a case, which it keeps alive.
struct Part {
    std::string name, tissue;
    int priority;
    Mesh mesh;
};

Mesh meshIn(const std::shared_ptr<const cases::Case>& owner, const geometry::TriangleMesh& mesh,
            const geometry::VertexColours& colours) {
    return {{owner, &mesh}, {owner, &colours}};
}

std::vector<Part> partsOf(const std::shared_ptr<const cases::Case>& owner, const std::vector<cases::Part>& parts) {
    std::vector<Part> all;
    for (const cases::Part& part : parts)
        all.push_back({part.name, std::string(cases::properties(part.tissue).name), part.priority,
                       meshIn(owner, part.mesh, part.colours)});
    return all;
}

/// A tooth that stands around the one worked on.
struct Standing {
    std::string name;
    int fdi;
    bool isCuttable;
    std::array<double, 7> pose;
    Mesh outer;
};

std::vector<Standing> othersOf(const Case& c) {
    std::vector<Standing> all;
    for (const cases::PlacedTooth& t : c.it->others) {
        const core::Vec3& p = t.inCase.positionMm;
        const core::Quat& q = t.inCase.orientation;
        all.push_back({t.name,
                       t.fdiNumber,
                       t.isCuttable,
                       {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()},
                       meshIn(c.it, t.surface(), t.surfaceColours())});
    }
    return all;
}

Case caseOf(cases::Case made, std::string path = {}) {
    return {std::make_shared<const cases::Case>(std::move(made)), std::move(path)};
}

Case makeTooth(const std::string& kind, int fdi, std::uint64_t seed, double ageYears, std::size_t faces,
               std::size_t partFaces, bool scene, const std::string& lesions, const py::object& progress) {
    if (fdi != 0 && scene)
        throw core::Error("a tooth by its number comes without a scene", "scene", "leave one of fdi and scene out");
    LongWork work(progress);
    return work.run([&] {
        const std::vector<lesion::Lesion> wanted = lesion::lesionsByName(lesions);
        const core::Progress told = work.listener();
        const core::Progress making = core::part(told, 0.0, wanted.empty() ? 1.0 : 0.7);
        cases::Case made = studies::makeTooth({kind, fdi, {seed, ageYears}, {faces, partFaces, scene}}, making);
        studies::replaceLesions(made, wanted, seed, core::part(told, 0.7, 1.0));
        return caseOf(std::move(made));
    });
}

Case makeMouth(int fdi, std::uint64_t seed, double ageYears, std::size_t faces, double openingMm,
               const std::string& lesions, const py::object& progress) {
    LongWork work(progress);
    return work.run([&] {
        const lesion::MouthLesions wanted = lesion::mouthLesionsByName(lesions);
        dentition::MouthOptions mouth;
        mouth.fdi = fdi;
        mouth.faces = faces;
        mouth.openingMm = openingMm;
        cases::Case made = dentition::makeMouth({seed, ageYears}, mouth, core::part(work.listener(), 0.0, 0.9));
        lesion::addLesions(made, wanted, {.seed = seed}, core::part(work.listener(), 0.9, 1.0));
        return caseOf(std::move(made));
    });
}

Case readCase(const py::object& path) {
    const std::string file = pathFrom(path);
    const py::gil_scoped_release released;
    return caseOf(cases::readCase(file), file);
}

py::list landmarksOf(const Case& c) {
    py::list all;
    for (const cases::Landmark& mark : c.it->landmarks) {
        std::vector<double> numbers;
        for (const core::Vec3& p : mark.pointsMm)
            numbers.insert(numbers.end(), p.data(), p.data() + 3);
        const auto n = static_cast<py::ssize_t>(mark.pointsMm.size());
        all.append(py::make_tuple(std::string(cases::kLandmarkKinds[static_cast<std::size_t>(mark.kind)]), mark.name,
                                  arrayOf(std::move(numbers), {n, 3})));
    }
    return all;
}

}  // namespace

void bindCase(py::module_& module) {
    py::class_<Part>(module, "Part", "One closed surface of a case and what it is made of.")
        .def_readonly("name", &Part::name, "Of the part.")
        .def_readonly("tissue", &Part::tissue, "One of TISSUES.")
        .def_readonly("priority", &Part::priority, "Where parts overlap the higher wins.")
        .def_readonly("mesh", &Part::mesh, "Its surface; keeps the case alive, copies nothing.");
    py::class_<Standing>(module, "StandingTooth", "A tooth that stands around the one worked on.")
        .def_readonly("name", &Standing::name, "As the case names it.")
        .def_readonly("fdi", &Standing::fdi, "Its number, 11 to 48; 0 where it is unknown.")
        .def_readonly("cuttable", &Standing::isCuttable, "False: the bur is only held off by it.")
        .def_property_readonly(
            "pose", [](const Standing& s) { return arrayOf(std::vector<double>(s.pose.begin(), s.pose.end()), {7}); },
            "Its frame in the case's: x, y, z [mm], qw, qx, qy, qz; (7,) float64, a copy.")
        .def_readonly("outer", &Standing::outer, "Its surface, in its own frame.");
    py::class_<Case>(module, "Case",
                     "A tooth as files hold it: surfaces [mm], tissues, and what stands around it. Never changes.\n\n"
                     "The tooth's frame is +z occlusal, +x mesial, +y completes the right hand. Made by make_tooth, "
                     "make_mouth, read_case.")
        .def_property_readonly(
            "name", [](const Case& c) { return c.it->name; }, "For people.")
        .def_property_readonly(
            "kind", [](const Case& c) { return c.it->kind; }, "As \"lower-first-molar\"; may be \"\".")
        .def_property_readonly(
            "fdi", [](const Case& c) { return c.it->fdiNumber; }, "Number of the tooth; 0: unknown.")
        .def_property_readonly(
            "path", [](const Case& c) { return c.path.empty() ? py::object(py::none()) : py::str(c.path); },
            "Of the file that it was read from; None of one that was made.")
        .def_property_readonly(
            "outer", [](const Case& c) { return meshIn(c.it, c.it->surface(), c.it->surfaceColours()); },
            "The whole tooth as one closed surface.")
        .def_property_readonly(
            "parts", [](const Case& c) { return partsOf(c.it, c.it->parts); }, "A surface for each tissue.")
        .def_property_readonly(
            "scenery", [](const Case& c) { return partsOf(c.it, c.it->scenery); }, "Gingiva, bone, what is only seen.")
        .def_property_readonly("others", &othersOf, "Teeth that stand around it.")
        .def_property_readonly("landmarks", &landmarksOf,
                               "Places that dentists name: tuples (kind, name, points), points (n, 3) [mm].")
        .def(
            "write",
            [](const Case& c, const py::object& path) {
                const std::string file = pathFrom(path);
                const py::gil_scoped_release released;
                cases::writeCase(*c.it, file);
            },
            py::arg("path"), "Write a folder, or one .handpiece file; whole or not at all. STL rounds to float32.")
        .def("__repr__", [](const Case& c) {
            return fmt::format("<handpiece.Case: {}, {} faces>", c.it->name, c.it->surface().triangles.size());
        });
    module.def("make_tooth", &makeTooth, py::arg("kind") = "lower-first-molar", py::kw_only(), py::arg("fdi") = 0,
               py::arg("seed") = 1, py::arg("age_years") = 25.0, py::arg("faces") = 68150, py::arg("part_faces") = 0,
               py::arg("scene") = false, py::arg("lesions") = "", py::arg("progress") = py::none(),
               "Make a tooth, as `handpiece make tooth` does: the same bytes for the same request.\n\n"
               "Parameters\n----------\n"
               "kind : str\n    lower-first-molar, upper-incisor or upper-premolar.\n"
               "fdi : int\n    Instead of a kind: a permanent tooth by its number, 11 to 48.\n"
               "seed : int\n    With fdi or lesions: whose tooth. 0: the average of all.\n"
               "age_years : float\n    With fdi: wear and the pulp's size.\n"
               "faces, part_faces : int\n    Triangles of the outer surface, and of each tissue's (0: by the outer).\n"
               "scene : bool\n    Also adjacent teeth, gingiva and bone; not with fdi.\n"
               "lesions : str\n    SURFACE:DEPTH,... instead of the tooth's own lesion.\n"
               "progress : callable, optional\n    Hears the fraction done; False from it cancels.\n\n"
               "Returns\n-------\nCase\n\nRaises\n------\nError\n    Names and numbers there are not; cancelled.");
    module.def("make_mouth", &makeMouth, py::arg("fdi") = 46, py::kw_only(), py::arg("seed") = 1,
               py::arg("age_years") = 25.0, py::arg("faces") = 70000, py::arg("opening_mm") = dentition::kOpeningMm,
               py::arg("lesions") = "", py::arg("progress") = py::none(),
               "Make a whole mouth, as `handpiece make mouth` does: 32 teeth, gingiva and bone. A minute or two.\n\n"
               "Parameters\n----------\n"
               "fdi : int\n    The tooth that is worked on: its frame is the case's.\n"
               "seed, age_years\n    Of the patient.\n"
               "faces : int\n    Of each tooth's outer surface.\n"
               "opening_mm : float\n    Between the incisal edges.\n"
               "lesions : str\n    FDI:SURFACE:DEPTH,...\n"
               "progress : callable, optional\n    Hears the fraction done; False from it cancels.\n\n"
               "Returns\n-------\nCase\n\nRaises\n------\nError");
    module.def("read_case", &readCase, py::arg("path"),
               "Read a case: a folder with case.toml, a .handpiece file, or a mesh file (mm).\n\n"
               "Returns\n-------\nCase\n\nRaises\n------\nError\n    No case, damaged, or not to be read.");
}

}  // namespace handpiece::python
