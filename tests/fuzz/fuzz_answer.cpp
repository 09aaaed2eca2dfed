// SPDX-License-Identifier: Apache-2.0
// Whatever a sandbox's child, or a worker on another machine, says must give an answer within its bounds that is
// written and read again as the same, or one core::Error.
#include <algorithm>
#include <cmath>

#include "fuzz_model.h"
#include "handpiece/app/sandboxed/sandboxed.h"
#include "handpiece/base/core/utf8.h"
#include "handpiece/base/sandbox/hearing.h"

using namespace handpiece;

namespace {

void prove(std::string_view text, std::size_t sessions) {
    (void)fuzz::readText(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), [&](std::string_view one) {
        const sandboxed::Proof proof = sandboxed::proofFrom(std::string(one), sessions);
        if (!std::isfinite(proof.score.score) || proof.contents.inputs.size() != sessions) __builtin_trap();
        const std::string once = sandboxed::toJson(proof);
        const auto again = fuzz::mustRead([&] { return sandboxed::proofFrom(once, sessions); });
        if (sandboxed::toJson(again) != once) __builtin_trap();
    });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 2) return 0;
    // As a pipe gives it: in pieces of any size.
    const std::size_t piece = 1 + data[0], sessions = data[1] % 4, most = 4096;
    const std::string_view said(reinterpret_cast<const char*>(data + 2), size - 2);
    prove(said, sessions);
    (void)fuzz::readText(data, size, [&](std::string_view) {
        sandbox::Hearing hearing(most);
        std::string come;
        try {
            for (std::size_t at = 0; at < said.size(); at += piece) {
                come += said.substr(at, piece);
                hearing.hear(come);
            }
        } catch (const core::Error& e) {
            // Pages and databases show it.
            for (std::string_view left = e.problem(); !left.empty(); left.remove_prefix(core::utf8Length(left)))
                if (core::utf8Length(left) == 0 || static_cast<unsigned char>(left.front()) < ' ') __builtin_trap();
            throw;
        }
        if (hearing.answer.text.size() > most || hearing.answer.bytes.size() > most) __builtin_trap();
        if (hearing.isWhole) prove(hearing.answer.text, sessions);
    });
    return 0;
}
