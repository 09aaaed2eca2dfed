// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What stations and a school's server tell each other, as JSON. docs/school.md#between-station-and-server.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/school/store/books.h"

namespace handpiece::school_wire {

/// Of the messages below: what stations speak, and the oldest that a server still takes. It answers a station of
/// another one with what to do.
inline constexpr int kProtocol = 1, kOldestProtocol = 1;
inline constexpr std::size_t kMostMessage = 4 << 20, kMostPiece = 4 << 20;

/// What a station pushes; the server fills in station and time.
[[nodiscard]] std::string toJson(const school::PushedAttempt& attempt);
[[nodiscard]] std::string toJson(const school::Judgement& judgement);
/// Throw core::Error "message-damaged" (field, why) for what is none.
[[nodiscard]] school::PushedAttempt attemptFrom(std::string_view json);
[[nodiscard]] school::Judgement judgementFrom(std::string_view json);

struct Enrolled {
    std::string station, key;
    std::string person;  ///< whose it is, by its code; empty: anybody's
};
[[nodiscard]] std::string toJson(const Enrolled& enrolled);
[[nodiscard]] Enrolled enrolledFrom(std::string_view json);
struct Enrol {
    std::string code;
    /// What it is meant for, so that a code that is not that is not spent: a person's school code or "" where the code
    /// says whose it is; "exam" of a station for exams. Older programs say nothing of it.
    std::optional<std::string> person{}, kind{};
};
[[nodiscard]] std::string toJson(const Enrol& enrol);
[[nodiscard]] Enrol enrolFrom(std::string_view json);

/// Where a file stands.
struct Received {
    std::uint64_t bytes = 0;
    bool isWhole = false;
};
[[nodiscard]] std::string toJson(const Received& received);
[[nodiscard]] Received receivedFrom(std::string_view json);

/// What the server knows of a station.
struct Status {
    std::string server;  ///< version of its program
    int protocol = kProtocol;
    std::int32_t engine = 0;
    std::string station;
    std::string books{};               ///< incarnation of its books; empty: of an older server
    school::Milliseconds now = 0;      ///< by the server's clock; 0: of an older server
    std::vector<std::string> missing;  ///< SHA-256 of files of its attempts that have not come
};
[[nodiscard]] std::string toJson(const Status& status);
[[nodiscard]] Status statusFrom(std::string_view json);

/// What a person has to do.
struct Task {
    std::string assignment, exerciseHash, title;
    school::Milliseconds opens = 0, closes = 0;
};
[[nodiscard]] std::string toJson(const std::vector<Task>& tasks);
[[nodiscard]] std::vector<Task> tasksFrom(std::string_view json);

/// A work that a worker on another machine is lent.
struct Work {
    struct File {
        std::string hash;  ///< SHA-256
        std::uint64_t bytes = 0;
    };
    std::int64_t number = 0, turn = 0;  ///< of the job; which time it is lent
    school::Milliseconds leaseMs = 0;   ///< it is lent for, unless it is renewed
    std::string question;               ///< sandboxed::questionOf()
    std::vector<File> sessions{};
    File exercise{};
};
[[nodiscard]] std::string toJson(const Work& work);
[[nodiscard]] Work workFrom(std::string_view json);
/// What a station shows of the work that goes on at it.
inline constexpr std::size_t kMostPicture = 300'000;
struct Live {
    std::string person;      ///< the school's code
    std::string assignment;  ///< empty: practice of one's own
    std::string exerciseHash, title;
    bool isShared = false;  ///< practice that its student lets be watched
    double elapsedS = 0.0, removedMm3 = 0.0;
    std::vector<std::string> flags{};  ///< of kLiveFlags
    std::int64_t ageMs = 0;            ///< of the picture, when it was sent: no two clocks agree
    std::string picture{};             ///< the bytes of a JPEG file
};
/// What may have happened; others, of a newer station, are left out.
inline constexpr std::array<std::string_view, 8> kLiveFlags{"pulp-exposed",    "neighbour-touched", "neighbour-cut",
                                                            "gingiva-pressed", "gingiva-cut",       "head-touched",
                                                            "stalled",         "time-over"};
/// The length of the JSON (32 bits, low byte first), the JSON, the picture.
[[nodiscard]] std::string toBytes(const Live& live);
[[nodiscard]] Live liveFrom(std::string_view bytes);
[[nodiscard]] std::string framed(std::string_view json, std::string_view rest);
/// JSON, and the rest.
[[nodiscard]] std::pair<std::string_view, std::string_view> unframed(std::string_view bytes);

/// Who looks at a station, told to it.
struct Watcher {
    std::string name, role;
    friend bool operator==(const Watcher&, const Watcher&) = default;
};
struct Watched {
    std::vector<Watcher> by{};
    bool closely = false;  ///< somebody looks at this station alone: a larger picture is worth while
};
[[nodiscard]] std::string toJson(const Watched& watched);
[[nodiscard]] Watched watchedFrom(std::string_view json);

/// Where an error was that the other side told.
inline constexpr std::string_view kServer = "the school's server";
/// An error as the other side tells it, and back: what, where, what to do, and its name.
[[nodiscard]] std::string toJson(const core::Error& error);
[[nodiscard]] core::Error errorFrom(std::string_view json, int status);

}  // namespace handpiece::school_wire
