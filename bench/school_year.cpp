// SPDX-License-Identifier: Apache-2.0
// A year of a school in its books: 200 students, ten assignments, 8,000 attempts, two sessions scored over. How long
// the page of the class takes, alone and while stations push, and all of it queued and shared by two workers.
//     school_year FOLDER [postgresql://...]      (an empty database; the folder is made)
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/split_mix.h"
#include "handpiece/school/store/books.h"

namespace school = handpiece::school;

namespace {

constexpr int kStudents = 200, kAssignments = 10, kTimes = 4, kStations = 30, kPages = 500;
constexpr school::Milliseconds kNow = 1'700'000'000'000;
const school::Act kAdmin{"admin", kNow};

std::string id(std::uint64_t number) {
    return fmt::format("{:032x}", number);
}

/// About as large as what a session of ten minutes is scored to.
std::string result(std::uint64_t seed) {
    std::string text = "{\"criteria\":[";
    while (text.size() < 20'000)
        text += fmt::format("{{\"id\":\"depth\",\"value\":{}}},", handpiece::core::nextSplitMix(seed));
    return text + "0]}";
}

school::PushedAttempt attempt(int number) {
    const auto seed = static_cast<std::uint64_t>(number);
    school::PushedAttempt p;
    p.attempt.id = id(seed + 1);
    p.attempt.exercise = "class-one-46";
    p.attempt.exerciseHash = p.attempt.rubricHash = fmt::format("{:016x}", 1);
    p.attempt.began = kNow + number * 1000;
    p.attempt.finished = p.attempt.began + 600'000;
    p.attempt.device = "pointer";
    p.attempt.score = handpiece::core::unitOf(handpiece::core::splitMix(seed)) * 10.0;
    p.attempt.maxScore = p.attempt.wholeScore = 10.0;
    p.attempt.passed = "teacher";
    p.attempt.result = result(seed);
    p.station = id(static_cast<std::uint64_t>(number % kStations));
    p.person = fmt::format("s{:03}", number % kStudents);
    p.assignment = fmt::format("a{}", number / kStudents % kAssignments);
    p.received = kNow;
    return p;
}

double milliseconds(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void pages(school::Books& books, const char* when) {
    std::vector<double> all;
    std::size_t cells = 0;
    const std::clock_t before = std::clock();
    for (int i = 0; i < kPages; ++i)
        all.push_back(milliseconds([&] { cells = books.classPage("c").cells.size(); }));
    const double cpuMs = 1000.0 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC / kPages;
    std::sort(all.begin(), all.end());
    fmt::print(
        "class page, {}: {} cells, p50 {:.1f} ms, p99 {:.1f} ms, most {:.1f} ms ({} times), {:.1f} ms of this "
        "process\n",
        when, cells, all[all.size() / 2], all[all.size() * 99 / 100], all.back(), all.size(), cpuMs);
}

void fill(school::Books& books) {
    std::vector<school::Person> people;
    std::vector<school::Enrolment> enrolments;
    for (int s = 0; s < kStudents; ++s) {
        people.push_back({fmt::format("s{:03}", s), fmt::format("Student {}", s), fmt::format("login{}", s)});
        enrolments.push_back({"c", people.back().code, "student"});
    }
    books.add(people, kAdmin);
    books.add(school::SchoolClass{"c", "Second year"}, kAdmin);
    books.enrol(enrolments, kAdmin);
    const std::string pack = "an exercise", hash = fmt::format("{:016x}", 1), newer = fmt::format("{:016x}", 2);
    books.append({id(0), school::sha256(pack), pack.size()}, 0, std::as_bytes(std::span(pack.data(), pack.size())),
                 kNow);
    books.add(school::RubricVersion{hash, "r", "one", 1}, kAdmin);
    books.add(school::RubricVersion{newer, "r", "two", 2}, kAdmin);
    books.add(school::Pack{hash, school::sha256(pack), "class-one-46", "Class I", hash}, kAdmin);
    for (int a = 0; a < kAssignments; ++a)
        books.add(school::Assignment{fmt::format("a{}", a), "c", hash, hash, "Week", "practice", "", kNow, kNow + 1},
                  kAdmin);
    for (int s = 0; s < kStations; ++s) {
        const std::string code = fmt::format("code of station {}", s);
        books.offerCode(code, "Room", kNow + 1, kAdmin);
        books.enrolStation(code, id(static_cast<std::uint64_t>(s)), fmt::format("{:040}", s), kNow);
    }
}

/// Two workers until nothing waits. The replay itself takes no part in it.
void work(const std::string& folder, const std::string& address) {
    std::vector<std::thread> workers;
    for (int w = 0; w < 2; ++w)
        workers.emplace_back([&, w] {
            school::Books books(folder, address);
            while (auto job = books.takeJob(fmt::format("w{}", w), kNow, 60'000)) {
                school::Score score;
                score.engine = 1;
                score.state = "proven";
                score.score = 5.0;
                score.maxScore = score.wholeScore = 10.0;
                score.passed = "yes";
                score.result = result(static_cast<std::uint64_t>(job->number));
                score.worker = fmt::format("w{}", w);
                books.finish(*job, score);
            }
        });
    for (std::thread& worker : workers)
        worker.join();
}

}  // namespace

int main(int count, char** words) {
    if (count < 2) {
        std::fputs("school_year FOLDER [postgresql://...]\n", stderr);
        return 2;
    }
    const std::string folder = words[1], address = count > 2 ? words[2] : "";
    try {
        school::Books books(folder, address);
        fill(books);
        constexpr int kAttempts = kStudents * kAssignments * kTimes;
        const double pushed = milliseconds([&] {
            for (int i = 0; i < kAttempts; ++i)
                books.push(attempt(i));
        });
        fmt::print("{} attempts of 20 kB pushed one by one: {:.2f} ms each\n", kAttempts, pushed / kAttempts);
        pages(books, "provisional scores");
        const double worked = milliseconds([&] { work(folder, address); });
        fmt::print("{} jobs taken and finished by two workers: {:.1f} s\n", books.progress("arrival").done,
                   worked / 1000.0);
        pages(books, "proven scores");
        double queued = 0.0;
        std::int64_t jobs = 0;
        for (int a = 0; a < kAssignments; ++a)
            queued += milliseconds(
                [&] { jobs += books.rescore("again", fmt::format("a{}", a), fmt::format("{:016x}", 2), kAdmin); });
        fmt::print("{} jobs queued under another rubric: {:.2f} s\n", jobs, queued / 1000.0);
        work(folder, address);
        std::atomic<bool> isOver = false;
        std::atomic<int> more = 0;
        std::thread pusher([&] {
            school::Books own(folder, address);
            while (!isOver)
                own.push(attempt(kAttempts + more++));
        });
        pages(books, "scored twice, while a station pushes without a pause");
        isOver = true;
        pusher.join();
        fmt::print("{} attempts were pushed meanwhile\n", more.load());
    } catch (const handpiece::core::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
