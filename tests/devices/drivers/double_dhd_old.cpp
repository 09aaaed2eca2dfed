// SPDX-License-Identifier: Apache-2.0
/// @file
/// A library of the right name and the wrong version: it opens devices, and that is all.

extern "C" __attribute__((visibility("default"))) int dhdOpen() {
    return 0;
}
