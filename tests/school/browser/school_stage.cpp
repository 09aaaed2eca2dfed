// SPDX-License-Identifier: Apache-2.0
// A school with people of every role and real work, served until the input ends: for a browser to walk through.
#include <atomic>
#include <cstdio>

#include "handpiece/school/people/secret.h"
#include "school/server/exam_stage.h"
#include "school/server/school_fixture.h"
#include "school/server/small_picture.h"
#include "school/worker.h"

namespace handpiece::school_server {
namespace {

constexpr const char* kPassword = "a long enough one";

void fill(const fs::path& data, Chair& chair) {
    School::furnish(data);
    Books books(data);
    const Act act{"server", 1};
    const std::string hash = school::hashOfPassword(kPassword);
    const auto person = [&](const char* code, const char* name, const char* role) {
        return school::Person{code, name, code, "", hash, {role}, 1, 0};
    };
    const std::vector<school::Person> people{
        person("t1", "Dr. Sato", "teacher"),      person("e1", "Examiner One", "examiner"),
        person("e2", "Examiner Two", "examiner"), person("a1", "Office", "administrator"),
        person("s018", "Jun <b>", "student"),     person("s019", "Never Came", "student")};
    books.add(people, act);
    books.setPassword("s017", hash, act);
    books.add(school::SchoolClass{"c1", "Operative <1>", "", 0, 1, 0}, act);
    books.add(school::SchoolClass{"c2", "Nobody yet", "", 0, 1, 0}, act);
    const std::vector<school::Enrolment> enrolments{
        {"c1", "s017", "student"}, {"c1", "s018", "student"}, {"c1", "s019", "student"}, {"c1", "t1", "teacher"},
        {"c1", "e1", "examiner"},  {"c1", "e2", "examiner"},  {"c2", "t1", "teacher"}};
    books.enrol(enrolments, act);
    const std::string exercise = rubric::hashText(tasks::contentHash(blockTask()));
    const std::string rubricHash = rubric::hashText(rubric::hashOf(rubric::parseRubric(kRubric, "rubric.toml")));
    for (const char* id : {"as1", "as2"})
        books.add(
            school::Assignment{id, "c1", exercise, rubricHash, id == std::string("as1") ? "Block & hole" : "Again",
                               "practice", "", 1, 4'000'000'000'000},
            act);
    const std::string station(32, 'c');
    (void)books.enrolStation(kCode, station, std::string(64, 'd'), 2);
    int number = 0;
    // Another's session as one's own would be refused.
    const fs::path others = data.parent_path() / "others.h5";
    recordSession(others, 2.6);
    for (const auto& [student, assignment] : std::vector<std::pair<std::string, std::string>>{
             {"s017", "as1"}, {"s017", "as2"}, {"s017", ""}, {"s018", "as1"}}) {
        const fs::path file = student == "s018" ? others : session();
        school::PushedAttempt p;
        p.attempt = *chair.store().attempt(chair.finish(file, fmt::format("{}.h5", ++number)));
        p.station = station, p.person = student, p.assignment = assignment;
        p.files = {school::sha256Of(file)};
        p.received = 10;
        const std::vector<std::byte> bytes = core::readFile(file);
        const school::Upload upload{station, p.files.front(), bytes.size()};
        if (const std::uint64_t have = books.received(upload, 3); have < bytes.size())
            (void)books.append(upload, have, std::span(bytes).subspan(have), 3);
        (void)books.push(p);
    }
    const std::vector<std::string> sittings = holdExam(books, data, {{"s017", session()}, {"s018", others}});
    Worker worker({data}, systemClock());
    while (worker.workOnce()) {
    }
    decideExam(books, sittings.at(0), "confirm", "t1", "fail", "The floor is too deep <b>");
    decideExam(books, sittings.at(0), "appeal", "s017", "", "It is within the range");
}

void serve() {
    const test::TemporaryFolder folder;
    Chair chair;
    fill(folder.path() / "school", chair);
    const School school(folder.path() / "school", 1);
    // Somebody is at work all the while.
    std::atomic<bool> ends{false};
    std::thread working([&] {
        httplib::Client http(school.address());
        http.set_default_headers({{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer " + std::string(64, 'd')}});
        school_wire::Live live;
        live.person = "s017", live.assignment = "as1";
        live.exerciseHash = rubric::hashText(tasks::contentHash(blockTask()));
        live.flags = {"pulp-exposed", "neighbour-cut"};
        for (; !ends; std::this_thread::sleep_for(std::chrono::milliseconds(500))) {
            live.elapsedS += 0.5, live.removedMm3 += 0.01, live.picture = picture();
            (void)http.Put("/api/v1/live", toBytes(live), "application/octet-stream");
        }
    });
    std::printf("%s\n", school.address().c_str());
    std::fflush(stdout);
    while (std::getchar() != EOF) {
    }
    ends = true;
    working.join();
}

}  // namespace
}  // namespace handpiece::school_server

int main() {
    handpiece::school_server::serve();
}
