// SPDX-License-Identifier: Apache-2.0
#include "python/own_method.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/contact/hull/hull_method.h"
#include "python/arrays.h"

namespace handpiece::python {
namespace {

class OwnMethod final : public contact::Method {
  public:
    OwnMethod(const py::object& own, bool withNormal, std::shared_ptr<OwnProblem> problem)
        : name_(nameOfOwn(own)), depth_(own.attr("depth")), withNormal_(withNormal), problem_(std::move(problem)) {}
    OwnMethod(const OwnMethod&) = delete;
    OwnMethod& operator=(const OwnMethod&) = delete;
    ~OwnMethod() override {
        const py::gil_scoped_acquire acquired;
        depth_ = {};
    }

    [[nodiscard]] const char* name() const noexcept override { return name_.c_str(); }

    [[nodiscard]] contact::Depth depth(const core::Pose& pose) noexcept override {
        contact::Depth none;
        none.status = contact::Status::invalidPose;
        if (!pose.isValid()) return none;
        const py::gil_scoped_acquire acquired;
        if (problem_->thrown) return none;
        try {
            return ask(pose);
        } catch (...) {
            problem_->thrown = std::current_exception();
            return none;
        }
    }

  private:
    contact::Depth ask(const core::Pose& pose) const {
        const core::Vec3& p = pose.positionMm;
        const core::Quat& q = pose.orientation;
        const py::object answer =
            depth_(arrayOf(std::vector<double>{p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()}, {7}));
        contact::Depth result;
        result.tissue = cases::Tissue::enamel;
        result.status = contact::Status::ok;
        if (!py::isinstance<py::tuple>(answer)) {
            result.depthMm = number(answer);
            if (withNormal_) throw py::value_error(name_ + ".depth must give (depth, normal) for a run");
            return result;
        }
        const auto parts = py::reinterpret_borrow<py::tuple>(answer);
        if (parts.size() != 2 && parts.size() != 3) refuse(answer);
        result.depthMm = number(parts[0]);
        result.normal = vector(parts[1], "normal");
        const double length = result.normal.norm();
        if (std::abs(length - 1.0) > kUnitTolerance)
            throw py::value_error(fmt::format("{}.depth: the normal's length is {:.6g}, not 1", name_, length));
        result.normal /= length;
        result.toothPointMm = parts.size() == 3 ? vector(parts[2], "point") : p;
        return result;
    }

    [[noreturn]] void refuse(const py::handle& answer) const {
        throw py::type_error(
            fmt::format("{}.depth must give a depth [mm], (depth, normal) or (depth, normal, point), "
                        "not {}",
                        name_, std::string(py::str(py::type::handle_of(answer).attr("__name__")))));
    }

    double number(const py::handle& given) const {
        const double value = PyFloat_AsDouble(given.ptr());
        if (value == -1.0 && PyErr_Occurred()) {
            PyErr_Clear();
            refuse(given);
        }
        if (!std::isfinite(value)) throw py::value_error(name_ + ".depth: the depth is not finite");
        return value;
    }

    core::Vec3 vector(const py::handle& given, const char* what) const {
        const std::string full = name_ + ".depth: the " + what;
        const std::vector<core::Vec3> points = pointsFrom(given, full.c_str());
        if (points.size() != 1) throw py::value_error(full + " must have three numbers");
        return points[0];
    }

    std::string name_;
    py::object depth_;
    bool withNormal_;
    std::shared_ptr<OwnProblem> problem_;
};

}  // namespace

void requireMethod(const std::string& name) {
    if (name != "field" && name != "hull")
        throw core::Error(fmt::format("there is no contact method called \"{}\"", name), "method",
                          "choose one of field, hull, or give one of your own");
}

std::unique_ptr<contact::Method> makeMethod(const std::string& name,
                                            const std::shared_ptr<const tooth::ToothModel>& tooth,
                                            const std::shared_ptr<const instrument::Bur>& bur) {
    requireMethod(name);
    if (name == "field") return contact::makeFieldMethod(tooth, bur);
    return contact::makeHullMethod(tooth->outer, bur->mesh());
}

std::string nameOfOwn(const py::object& own) {
    if (py::hasattr(own, "name") && py::isinstance<py::str>(own.attr("name")))
        return own.attr("name").cast<std::string>();
    return py::str(py::type::handle_of(own).attr("__name__"));
}

std::unique_ptr<contact::Method> makeOwnMethod(const py::object& own, bool withNormal,
                                               std::shared_ptr<OwnProblem> problem) {
    if (!py::hasattr(own, "depth") || !PyCallable_Check(py::object(own.attr("depth")).ptr()))
        throw py::type_error("a method is \"field\", \"hull\", or has a depth(pose) to call");
    return std::make_unique<OwnMethod>(own, withNormal, std::move(problem));
}

}  // namespace handpiece::python
