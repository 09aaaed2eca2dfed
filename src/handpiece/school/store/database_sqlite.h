// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// SQLite as this room needs it.

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "handpiece/school/store/database.h"

struct sqlite3;

namespace handpiece::school {

/// How one that is damaged, or none, is called and what is to be done then.
struct DatabaseKind {
    std::string name = "store of results";
    std::string remedy = "move the file away: a new one is made";
};

class SqliteDatabase final : public Database {
  public:
    /// Made where there is none. `patience`: how long it waits for another that writes.
    SqliteDatabase(const std::filesystem::path& file, std::chrono::milliseconds patience, DatabaseKind kind = {});
    ~SqliteDatabase() override;

    [[nodiscard]] Engine engine() const noexcept override { return Engine::sqlite; }
    void run(const char* statements) override;
    [[nodiscard]] std::unique_ptr<Rows> prepare(const char* sql) override;
    void begin(Access access) override;
    void commit() override { run("COMMIT"); }
    void rollBack() noexcept override;
    /// From now on with a write-ahead log, which stays short: whoever commits when it has grown beyond 4 MB puts it
    /// into the file and begins it anew. SQLite by itself never waits for readers, so that with one after another it
    /// grows without end; this waits for those who read, the longer the longer the log is, half its patience at most,
    /// and else tries again when the log is half as long again.
    void writeAhead();
    /// What went wrong last, as core::Error.
    [[noreturn]] void fail() const;

  private:
    /// Looks every millisecond: SQLite's own wait grows to a tenth of a second, in which two that write without a pause
    /// starve a third.
    static int waitForOthers(void* self, int times);

    static int afterCommit(void* self, sqlite3* handle, const char* name, int pages);

    sqlite3* handle_ = nullptr;
    int emptyLogAt_ = 0;  ///< [pages]
    DatabaseKind kind_;
    std::chrono::milliseconds patience_;
    std::chrono::steady_clock::time_point waitsUntil_;
};

}  // namespace handpiece::school
