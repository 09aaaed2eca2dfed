// SPDX-License-Identifier: Apache-2.0
#include "school/statements_push.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "school/elsewhere.h"
#include "school/http.h"

namespace handpiece::school_station {
namespace {

using Json = nlohmann::ordered_json;

/// By record store, person and home page: up to where in the outbox.
class Reached {
  public:
    Reached(std::filesystem::path file, std::string key) : file_(std::move(file)), key_(std::move(key)) {
        if (!core::isThere(file_)) return;
        const std::vector<std::byte> bytes = core::readFile(file_, 1 << 20);
        const auto* from = reinterpret_cast<const char*>(bytes.data());
        all_ = Json::parse(from, from + bytes.size(), nullptr, false);
        const bool isWell = all_.is_object() && std::all_of(all_.begin(), all_.end(),
                                                            [](const Json& one) { return one.is_number_integer(); });
        if (!isWell)
            throw core::Error("it cannot be read how far the statements went", file_.string(),
                              "move the file away: all go again, and none is doubled there")
                .as("statements-progress");
    }
    [[nodiscard]] std::int64_t sequence() const { return all_.value(key_, std::int64_t{0}); }
    void keep(std::int64_t sequence) {
        all_[key_] = sequence;
        core::writeFile(file_, all_.dump(1) + "\n", {.ownerOnly = true});
    }

  private:
    std::filesystem::path file_;
    std::string key_;
    Json all_ = Json::object();
};

class StatementPusher {
  public:
    StatementPusher(const RecordStore& to) : address_(to.address) {
        while (address_.ends_with('/'))
            address_.pop_back();
        address_ += "/statements";
        headers_ = {{"X-Experience-API-Version", "1.0.3"}};
        if (!to.user.empty()) {
            const auto basic = httplib::make_basic_authentication_header(to.user, to.password);
            headers_.emplace_back(basic.first, basic.second);
        }
    }
    /// A list at once; where the store has one of them already, one by one.
    void push(const Json& statements) {
        if (statements.empty()) return;
        const int status = answered(statements);
        if (status != 409) {
            pushed_.sent += statements.size();
            return;
        }
        for (const Json& one : statements)
            answered(Json::array({one})) == 409 ? ++pushed_.there : ++pushed_.sent;
    }
    [[nodiscard]] PushedStatements pushed() const { return pushed_; }

  private:
    /// Taken, or 409: there is one of this id.
    int answered(const Json& statements) {
        const school_server::Elsewhere answer =
            school_server::post(address_, statements.dump(), "application/json", headers_);
        if ((answer.status >= 200 && answer.status < 300) || answer.status == 409) return answer.status;
        std::string said = answer.body.substr(0, 300);
        std::replace_if(
            said.begin(), said.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
        throw core::Error(fmt::format("the record store does not take it: {} {}", answer.status, said), address_,
                          answer.status == 401 || answer.status == 403
                              ? "check the user and the password"
                              : "tell who looks after it; nothing is lost until then")
            .as("statements-refused", {std::to_string(answer.status)});
    }

    std::string address_;
    std::vector<std::pair<std::string, std::string>> headers_;
    PushedStatements pushed_;
};

}  // namespace

PushedStatements pushStatements(const school::Store& store, const statements::Actor& actor, const RecordStore& to,
                                const std::filesystem::path& progress) {
    school_server::requireAddress(to.address);
    Reached reached(progress, fmt::format("{} {} {}", to.address, actor.homePage, actor.code));
    std::map<std::string, std::string> titles;
    for (const school::Exercise& exercise : store.exercises())
        titles[exercise.id] = exercise.title;
    StatementPusher pusher(to);
    constexpr std::size_t kSome = 20;
    for (auto some = store.outbox(reached.sequence(), kSome); !some.empty();
         some = store.outbox(reached.sequence(), kSome)) {
        std::vector<statements::Work> works;
        for (const school::Outgoing& one : some) {
            if (one.kind != "attempt" && one.kind != "returned") continue;
            const bool isIn = std::any_of(works.begin(), works.end(),
                                          [&](const statements::Work& work) { return work.attempt.id == one.id; });
            if (const auto attempt = isIn ? std::nullopt : store.attempt(one.id))
                works.push_back({*attempt, titles[attempt->exercise], store.returnedOf(one.id)});
        }
        pusher.push(Json::parse(statements::statementsOf(works, actor)));
        reached.keep(some.back().sequence);
    }
    return pusher.pushed();
}

}  // namespace handpiece::school_station
