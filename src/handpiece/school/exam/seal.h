// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An exam's exercise before its time: closed by a code that the server tells from the opening on, and an invigilator
/// has for where the network is not. docs/school-exams.md.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::exam {

/// XSalsa20-Poly1305 under a key that Argon2id makes of the code (school::newStationCode(), 60 bits), by libsodium.
/// Another text each time. Throws core::Error "no-memory".
[[nodiscard]] std::vector<std::byte> sealed(std::span<const std::byte> bytes, std::string_view exam,
                                            std::string_view code);
/// Throws core::Error "exam-seal": another code or exam, or changed since.
[[nodiscard]] std::vector<std::byte> unsealed(std::span<const std::byte> sealed, std::string_view exam,
                                              std::string_view typedCode);

}  // namespace handpiece::exam
