// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A real PostgreSQL server of a test's own: in a private folder, behind a socket there, gone with the object.

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <string>

#include "handpiece/base/core/file.h"

namespace handpiece::test {

class PostgresServer {
  public:
    /// None where Debian's package is not there; a test skips then. Throws std::runtime_error where it does not start.
    /// As root it runs as another user, for PostgreSQL refuses root.
    static std::unique_ptr<PostgresServer> start(int connections = 60);
    ~PostgresServer();
    PostgresServer(const PostgresServer&) = delete;
    PostgresServer& operator=(const PostgresServer&) = delete;

    /// Of its one database, with a schema to work in, which is made anew.
    std::string newSchema();
    /// Address of what newSchema() made.
    [[nodiscard]] std::string address(const std::string& schema) const;
    /// As its administrator; the first column of the first row.
    std::string sql(const std::string& schema, const std::string& statements);
    /// In which it lives.
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }
    /// Its user may write there from now on.
    static void giveToServer(const std::filesystem::path& folder);
    /// kill -9 to all its processes, as when its machine loses power.
    void kill();
    /// Again after kill(), or for the first time.
    void run();

  private:
    PostgresServer() = default;
    void launchServer();
    void wait(bool untilUp);
    core::PrivateFolder folder_;
    std::string programs_;
    pid_t server_ = 0;
    int connections_ = 0, schemas_ = 0;
};

}  // namespace handpiece::test
