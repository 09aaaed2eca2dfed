// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The module's parts, one a source, and what they hand to each other. Everything shared is immutable once made.

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "handpiece/model/case/case.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/tooth/tooth_state.h"

namespace handpiece::python {

namespace py = pybind11;

// pybind11 holds no shared_ptr to const, so each of these holds one.

struct Mesh {
    std::shared_ptr<const geometry::TriangleMesh> mesh;
    std::shared_ptr<const geometry::VertexColours> colours{};  ///< one a vertex; null or empty: it has none
    [[nodiscard]] bool hasColours() const { return colours && !colours->empty(); }
};
struct Case {
    std::shared_ptr<const cases::Case> it;
    std::string path;  ///< of its file; empty: it has none
};
/// A prepared tooth; with `cut`, as it was cut.
struct Tooth {
    std::shared_ptr<const tooth::ToothModel> model;
    std::shared_ptr<const tooth::ToothState> cut{};
    [[nodiscard]] const field::DistanceField& field() const { return cut ? cut->field() : model->field; }
};
/// Of the state that a file holds.
[[nodiscard]] Tooth cutTooth(std::shared_ptr<const tooth::ToothModel> model, const tooth::StateDelta& state);
struct Field {
    Tooth of;
};
struct Bur {
    std::shared_ptr<const instrument::Bur> bur;
};

/// Of a name, a mesh's file, or a Bur. Throws core::Error, TypeError.
[[nodiscard]] Bur burFrom(const py::object& bur);
/// A case's, a session's or an attempt's path as os.fspath gives it. Throws TypeError.
[[nodiscard]] std::string pathFrom(const py::object& path);
/// JSON text as dictionaries and lists.
[[nodiscard]] py::object fromJson(const std::string& text);

void bindMesh(py::module_& module);
void bindCase(py::module_& module);
void bindTooth(py::module_& module);
void bindContact(py::module_& module);
void bindRun(py::module_& module);
void bindSession(py::module_& module);
void bindScore(py::module_& module);

}  // namespace handpiece::python
