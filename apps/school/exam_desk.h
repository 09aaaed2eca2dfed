// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a student's programs hear from the service that holds a station's exams, over a socket of this machine. Texts
/// as school/exam has them.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/school/store/store.h"

namespace handpiece::school_exam {

/// Where it listens unless told.
inline constexpr const char* kSocket = "/run/handpiece/exam.sock";

struct Desk {
    std::string sitting{};  ///< empty: nobody is at an exam
    std::string exam{}, title{};
    school::Milliseconds now = 0, began = 0, deadline = 0;
    std::int64_t extraPercent = 0, pauseMinutes = 0;  ///< of this candidate, and in the deadline
    std::vector<std::string> locked{};                ///< helps that this candidate does not have
    std::int64_t again = 0;                           ///< how often they had begun here before
    std::int64_t waiting = 0;                         ///< entries and recordings that the server has not yet
    std::string trouble{};                            ///< why not, or what is wrong with a pack; empty: nothing
};
[[nodiscard]] std::string toText(const Desk& desk);
/// Throws core::Error "exam-damaged".
[[nodiscard]] Desk deskFrom(std::string_view text);

/// A student's side. All throw core::Error: "exam-service" where nobody listens, else what the service says.
class ExamClient {
  public:
    explicit ExamClient(std::filesystem::path socket) : socket_(std::move(socket)) {}
    [[nodiscard]] Desk desk() const;
    /// A sealed exam by the code on an invigilator's sheet, where the server does not open it.
    void open(const std::string& code) const;
    /// What would be begun by this code, as JSON: title, closes_ms, minutes, extra_percent, pause_minutes, locked,
    /// again, titles and instructions by language.
    [[nodiscard]] std::string look(const std::string& candidate) const;
    /// `pin`: the invigilator's confirmation code.
    Desk begin(const std::string& candidate, const std::string& invigilator, const std::string& pin) const;
    /// The exercise of the exam that was begun, as a file.
    void keepExercise(const std::filesystem::path& file) const;
    void checkpoint(const std::string& sitting, std::int64_t part, std::int64_t ticks, const std::string& inputs) const;
    /// Notes how far the recordings are, hands all of them over, and ends it. Returns the entry that was signed.
    std::string finish(const std::string& sitting, const std::vector<std::filesystem::path>& recordings) const;
    void giveUp(const std::string& sitting, const std::string& invigilator, const std::string& pin) const;
    /// The entry that ended it: "finished", "given-up".
    [[nodiscard]] std::string ending(const std::string& sitting) const;
    /// That the school's server signed; empty: it has not come yet.
    [[nodiscard]] std::string receipt(const std::string& sitting) const;

  private:
    std::filesystem::path socket_;
};

}  // namespace handpiece::school_exam
