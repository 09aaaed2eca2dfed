// SPDX-License-Identifier: Apache-2.0
#include "cli/completion.h"
#include "cli/command.h"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

namespace handpiece::cli {
namespace {

/// One command with its words: what may follow it.
struct Level {
    std::string path;  ///< "make tooth"; empty for the program itself
    std::vector<std::string> words;
};

void collect(const Command& command, const std::string& path, std::vector<Level>& levels) {
    Level level{path, {}};
    const std::vector<Command> subcommands = command.subcommands();
    for (const Command& sub : subcommands)
        level.words.push_back(sub.name());
    for (const std::string& name : command.optionNames())
        level.words.push_back("--" + name);
    levels.push_back(std::move(level));
    for (const Command& sub : subcommands)
        collect(sub, path.empty() ? sub.name() : path + " " + sub.name(), levels);
}

std::string bash(const std::vector<Level>& levels) {
    std::string text =
        "_handpiece() {\n    local path=\"\" word words=\"\"\n"
        "    for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
        "        case \"$word\" in -*) break ;; esac\n        path=\"${path:+$path }$word\"\n    done\n"
        "    case \"$path\" in\n";
    for (const Level& level : levels)
        text += fmt::format("        \"{}\") words=\"{}\" ;;\n", level.path, fmt::join(level.words, " "));
    return text +
           "    esac\n    COMPREPLY=($(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\"))\n"
           "    [ ${#COMPREPLY[@]} -gt 0 ] || COMPREPLY=($(compgen -f -- \"${COMP_WORDS[COMP_CWORD]}\"))\n}\n"
           "complete -F _handpiece handpiece\n";
}

std::string fish(const std::vector<Level>& levels) {
    std::string text;
    for (const Level& level : levels) {
        const std::string condition =
            level.path.empty() ? "__fish_use_subcommand"
                               : "__fish_seen_subcommand_from " + level.path.substr(level.path.rfind(' ') + 1);
        for (const std::string& word : level.words)
            text += word.rfind("--", 0) == 0
                        ? fmt::format("complete -c handpiece -n '{}' -l {}\n", condition, word.substr(2))
                        : fmt::format("complete -c handpiece -n '{}' -a {}\n", condition, word);
    }
    return text;
}

}  // namespace

void addCompletionCommand(Command& app) {
    Command command = app.subcommand("completion", "Print a completion script for bash, zsh or fish");
    const auto shell = std::make_shared<std::string>();
    command.option("shell", *shell, "bash, zsh or fish").required().check(oneOf({"bash", "zsh", "fish"}));
    command.footer("Example:\n  source <(handpiece completion bash)");
    command.callback([&app, shell] {
        std::vector<Level> levels;
        collect(app, "", levels);
        if (*shell == "fish") {
            fmt::print("{}", fish(levels));
        } else {
            fmt::print("{}{}", *shell == "zsh" ? "autoload -U +X bashcompinit && bashcompinit\n" : "", bash(levels));
        }
    });
}

}  // namespace handpiece::cli
