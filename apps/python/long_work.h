// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Long work without Python's lock: Ctrl-C ends it, a callback hears how far it is.

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <optional>
#include <thread>
#include <type_traits>
#include <utility>

#include "handpiece/base/core/progress.h"

namespace handpiece::python {

namespace py = pybind11;

/// One call's. Python is asked on the thread that called alone, at most twenty times a second.
class LongWork {
  public:
    /// None, or what is called with the fraction done; False from it cancels. Throws TypeError for anything else.
    explicit LongWork(py::object progress);
    LongWork(const LongWork&) = delete;
    LongWork& operator=(const LongWork&) = delete;

    /// To hand to the work; valid as long as this.
    [[nodiscard]] core::Progress listener() {
        return [this](double fraction) { return tell(fraction); };
    }

    /// Does the work. What Python threw meanwhile (KeyboardInterrupt, an error of the callback) comes out of it.
    template <class Work>
    auto run(Work&& work) {
        using Result = std::invoke_result_t<Work>;
        if constexpr (std::is_void_v<Result>) {
            guarded(work);
            finish();
        } else {
            std::optional<Result> result;
            guarded([&] { result.emplace(work()); });
            finish();
            return std::move(*result);
        }
    }

  private:
    template <class Work>
    void guarded(Work&& work) {
        try {
            const py::gil_scoped_release released;
            work();
        } catch (...) {
            if (thrown_) std::rethrow_exception(std::exchange(thrown_, {}));
            throw;
        }
        if (thrown_) std::rethrow_exception(std::exchange(thrown_, {}));
    }
    bool tell(double fraction);
    void finish();

    py::object progress_;
    std::thread::id owner_ = std::this_thread::get_id();
    std::chrono::steady_clock::time_point next_{};
    std::exception_ptr thrown_;
    std::atomic<bool> stop_{false};
};

}  // namespace handpiece::python
