// SPDX-License-Identifier: Apache-2.0
// An exam at many stations, while everything that holds it is killed again and again: nothing is lost, nobody accused.
// HANDPIECE_KILLS=50: thirty stations, and each of server, worker, reader, service and database so often.
#include <gmock/gmock.h>

#include "handpiece/app/proving/exam_check.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/exam_books.h"
#include "school/exam_arrival.h"
#include "school/exam_desk.h"
#include "school/exam_station.h"
#include "school/robust/robust_fixture.h"

namespace handpiece::school_server::exam_kill_test {
namespace {

using school::ExamBooks;

class ExamKillTest : public RobustTest {
  protected:
    static constexpr const char *kPin = "PPP-QQQ-RRR-SSS", *kExam = "ex1";
    enum class Victim { server, reader, service, database, worker };

    struct Seat {
        std::string person, code;
        fs::path service, socket, recording;
        std::unique_ptr<Program> program{};
        std::string sitting{}, trouble{};
    };

    void holdExam(std::size_t seats) {
        School::furnish(data_, database_);
        Books open = books();
        const Act act{"server", 1};
        const school::Milliseconds now = systemClock()();
        const school::Person teacher{"t1", "Dr. Sato", "t1", "", "", {"teacher"}, 1, 0};
        open.add(std::span(&teacher, 1), act);
        open.add(school::SchoolClass{"c1", "Operative", "", 0, 1, 0}, act);
        const std::string exercise = rubric::hashText(tasks::contentHash(blockTask()));
        open.add(school::Assignment{kExam, "c1", exercise, open.pack(exercise)->rubric, "Block exam", "exam", "",
                                    now - 3'600'000, now + 3'600'000},
                 act);
        ExamBooks exams(open);
        exams.set(school::ExamSettings{kExam, 30, "undo"}, act);
        exams.set(school::ExamInvigilator{kExam, "t1", "-"}, act);
        const std::string hash = school::hashOfPassword(kPin);
        for (std::size_t i = 0; i < seats; ++i) {
            Seat seat{fmt::format("k{:03}", i), fmt::format("123-456-789-{:03}", i),
                      folder_.path() / fmt::format("exam{}", i), folder_.path() / fmt::format("exam{}.sock", i),
                      folder_.path() / fmt::format("work{}.h5", i)};
            const school::Person student{seat.person, seat.person, "", "", "", {"student"}, 1, 0};
            open.add(std::span(&student, 1), act);
            const school::Enrolment in{"c1", seat.person, "student"};
            open.enrol(std::span(&in, 1), act);
            exams.set(school::ExamCandidate{kExam, seat.person, exam::candidateHash(kExam, seat.code), 0, 0, ""}, act);
            exams.add(school::ExamConfirmation{kExam, seat.person, 0, hash}, act);
            // A hole of their own.
            recordSession(seat.recording, 1.3,
                          simulation::hole(-1.2 + 2.4 * static_cast<double>(i) / static_cast<double>(seats)));
            seats_.push_back(std::move(seat));
        }
        (void)signExam(open, kExam, examKey(data_), act);
    }
    void setUpStations() {
        for (std::size_t i = 0; i < seats_.size(); ++i) {
            const std::string code = school::newStationCode();
            books().offerCode(code, fmt::format("seat {}", i), 4'000'000'000'000, {"server", 1}, "exam");
            school_exam::enrolForExams(address(), code, seats_[i].service);
        }
        Books open = books();
        for (const school::Station& one : school::BooksAccounts(open).stations())
            if (one.kind == "exam") open.releaseForExams(one.id, {"server", 1});
        for (Seat& seat : seats_) {
            ASSERT_EQ(school_exam::fetchExams(seat.service).packs.size(), 1u);
            school_exam::openExams(seat.service, systemClock()());
            seat.program = serviceOf(seat);
        }
    }
    std::unique_ptr<Program> serviceOf(const Seat& seat) const {
        return std::make_unique<Program>(std::vector<std::string>{"exam", "serve", "--service", seat.service.string(),
                                                                  "--socket", seat.socket.string()},
                                         log());
    }
    std::unique_ptr<Program> worker() const {
        return std::make_unique<Program>(
            std::vector<std::string>{"worker", "run", "--home", (folder_.path() / "machine").string(), "--workers",
                                     "2"},
            log());
    }
    /// A candidate and their window, which asks again where the service is gone for a moment.
    static void sit(Seat& seat, std::chrono::milliseconds thinks) {
        const school_exam::ExamClient client(seat.socket);
        const auto persist = [&](const auto& does) {
            for (int i = 0; i < 6000 && seat.trouble.empty(); ++i, std::this_thread::sleep_for(50ms))
                try {
                    return does();
                } catch (const core::Error& e) {
                    if (e.id() != "exam-service") seat.trouble = e.what();
                }
            if (seat.trouble.empty()) seat.trouble = "its service never came back";
        };
        std::string sitting;
        // What a kill took the answer of may have been done all the same.
        persist([&] {
            sitting = client.desk().sitting;
            if (sitting.empty()) sitting = client.begin(seat.code, "t1", kPin).sitting;
        });
        std::this_thread::sleep_for(thinks);
        proving::RecordedInputs inputs(seat.recording);
        inputs.goOn();
        persist([&] { client.checkpoint(sitting, 1, inputs.ticks(), inputs.hash()); });
        std::this_thread::sleep_for(thinks);
        persist([&] {
            if (client.desk().sitting == sitting)
                (void)client.finish(sitting, {seat.recording});
            else
                (void)client.ending(sitting);
        });
        seat.sitting = sitting;
    }
    bool killOne(Victim victim, std::unique_ptr<Program>& server, std::unique_ptr<Program>& machine) {
        switch (victim) {
            case Victim::server:
                server->kill();
                server = serve();
                return true;
            case Victim::reader: {
                const std::vector<pid_t> readers = childrenOf(machine->id());
                return !readers.empty() && ::kill(readers.front(), SIGKILL) == 0;
            }
            case Victim::service: {
                Seat& seat = seats_[random_() % seats_.size()];
                seat.program->kill();
                seat.program = serviceOf(seat);
                return true;
            }
            case Victim::database:
                postgres()->kill();
                postgres()->run();
                return true;
            case Victim::worker:
                machine->kill();
                machine = worker();
                return true;
        }
        return false;
    }

    std::vector<Seat> seats_;
};
INSTANTIATE_TEST_SUITE_P(OnBoth, ExamKillTest, testing::Values("sqlite", "postgres"),
                         [](const auto& all) { return std::string(all.param); });

TEST_P(ExamKillTest, NothingIsLostAndNobodyAccused) {
    const int kills = times("HANDPIECE_KILLS", 2);
    const bool isWhole = std::getenv("HANDPIECE_KILLS") != nullptr;
    if (isPostgres() && !isWhole) GTEST_SKIP() << "HANDPIECE_KILLS=2 holds an exam on this database, too";
    holdExam(isWhole ? 30 : 3);
    std::unique_ptr<Program> server = serve();
    setUpStations();
    const std::string code = school::newStationCode();
    books().offerCode(code, "machine", 4'000'000'000'000, {"server", 1}, "worker");
    fs::create_directories(folder_.path() / "machine");
    school_station::writeEnrolment(school_station::enrol(address(), code, "", "worker"),
                                   folder_.path() / "machine" / "worker.json");
    std::unique_ptr<Program> machine = worker();
    // Works come one by one while all this goes on.
    std::vector<std::thread> candidates;
    for (Seat& seat : seats_)
        candidates.emplace_back(
            [&seat, thinks = std::chrono::milliseconds(random_() % (isWhole ? 60'000 : 1500))] { sit(seat, thinks); });
    std::vector<Victim> victims;
    for (int i = 0; i < kills; ++i) {
        victims.insert(victims.end(), {Victim::server, Victim::reader, Victim::service});
        if (isPostgres()) victims.push_back(Victim::database);
        // Its work waits for two minutes then.
        if (isWhole) victims.push_back(Victim::worker);
    }
    std::shuffle(victims.begin(), victims.end(), random_);
    std::map<Victim, int> killed;
    for (const Victim one : victims) {
        sleepUpTo(600);
        // A reader is there for a moment only.
        for (int i = 0; i < 100; ++i, std::this_thread::sleep_for(20ms))
            if (killOne(one, server, machine)) {
                ++killed[one];
                break;
            }
    }
    for (std::thread& one : candidates)
        one.join();
    for (const Seat& seat : seats_)
        ASSERT_EQ(seat.trouble, "") << seat.person << ", seed " << seed_;
    const auto ended = [&] {
        const school::Progress work = books().progress("arrival");
        return work.done + work.failed == static_cast<std::int64_t>(seats_.size());
    };
    for (int i = 0; i < 3000 && !ended(); ++i)
        std::this_thread::sleep_for(200ms);
    std::printf("killed: server %d, reader %d, service %d, database %d, worker %d\n", killed[Victim::server],
                killed[Victim::reader], killed[Victim::service], killed[Victim::database], killed[Victim::worker]);
    Books open = books();
    // Whose readers and workers were killed five times waits an hour.
    if (const std::int64_t failed = open.progress("arrival").failed; failed > 0) {
        std::printf("%lld killed five times: tried again an hour later\n", static_cast<long long>(failed));
        EXPECT_EQ(open.retry(systemClock()() + 4'000'000), failed);
        for (int i = 0; i < 3000 && open.progress("arrival").done < static_cast<std::int64_t>(seats_.size()); ++i)
            std::this_thread::sleep_for(200ms);
    }
    EXPECT_EQ(open.progress("arrival").done, static_cast<std::int64_t>(seats_.size())) << logged();
    for (const Seat& seat : seats_) {
        const std::vector<school::PushedAttempt> works = open.attemptsOf(seat.person, kExam);
        ASSERT_EQ(works.size(), 1u) << seat.person << ": " << logged();
        EXPECT_EQ(works.front().attempt.id, seat.sitting);
        ASSERT_EQ(works.front().files.size(), 1u);
        EXPECT_EQ(works.front().files.front(), school::sha256Of(seat.recording));
        EXPECT_EQ(school::sha256Of(open.files().path(works.front().files.front())), works.front().files.front());
        const std::vector<school::Score> scores = open.scoresOf(seat.sitting);
        ASSERT_EQ(scores.size(), 1u) << seat.person;
        EXPECT_EQ(scores.front().state, "proven") << scores.front().reason;
        for (const std::string& doubt : doubtsOf(open, *ExamBooks(open).sitting(seat.sitting)))
            EXPECT_THAT(doubt, testing::HasSubstr("service was started again")) << "that it was, it was";
    }
    for (Seat& seat : seats_)
        EXPECT_EQ(seat.program->terminate(), 0);
    EXPECT_EQ(machine->terminate(), 0);
    EXPECT_EQ(server->terminate(), 0);
}

}  // namespace
}  // namespace handpiece::school_server::exam_kill_test
