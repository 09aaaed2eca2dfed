// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Forms of a page, as data: every field with its label, what it wants, and what was wrong with what was typed.

#include <string>
#include <vector>

namespace handpiece::report {

struct FormField {
    struct Choice {
        std::string value, text;
    };
    std::string name{}, label{};
    /// As HTML has it: "text", "password", "hidden", "number", "date", "datetime-local", "checkbox", "file";
    /// "textarea", "select", "radio" (one of `choices`); "group": what follows belongs together under `label`, until
    /// "end".
    std::string kind = "text";
    std::string value{};  ///< what stands there; a checkbox is set unless it is empty
    std::string hint{};   ///< what is wanted: unit, range, an example
    std::string wrong{};  ///< what is wrong with `value`, and what to do
    std::vector<Choice> choices{};
    bool isRequired = false;
    std::string least{}, most{}, step{};  ///< of numbers and times; empty: any
    std::string complete = "off";         ///< HTML's autocomplete
};
struct FormButton {
    std::string text, name{}, value{};  ///< sent where `name` is not empty
    bool isGrave = false;               ///< what it does cannot be taken back
};
struct Form {
    std::string address;
    std::vector<FormField> fields;
    std::vector<FormButton> buttons;
    bool isGet = false;  ///< asks, and changes nothing
};

/// `number`: of this form in its page, so that no two fields have one id.
[[nodiscard]] std::string toHtml(const Form& form, int number);

}  // namespace handpiece::report
