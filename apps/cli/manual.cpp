// SPDX-License-Identifier: Apache-2.0
#include "cli/manual.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "handpiece/base/core/file.h"

namespace handpiece::cli {
namespace {

/// As roff prints it: no hyphen for a dash, no request from a line's first character.
std::string roff(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '\\')
            out += "\\e";
        else if (c == '-')
            out += "\\-";
        else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n'))
            out += std::string("\\&") + c;
        else
            out += c;
        // Where a long list may be broken.
        if (c == '|' || c == ',') out += "\\:";
    }
    return out;
}

std::string sentence(std::string text) {
    if (!text.empty() && text.back() != '.') text += '.';
    return text;
}

/// "a hand works" for "A hand works", but "CT": what a page is listed by.
std::string asPhrase(std::string text) {
    if (text.size() > 1 && !std::isupper(static_cast<unsigned char>(text[1])))
        text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
    return text;
}

std::string pageOf(const std::string& path) {
    std::string page = path;
    std::ranges::replace(page, ' ', '-');
    return page;
}

std::string reference(const std::string& path) {
    return fmt::format("\\fB{}\\fR(1)", roff(pageOf(path)));
}

/// A name as it is typed and what it takes.
std::string tag(const OptionText& option) {
    std::string out;
    for (const std::string& name : option.names)
        out += (out.empty() ? "" : ", ") + fmt::format("\\f{}{}\\fR", option.isArgument ? 'I' : 'B', roff(name));
    // Of an argument its name says it already.
    if (!option.value.empty() && !(option.isArgument && option.value.starts_with("TEXT")))
        out += " \\fI" + roff(option.value) + "\\fR";
    return out;
}

std::string entry(const OptionText& option) {
    std::string text = option.help;
    if (!option.standard.empty()) text += fmt::format(" (default: {})", option.standard);
    return fmt::format(".TP\n{}\n{}{}\n", tag(option), roff(sentence(text)),
                       option.required && !option.isArgument ? " Required." : "");
}

struct Footer {
    std::vector<std::string> remarks, examples;
};

/// What a command says below its options: remarks, and examples under their heading, set in by two.
Footer readFooter(const std::string& text) {
    Footer footer;
    bool examples = false;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        // They have a section of their own.
        if (line.empty() || line.starts_with("Exit codes:")) continue;
        if (line == "Example:" || line == "Examples:")
            examples = true;
        else if (examples && line.starts_with("  "))
            footer.examples.push_back(line.substr(2));
        else
            examples = false, footer.remarks.push_back(line);
    }
    return footer;
}

std::string synopsis(const std::string& path, const std::vector<OptionText>& options, bool hasSubcommands) {
    std::string text = fmt::format(".HP\n\\fB{}\\fR", roff(path));
    if (hasSubcommands) return text + " \\fICOMMAND\\fR [\\fIOPTION\\fR]...\n";
    for (const OptionText& option : options)
        if (option.required && !option.isArgument) {
            OptionText first = option;
            first.names = {
                *std::ranges::find_if(option.names, [](const std::string& n) { return n.starts_with("--"); })};
            text += " " + tag(first);
        }
    text += " [\\fIOPTION\\fR]...";
    for (const OptionText& option : options)
        if (option.isArgument) {
            const std::string name = roff(option.names.front()) + "\\fR" + (option.value.ends_with("...") ? "..." : "");
            text += option.required ? " \\fI" + name : " [\\fI" + name + "]";
        }
    return text + "\n";
}

std::string page(const Command& command, const std::string& path, const std::string& parent) {
    const std::vector<OptionText> options = command.options();
    const std::vector<Command> subcommands = command.subcommands();
    const Footer footer = readFooter(command.footer());
    std::string title = pageOf(path);
    std::ranges::transform(title, title.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    std::string text =
        fmt::format(".TH {} 1 \"\" \"Handpiece {}\" \"Handpiece's Manual\"\n", roff(title), HANDPIECE_VERSION);
    // A command's words cannot be broken in the middle by a hyphen, nor lines be stretched.
    text += ".nh\n.ad l\n";
    text += fmt::format(".SH NAME\n{} \\- {}\n", roff(pageOf(path)), roff(asPhrase(command.what())));
    text += ".SH SYNOPSIS\n" + synopsis(path, options, !subcommands.empty());
    text += ".SH DESCRIPTION\n" + roff(sentence(command.what())) + "\n";
    bool wasListed = false;
    for (const std::string& remark : footer.remarks) {
        const bool isListed = remark.starts_with("  ");
        text += isListed && wasListed ? ".br\n" : ".PP\n";
        text += roff(isListed ? remark.substr(2) : remark) + "\n";
        wasListed = isListed;
    }
    if (!subcommands.empty()) {
        text += ".SH COMMANDS\n";
        for (const Command& sub : subcommands) {
            const std::string program = sub.doneBy();
            const std::string by = program.empty() ? reference(path + " " + sub.name()) : reference(program);
            text += fmt::format(".TP\n\\fB{}\\fR\n{} See {}.\n", roff(sub.name()), roff(sentence(sub.what())), by);
        }
    }
    if (std::ranges::any_of(options, &OptionText::isArgument)) {
        text += ".SH ARGUMENTS\n";
        for (const OptionText& option : options)
            if (option.isArgument) text += entry(option);
    }
    std::vector<std::string> groups;
    for (const OptionText& option : options)
        if (!option.isArgument && !option.group.empty() && std::ranges::find(groups, option.group) == groups.end())
            groups.push_back(option.group);
    text += ".SH OPTIONS\n";
    for (const std::string& group : groups) {
        if (group != "Options") text += ".SS " + roff(group) + "\n";
        for (const OptionText& option : options)
            if (!option.isArgument && option.group == group) text += entry(option);
    }
    if (!footer.examples.empty()) {
        text += ".SH EXAMPLES\n";
        // A long line is continued below itself.
        for (const std::string& example : footer.examples)
            text += fmt::format(".HP\n\\fB{}\\fR\n", roff(example));
    }
    text += ".SH EXIT STATUS\n0 done, 1 failed (bad input, no permission), 2 wrong usage.\n";
    std::vector<std::string> also;
    if (!parent.empty()) also.push_back(reference(parent));
    for (const Command& sub : subcommands)
        if (sub.doneBy().empty()) also.push_back(reference(path + " " + sub.name()));
    if (!also.empty()) text += fmt::format(".SH SEE ALSO\n{}\n", fmt::join(also, ",\n"));
    return text;
}

void write(const Command& command, const std::string& path, const std::string& parent,
           const std::filesystem::path& folder) {
    core::writeFile((folder / (pageOf(path) + ".1")).string(), page(command, path, parent));
    for (const Command& sub : command.subcommands())
        if (sub.doneBy().empty()) write(sub, path + " " + sub.name(), path, folder);
}

}  // namespace

void addManualCommand(Command& app, const std::string& program) {
    Command command = app.subcommand("manual", "Write the manual's pages into a folder");
    command.hide();
    const auto folder = std::make_shared<std::string>();
    command.option("folder", *folder, "folder to write").required();
    command.callback([app, program, folder] {
        std::filesystem::create_directories(*folder);
        write(app, program, "", *folder);
    });
}

}  // namespace handpiece::cli
