// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The HTTP library, without the macro that <resolv.h> gives it: Eigen has parameters of that name.

#include <httplib.h>

#undef _res
