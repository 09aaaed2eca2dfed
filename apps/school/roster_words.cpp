// SPDX-License-Identifier: Apache-2.0
#include "school/roster_words.h"

#include "handpiece/app/report/school_pages.h"
#include "handpiece/base/config/words.h"
#include "handpiece/school/people/secret.h"

namespace handpiece::school_server {

std::string inWords(const school::RosterChange& c) {
    using Kind = school::RosterChange::Kind;
    static constexpr const char* kWords[] = {
        "school-office.add-person",     "school-office.rename",        "school-office.set-roles",
        "school-office.suspend-person", "school-office.resume-person", "school-office.add-class",
        "school-office.rename-class",   "school-office.close-class",   "school-office.open-class",
        "school-office.enrol-person",   "school-office.leave-class"};
    const bool isClass = c.kind >= Kind::addClass && c.kind <= Kind::openClass;
    return config::words()(kWords[static_cast<std::size_t>(c.kind)], isClass ? c.schoolClass : c.person, c.name,
                           c.detail);
}

std::string today(school::Milliseconds now) {
    return report::momentOf(now).substr(0, 10);
}

std::string newPersonCode() {
    return school::newStationCode().substr(0, 7);
}

}  // namespace handpiece::school_server
