// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/database.h"

#include <sqlite3.h>

#include <cstring>

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

Database::Database(const std::filesystem::path& file, std::chrono::milliseconds patience) : where_(file.string()) {
    // Another's eyes have no business in it: the journal beside it takes the file's mode.
    const int code = sqlite3_open_v2(where_.c_str(), &handle_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
    try {
        if (code != SQLITE_OK) fail();
        sqlite3_extended_result_codes(handle_, 1);
        sqlite3_busy_timeout(handle_, static_cast<int>(patience.count()));
        sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
        sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    } catch (...) {
        sqlite3_close(handle_);
        throw;
    }
}

Database::~Database() {
    sqlite3_close(handle_);
}

void Database::fail() const {
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
            throw core::Error("this is no store of results, or a damaged one: " + why, where_,
                              "move the file away: a new one is made")
                .as("store-damaged", {why});
    }
}

void Database::run(const char* statements) {
    if (sqlite3_exec(handle_, statements, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

std::int64_t Database::number(const char* query) {
    Statement statement(*this, query);
    return statement.next() ? statement.integer(0) : 0;
}

std::string Database::text(const char* query) {
    Statement statement(*this, query);
    return statement.next() ? statement.text(0) : std::string();
}

bool Database::isReadOnly() const {
    return sqlite3_db_readonly(handle_, "main") == 1;
}

Statement::Statement(Database& database, const char* sql) : database_(database) {
    if (sqlite3_prepare_v2(database.handle_, sql, -1, &statement_, nullptr) != SQLITE_OK) database.fail();
}

Statement::~Statement() {
    sqlite3_finalize(statement_);
}

Statement& Statement::with(std::string_view text) {
    if (sqlite3_bind_text64(statement_, ++bound_, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8) != SQLITE_OK)
        database_.fail();
    return *this;
}

Statement& Statement::with(std::int64_t number) {
    if (sqlite3_bind_int64(statement_, ++bound_, number) != SQLITE_OK) database_.fail();
    return *this;
}

Statement& Statement::with(double number) {
    if (sqlite3_bind_double(statement_, ++bound_, number) != SQLITE_OK) database_.fail();
    return *this;
}

Statement& Statement::with(const std::optional<double>& number) {
    if (number) return with(*number);
    if (sqlite3_bind_null(statement_, ++bound_) != SQLITE_OK) database_.fail();
    return *this;
}

bool Statement::next() {
    const int code = sqlite3_step(statement_);
    if (code != SQLITE_ROW && code != SQLITE_DONE) database_.fail();
    return code == SQLITE_ROW;
}

void Statement::run() {
    while (next()) {
    }
}

std::string Statement::text(int column) const {
    const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return bytes ? std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)))
                 : std::string();
}

std::int64_t Statement::integer(int column) const {
    return sqlite3_column_int64(statement_, column);
}

double Statement::number(int column) const {
    return sqlite3_column_double(statement_, column);
}

std::optional<double> Statement::optional(int column) const {
    if (sqlite3_column_type(statement_, column) == SQLITE_NULL) return {};
    return number(column);
}

Transaction::~Transaction() {
    // What cannot be taken back now is when the file is opened next: the journal is still there.
    if (isOpen_) sqlite3_exec(database_.handle_, "ROLLBACK", nullptr, nullptr, nullptr);
}

void Transaction::commit() {
    database_.run("COMMIT");
    isOpen_ = false;
}

}  // namespace handpiece::school
