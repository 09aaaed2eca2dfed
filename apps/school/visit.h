// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What every page asks about who looks: their roles, how they stand to a thing, what they may, and a line in the
/// audit.

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/app/report/school_pages.h"
#include "handpiece/school/store/exam_books.h"
#include "handpiece/school/store/visible.h"
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
/// What a sitting hands over, as far as it is known before that came.
[[nodiscard]] school::PushedAttempt workOf(const school::ExamSitting& sitting);
[[nodiscard]] bool may(const Visit& visit, school::Action action, const school::Relation& relation);
/// What this person may see of an attempt: all pages ask this.
[[nodiscard]] school::Visible visibleOf(const Visit& visit, const school::PushedAttempt& attempt);
/// Of others' work of a class, whichever it is.
[[nodiscard]] school::Visible visibleIn(const Visit& visit, const school::Relation& relation, bool marksBlind = false);
/// Of many attempts: what is the same of all of an assignment is asked once.
class Sight {
  public:
    explicit Sight(const Visit& visit) : visit_(visit) {}
    [[nodiscard]] school::Visible of(const school::PushedAttempt& attempt);

  private:
    const Visit& visit_;
    std::map<std::pair<std::string, bool>, school::Eyes> eyes_;  ///< by assignment, and whether it is their own
};
/// Their own, and that of `person` where they may see it.
[[nodiscard]] report::Names namesFor(const Visit& visit, const school::Visible& seen, const std::string& person);
/// Of theirs, now.
[[nodiscard]] school::Act actOf(const Visit& visit);
/// In the audit.
void noteLook(const Visit& visit, const char* what, const std::string& about, const std::string& detail = {});
/// Of another's work; at one's own nobody is told of.
void noteLookAt(const Visit& visit, const char* what, const school::PushedAttempt& attempt);
/// What is not there is answered as what one may not see: nobody learns which.
[[nodiscard]] Page notYours();

}  // namespace handpiece::school_server
