// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Sessions and .handpiece files that somebody else made: read in a process that holds nothing before this program
/// opens them. Its own are opened as they lie. docs/sandbox.md. No widgets, any thread.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "desktop/framework/settings.h"
#include "handpiece/base/core/progress.h"

namespace handpiece::desktop {

/// While it lives, all that this process opens goes through it (core::TakingFrom), whoever opens it: what was not read
/// yet is read then.
///
/// Own are: what lies in the folders of recordings, of made teeth and of exams (whose exercise the school has signed)
/// and is this user's; what made() was told of, also by a program of before.
class OutsideFiles {
  public:
    /// Reads a file apart; throws core::Error for what must not be opened. SHA-256 of what was read in it besides.
    using Reader =
        std::function<std::vector<std::string>(const std::filesystem::path& copy, const core::Progress& progress)>;
    explicit OutsideFiles(const Folders& folders, Reader reader = sandboxReader());
    OutsideFiles(const OutsideFiles&) = delete;
    OutsideFiles& operator=(const OutsideFiles&) = delete;
    ~OutsideFiles();

    /// Opening it takes no reading first: it is its own, was read and is the same still, is of no kind that is read
    /// apart, or is not there.
    [[nodiscard]] bool isAtHand(const std::filesystem::path& file) const;
    /// Reads it apart where it is not at hand; it may be opened then, and what is opened are the bytes that were read.
    /// One that ended its reader is not tried again. Throws core::Error: what its reader says, sandbox::ask(),
    /// "cancelled".
    void read(const std::filesystem::path& file, const core::Progress& progress = {}) const;
    /// Runs what reads `what` apart; where that ended its reader, it throws the same again and is not run.
    void once(const std::string& what, const std::function<void()>& reads) const;
    /// This program wrote it, or these bytes, which others pack.
    void made(const std::filesystem::path& file) const;
    void made(std::span<const std::byte> bytes) const;

    /// In the program that is locked in (app/sandboxed).
    [[nodiscard]] static Reader sandboxReader();

  private:
    struct State;
    std::shared_ptr<State> state_;
};

}  // namespace handpiece::desktop
