// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// People at browsers, and a school in which each role is somebody.

#include <functional>

#include "handpiece/school/people/secret.h"
#include "school/server/browser.h"

namespace handpiece::school_server {

inline const std::string kRoomStation(32, 'c');
inline const std::string kRoomKey(64, 'd');

inline school::Person personAs(const std::string& code, const std::string& name, const std::string& role) {
    static const std::string hash = school::hashOfPassword(kPassword);
    return {code, name, code, "", hash, {role}, 1, 0};
}

/// Somebody of each role, class c1 with an assignment, c2 of another teacher, and a station.
inline void furnishRoles(Books& open) {
    const Act act{"server", 1};
    const std::vector<school::Person> people{
        personAs("t1", "Dr. Sato", "teacher"), personAs("t2", "Dr. Other", "teacher"),
        personAs("e1", "Examiner", "examiner"), personAs("a1", "Admin", "administrator"),
        personAs("s018", "Jun <b>", "student")};
    open.add(people, act);
    open.setPassword("s017", people.front().password, act);
    open.add(school::SchoolClass{"c1", "Operative <1>", "", 0, 1, 0}, act);
    open.add(school::SchoolClass{"c2", "Others", "", 0, 1, 0}, act);
    const std::vector<school::Enrolment> enrolments{{"c1", "s017", "student"},
                                                    {"c1", "s018", "student"},
                                                    {"c1", "t1", "teacher"},
                                                    {"c1", "e1", "examiner"},
                                                    {"c2", "t2", "teacher"}};
    open.enrol(enrolments, act);
    const std::string exercise = rubric::hashText(tasks::contentHash(blockTask()));
    open.add(school::Assignment{"as1", "c1", exercise, open.pack(exercise)->rubric, "Block & hole", "practice", "", 1,
                                4'000'000'000'000},
             act);
    EXPECT_TRUE(open.enrolStation(kCode, kRoomStation, kRoomKey, 2));
}

/// As that station pushes it; returns the attempt.
inline std::string pushWork(Books& open, Chair& chair, const fs::path& recording, const std::string& person,
                            const std::string& assignment) {
    school::PushedAttempt p;
    p.attempt = *chair.store().attempt(chair.finish(recording, school::newId() + ".h5"));
    p.station = kRoomStation, p.person = person, p.assignment = assignment;
    p.files = {school::sha256Of(recording)};
    p.received = 10;
    const std::vector<std::byte> bytes = core::readFile(recording);
    const school::Upload upload{p.station, p.files.front(), bytes.size()};
    if (const std::uint64_t have = open.received(upload, 3); have < bytes.size())
        (void)open.append(upload, have, std::span(bytes).subspan(have), 3);
    EXPECT_TRUE(open.push(p));
    return p.attempt.id;
}

class PagesTest : public SchoolTest {
  protected:
    void SetUp() override {
        SchoolTest::SetUp();
        Books open = books();
        furnishRoles(open);
        chair_ = std::make_unique<Chair>();
        assigned_ = pushWork(open, *chair_, session(), "s017", "as1");
        practice_ = pushWork(open, *chair_, session(), "s017", "");
        static std::optional<sandboxed::Proof> proof;
        scoreAll(data(), proof);
    }
    std::unique_ptr<Chair> chair_;
    std::string assigned_, practice_;
};

}  // namespace handpiece::school_server
