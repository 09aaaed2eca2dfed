// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <atomic>
#include <functional>
#include <mutex>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/tick/contact/field_method.h"
#include "python/arrays.h"
#include "python/bind.h"
#include "python/long_work.h"
#include "python/own_method.h"
#include "studies/probe.h"

namespace handpiece::python {
namespace {

/// What a bur feels at one pose, but for its patches.
struct Felt {
    contact::Depth depth;
    double areaMm2 = 0.0;
    contact::Status patchStatus = contact::Status::ok;
};

/// Answers to a list of poses; arrays are views of these.
struct Probe {
    std::vector<Felt> felt;
    bool hasPatches = false;
    std::vector<contact::Patch> patches;  ///< of all poses, in their order
    std::vector<std::int64_t> starts;     ///< of each pose's in `patches`, and their end
};

class Contact {
  public:
    Contact(const Tooth& tooth, const py::object& bur, const py::object& method) : tooth_(tooth), bur_(burFrom(bur)) {
        const auto t = tooth_;
        const auto b = bur_.bur;
        if (!py::isinstance<py::str>(method)) {
            problem_ = std::make_shared<OwnProblem>();
            own_ = method;
            name_ = nameOfOwn(method);
            idle_.push_back(makeOwnMethod(method, false, problem_));
            return;
        }
        name_ = method.cast<std::string>();
        requireMethod(name_);
        if (!t.cut)
            make_ = [t, b, name = name_] { return makeMethod(name, t.model, b); };
        else if (name_ == "field")
            make_ = [t, b] { return contact::makeFieldMethod(t.cut, b); };
        else
            throw core::Error("a tooth that was cut is felt by the method \"field\" alone", "method",
                              "leave it out, or prepare the case");
        const py::gil_scoped_release released;
        idle_.push_back(make_());  // what cannot be made is told here
    }

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] const Tooth& tooth() const { return tooth_; }
    [[nodiscard]] const Bur& bur() const { return bur_; }

    std::shared_ptr<Probe> probe(const py::object& given, bool patches, const py::object& progress) {
        const std::vector<core::Pose> poses = posesFrom(given, "poses");
        LongWork work(progress);
        const Turn turn(*this);
        auto out = std::make_shared<Probe>();
        out->felt.resize(poses.size());
        out->hasPatches = patches;
        work.run([&] { ask(poses, *out, work.listener()); });
        if (problem_) problem_->rethrow();
        return out;
    }

  private:
    /// One call at a time: methods keep a warm start.
    class Turn {
      public:
        explicit Turn(Contact& contact) : busy_(contact.busy_) {
            if (busy_.exchange(true))
                throw core::Error("this Contact is at work in another thread", "probe", "make one Contact a thread")
                    .as("contact-busy");
        }
        ~Turn() { busy_ = false; }
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;

      private:
        std::atomic<bool>& busy_;
    };

    void ask(const std::vector<core::Pose>& poses, Probe& out, const core::Progress& progress) {
        const std::size_t stretches = (poses.size() + studies::kProbeStretch - 1) / studies::kProbeStretch;
        std::vector<std::vector<contact::Patch>> found(out.hasPatches ? stretches : 0);
        std::vector<std::int64_t> counts(out.hasPatches ? poses.size() : 0);
        std::atomic<std::size_t> done{0};
        const auto some = [&](std::size_t begin, std::size_t end) {
            const Taken taken(*this);
            contact::Method* const method = taken.method.get();
            contact::PatchSet patches;
            for (std::size_t s = begin; s < end; ++s) {
                method->reset();
                const std::size_t last = std::min(poses.size(), (s + 1) * studies::kProbeStretch);
                for (std::size_t i = s * studies::kProbeStretch; i < last; ++i) {
                    Felt& felt = out.felt[i];
                    felt.depth = method->depth(poses[i]);
                    if (!out.hasPatches) continue;
                    method->patches(poses[i], patches);
                    felt.areaMm2 = patches.areaMm2;
                    felt.patchStatus = patches.status;
                    counts[i] = static_cast<std::int64_t>(patches.patches.size());
                    found[s].insert(found[s].end(), patches.patches.begin(), patches.patches.end());
                }
                core::report(progress, static_cast<double>(++done) / static_cast<double>(stretches));
                if (problem_ && hasFailed()) break;
            }
        };
        // One's own method knows one thread, Python's.
        if (own_)
            some(0, stretches);
        else
            core::parallelFor(stretches, 1, some);
        if (!out.hasPatches) return;
        out.starts.assign(1, 0);
        for (const std::int64_t count : counts)
            out.starts.push_back(out.starts.back() + count);
        out.patches.reserve(static_cast<std::size_t>(out.starts.back()));
        for (const auto& of : found)
            out.patches.insert(out.patches.end(), of.begin(), of.end());
    }

    /// A method in use: it goes back however the work ends.
    struct Taken {
        explicit Taken(Contact& from) : of(from), method(from.take()) {}
        ~Taken() { of.giveBack(std::move(method)); }
        Taken(const Taken&) = delete;
        Taken& operator=(const Taken&) = delete;
        Contact& of;
        std::unique_ptr<contact::Method> method;
    };
    [[nodiscard]] bool hasFailed() const {
        const py::gil_scoped_acquire acquired;
        return problem_->thrown != nullptr;
    }
    std::unique_ptr<contact::Method> take() {
        {
            const std::lock_guard lock(mutex_);
            if (!idle_.empty()) {
                std::unique_ptr<contact::Method> method = std::move(idle_.back());
                idle_.pop_back();
                return method;
            }
        }
        return make_();
    }
    void giveBack(std::unique_ptr<contact::Method> method) {
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(method));
    }

    Tooth tooth_;
    Bur bur_;
    std::string name_;
    py::object own_;
    std::shared_ptr<OwnProblem> problem_;
    std::function<std::unique_ptr<contact::Method>()> make_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<contact::Method>> idle_;
    std::atomic<bool> busy_{false};
};

using Rows = const std::vector<Felt>&;
using Patches = const std::vector<contact::Patch>&;

/// A view of one member of each row; empty rows have no address to begin at.
template <class T, class Row, class Member>
py::array column(const py::object& self, const std::vector<Row>& rows, py::ssize_t width, const Member& member) {
    static const Row none{};
    return columnOf(rows, reinterpret_cast<const T*>(member(rows.empty() ? none : rows.front())), width, self);
}

/// Adds a property that is a view of a member.
template <class T, class Row>
void view(py::class_<Probe, std::shared_ptr<Probe>>& type, const char* name, std::vector<Row> Probe::*rows,
          py::ssize_t width, const void* (*member)(const Row&), const char* doc) {
    type.def_property_readonly(
        name, [=](const py::object& self) { return column<T>(self, self.cast<const Probe&>().*rows, width, member); },
        doc);
}

void bindProbe(py::module_& module) {
    using contact::Patch;
    py::class_<Probe, std::shared_ptr<Probe>> type(
        module, "Probe",
        "What a bur feels at n poses. Its arrays are views, read-only, that keep it alive.\n\n"
        "Patches of pose i are the rows patch_starts[i] to patch_starts[i + 1] of the patch arrays.");
    type.def("__len__", [](const Probe& p) { return p.felt.size(); });
    type.def("__repr__", [](const Probe& p) {
        return fmt::format("<handpiece.Probe: {} poses{}>", p.felt.size(),
                           p.hasPatches ? fmt::format(", {} patches", p.patches.size()) : ", depths alone");
    });
    const auto felt = &Probe::felt;
    view<double, Felt>(
        type, "depth_mm", felt, 1, [](const Felt& f) -> const void* { return &f.depth.depthMm; },
        "(n,) float64 [mm]: positive when overlapping, 0 at touch, minus the distance when apart; beyond "
        "the reach (5 mm) a bound.");
    view<double, Felt>(
        type, "normal", felt, 3, [](const Felt& f) -> const void* { return f.depth.normal.data(); },
        "(n, 3) float64: unit, out of the tooth; zero beyond the reach.");
    view<double, Felt>(
        type, "tooth_point_mm", felt, 3, [](const Felt& f) -> const void* { return f.depth.toothPointMm.data(); },
        "(n, 3) float64 [mm]: the point of the tooth's surface that decides.");
    view<std::uint8_t, Felt>(
        type, "tissue", felt, 1, [](const Felt& f) -> const void* { return &f.depth.tissue; },
        "(n,) uint8: at that point, a number of TISSUES.");
    view<std::uint8_t, Felt>(
        type, "status", felt, 1, [](const Felt& f) -> const void* { return &f.depth.status; },
        "(n,) uint8: a number of STATUS.");
    view<double, Felt>(
        type, "area_mm2", felt, 1, [](const Felt& f) -> const void* { return &f.areaMm2; },
        "(n,) float64 [mm2]: of contact; 0 where patches were not asked for, and of methods that know "
        "depth alone.");
    type.def_property_readonly(
        "patch_starts",
        [](const py::object& self) {
            const auto& starts = self.cast<const Probe&>().starts;
            return viewOf(starts.data(), {static_cast<py::ssize_t>(starts.size())}, self);
        },
        "(n + 1,) int64: where each pose's patches begin; empty where they were not asked for.");
    const auto patches = &Probe::patches;
    view<double, Patch>(
        type, "patch_centre_mm", patches, 3, [](const Patch& p) -> const void* { return p.centreMm.data(); },
        "(m, 3) float64 [mm]: weighted by area and pressure.");
    view<double, Patch>(
        type, "patch_normal", patches, 3, [](const Patch& p) -> const void* { return p.normal.data(); },
        "(m, 3) float64: unit, out of the tooth.");
    view<double, Patch>(
        type, "patch_area_mm2", patches, 1, [](const Patch& p) -> const void* { return &p.areaMm2; },
        "(m,) float64 [mm2]: of the bur's surface within 0.02 mm of tissue, or inside it.");
    view<double, Patch>(
        type, "patch_depth_mm", patches, 1, [](const Patch& p) -> const void* { return &p.maxDepthMm; },
        "(m,) float64 [mm]: of its deepest point.");
    view<double, Patch>(
        type, "patch_pressure_share", patches, 1, [](const Patch& p) -> const void* { return &p.pressureShare; },
        "(m,) float64: of all patches of its pose; they add up to 1.");
    view<std::uint8_t, Patch>(
        type, "patch_tissue", patches, 1, [](const Patch& p) -> const void* { return &p.tissue; },
        "(m,) uint8: that carries most of its pressure, a number of TISSUES.");
}

}  // namespace

void bindContact(py::module_& module) {
    module.attr("STATUS") = py::make_tuple("ok", "beyond reach", "truncated", "invalid pose");
    bindProbe(module);
    py::class_<Contact>(
        module, "Contact",
        "One way to find contact between a bur and a tooth.\n\n"
        "Parameters\n----------\n"
        "tooth : Tooth\n    Of prepare.\n"
        "bur : Bur, str or path\n    Or what Bur takes.\n"
        "method : str or Method\n    \"field\": the concave tooth, exact where it is uncut. \"hull\": the "
        "paper's convex hulls (Quickhull, GJK, EPA). Or one of your own.\n\n"
        "Raises\n------\nError\n    No such bur or method.\nTypeError\n    A method without depth(pose).\n\n"
        "Notes\n-----\nOne call at a time: a second thread gets an Error with the id \"contact-busy\". "
        "Methods: docs/contact.md, docs/paper.md.")
        .def(py::init<const Tooth&, const py::object&, const py::object&>(), py::arg("tooth"), py::arg("bur"),
             py::arg("method") = "field")
        .def(
            "probe",
            [](Contact& c, const py::object& poses, bool patches, const py::object& progress) {
                return c.probe(poses, patches, progress);
            },
            py::arg("poses"), py::kw_only(), py::arg("patches") = true, py::arg("progress") = py::none(),
            "What the bur feels at each pose, as `handpiece probe` tells it.\n\n"
            "Parameters\n----------\n"
            "poses : array (n, 7) or (n, 4, 4)\n    Bur in tooth: x, y, z of the tip [mm] and qw, qx, qy, qz, or "
            "matrices [mm].\n"
            "patches : bool\n    Area and patches too; without, depth alone in two thirds of the time.\n"
            "progress : callable, optional\n    Hears the fraction done; False from it cancels.\n\n"
            "Returns\n-------\nProbe\n\n"
            "Raises\n------\nTypeError, ValueError\n    Not poses: wrong shape, not finite, no rotation.\n"
            "Error\n    At work in another thread, or cancelled.\n\n"
            "Notes\n-----\nUses all cores, without Python's lock; the same bits at any number of threads. Ctrl-C ends "
            "it.")
        .def_property_readonly(
            "method", [](const Contact& c) { return c.name(); }, "The method's name.")
        .def_property_readonly(
            "tooth", [](const Contact& c) { return c.tooth(); }, "As it was given.")
        .def_property_readonly(
            "bur", [](const Contact& c) { return c.bur(); }, "As it was given.")
        .def("__repr__", [](const Contact& c) {
            return fmt::format("<handpiece.Contact: {} on {} by {}>", c.bur().bur->name(), c.tooth().model->name,
                               c.name());
        });
}

}  // namespace handpiece::python
