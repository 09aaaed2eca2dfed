// SPDX-License-Identifier: Apache-2.0
#include "school/server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <atomic>
#include <charconv>
#include <chrono>
#include <map>
#include <mutex>
#include <span>
#include <thread>

#include "handpiece/app/report/school_pages.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/people/throttle.h"
#include "school/books_pool.h"
#include "school/pages.h"
#include "school/task_shelf.h"
#include "school/wire.h"
#include "school/worker.h"

namespace handpiece::school_server {
namespace {

using httplib::Request;
using httplib::Response;
using school::Books;
using school::Milliseconds;

constexpr const char *kJson = "application/json", *kCookie = "handpiece";
constexpr Milliseconds kLoginMs = 12 * 3'600'000;  // a working day
/// Reading and writing of one message, and between two on one connection.
constexpr auto kPatience = std::chrono::seconds(20);
constexpr time_t kKeepAliveS = 5;

int statusOf(const core::Error& error) {
    static const std::map<std::string, int, std::less<>> statuses{
        {"message-damaged", 400}, {"books-invalid", 400},   {"not-enrolled", 401},  {"code-unknown", 403},
        {"books-unknown", 404},   {"books-duplicate", 409}, {"books-changed", 409}, {"upload-offset", 409},
        {"upload-mismatch", 422}, {"no-space", 507},        {"store-locked", 503},  {"store-gone", 503},
        {"store-refused", 503},   {"protocol-other", 426}};
    const auto found = statuses.find(error.id());
    return found != statuses.end() ? found->second : 500;
}

constexpr const char* kPolicy = "Content-Security-Policy";

void answer(Response& response, const std::string& json, int status = 200) {
    response.status = status;
    response.set_header(kPolicy, "default-src 'none'; frame-ancestors 'none'");
    response.set_content(json, kJson);
}
void answer(Response& response, const core::Error& error) {
    // Where it went wrong here is not a station's to know, unless it is its own.
    const int status = statusOf(error);
    if (status < 500 || status == 503 || status == 507) return answer(response, school_wire::toJson(error), status);
    std::fprintf(stderr, "handpiece-school: %s\n", error.what());
    answer(
        response,
        school_wire::toJson(core::Error("something went wrong there", "", "tell who looks after it; it is in its log")
                                .as("server-failed")),
        status);
}

/// A page, or the way to another. `secure`: over TLS, and the cookie never goes over anything else.
void answer(Response& response, const Page& page, bool secure) {
    response.set_header(kPolicy,
                        "default-src 'none'; style-src 'unsafe-inline'; img-src data:; form-action 'self'; base-uri "
                        "'none'; frame-ancestors 'none'");
    if (page.login)
        response.set_header("Set-Cookie",
                            fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict{}; Max-Age={}", kCookie, *page.login,
                                        secure ? "; Secure" : "", page.login->empty() ? 0 : kLoginMs / 1000));
    response.status = page.status;
    if (page.to.empty()) return response.set_content(page.html, "text/html; charset=utf-8");
    response.status = 303;
    response.set_header("Location", page.to);
    response.set_content("", "text/plain");
}

std::string tokenOf(const Request& request) {
    const std::string cookies = request.get_header_value("Cookie"), name = std::string(kCookie) + "=";
    for (std::size_t at = 0; at < cookies.size();) {
        const std::size_t end = std::min(cookies.find(';', at), cookies.size());
        std::string_view one = std::string_view(cookies).substr(at, end - at);
        while (one.starts_with(' '))
            one.remove_prefix(1);
        if (one.starts_with(name) && one.size() == name.size() + 64) return std::string(one.substr(name.size()));
        at = end + 1;
    }
    return {};
}

std::uint64_t numberOf(const Request& request, const char* name) {
    const std::string text = request.get_param_value(name);
    std::uint64_t value = 0;
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || ec != std::errc() || end != text.data() + text.size())
        throw core::Error(fmt::format("\"{}\" is no number", text), name, "send a whole number")
            .as("message-damaged", {name, "is no number"});
    return value;
}

}  // namespace

Clock systemClock() {
    return [] {
        return std::chrono::duration_cast<std::chrono::milliseconds>(
                   std::chrono::system_clock::now().time_since_epoch())
            .count();
    };
}

struct Server::State {
    State(const Settings& s, Clock c) : settings(s), clock(std::move(c)), books({s.data, s.database}), http(make(s)) {
        // What is wrong with the books is told before anybody calls.
        (void)books.take();
        configure();
        for (const Entry& entry : table(this))
            add(entry);
        port = settings.port == 0                                 ? http->bind_to_any_port(settings.host)
               : http->bind_to_port(settings.host, settings.port) ? settings.port
                                                                  : -1;
        if (port < 0)
            throw core::Error(fmt::format("nobody can listen at {}:{}", settings.host, settings.port), "--listen",
                              "another program is there, or the address is none of this machine's: give another one")
                .as("port-taken", {settings.host, std::to_string(settings.port)});
        for (std::size_t i = 0; i < settings.workers; ++i)
            workers.push_back(std::make_unique<Worker>(WorkerSettings{settings.data, settings.database}, clock));
    }

    static std::unique_ptr<httplib::Server> make(const Settings& s) {
        if (s.certificate.empty() != s.key.empty())
            throw core::Error("TLS needs a certificate and its key", "--certificate", "give both, or neither");
        if (s.certificate.empty()) return std::make_unique<httplib::Server>();
        auto server = std::make_unique<httplib::SSLServer>(s.certificate.c_str(), s.key.c_str());
        if (!server->is_valid())
            throw core::Error("certificate or key cannot be used", s.certificate,
                              "give two PEM files that belong together");
        return server;
    }

    void configure() {
        http->new_task_queue = [threads = settings.threads] { return new httplib::ThreadPool(threads); };
        http->set_payload_max_length(std::max(school_wire::kMostMessage, school_wire::kMostPiece));
        http->set_read_timeout(kPatience);
        http->set_write_timeout(kPatience);
        http->set_keep_alive_timeout(kKeepAliveS);
        http->set_tcp_nodelay(true);
        http->set_default_headers(
            {{"X-Content-Type-Options", "nosniff"}, {"Cache-Control", "no-store"}, {"Referrer-Policy", "no-referrer"}});
        http->set_exception_handler([this](const Request&, Response& response, std::exception_ptr thrown) {
            ++failed;
            try {
                std::rethrow_exception(thrown);
            } catch (const std::exception& e) {
                answer(response, core::asError(e));
            } catch (...) {
                answer(response, core::Error("something that is no error was thrown"));
            }
        });
        http->set_error_handler([](const Request&, Response& response) {
            if (!response.body.empty()) return;
            const char* what = response.status == 404   ? "there is nothing at this address"
                               : response.status == 413 ? "that is too long for one message"
                                                        : "this cannot be answered";
            const int status = response.status;
            answer(response,
                   school_wire::toJson(core::Error(what, "", "use programs that belong together").as("not-there")),
                   status);
        });
    }

    using Handler = std::function<void(const Request&, Response&, const school::Station*)>;
    using Shown = std::function<Page(const Request&, const Visit&)>;
    struct Entry {
        Route route;
        Handler handler;  ///< of anyone's and stations' routes
        Shown shown{};    ///< of persons'
    };

    /// Handlers of `of`, which may be null where nobody calls them.
    static std::vector<Entry> table(State* of);

    void add(const Entry& entry) {
        const auto handler = [this, entry](const Request& request, Response& response) {
            ++asked;
            if (entry.route.caller == Caller::anyone) return entry.handler(request, response, nullptr);
            if (entry.route.caller == Caller::person) return show(entry, request, response);
            const school::Station station = stationOf(request);
            entry.handler(request, response, &station);
        };
        const std::string& method = entry.route.method;
        if (method == "GET") http->Get(entry.route.pattern, handler);
        if (method == "POST") http->Post(entry.route.pattern, handler);
        if (method == "PUT") http->Put(entry.route.pattern, handler);
    }

    [[nodiscard]] bool isSecure() const { return !settings.certificate.empty(); }

    void show(const Entry& entry, const Request& request, Response& response) {
        const BooksPool::Lent open = books.take();
        const std::string token = tokenOf(request);
        const Milliseconds now = clock();
        const auto person = token.empty() ? std::nullopt : open->personByToken(token, now);
        if (!person) return answer(response, Page{303, {}, "/login", std::string()}, isSecure());
        const Visit visit{*open, *person, token, now};
        // What changes something came from a page of this very log-in.
        if (entry.route.method == "POST" &&
            !school::isSameSecret(request.get_param_value("token"), school::requestTokenOf(token)))
            return answer(response, refused(config::words()("school.gone"), 403), isSecure());
        answer(response, entry.shown(request, visit), isSecure());
    }

    Page logIn(const Request& request) {
        const std::string login = request.get_param_value("login"), password = request.get_param_value("password");
        const Milliseconds now = clock();
        const std::string from = "from " + request.remote_addr, of = "login " + login;
        {
            const std::lock_guard lock(guessing);
            if (const std::int64_t wait = std::max(throttle.waitMs(from, now), throttle.waitMs(of, now)); wait > 0)
                return {429, report::loginPage(login, config::words()("school.wait", (wait + 999) / 1000)), {}, {}};
            // Counted before it is looked at: a hundred guesses at once are a hundred.
            throttle.failed(from, now), throttle.failed(of, now);
        }
        auto open = books.take();
        constexpr std::size_t kMostPassword = 256;
        const auto person = login.size() <= 200 ? open->personByLogin(login) : std::nullopt;
        bool isRight = false;
        if (password.size() <= kMostPassword) {
            if (person && !person->password.empty())
                isRight = school::isPassword(person->password, password);
            else
                school::spendPasswordTime(password);
        }
        if (!isRight) return {401, report::loginPage(login, config::words()("school.wrong-login")), {}, {}};
        {
            const std::lock_guard lock(guessing);
            throttle.succeeded(from), throttle.succeeded(of);
        }
        const std::string token = school::newSecret();
        open->addLogin(token, person->code, now + kLoginMs, {person->code, now});
        return {303, {}, "/classes", token};
    }

    school::Station stationOf(const Request& request) {
        if (const std::string said = request.get_header_value("Handpiece-Protocol");
            said != std::to_string(school_wire::kProtocol))
            throw core::Error(fmt::format("the station speaks version {} of what the server speaks in version {}",
                                          said.empty() ? "none" : said, school_wire::kProtocol),
                              "", "bring the older of the two up to date; nothing is lost until then")
                .as("protocol-other", {said, std::to_string(school_wire::kProtocol)});
        constexpr std::string_view kBearer = "Bearer ";
        const std::string said = request.get_header_value("Authorization");
        if (said.starts_with(kBearer) && said.size() < 200)
            if (auto station = books.take()->stationByKey(said.substr(kBearer.size()))) return *station;
        throw core::Error("the server does not know this station, or no longer", "",
                          "enrol it with a new code: handpiece school enrol")
            .as("not-enrolled");
    }

    const Settings settings;
    const Clock clock;
    BooksPool books;
    std::unique_ptr<httplib::Server> http;
    int port = -1;
    std::vector<std::unique_ptr<Worker>> workers;
    TaskShelf tasks;
    std::mutex guessing;
    school::Throttle throttle;
    std::atomic<std::uint64_t> asked{0}, failed{0}, attempts{0}, bytes{0};
};

std::vector<Server::State::Entry> Server::State::table(State* of) {
    using school_wire::toJson;
    const auto on = [](const char* method, const char* pattern, Caller caller, Handler handler) {
        return Entry{{method, pattern, caller}, std::move(handler)};
    };
    const auto page = [](const char* method, const char* pattern, Shown shown) {
        return Entry{{method, pattern, Caller::person}, {}, std::move(shown)};
    };
    const auto upload = [](const Request& request, const school::Station& station) {
        return school::Upload{station.id, request.matches[1].str(), numberOf(request, "bytes")};
    };
    return {
        on("GET", "/healthz", Caller::anyone,
           [of](const Request&, Response& response, const school::Station*) {
               (void)of->books.take()->progress("arrival");
               response.set_content("well\n", "text/plain");
           }),
        on("GET", "/metrics", Caller::anyone,
           [of](const Request&, Response& response, const school::Station*) {
               const school::Progress work = of->books.take()->progress("arrival");
               response.set_content(
                   fmt::format("# TYPE handpiece_requests_total counter\nhandpiece_requests_total {}\n"
                               "# TYPE handpiece_failed_total counter\nhandpiece_failed_total {}\n"
                               "# TYPE handpiece_attempts_total counter\nhandpiece_attempts_total {}\n"
                               "# TYPE handpiece_uploaded_bytes_total counter\nhandpiece_uploaded_bytes_total {}\n"
                               "# TYPE handpiece_jobs gauge\nhandpiece_jobs{{state=\"waiting\"}} {}\n"
                               "handpiece_jobs{{state=\"taken\"}} {}\nhandpiece_jobs{{state=\"done\"}} {}\n"
                               "handpiece_jobs{{state=\"failed\"}} {}\n",
                               of->asked.load(), of->failed.load(), of->attempts.load(), of->bytes.load(), work.waiting,
                               work.taken, work.done, work.failed),
                   "text/plain; version=0.0.4");
           }),
        on("POST", "/api/v1/enrol", Caller::anyone,
           [of](const Request& request, Response& response, const school::Station*) {
               const school_wire::Enrol enrol = school_wire::enrolFrom(request.body);
               // A key of 256 bits out of the system's randomness.
               const school_wire::Enrolled made{school::newId(), school::newSecret()};
               if (!of->books.take()->enrolStation(school::typedStationCode(enrol.code), made.station, made.key,
                                                   of->clock()))
                   throw core::Error("this code is not known, was used, or is too old", "",
                                     "have a new one made: handpiece school code")
                       .as("code-unknown");
               answer(response, toJson(made), 201);
           }),
        on("GET", "/api/v1/status", Caller::station,
           [of](const Request&, Response& response, const school::Station* station) {
               school_wire::Status status{HANDPIECE_VERSION, school_wire::kProtocol, core::kEngineRevision, station->id,
                                          of->books.take()->missingFiles(station->id)};
               if (status.missing.size() > 200) status.missing.resize(200);
               answer(response, toJson(status));
           }),
        on("GET", "/api/v1/tasks/([0-9A-Za-z._-]{1,64})", Caller::station,
           [of](const Request& request, Response& response, const school::Station*) {
               const std::string person = request.matches[1];
               auto open = of->books.take();
               std::vector<school_wire::Task> tasks;
               for (const school::SchoolClass& one : open->classes()) {
                   const std::vector<school::Enrolment> in = open->enrolments(one.id);
                   if (std::none_of(in.begin(), in.end(), [&](const school::Enrolment& e) {
                           return e.person == person && e.role == "student";
                       }))
                       continue;
                   for (const school::Assignment& a : open->assignments(one.id))
                       tasks.push_back({a.id, a.pack, a.title, a.opens, a.closes});
               }
               answer(response, toJson(tasks));
           }),
        on("POST", "/api/v1/attempts", Caller::station,
           [of](const Request& request, Response& response, const school::Station* station) {
               school::PushedAttempt pushed = school_wire::attemptFrom(request.body);
               pushed.station = station->id;
               pushed.received = of->clock();
               const bool isNew = of->books.take()->push(pushed);
               if (isNew) ++of->attempts;
               answer(response, "{}", isNew ? 201 : 200);
           }),
        on("POST", "/api/v1/judgements", Caller::station,
           [of](const Request& request, Response& response, const school::Station* station) {
               const school::Judgement judgement = school_wire::judgementFrom(request.body);
               auto open = of->books.take();
               // Of its own attempts only.
               const auto attempt = open->attempt(judgement.attempt);
               if (attempt && attempt->station != station->id)
                   throw core::Error("this attempt is another station's", "", "enrol the station anew")
                       .as("books-unknown", {"attempt", judgement.attempt});
               answer(response, "{}", open->push(judgement) ? 201 : 200);
           }),
        on("GET", "/api/v1/files/([0-9a-f]{64})", Caller::station,
           [of, upload](const Request& request, Response& response, const school::Station* station) {
               const school::Upload file = upload(request, *station);
               const std::uint64_t there = of->books.take()->received(file, of->clock());
               answer(response, toJson(school_wire::Received{there, there == file.bytes}));
           }),
        on("PUT", "/api/v1/files/([0-9a-f]{64})", Caller::station,
           [of, upload](const Request& request, Response& response, const school::Station* station) {
               const school::Upload file = upload(request, *station);
               const std::uint64_t offset = numberOf(request, "offset");
               const bool isWhole =
                   of->books.take()->append(file, offset, std::as_bytes(std::span(request.body)), of->clock());
               of->bytes += request.body.size();
               answer(response, toJson(school_wire::Received{offset + request.body.size(), isWhole}));
           }),
        on("GET", "/login", Caller::anyone,
           [of](const Request&, Response& response, const school::Station*) {
               answer(response, Page{200, report::loginPage({}, {}), {}, {}}, of->isSecure());
           }),
        on("POST", "/login", Caller::anyone,
           [of](const Request& request, Response& response, const school::Station*) {
               answer(response, of->logIn(request), of->isSecure());
           }),
        page("POST", "/logout",
             [](const Request&, const Visit& visit) {
                 visit.books.endLogin(visit.token);
                 return Page{303, {}, "/login", std::string()};
             }),
        page("GET", "/",
             [](const Request&, const Visit&) {
                 return Page{303, {}, "/classes", {}};
             }),
        page("GET", "/classes", [](const Request&, const Visit& visit) { return classesOf(visit); }),
        page("GET", "/classes/([0-9A-Za-z._-]{1,64})",
             [](const Request& request, const Visit& visit) { return classOf(visit, request.matches[1]); }),
        page("GET", "/people/([0-9A-Za-z._-]{1,64})",
             [](const Request& request, const Visit& visit) { return personOf(visit, request.matches[1]); }),
        page("GET", "/attempts/([0-9a-f]{32})",
             [](const Request& request, const Visit& visit) { return attemptOf(visit, request.matches[1]); }),
        page("GET", "/attempts/([0-9a-f]{32})/result",
             [of](const Request& request, const Visit& visit) {
                 return resultOf(visit, request.matches[1], [of](const school::Books& books, const std::string& hash) {
                     return of->tasks.of(books, hash);
                 });
             }),
    };
}

std::vector<Route> Server::routes() {
    std::vector<Route> all;
    for (State::Entry& entry : State::table(nullptr))
        all.push_back(std::move(entry.route));
    return all;
}

Server::Server(const Settings& settings, Clock clock) : state_(std::make_unique<State>(settings, std::move(clock))) {}
Server::~Server() {
    if (state_) stop();
}
int Server::port() const {
    return state_->port;
}
void Server::run() {
    for (const auto& worker : state_->workers)
        worker->start();
    state_->http->listen_after_bind();
    for (const auto& worker : state_->workers)
        worker->stop();
}
void Server::stop() {
    state_->http->stop();
}

}  // namespace handpiece::school_server
