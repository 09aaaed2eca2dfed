// SPDX-License-Identifier: Apache-2.0
#include "school/server.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <string_view>
#include <utility>
#include <variant>

#include "handpiece/base/config/words.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/error.h"
#include "handpiece/school/people/secret.h"
#include "school/answers.h"
#include "school/door.h"
#include "school/growing_pool.h"
#include "school/housekeeper.h"
#include "school/routes.h"
#include "school/slow_guard.h"
#include "school/wire.h"
#include "school/worker.h"

namespace handpiece::school_server {
namespace {

using httplib::Request;
using httplib::Response;
using school::Milliseconds;

/// Reading and writing of one message, and between two on one connection.
constexpr auto kPatience = std::chrono::seconds(20);
constexpr time_t kKeepAliveS = 5;

/// That the request of this thread was refused at the door.
thread_local bool refusedNow = false;

/// Each connection takes a descriptor, and the 1024 that a system gives to whoever asks for no more are soon gone. How
/// many connections there may be: some are kept for books, files and workers.
std::size_t roomForConnections() {
    constexpr rlim_t kWanted = 8192, kKept = 256;
    rlimit there{};
    if (getrlimit(RLIMIT_NOFILE, &there) != 0) return kWanted - kKept;
    if (there.rlim_cur < kWanted) {
        const rlimit more{std::min(there.rlim_max, kWanted), there.rlim_max};
        if (setrlimit(RLIMIT_NOFILE, &more) == 0) there = more;
    }
    const rlim_t all = std::min(there.rlim_cur, kWanted);
    return all > 2 * kKept ? all - kKept : all / 2;
}

/// All there are: what is not in here is answered with 404.
std::vector<Entry> everyRoute(Service* service) {
    std::vector<Entry> all;
    for (const auto room : {generalRoutes, stationRoutes, pageRoutes, liveRoutes, teachingRoutes, examRoutes,
                            signOnRoutes, officeRoutes, workerRoutes})
        for (Entry& entry : room(service))
            all.push_back(std::move(entry));
    return all;
}

bool isProxy(const std::string& address, const Settings& settings) {
    const auto in = [&](const std::vector<std::string>& all) {
        return std::find(all.begin(), all.end(), address) != all.end();
    };
    return in(settings.proxies) || in(settings.signOn.proxies);
}

}  // namespace

bool isSecure(const Request& request, const Settings& settings) {
    if (!settings.certificate.empty()) return true;
    // Of two, one is what the browser wrote.
    return isProxy(request.remote_addr, settings) && request.get_header_value_count("X-Forwarded-Proto") == 1 &&
           request.get_header_value("X-Forwarded-Proto") == "https";
}

std::string clientOf(const Request& request, const Settings& settings) {
    if (!isProxy(request.remote_addr, settings)) return request.remote_addr;
    // Each proxy adds whom it saw at the end; what stands before that anybody may have written.
    std::string all;
    for (auto [at, end] = request.headers.equal_range("X-Forwarded-For"); at != end; ++at)
        all += "," + at->second;
    while (!all.empty()) {
        const std::size_t comma = all.rfind(',');
        std::string last = all.substr(comma + 1);
        last.erase(0, last.find_first_not_of(' '));
        last.erase(last.find_last_not_of(' ') + 1);
        constexpr std::size_t kMostAddress = 45;  // IPv6 with an IPv4 in it
        if (last.empty() || last.size() > kMostAddress ||
            last.find_first_not_of("0123456789abcdefABCDEF.:") != last.npos)
            break;
        if (!isProxy(last, settings)) return last;
        all.resize(comma);
    }
    return request.remote_addr;
}

Clock systemClock() {
    return [] {
        return std::chrono::duration_cast<std::chrono::milliseconds>(
                   std::chrono::system_clock::now().time_since_epoch())
            .count();
    };
}

struct Server::State : Service {
    State(const Settings& s, Clock c) : Service(s, std::move(c)), http(make(s)) {
        // What is wrong with the books is told before anybody calls.
        (void)books.take();
        configure();
        for (const Entry& entry : everyRoute(this))
            add(entry);
        port = settings.port == 0                                 ? http->bind_to_any_port(settings.host)
               : http->bind_to_port(settings.host, settings.port) ? settings.port
                                                                  : -1;
        if (port < 0)
            throw core::Error(fmt::format("nobody can listen at {}:{}", settings.host, settings.port), "--listen",
                              "another program is there, or the address is none of this machine's: give another one")
                .as("port-taken", {settings.host, std::to_string(settings.port)});
        letManyWait();
        guard = std::make_unique<SlowGuard>(listening, settings.slow, bounds());
        for (std::size_t i = 0; i < settings.workers; ++i)
            workers.push_back(std::make_unique<Worker>(worksOf({settings.data, settings.database}, clock)));
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

    /// The library lets five wait to be taken, and the system turns away some of those that come beside them: a room
    /// that begins at once is more. Of the socket that was bound last, which is the one that listens.
    void letManyWait() const {
        constexpr int kMostWaiting = 1024;
        if (::listen(listening, kMostWaiting) != 0)
            std::fprintf(stderr, "handpiece-school: few may wait to be taken: %s\n", std::strerror(errno));
    }

    [[nodiscard]] SlowGuard::Bounds bounds() const {
        constexpr std::size_t kLeastOfAddress = 200;  // behind which a whole school may sit
        SlowGuard::Bounds bounds{std::max(kLeastOfAddress, settings.threads / 2), roomForConnections()};
        for (const auto* proxies : {&settings.proxies, &settings.signOn.proxies})
            bounds.excepted.insert(proxies->begin(), proxies->end());
        return bounds;
    }

    void configure() {
        http->set_socket_options([this](socket_t socket) {
            // At once after an end; and not the library's SO_REUSEPORT, by which a second server starts beside the
            // first.
            const int yes = 1;
            (void)::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
            listening = socket;
        });
        http->new_task_queue = [threads = settings.threads] { return new GrowingPool(threads); };
        // Each route has its own bound (read()); beyond that of all of them the library answers by itself.
        std::size_t most = std::max(school_wire::kMostMessage, school_wire::kMostPiece);
        for (const Entry& entry : everyRoute(this))
            most = std::max(most, entry.most);
        http->set_payload_max_length(most);
        http->set_read_timeout(kPatience);
        http->set_write_timeout(kPatience);
        http->set_keep_alive_timeout(kKeepAliveS);
        http->set_tcp_nodelay(true);
        http->set_default_headers(
            {{"X-Content-Type-Options", "nosniff"}, {"Cache-Control", "no-store"}, {"Referrer-Policy", "no-referrer"}});
        http->set_pre_routing_handler([this](const Request& request, Response& response) {
            using Result = httplib::Server::HandlerResponse;
            const auto status = door.refuses(request);
            // Everything is sent whole: the library would send pieces of pages as 200, and of a refusal as many as are
            // asked for. The request is its own, and not const there.
            const_cast<Request&>(request).ranges.clear();
            // From then on a browser that was here once comes by TLS alone.
            if (isSecure(request, settings)) response.set_header("Strict-Transport-Security", "max-age=31536000");
            // Of each request anew: an answer that nobody took was not logged.
            refusedNow = status.has_value();
            if (!status) {
                guard->admit(remoteOf(request), Door::lengthOf(request));
                return Result::Unhandled;
            }
            response.status = *status;
            response.set_header("Connection", "close");
            return Result::Handled;
        });
        // When it is answered: nothing that follows is taken for the next request.
        http->set_logger([this](const Request& request, const Response&) {
            if (std::exchange(refusedNow, false)) guard->hearNoMore(remoteOf(request));
        });
        http->set_exception_handler([this](const Request& request, Response& response, std::exception_ptr thrown) {
            ++failed;
            try {
                std::rethrow_exception(thrown);
            } catch (const std::exception& e) {
                answer(response, core::asError(e));
            } catch (...) {
                answer(response, core::Error("something that is no error was thrown"));
            }
            if (response.status != 503 || request.get_header_value("Accept").find("text/html") == std::string::npos)
                return;
            const config::LanguageHere here(languageOf(request));
            answer(response, refused(config::words()("school.busy"), 503), isSecure(request, settings));
        });
        http->set_error_handler([](const Request&, Response& response) {
            if (!response.body.empty()) return;
            const char* what = response.status == 404   ? "there is nothing at this address"
                               : response.status == 413 ? "that is too long for one message"
                               : response.status == 411 ? "tell its length beforehand, in one number"
                               : response.status == 415 ? "send it as it is, not packed"
                               : response.status == 416 ? "too many pieces are asked for, or none that is there"
                               : response.status == 431 ? "too many headers, or too long ones"
                                                        : "this cannot be answered";
            const int status = response.status;
            answer(response,
                   school_wire::toJson(core::Error(what, "", "use programs that belong together").as("not-there")),
                   status);
        });
    }

    void add(const Entry& entry) {
        const auto handler = [this, entry](const Request& request, Response& response) {
            ++asked;
            const SlowGuard::Working working(*guard, remoteOf(request));
            const config::LanguageHere here(languageOf(request));
            if (const auto* anyones = std::get_if<Handler>(&entry.answer)) return (*anyones)(request, response);
            if (const auto* stations = std::get_if<StationHandler>(&entry.answer))
                return (*stations)(request, response, stationOf(request, false));
            if (const auto* machines = std::get_if<WorkerHandler>(&entry.answer))
                return machines->answer(request, response, stationOf(request, true));
            show(entry, request, response);
        };
        const auto withBody = [this, entry, handler](const Request& request, Response& response,
                                                     const httplib::ContentReader& reader) {
            Request whole = request;
            if (read(whole, response, reader, mostOf(entry, request))) handler(whole, response);
        };
        const std::string_view method = entry.method;
        if (method == "GET") http->Get(entry.pattern, handler);
        if (method == "POST") http->Post(entry.pattern, withBody);
        if (method == "PUT") http->Put(entry.pattern, withBody);
    }

    /// Each person's browser asks for one; the server's own where that is none of ours.
    static std::string languageOf(const Request& request) {
        const std::string asked = config::languageAsked(request.get_header_value("Accept-Language"));
        return asked.empty() ? config::words().language() : asked;
    }

    static std::string remoteOf(const Request& request) {
        return fmt::format("{} {}", request.remote_addr, request.remote_port);
    }
    bool isKnown(const Request& request) {
        if (request.has_header("Authorization")) return stationBy(request).has_value();
        const std::string token = tokenOf(request);
        return !token.empty() && books.take()->personByToken(token, clock()).has_value();
    }

    /// Much is taken of stations and of who is logged in alone.
    std::size_t mostOf(const Entry& entry, const Request& request) {
        constexpr std::size_t kMostOfStrangers = 128 << 10;
        if (Door::lengthOf(request) <= kMostOfStrangers || isKnown(request)) return entry.most;
        return std::min(entry.most, kMostOfStrangers);
    }

    /// What was sent, as the library reads it by itself: but of forms more than 8 kB, and of each route no more than
    /// its own `most`. What is beyond is read past and kept nowhere, so that the connection stays in step. False: it
    /// was too long, which is answered, or broke off.
    static bool read(Request& request, Response& response, const httplib::ContentReader& reader, std::size_t most) {
        constexpr std::size_t kMostParts = 1000;
        std::size_t bytes = 0;
        std::string* into = &request.body;
        const auto take = [&](const char* data, std::size_t size) {
            bytes += size;
            if (bytes <= most && into != nullptr) into->append(data, size);
            return true;
        };
        if (request.is_multipart_form_data()) {
            const auto begin = [&](const httplib::MultipartFormData& part) {
                into = request.files.size() < kMostParts ? &request.files.emplace(part.name, part)->second.content
                                                         : nullptr;
                return true;
            };
            if (!reader(begin, take)) return false;
        } else if (!reader(take)) {
            return false;
        }
        if (bytes > most) {
            response.status = 413;
            return false;
        }
        if (request.get_header_value("Content-Type").starts_with("application/x-www-form-urlencoded"))
            httplib::detail::parse_query_text(request.body, request.params);
        return true;
    }

    void show(const Entry& entry, const Request& request, Response& response) {
        const BooksPool::Lent open = books.take();
        const bool secure = isSecure(request, settings);
        const std::string token = tokenOf(request);
        const Milliseconds now = clock();
        const auto person = token.empty() ? std::nullopt : open->personByToken(token, now);
        if (!person) return answer(response, Page{303, {}, "/login", std::string()}, secure);
        const Visit visit{*open, *person, token, now};
        // What changes something came from a page of this very log-in.
        if (std::string_view(entry.method) == "POST" &&
            !school::isSameSecret(sentBy(request, "token"), school::requestTokenOf(token)))
            return answer(response, refused(config::words()("school.gone"), 403), secure);
        answer(response, std::get<Shown>(entry.answer)(request, visit), secure);
    }

    /// What the station speaks, the server has to know.
    void requireSpoken(const Request& request) const {
        const std::string said = request.get_header_value("Handpiece-Protocol");
        int spoken = 0;
        const auto [end, ec] = std::from_chars(said.data(), said.data() + said.size(), spoken);
        const bool isNumber = !said.empty() && ec == std::errc() && end == said.data() + said.size();
        if (isNumber && spoken >= settings.oldestProtocol && spoken <= settings.newestProtocol) return;
        const bool isNewer = isNumber && spoken > settings.newestProtocol;
        throw core::Error(fmt::format("the station speaks version {} of the messages, and the server knows {}",
                                      isNumber ? said : "none",
                                      settings.oldestProtocol == settings.newestProtocol
                                          ? std::to_string(settings.newestProtocol)
                                          : fmt::format("{} to {}", settings.oldestProtocol, settings.newestProtocol)),
                          "",
                          isNewer ? "bring the server up to date; nothing is lost until then"
                                  : "bring the station up to date; nothing is lost until then")
            .as("protocol-other", {said, std::to_string(settings.newestProtocol)});
    }

    std::optional<school::Station> stationBy(const Request& request) {
        constexpr std::string_view kBearer = "Bearer ";
        const std::string said = request.get_header_value("Authorization");
        if (!said.starts_with(kBearer) || said.size() >= 200) return {};
        return books.take()->stationByKey(said.substr(kBearer.size()), clock());
    }
    school::Station stationOf(const Request& request, bool isWorker) {
        requireSpoken(request);
        if (auto station = stationBy(request)) {
            if ((station->kind == "worker") == isWorker) return *station;
            throw core::Error(isWorker ? "this station cuts no works again" : "this machine cuts works again, no more",
                              station->name,
                              isWorker ? "enrol one that does: handpiece school code --worker"
                                       : "enrol it as a station: handpiece school code")
                .as("code-other", {station->kind});
        }
        throw core::Error("the server does not know this station, or no longer", "",
                          "enrol it with a new code: handpiece school enrol")
            .as("not-enrolled");
    }

    const Door door{everyRoute(nullptr)};
    std::unique_ptr<httplib::Server> http;
    socket_t listening = INVALID_SOCKET;
    int port = -1;
    std::unique_ptr<SlowGuard> guard;
    std::vector<std::unique_ptr<Worker>> workers;
    Housekeeper house{*this};
};

std::vector<Route> Server::routes() {
    std::vector<Route> all;
    for (const Entry& entry : everyRoute(nullptr))
        all.push_back({entry.method, entry.pattern, entry.caller()});
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
    if (state_->settings.keepsHouse) state_->house.start();
    state_->http->listen_after_bind();
    state_->house.stop();
    for (const auto& worker : state_->workers)
        worker->stop();
}
void Server::stop() {
    state_->http->stop();
}

}  // namespace handpiece::school_server
