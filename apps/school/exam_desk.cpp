// SPDX-License-Identifier: Apache-2.0
#include "school/exam_desk.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/socket.h>

#include <algorithm>

#include "handpiece/app/proving/exam_check.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/exam/lines.h"
#include "school/http.h"
#include "school/wire.h"

namespace handpiece::school_exam {
namespace {

constexpr std::string_view kKind = "handpiece exam desk 2";
constexpr std::int64_t kMost = std::int64_t{1} << 53;

std::string plain(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, ' ');
    return text.substr(0, 1000);
}

class DeskLine {
  public:
    explicit DeskLine(const std::filesystem::path& socket) : socket_(socket), http_(socket.string()) {
        http_.set_address_family(AF_UNIX);
        http_.set_read_timeout(60);
        http_.set_write_timeout(60);
    }
    std::string get(const std::string& path) { return heard(http_.Get(path)); }
    std::string post(const std::string& path, const httplib::Params& form) { return heard(http_.Post(path, form)); }
    std::string put(const std::string& path, const std::filesystem::path& file) {
        const std::vector<std::byte> bytes = core::readFile(file);
        return heard(
            http_.Put(path, reinterpret_cast<const char*>(bytes.data()), bytes.size(), "application/octet-stream"));
    }

  private:
    std::string heard(const httplib::Result& result) const {
        if (!result)
            throw core::Error(fmt::format("the service that holds this station's exams does not answer ({})",
                                          httplib::to_string(result.error())),
                              socket_.string(), "call the invigilator: it is started by its own user")
                .as("exam-service", {httplib::to_string(result.error())});
        if (result->status < 200 || result->status > 299) {
            const core::Error e = school_wire::errorFrom(result->body, result->status);
            throw core::Error(e.problem(), "this station's exams", e.remedy()).as(e.id(), e.arguments());
        }
        return result->body;
    }
    const std::filesystem::path& socket_;
    httplib::Client http_;
};

}  // namespace

std::string toText(const Desk& d) {
    exam::LineWriter lines(kKind);
    lines.add("sitting", d.sitting).add("exam", d.exam).add("title", plain(d.title)).add("now_ms", d.now);
    lines.add("began_ms", d.began).add("deadline_ms", d.deadline);
    lines.add("extra_percent", d.extraPercent).add("pause_minutes", d.pauseMinutes);
    lines.add("locked", fmt::format("{}", fmt::join(d.locked, " "))).add("again", d.again).add("waiting", d.waiting);
    lines.add("trouble", plain(d.trouble));
    return lines.text();
}

Desk deskFrom(std::string_view text) {
    exam::LineReader lines(text, kKind, "the station's exams");
    Desk d;
    d.sitting = lines.text("sitting", 32), d.exam = lines.text("exam", 64), d.title = lines.text("title", 1000);
    d.now = lines.whole("now_ms", 0, kMost), d.began = lines.whole("began_ms", 0, kMost);
    d.deadline = lines.whole("deadline_ms", 0, kMost), d.extraPercent = lines.whole("extra_percent", 0, kMost);
    d.pauseMinutes = lines.whole("pause_minutes", 0, kMost);
    d.locked = exam::partsOf(lines.text("locked", 1000), ' ');
    d.again = lines.whole("again", 0, kMost), d.waiting = lines.whole("waiting", 0, kMost);
    d.trouble = lines.text("trouble", 1000);
    lines.end();
    return d;
}

Desk ExamClient::desk() const {
    return deskFrom(DeskLine(socket_).get("/desk"));
}

std::string ExamClient::look(const std::string& candidate) const {
    return DeskLine(socket_).post("/look", {{"candidate", candidate}});
}

void ExamClient::open(const std::string& code) const {
    (void)DeskLine(socket_).post("/open", {{"code", code}});
}

Desk ExamClient::begin(const std::string& candidate, const std::string& invigilator, const std::string& pin) const {
    return deskFrom(
        DeskLine(socket_).post("/begin", {{"candidate", candidate}, {"invigilator", invigilator}, {"pin", pin}}));
}

void ExamClient::keepExercise(const std::filesystem::path& file) const {
    core::writeFile(file, DeskLine(socket_).get("/exercise"));
}

void ExamClient::checkpoint(const std::string& sitting, std::int64_t part, std::int64_t ticks,
                            const std::string& inputs) const {
    (void)DeskLine(socket_).post(
        "/checkpoint",
        {{"sitting", sitting}, {"part", std::to_string(part)}, {"ticks", std::to_string(ticks)}, {"inputs", inputs}});
}

std::string ExamClient::finish(const std::string& sitting, const std::vector<std::filesystem::path>& recordings) const {
    DeskLine line(socket_);
    std::int64_t part = 0;
    for (const std::filesystem::path& file : recordings) {
        proving::RecordedInputs inputs(file);
        inputs.goOn();
        checkpoint(sitting, ++part, inputs.ticks(), inputs.hash());
        (void)line.put(fmt::format("/recording?sitting={}&part={}", sitting, part), file);
    }
    return line.post("/finish", {{"sitting", sitting}, {"parts", std::to_string(part)}});
}

void ExamClient::giveUp(const std::string& sitting, const std::string& invigilator, const std::string& pin) const {
    (void)DeskLine(socket_).post("/give-up", {{"sitting", sitting}, {"invigilator", invigilator}, {"pin", pin}});
}

std::string ExamClient::ending(const std::string& sitting) const {
    return DeskLine(socket_).get("/ending?sitting=" + sitting);
}

std::string ExamClient::receipt(const std::string& sitting) const {
    return DeskLine(socket_).get("/receipt?sitting=" + sitting);
}

}  // namespace handpiece::school_exam
