// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/assessment/judge_file.h"
#include "handpiece/app/course/shipped_exercises.h"
#include "handpiece/base/core/error.h"
#include "python/bind.h"
#include "python/long_work.h"

namespace handpiece::python {
namespace {

/// An exercise, opened.
struct Exercise {
    std::shared_ptr<const course::Made> made;
    std::string named;
};

Exercise openExercise(const py::object& pathOrId, const py::object& progress) {
    const std::string named = pathFrom(pathOrId);
    LongWork work(progress);
    return work.run([&] {
        return Exercise{std::make_shared<const course::Made>(course::openExercise(named, work.listener())), named};
    });
}

py::object score(const py::object& path, const py::object& exercise, const py::object& rubricName,
                 const py::object& before, double mmPerUnit, bool prove, bool anew, const py::object& progress) {
    const Exercise opened =
        py::isinstance<Exercise>(exercise) ? exercise.cast<Exercise>() : openExercise(exercise, py::none());
    assessment::WorkFile file{pathFrom(path), {}, mmPerUnit, prove, !anew};
    if (!(mmPerUnit > 0.0)) throw core::Error("a scan without a size", "mm_per_unit", "give more than 0");
    if (!before.is_none()) file.before = pathFrom(before);
    const std::string named = rubricName.is_none() ? std::string() : pathFrom(rubricName);
    LongWork work(progress);
    std::string proof;
    const std::string text = work.run([&] {
        const rubric::Rubric rubric = assessment::rubricFor(opened.made->task, named, opened.named);
        const assessment::JudgedFile judged = assessment::judgeFile(file, opened.made->task, rubric, work.listener());
        proof = judged.result.proof;
        return assessment::resultJson(judged.result.assessment, judged.result.identity);
    });
    py::dict result = fromJson(text);
    result["proof"] = proof;
    return result;
}

}  // namespace

void bindScore(py::module_& module) {
    py::class_<Exercise>(module, "Exercise", "An exercise: a case, what is to be cut of it, how that is judged.")
        .def_property_readonly(
            "id", [](const Exercise& e) { return e.made->task.id; }, "Small letters, digits, -.")
        .def_property_readonly(
            "path", [](const Exercise& e) { return e.made->path.string(); }, "Of its files.")
        .def_property_readonly(
            "voxel_mm", [](const Exercise& e) { return e.made->task.voxelMm; }, "That work on it is cut in [mm].")
        .def_property_readonly(
            "case",
            [](const Exercise& e) {
                const cases::Case& c = e.made->task.toothCase;
                return Case{std::shared_ptr<const cases::Case>(e.made, &c), c.source.string()};
            },
            "Its tooth, and what stands around it.")
        .def("__repr__", [](const Exercise& e) { return "<handpiece.Exercise: " + e.made->task.id + ">"; });
    py::list ids;
    for (const course::Shipped& shipped : course::shippedExercises())
        ids.append(shipped.id);
    module.attr("EXERCISES") = py::tuple(ids);
    module.def(
        "open_exercise", &openExercise, py::arg("path_or_id"), py::kw_only(), py::arg("progress") = py::none(),
        "Open an exercise: its folder, its .handpiece file, or one of EXERCISES, which is made in the user's cache "
        "folder first.\n\nReturns\n-------\nExercise\n\nRaises\n------\nError");
    module.def(
        "score", &score, py::arg("work"), py::arg("exercise"), py::arg("rubric") = py::none(), py::kw_only(),
        py::arg("before") = py::none(), py::arg("mm_per_unit") = 1.0, py::arg("prove") = true, py::arg("anew") = false,
        py::arg("progress") = py::none(),
        "Judge work on an exercise by a rubric, as `handpiece score` does.\n\n"
        "Parameters\n----------\n"
        "work : path\n    A session (.h5), a folder of one work's sessions, an attempt, or a scan (.stl, .ply).\n"
        "exercise : Exercise, path or id\n"
        "rubric : str or path, optional\n    Instead of the exercise's own.\n"
        "before, mm_per_unit\n    Of a scan: one from before the work; its unit.\n"
        "prove : bool\n    Cut sessions again. Quicker without, and not proven.\n"
        "anew : bool\n    Neither use nor keep what was measured before.\n"
        "progress : callable, optional\n    Hears the fraction done; False from it cancels.\n\n"
        "Returns\n-------\ndict\n    As docs/formats/rubric.md#the-result has it (score, max_score, passed, "
        "criteria, ...), and `proof`, a sentence.\n\n"
        "Raises\n------\nError\n    Work on another tooth or voxel, no rubric, cancelled.\n\n"
        "Notes\n-----\nMeasures and their uncertainty: docs/assessment.md.");
}

}  // namespace handpiece::python
