// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Exams in a browser: who sat it and how it stands, one sitting with what a teacher should know, what people decided.

#include <filesystem>
#include <string>

#include "school/pages.h"

namespace handpiece::school_server {

// `data`: the server's folder.
[[nodiscard]] Page examOf(const Visit& visit, const std::string& exam, const std::filesystem::path& data);
[[nodiscard]] Page sittingOf(const Visit& visit, const std::string& id, const std::filesystem::path& data);
[[nodiscard]] Page receiptOf(const Visit& visit, const std::string& id, const std::filesystem::path& data);
/// `kind` as school::ExamDecision has it.
[[nodiscard]] Page decide(const Visit& visit, const std::string& id, const char* kind, const std::string& verdict,
                          const std::string& words);

[[nodiscard]] bool isExam(const Visit& visit, const std::string& attempt);

}  // namespace handpiece::school_server
