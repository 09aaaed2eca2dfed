// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// All that the window can do.

namespace handpiece::desktop {

struct FeatureContext;

/// One line a feature; they belong to the window. Shows it as it was left.
void installFeatures(const FeatureContext& context);

}  // namespace handpiece::desktop
