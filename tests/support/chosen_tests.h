// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace handpiece::test {

/// After GoogleTest's own arguments: runs all tests of the program, or with --sources=FILE,... those of these files,
/// named as below tests/. CTest's tests are run so. Returns what main() does.
int runChosen(int argc, char** argv);

}  // namespace handpiece::test
