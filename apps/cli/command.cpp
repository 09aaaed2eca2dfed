// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace handpiece::cli {
namespace {

Check checkOf(const CLI::Validator& validator, std::string description) {
    return {[validator](std::string& value) { return validator(value); }, std::move(description)};
}

// CLI11's own words name the largest double there is.
Check saying(const CLI::Validator& validator, const char* what) {
    return {[validator, what](std::string& value) {
                return validator(value).empty() ? std::string() : value + " is not " + what;
            },
            {}};
}

// CLI11's names of types are those of this language.
std::string plainType(const std::string& name) {
    return name == "FLOAT" || name == "INT" || name == "UINT" ? "NUMBER" : name;
}

constexpr const char* kDoneBy = "By ";

}  // namespace

template <class T>
Check range(T low, T high) {
    return checkOf(CLI::Range(low, high), fmt::format("{}..{}", low, high));
}
template Check range(int, int);
template Check range(double, double);
template Check range(std::size_t, std::size_t);
Check nonNegative() {
    return saying(CLI::NonNegativeNumber, "0 or more");
}
Check positive() {
    return saying(CLI::PositiveNumber, "more than 0");
}
Check oneOf(const std::vector<std::string>& values) {
    return checkOf(CLI::IsMember(values), fmt::format("{}", fmt::join(values, "|")));
}

Option& Option::required() {
    option_->required();
    return *this;
}
Option& Option::check(const Check& check) {
    option_->check(CLI::Validator(check.test, check.description));
    return *this;
}
Option& Option::showDefault() {
    option_->capture_default_str();
    return *this;
}
Option& Option::group(const std::string& heading) {
    option_->group(heading);
    return *this;
}
Option& Option::takeAll() {
    option_->take_all();
    return *this;
}
Option& Option::expected(int values) {
    option_->expected(values);
    return *this;
}
Option& Option::delimiter(char between) {
    option_->delimiter(between);
    return *this;
}
Option& Option::typeName(const std::string& name) {
    option_->type_name(name);
    return *this;
}
Option& Option::excludes(const Option& other) {
    option_->excludes(other.option_);
    return *this;
}
Option& Option::excludes(const char* name) {
    option_->excludes(name);
    return *this;
}
Option& Option::needs(const Option& other) {
    option_->needs(other.option_);
    return *this;
}

Command Command::subcommand(const std::string& name, const std::string& what) {
    return Command(*app_->add_subcommand(name, what));
}
void Command::requireSubcommand() {
    app_->require_subcommand(1);
}
void Command::footer(const std::string& text) {
    app_->footer(text);
}
void Command::callback(std::function<void()> work) {
    app_->callback(std::move(work));
}
template <class T>
Option Command::option(const std::string& name, T& value, const std::string& help) {
    CLI::Option* const option = app_->add_option(name, value, help);
    // CLI11 takes the next word, whatever it is: `--out --json` made a folder of that name.
    option->check(CLI::Validator(
        [](const std::string& given) {
            return given.rfind("--", 0) == 0 ? fmt::format("its value is missing before {}", given) : std::string();
        },
        ""));
    // CLI11 reads -1 as the largest number there is, and what is larger too.
    constexpr bool isUnsigned = std::is_same_v<T, std::size_t> || std::is_same_v<T, std::vector<std::size_t>>;
    if (isUnsigned)
        option->check(CLI::Validator(
            [](const std::string& given) {
                if (given.starts_with('-')) return fmt::format("{} is not 0 or more", given);
                std::size_t number = 0;
                const auto [end, error] = std::from_chars(given.data(), given.data() + given.size(), number);
                return error == std::errc::result_out_of_range ? fmt::format("{} is too large", given) : std::string();
            },
            ""));
    return Option(*option);
}
Option Command::flag(const std::string& name, bool& value, const std::string& help) {
    return Option(*app_->add_flag(name, value, help));
}
template Option Command::option(const std::string&, std::string&, const std::string&);
template Option Command::option(const std::string&, double&, const std::string&);
template Option Command::option(const std::string&, int&, const std::string&);
template Option Command::option(const std::string&, std::size_t&, const std::string&);
template Option Command::option(const std::string&, std::vector<std::string>&, const std::string&);
template Option Command::option(const std::string&, std::vector<double>&, const std::string&);
template Option Command::option(const std::string&, std::vector<std::size_t>&, const std::string&);

bool Command::isGiven(const std::string& name) const {
    const CLI::Option* option = app_->get_option_no_throw(name);
    return option != nullptr && option->count() > 0;
}
void Command::doneBy(const std::string& program) {
    app_->group(kDoneBy + program);
}
void Command::hide() {
    app_->group("");
}
std::string Command::name() const {
    return app_->get_name();
}
std::string Command::what() const {
    return app_->get_description();
}
std::string Command::footer() const {
    return app_->get_footer();
}
std::string Command::doneBy() const {
    return app_->get_group().starts_with(kDoneBy) ? app_->get_group().substr(std::strlen(kDoneBy)) : "";
}
std::vector<Command> Command::subcommands() const {
    std::vector<Command> all;
    for (CLI::App* sub : app_->get_subcommands([](CLI::App* a) { return !a->get_group().empty(); }))
        all.emplace_back(*sub);
    return all;
}
std::vector<OptionText> Command::options() const {
    std::vector<OptionText> all;
    for (const CLI::Option* option : app_->get_options())
        all.push_back(textOf(*option));
    return all;
}

OptionText textOf(const CLI::Option& option) {
    OptionText text;
    text.help = option.get_description(), text.group = option.get_group();
    text.required = option.get_required(), text.isArgument = option.get_positional();
    for (const std::string& name : option.get_snames())
        text.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames())
        text.names.push_back("--" + name);
    if (text.isArgument) text.names = {option.get_name(true, false)};
    if (option.get_type_size() == 0) return text;
    // The type, and behind a colon what its checks say it is.
    const std::string type = option.get_type_name();
    const std::size_t colon = type.find(':');
    text.value = plainType(colon == std::string::npos ? type : type.substr(colon + 1));
    text.standard = option.get_default_str();
    if (text.standard.starts_with('[') && text.standard.ends_with(']'))
        text.standard = text.standard.substr(1, text.standard.size() - 2);
    if (option.get_expected_max() == CLI::detail::expected_max_vector_size)
        text.value += " ...";
    else
        for (int i = 1; i < option.get_expected_min(); ++i)
            text.value += " " + plainType(type);
    return text;
}

}  // namespace handpiece::cli
