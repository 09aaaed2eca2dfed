// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/sandboxed/sandboxed_work.h"
#include "handpiece/base/sandbox/sandbox.h"

int main() {
    return handpiece::sandbox::serve(handpiece::sandboxed::answer);
}
