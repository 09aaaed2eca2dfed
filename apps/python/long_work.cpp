// SPDX-License-Identifier: Apache-2.0
#include "python/long_work.h"

namespace handpiece::python {
namespace {
constexpr std::chrono::milliseconds kBetween{50};
}  // namespace

LongWork::LongWork(py::object progress) : progress_(std::move(progress)) {
    if (!progress_.is_none() && !PyCallable_Check(progress_.ptr()))
        throw py::type_error("progress must be None or something to call with the fraction that is done");
}

bool LongWork::tell(double fraction) {
    if (stop_.load(std::memory_order_relaxed)) return false;
    if (std::this_thread::get_id() != owner_) return true;
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return true;
    const py::gil_scoped_acquire acquired;
    try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (!progress_.is_none()) {
            const py::object answer = progress_(fraction);
            if (answer.ptr() == Py_False) stop_ = true;
        }
    } catch (...) {
        thrown_ = std::current_exception();
        stop_ = true;
    }
    next_ = std::chrono::steady_clock::now() + kBetween;
    return !stop_;
}

void LongWork::finish() {
    if (!progress_.is_none() && !stop_) progress_(1.0);
}

}  // namespace handpiece::python
