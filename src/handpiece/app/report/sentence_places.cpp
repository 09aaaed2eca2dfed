// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/sentence_places.h"

namespace handpiece::report {

std::optional<std::vector<std::string>> placesIn(std::string_view sentence, std::string_view pattern) {
    constexpr std::string_view kPlace = "{}";
    std::vector<std::string> places;
    const std::string_view start = pattern.substr(0, pattern.find(kPlace));
    if (!sentence.starts_with(start)) return {};
    sentence.remove_prefix(start.size()), pattern.remove_prefix(start.size());
    while (!pattern.empty()) {
        pattern.remove_prefix(kPlace.size());
        const std::string_view next = pattern.substr(0, pattern.find(kPlace));
        pattern.remove_prefix(next.size());
        // The last piece ends the sentence.
        const std::size_t end = pattern.empty()
                                    ? (sentence.ends_with(next) ? sentence.size() - next.size() : sentence.npos)
                                    : sentence.find(next);
        if (end == sentence.npos) return {};
        places.emplace_back(sentence.substr(0, end));
        sentence.remove_prefix(end + next.size());
    }
    return sentence.empty() ? std::optional(places) : std::nullopt;
}

}  // namespace handpiece::report
