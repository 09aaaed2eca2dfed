// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The service that holds a station's exams, under a user of its own: students' programs speak to it over a socket of
/// this machine, and it tells the school's server. docs/school-exams.md says what that protects and what not.

#include <chrono>
#include <filesystem>
#include <memory>

#include "school/server.h"

namespace handpiece::school_exam {

struct ExamServiceSettings {
    std::filesystem::path folder;
    std::filesystem::path socket;
    std::chrono::milliseconds every{15'000};  ///< between two tries to tell the server
};

class ExamService {
  public:
    /// Throws core::Error: "not-enrolled", "exam-chain", "exam-busy", and where nobody can listen.
    explicit ExamService(ExamServiceSettings settings, school_server::Clock clock = school_server::systemClock());
    ~ExamService();
    ExamService(const ExamService&) = delete;
    ExamService& operator=(const ExamService&) = delete;

    /// Until stop(), which may be called from another thread.
    void run();
    void stop();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::school_exam
