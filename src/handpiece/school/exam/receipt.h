// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a server signs of work that came: its student keeps it, anybody may check it. No name and no code of a person.

#include <string>
#include <string_view>
#include <vector>

#include "handpiece/school/exam/chain.h"

namespace handpiece::exam {

struct Receipt {
    std::string sitting{}, exam{}, candidate{}, station{};
    Milliseconds began = 0, finished = 0, received = 0, made = 0;
    std::vector<std::string> files{};  ///< SHA-256, in the order of the work
    std::string state{};               ///< "waiting", "proven", "refused"
    std::string stateHash{};           ///< of the tooth that it leaves, 16 digits; empty where it is not known
    std::string verdict{};             ///< "to be confirmed", "pass", "fail", "void"
};
[[nodiscard]] std::string toText(const Receipt& receipt);
/// Throws core::Error "exam-damaged", "exam-newer".
[[nodiscard]] Receipt receiptFrom(std::string_view text, const std::string& where);
/// Throws also "exam-other-key", "exam-changed".
[[nodiscard]] Receipt openedReceipt(std::string_view joined, std::string_view serverKey, const std::string& where);

}  // namespace handpiece::exam
