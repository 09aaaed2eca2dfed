// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/exam/pack.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>

#include "handpiece/model/case/exercise.h"
#include "handpiece/school/exam/lines.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/content_files.h"

namespace handpiece::exam {
namespace {

constexpr std::string_view kPackKind = "handpiece exam pack 2", kFirstPackKind = "handpiece exam pack 1";
constexpr std::int64_t kMostMs = 4'102'444'800'000;  // 2100
constexpr std::size_t kMostCandidates = 2000, kMostHash = 128;

core::Error twice(const char* what, const std::string& which, const std::string& where) {
    return core::Error(fmt::format("the {} {} is in this exam twice", what, which), where, "give one of them another")
        .as("exam-duplicate", {what, which});
}

std::vector<std::string> helpsIn(const LineReader& lines, std::string_view text, char between) {
    if (text.empty()) throw lines.damaged("it is empty");
    std::vector<std::string> helps = partsOf(text, between);
    for (const std::string& help : helps)
        if (std::find(cases::kHelps.begin(), cases::kHelps.end(), help) == cases::kHelps.end())
            // To begin without a lock that is not known would be another exam.
            throw core::Error(fmt::format("this program does not know the help \"{}\", which this exam speaks of",
                                          help.substr(0, 40)),
                              lines.where(), "bring this station up to date")
                .as("exam-newer", {help.substr(0, 40)});
    return helps;
}

}  // namespace

std::string toText(Pack p) {
    std::sort(p.candidates.begin(), p.candidates.end(),
              [](const Candidate& a, const Candidate& b) { return a.code < b.code; });
    std::sort(p.invigilators.begin(), p.invigilators.end(),
              [](const Invigilator& a, const Invigilator& b) { return a.person < b.person; });
    const bool isFirst = p.format == 1;
    LineWriter lines(isFirst ? kFirstPackKind : kPackKind);
    lines.add("exam", p.exam).add("version", p.version).add("title", p.title).add("exercise", p.exercise);
    lines.add("file", p.file).add("bytes", p.bytes).add("rubric", p.rubric).add("rubric_format", p.rubricFormat);
    lines.add("engine", p.engine).add("opens_ms", p.opens).add("closes_ms", p.closes).add("minutes", p.minutes);
    if (!isFirst) lines.add("seal", p.seal);
    lines.add("locked", p.locked.empty() ? "-" : fmt::format("{}", fmt::join(p.locked, " ")));
    for (const Candidate& c : p.candidates) {
        lines.add("candidate", fmt::format("{} {} {} {}", c.code, c.extraPercent, c.pauseMinutes,
                                           c.helps.empty() ? "-" : fmt::format("{}", fmt::join(c.helps, ","))));
        for (const std::string& one : c.confirmations)
            if (!isFirst) lines.add("confirmation", one);
    }
    for (const Invigilator& i : p.invigilators)
        lines.add("invigilator", isFirst ? fmt::format("{} {}", i.person, i.pin) : i.person);
    // What is given out can be read.
    (void)packFrom(lines.text(), p.exam);
    return lines.text();
}

Pack packFrom(std::string_view text, const std::string& where) {
    const bool isFirst = isOfKind(text, kFirstPackKind);
    LineReader lines(text, isFirst ? kFirstPackKind : kPackKind, where);
    Pack p;
    p.format = isFirst ? 1 : 2;
    p.exam = lines.code("exam");
    p.version = lines.whole("version", 1, 1'000'000);
    p.title = lines.text("title", 400);
    p.exercise = lines.hex("exercise", 16), p.file = lines.hex("file", 64);
    p.bytes = lines.whole("bytes", 1, std::int64_t{1} << 32);
    p.rubric = lines.hex("rubric", 16), p.rubricFormat = lines.whole("rubric_format", 1, 1000);
    p.engine = lines.whole("engine", 0, 1'000'000);
    p.opens = lines.whole("opens_ms", 0, kMostMs), p.closes = lines.whole("closes_ms", p.opens, kMostMs);
    p.minutes = lines.whole("minutes", 1, 1440);
    if (!isFirst) p.seal = lines.text("seal", kMostHash);
    if (const std::string locked = lines.text("locked", 400); locked != "-") p.locked = helpsIn(lines, locked, ' ');
    while (lines.isNext("candidate")) {
        const std::vector<std::string> parts = partsOf(lines.text("candidate", 400), ' ');
        if (parts.size() != 4 || !school::isHex(parts[0], 64)) throw lines.damaged("this is no candidate");
        Candidate c{parts[0], wholeOf(lines, parts[1], 0, 300), wholeOf(lines, parts[2], 0, 600)};
        if (parts[3] != "-") c.helps = helpsIn(lines, parts[3], ',');
        if (!p.candidates.empty() && p.candidates.back().code == c.code)
            throw twice("candidate's code", c.code.substr(0, 16) + "...", where);
        if (!p.candidates.empty() && p.candidates.back().code > c.code) throw lines.damaged("it is not in its place");
        if (p.candidates.size() == kMostCandidates) throw lines.damaged("there are too many candidates");
        while (!isFirst && lines.isNext("confirmation")) {
            c.confirmations.push_back(lines.text("confirmation", kMostHash));
            if (c.confirmations.size() > 10 || c.confirmations.back().empty())
                throw lines.damaged("this is no confirmation");
        }
        p.candidates.push_back(std::move(c));
    }
    while (lines.isNext("invigilator")) {
        const std::vector<std::string> parts = partsOf(lines.text("invigilator", 300), ' ');
        if (parts.size() != (isFirst ? 2u : 1u) || !isCode(parts[0]) || parts.back().empty())
            throw lines.damaged("this is no invigilator");
        if (!p.invigilators.empty() && p.invigilators.back().person == parts[0])
            throw twice("invigilator", parts[0], where);
        if (!p.invigilators.empty() && p.invigilators.back().person > parts[0])
            throw lines.damaged("it is not in its place");
        if (p.invigilators.size() == kMostCandidates) throw lines.damaged("there are too many invigilators");
        p.invigilators.push_back({parts[0], isFirst ? parts[1] : std::string()});
    }
    lines.end();
    return p;
}

Pack openedPack(const Signed& pack, std::string_view serverKey, const std::string& where) {
    requireSigned(pack.text, pack.signature, serverKey, "the exam", where);
    return packFrom(pack.text, where);
}

std::string candidateHash(std::string_view exam, std::string_view typedCode) {
    return school::sha256(fmt::format("handpiece candidate\n{}\n{}", exam, school::typedStationCode(typedCode)));
}

void requireFitting(const Pack& p, std::int64_t rubricFormat, std::int64_t engine) {
    if (p.rubricFormat > rubricFormat)
        throw core::Error(
            fmt::format("the exam's rubric is of format {}, and this program knows {}", p.rubricFormat, rubricFormat),
            p.exam, "bring this station up to date")
            .as("exam-rubric-newer", {std::to_string(p.rubricFormat), std::to_string(rubricFormat)});
    if (p.engine != engine)
        throw core::Error(fmt::format("the school's server cuts work again with engine {}, and this station has {}",
                                      p.engine, engine),
                          p.exam, "bring both to one version: work of another engine cannot be proven")
            .as("exam-engine-other", {std::to_string(p.engine), std::to_string(engine)});
}

void requireOpen(const Pack& p, Milliseconds now) {
    if (now < p.opens)
        throw core::Error(
            fmt::format("this exam begins {}, and it is {} at this station", clockOf(p.opens), clockOf(now)), p.exam,
            "wait, or put this station's clock right")
            .as("exam-early", {clockOf(p.opens), clockOf(now)});
    if (now > p.closes)
        throw core::Error(fmt::format("this exam could be begun until {}, and it is {} at this station",
                                      clockOf(p.closes), clockOf(now)),
                          p.exam, "put this station's clock right, or ask the teacher for a new time")
            .as("exam-expired", {clockOf(p.closes), clockOf(now)});
}

const Candidate& candidateOf(const Pack& p, std::string_view typedCode) {
    const std::string hash = candidateHash(p.exam, typedCode);
    for (const Candidate& one : p.candidates)
        if (one.code == hash) return one;
    throw core::Error("this exam knows no candidate of this code", p.exam,
                      "type it as it stands on the slip; who came later needs a newer pack: fetch it again")
        .as("exam-candidate-unknown", {p.exam});
}

Milliseconds deadlineOf(const Pack& p, const Candidate& c, Milliseconds began) {
    return began + p.minutes * 600 * (100 + c.extraPercent) + c.pauseMinutes * 60'000;
}

std::vector<std::string> lockedFor(const Pack& p, const Candidate& c, const std::vector<std::string>& exercise) {
    std::vector<std::string> locked;
    for (const std::string_view help : cases::kHelps) {
        const auto in = [help](const std::vector<std::string>& all) {
            return std::find(all.begin(), all.end(), help) != all.end();
        };
        if ((in(exercise) || in(p.locked)) && !in(c.helps)) locked.emplace_back(help);
    }
    return locked;
}

std::string clockOf(Milliseconds since1970) {
    return fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(static_cast<std::time_t>(since1970 / 1000)));
}

}  // namespace handpiece::exam
