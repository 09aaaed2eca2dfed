// SPDX-License-Identifier: Apache-2.0
#include "school/exam_station.h"

#include <fmt/format.h>

#include <charconv>

#include "handpiece/base/core/file.h"
#include "handpiece/school/exam/lines.h"
#include "handpiece/school/exam/receipt.h"
#include "handpiece/school/store/content_files.h"
#include "school/line.h"
#include "school/send_file.h"
#include "school/station.h"

namespace handpiece::school_exam {
namespace {

using school_station::Line;

/// "12 word" a line; throws "server-nonsense".
std::vector<std::pair<std::int64_t, std::string>> numberedLines(const std::string& text, const std::string& server) {
    std::vector<std::pair<std::int64_t, std::string>> all;
    for (const std::string& line : exam::partsOf(text, '\n')) {
        if (line.empty()) continue;
        std::int64_t number = -1;
        const auto [end, ec] = std::from_chars(line.data(), line.data() + line.size(), number);
        const std::string_view rest(end, static_cast<std::size_t>(line.data() + line.size() - end));
        if (ec != std::errc() || number < 0 || !rest.starts_with(' ') || !exam::isCode(rest.substr(1)))
            throw core::Error("it answers what is no list", server, "ask whether this is its address")
                .as("server-nonsense", {"200"});
        all.emplace_back(number, rest.substr(1));
    }
    return all;
}

}  // namespace

void enrolForExams(const std::string& server, const std::string& code, const std::filesystem::path& folder) {
    if (core::isThere(folder / "station.txt"))
        throw core::Error("exams are set up at this station already", (folder / "station.txt").string(),
                          "move the folder away to enrol it anew: what it still has to tell goes with it");
    core::prepareOutputFolder(folder, true);
    const exam::SigningKey own = exam::keptSigningKey(folder / "station.key");
    const school_station::Enrolment made = school_station::enrol(server, code, "", "exam");
    const std::string serverKey = Line(made.server, made.key).post("/api/v1/exams/station", own.open);
    if (!school::isHex(serverKey, 64))
        throw core::Error("it gives no key of its own", server, "bring the server up to date").as("server-nonsense");
    exam::keepStation({made.server, made.station, made.key, serverKey}, folder);
}

Fetched fetchExams(const std::filesystem::path& folder) {
    const exam::StationIdentity station = exam::stationIn(folder);
    Line line(station.server, station.key);
    std::vector<std::string> ignored;
    const std::vector<exam::Installed> here = exam::packsIn(folder, ignored);
    Fetched fetched;
    for (const auto& [version, id] : numberedLines(line.get("/api/v1/exams"), station.server))
        try {
            bool isHere = false;
            for (const exam::Installed& one : here)
                isHere = isHere || (one.pack.exam == id && one.pack.version == version);
            if (isHere) continue;
            const exam::Signed pack = exam::parted(line.get("/api/v1/exams/" + id + "/pack"), "the exam's pack");
            const exam::Pack opened = exam::openedPack(pack, station.serverKey, "the exam's pack");
            std::filesystem::path file;
            if (!exam::hasExercise(folder, opened)) {
                file = folder / ("exercise." + school::newId());
                core::writeFile(file, line.get("/api/v1/exams/" + id + "/exercise", Line::kMostFile),
                                {.ownerOnly = true});
            }
            try {
                fetched.packs.push_back(exam::installPack(folder, pack, file));
            } catch (...) {
                std::error_code none;
                if (!file.empty()) std::filesystem::remove(file, none);
                throw;
            }
        } catch (const core::Error& e) {
            if (e.id() == "server-silent") throw;
            fetched.problems.push_back(fmt::format("exam {}: {}", id, e.what()));
        }
    return fetched;
}

void openExams(const std::filesystem::path& folder, school::Milliseconds now) {
    const exam::StationIdentity station = exam::stationIn(folder);
    std::vector<std::string> ignored;
    for (const exam::Installed& one : exam::packsIn(folder, ignored)) {
        if (!one.isSealed || now < one.pack.opens) continue;
        try {
            const std::string code =
                Line(station.server, station.key).get("/api/v1/exams/" + one.pack.exam + "/opening");
            exam::openExercise(folder, one.pack, code.substr(0, 100));
        } catch (const core::Error& e) {
            if (e.id() != "exam-early") throw;
        }
    }
}

Told pushExams(const exam::StationIdentity& station,
               const std::function<std::vector<exam::Signed>(std::int64_t, std::size_t)>& entriesAfter,
               const std::function<std::filesystem::path(const std::string&)>& fileOf) {
    Line line(station.server, station.key);
    Told told;
    const auto there = numberedLines(line.get("/api/v1/exams/chain"), station.server);
    std::int64_t last = there.empty() ? 0 : there.front().first;
    if (last > 0) {
        // Is it still the chain that the server knows?
        const std::vector<exam::Signed> same = entriesAfter(last - 1, 1);
        if (same.empty())
            throw core::Error(fmt::format("the server has {} entries of this station, and fewer are here", last),
                              station.server,
                              "the folder was put back from a copy: enrol the station anew, in an empty folder")
                .as("exam-chain", {std::to_string(last), ""});
        if (exam::hashOfEntry(same.front().text) != there.front().second)
            (void)line.post("/api/v1/exams/chain", exam::joined(same.front()));  // which it refuses, and notes
    }
    constexpr std::size_t kSome = 100;
    for (auto some = entriesAfter(last, kSome); !some.empty(); some = entriesAfter(last, kSome))
        for (const exam::Signed& entry : some) {
            (void)line.post("/api/v1/exams/chain", exam::joined(entry));
            ++last, ++told.entries;
        }
    for (const std::string& missing : school_wire::statusFrom(line.get("/api/v1/status")).missing)
        if (const std::filesystem::path file = fileOf(missing); !file.empty()) {
            (void)school_station::sendFile(line, file, missing);
            ++told.files;
        }
    return told;
}

void fetchReceipts(const exam::StationIdentity& station,
                   const std::vector<std::pair<std::string, std::filesystem::path>>& sittings) {
    if (sittings.empty()) return;
    Line line(station.server, station.key);
    for (const auto& [sitting, file] : sittings) {
        std::string receipt;
        try {
            receipt = line.get("/api/v1/exams/sittings/" + sitting + "/receipt");
        } catch (const core::Error& e) {
            if (e.id() != "books-unknown") throw;
            continue;
        }
        (void)exam::openedReceipt(receipt, station.serverKey, "the exam's receipt");
        core::writeFile(file, receipt, {.ownerOnly = true});
    }
}

}  // namespace handpiece::school_exam
