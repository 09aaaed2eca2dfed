// SPDX-License-Identifier: Apache-2.0
// The module handpiece._core: what the package `handpiece` is made of.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/simd.h"
#include "python/bind.h"

namespace handpiece::python {
namespace {

constexpr std::size_t kMaxThreads = 1024;

void setThreads(std::size_t threads) {
    if (threads > kMaxThreads) throw core::Error("this many threads are not possible", "set_threads", "give 0 to 1024");
    core::setThreadCount(threads);
}

/// core::Error as handpiece.Error, with its parts.
void translate(std::exception_ptr thrown) {
    try {
        if (thrown) std::rethrow_exception(thrown);
    } catch (const core::Error& e) {
        const py::object type = py::module_::import("handpiece._error").attr("Error");
        const py::object error = type(e.problem(), e.where(), e.remedy(), e.id(), py::tuple(py::cast(e.arguments())));
        PyErr_SetObject(type.ptr(), error.ptr());
    }
}

/// pybind11 would lend memory that nobody filled to an object whose __init__ was never called.
void refuseUnmade(const py::module_& module) {
    for (const auto& [name, value] : module.attr("__dict__").cast<py::dict>())
        if (PyType_Check(value.ptr()))
            if (auto* info = py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(value.ptr())))
                info->operator_new = [](std::size_t) -> void* {
                    throw py::type_error("this object was never made: its __init__ was not called");
                };
}

}  // namespace

py::object fromJson(const std::string& text) {
    return py::module_::import("json").attr("loads")(text);
}

std::string pathFrom(const py::object& path) {
    return py::module_::import("os").attr("fsdecode")(path).cast<std::string>();
}

}  // namespace handpiece::python

PYBIND11_MODULE(_core, module) {
    using namespace handpiece::python;
    module.doc() = "What the package handpiece is made of; import that.";
    py::register_exception_translator(translate);
    py::options options;
    options.enable_function_signatures();
    py::tuple tissues(handpiece::cases::kTissueCount);
    for (std::size_t t = 0; t < tissues.size(); ++t)
        tissues[t] = std::string(handpiece::cases::properties(static_cast<handpiece::cases::Tissue>(t)).name);
    module.attr("TISSUES") = tissues;
    module.attr("__version__") = HANDPIECE_VERSION;
    module.def("set_threads", setThreads, py::arg("threads"),
               "Limit long work to so many threads, in the whole process; 0: all cores.\n\n"
               "Results are the same, bit for bit, whatever the number.");
    module.def("threads", handpiece::core::threadCount, "Threads that long work may use.");
    bindMesh(module);
    bindCase(module);
    bindTooth(module);
    bindContact(module);
    bindRun(module);
    bindSession(module);
    bindScore(module);
    refuseUnmade(module);
}
