// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A station's side: what its store of results has in the outbox goes to the school's server, now or a month later.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/school/store/store.h"
#include "school/wire.h"

namespace handpiece::school_station {

/// What a station knows of its school, in a file that only its owner reads.
struct Enrolment {
    std::string server;  ///< http(s)://host[:port]
    std::string station, key;
    std::string person;                     ///< whose results these are: the school's code
    std::int64_t sent = 0;                  ///< up to where in the outbox the server has it
    std::string books{};                    ///< incarnation of the server's books that have it
    int protocol = school_wire::kProtocol;  ///< that it speaks; not in the file
};
/// Throws core::Error "not-enrolled" where there is none, and for one that is damaged.
[[nodiscard]] Enrolment readEnrolment(const std::filesystem::path& file);
void writeEnrolment(const Enrolment& enrolment, const std::filesystem::path& file);

/// With a one-time code; one of a person's account says whose work it will send, else `person` does. Throws
/// core::Error: "code-unknown", "server-silent", "server-nonsense", an address that is none.
/// "code-other" (it is not spent then). `kind`: "exam" of a station for exams.
[[nodiscard]] Enrolment enrol(const std::string& server, const std::string& code, const std::string& person,
                              const std::string& kind = "practice");

struct Pushed {
    std::size_t attempts = 0, judgements = 0, files = 0;
    std::uint64_t bytes = 0;
    std::vector<std::string> refused;     ///< what the server will never take, a sentence each; the rest went on
    school::Milliseconds clockAhead = 0;  ///< of this computer against the server's; 0: they agree to a minute
};
/// All that is waiting, oldest first; `file` is written after each piece that the server has, so what was cut off goes
/// on from there. Recordings lie in `sessions`; of an attempt whose recordings are gone the rest goes. Comments and
/// marks stay here: they came from a teacher. Throws core::Error: "server-silent", "not-enrolled", "protocol-other",
/// whatever the server says; what went before then is there.
Pushed push(school::Store& store, const std::filesystem::path& sessions, Enrolment& enrolment,
            const std::filesystem::path& file, const core::Progress& progress = {});

/// By this computer's clock.
[[nodiscard]] school::Milliseconds clockNow();
/// How much of the outbox the server has not heard of yet.
[[nodiscard]] std::size_t waitingIn(const school::Store& store, const Enrolment& enrolment);
/// What its person has to do; times by this computer's clock, which may be wrong.
[[nodiscard]] std::vector<school_wire::Task> tasksOf(const Enrolment& enrolment);
[[nodiscard]] school_wire::Status status(const Enrolment& enrolment);

}  // namespace handpiece::school_station
