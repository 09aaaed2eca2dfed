// SPDX-License-Identifier: Apache-2.0
// Any bytes at all must give a mesh whose triangles name vertices that are there, and a colour for each of them or
// none, or one core::Error.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/mesh_io.h"

using handpiece::geometry::MeshFormat;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    handpiece::geometry::ColouredMesh read;
    try {
        read = handpiece::geometry::readColouredMesh(std::as_bytes(std::span(data, size)),
                                                     MeshFormat::HANDPIECE_FUZZ_FORMAT, "fuzz");
    } catch (const handpiece::core::Error&) {
        return 0;
    }
    // Throws, and so stops the fuzzer, when an index is out of range or a coordinate is not finite.
    const handpiece::geometry::MeshReport report = handpiece::geometry::inspect(read.mesh);
    if (report.faces == 0) std::abort();
    handpiece::geometry::requireOneAVertex(read.mesh, read.colours, "fuzz");
    return 0;
}
