// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Masses among newtons, millimetres and seconds.

namespace handpiece::device {

/// 1 N s2/mm is 1000 kg.
inline constexpr double kKgPerUnit = 1e3;

}  // namespace handpiece::device
