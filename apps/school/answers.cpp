// SPDX-License-Identifier: Apache-2.0
#include "school/answers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <string_view>

#include "handpiece/app/report/report_html.h"
#include "school/wire.h"

namespace handpiece::school_server {
namespace {

using httplib::Request;
using httplib::Response;

constexpr const char *kJson = "application/json", *kCookie = "handpiece", *kPolicy = "Content-Security-Policy";

int statusOf(const core::Error& error) {
    static const std::map<std::string, int, std::less<>> statuses{
        {"message-damaged", 400},  {"books-invalid", 400},  {"not-enrolled", 401},    {"exam-station", 403},
        {"code-unknown", 403},     {"live-private", 403},   {"books-unknown", 404},   {"books-duplicate", 409},
        {"books-changed", 409},    {"upload-offset", 409},  {"upload-mismatch", 422}, {"no-space", 507},
        {"store-locked", 503},     {"store-gone", 503},     {"store-refused", 503},   {"store-full", 503},
        {"store-busy", 503},       {"protocol-other", 426}, {"exam-damaged", 400},    {"exam-newer", 400},
        {"exam-other-key", 403},   {"exam-changed", 403},   {"exam-chain", 409},      {"account-suspended", 403},
        {"exam-invigilator", 403}, {"exam-early", 403},     {"code-other", 403},      {"station-anothers", 403},
        {"station-anybodys", 403}, {"work-lost", 409},      {"engine-other", 426},    {"work-enough", 429}};
    const auto found = statuses.find(error.id());
    return found != statuses.end() ? found->second : 500;
}

/// What is about the message: its places are the other side's own. Of all else they are paths and databases.
bool isOfMessage(const core::Error& error) {
    return error.id() == "message-damaged" || error.id() == "books-invalid" || error.id().starts_with("upload-") ||
           error.id().starts_with("exam-");
}
core::Error withoutPlace(const core::Error& error) {
    return core::Error(error.problem(), "", error.remedy()).as(error.id(), error.arguments());
}

/// Piece by piece, as the other side takes it.
void sendFile(Response& response, Page& page) {
    const std::uint64_t bytes = core::sizeOf(page.stream);
    const std::shared_ptr<std::FILE> file(page.stream.release(), core::CloseFile());
    response.set_content_provider(
        bytes, page.type.c_str(), [file](std::size_t from, std::size_t most, httplib::DataSink& to) {
            std::array<char, 1 << 16> piece;
            if (std::fseek(file.get(), static_cast<long>(from), SEEK_SET) != 0) return false;
            const std::size_t got = std::fread(piece.data(), 1, std::min(most, piece.size()), file.get());
            return got > 0 && to.write(piece.data(), got);
        });
}

}  // namespace

void answer(Response& response, const std::string& json, int status) {
    response.status = status;
    response.set_header(kPolicy, "default-src 'none'; frame-ancestors 'none'");
    response.set_content(json, kJson);
}
void answer(Response& response, const core::Error& error) {
    // Where it went wrong here is not a station's to know, unless it is in what it sent.
    const int status = statusOf(error);
    if (status < 500)
        return answer(response, school_wire::toJson(isOfMessage(error) ? error : withoutPlace(error)), status);
    std::fprintf(stderr, "handpiece-school: %s\n", error.what());
    if (status == 507)
        return answer(response,
                      school_wire::toJson(
                          core::Error("the server's disk is full", "", "make room there; nothing is lost until then")
                              .as(error.id(), {std::strerror(ENOSPC)})),
                      status);
    if (status == 503) {
        response.set_header("Retry-After", "5");
        return answer(response,
                      school_wire::toJson(core::Error("the server's database does not answer, or has too much to do",
                                                      "", "try again in a few seconds")
                                              .as(error.id())),
                      status);
    }
    answer(
        response,
        school_wire::toJson(core::Error("something went wrong there", "", "tell who looks after it; it is in its log")
                                .as("server-failed")),
        status);
}

void answer(Response& response, Page&& page, bool secure) {
    response.set_header(kPolicy, fmt::format("default-src 'none'; style-src 'unsafe-inline'; img-src {}; form-action "
                                             "'self'; base-uri 'none'; frame-ancestors 'none'",
                                             page.runsScript ? "'self' data: blob:; script-src 'self'; connect-src "
                                                               "'self'"
                                             : page.isReview ? "data:; script-src " + report::viewerInPolicy()
                                                             : std::string("'self' data:")));
    if (!page.fileName.empty())
        response.set_header("Content-Disposition", fmt::format("attachment; filename=\"{}\"", page.fileName));
    if (page.login)
        response.set_header("Set-Cookie",
                            fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict{}; Max-Age={}", kCookie, *page.login,
                                        secure ? "; Secure" : "", page.login->empty() ? 0 : kLoginMs / 1000));
    response.status = page.status;
    if (page.stream) return sendFile(response, page);
    if (page.to.empty()) return response.set_content(page.body, page.type);
    response.status = 303;
    response.set_header("Location", page.to);
    response.set_content("", "text/plain");
}

std::string tokenOf(const Request& request) {
    return secretInCookie(request, kCookie);
}

std::string secretInCookie(const Request& request, const std::string& cookie) {
    const std::string cookies = request.get_header_value("Cookie"), name = cookie + "=";
    for (std::size_t at = 0; at < cookies.size();) {
        const std::size_t end = std::min(cookies.find(';', at), cookies.size());
        std::string_view one = std::string_view(cookies).substr(at, end - at);
        while (one.starts_with(' '))
            one.remove_prefix(1);
        if (one.starts_with(name) && one.size() == name.size() + 64) return std::string(one.substr(name.size()));
        at = end + 1;
    }
    return {};
}

std::string sentBy(const Request& request, const char* name) {
    return request.is_multipart_form_data() ? request.get_file_value(name).content : request.get_param_value(name);
}

std::uint64_t numberOf(const Request& request, const char* name) {
    const std::string text = request.get_param_value(name);
    std::uint64_t value = 0;
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || ec != std::errc() || end != text.data() + text.size())
        throw core::Error(fmt::format("\"{}\" is no number", text), name, "send a whole number")
            .as("message-damaged", {name, "is no number"});
    return value;
}

}  // namespace handpiece::school_server
