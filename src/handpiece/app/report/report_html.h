// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One self-contained HTML page, to read and to print: headings, text, tables, pictures. Nothing is loaded from
/// elsewhere, and no browser lets it: its content security policy names what may run. Every page of the program is made
/// with it, in the program's language.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "handpiece/app/report/html_form.h"
#include "handpiece/app/report/review.h"
#include "handpiece/senses/view/image.h"

namespace handpiece::report {

class HtmlReport {
  public:
    enum class Tone { plain, note, good, bad, missing };
    /// What stands side by side, or in a frame. `beside` (of a server's page): a picture that stays in sight, and the
    /// `part` that is read or filled in beside it; one under the other where there is no room.
    enum class Group { columns, pictures, slices, frame, thirds, beside, part };
    struct Chip {
        std::array<std::uint8_t, 3> colour;
        std::string name;
    };

    /// A cell that may lead somewhere.
    struct Cell {
        std::string text, address{};
    };
    /// A way to elsewhere in the same site.
    struct Way {
        std::string address, text;
        bool isHere = false;
    };

    /// All text is escaped.
    explicit HtmlReport(std::string title);
    void heading(std::string_view text);
    void subheading(std::string_view text);
    void paragraph(std::string_view text, Tone tone = Tone::plain);
    void list(const std::vector<std::string>& items);
    void legend(const std::vector<Chip>& chips);
    void link(std::string_view address, std::string_view text);
    void code(std::string_view text);
    /// Cells that start with a digit, a sign or a dot stand right, and so do the heads of columns that have no others.
    /// Cells "yes" and "no" are coloured.
    void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows,
               std::string_view caption = {});
    /// As table().
    void linkedTable(const std::vector<std::string>& header, const std::vector<std::vector<Cell>>& rows,
                     std::string_view caption = {});
    void form(const Form& form);
    /// How far something is: `done` of `all`, in words as well.
    void progress(double done, double all, std::string_view words);
    /// What progress() shows moves on by itself, where a script runs (apps/web/live), as the page at `address` has it,
    /// until that one says no more that it does.
    void keepUp(std::string_view address);
    /// What, and how much.
    void facts(std::string_view caption, const std::vector<std::pair<std::string, std::string>>& rows);
    /// `svg` as made by toSvg() or stroboscopeSvg(), without a style of its own.
    void figure(std::string_view svg, std::string_view caption);
    /// A PNG file, taken into the page.
    void picture(const std::filesystem::path& png, std::string_view caption);
    void picture(const view::Image& image, std::string_view caption);
    /// The bytes of a PNG file.
    void picture(std::span<const std::byte> png, std::string_view caption);
    /// Where review() puts it; what is in the page by then is counted by roomForReview(). Without a call, at the end.
    void reviewHere() { reviewAt_ = body_.size(); }
    /// Bytes that a review may have, so that the page stays under kMostPageBytes.
    [[nodiscard]] std::size_t roomForReview() const;
    /// The viewer (apps/web/viewer) and what it shows. Once a page.
    void review(const Review& review);
    void begin(Group group);
    void end();
    /// Makes it a page of a server: wide, with ways to the others and who is logged in over it; its policy comes with
    /// it over HTTP. `logOut`: a form of one button; none: nobody is logged in.
    void ofSite(const std::vector<Way>& ways, std::string_view who, const std::optional<Form>& logOut);
    /// A module of the server, and what it needs to know, as JSON without '<'. Once a page.
    void script(std::string_view address, std::string_view json);
    /// A place of its own for a module to draw in, with what stands there without script.
    void place(std::string_view id, std::string_view without);
    /// What a module of the server keeps up in its page; where none runs the page is loaded again and again.
    /// `html` is escaped where it has to be.
    void live(std::string_view html);
    /// The page.
    [[nodiscard]] std::string text() const;

  private:
    std::string title_, body_, site_, script_;
    std::optional<std::size_t> reviewAt_;
    bool hasViewer_ = false, isLive_ = false;
    int forms_ = 0;
};

/// The script of review() as a content security policy names it: 'sha256-...'.
[[nodiscard]] std::string viewerInPolicy();

}  // namespace handpiece::report
