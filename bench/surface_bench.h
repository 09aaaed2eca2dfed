// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The re-meshing benchmarks of cut_bench.

namespace handpiece::bench {

/// Registers surface/<voxel_um>/<shallow|deep|full>.
void registerSurface();

}  // namespace handpiece::bench
