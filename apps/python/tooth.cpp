// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <filesystem>

#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/app/simulation/tissue_export.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/instrument/catalogue.h"
#include "python/arrays.h"
#include "python/bind.h"
#include "python/long_work.h"

namespace handpiece::python {
namespace {

constexpr double kLeastVoxelMm = 0.01, kMostVoxelMm = 0.4;
constexpr std::size_t kGrain = 1024;

Tooth prepare(const py::object& what, double voxelMm, bool cache, const py::object& progress) {
    if (!(voxelMm >= kLeastVoxelMm && voxelMm <= kMostVoxelMm))
        throw core::Error(fmt::format("a voxel of {} mm", voxelMm), "voxel_mm", "give 0.01 to 0.4 mm");
    tooth::LoadSettings settings;
    settings.field = simulation::fieldSettingsAt(voxelMm);
    LongWork work(progress);
    if (py::isinstance<Case>(what)) {
        const Case given = what.cast<Case>();
        // One that was made lies in no folder that a cache could stand beside.
        settings.useCache = cache && !given.path.empty();
        return work.run([&] { return Tooth{tooth::loadModel(*given.it, settings, work.listener()), {}}; });
    }
    settings.useCache = cache;
    const std::string path = pathFrom(what);
    return work.run([&] {
        const bool isSession = std::filesystem::path(path).extension() == ".h5";
        if (isSession || (core::isThere(path) && cases::isAttempt(path))) {
            const simulation::ToothOfFile found = simulation::toothOf(path, voxelMm, cache, work.listener());
            return cutTooth(found.base, found.state);
        }
        return Tooth{tooth::loadModel(cases::readCase(path), settings, work.listener()), {}};
    });
}

/// One number, or `width` of them, for each point, on all cores; the same bits however the points are shared.
template <class T, class Of>
py::array forEach(const std::vector<core::Vec3>& points, std::size_t width, const Of& of) {
    std::vector<T> out(points.size() * width);
    {
        const py::gil_scoped_release released;
        core::parallelFor(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                of(points[i], &out[i * width]);
        });
    }
    const auto n = static_cast<py::ssize_t>(points.size());
    return width == 1 ? arrayOf(std::move(out), {n}) : arrayOf(std::move(out), {n, static_cast<py::ssize_t>(width)});
}

py::array distances(const Field& f, const py::object& points) {
    return forEach<double>(pointsFrom(points, "points"), 1,
                           [&](const core::Vec3& p, double* out) { *out = f.of.field().distance(p); });
}

py::array normals(const Field& f, const py::object& points) {
    return forEach<double>(pointsFrom(points, "points"), 3, [&](const core::Vec3& p, double* out) {
        const core::Vec3 n = f.of.field().normal(p);
        std::copy(n.data(), n.data() + 3, out);
    });
}

py::array tissuesAt(const Field& f, const py::object& points) {
    return forEach<std::uint8_t>(pointsFrom(points, "points"), 1, [&](const core::Vec3& p, std::uint8_t* out) {
        *out = static_cast<std::uint8_t>(f.of.field().tissueAt(p));
    });
}

py::array exactDistances(const Tooth& t, const py::object& points) {
    if (t.cut)
        throw core::Error("a tooth that was cut has no exact surface", "distance", "ask its field, or the uncut tooth");
    return forEach<double>(pointsFrom(points, "points"), 1,
                           [&](const core::Vec3& p, double* out) { *out = t.model->tree.signedDistance(p); });
}

py::dict byTissue(const tooth::TissueVolumes& mm3) {
    py::dict all;
    for (std::size_t t = 1; t < mm3.size(); ++t)
        if (mm3[t] != 0.0) all[py::str(std::string(cases::properties(static_cast<cases::Tissue>(t)).name))] = mm3[t];
    return all;
}

void bindField(py::module_& module) {
    py::class_<Field>(module, "Field",
                      "Signed distances to a tooth [mm], negative inside: bricks of 9 x 9 x 9 nodes near the surface, "
                      "one value a brick elsewhere.\n\nA view: the tooth stays alive as long as this or one of its "
                      "arrays does, and never changes.")
        .def("distance", &distances, py::arg("points"),
             "Signed distance: trilinear where a brick is stored, elsewhere of the right sign and a lower bound.\n\n"
             "Parameters\n----------\npoints : array (n, 3)\n    Places in the tooth's frame [mm].\n\n"
             "Returns\n-------\narray (n,) of float64\n    [mm].\n\n"
             "Raises\n------\nTypeError, ValueError\n    Not (n, 3) finite numbers.\n\n"
             "Notes\n-----\nUses all cores, without Python's lock. Method: docs/contact.md.")
        .def("normal", &normals, py::arg("points"),
             "Unit gradient, out of the tooth; zero where no brick is stored.\n\n"
             "Returns\n-------\narray (n, 3) of float64")
        .def("tissue_at", &tissuesAt, py::arg("points"),
             "What lies there, as a number of TISSUES.\n\nReturns\n-------\narray (n,) of uint8")
        .def_property_readonly(
            "voxel_mm", [](const Field& f) { return f.of.field().settings().voxelMm; }, "Distance of nodes [mm].")
        .def_property_readonly(
            "origin_mm",
            [](const Field& f) {
                const core::Vec3& o = f.of.field().storage().originMm;
                return arrayOf(std::vector<double>{o.x(), o.y(), o.z()}, {3});
            },
            "Where node 0 of brick 0 lies, (3,) float64 [mm]: a copy.")
        .def_property_readonly(
            "bricks",
            [](const py::object& self) {
                const auto& s = self.cast<const Field&>().of.field().storage();
                const auto n = static_cast<py::ssize_t>(s.brickCount());
                return viewOf(s.values.data(), {n, field::kBrickNodes, field::kBrickNodes, field::kBrickNodes}, self);
            },
            "Values of the stored bricks, (n, 9, 9, 9) float32 [mm], indices brick, z, y, x: a view, read-only. "
            "Neighbours repeat the nodes of the face between them.")
        .def_property_readonly(
            "brick_index",
            [](const py::object& self) {
                const auto& s = self.cast<const Field&>().of.field().storage();
                return viewOf(s.brickIndex.data(), {s.bricks[2], s.bricks[1], s.bricks[0]}, self);
            },
            "Which stored brick lies where, (nz, ny, nx) int32, -1 for none: a view, read-only.")
        .def_property_readonly(
            "coarse",
            [](const py::object& self) {
                const auto& s = self.cast<const Field&>().of.field().storage();
                return viewOf(s.coarse.data(), {s.bricks[2], s.bricks[1], s.bricks[0]}, self);
            },
            "Distance at each brick's centre, (nz, ny, nx) float32 [mm]: a view, read-only.")
        .def("__repr__", [](const Field& f) {
            return fmt::format("<handpiece.Field: {} bricks, {} mm>", f.of.field().brickCount(),
                               f.of.field().settings().voxelMm);
        });
}

void bindBur(py::module_& module) {
    py::class_<Bur>(
        module, "Bur",
        "A bur: a solid of revolution, tip at the origin, shank along +z [mm]. Never changes.\n\n"
        "Parameters\n----------\nname : str or path\n"
        "    Of the catalogue (330, round-4), SHAPE:DIAMETERxLENGTH (cylinder-round:1.0x4.0), or a mesh file.\n"
        "mm_per_unit : float\n    Multiplies the coordinates of a mesh file.\n\n"
        "Raises\n------\nError\n    There is no such bur.")
        .def(py::init([](const py::object& name, double mmPerUnit) {
                 return Bur{instrument::makeInstrument(pathFrom(name), {}, {}, mmPerUnit).bur};
             }),
             py::arg("name"), py::arg("mm_per_unit") = 1.0)
        .def_property_readonly(
            "name", [](const Bur& b) { return b.bur->name(); }, "As it was named.")
        .def_property_readonly(
            "length_mm", [](const Bur& b) { return b.bur->lengthMm(); }, "Of the head [mm].")
        .def_property_readonly(
            "max_radius_mm", [](const Bur& b) { return b.bur->maxRadiusMm(); }, "[mm].")
        .def_property_readonly(
            "mesh",
            [](const Bur& b) { return Mesh{std::shared_ptr<const geometry::TriangleMesh>(b.bur, &b.bur->mesh())}; },
            "What the hull method and the eye see; keeps the bur alive, copies nothing.")
        .def(
            "distance",
            [](const Bur& b, const py::object& points) {
                return forEach<double>(pointsFrom(points, "points"), 1,
                                       [&](const core::Vec3& p, double* out) { *out = b.bur->signedDistance(p); });
            },
            py::arg("points"),
            "Signed distance to the solid, negative inside.\n\n"
            "Parameters\n----------\npoints : array (n, 3)\n    In the bur's frame [mm].\n\n"
            "Returns\n-------\narray (n,) of float64\n    [mm].")
        .def("__repr__", [](const Bur& b) { return "<handpiece.Bur: " + b.bur->name() + ">"; });
    std::vector<std::string> names;
    for (const instrument::CatalogueEntry& entry : instrument::catalogue())
        names.push_back(entry.name);
    module.attr("BURS") = py::tuple(py::cast(names));
}

}  // namespace

Tooth cutTooth(std::shared_ptr<const tooth::ToothModel> model, const tooth::StateDelta& state) {
    const auto cut = std::make_shared<tooth::ToothState>(model);
    (void)cut->restore(state, 0, state.bricks.size());
    return {std::move(model), cut};
}

Bur burFrom(const py::object& bur) {
    if (py::isinstance<Bur>(bur)) return bur.cast<Bur>();
    return {instrument::makeInstrument(pathFrom(bur)).bur};
}

void bindTooth(py::module_& module) {
    bindField(module);
    bindBur(module);
    py::class_<Tooth>(
        module, "Tooth",
        "A tooth that can be felt: surface, distances, tissues. Never changes; share it as you like. Made "
        "by prepare.")
        .def_property_readonly(
            "name", [](const Tooth& t) { return t.model->name; }, "For people.")
        .def_property_readonly(
            "is_cut", [](const Tooth& t) { return t.cut != nullptr; }, "True of one out of a session or an attempt.")
        .def_property_readonly(
            "outer",
            [](const Tooth& t) {
                return Mesh{std::shared_ptr<const geometry::TriangleMesh>(t.model, &t.model->outer)};
            },
            "Its surface before any cut; keeps the tooth alive, copies nothing.")
        .def_property_readonly(
            "field", [](const Tooth& t) { return Field{t}; }, "Its signed distances, as it is now.")
        .def_property_readonly(
            "volumes_mm3", [](const Tooth& t) { return byTissue(t.cut ? t.cut->volumesMm3() : t.model->volumesMm3); },
            "What there is of each tissue [mm3]: a dict by name.")
        .def_property_readonly(
            "state_hash", [](const Tooth& t) { return fmt::format("{:016x}", t.cut ? t.cut->stateHash() : 0); },
            "Of what was cut, as `handpiece run` tells it; zeros of a tooth that was not.")
        .def_property_readonly(
            "from_cache", [](const Tooth& t) { return t.model->fromCache; },
            "True where its distances were computed before.")
        .def("distance", &exactDistances, py::arg("points"),
             "Signed distance to the triangles of the uncut surface, exact, negative inside.\n\n"
             "Parameters\n----------\npoints : array (n, 3)\n    In the tooth's frame [mm].\n\n"
             "Returns\n-------\narray (n,) of float64\n    [mm].\n\n"
             "Raises\n------\nError\n    The tooth was cut.\n\n"
             "Notes\n-----\nSign by angle-weighted pseudonormals (Baerentzen & Aanaes 2005). All cores.")
        .def("__repr__", [](const Tooth& t) {
            return fmt::format("<handpiece.Tooth: {}{}, {} mm>", t.model->name, t.cut ? ", cut" : "",
                               t.field().settings().voxelMm);
        });
    module.def(
        "prepare", &prepare, py::arg("what"), py::arg("voxel_mm") = 0.05, py::kw_only(), py::arg("cache") = true,
        py::arg("progress") = py::none(),
        "Make a tooth ready to be felt: its distance field and tissues, on all cores.\n\n"
        "Parameters\n----------\n"
        "what : Case or path\n    A case or its path; or an attempt or a session (.h5): the tooth as it was cut, "
        "which has a voxel of its own.\n"
        "voxel_mm : float\n    Of the field, 0.01 to 0.4 [mm].\n"
        "cache : bool\n    Of what was read from a file: keep the field beside it, and use one that is there.\n"
        "progress : callable, optional\n    Hears the fraction done; False from it cancels.\n\n"
        "Returns\n-------\nTooth\n\n"
        "Raises\n------\nError\n    A surface that cannot be felt, a voxel out of range, cancelled.\n\n"
        "Notes\n-----\nThe same bits at any number of threads.");
}

}  // namespace handpiece::python
