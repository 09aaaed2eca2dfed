// SPDX-License-Identifier: Apache-2.0
// The main of a wing's tests.
#include <gmock/gmock.h>

#include "support/chosen_tests.h"

int main(int argc, char** argv) {
    testing::InitGoogleMock(&argc, argv);
    return handpiece::test::runChosen(argc, argv);
}
