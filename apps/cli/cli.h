// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The command line as a function, so that other programs can add a contact method of their own to it.

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/tooth/tooth.h"
#include "handpiece/tick/contact/method.h"

namespace handpiece::cli {

/// Makes a contact method for a tooth and a bur; called off the tick.
using MethodFactory = std::function<std::unique_ptr<contact::Method>(std::shared_ptr<const tooth::Tooth>,
                                                                     std::shared_ptr<const instrument::Bur>)>;
/// By the name typed after --method. "field" and "hull" are always there.
using MethodRegistry = std::map<std::string, MethodFactory>;

/// Runs one command. Returns the exit code: 0 done, 1 failed, 2 wrong usage. Messages go to stderr, results to stdout.
int run(int argc, const char* const* argv, const MethodRegistry& extraMethods = {});

}  // namespace handpiece::cli
