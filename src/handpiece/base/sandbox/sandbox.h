// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Reads what strangers made in a process that holds nothing: no key, no file but the named ones, no network. What
/// comes back is data with bounds. docs/sandbox.md.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/base/core/progress.h"

namespace handpiece::sandbox {

/// What a child may use; who passes them ends.
struct Bounds {
    std::uint64_t memoryBytes = 3ull << 30;  ///< address space
    double cpuS = 600.0, wallS = 1800.0;
    std::size_t answerBytes = 64u << 20;
};

struct Answer {
    std::string text{};
    std::vector<std::byte> bytes{};
    std::uint64_t peakBytes = 0;  ///< of memory that the child had; filled in by ask()
};

/// Where handpiece-sandbox lies: beside this program, or in ../libexec/handpiece of it; empty where it is not.
[[nodiscard]] std::filesystem::path programPath();

/// Starts the program that calls serve(), hands it `request`, and waits for its answer. `readable`: the only files that
/// it may open, besides the system's libraries. `progress` is called ten times a second, in this thread.
///
/// Throws core::Error: what the child threw, as it threw it; "cancelled"; and by id
/// - "sandbox-start": it could not begin (no program, a kernel without Landlock or seccomp): no file's fault;
/// - "sandbox-killed": somebody ended it from outside (an administrator, a machine without memory): no file's fault;
/// - "sandbox-died": reading ended it, or it answered what is no answer;
/// - "sandbox-slow", "sandbox-large": it passed its bounds of time, or of memory.
[[nodiscard]] Answer ask(const std::string& request, std::span<const std::filesystem::path> readable,
                         const Bounds& bounds = {}, const core::Progress& progress = {},
                         const std::filesystem::path& program = programPath());

/// Whether an error of ask() is the fault of what was read; it will be the same again.
[[nodiscard]] bool isFault(const core::Error& error);

/// What the child does with a request.
using Work = std::function<Answer(const std::string& request, const core::Progress& progress)>;
/// The child's main: reads what it is asked, locks itself in, works, answers. Only where ask() has started it. Returns
/// the exit code.
[[nodiscard]] int serve(const Work& work);

}  // namespace handpiece::sandbox
