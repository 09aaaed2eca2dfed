// SPDX-License-Identifier: Apache-2.0
#include "cli/completion.h"
#include "cli/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace handpiece::cli {
namespace {

struct Word {
    std::string text, what;
    bool takesValue = false;
};

/// One command with its words: what may follow it.
struct Level {
    std::string path;  ///< "make tooth"; empty for the program itself
    std::vector<Word> commands, options;
};

void collect(const Command& command, const std::string& path, std::vector<Level>& levels) {
    Level level{path, {}, {}};
    const std::vector<Command> subcommands = command.subcommands();
    for (const Command& sub : subcommands)
        level.commands.push_back({sub.name(), sub.what()});
    for (const OptionText& option : command.options())
        for (const std::string& name : option.names)
            if (name.starts_with("--")) level.options.push_back({name, option.help, !option.value.empty()});
    levels.push_back(std::move(level));
    for (const Command& sub : subcommands)
        collect(sub, path.empty() ? sub.name() : path + " " + sub.name(), levels);
}

/// In single quotes, as all three shells read them; `quote` is how one of them stands within.
std::string quoted(const std::string& text, const char* quote) {
    std::string out = "'";
    for (const char c : text)
        c == '\'' ? out += quote : out += c;
    return out + "'";
}

std::string functionOf(const std::string& program) {
    std::string name = "_" + program;
    std::ranges::replace(name, '-', '_');
    return name;
}

/// "|make|make tooth|...|": the words of a command line that are commands are looked for in it.
std::string allPaths(const std::vector<Level>& levels) {
    std::string paths = "|";
    for (const Level& level : levels)
        if (!level.path.empty()) paths += level.path + "|";
    return paths;
}

/// In bash and zsh: which command stands in `words`, and a branch for each.
std::string branches(const std::string& words, const std::vector<Level>& levels) {
    return fmt::format(
        "    for word in \"{}\"; do\n"
        "        case '{}' in *\"|${{at:+$at }}$word|\"*) at=\"${{at:+$at }}$word\" ;; esac\n    done\n"
        "    case \"$at\" in\n",
        words, allPaths(levels));
}

std::string bash(const std::string& program, const std::vector<Level>& levels) {
    const std::string function = functionOf(program);
    std::string text =
        function + "() {\n    local at=\"\" word words=\"\"\n" + branches("${COMP_WORDS[@]:1:COMP_CWORD-1}", levels);
    for (const Level& level : levels) {
        text += fmt::format("        '{}') words='", level.path);
        for (const auto* const list : {&level.commands, &level.options})
            for (const Word& word : *list)
                text += word.text + " ";
        text.back() = '\'';
        text += " ;;\n";
    }
    return text +
           fmt::format(
               "    esac\n    COMPREPLY=($(compgen -W \"$words\" -- \"${{COMP_WORDS[COMP_CWORD]}}\"))\n"
               "    [ ${{#COMPREPLY[@]}} -gt 0 ] || COMPREPLY=($(compgen -f -- \"${{COMP_WORDS[COMP_CWORD]}}\"))\n}}\n"
               "complete -o filenames -F {} {}\n",
               function, program);
}

std::string zsh(const std::string& program, const std::vector<Level>& levels) {
    std::string function = "_" + program, text = fmt::format("#compdef {}\n\n{}() {{\n", program, function);
    text += "    local at='' word\n    local -a commands options\n" + branches("${(@)words[2,CURRENT-1]}", levels);
    for (const Level& level : levels) {
        text += fmt::format("        '{}')\n", level.path);
        for (const auto& [name, list] :
             {std::pair("commands", &level.commands), std::pair("options", &level.options)}) {
            text += fmt::format("            {}=(", name);
            for (const Word& word : *list)
                text += quoted(word.text + ":" + word.what, "'\\''") + " ";
            text += ")\n";
        }
        text += "            ;;\n";
    }
    return text + fmt::format(
                      "    esac\n    _describe -t commands command commands\n"
                      "    [[ $PREFIX == -* ]] && _describe -t options option options\n"
                      "    (( $#commands )) || [[ $PREFIX == -* ]] || _files\n}}\n\n"
                      // Loaded by the shell as a function, or read by a person's own start file.
                      "if [ \"$funcstack[1]\" = \"{0}\" ]; then {0} \"$@\"; else compdef {0} {1}; fi\n",
                      function, program);
}

std::string fish(const std::string& program, const std::vector<Level>& levels) {
    const std::string function = "_" + functionOf(program);
    std::string text = fmt::format(
        "function {}_at --argument-names wanted\n    set -l at ''\n"
        "    for word in (commandline -opc)[2..-1]\n        set -l next (string trim -- \"$at $word\")\n"
        "        string match -q -- \"*|$next|*\" '{}'; and set at $next\n    end\n"
        "    test \"$at\" = \"$wanted\"\nend\n",
        function, allPaths(levels));
    for (const Level& level : levels) {
        const std::string head = fmt::format("complete -c {} -n '{}_at \"{}\"'", program, function, level.path);
        for (const Word& word : level.commands)
            text += fmt::format("{} -f -a {} -d {}\n", head, word.text, quoted(word.what, "\\'"));
        for (const Word& word : level.options)
            text += fmt::format("{}{} -l {} -d {}\n", head, word.takesValue ? " -r" : "", word.text.substr(2),
                                quoted(word.what, "\\'"));
    }
    return text;
}

}  // namespace

void addCompletionCommand(Command& app, const std::string& program) {
    Command command = app.subcommand("completion", "Print a completion script for bash, zsh or fish");
    const auto shell = std::make_shared<std::string>();
    command.option("shell", *shell, "bash, zsh or fish").required().check(oneOf({"bash", "zsh", "fish"}));
    command.footer("Example:\n  source <(" + program + " completion bash)");
    command.callback([app, shell, program] {
        std::vector<Level> levels;
        collect(app, "", levels);
        fmt::print("{}", (*shell == "fish" ? fish : *shell == "zsh" ? zsh : bash)(program, levels));
    });
}

}  // namespace handpiece::cli
