// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How much a panel tells.

namespace handpiece::desktop {

/// The three layouts of the window. Practice shows no engineering words, Laboratory every figure, Paper what the
/// paper's Figure 5 has.
enum class Detail { practice, laboratory, paper };

}  // namespace handpiece::desktop
