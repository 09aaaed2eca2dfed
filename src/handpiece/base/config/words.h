// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What programs and reports say, by name, in the languages of data/words.

#include <fmt/format.h>

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace handpiece::config {

/// A text by its name, with what varies in it: said later, in any language. Without a name it is its first argument as
/// it stands.
struct Phrase {
    std::string id;
    std::vector<std::string> arguments;

    [[nodiscard]] bool empty() const noexcept { return id.empty() && arguments.empty(); }
};
template <class... Arguments>
[[nodiscard]] Phrase phrase(std::string id, Arguments&&... arguments) {
    return {std::move(id), {std::string(std::forward<Arguments>(arguments))...}};
}
[[nodiscard]] inline Phrase verbatim(std::string text) {
    return {{}, {std::move(text)}};
}

/// One language. Immutable; any thread.
class Words {
  public:
    /// Throws core::Error naming the languages there are.
    [[nodiscard]] static const Words& in(std::string_view language);
    /// "en" and those it was put into.
    [[nodiscard]] static std::vector<std::string> languages();

    [[nodiscard]] const std::string& language() const noexcept { return language_; }
    [[nodiscard]] bool has(std::string_view id) const { return texts_.find(id) != texts_.end(); }
    /// Throws core::Error for an id that is in no language's file.
    [[nodiscard]] const std::string& text(std::string_view id) const;
    /// The text with fmt's {} filled in.
    template <class... Arguments>
    [[nodiscard]] std::string operator()(std::string_view id, const Arguments&... arguments) const {
        return fmt::vformat(text(id), fmt::make_format_args(arguments...));
    }
    [[nodiscard]] std::string operator()(const Phrase& phrase) const;
    [[nodiscard]] const std::map<std::string, std::string, std::less<>>& texts() const noexcept { return texts_; }

  private:
    Words(std::string_view language, const char* toml);
    std::string language_;
    std::map<std::string, std::string, std::less<>> texts_;
};

/// The language of this program: English until useLanguage(), which belongs to its start.
[[nodiscard]] const Words& words();
void useLanguage(std::string_view language);
/// Another language in this thread, as long as it lives: a server answers each in theirs.
class LanguageHere {
  public:
    /// As Words::in().
    explicit LanguageHere(std::string_view language);
    ~LanguageHere();
    LanguageHere(const LanguageHere&) = delete;
    LanguageHere& operator=(const LanguageHere&) = delete;

  private:
    const Words* before_;
};
/// The first of ours that a browser asks for (HTTP's Accept-Language, by its weights); empty: none of them.
[[nodiscard]] std::string languageAsked(std::string_view acceptLanguage);
/// The language that the person's environment asks for (LC_ALL, LC_MESSAGES, LANG), English where it has none of ours.
[[nodiscard]] std::string languageOfEnvironment();

}  // namespace handpiece::config
