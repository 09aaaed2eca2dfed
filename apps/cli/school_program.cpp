// SPDX-License-Identifier: Apache-2.0
// handpiece serve, handpiece school: another program, which alone speaks HTTP.
#include "cli/school_program.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "cli/commands.h"

namespace handpiece::cli {

bool isForSchool(int argc, const char* const* argv) {
    return argc > 1 && (std::strcmp(argv[1], "serve") == 0 || std::strcmp(argv[1], "school") == 0);
}

int runSchoolProgram(int argc, const char* const* argv) {
    constexpr const char* kName = "handpiece-school";
    std::error_code ec;
    // The one that came with this program; else the one that is found.
    const std::filesystem::path beside = std::filesystem::read_symlink("/proc/self/exe", ec).parent_path() / kName;
    const std::string program = !ec && std::filesystem::exists(beside, ec) ? beside.string() : kName;
    std::vector<char*> arguments{const_cast<char*>(kName)};
    for (int i = std::strcmp(argv[1], "school") == 0 ? 2 : 1; i < argc; ++i)
        arguments.push_back(const_cast<char*>(argv[i]));
    arguments.push_back(nullptr);
    (void)execvp(program.c_str(), arguments.data());
    std::fprintf(stderr, "handpiece: %s: %s (install handpiece-school, the school's part)\n", kName,
                 std::strerror(errno));
    return 1;
}

void addSchoolCommands(Command& app) {
    app.subcommand("serve", "The school's server: takes what stations push, and scores it").doneBy("handpiece-school");
    app.subcommand("school", "A station's way to its school, and the server's books: handpiece school --help")
        .doneBy("handpiece-school");
}

}  // namespace handpiece::cli
