// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "handpiece/app/scan_case/textures.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/geometry/repair.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "python/arrays.h"
#include "python/bind.h"
#include "python/long_work.h"
#include "studies/told_json.h"

namespace handpiece::python {
namespace {

Mesh meshOf(geometry::TriangleMesh mesh, geometry::VertexColours colours = {}) {
    return {std::make_shared<const geometry::TriangleMesh>(std::move(mesh)),
            std::make_shared<const geometry::VertexColours>(std::move(colours))};
}

Mesh makeMesh(const py::object& vertices, const py::object& faces) {
    geometry::TriangleMesh mesh;
    mesh.vertices = pointsFrom(vertices, "vertices");
    const py::array given = py::array::ensure(faces);
    if (!given) PyErr_Clear();
    if (!given || (given.dtype().kind() != 'i' && given.dtype().kind() != 'u'))
        throw py::type_error("faces must be an array of whole numbers");
    if (given.ndim() != 2 || given.shape(1) != 3) throw py::value_error("faces must have the shape (n, 3)");
    const py::array_t<long long, kDense> numbers(given);
    mesh.triangles.resize(static_cast<std::size_t>(numbers.shape(0)));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const long long vertex = numbers.data()[3 * i + k];
            if (vertex < 0 || vertex >= static_cast<long long>(mesh.vertices.size()))
                throw py::value_error(
                    fmt::format("faces[{}] names the vertex {}, and there are {}", i, vertex, mesh.vertices.size()));
            mesh.triangles[i][k] = static_cast<std::uint32_t>(vertex);
        }
    return meshOf(std::move(mesh));
}

double millimetresOf(const std::string& unit) {
    const double mm = geometry::millimetresPer(geometry::unitByName(unit));
    if (mm == 0.0) throw core::Error("there is no unit called \"" + unit + "\"", "unit", "give mm, cm, m, inch or um");
    return mm;
}

Mesh readMesh(const py::object& path, const std::string& unit) {
    const std::string file = pathFrom(path);
    const double mm = millimetresOf(unit);
    geometry::ReadNotes notes;
    Mesh mesh;
    {
        const py::gil_scoped_release released;
        geometry::ColouredMesh read = geometry::readColouredMesh(file, &notes);
        mesh = meshOf(geometry::scaled(std::move(read.mesh), mm), std::move(read.colours));
    }
    for (const std::string& note : notes)
        if (PyErr_WarnEx(PyExc_UserWarning, (file + ": " + note).c_str(), 1) != 0) throw py::error_already_set();
    return mesh;
}

py::object inspectMesh(const Mesh& mesh) {
    std::string text;
    {
        const py::gil_scoped_release released;
        nlohmann::ordered_json json = studies::toJson(geometry::inspect(*mesh.mesh));
        json["crossing_faces"] = geometry::selfIntersections(*mesh.mesh).size();
        text = json.dump();
    }
    return fromJson(text);
}

py::tuple repairMesh(const Mesh& mesh, std::optional<double> weldMm, bool keepDebris, bool base,
                     std::optional<double> baseDepthMm) {
    if (weldMm && !(*weldMm >= 0.0)) throw core::Error("a welding distance below zero", "weld_mm", "give 0 or more");
    if (baseDepthMm && !(*baseDepthMm > 0.0))
        throw core::Error("a base has a depth", "base_depth_mm", "give more than 0, or leave it out");
    Mesh mended;
    std::string text;
    {
        const py::gil_scoped_release released;
        geometry::TriangleMesh work = *mesh.mesh;
        geometry::RepairSettings settings;
        if (weldMm) settings.weldMm = *weldMm;
        if (keepDebris) settings.debrisAreaShare = 0.0;
        settings.base = base || baseDepthMm;
        if (baseDepthMm) settings.baseDepthMm = *baseDepthMm;
        text = studies::toJson(geometry::repair(work, settings)).dump();
        geometry::VertexColours colours;
        if (mesh.hasColours()) colours = geometry::coloursFrom(*mesh.mesh, *mesh.colours, work);
        mended = meshOf(std::move(work), std::move(colours));
    }
    return py::make_tuple(mended, fromJson(text));
}

}  // namespace

void bindMesh(py::module_& module) {
    static_assert(sizeof(core::Vec3) == 3 * sizeof(double) && sizeof(geometry::Triangle) == 12 &&
                  sizeof(geometry::Colour) == 3);
    scan_case::readTextures();
    py::class_<Mesh>(module, "Mesh",
                     "A triangle mesh [mm], counter-clockwise from outside. Never changes.\n\n"
                     "Mesh(vertices, faces) copies what it is given.\n\n"
                     "Parameters\n----------\n"
                     "vertices : array (n, 3) of float\n    Places [mm].\n"
                     "faces : array (m, 3) of int\n    Numbers of vertices.\n\n"
                     "Raises\n------\n"
                     "ValueError\n    Wrong shape, a vertex that is not finite, a face that names none.\n"
                     "TypeError\n    Not numbers.")
        .def(py::init(&makeMesh), py::arg("vertices"), py::arg("faces"))
        .def_property_readonly(
            "vertices",
            [](const py::object& self) {
                const auto& v = self.cast<const Mesh&>().mesh->vertices;
                return viewOf(reinterpret_cast<const double*>(v.data()), {static_cast<py::ssize_t>(v.size()), 3}, self);
            },
            "Places [mm], (n, 3) float64: a view, read-only.")
        .def_property_readonly(
            "faces",
            [](const py::object& self) {
                const auto& f = self.cast<const Mesh&>().mesh->triangles;
                return viewOf(reinterpret_cast<const std::uint32_t*>(f.data()), {static_cast<py::ssize_t>(f.size()), 3},
                              self);
            },
            "Numbers of vertices, (m, 3) uint32: a view, read-only.")
        .def_property_readonly(
            "colours",
            [](const py::object& self) -> py::object {
                const auto& mesh = self.cast<const Mesh&>();
                if (!mesh.hasColours()) return py::none();
                return viewOf(reinterpret_cast<const std::uint8_t*>(mesh.colours->data()),
                              {static_cast<py::ssize_t>(mesh.colours->size()), 3}, self);
            },
            "Red, green and blue of each vertex as a scanner saw it, (n, 3) uint8, sRGB: a view, read-only. None of a "
            "mesh without.")
        .def_property_readonly(
            "area_mm2", [](const Mesh& m) { return geometry::surfaceAreaMm2(*m.mesh); }, "Of all faces.")
        .def_property_readonly(
            "volume_mm3", [](const Mesh& m) { return geometry::enclosedVolumeMm3(*m.mesh); },
            "Enclosed; means something only of a closed mesh that faces outwards.")
        .def("inspect", &inspectMesh,
             "Counts, sizes and flaws.\n\nReturns\n-------\ndict\n"
             "    As `handpiece mesh info --json` tells: closed, oriented, open_edges, volume_mm3, crossing_faces, ...")
        .def("repair", &repairMesh, py::arg("weld_mm") = py::none(), py::arg("keep_debris") = false,
             py::arg("base") = false, py::arg("base_depth_mm") = py::none(),
             "Mend: weld, close holes, orient, drop debris. This mesh stays as it is; colours go with its surface.\n\n"
             "Parameters\n----------\n"
             "weld_mm : float, optional\n    Vertices nearer than this become one [mm]; 1e-5 of the diagonal if None.\n"
             "keep_debris : bool\n    Keep shells of less than 1 % of the largest one's area.\n"
             "base : bool\n    Stand the border of an open scan on a flat base.\n"
             "base_depth_mm : float, optional\n    From the border's lowest place to the floor, with a base [mm]; by "
             "the "
             "scan's size if None.\n\n"
             "Returns\n-------\n(Mesh, dict)\n    What was made, and what was done, as `handpiece mesh repair --json` "
             "tells.\n\n"
             "Raises\n------\nError\n    Too much would be lost, or nothing is left.")
        .def(
            "write",
            [](const Mesh& mesh, const py::object& path) {
                const std::string file = pathFrom(path);
                const py::gil_scoped_release released;
                geometry::writeMesh(file, *mesh.mesh, mesh.hasColours() ? *mesh.colours : geometry::VertexColours());
            },
            py::arg("path"),
            "Write a .stl (float32, without colours) or a .ply (nothing is lost), whole or not at all.")
        .def("__repr__", [](const Mesh& m) {
            return fmt::format("<handpiece.Mesh: {} vertices, {} faces>", m.mesh->vertices.size(),
                               m.mesh->triangles.size());
        });
    module.def("read_mesh", &readMesh, py::arg("path"), py::arg("unit") = "mm",
               "Read a STL, PLY or OBJ file; its colours too, at its vertices or in the pictures beside an OBJ.\n\n"
               "Parameters\n----------\npath : path\nunit : str\n    Of the file: mm, cm, m, inch or um.\n\n"
               "Returns\n-------\nMesh\n\nRaises\n------\nError\n    No mesh, damaged, or not to be read.\n\n"
               "Warns\n-----\nUserWarning\n    Something was left out of the file.");
}

}  // namespace handpiece::python
