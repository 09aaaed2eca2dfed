// SPDX-License-Identifier: Apache-2.0
#include "school/station.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/store/content_files.h"
#include "school/line.h"
#include "school/send_file.h"

namespace handpiece::school_station {
namespace {

namespace fs = std::filesystem;

/// What the server itself will refuse tomorrow as well. An answer that cannot be read came damaged, or from somebody
/// else; and a file that arrived as another one was written by two at once (a connection that was cut, and the next):
/// both go again.
bool isFinal(const core::Error& error) {
    constexpr std::string_view kFinal[] = {"books-changed", "books-invalid", "message-damaged"};
    return error.where().starts_with(school_wire::kServer) &&
           std::find(std::begin(kFinal), std::end(kFinal), error.id()) != std::end(kFinal);
}

Line lineTo(const Enrolment& e) {
    return {e.server, e.key, kLinePatience, e.protocol};
}

/// Against the server's; 0: they agree to a minute, or the server is an older one.
school::Milliseconds clockAheadOf(const school_wire::Status& there) {
    constexpr school::Milliseconds kAgrees = 60'000;
    const school::Milliseconds ahead = clockNow() - there.now;
    return there.now == 0 || std::abs(ahead) < kAgrees ? 0 : ahead;
}

class Pusher {
  public:
    Pusher(school::Store& store, const fs::path& sessions, Enrolment& enrolment, const fs::path& file)
        : store_(store), sessions_(sessions), enrolment_(enrolment), file_(file), line_(lineTo(enrolment)) {}

    Pushed run(const core::Progress& progress) {
        // Books that were restored do not have what came after the backup: all of it once more, which is no error.
        const school_wire::Status there = school_wire::statusFrom(line_.get("/api/v1/status"));
        pushed_.clockAhead = clockAheadOf(there);
        serversNow_ = there.now;
        if (there.books != enrolment_.books) {
            if (!enrolment_.books.empty()) enrolment_.sent = 0;
            enrolment_.books = there.books;
            writeEnrolment(enrolment_, file_);
        }
        const std::size_t all = waitingIn(store_, enrolment_);
        std::size_t done = 0;
        for (auto some = store_.outbox(enrolment_.sent); !some.empty(); some = store_.outbox(enrolment_.sent))
            for (const school::Outgoing& one : some) {
                try {
                    send(one);
                } catch (const core::Error& e) {
                    if (!isFinal(e)) throw;
                    pushed_.refused.push_back(fmt::format("{} {}: {}", one.kind, one.id, e.what()));
                }
                enrolment_.sent = one.sequence;
                writeEnrolment(enrolment_, file_);
                ++done;
                core::report(progress, static_cast<double>(done) / static_cast<double>(std::max(done, all)));
            }
        return std::move(pushed_);
    }

  private:
    void send(const school::Outgoing& one) {
        if (one.kind == "attempt") {
            if (const auto attempt = store_.attempt(one.id)) sendAttempt(*attempt);
        } else if (one.kind == "judgement") {
            if (const auto judgement = store_.judgementOf(one.id)) {
                (void)line_.post("/api/v1/judgements", school_wire::toJson(*judgement));
                ++pushed_.judgements;
            }
        }
    }
    /// The one that the school gave to do with this very exercise at that time; empty: practice of one's own.
    std::string assignmentOf(const school::Attempt& attempt) {
        if (!tasks_) tasks_ = school_wire::tasksFrom(line_.get("/api/v1/tasks/" + enrolment_.person));
        // As this computer's clock said. Then, where that is wrong, as the server's would have: what is dated in the
        // server's future was finished by now at the latest.
        const school::Milliseconds inFuture =
            serversNow_ > 0 ? std::max<school::Milliseconds>(0, attempt.finished - serversNow_) : 0;
        for (const school::Milliseconds ahead : {school::Milliseconds{0}, pushed_.clockAhead, inFuture})
            for (const school_wire::Task& t : *tasks_)
                if (t.exerciseHash == attempt.exerciseHash && attempt.finished - ahead >= t.opens &&
                    attempt.began - ahead <= t.closes)
                    return t.assignment;
        return {};
    }
    void sendAttempt(const school::Attempt& attempt) {
        school::PushedAttempt p;
        p.attempt = attempt;
        p.person = enrolment_.person;
        p.assignment = assignmentOf(attempt);
        std::vector<fs::path> files;
        for (const std::string& name : attempt.recordings)
            files.push_back(sessions_ / fs::path(name).filename());
        if (std::all_of(files.begin(), files.end(), [](const fs::path& f) { return core::isThere(f); }))
            for (const fs::path& file : files)
                p.files.push_back(school::sha256Of(file));
        (void)line_.post("/api/v1/attempts", school_wire::toJson(p));
        ++pushed_.attempts;
        for (std::size_t i = 0; i < p.files.size(); ++i)
            sendFile(files[i], p.files[i]);
    }
    void sendFile(const fs::path& file, const std::string& hash) {
        if (const std::uint64_t bytes = school_station::sendFile(line_, file, hash); bytes > 0)
            pushed_.bytes += bytes, ++pushed_.files;
    }

    school::Store& store_;
    const fs::path& sessions_;
    Enrolment& enrolment_;
    const fs::path& file_;
    Line line_;
    std::optional<std::vector<school_wire::Task>> tasks_;
    school::Milliseconds serversNow_ = 0;
    Pushed pushed_;
};

}  // namespace

Enrolment readEnrolment(const fs::path& file) {
    if (!core::isThere(file))
        throw core::Error("this station belongs to no school yet", file.string(),
                          "enrol it: handpiece school enrol SERVER CODE --person CODE")
            .as("not-enrolled");
    constexpr std::size_t kMost = 1 << 16;
    const std::vector<std::byte> bytes = core::readFile(file, kMost);
    try {
        const auto json = nlohmann::json::parse(reinterpret_cast<const char*>(bytes.data()),
                                                reinterpret_cast<const char*>(bytes.data()) + bytes.size());
        return {json.at("server"), json.at("station"), json.at("key"),
                json.at("person"), json.at("sent"),    json.value("books", "")};
    } catch (const nlohmann::json::exception& e) {
        throw core::Error(fmt::format("the enrolment cannot be read: {}", e.what()), file.string(),
                          "enrol the station anew; its results stay");
    }
}

void writeEnrolment(const Enrolment& e, const fs::path& file) {
    const std::string text = nlohmann::ordered_json{{"server", e.server}, {"station", e.station}, {"key", e.key},
                                                    {"person", e.person}, {"sent", e.sent},       {"books", e.books}}
                                 .dump(1) +
                             "\n";
    core::writeFile(file, text, {.ownerOnly = true});
}

Enrolment enrol(const std::string& server, const std::string& code, const std::string& person,
                const std::string& kind) {
    const std::string address = serverAddress(server);
    Line line(address, {});
    const school_wire::Enrolled made = school_wire::enrolledFrom(
        line.post("/api/v1/enrol", school_wire::toJson(school_wire::Enrol{code, person, kind})));
    return {address, made.station, made.key, made.person.empty() ? person : made.person, 0};
}

Pushed push(school::Store& store, const fs::path& sessions, Enrolment& enrolment, const fs::path& file,
            const core::Progress& progress) {
    return Pusher(store, sessions, enrolment, file).run(progress);
}

school::Milliseconds clockNow() {
    return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

std::size_t waitingIn(const school::Store& store, const Enrolment& enrolment) {
    std::size_t waiting = 0;
    std::int64_t from = enrolment.sent;
    for (auto some = store.outbox(from); !some.empty(); some = store.outbox(from))
        waiting += some.size(), from = some.back().sequence;
    return waiting;
}

std::vector<school_wire::Task> tasksOf(const Enrolment& enrolment) {
    Line line = lineTo(enrolment);
    const school::Milliseconds ahead = clockAheadOf(school_wire::statusFrom(line.get("/api/v1/status")));
    std::vector<school_wire::Task> tasks = school_wire::tasksFrom(line.get("/api/v1/tasks/" + enrolment.person));
    for (school_wire::Task& t : tasks)
        t.opens += ahead, t.closes += ahead;
    return tasks;
}

school_wire::Status status(const Enrolment& enrolment) {
    return school_wire::statusFrom(lineTo(enrolment).get("/api/v1/status"));
}

}  // namespace handpiece::school_station
