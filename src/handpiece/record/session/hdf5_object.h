// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// HDF5's identifiers as objects that close themselves. For the sources of this room only.

#include <cstdint>
#include <string>

#include "handpiece/record/session/layout.h"

namespace handpiece::session {

/// Owns an identifier (hid_t) of any kind.
class Hdf5Object {
  public:
    Hdf5Object() = default;
    explicit Hdf5Object(std::int64_t id) noexcept : id_(id) {}
    Hdf5Object(Hdf5Object&& other) noexcept : id_(other.id_) { other.id_ = -1; }
    Hdf5Object& operator=(Hdf5Object&& other) noexcept;
    ~Hdf5Object() { close(); }
    void close() noexcept;
    [[nodiscard]] std::int64_t id() const noexcept { return id_; }
    explicit operator bool() const noexcept { return id_ >= 0; }

  private:
    std::int64_t id_ = -1;
};

/// Little-endian, whatever the machine; not to be closed.
[[nodiscard]] std::int64_t fileType(NumberType type);
/// Of this machine; not to be closed.
[[nodiscard]] std::int64_t memoryType(NumberType type);
/// Of EventRow and KeyFrameRow, both in memory and in the file.
[[nodiscard]] Hdf5Object eventRowType();
[[nodiscard]] Hdf5Object keyFrameRowType();
/// UTF-8 of fixed length.
[[nodiscard]] Hdf5Object textType(std::size_t bytes);
/// HDF5 says nothing on stderr in this thread.
void silenceHdf5();

}  // namespace handpiece::session
