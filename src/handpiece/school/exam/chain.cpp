// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/exam/chain.h"

#include <fmt/format.h>

#include <algorithm>

#include "handpiece/school/exam/lines.h"
#include "handpiece/school/store/content_files.h"

namespace handpiece::exam {
namespace {

constexpr std::string_view kRecordKind = "handpiece exam record 2", kFirstRecordKind = "handpiece exam record 1";
constexpr std::int64_t kMost = std::int64_t{1} << 53;
/// A checkpoint is due every half minute.
constexpr Milliseconds kSilentMs = 120'000, kGraceMs = 120'000, kClockMs = 120'000;
constexpr std::size_t kMostFiles = 100;

std::string secondsOf(Milliseconds ms) {
    return fmt::format("{} s", (ms + 500) / 1000);
}

}  // namespace

std::string toText(const Entry& e) {
    LineWriter lines(e.format == 1 ? kFirstRecordKind : kRecordKind);
    const auto confirmed = [&] {
        if (e.format != 1) lines.add("confirmation", e.confirmation.empty() ? "-" : e.confirmation);
    };
    lines.add("station", e.station).add("number", e.number).add("previous", e.previous).add("at_ms", e.at);
    lines.add("kind", e.kind);
    if (e.kind != "started") lines.add("sitting", e.sitting);
    if (e.kind == "begun")
        lines.add("exam", e.exam)
            .add("pack", e.pack)
            .add("candidate", e.candidate)
            .add("invigilator", e.invigilator)
            .add("again", e.again);
    if (e.kind == "begun") confirmed();
    if (e.kind == "checkpoint") lines.add("part", e.part).add("ticks", e.ticks).add("inputs", e.inputs);
    if (e.kind == "given-up") {
        lines.add("invigilator", e.invigilator);
        confirmed();
    }
    if (e.kind == "finished")
        for (const HandedOver& one : e.files)
            lines.add("file", fmt::format("{} {} {}", one.file, one.work, one.bytes));
    return lines.text();
}

Entry entryFrom(std::string_view text, const std::string& where) {
    const bool isFirst = isOfKind(text, kFirstRecordKind);
    LineReader lines(text, isFirst ? kFirstRecordKind : kRecordKind, where);
    Entry e;
    e.format = isFirst ? 1 : 2;
    const auto readConfirmation = [&] {
        if (isFirst) return;
        if (e.confirmation = lines.code("confirmation"); e.confirmation == "-") e.confirmation.clear();
    };
    e.station = lines.hex("station", 32), e.number = lines.whole("number", 1, kMost);
    e.previous = lines.hex("previous", 64), e.at = lines.whole("at_ms", 0, kMost);
    e.kind = lines.text("kind", 20);
    if (e.kind != "started") e.sitting = lines.hex("sitting", 32);
    if (e.kind == "begun") {
        e.exam = lines.code("exam"), e.pack = lines.hex("pack", 64), e.candidate = lines.hex("candidate", 64);
        e.invigilator = lines.code("invigilator"), e.again = lines.whole("again", 0, kMost);
        readConfirmation();
    } else if (e.kind == "checkpoint") {
        e.part = lines.whole("part", 1, static_cast<std::int64_t>(kMostFiles));
        e.ticks = lines.whole("ticks", 0, kMost), e.inputs = lines.hex("inputs", 64);
    } else if (e.kind == "given-up") {
        e.invigilator = lines.code("invigilator");
        readConfirmation();
    } else if (e.kind == "finished") {
        while (lines.isNext("file")) {
            const std::vector<std::string> parts = partsOf(lines.text("file", 200), ' ');
            if (parts.size() != 3 || !school::isHex(parts[0], 64) || !school::isHex(parts[1], 16))
                throw lines.damaged("this is no file");
            if (e.files.size() == kMostFiles) throw lines.damaged("there are too many files");
            e.files.push_back({parts[0], parts[1], wholeOf(lines, parts[2], 0, kMost)});
        }
        if (e.files.empty()) throw lines.damaged("nothing was handed over");
    } else if (e.kind != "started") {
        throw lines.damaged("this is no kind of entry");
    }
    lines.end();
    return e;
}

std::string hashOfEntry(std::string_view text) {
    return school::sha256(text);
}

Entry nextOf(const ChainEnd& end, const Signed& entry, const std::string& station, std::string_view stationKey) {
    const std::string where = "station " + station;
    requireSigned(entry.text, entry.signature, stationKey, "the entry", where);
    Entry e = entryFrom(entry.text, where);
    if (e.station != station || e.number != end.number + 1 || e.previous != end.hash)
        throw core::Error(fmt::format("entry {} does not follow entry {} of this station", e.number, end.number), where,
                          "what was noted of exams was changed or put back from a copy: tell the administrator; a "
                          "station that is enrolled anew begins a new chain")
            .as("exam-chain", {std::to_string(e.number), std::to_string(end.number)});
    return e;
}

std::vector<std::string> doubtsOf(const Pack& pack, std::span<const Entry> entries,
                                  std::span<const Milliseconds> received) {
    std::vector<std::string> doubts;
    if (entries.empty() || entries.front().kind != "begun") return {"there is no entry of its beginning"};
    const Entry& begun = entries.front();
    const auto known = std::find_if(pack.candidates.begin(), pack.candidates.end(),
                                    [&](const Candidate& c) { return c.code == begun.candidate; });
    if (known == pack.candidates.end()) return {"this exam knows no such candidate"};
    if (begun.at < pack.opens) doubts.push_back("it was begun before the exam opened, " + clockOf(begun.at));
    if (begun.at > pack.closes) doubts.push_back("it was begun after the exam closed, " + clockOf(begun.at));
    if (std::none_of(pack.invigilators.begin(), pack.invigilators.end(),
                     [&](const Invigilator& one) { return one.person == begun.invigilator; }))
        doubts.push_back("whoever confirmed the identity is none of this exam's invigilators: " + begun.invigilator);
    if (begun.again > 0) doubts.push_back(fmt::format("this candidate had begun {} times here before", begun.again));
    std::int64_t restarts = 0, checkpoints = 0;
    Milliseconds last = begun.at, silent = 0;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const Entry& e = entries[i];
        if (i > 0 && e.at < entries[i - 1].at)
            doubts.push_back(fmt::format("the station's clock went back by {}", secondsOf(entries[i - 1].at - e.at)));
        // It cannot come before it was.
        if (i < received.size() && e.at > received[i] + kClockMs)
            doubts.push_back(fmt::format("the station's clock is ahead of the server's by {} or more",
                                         secondsOf(e.at - received[i])));
        if (e.kind == "started") ++restarts;
        if (e.kind == "checkpoint") ++checkpoints;
        if (e.kind == "checkpoint" || e.kind == "finished") silent = std::max(silent, e.at - last), last = e.at;
        for (std::size_t k = 0; k < i && e.kind == "checkpoint"; ++k)
            if (entries[k].kind == "checkpoint" && entries[k].part == e.part && entries[k].ticks > e.ticks) {
                doubts.push_back(
                    fmt::format("recording {} went back from {} to {} ticks", e.part, entries[k].ticks, e.ticks));
                break;
            }
    }
    if (restarts > 0) doubts.push_back(fmt::format("the station's service was started again {} times", restarts));
    if (silent > kSilentMs) doubts.push_back(fmt::format("nothing was heard of the work for {}", secondsOf(silent)));
    const Entry& end = entries.back();
    if (end.kind == "given-up") doubts.push_back("it was given up, by " + end.invigilator);
    if (end.kind == "finished") {
        if (checkpoints == 0) doubts.push_back("nothing was heard of the work before it was handed over");
        if (const Milliseconds late = end.at - deadlineOf(pack, *known, begun.at); late > kGraceMs)
            doubts.push_back(fmt::format("it was handed over {} late", secondsOf(late)));
    }
    // Said once each.
    std::vector<std::string> once;
    for (std::string& one : doubts)
        if (std::find(once.begin(), once.end(), one) == once.end()) once.push_back(std::move(one));
    return once;
}

}  // namespace handpiece::exam
