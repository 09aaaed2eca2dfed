// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// PostgreSQL (15 or later) as this room needs it, through libpq.

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "handpiece/school/store/database.h"

struct pg_conn;
struct pg_result;

namespace handpiece::school {

/// One connection. Errors: "store-gone" (no server, a lost connection; the next transaction tries to connect again),
/// "store-refused" (user, password, database),
/// "store-full" (no more connections), "store-locked", "no-space", "not-writable", "store-damaged" (all else).
class PostgresDatabase final : public Database {
  public:
    /// @param url  postgresql://..., or libpq's key=value words.
    PostgresDatabase(const std::string& url, std::chrono::milliseconds patience);
    ~PostgresDatabase() override;

    [[nodiscard]] Engine engine() const noexcept override { return Engine::postgres; }
    void run(const char* statements) override;
    [[nodiscard]] std::unique_ptr<Rows> prepare(const char* sql) override;
    void begin(Access access) override;
    void commit() override;
    void rollBack() noexcept override;

    struct Clear {
        void operator()(pg_result* result) const noexcept;
    };
    using Result = std::unique_ptr<pg_result, Clear>;
    /// One statement with its values as text; nullptr: nothing.
    [[nodiscard]] Result execute(const char* sql, const std::vector<const char*>& values);

  private:
    void connect();
    [[nodiscard]] bool completes();
    /// Throws unless it went well.
    Result checked(pg_result* result);
    /// Once more on a new connection where the old one turns out to be lost and nothing was begun on it.
    template <class Ask>
    Result askedAgain(const Ask& ask);
    [[noreturn]] void failConnection(const std::string& reason = {});

    std::string url_;
    std::chrono::milliseconds patience_;
    pg_conn* connection_ = nullptr;
    bool isOpen_ = false;  ///< a transaction
};

}  // namespace handpiece::school
