// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The command line as a function, so that other programs can add a contact method or a law of
/// force of their own to it.

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "handpiece/tick/contact/method.h"
#include "handpiece/tick/force/force_law.h"

namespace handpiece::cli {

/// Makes a contact method for a tooth and a bur; called off the tick.
using MethodFactory = std::function<std::unique_ptr<contact::Method>(std::shared_ptr<const tooth::ToothModel>,
                                                                     std::shared_ptr<const instrument::Bur>)>;
/// By the name typed after --method. "field" and "hull" are always there.
using MethodRegistry = std::map<std::string, MethodFactory>;

/// By the name typed after --force. "proxy" and "penalty" are always there. Sessions tell the name, so a program that
/// replays one needs the same laws.
using LawRegistry = std::map<std::string, force::LawFactory>;

/// Runs one command. Returns the exit code: 0 done, 1 failed, 2 wrong usage. Messages go to stderr, results to stdout.
int run(int argc, const char* const* argv, const MethodRegistry& extraMethods = {}, const LawRegistry& extraLaws = {});

}  // namespace handpiece::cli
