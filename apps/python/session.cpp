// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <mutex>
#include <nlohmann/json.hpp>

#include "handpiece/app/simulation/session_player.h"
#include "handpiece/app/simulation/tissue_export.h"
#include "handpiece/base/core/error.h"
#include "handpiece/record/session/session_reader.h"
#include "python/bind.h"
#include "python/long_work.h"
#include "python/samples.h"
#include "studies/told_json.h"

namespace handpiece::python {
namespace {

/// A session's file, opened. Its reader belongs to one thread at a time.
class Session {
  public:
    explicit Session(const py::object& path) : path_(pathFrom(path)) {
        const py::gil_scoped_release released;
        reader_ = std::make_unique<session::SessionReader>(path_);
    }

    [[nodiscard]] const std::string& path() const { return path_; }

    /// Reads without Python's lock, one thread after the other. Throws core::Error for one that was closed.
    template <class Read>
    auto read(const Read& read) {
        const py::gil_scoped_release released;
        const std::lock_guard lock(mutex_);
        if (!reader_) throw core::Error("the session was closed", path_, "open it again").as("session-closed");
        return read(*reader_);
    }
    void close() {
        const py::gil_scoped_release released;
        const std::lock_guard lock(mutex_);
        reader_.reset();
    }

  private:
    std::string path_;
    std::mutex mutex_;
    std::unique_ptr<session::SessionReader> reader_;
};

struct KeyFrame {
    std::uint64_t tick;
    double timeS;
    std::vector<std::byte> state;
};

py::dict samples(Session& s, std::int64_t first, std::optional<std::int64_t> count) {
    if (first < 0 || (count && *count < 0)) throw py::value_error("first and count must be 0 or more");
    double rateHz = 0.0;
    auto records = s.read([&](const session::SessionReader& reader) {
        rateHz = reader.info().rateHz;
        const std::uint64_t from = std::min(static_cast<std::uint64_t>(first), reader.size());
        const std::uint64_t most = reader.size() - from;
        const std::uint64_t n = count ? std::min(static_cast<std::uint64_t>(*count), most) : most;
        return std::make_shared<const std::vector<session::Record>>(reader.records(from, static_cast<std::size_t>(n)));
    });
    return samplesOf(std::move(records), rateHz);
}

py::list events(Session& s) {
    double rateHz = 0.0;
    const std::vector<session::Event> all = s.read([&](const session::SessionReader& reader) {
        rateHz = reader.info().rateHz;
        return reader.events();
    });
    py::list told;
    for (const session::Event& e : all)
        told.append(py::dict(py::arg("tick") = e.tick, py::arg("time_s") = static_cast<double>(e.tick) * (1.0 / rateHz),
                             py::arg("name") = e.name, py::arg("text") = e.text));
    return told;
}

KeyFrame keyFrame(Session& s, std::int64_t index) {
    return s.read([&](const session::SessionReader& reader) {
        const auto count = static_cast<std::int64_t>(reader.keyFrameTicks().size());
        const std::int64_t at = index < 0 ? index + count : index;
        if (at < 0 || at >= count) throw py::index_error(fmt::format("key frame {} of {}", index, count));
        session::KeyFrame frame = reader.keyFrame(static_cast<std::size_t>(at));
        return KeyFrame{frame.tick, static_cast<double>(frame.tick) * (1.0 / reader.info().rateHz),
                        std::move(frame.state)};
    });
}

Tooth toothAt(Session& s, std::optional<double> timeS, const py::object& progress) {
    if (timeS && !(*timeS >= 0.0)) throw py::value_error("time_s must be 0 or more");
    s.read([](const session::SessionReader&) { return 0; });  // tells one that was closed
    LongWork work(progress);
    return work.run([&] {
        const auto cut = simulation::readCutTeeth(s.path(), timeS, true, work.listener());
        return cutTooth(cut->teeth.at(0), cut->state);
    });
}

py::object replay(const py::object& path, bool cache, const py::object& progress) {
    const std::string file = pathFrom(path);
    LongWork work(progress);
    const std::string text = work.run([&] {
        const core::Progress told = work.listener();
        simulation::SessionPlayer player(file, {cache, false, {}}, core::part(told, 0.0, 0.3));
        const simulation::Verdict verdict = player.compareAll(core::part(told, 0.3, 1.0));
        return studies::toJson(verdict, player).dump();
    });
    return fromJson(text);
}

}  // namespace

void bindSession(py::module_& module) {
    py::class_<KeyFrame>(module, "KeyFrame", "The tooth at a moment of a session, as its file holds it.")
        .def_readonly("tick", &KeyFrame::tick, "When.")
        .def_readonly("time_s", &KeyFrame::timeS, "When [s].")
        .def_property_readonly(
            "state",
            [](const KeyFrame& k) { return py::bytes(reinterpret_cast<const char*>(k.state.data()), k.state.size()); },
            "What was cut by then, as docs/formats/cut-state.md has it: bytes, a copy.");
    py::class_<Session>(
        module, "Session",
        "A recorded session (.h5): whole, cut off, or still being written. Closes itself; `with` closes "
        "it sooner.\n\n"
        "Parameters\n----------\npath : path\n\n"
        "Raises\n------\nError\n    No session, damaged, of a newer version.\n\n"
        "Notes\n-----\nThreads may share one: they read one after the other. A closed one raises Error "
        "with the id \"session-closed\".")
        .def(py::init<const py::object&>(), py::arg("path"))
        .def_property_readonly(
            "path", [](const Session& s) { return s.path(); }, "Of its file.")
        .def("__len__", [](Session& s) { return s.read([](const auto& r) { return r.size(); }); })
        .def_property_readonly(
            "rate_hz", [](Session& s) { return s.read([](const auto& r) { return r.info().rateHz; }); },
            "Ticks a second.")
        .def_property_readonly(
            "code", [](Session& s) { return s.read([](const auto& r) { return r.info().code; }); },
            "Typed by the student; may be \"\".")
        .def_property_readonly(
            "engine_revision", [](Session& s) { return s.read([](const auto& r) { return r.info().engineRevision; }); },
            "Of the program that recorded it: another than this one's cannot prove it.")
        .def_property_readonly(
            "complete", [](Session& s) { return s.read([](const auto& r) { return r.isComplete(); }); },
            "False after a kill or a full disk, or while it is written.")
        .def_property_readonly(
            "settings", [](Session& s) { return fromJson(s.read([](const auto& r) { return r.info().settings; })); },
            "Bur, drive, force, field: all that a replay needs beside the tooth, as a dict.")
        .def(
            "samples", &samples, py::arg("first") = 0, py::arg("count") = py::none(),
            "What was recorded of each tick.\n\n"
            "Parameters\n----------\nfirst, count : int\n    Which samples; all from the first on if count is None.\n\n"
            "Returns\n-------\ndict of arrays (n,) or (n, k)\n"
            "    tick, time_s, position_mm (3), orientation (4: w x y z), velocity_mm_s (3), force_n (3), torque_nmm "
            "(3), "
            "depth_mm, tissue, tooth, flags, pedal, buttons, speed_rpm, load_torque_nmm, feed_mm_s, removed_mm3 (by "
            "TISSUES), removed_others_mm3. NaN where the device gave no number.\n\n"
            "Notes\n-----\ntime_s, position_mm, orientation and pedal are copies; the rest are views, read-only, of "
            "one "
            "block that any of them keeps alive.")
        .def("events", &events, "What is worth a name, in its order: dicts of tick, time_s, name, text.")
        .def_property_readonly(
            "key_frame_ticks", [](Session& s) { return s.read([](const auto& r) { return r.keyFrameTicks(); }); },
            "When the key frames were taken: a list.")
        .def("key_frame", &keyFrame, py::arg("index"),
             "One of them by its number, from the end if that is negative.\n\n"
             "Returns\n-------\nKeyFrame\n\nRaises\n------\nIndexError\n    There is none.")
        .def("tooth_at", &toothAt, py::arg("time_s") = py::none(), py::kw_only(), py::arg("progress") = py::none(),
             "The tooth as it was cut at a time; at the end if that is None.\n\n"
             "Returns\n-------\nTooth\n\n"
             "Raises\n------\nError\n    The session holds no tooth, or cancelled.\n\n"
             "Notes\n-----\nCuts again from the key frame before.")
        .def(
            "close", [](Session& s) { s.close(); }, "Let go of the file. Arrays that came out of it stay.")
        .def("__enter__", [](const py::object& self) { return self; })
        .def("__exit__", [](Session& s, const py::args&) { s.close(); })
        .def("__repr__", [](const Session& s) { return "<handpiece.Session: " + s.path() + ">"; });
    module.def("replay", &replay, py::arg("path"), py::kw_only(), py::arg("cache") = true,
               py::arg("progress") = py::none(),
               "Cut a session's tooth again with the hand that was recorded, and compare what is left.\n\n"
               "Returns\n-------\ndict\n    As `handpiece replay --json` tells: state_hash, recorded_hash, matches, "
               "ticks, ... Where matches is false the dict says so; nothing is raised.\n\n"
               "Raises\n------\nError\n    No session, damaged, without its tooth, cancelled.");
}

}  // namespace handpiece::python
