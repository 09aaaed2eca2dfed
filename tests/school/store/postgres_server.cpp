// SPDX-License-Identifier: Apache-2.0
#include "school/store/postgres_server.h"

#include <fcntl.h>
#include <libpq-fe.h>
#include <pwd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <thread>
#include <vector>

namespace handpiece::test {
namespace fs = std::filesystem;
namespace {

const passwd* user() {
    const passwd* const own = getpwnam("postgres");
    return own ? own : getpwnam("nobody");
}

/// In a process group of its own, as that user where we are root; what it says goes into `log`.
pid_t launch(const std::vector<std::string>& words, const fs::path& log) {
    std::vector<char*> argv;
    for (const std::string& word : words)
        argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    const passwd* const as = geteuid() == 0 ? user() : nullptr;
    const pid_t child = fork();
    if (child != 0) return child;
    setpgid(0, 0);
    const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    dup2(out, 1);
    dup2(out, 2);
    if (as && (setgid(as->pw_gid) != 0 || setuid(as->pw_uid) != 0)) _exit(126);
    if (chdir("/") == 0) execv(argv[0], argv.data());
    _exit(127);
}

}  // namespace

std::unique_ptr<PostgresServer> PostgresServer::start(int connections) {
    std::string programs;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator("/usr/lib/postgresql", none))
        if (fs::exists(entry.path() / "bin/initdb") && std::atoi(entry.path().filename().c_str()) >= 15)
            programs = (entry.path() / "bin").string();
    if (programs.empty()) return nullptr;
    std::unique_ptr<PostgresServer> server(new PostgresServer);
    server->programs_ = programs;
    server->connections_ = connections;
    const fs::path folder = server->folder_.path();
    giveToServer(folder);
    // An order of letters that is not that of bytes, as a school's server has it.
    const pid_t child =
        launch({programs + "/initdb", "-D", (folder / "data").string(), "-U", "school", "-A", "trust", "-E", "UTF8",
                "--locale=C.UTF-8", "--locale-provider=icu", "--icu-locale=en-US", "--no-sync"},
               folder / "initdb.log");
    int status = 0;
    waitpid(child, &status, 0);
    if (status != 0) throw std::runtime_error("initdb failed: see " + (folder / "initdb.log").string());
    server->run();
    return server;
}

void PostgresServer::giveToServer(const fs::path& folder) {
    if (geteuid() == 0 && chown(folder.c_str(), user()->pw_uid, user()->pw_gid) != 0)
        throw std::runtime_error("the folder cannot be given to another user");
}

void PostgresServer::run() {
    launchServer();
    wait(true);
}

void PostgresServer::launchServer() {
    const std::string folder = folder_.path().string();
    // Not onto the disk itself: what is killed here are processes, and the kernel keeps what they wrote.
    server_ =
        launch({programs_ + "/postgres", "-D", folder + "/data", "-k", folder, "-c", "listen_addresses=", "-c",
                "shared_buffers=32MB", "-c", "max_connections=" + std::to_string(connections_), "-c", "fsync=off"},
               folder_.path() / "server.log");
}

void PostgresServer::wait(bool untilUp) {
    const std::string url = "postgresql://school@/postgres?host=" + folder_.path().string();
    for (int i = 0; i < 600; ++i) {
        const bool isUp = PQping(url.c_str()) == PQPING_OK;
        if (isUp == untilUp) return;
        // What was killed may still be dying, and a server does not start on its memory.
        if (untilUp && waitpid(server_, nullptr, WNOHANG) == server_) launchServer();
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    throw std::runtime_error("the server did not start: see its log in " + folder_.path().string());
}

PostgresServer::~PostgresServer() {
    if (server_ == 0) return;
    ::kill(server_, SIGINT);
    waitpid(server_, nullptr, 0);
}

void PostgresServer::kill() {
    // Its processes each make a group of their own: the postmaster goes first, so that it starts none anew.
    const std::string children = "/proc/" + std::to_string(server_) + "/task/" + std::to_string(server_) + "/children";
    ::kill(server_, SIGSTOP);
    std::vector<pid_t> all;
    if (std::FILE* list = std::fopen(children.c_str(), "r")) {
        for (int pid = 0; std::fscanf(list, "%d", &pid) == 1;)
            all.push_back(pid);
        std::fclose(list);
    }
    ::kill(server_, SIGKILL);
    for (const pid_t pid : all)
        ::kill(pid, SIGKILL);
    waitpid(server_, nullptr, 0);
    server_ = 0;
    wait(false);
}

std::string PostgresServer::newSchema() {
    const std::string schema = "s" + std::to_string(++schemas_);
    sql("public", "CREATE SCHEMA " + schema);
    return schema;
}

std::string PostgresServer::address(const std::string& schema) const {
    return "postgresql://school@/postgres?host=" + folder_.path().string() + "&options=-csearch_path%3D" + schema;
}

std::string PostgresServer::sql(const std::string& schema, const std::string& statements) {
    PGconn* const connection = PQconnectdb(address(schema).c_str());
    PGresult* const result = PQexec(connection, statements.c_str());
    const ExecStatusType status = PQresultStatus(result);
    const std::string why = PQerrorMessage(connection);
    const std::string answer = status == PGRES_TUPLES_OK && PQntuples(result) > 0 ? PQgetvalue(result, 0, 0) : "";
    PQclear(result);
    PQfinish(connection);
    if (status != PGRES_TUPLES_OK && status != PGRES_COMMAND_OK) throw std::runtime_error(why);
    return answer;
}

}  // namespace handpiece::test
