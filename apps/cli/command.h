// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A command of the command line and what it takes. CLI11 stands behind it, in one source: its headers would be most of
/// what each command costs to compile.

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace handpiece::cli {

/// What a value must be; where it is not, the command is used wrongly and says how.
struct Check {
    std::function<std::string(std::string&)> test;  ///< empty when the value will do, else why not
    std::string description;                        ///< behind the option in the help
};
/// T: int, double or std::size_t, as the value.
template <class T>
[[nodiscard]] Check range(T low, T high);
[[nodiscard]] Check nonNegative();
[[nodiscard]] Check positive();
[[nodiscard]] Check oneOf(const std::vector<std::string>& values);

/// An option as help and manual tell it.
struct OptionText {
    std::vector<std::string> names;  ///< with their dashes, as "--out"; of an argument its name
    std::string value;               ///< what it takes, as "NUMBER" or "mm|cm|m"; empty for a flag
    std::string standard;            ///< what the value is where none is given
    std::string help, group;
    bool required = false, isArgument = false;
};

/// A handle; the command line owns what it stands for.
class Option {
  public:
    explicit Option(CLI::Option& option) : option_(&option) {}
    Option& required();
    Option& check(const Check& check);
    /// What the value is now shows in the help.
    Option& showDefault();
    Option& group(const std::string& heading);
    /// May be given several times.
    Option& takeAll();
    Option& expected(int values);
    Option& delimiter(char between);
    Option& typeName(const std::string& name);
    Option& excludes(const Option& other);
    Option& excludes(const char* name);
    Option& needs(const Option& other);

  private:
    CLI::Option* option_;
};

/// What of `option` stands behind its name in the help.
[[nodiscard]] OptionText textOf(const CLI::Option& option);

/// A handle likewise.
class Command {
  public:
    explicit Command(CLI::App& app) : app_(&app) {}
    [[nodiscard]] Command subcommand(const std::string& name, const std::string& what);
    /// It does nothing by itself.
    void requireSubcommand();
    void footer(const std::string& text);
    /// Another program does the work: listed under a heading of its own, without a page.
    void doneBy(const std::string& program);
    /// Of no use to a person.
    void hide();
    void callback(std::function<void()> work);
    /// T: a text, a number, a list of these, or an optional one; see command.cpp. `value` must live as long.
    template <class T>
    Option option(const std::string& name, T& value, const std::string& help);
    Option flag(const std::string& name, bool& value, const std::string& help);
    /// False where there is no such option, too.
    [[nodiscard]] bool isGiven(const std::string& name) const;

    [[nodiscard]] std::string name() const;
    [[nodiscard]] std::string what() const;
    [[nodiscard]] std::string footer() const;
    [[nodiscard]] std::string doneBy() const;
    [[nodiscard]] std::vector<Command> subcommands() const;  ///< but those that are hidden
    [[nodiscard]] std::vector<OptionText> options() const;

  private:
    CLI::App* app_;
};

}  // namespace handpiece::cli
