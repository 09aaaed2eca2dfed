// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/sandbox/hearing.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <vector>

#include "handpiece/base/core/utf8.h"

namespace handpiece::sandbox {
namespace {

/// UTF-8 without control characters, as pages and databases take it.
std::string plain(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t length = core::utf8Length(text);
        const auto first = static_cast<unsigned char>(text.front());
        if (length == 0 || first < ' ' || first == 0x7f)
            out += length == 0 ? '?' : ' ';
        else
            out += text.substr(0, length);
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return out;
}

[[noreturn]] void fail(std::string_view piece) {
    Taker taker(piece);
    const std::string id = plain(taker.text()), problem = plain(taker.text()), where = plain(taker.text()),
                      remedy = plain(taker.text());
    std::vector<std::string> arguments;
    while (taker.isWhole && !taker.isEmpty())
        arguments.push_back(plain(taker.text()));
    // Its own troubles are told by who started it alone.
    if (!taker.isWhole || id == "sandbox-start" || id == "sandbox-killed" || id == "cancelled" ||
        problem == "cancelled" || problem.empty())
        throw died("it sent what is no answer");
    throw core::Error(problem, where, remedy).as(id, arguments);
}

}  // namespace

core::Error died(const std::string& how) {
    return core::Error(fmt::format("reading it ended the program that reads it ({})", how), "",
                       "it is damaged, or was made to do this: record it again")
        .as("sandbox-died", {how});
}

void Hearing::hear(std::string& come) {
    std::size_t at = 0;
    while (!isWhole && come.size() - at >= kHeadBytes) {
        const auto kind = static_cast<Frame>(come[at]);
        const std::size_t size = Taker(std::string_view(come).substr(at + 1)).number(4);
        if (size > mostOf(kind)) throw died("it sent what is no answer");
        if (come.size() - at - kHeadBytes < size) break;
        take(kind, std::string_view(come).substr(at + kHeadBytes, size));
        at += kHeadBytes + size;
    }
    come.erase(0, at);
}

std::size_t Hearing::mostOf(Frame kind) const {
    switch (kind) {
        case Frame::ready:
        case Frame::end:
            return 0;
        case Frame::progress:
            return 8;
        case Frame::text:
        case Frame::bytes:
            return most_;
        case Frame::error:
            return kMostErrorBytes;
    }
    throw died("it sent what is no answer");
}

void Hearing::take(Frame kind, std::string_view piece) {
    if (isReady == (kind == Frame::ready)) throw died("it sent what is no answer");
    if (kind == Frame::ready) isReady = true;
    if (kind == Frame::progress) {
        int thousandths = 0;
        (void)std::from_chars(piece.data(), piece.data() + piece.size(), thousandths);
        progress = 1e-3 * thousandths;
    }
    if (kind == Frame::text) answer.text = piece;
    if (kind == Frame::bytes) {
        const auto* data = reinterpret_cast<const std::byte*>(piece.data());
        answer.bytes.assign(data, data + piece.size());
    }
    if (kind == Frame::end) isWhole = true;
    if (kind == Frame::error) fail(piece);
}

}  // namespace handpiece::sandbox
