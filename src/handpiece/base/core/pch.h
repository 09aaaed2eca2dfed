// SPDX-License-Identifier: Apache-2.0
// Precompiled once, in core, and reused by every room: what nearly every source includes.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>
