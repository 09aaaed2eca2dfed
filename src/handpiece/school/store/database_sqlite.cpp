// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/database_sqlite.h"

#include <sqlite3.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::school {

namespace {

/// The system's number of what SQLite could not do: its own count forgets a failed write, its files do not.
int systemError(sqlite3* handle) {
    int number = sqlite3_system_errno(handle);
    if (number == 0) sqlite3_file_control(handle, "main", SQLITE_FCNTL_LAST_ERRNO, &number);
    sqlite3_file* journal = nullptr;
    if (number == 0 && sqlite3_file_control(handle, "main", SQLITE_FCNTL_JOURNAL_POINTER, &journal) == SQLITE_OK &&
        journal && journal->pMethods)
        journal->pMethods->xFileControl(journal, SQLITE_FCNTL_LAST_ERRNO, &number);
    return number;
}

}  // namespace

SqliteDatabase::SqliteDatabase(const std::filesystem::path& file, std::chrono::milliseconds patience, DatabaseKind kind)
    : kind_(std::move(kind)), patience_(patience) {
    where_ = file.string();
    // Another's eyes have no business in it: the journal beside it takes the file's mode.
    const int code = sqlite3_open_v2(where_.c_str(), &handle_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
    try {
        if (code != SQLITE_OK) fail();
        sqlite3_extended_result_codes(handle_, 1);
        sqlite3_busy_handler(handle_, &waitForOthers, this);
        sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
        sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    } catch (...) {
        sqlite3_close(handle_);
        throw;
    }
}

int SqliteDatabase::waitForOthers(void* self, int times) {
    auto& database = *static_cast<SqliteDatabase*>(self);
    const auto now = std::chrono::steady_clock::now();
    if (times == 0) database.waitsUntil_ = now + database.patience_;
    if (now >= database.waitsUntil_) return 0;
    sqlite3_sleep(1);
    return 1;
}

namespace {
constexpr int kLogPages = 1000;
constexpr std::chrono::milliseconds kForReaders{2000};
}  // namespace

void SqliteDatabase::writeAhead() {
    // Of two that change it at once SQLite refuses one without asking waitForOthers(): each would wait for the other.
    const auto until = std::chrono::steady_clock::now() + patience_;
    while (sqlite3_exec(handle_, "PRAGMA journal_mode = WAL", nullptr, nullptr, nullptr) != SQLITE_OK) {
        const bool isBusy = (sqlite3_errcode(handle_) & 0xff) == SQLITE_BUSY;
        if (!isBusy || std::chrono::steady_clock::now() >= until) fail();
        sqlite3_sleep(1);
    }
    emptyLogAt_ = kLogPages;
    sqlite3_wal_hook(handle_, &afterCommit, this);
}

int SqliteDatabase::afterCommit(void* self, sqlite3* handle, const char* name, int pages) {
    auto& database = *static_cast<SqliteDatabase*>(self);
    if (pages < database.emptyLogAt_) return SQLITE_OK;
    // The longer the log, the longer; another that writes must not give up meanwhile.
    const auto own =
        std::min<std::chrono::milliseconds>(kForReaders * (database.emptyLogAt_ / kLogPages), database.patience_ / 2);
    const std::chrono::milliseconds patience = std::exchange(database.patience_, own);
    const int code = sqlite3_wal_checkpoint_v2(handle, name, SQLITE_CHECKPOINT_TRUNCATE, nullptr, nullptr);
    database.patience_ = patience;
    database.emptyLogAt_ = code == SQLITE_OK ? kLogPages : pages + std::max(kLogPages, pages / 2);
    // What was committed is; that the log is long for now is no error of it.
    return SQLITE_OK;
}

SqliteDatabase::~SqliteDatabase() {
    sqlite3_close(handle_);
}

void SqliteDatabase::fail() const {
    const int code = sqlite3_errcode(handle_) & 0xff;
    const int system = systemError(handle_);
    const std::string why = sqlite3_errmsg(handle_);
    const std::string reason = system != 0 ? std::strerror(system) : why;
    switch (code) {
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
            throw core::Error("another program is writing into it", where_, "close that one, or try again")
                .as("store-locked");
        case SQLITE_FULL:
            throw core::Error("it cannot be written: the disk is full", where_, "make room")
                .as("no-space", {std::strerror(ENOSPC)});
        case SQLITE_READONLY:
        case SQLITE_CANTOPEN:
        case SQLITE_PERM:
        case SQLITE_AUTH:
            throw core::Error("it cannot be written: " + reason, where_, "check its permissions and its folder's")
                .as("not-writable", {reason});
        case SQLITE_IOERR:
            throw core::Error("it cannot be written: " + reason, where_, "make room, or check the disk")
                .as(core::writeErrorId(system), {reason});
        default:
            throw core::Error("this is no " + kind_.name + ", or a damaged one: " + why, where_, kind_.remedy)
                .as("store-damaged", {why});
    }
}

void SqliteDatabase::run(const char* statements) {
    if (sqlite3_exec(handle_, statements, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

void SqliteDatabase::begin(Access access) {
    run(access == Access::read ? "BEGIN" : "BEGIN IMMEDIATE");
}

void SqliteDatabase::rollBack() noexcept {
    // What cannot be taken back now is when the file is opened next: the journal is still there.
    sqlite3_exec(handle_, "ROLLBACK", nullptr, nullptr, nullptr);
}

namespace {

class SqliteRows final : public Database::Rows {
  public:
    SqliteRows(const SqliteDatabase& database, sqlite3* handle, const char* sql) : database_(database) {
        if (sqlite3_prepare_v2(handle, sql, -1, &statement_, nullptr) != SQLITE_OK) database_.fail();
    }
    ~SqliteRows() override { sqlite3_finalize(statement_); }

    void bind(int place, std::string_view text) override {
        require(sqlite3_bind_text64(statement_, at(place), text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
    }
    void bind(int place, std::int64_t number) override { require(sqlite3_bind_int64(statement_, at(place), number)); }
    void bind(int place, double number) override { require(sqlite3_bind_double(statement_, at(place), number)); }
    void bindNothing(int place) override { require(sqlite3_bind_null(statement_, at(place))); }

    bool next() override {
        const int code = sqlite3_step(statement_);
        if (code != SQLITE_ROW && code != SQLITE_DONE) database_.fail();
        return code == SQLITE_ROW;
    }
    [[nodiscard]] std::string text(int column) const override {
        const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
        return bytes ? std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)))
                     : std::string();
    }
    [[nodiscard]] std::int64_t integer(int column) const override { return sqlite3_column_int64(statement_, column); }
    [[nodiscard]] double number(int column) const override { return sqlite3_column_double(statement_, column); }
    [[nodiscard]] bool isNothing(int column) const override {
        return sqlite3_column_type(statement_, column) == SQLITE_NULL;
    }

  private:
    /// $2 is a name to SQLite, whose number is that of its first mention.
    [[nodiscard]] int at(int place) const {
        const int named = sqlite3_bind_parameter_index(statement_, ("$" + std::to_string(place)).c_str());
        return named != 0 ? named : place;
    }
    void require(int code) const {
        if (code != SQLITE_OK) database_.fail();
    }

    const SqliteDatabase& database_;
    sqlite3_stmt* statement_ = nullptr;
};

}  // namespace

std::unique_ptr<Database::Rows> SqliteDatabase::prepare(const char* sql) {
    return std::make_unique<SqliteRows>(*this, handle_, sql);
}

}  // namespace handpiece::school
