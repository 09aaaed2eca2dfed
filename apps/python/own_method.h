// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Contact methods: ours by their names, and one written in Python for whoever calls a contact::Method.

#include <pybind11/pybind11.h>

#include <exception>
#include <memory>
#include <string>

#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "handpiece/tick/contact/method.h"

namespace handpiece::python {

namespace py = pybind11;

/// What Python threw in a tick, which cannot throw: told afterwards. Touch with Python's lock held.
struct OwnProblem {
    std::exception_ptr thrown;
    void rethrow() {
        if (thrown) std::rethrow_exception(std::exchange(thrown, {}));
    }
};

/// Asks `own.depth(pose)` with Python's lock; after the first failure it answers that the pose is invalid, which holds
/// the force at zero. `withNormal`: a depth alone will not do. Throws TypeError where there is nothing to call.
[[nodiscard]] std::unique_ptr<contact::Method> makeOwnMethod(const py::object& own, bool withNormal,
                                                             std::shared_ptr<OwnProblem> problem);
/// "field" or "hull", of an uncut tooth. Throws core::Error for a name there is not.
[[nodiscard]] std::unique_ptr<contact::Method> makeMethod(const std::string& name,
                                                          const std::shared_ptr<const tooth::ToothModel>& tooth,
                                                          const std::shared_ptr<const instrument::Bur>& bur);
/// As makeMethod() does, before there is a tooth.
void requireMethod(const std::string& name);
/// What it calls itself: its attribute `name`, or its class.
[[nodiscard]] std::string nameOfOwn(const py::object& own);

}  // namespace handpiece::python
