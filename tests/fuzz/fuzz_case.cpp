// SPDX-License-Identifier: Apache-2.0
// Any case.toml, and any attempt.toml, must give a value or one core::Error; what is read can be written and read
// again.
#include "fuzz_model.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/case/case_files.h"

namespace cases = handpiece::cases;

namespace {

constexpr std::string_view kMesh =
    "solid t\n"
    "facet normal 0 0 -1 outer loop vertex 0 0 0 vertex 0 1 0 vertex 1 0 0 endloop endfacet\n"
    "facet normal 0 -1 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 0 1 endloop endfacet\n"
    "facet normal -1 0 0 outer loop vertex 0 0 0 vertex 0 0 1 vertex 0 1 0 endloop endfacet\n"
    "facet normal 1 1 1 outer loop vertex 1 0 0 vertex 0 1 0 vertex 0 0 1 endloop endfacet\n"
    "endsolid t\n";

std::vector<std::byte> bytesOf(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

/// A throw from here is one the fuzzer must see.
void mustComeBack(const cases::Case& read) {
    try {
        const cases::PackageFiles files = cases::caseFiles(read);
        const cases::Case again = cases::readCaseFiles(cases::filesInPackage("again", files));
        if (cases::contentKey(again) != cases::contentKey(read) ||
            again.exercise.has_value() != read.exercise.has_value())
            __builtin_trap();
    } catch (const handpiece::core::Error&) {
        __builtin_trap();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    (void)handpiece::fuzz::readText(data, size, [](std::string_view text) {
        const cases::Attempt attempt = cases::parseAttempt(text, "fuzz");
        try {
            (void)cases::parseAttempt(cases::attemptToml(attempt), "again");
        } catch (const handpiece::core::Error&) {
            __builtin_trap();
        }
    });
    return handpiece::fuzz::readText(data, size, [](std::string_view text) {
        const cases::PackageFiles files{{"case.toml", bytesOf(text)},
                                        {"a.stl", bytesOf(kMesh)},
                                        {"t.toml", bytesOf("format = 1\n[enamel]\ncutting = 1e-5\n")}};
        mustComeBack(cases::readCaseFiles(cases::filesInPackage("fuzz", files)));
    });
}
