// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/config/words.h"

#include <fmt/args.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cstdlib>

#include "handpiece/base/config/table.h"
#include "handpiece/base/core/error.h"

namespace handpiece::config {

// data/words
extern const char* const kEnglishWords;
extern const char* const kJapaneseWords;

namespace {

void gather(const Table& table, const std::string& prefix, std::map<std::string, std::string, std::less<>>& texts) {
    for (const std::string& key : table.keys()) {
        const std::string id = prefix + key;
        if (table.isTable(key))
            gather(*table.table(key), id + ".", texts);
        else
            texts.emplace(id, *table.text(key));
    }
}

std::atomic<const Words*> current{nullptr};
thread_local const Words* here = nullptr;

}  // namespace

Words::Words(std::string_view language, const char* toml) : language_(language) {
    gather(Table::parse(toml, "data/words/" + language_ + ".toml"), {}, texts_);
}

const Words& Words::in(std::string_view language) {
    static const std::array all{Words("en", kEnglishWords), Words("ja", kJapaneseWords)};
    for (const Words& words : all)
        if (words.language() == language) return words;
    throw core::Error(fmt::format("there are no words in \"{}\"", language), "--language",
                      fmt::format("choose one of {}", fmt::join(languages(), ", ")));
}

std::vector<std::string> Words::languages() {
    return {"en", "ja"};
}

const std::string& Words::text(std::string_view id) const {
    const auto found = texts_.find(id);
    if (found == texts_.end()) throw core::Error(fmt::format("there is no text \"{}\" in \"{}\"", id, language_));
    return found->second;
}

std::string Words::operator()(const Phrase& phrase) const {
    if (phrase.id.empty()) return phrase.arguments.empty() ? std::string() : phrase.arguments.front();
    fmt::dynamic_format_arg_store<fmt::format_context> arguments;
    for (const std::string& argument : phrase.arguments)
        arguments.push_back(argument);
    return fmt::vformat(text(phrase.id), arguments);
}

const Words& words() {
    if (here != nullptr) return *here;
    const Words* set = current.load(std::memory_order_acquire);
    return set != nullptr ? *set : Words::in("en");
}

void useLanguage(std::string_view language) {
    current.store(&Words::in(language), std::memory_order_release);
}

LanguageHere::LanguageHere(std::string_view language) : before_(here) {
    here = &Words::in(language);
}
LanguageHere::~LanguageHere() {
    here = before_;
}

std::string languageAsked(std::string_view accept) {
    const std::vector<std::string> ours = Words::languages();
    std::string best;
    double bestWeight = 0.0;
    while (!accept.empty()) {
        const std::size_t end = std::min(accept.find(','), accept.size());
        std::string_view one = accept.substr(0, end);
        accept.remove_prefix(std::min(end + 1, accept.size()));
        while (one.starts_with(' '))
            one.remove_prefix(1);
        double weight = 1.0;
        if (const std::size_t q = one.find(";q="); q != one.npos) {
            weight = 0.0;
            std::from_chars(one.data() + q + 3, one.data() + one.size(), weight);
        }
        const std::string language(one.substr(0, one.find_first_of("-; ")));
        if (weight > bestWeight && std::find(ours.begin(), ours.end(), language) != ours.end())
            best = language, bestWeight = weight;
    }
    return best;
}

std::string languageOfEnvironment() {
    for (const char* name : {"LC_ALL", "LC_MESSAGES", "LANG"}) {
        const char* value = std::getenv(name);
        if (value == nullptr || *value == '\0') continue;
        // The first that is set decides, as for every program: "ja_JP.UTF-8".
        for (const std::string& language : Words::languages())
            if (std::string_view(value).substr(0, 2) == language) return language;
        break;
    }
    return "en";
}

}  // namespace handpiece::config
