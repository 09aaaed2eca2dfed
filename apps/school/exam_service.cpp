// SPDX-License-Identifier: Apache-2.0
#include "school/exam_service.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/sandboxed/sandboxed.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/exam/invigilation.h"
#include "handpiece/school/exam/lines.h"
#include "handpiece/school/store/content_files.h"
#include "school/answers.h"
#include "school/exam_desk.h"
#include "school/exam_station.h"
#include "school/local_server.h"
#include "school/wire.h"

namespace handpiece::school_exam {
namespace {

namespace fs = std::filesystem;
using httplib::Request;
using httplib::Response;

constexpr std::size_t kMostRecording = std::size_t{1} << 30;
constexpr const char* kReceipt = "receipt.txt";

std::string textOf(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Held while the service lives; the system lets it go with the process.
class OneService {
  public:
    explicit OneService(const fs::path& folder) {
        core::prepareOutputFolder(folder, true);
        file_ = ::open((folder / "service.lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, S_IRUSR | S_IWUSR);
        if (file_ >= 0 && ::flock(file_, LOCK_EX | LOCK_NB) == 0) return;
        if (file_ >= 0) ::close(file_);
        throw core::Error("another service works with these exams, or the folder is not its user's", folder.string(),
                          "one is enough: leave it running")
            .as("exam-busy");
    }
    ~OneService() { ::close(file_); }
    OneService(const OneService&) = delete;
    OneService& operator=(const OneService&) = delete;

  private:
    int file_ = -1;
};

}  // namespace

struct ExamService::State {
    State(ExamServiceSettings s, school_server::Clock c)
        : settings(std::move(s)), clock(std::move(c)), one(settings.folder), exams(settings.folder, clock()) {
        configure();
        std::error_code none;
        fs::remove(settings.socket, none);
        http.set_address_family(AF_UNIX);
        http.set_socket_options([this](socket_t socket) { listening = socket; });
        // The port means nothing to a socket of this machine.
        if (!http.bind_to_port(settings.socket.string(), 80))
            throw core::Error("nobody can listen there", settings.socket.string(),
                              "name a socket in a folder that this user may write to")
                .as("port-taken", {settings.socket.string(), ""});
        // The library lets five wait to be taken: whoever fills these is one account.
        constexpr int kMostWaiting = 1024;
        (void)::listen(listening, kMostWaiting);
        // Every account of this machine may speak to it: what it does hangs on codes.
        ::chmod(settings.socket.c_str(), 0666);
    }
    ~State() {
        std::error_code none;
        fs::remove(settings.socket, none);
    }

    void configure() {
        http.set_payload_max_length(kMostRecording);
        http.set_read_timeout(std::chrono::seconds(20));
        http.set_exception_handler([](const Request&, Response& response, std::exception_ptr thrown) {
            try {
                std::rethrow_exception(thrown);
            } catch (const std::exception& e) {
                const core::Error error = core::asError(e);
                response.status = 400;
                response.set_content(school_wire::toJson(error), "application/json");
            }
        });
        const auto on = [this](auto work) {
            return [this, work](const Request& request, Response& response) {
                const std::lock_guard lock(mutex);
                response.set_content(work(request), "text/plain; charset=utf-8");
            };
        };
        http.Get("/desk", on([this](const Request&) { return toText(desk()); }));
        http.Get("/exercise", on([this](const Request& r) {
                     if (!exams.sitting())
                         throw core::Error("nobody is at an exam here", settings.folder.string(), "begin it")
                             .as("exam-none", {""});
                     requireOwner(r, exams.sitting()->id);
                     return textOf(core::readFile(exams.sitting()->exam.exercise));
                 }));
        http.Post("/look", on([this](const Request& r) {
                      const exam::Sitting sitting = exams.look(field(r, "candidate"), exam::kRubricFormat, clock());
                      const exam::Pack& pack = sitting.exam.pack;
                      const sandboxed::Exercise& of = exerciseOf(sitting);
                      return nlohmann::ordered_json{
                          {"title", pack.title},
                          {"closes_ms", pack.closes},
                          {"minutes", pack.minutes},
                          {"extra_percent", sitting.candidate.extraPercent},
                          {"pause_minutes", sitting.candidate.pauseMinutes},
                          {"time_ms", sitting.deadline - sitting.began},
                          {"locked", exam::lockedFor(pack, sitting.candidate, of.lockedHelps)},
                          {"again", sitting.again},
                          {"titles", of.title},
                          {"instructions", of.instructions}}
                          .dump();
                  }));
        http.Get("/ending", on([this](const Request& r) {
                     requireOwner(r, field(r, "sitting"));
                     return exam::joined(exams.endOf(field(r, "sitting")));
                 }));
        http.Get("/receipt", on([this](const Request& r) {
                     const std::string id = field(r, "sitting");
                     const fs::path file = settings.folder / "sessions" / id / kReceipt;
                     requireOwner(r, id);
                     if (!school::isHex(id, 32) || !core::isThere(file)) return std::string();
                     return textOf(core::readFile(file, 1 << 20));
                 }));
        http.Post("/open", on([this](const Request& r) {
                      exams.open(field(r, "code"), clock(), r.remote_addr);
                      return std::string();
                  }));
        http.Post("/begin", on([this](const Request& r) {
                      (void)exams.begin(field(r, "candidate"), field(r, "invigilator"), field(r, "pin"),
                                        exam::kRubricFormat, clock(), r.remote_addr);
                      keepAccount(r);
                      wake();
                      return toText(desk());
                  }));
        http.Post("/checkpoint", on([this](const Request& r) {
                      requireOwner(r, field(r, "sitting"));
                      exams.checkpoint(field(r, "sitting"), number(r, "part"), number(r, "ticks"), field(r, "inputs"),
                                       clock());
                      return std::string();
                  }));
        http.Put("/recording", [this](const Request& r, Response& response, const httplib::ContentReader& read) {
            take(r, response, read);
        });
        http.Post("/finish", on([this](const Request& r) {
                      const std::string id = field(r, "sitting");
                      requireOwner(r, id);
                      const std::int64_t parts = number(r, "parts");
                      if (parts < 1 || parts > 100)
                          throw core::Error("there is no recording to hand over", id, "name the session's file")
                              .as("exam-damaged", {"parts", ""});
                      std::vector<std::string> works;
                      for (std::int64_t part = 1; part <= parts; ++part)
                          works.push_back(assessment::workHash(exams.placeFor(id, part)));
                      const exam::Signed entry = exams.finish(id, works, clock());
                      wake();
                      return exam::joined(entry);
                  }));
        http.Post("/give-up", on([this](const Request& r) {
                      requireOwner(r, field(r, "sitting"));
                      exams.giveUp(field(r, "sitting"), field(r, "invigilator"), field(r, "pin"), clock(),
                                   r.remote_addr);
                      wake();
                      return std::string();
                  }));
    }

    /// By which account of this machine an exam was begun: others have no hand in it.
    fs::path accountFile(const std::string& sitting) const {
        return settings.folder / "sessions" / sitting / "account";
    }
    void keepAccount(const Request& request) const {
        const std::string& id = exams.sitting()->id;
        (void)exams.placeFor(id, 1);  // makes its folder
        if (const auto account = LocalServer::accountOf(request))
            core::writeFile(accountFile(id), std::to_string(*account), {.ownerOnly = true});
    }
    void requireOwner(const Request& request, const std::string& sitting) const {
        const auto account = LocalServer::accountOf(request);
        // Of one that was begun before this was kept there is none.
        if (!school::isHex(sitting, 32) || !core::isThere(accountFile(sitting))) return;
        const std::string owner = textOf(core::readFile(accountFile(sitting), 100));
        if (account && (*account == 0 || *account == ::geteuid() || std::to_string(*account) == owner)) return;
        throw core::Error("this exam was begun by another account of this computer", sitting,
                          "go on in that account, or call the invigilator")
            .as("exam-account", {});
    }

    static std::string field(const Request& request, const char* name) {
        std::string value = request.get_param_value(name);
        if (value.size() > 200)
            throw core::Error("this is too long", name, "use programs that belong together")
                .as("exam-damaged", {name, ""});
        return value;
    }
    static std::int64_t number(const Request& request, const char* name) {
        return static_cast<std::int64_t>(school_server::numberOf(request, name) & ((std::uint64_t{1} << 53) - 1));
    }
    /// Beside its place first: what was cut off is none.
    void take(const Request& request, Response& response, const httplib::ContentReader& read) {
        fs::path place;
        {
            const std::lock_guard lock(mutex);
            requireOwner(request, field(request, "sitting"));
            place = exams.placeFor(field(request, "sitting"), number(request, "part"));
        }
        const fs::path coming = place.string() + "." + school::newId();
        std::error_code none;
        {
            const core::FileStream file = core::createOwnFile(coming);
            bool isWell = file != nullptr;
            std::uint64_t came = 0;
            const bool isWhole = read([&](const char* bytes, std::size_t count) {
                came += count;
                return isWell = isWell && std::fwrite(bytes, 1, count, file.get()) == count;
            });
            // A hand-over that is cut off replaces nothing.
            if (isWell && (!isWhole || came != request.get_header_value<std::uint64_t>("Content-Length"))) {
                fs::remove(coming, none);
                throw core::Error("the recording did not come whole", place.string(), "hand it over again")
                    .as("exam-damaged", {"recording", ""});
            }
            isWell = isWell && std::fflush(file.get()) == 0 && ::fsync(::fileno(file.get())) == 0;
            if (!isWell) {
                fs::remove(coming, none);
                throw core::Error("the recording could not be kept here", place.string(),
                                  "free some room; the file stays where it was")
                    .as("no-space", {});
            }
        }
        fs::rename(coming, place);
        response.set_content("", "text/plain");
    }

    /// Read once: a desk is asked for every second or two.
    const sandboxed::Exercise& exerciseOf(const exam::Sitting& sitting) const {
        if (exerciseHash != sitting.exam.pack.exercise || exerciseHash.empty()) {
            exercise = sandboxed::exercise(sitting.exam.exercise);
            exerciseHash = sitting.exam.pack.exercise;
        }
        return exercise;
    }
    Desk desk() const {
        Desk d;
        d.now = clock(), d.waiting = waiting, d.trouble = trouble;
        if (const auto& s = exams.sitting()) {
            d.sitting = s->id, d.exam = s->exam.pack.exam, d.title = s->exam.pack.title;
            d.began = s->began, d.deadline = s->deadline, d.again = s->again;
            d.extraPercent = s->candidate.extraPercent, d.pauseMinutes = s->candidate.pauseMinutes;
            d.locked = exam::lockedFor(s->exam.pack, s->candidate, exerciseOf(*s).lockedHelps);
        }
        return d;
    }

    void wake() {
        hasNews = true;
        news.notify_all();
    }
    void tellServer() {
        while (!ends) {
            std::string why;
            try {
                const Fetched fetched = fetchExams(settings.folder);
                if (!fetched.problems.empty()) why = fetched.problems.front();
                open(why);
                (void)pushExams(
                    exams.identity(),
                    [this](std::int64_t number, std::size_t most) {
                        const std::lock_guard lock(mutex);
                        return exams.entriesAfter(number, most);
                    },
                    [this](const std::string& sha256) { return fileOf(sha256); });
                fetchReceipts(exams.identity(), withoutReceipt());
                const std::lock_guard lock(mutex);
                waiting = 0;
            } catch (const std::exception& e) {
                why = core::asError(e).what();
                const std::lock_guard lock(mutex);
                ++waiting;
            }
            std::unique_lock lock(mutex);
            trouble = why;
            news.wait_for(lock, settings.every, [this] { return ends || hasNews; });
            hasNews = false;
        }
    }
    /// What cannot be opened is told, and what else there is to tell goes on.
    void open(std::string& why) const {
        try {
            openExams(settings.folder, clock());
        } catch (const core::Error& e) {
            if (e.id() == "server-silent") throw;
            why = e.what();
        }
    }
    std::vector<std::pair<std::string, fs::path>> withoutReceipt() {
        std::vector<std::pair<std::string, fs::path>> all;
        std::error_code none;
        for (fs::directory_iterator at(settings.folder / "sessions", none), end; !none && at != end;
             at.increment(none)) {
            const std::string id = at->path().filename().string();
            if (!school::isHex(id, 32) || core::isThere(at->path() / kReceipt)) continue;
            const std::lock_guard lock(mutex);
            if (exams.sitting() && exams.sitting()->id == id) continue;
            all.emplace_back(id, at->path() / kReceipt);
        }
        return all;
    }
    fs::path fileOf(const std::string& sha256) const {
        std::error_code none;
        for (fs::recursive_directory_iterator at(settings.folder / "sessions", none), end; !none && at != end;
             at.increment(none))
            if (at->path().extension() == ".h5" && school::sha256Of(at->path()) == sha256) return at->path();
        return {};
    }

    const ExamServiceSettings settings;
    const school_server::Clock clock;
    const OneService one;
    std::mutex mutex;
    exam::Invigilation exams;          ///< guarded by `mutex`
    mutable std::string exerciseHash;  ///< guarded by `mutex`, as what it is of
    mutable sandboxed::Exercise exercise;
    std::int64_t waiting = 0;
    std::string trouble;
    std::condition_variable news;
    bool hasNews = false;
    std::atomic<bool> ends{false};
    socket_t listening = INVALID_SOCKET;
    LocalServer http;
    std::thread teller;
};

ExamService::ExamService(ExamServiceSettings settings, school_server::Clock clock)
    : state_(std::make_unique<State>(std::move(settings), std::move(clock))) {}
ExamService::~ExamService() {
    stop();
    if (state_->teller.joinable()) state_->teller.join();
}

void ExamService::run() {
    state_->teller = std::thread([this] { state_->tellServer(); });
    state_->http.listen_after_bind();
    stop();
    state_->teller.join();
}

void ExamService::stop() {
    {
        const std::lock_guard lock(state_->mutex);
        state_->ends = true;
    }
    state_->news.notify_all();
    state_->http.stop();
}

}  // namespace handpiece::school_exam
