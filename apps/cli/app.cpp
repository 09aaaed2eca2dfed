// SPDX-License-Identifier: Apache-2.0
#include "cli/app.h"
#include "cli/completion.h"
#include "cli/manual.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <set>
#include <utility>

#include "handpiece/base/config/words.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/utf8.h"
#include "handpiece/base/geometry/read_notes.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

/// Begun without one of the three (>&-), a program gives its number to the first file that it opens, and prints into
/// that.
void holdStandardStreams() {
    for (int number = 0; number <= 2; ++number)
        if (fcntl(number, F_GETFD) == -1 && errno == EBADF) (void)open("/dev/null", O_RDWR);
}

/// What was printed is a result as well.
void finishPrinting() {
    errno = 0;
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
        throw core::Error(
            std::string("not all could be printed") + (errno != 0 ? ": " + std::string(std::strerror(errno)) : ""),
            "standard output", "give it a place with room");
}

/// What was left out of a file goes to stderr, once: a command may read a file twice.
void tellWhatIsLeftOut(const std::string& program) {
    geometry::listenToNotes([program, told = std::set<std::pair<std::string, std::string>>()](
                                const std::string& where, const std::string& note) mutable {
        if (told.emplace(where, note).second)
            std::fprintf(stderr, "%s: note: %s: %s\n", program.c_str(), core::printable(where).c_str(),
                         core::printable(note).c_str());
    });
}

/// Says what an option takes as one would say it.
class Formatter : public CLI::Formatter {
  public:
    std::string make_option_name(const CLI::Option* option, bool isPositional) const override {
        const OptionText text = textOf(*option);
        return isPositional ? text.names.front() : fmt::format("{}", fmt::join(text.names, ", "));
    }
    std::string make_option_opts(const CLI::Option* option) const override {
        const OptionText text = textOf(*option);
        std::string all = (text.isArgument && text.value == "TEXT") || text.value.empty() ? "" : " " + text.value;
        if (!text.standard.empty()) all += "=" + text.standard;
        return text.required && !text.isArgument ? all + " REQUIRED" : all;
    }
};

}  // namespace

int runApp(int argc, const char* const* argv, const App& of) {
    holdStandardStreams();
    CLI::App app{of.what, of.name};
    app.require_subcommand(1);
    app.set_version_flag("--version", of.name + " " HANDPIECE_VERSION);
    app.formatter(std::make_shared<Formatter>());
    app.get_formatter()->column_width(34);
    app.footer("Each command explains itself: " + of.name +
               " COMMAND --help\n"
               "Exit codes: 0 done, 1 failed (bad input, no permission), 2 wrong usage.");
    config::useLanguage(config::languageOfEnvironment());
    app.fallthrough();
    app.add_option_function<std::string>(
           "--language", [](const std::string& language) { config::useLanguage(language); },
           "of the reports: en or ja; else what LANG asks for")
        ->check(CLI::IsMember(config::Words::languages())
                    .description(fmt::format("{}", fmt::join(config::Words::languages(), "|"))));
    Command top(app);
    of.addCommands(top);
    addCompletionCommand(top, of.name);
    addManualCommand(top, of.name);
    studies::installCancel();
    tellWhatIsLeftOut(of.name);
    try {
        if (of.begin) of.begin();
        app.parse(argc, argv);
        finishPrinting();
        return 0;
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? 0 : 2;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s: %s\n", of.name.c_str(), core::asError(e).what());
        return 1;
    }
}

}  // namespace handpiece::cli
