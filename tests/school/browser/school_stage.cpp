// SPDX-License-Identifier: Apache-2.0
// A school with people of every role and real work, served until the input ends: for a browser to walk through.
#include <atomic>
#include <cstdio>

#include "school/server/exam_stage.h"
#include "school/server/pages_fixture.h"
#include "school/server/small_picture.h"
#include "school/worker.h"

namespace handpiece::school_server {
namespace {

void fill(const fs::path& data, Chair& chair) {
    School::furnish(data);
    Books books(data);
    furnishRoles(books);
    const Act act{"server", 1};
    const std::vector<school::Person> more{personAs("e2", "Examiner Two", "examiner"),
                                           personAs("s019", "Never Came", "student")};
    books.add(more, act);
    const std::vector<school::Enrolment> enrolments{
        {"c1", "s019", "student"}, {"c1", "e2", "examiner"}, {"c2", "t1", "teacher"}};
    books.enrol(enrolments, act);
    school::Assignment again = *books.assignment("as1");
    again.id = "as2", again.title = "Again";
    books.add(again, act);
    // Another's session as one's own would be refused.
    const fs::path others = data.parent_path() / "others.h5";
    recordSession(others, 2.6);
    for (const auto& [student, assignment] : std::vector<std::pair<std::string, std::string>>{
             {"s017", "as1"}, {"s017", "as2"}, {"s017", ""}, {"s018", "as1"}})
        (void)pushWork(books, chair, student == "s018" ? others : session(), student, assignment);
    const std::vector<std::string> sittings = holdExam(books, data, {{"s017", session()}, {"s018", others}});
    Worker worker(worksOf({data}, systemClock()));
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
        http.set_default_headers({{"Handpiece-Protocol", "1"}, {"Authorization", "Bearer " + kRoomKey}});
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
