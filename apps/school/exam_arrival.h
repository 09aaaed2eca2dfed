// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a server makes of exams: packs that it signs, entries of stations' chains that come, recordings held against
/// them, receipts. docs/school-exams.md.

#include <filesystem>
#include <optional>
#include <string>

#include "handpiece/app/sandboxed/sandboxed.h"
#include "handpiece/school/exam/receipt.h"
#include "handpiece/school/store/exam_books.h"

namespace handpiece::school_server {

/// Made once, in the server's folder.
[[nodiscard]] exam::SigningKey examKey(const std::filesystem::path& data);

/// Signs what the books say of an exam by now, as its next version; the same again is the same pack. Throws
/// core::Error: "books-unknown", and where nobody could sit it ("exam-empty").
school::ExamPack signExam(school::Books& books, const std::string& exam, const exam::SigningKey& key,
                          const school::Act& act);

/// One entry of a station's chain. False: it was there already. Throws core::Error as exam::nextOf, and "books-unknown"
/// for a pack or candidate that is not this school's.
bool takeEntry(school::Books& books, const std::string& station, std::string_view joined, school::Milliseconds now);

/// What recordings of an exam are held against; nothing for other attempts.
[[nodiscard]] std::optional<sandboxed::ExamNotes> examNotes(school::Books& books, const school::PushedAttempt& attempt);
/// All of it: what was found in the recordings, and what the chain and other stations say.
[[nodiscard]] std::vector<std::string> doubtsOf(school::Books& books, const school::ExamSitting& sitting);

[[nodiscard]] exam::Signed receiptOf(school::Books& books, const school::ExamSitting& sitting,
                                     const exam::SigningKey& key, school::Milliseconds now);

/// For the station that held it, once its recordings are here. Throws core::Error "books-unknown" before.
[[nodiscard]] std::string receiptFor(school::Books& books, const std::string& station, const std::string& sitting,
                                     const exam::SigningKey& key, school::Milliseconds now);

}  // namespace handpiece::school_server
