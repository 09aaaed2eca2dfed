// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Works that a school's server lends to this machine, over its own protocol: it needs neither the server's folder nor
/// its database.

#include <memory>

#include "school/lent_work.h"
#include "school/station.h"

namespace handpiece::school_server {

/// Of a machine that was enrolled as a worker (school_station::enrol(), kind "worker"). Files lie in a folder of this
/// one, of the user's alone, while their work is done: 2 GB of a work at most. A server that is out of reach is asked
/// again, for as long as it keeps the work for this machine. What it may not be believed in: docs/school-keys.md.
[[nodiscard]] std::unique_ptr<WorkSource> worksOf(const school_station::Enrolment& enrolment,
                                                  const std::filesystem::path& folder);

}  // namespace handpiece::school_server
