// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Works that a school's server lends to this machine, over its own protocol: it needs neither the server's folder nor
/// its database.

#include <memory>

#include "school/lent_work.h"
#include "school/station.h"

namespace handpiece::school_server {

/// Of a machine that was enrolled as a worker (school_station::enrol(), kind "worker"). Files lie here in a folder of
/// the user's alone, while their work is done. A server that is out of reach is asked again, for as long as it keeps
/// the work for this machine.
[[nodiscard]] std::unique_ptr<WorkSource> worksOf(const school_station::Enrolment& enrolment);

}  // namespace handpiece::school_server
