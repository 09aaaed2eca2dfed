// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/html_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "handpiece/app/report/plot.h"

namespace handpiece::report {
namespace {

std::string attribute(std::string_view name, std::string_view value) {
    return value.empty() ? std::string() : fmt::format(" {}=\"{}\"", name, escaped(value));
}

std::string input(const FormField& f, const std::string& id, const std::string& more) {
    if (f.kind == "textarea")
        return fmt::format("<textarea id=\"{}\" name=\"{}\" rows=\"6\"{}>\n{}</textarea>", id, escaped(f.name), more,
                           escaped(f.value));
    if (f.kind == "select") {
        std::string all = fmt::format("<select id=\"{}\" name=\"{}\"{}>", id, escaped(f.name), more);
        for (const FormField::Choice& c : f.choices)
            all += fmt::format("<option value=\"{}\"{}>{}</option>", escaped(c.value),
                               c.value == f.value ? " selected" : "", escaped(c.text));
        return all + "</select>";
    }
    const std::string value = f.kind == "file"       ? std::string()
                              : f.kind == "checkbox" ? fmt::format(" value=\"on\"{}", f.value.empty() ? "" : " checked")
                                                     : fmt::format(" value=\"{}\"", escaped(f.value));
    return fmt::format("<input id=\"{}\" name=\"{}\" type=\"{}\"{}{}{}{}{} autocomplete=\"{}\">", id, escaped(f.name),
                       escaped(f.kind), value, attribute("min", f.least), attribute("max", f.most),
                       attribute("step", f.step), more, escaped(f.complete));
}

std::string said(const FormField& f, const std::string& id) {
    std::string all;
    if (!f.hint.empty()) all += fmt::format(" <span class=\"note\" id=\"{}-hint\">{}</span>", id, escaped(f.hint));
    if (!f.wrong.empty()) all += fmt::format(" <span class=\"bad\" id=\"{}-wrong\">{}</span>", id, escaped(f.wrong));
    return all;
}

}  // namespace

std::string toHtml(const Form& form, int number) {
    const bool sendsFile =
        std::any_of(form.fields.begin(), form.fields.end(), [](const FormField& f) { return f.kind == "file"; });
    std::string all = fmt::format("<form method=\"{}\" action=\"{}\"{}>\n", form.isGet ? "get" : "post",
                                  escaped(form.address), sendsFile ? " enctype=\"multipart/form-data\"" : "");
    for (const FormField& f : form.fields) {
        const std::string id = fmt::format("f{}-{}", number, escaped(f.name));
        std::string described;
        if (!f.hint.empty()) described = id + "-hint";
        if (!f.wrong.empty()) described += (described.empty() ? "" : " ") + id + "-wrong";
        const std::string more = std::string(f.isRequired ? " required" : "") +
                                 (f.wrong.empty() ? "" : " aria-invalid=\"true\"") +
                                 attribute("aria-describedby", described);
        if (f.kind == "hidden") {
            all += fmt::format("<input type=\"hidden\" name=\"{}\" value=\"{}\">\n", escaped(f.name), escaped(f.value));
        } else if (f.kind == "group") {
            all += fmt::format("<fieldset><legend>{}</legend>\n", escaped(f.label));
        } else if (f.kind == "end") {
            all += "</fieldset>\n";
        } else if (f.kind == "radio") {
            all += fmt::format("<fieldset class=\"choice\"><legend>{}{}</legend>\n", escaped(f.label), said(f, id));
            for (std::size_t i = 0; i < f.choices.size(); ++i)
                all += fmt::format(
                    "<label for=\"{0}-{1}\"><input id=\"{0}-{1}\" name=\"{2}\" type=\"radio\" value=\"{3}\"{4}{5}> "
                    "{6}</label>\n",
                    id, i, escaped(f.name), escaped(f.choices[i].value),
                    f.choices[i].value == f.value ? " checked" : "", more, escaped(f.choices[i].text));
            all += "</fieldset>\n";
        } else {
            all += fmt::format("<p class=\"{}\"><label for=\"{}\">{}</label> {}{}</p>\n",
                               f.kind == "checkbox" ? "field tick" : "field", id, escaped(f.label), input(f, id, more),
                               said(f, id));
        }
    }
    all += "<p>";
    for (const FormButton& b : form.buttons)
        all += fmt::format("<button type=\"submit\"{}{}{}>{}</button> ", attribute("name", b.name),
                           b.name.empty() ? "" : fmt::format(" value=\"{}\"", escaped(b.value)),
                           b.isGrave ? " class=\"grave\"" : "", escaped(b.text));
    return all + "</p>\n</form>\n";
}

}  // namespace handpiece::report
