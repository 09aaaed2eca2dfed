// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What every page asks about who looks: their roles, how they stand to a thing, what they may, and a line in the
/// audit.

#include <optional>
#include <string>
#include <vector>

#include "handpiece/app/report/school_pages.h"
#include "handpiece/school/people/permission.h"
#include "school/pages.h"

namespace handpiece::school_server {

[[nodiscard]] std::vector<school::Role> rolesOf(const school::Person& person);
/// Nothing: they are not in it.
[[nodiscard]] std::optional<school::Role> roleIn(const school::Books& books, const std::string& schoolClass,
                                                 const std::string& person);
[[nodiscard]] report::Looker lookerOf(const Visit& visit);
/// A class as this person stands to it.
[[nodiscard]] school::Relation relationToClass(const Visit& visit, const std::string& schoolClass);
/// An attempt as this person stands to it: of which class its assignment is, and whether it is practice of its own.
[[nodiscard]] school::Relation relationTo(const Visit& visit, const school::PushedAttempt& attempt);
[[nodiscard]] bool may(const Visit& visit, school::Action action, const school::Relation& relation);
/// Their own, and that of `person` where they may see it.
[[nodiscard]] report::Names namesFor(const Visit& visit, const school::Relation& relation, const std::string& person);
/// Of theirs, now.
[[nodiscard]] school::Act actOf(const Visit& visit);
/// In the audit.
void noteLook(const Visit& visit, const char* what, const std::string& about, const std::string& detail = {});
/// What is not there is answered as what one may not see: nobody learns which.
[[nodiscard]] Page notYours();

}  // namespace handpiece::school_server
