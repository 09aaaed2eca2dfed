// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/database_postgres.h"

#include <fmt/format.h>
#include <libpq-fe.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <optional>
#include <string_view>

#include "handpiece/base/core/error.h"

namespace handpiece::school {
namespace {

/// What the server says, its first line.
std::string firstLine(const char* message) {
    std::string text = message ? message : "";
    return text.substr(0, text.find('\n'));
}

/// Where it is, without user and password.
std::string placeOf(const std::string& url) {
    char* why = nullptr;
    PQconninfoOption* const options = PQconninfoParse(url.c_str(), &why);
    if (!options) {
        const std::string reason = firstLine(why);
        PQfreemem(why);
        throw core::Error("this is no address of a PostgreSQL database: " + reason, "--database",
                          "write postgresql://USER@HOST/NAME")
            .as("store-refused", {reason});
    }
    std::string host, port, name;
    for (const PQconninfoOption* option = options; option->keyword; ++option) {
        const std::string_view keyword = option->keyword;
        const std::string value = option->val ? option->val : "";
        if (keyword == "host") host = value;
        if (keyword == "port") port = value;
        if (keyword == "dbname") name = value;
    }
    PQconninfoFree(options);
    return fmt::format("postgresql://{}{}{}/{}", host, port.empty() ? "" : ":", port, name);
}

class PostgresRows final : public Database::Rows {
  public:
    PostgresRows(PostgresDatabase& database, const char* sql) : database_(database), sql_(sql) {}

    void bind(int place, std::string_view text) override { at(place) = std::string(text); }
    void bind(int place, std::int64_t number) override { at(place) = std::to_string(number); }
    void bind(int place, double number) override { at(place) = fmt::format("{}", number); }
    void bindNothing(int place) override { at(place).reset(); }

    bool next() override {
        if (!result_) {
            std::vector<const char*> values;
            for (const std::optional<std::string>& value : values_)
                values.push_back(value ? value->c_str() : nullptr);
            result_ = database_.execute(sql_.c_str(), values);
            return PQntuples(result_.get()) > 0;
        }
        return ++row_ < PQntuples(result_.get());
    }
    [[nodiscard]] std::string text(int column) const override {
        return {PQgetvalue(result_.get(), row_, column),
                static_cast<std::size_t>(PQgetlength(result_.get(), row_, column))};
    }
    [[nodiscard]] std::int64_t integer(int column) const override { return read<std::int64_t>(column); }
    [[nodiscard]] double number(int column) const override { return read<double>(column); }
    [[nodiscard]] bool isNothing(int column) const override { return PQgetisnull(result_.get(), row_, column) != 0; }

  private:
    std::optional<std::string>& at(int place) {
        values_.resize(std::max(values_.size(), static_cast<std::size_t>(place)));
        return values_[static_cast<std::size_t>(place) - 1];
    }
    template <class Number>
    Number read(int column) const {
        Number number{};
        const char* const from = PQgetvalue(result_.get(), row_, column);
        const char* const end = from + PQgetlength(result_.get(), row_, column);
        if (from != end && std::from_chars(from, end, number).ptr != end)
            throw core::Error(fmt::format("'{}' stands where a number belongs", from), database_.where(),
                              "restore a backup of it")
                .as("store-damaged", {from});
        return number;
    }

    PostgresDatabase& database_;
    std::string sql_;
    std::vector<std::optional<std::string>> values_;
    PostgresDatabase::Result result_;
    int row_ = 0;
};

}  // namespace

void PostgresDatabase::Clear::operator()(pg_result* result) const noexcept {
    PQclear(result);
}

PostgresDatabase::PostgresDatabase(const std::string& url, std::chrono::milliseconds patience)
    : url_(url), patience_(patience) {
    where_ = placeOf(url);
    try {
        connect();
    } catch (...) {
        PQfinish(connection_);
        throw;
    }
}

PostgresDatabase::~PostgresDatabase() {
    PQfinish(connection_);
}

/// What was begun with PQconnectStart. False: not, or not soon.
bool PostgresDatabase::completes() {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    auto wants = PQstatus(connection_) == CONNECTION_BAD ? PGRES_POLLING_FAILED : PGRES_POLLING_WRITING;
    while (wants == PGRES_POLLING_READING || wants == PGRES_POLLING_WRITING) {
        pollfd line{PQsocket(connection_), static_cast<short>(wants == PGRES_POLLING_READING ? POLLIN : POLLOUT), 0};
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
        const int ready = poll(&line, 1, std::max(0, static_cast<int>(left.count())));
        if (ready == 0) return false;
        if (ready > 0 || errno != EINTR) wants = PQconnectPoll(connection_);
    }
    return wants == PGRES_POLLING_OK;
}

void PostgresDatabase::connect() {
    PQfinish(connection_);
    const std::string seconds = std::to_string(std::max<std::int64_t>(2, patience_.count() / 1000));
    // What the address says comes last and counts.
    const char* const words[] = {"connect_timeout", "application_name", "keepalives_idle",
                                 "dbname",          "client_encoding",  nullptr};
    const char* const values[] = {seconds.c_str(), "handpiece", "30", url_.c_str(), "UTF8", nullptr};
    connection_ = PQconnectdbParams(words, values, 1);
    if (PQstatus(connection_) != CONNECTION_OK) {
        // Why, libpq says in the language of the server, unless it is asked for the number as well, which can be done
        // only step by step.
        const std::string first = firstLine(PQerrorMessage(connection_));
        PQfinish(connection_);
        connection_ = PQconnectStartParams(words, values, 1);
        PQsetErrorVerbosity(connection_, PQERRORS_VERBOSE);
        if (!completes()) failConnection(first);
        PQsetErrorVerbosity(connection_, PQERRORS_DEFAULT);
    }
    PQsetNoticeProcessor(
        connection_, [](void*, const char*) {}, nullptr);
    if (PQserverVersion(connection_) < 150000)
        throw core::Error(
            fmt::format("the server is PostgreSQL {}, and 15 or later is needed", PQserverVersion(connection_) / 10000),
            where_, "update the server")
            .as("store-refused", {"PostgreSQL 15"});
    // Who died or hangs in the middle of writing holds up the others no longer than a minute.
    run(fmt::format("SET lock_timeout = {}; SET idle_in_transaction_session_timeout = 60000; "
                    "SET default_transaction_isolation = 'read committed'; SET synchronous_commit = on",
                    patience_.count())
            .c_str());
}

void PostgresDatabase::failConnection(const std::string& reason) {
    const std::string last = firstLine(PQerrorMessage(connection_));
    std::string why = reason.empty() ? last : reason;
    if (PQconnectionNeedsPassword(connection_)) why = "it asks for a password";
    const auto says = [&last](std::string_view number) { return last.find(fmt::format(" {}: ", number)) != last.npos; };
    if (says("53300"))
        throw core::Error("the database server takes no more connections: " + why, where_,
                          "wait, or raise its max_connections")
            .as("store-full", {why});
    // A class of its own (28: who they are), no such database, and no right to it.
    if (PQconnectionNeedsPassword(connection_) || says("28000") || says("28P01") || says("3D000") || says("42501"))
        throw core::Error("the database server lets this user not in: " + why, where_,
                          "check user, password and database in the address")
            .as("store-refused", {why});
    throw core::Error("the database server does not answer: " + why, where_, "start it, or check the address")
        .as("store-gone", {why});
}

PostgresDatabase::Result PostgresDatabase::checked(pg_result* raw) {
    Result result(raw);
    const ExecStatusType status = PQresultStatus(raw);
    if (status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK || status == PGRES_EMPTY_QUERY) return result;
    if (PQstatus(connection_) != CONNECTION_OK) failConnection();
    const char* const state = PQresultErrorField(raw, PG_DIAG_SQLSTATE);
    const std::string code = state ? state : "";
    const std::string why =
        firstLine(state ? PQresultErrorField(raw, PG_DIAG_MESSAGE_PRIMARY) : PQerrorMessage(connection_));
    const auto is = [&code](std::string_view start) { return code.compare(0, start.size(), start) == 0; };
    if (is("53100") || is("53200"))
        throw core::Error("it cannot be written: " + why, where_, "make room on the database's disk")
            .as("no-space", {why});
    if (is("55P03") || is("40") || is("57014"))
        throw core::Error("another program is writing into it", where_, "try again").as("store-locked");
    if (is("25006") || is("42501"))
        throw core::Error("it cannot be written: " + why, where_, "give the user of the address the right to")
            .as("not-writable", {why});
    if (is("57P") || is("08") || is("53300"))
        throw core::Error("the database server does not answer: " + why, where_, "start it, or check the address")
            .as("store-gone", {why});
    throw core::Error("these are no school's books, or damaged ones: " + why, where_, "restore a backup of it")
        .as("store-damaged", {why});
}

void PostgresDatabase::run(const char* statements) {
    static_cast<void>(checked(PQexec(connection_, statements)));
}

template <class Ask>
PostgresDatabase::Result PostgresDatabase::askedAgain(const Ask& ask) {
    // In a transaction what was done is lost with the connection, and that is told.
    if (isOpen_) return checked(ask());
    if (PQstatus(connection_) != CONNECTION_OK) connect();
    pg_result* const first = ask();
    if (PQstatus(connection_) == CONNECTION_OK) return checked(first);
    PQclear(first);
    connect();
    return checked(ask());
}

PostgresDatabase::Result PostgresDatabase::execute(const char* sql, const std::vector<const char*>& values) {
    return askedAgain([&] {
        return PQexecParams(connection_, sql, static_cast<int>(values.size()), nullptr, values.data(), nullptr, nullptr,
                            0);
    });
}

std::unique_ptr<Database::Rows> PostgresDatabase::prepare(const char* sql) {
    return std::make_unique<PostgresRows>(*this, sql);
}

void PostgresDatabase::begin(Access access) {
    const char* const how = access == Access::read ? "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY" : "BEGIN";
    static_cast<void>(askedAgain([&] { return PQexec(connection_, how); }));
    isOpen_ = true;
    try {
        if (access == Access::write) run("SELECT pg_advisory_xact_lock(hashtext('handpiece ' || current_schema()))");
    } catch (...) {
        rollBack();
        throw;
    }
}

void PostgresDatabase::commit() {
    const Result result = checked(PQexec(connection_, "COMMIT"));
    // To one in which something failed the server says ROLLBACK, and calls that no error.
    if (std::string_view(PQcmdStatus(result.get())) != "COMMIT")
        throw core::Error("nothing was written: the transaction had failed before", where_, "try again")
            .as("store-locked");
    isOpen_ = false;
}

void PostgresDatabase::rollBack() noexcept {
    isOpen_ = false;
    PQclear(PQexec(connection_, "ROLLBACK"));
}

}  // namespace handpiece::school
