// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/exam/receipt.h"

#include <algorithm>
#include <array>

#include "handpiece/school/exam/lines.h"
#include "handpiece/school/store/content_files.h"

namespace handpiece::exam {
namespace {

constexpr std::string_view kReceiptKind = "handpiece exam receipt 1";
constexpr std::int64_t kLatestMs = std::int64_t{1} << 53;
constexpr std::array<std::string_view, 3> kStates = {"waiting", "proven", "refused"};
constexpr std::array<std::string_view, 4> kVerdicts = {"to be confirmed", "pass", "fail", "void"};

}  // namespace

std::string toText(const Receipt& r) {
    LineWriter lines(kReceiptKind);
    lines.add("sitting", r.sitting).add("exam", r.exam).add("candidate", r.candidate).add("station", r.station);
    lines.add("began_ms", r.began).add("finished_ms", r.finished).add("received_ms", r.received);
    lines.add("made_ms", r.made);
    for (const std::string& file : r.files)
        lines.add("file", file);
    lines.add("state", r.state).add("state_hash", r.stateHash.empty() ? "-" : r.stateHash).add("verdict", r.verdict);
    return lines.text();
}

Receipt receiptFrom(std::string_view text, const std::string& where) {
    LineReader lines(text, kReceiptKind, where);
    Receipt r;
    r.sitting = lines.hex("sitting", 32), r.exam = lines.code("exam"), r.candidate = lines.hex("candidate", 64);
    r.station = lines.hex("station", 32);
    r.began = lines.whole("began_ms", 0, kLatestMs), r.finished = lines.whole("finished_ms", 0, kLatestMs);
    r.received = lines.whole("received_ms", 0, kLatestMs), r.made = lines.whole("made_ms", 0, kLatestMs);
    while (lines.isNext("file"))
        r.files.push_back(lines.hex("file", 64));
    r.state = lines.text("state", 20);
    if (std::find(kStates.begin(), kStates.end(), r.state) == kStates.end()) throw lines.damaged("this is no state");
    if (const std::string hash = lines.text("state_hash", 16); hash != "-") {
        if (!school::isHex(hash, 16)) throw lines.damaged("\"state_hash\" has no 16 digits");
        r.stateHash = hash;
    }
    r.verdict = lines.text("verdict", 20);
    if (std::find(kVerdicts.begin(), kVerdicts.end(), r.verdict) == kVerdicts.end())
        throw lines.damaged("this is no verdict");
    lines.end();
    return r;
}

Receipt openedReceipt(std::string_view joined, std::string_view serverKey, const std::string& where) {
    const Signed both = parted(joined, where);
    requireSigned(both.text, both.signature, serverKey, "the receipt", where);
    return receiptFrom(both.text, where);
}

}  // namespace handpiece::exam
