// SPDX-License-Identifier: Apache-2.0
#include "school/simulated_school.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/books.h"
#include "school/http.h"
#include "school/server.h"
#include "school/station_service.h"

namespace handpiece::school_cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kPicturePeriod = 2000ms, kBrowserPeriod = 1000ms;  // as the window and apps/web/live have them
constexpr const char *kPassword = "only for a simulation", *kClass = "class", *kExercise = "0123456789abcdef",
                     *kRubric = "fedcba9876543210";
constexpr std::size_t kMarkAt = 6, kMarkDigits = 8;

std::vector<std::string> filesIn(const fs::path& folder, const std::string& suffix) {
    std::vector<fs::path> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == suffix) names.push_back(entry.path());
    if (names.empty()) throw core::Error("there are no " + suffix + " files", folder.string(), "name another folder");
    std::sort(names.begin(), names.end());
    std::vector<std::string> all;
    for (const fs::path& name : names) {
        const std::vector<std::byte> bytes = core::readFile(name);
        all.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
    return all;
}

/// A server as a process of its own, so that what it costs is its own as well.
class ServerProcess {
  public:
    ServerProcess(const fs::path& data, const std::string& database) {
        int out[2];
        if (pipe(out) != 0) throw core::Error("no pipe can be made", "", "close other programs");
        std::vector<std::string> words{"handpiece-school", "serve",       "--data",    data.string(),
                                       "--listen",         "127.0.0.1:0", "--workers", "0"};
        if (!database.empty()) words.insert(words.end(), {"--database", database});
        std::vector<char*> arguments;
        for (std::string& word : words)
            arguments.push_back(word.data());
        arguments.push_back(nullptr);
        pid_ = fork();
        if (pid_ == 0) {
            dup2(out[1], STDOUT_FILENO);
            close(out[0]), close(out[1]);
            execv("/proc/self/exe", arguments.data());
            _exit(127);
        }
        close(out[1]);
        char c = 0;
        std::string line;
        while (read(out[0], &c, 1) == 1 && c != '\n')
            line += c;
        out_ = out[0];
        address_ = line.substr(0, line.find(' '));
        if (!address_.starts_with("http://")) throw core::Error("the server does not start", line, "see what it says");
    }
    ~ServerProcess() {
        kill(pid_, SIGTERM);
        waitpid(pid_, nullptr, 0);
        close(out_);
    }
    ServerProcess(const ServerProcess&) = delete;
    ServerProcess& operator=(const ServerProcess&) = delete;
    [[nodiscard]] const std::string& address() const { return address_; }
    [[nodiscard]] double cpuS() const {
        std::ifstream in(fmt::format("/proc/{}/stat", pid_));
        std::string text(std::istreambuf_iterator<char>(in), {});
        text = text.substr(text.rfind(')') + 2);
        std::istringstream words(text);
        std::string word;
        double ticks = 0.0;
        for (int i = 3; i <= 15 && words >> word; ++i)
            if (i >= 14) ticks += std::stod(word);  // utime, stime
        return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
    }
    /// The most that it ever held [MB].
    [[nodiscard]] double memoryMb() const {
        std::ifstream in(fmt::format("/proc/{}/status", pid_));
        for (std::string line; std::getline(in, line);)
            if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024.0;
        return 0.0;
    }

  private:
    pid_t pid_ = -1;
    int out_ = -1;
    std::string address_;
};

/// Each picture carries a number (as a comment of its file), by which it is known again when it is shown.
class Captures {
  public:
    std::string mark(const std::string& picture) {
        const std::size_t number = next_++;
        {
            const std::lock_guard lock(mutex_);
            at_[number] = Clock::now();
        }
        const std::string digits = fmt::format("{:08x}", number);
        return picture.substr(0, 2) + "\xFF\xFE" + std::string("\0\x0A", 2) + digits + picture.substr(2);
    }
    /// How long ago it was captured.
    [[nodiscard]] std::pair<std::size_t, Clock::duration> shown(std::string_view picture) const {
        const std::size_t number = std::stoul(std::string(picture.substr(kMarkAt, kMarkDigits)), nullptr, 16);
        const std::lock_guard lock(mutex_);
        return {number, Clock::now() - at_.at(number)};
    }
    [[nodiscard]] std::size_t count() const { return next_; }

  private:
    std::atomic<std::size_t> next_{0};
    mutable std::mutex mutex_;
    std::map<std::size_t, Clock::time_point> at_;
};

/// The codes with which stations enrol.
std::vector<std::string> furnish(const fs::path& data, const SimulatedSchool& s, const std::string& anyFile) {
    school::Books books(data, s.database);
    const school::Act act{"server", school_server::systemClock()()};
    const std::string hash = school::hashOfPassword(kPassword);
    std::vector<school::Person> people;
    std::vector<school::Enrolment> enrolments;
    const auto add = [&](const std::string& code, const char* role) {
        people.push_back({code, "Person " + code, code, "", hash, {role}, act.at, 0});
        enrolments.push_back({kClass, code, role});
    };
    for (std::size_t i = 0; i < s.stations; ++i)
        add(fmt::format("s{}", i), "student");
    for (std::size_t i = 0; i < s.browsers; ++i)
        add(fmt::format("t{}", i), "teacher");
    books.add(people, act);
    books.add(school::SchoolClass{kClass, "Class", "", 0, act.at, 0}, act);
    books.enrol(enrolments, act);
    // Nobody cuts again here (no worker), so no exercise is read: any file stands for it.
    const fs::path file = data / "any";
    core::writeFile(file, anyFile);
    const std::string sha = school::sha256Of(file);
    (void)books.append({std::string(32, '0'), sha, anyFile.size()}, 0, std::as_bytes(std::span(anyFile)), act.at);
    books.add(school::RubricVersion{kRubric, "rubric", "", 1, act.at}, act);
    books.add(school::Pack{kExercise, sha, "exercise", "Exercise", kRubric, act.at}, act);
    books.add(school::Assignment{"assignment", kClass, kExercise, kRubric, "Class II, first try", "practice", "",
                                 act.at - 1000, act.at + 1'000'000'000},
              act);
    std::vector<std::string> codes;
    for (std::size_t i = 0; i < s.stations; ++i)
        books.offerCode(codes.emplace_back(school::newStationCode()), fmt::format("chair {}", i + 1),
                        act.at + 1'000'000'000, act);
    return codes;
}

/// A station with a home of its own and the real side of its.
class Station {
  public:
    Station(const fs::path& home, const std::string& server, const std::string& code, std::size_t number,
            const std::vector<std::string>& pictures, const std::vector<std::string>& sessions, Captures& captures,
            const SimulatedSchool& s)
        : home_(home),
          number_(number),
          pictures_(pictures),
          sessions_(sessions),
          captures_(captures),
          settings_(s),
          store_((fs::create_directories(home / "sessions"), home / "results.db")) {
        school_station::Enrolment e = school_station::enrol(server, code, fmt::format("s{}", number));
        school_station::writeEnrolment(e, home / "school.json");
        service_ = std::make_unique<school_station::StationService>(
            school_station::StationFolders{home, home / "sessions"}, [this](const school_station::Standing& standing) {
                waiting_ = standing.waiting;
                watchers_ = std::max<std::size_t>(watchers_, standing.watchers.size());
            });
    }
    void run(Clock::time_point from, Clock::time_point until) {
        std::mt19937 chance(static_cast<unsigned>(number_));
        const auto within = std::chrono::duration_cast<std::chrono::milliseconds>(until - from).count();
        std::vector<Clock::time_point> finishes;
        for (std::size_t i = 0; i < settings_.attempts; ++i)
            finishes.push_back(from + std::chrono::milliseconds(chance() % std::max<std::int64_t>(within * 3 / 4, 1)));
        std::sort(finishes.begin(), finishes.end());
        // They do not begin all at once.
        auto next = from + kPicturePeriod * static_cast<int>(number_) / static_cast<int>(settings_.stations);
        for (std::size_t i = 0; next < until; ++i, next += kPicturePeriod) {
            std::this_thread::sleep_until(next);
            for (; finished_ < finishes.size() && finishes[finished_] <= next; ++finished_)
                finish();
            school_wire::Live live;
            live.exerciseHash = kExercise;
            live.title = "Exercise";
            live.elapsedS = static_cast<double>(2 * i);
            live.removedMm3 = 0.05 * static_cast<double>(i);
            if (i % 10 > 7) live.flags = {"neighbour-touched"};
            live.picture = captures_.mark(pictures_[(number_ + i) % pictures_.size()]);
            service_->show(std::move(live));
        }
    }
    [[nodiscard]] std::size_t waiting() const { return waiting_; }
    [[nodiscard]] std::size_t watchers() const { return watchers_; }

  private:
    void finish() {
        const std::string name = fmt::format("{}.h5", finished_);
        core::writeFile(home_ / "sessions" / name, sessions_[(number_ + finished_) % sessions_.size()]);
        school::Attempt a;
        a.id = school::newId();
        a.exercise = "exercise", a.exerciseHash = kExercise, a.rubricHash = kRubric;
        a.sessionHashes = {std::string(16, '0')}, a.recordings = {name};
        a.finished = school_server::systemClock()(), a.began = a.finished - 100'000;
        a.device = "simulated", a.score = 50.0, a.maxScore = 100.0, a.wholeScore = 100.0, a.passed = "teacher";
        a.result = "{}";
        store_.add(a);
        waiting_ = 1;  // until it is told otherwise
        service_->push();
    }
    const fs::path home_;
    const std::size_t number_;
    const std::vector<std::string>&pictures_, &sessions_;
    Captures& captures_;
    const SimulatedSchool& settings_;
    school::Store store_;
    std::size_t finished_ = 0;
    std::atomic<std::size_t> waiting_{0}, watchers_{0};
    std::unique_ptr<school_station::StationService> service_;
};

/// What apps/web/live does, but for drawing.
class Browser {
  public:
    Browser(const std::string& server, std::size_t number, const Captures& captures, bool singly)
        : http_(server), captures_(captures), singly_(singly) {
        http_.set_keep_alive(true);
        const auto in =
            http_.Post("/login", httplib::Params{{"login", fmt::format("t{}", number)}, {"password", kPassword}});
        if (!in || in->status != 303) throw core::Error("a simulated teacher cannot log in", server, "see its log");
        const std::string set = in->get_header_value("Set-Cookie");
        headers_ = {{"Cookie", set.substr(0, set.find(';'))}};
        (void)http_.Get(fmt::format("/classes/{}/live", kClass), headers_);
    }
    void run(Clock::time_point until, std::size_t number, std::size_t of) {
        std::uint64_t since = 0;
        auto next = Clock::now() + kBrowserPeriod * static_cast<int>(number) / static_cast<int>(of);
        while (next < until) {
            std::this_thread::sleep_until(next);
            const auto asked = Clock::now();
            ask(since);
            next = std::max(next + kBrowserPeriod, asked + kBrowserPeriod);
        }
    }
    std::vector<double> latenciesS;
    std::size_t failures = 0, bytes = 0;

  private:
    void took(std::string_view picture) {
        const auto [number, ago] = captures_.shown(picture);
        latenciesS.push_back(std::chrono::duration<double>(ago).count());
    }
    void ask(std::uint64_t& since) {
        const auto answer = http_.Get(
            fmt::format("/classes/{}/live/feed?since={}", kClass, singly_ ? 1'000'000'000'000'000 : since), headers_);
        if (!answer || answer->status != 200) {
            ++failures;
            return;
        }
        bytes += answer->body.size();
        auto [json, pictures] = school_wire::unframed(answer->body);
        const auto feed = nlohmann::json::parse(json);
        for (const auto& tile : feed["tiles"]) {
            const std::string station = tile["station"];
            const std::uint64_t sequence = tile["sequence"];
            if (singly_) {
                if (seen_[station] == sequence) continue;
                seen_[station] = sequence;
                const auto one = http_.Get(fmt::format("/live/{}/picture?n={}", station, sequence), headers_);
                if (!one || one->status != 200) {
                    ++failures;
                    continue;
                }
                bytes += one->body.size();
                took(one->body);
                continue;
            }
            const std::size_t length = tile["bytes"];
            if (length > 0) took(pictures.substr(0, length));
            pictures.remove_prefix(length);
        }
        if (!singly_) since = feed["sequence"];
    }
    httplib::Client http_;
    httplib::Headers headers_;
    const Captures& captures_;
    const bool singly_;
    std::map<std::string, std::uint64_t> seen_;
};

double ownCpuS() {
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    const auto s = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return s(used.ru_utime) + s(used.ru_stime);
}

}  // namespace

void simulateSchool(const SimulatedSchool& s) {
    const std::vector<std::string> pictures = filesIn(s.pictures, ".jpg"), sessions = filesIn(s.sessions, ".h5");
    const core::PrivateFolder folder;
    const fs::path data = folder.path() / "server";
    fs::create_directories(data);
    const std::vector<std::string> codes = furnish(data, s, sessions.front());
    const ServerProcess server(data, s.database);
    Captures captures;
    std::vector<std::unique_ptr<Station>> stations;
    for (std::size_t i = 0; i < s.stations; ++i)
        stations.push_back(std::make_unique<Station>(folder.path() / fmt::format("s{}", i), server.address(), codes[i],
                                                     i, pictures, sessions, captures, s));
    std::vector<std::unique_ptr<Browser>> browsers;
    for (std::size_t i = 0; i < s.browsers; ++i)
        browsers.push_back(std::make_unique<Browser>(server.address(), i, captures, s.singly));

    const double cpuBefore = server.cpuS(), ownBefore = ownCpuS();
    const auto began = Clock::now(), until = began + std::chrono::seconds(s.seconds);
    std::vector<std::thread> threads;
    for (const auto& station : stations)
        threads.emplace_back([&] { station->run(began, until); });
    for (std::size_t i = 0; i < browsers.size(); ++i)
        threads.emplace_back([&, i] { browsers[i]->run(until, i, browsers.size()); });
    for (std::thread& thread : threads)
        thread.join();
    const double wallS = std::chrono::duration<double>(Clock::now() - began).count();
    const double cpu = (server.cpuS() - cpuBefore) / wallS, own = (ownCpuS() - ownBefore) / wallS;
    // What was finished late is still on its way.
    for (const auto& station : stations)
        for (int i = 0; i < 600 && station->waiting() > 0; ++i)
            std::this_thread::sleep_for(100ms);

    std::vector<double> all;
    std::size_t failures = 0, bytes = 0, pictureBytes = 0, leastWatchers = s.browsers;
    for (const auto& browser : browsers) {
        all.insert(all.end(), browser->latenciesS.begin(), browser->latenciesS.end());
        failures += browser->failures, bytes += browser->bytes;
    }
    for (const std::string& picture : pictures)
        pictureBytes += picture.size();
    for (const auto& station : stations)
        leastWatchers = std::min(leastWatchers, station->watchers());
    std::sort(all.begin(), all.end());
    const auto at = [&](double share) {
        return all.empty()
                   ? 0.0
                   : all[std::min(all.size() - 1, static_cast<std::size_t>(share * static_cast<double>(all.size())))];
    };
    std::size_t there = 0, whole = 0;
    school::Books books(data, s.database);
    for (std::size_t i = 0; i < s.stations; ++i)
        for (const school::PushedAttempt& one : books.attemptsOf(fmt::format("s{}", i))) {
            ++there;
            whole += std::all_of(one.files.begin(), one.files.end(),
                                 [&](const std::string& file) { return core::isThere(books.files().path(file)); });
        }
    fmt::print("{} stations, {} browsers ({}), {:.0f} s; pictures of {:.1f} kB, sessions of {:.2f} MB\n", s.stations,
               s.browsers, s.singly ? "a request a picture" : "all in one answer", wallS,
               1e-3 * static_cast<double>(pictureBytes) / static_cast<double>(pictures.size()),
               1e-6 * static_cast<double>(sessions.front().size()));
    fmt::print(
        "from capture to display: p50 {:.2f} s, p99 {:.2f} s, worst {:.2f} s; {} captured, {} shown of {} ({} "
        "failures)\n",
        at(0.5), at(0.99), all.empty() ? 0.0 : all.back(), captures.count(), all.size(), captures.count() * s.browsers,
        failures);
    fmt::print(
        "server: {:.1f} % of a core, {:.0f} MB at most, {:.2f} MB/s to browsers; stations and browsers: {:.1f} % of a "
        "core\n",
        100.0 * cpu, server.memoryMb(), 1e-6 * static_cast<double>(bytes) / wallS, 100.0 * own);
    fmt::print("attempts: {} finished, {} there, {} with their session; each station was told of {} watchers or more\n",
               s.stations * s.attempts, there, whole, leastWatchers);
    if (there != s.stations * s.attempts || whole != there)
        throw core::Error("work was lost or doubled", data.string(), "see what the server says");
}

}  // namespace handpiece::school_cli
