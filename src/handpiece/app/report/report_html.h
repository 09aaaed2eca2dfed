// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One self-contained HTML page: headings, text, tables, pictures. Nothing is loaded from elsewhere.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::report {

class HtmlReport {
  public:
    explicit HtmlReport(std::string title);
    void heading(std::string_view text);
    void subheading(std::string_view text);
    /// `text` is escaped, as all text here.
    void paragraph(std::string_view text, bool isNote = false);
    /// Cells that start with a digit, a sign or a dot stand right. Cells "yes" and "no" are coloured.
    void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows,
               std::string_view caption);
    /// `svg` as made by toSvg() or stroboscopeSvg(), without a style of its own.
    void figure(std::string_view svg, std::string_view caption);
    /// A PNG file, taken into the page.
    void picture(const std::filesystem::path& png, std::string_view caption);
    /// The page.
    [[nodiscard]] std::string text() const;

  private:
    std::string title_, body_;
};

}  // namespace handpiece::report
