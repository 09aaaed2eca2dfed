// SPDX-License-Identifier: Apache-2.0
// handpiece serve: the school's server.
#include <fmt/format.h>

#include <atomic>
#include <charconv>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <memory>
#include <thread>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "school/commands.h"
#include "school/school_settings.h"
#include "school/server.h"
#include "school/service_manager.h"
#include "school/worker.h"
#include "studies/progress_bar.h"

namespace handpiece::school_cli {
namespace {

struct ServeOptions {
    SchoolSettings given;
    std::size_t workers = 0, connections = 0;
    bool ownStationsOnly = false;
    bool worker = false;
};

std::string secretIn(const std::string& file) {
    const std::vector<std::byte> bytes = core::readFile(file, 4096);
    std::string secret(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    while (!secret.empty() && (secret.back() == '\n' || secret.back() == ' '))
        secret.pop_back();
    if (secret.size() < 32)
        throw core::Error("the proxy's secret is too short", file,
                          "32 characters or more, by chance: openssl rand -hex 32");
    return secret;
}

void serve(const ServeOptions& asked) {
    std::atomic<bool> ended{false};
    listenForEnd();
    const SchoolSettings o = settled(asked.given, ownEnvironment());
    if (asked.worker) {
        school_server::Worker worker(school_server::worksOf({o.data, o.database}, school_server::systemClock()));
        worker.start();
        tellManager("READY=1");
        fmt::print("works for {} (Ctrl-C ends it)\n", o.database.empty() ? o.data : o.database);
        (void)std::fflush(stdout);
        waitForEnd(ended);
        tellManager("STOPPING=1");
        worker.stop();
        return;
    }
    school_server::Settings settings;
    settings.data = o.data, settings.database = o.database;
    settings.certificate = o.certificate, settings.key = o.key;
    settings.workers = *o.workers;
    settings.address = o.address;
    while (settings.address.ends_with('/'))
        settings.address.pop_back();
    settings.proxies = o.proxies;
    settings.signOn.proxies = o.signOnProxies, settings.signOn.header = o.signOnHeader;
    if (!o.signOnSecret.empty()) settings.signOn.secret = secretIn(o.signOnSecret);
    if (o.signOnProxies.empty() != settings.signOn.secret.empty())
        throw core::Error("single sign-on needs the proxies' addresses and a secret that they know", "--sign-on-proxy",
                          "give both --sign-on-proxy and --sign-on-secret, or neither");
    settings.connections = *o.connections;
    settings.ownStationsOnly = *o.ownStationsOnly;
    const std::size_t colon = o.listen.rfind(':');
    settings.host = o.listen.substr(0, colon == std::string::npos ? o.listen.size() : colon);
    if (settings.host.size() > 2 && settings.host.front() == '[')
        settings.host = settings.host.substr(1, settings.host.size() - 2);
    if (colon != std::string::npos) {
        const char *from = o.listen.data() + colon + 1, *to = o.listen.data() + o.listen.size();
        const auto [end, ec] = std::from_chars(from, to, settings.port);
        if (ec != std::errc() || end != to || settings.port < 0 || settings.port > 65535)
            throw core::Error(fmt::format("\"{}\" is no address to listen at", o.listen), "--listen",
                              "give HOST:PORT, as 127.0.0.1:8620");
    }
    school_server::Server server(settings);
    if (settings.certificate.empty() && settings.host != "127.0.0.1" && settings.host != "::1" &&
        settings.host != "localhost")
        std::fprintf(stderr,
                     "it speaks plain HTTP to other machines: give --certificate and --key, or --listen 127.0.0.1:%d "
                     "behind a proxy that has them\n",
                     server.port());
    fmt::print("{}://{}:{} (Ctrl-C ends it)\n", o.certificate.empty() ? "http" : "https", settings.host, server.port());
    (void)std::fflush(stdout);
    // The port is open: who comes now waits for run().
    tellManager("READY=1");
    std::thread ending([&] {
        waitForEnd(ended);
        tellManager("STOPPING=1");
        server.stop();
    });
    server.run();
    ended = true;
    ending.join();
}

}  // namespace

void addServeCommand(cli::Command& app) {
    cli::Command command = app.subcommand("serve", "The school's server: takes what stations push, and scores it");
    const auto options = std::make_shared<ServeOptions>();
    ServeOptions& o = *options;
    command.option("--settings", o.given.file, "a file with what is not given here (TOML)");
    command.option("--data", o.given.data, "the server's folder (school)");
    command.option("--database", o.given.database, "postgresql://... instead of SQLite in the folder");
    command.option("--listen", o.given.listen, "HOST:PORT; port 0: any that is free (127.0.0.1:8620)");
    command.option("--certificate", o.given.certificate, "TLS of its own: certificate (PEM), with --key");
    command.option("--key", o.given.key, "its key (PEM)");
    command.option("--workers", o.workers, "that cut sessions again in this program; 0: others do (1)")
        .check(cli::range(std::size_t{0}, kMostWorkers));
    command.option("--connections", o.connections, "to the database at once, at most; who comes beyond waits (60)")
        .check(cli::range(std::size_t{1}, kMostConnections));
    command.flag("--own-stations-only", o.ownStationsOnly, "class work comes from a person's own stations alone");
    command.option("--address", o.given.address, "as browsers know it, https://school.example: for log-ins by LTI");
    command.option("--proxy", o.given.proxies, "address of a proxy whose X-Forwarded-For is believed; several times")
        .takeAll();
    command
        .option("--sign-on-proxy", o.given.signOnProxies,
                "address of a proxy that vouches for who logs in; several times")
        .takeAll();
    command.option("--sign-on-secret", o.given.signOnSecret, "file with the secret that it sends");
    command.option("--sign-on-header", o.given.signOnHeader, "in which it names who logs in (X-Handpiece-User)");
    command.flag("--worker", o.worker,
                 "only work: cut sessions again for books that this machine sees; else: handpiece school worker");
    command.footer(
        "Example:\n  handpiece serve --data /srv/handpiece --listen 0.0.0.0:8620 --certificate school.pem --key "
        "key.pem");
    command.callback([options, command] {
        if (command.isGiven("--workers")) options->given.workers = options->workers;
        if (options->ownStationsOnly) options->given.ownStationsOnly = true;
        if (command.isGiven("--connections")) options->given.connections = options->connections;
        serve(*options);
    });
}

}  // namespace handpiece::school_cli
