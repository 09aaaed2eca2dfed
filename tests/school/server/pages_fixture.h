// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// People at browsers, and a school in which each role is somebody.

#include <functional>

#include "handpiece/school/people/secret.h"
#include "school/server/browser.h"
#include "school/worker.h"

namespace handpiece::school_server {

class PagesTest : public SchoolTest {
  protected:
    void SetUp() override {
        SchoolTest::SetUp();
        Books open = books();
        const Act act{"server", 1};
        const std::string hash = school::hashOfPassword(kPassword);
        const auto person = [&](const char* code, const char* name, const char* role) {
            return school::Person{code, name, code, "", hash, {role}, 1, 0};
        };
        const std::vector<school::Person> people{
            person("t1", "Dr. Sato", "teacher"), person("t2", "Dr. Other", "teacher"),
            person("e1", "Examiner", "examiner"), person("a1", "Admin", "administrator"),
            person("s018", "Jun <b>", "student")};
        open.add(people, act);
        open.setPassword("s017", hash, act);
        open.add(school::SchoolClass{"c1", "Operative <1>", "", 0, 1, 0}, act);
        open.add(school::SchoolClass{"c2", "Others", "", 0, 1, 0}, act);
        const std::vector<school::Enrolment> enrolments{{"c1", "s017", "student"},
                                                        {"c1", "s018", "student"},
                                                        {"c1", "t1", "teacher"},
                                                        {"c1", "e1", "examiner"},
                                                        {"c2", "t2", "teacher"}};
        open.enrol(enrolments, act);
        const std::string exercise = rubric::hashText(tasks::contentHash(blockTask()));
        const rubric::Rubric rubric = rubric::parseRubric(kRubric, "rubric.toml");
        open.add(school::Assignment{"as1", "c1", exercise, rubric::hashText(rubric::hashOf(rubric)), "Block & hole",
                                    "practice", "", 1, 4'000'000'000'000},
                 act);
        chair_ = std::make_unique<Chair>();
        assigned_ = push("as1", 0);
        practice_ = push("", 1);
        Worker worker({data(), databaseOf(data())}, systemClock());
        while (worker.workOnce()) {
        }
    }
    std::string push(const std::string& assignment, int number) {
        school::PushedAttempt p;
        p.attempt = *chair_->store().attempt(chair_->finish(session(), fmt::format("{}.h5", number)));
        p.station = std::string(32, 'c'), p.person = "s017", p.assignment = assignment;
        p.files = {school::sha256Of(session())};
        p.received = 10;
        Books open = books();
        if (number == 0) {
            (void)open.enrolStation(kCode, p.station, std::string(64, 'd'), 2);
            const std::vector<std::byte> bytes = core::readFile(session());
            (void)open.append({p.station, p.files.front(), bytes.size()}, 0, bytes, 3);
        }
        EXPECT_TRUE(open.push(p));
        return p.attempt.id;
    }
    std::unique_ptr<Chair> chair_;
    std::string assigned_, practice_;
};

}  // namespace handpiece::school_server
