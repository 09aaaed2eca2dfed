// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/database.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace handpiece::school {

std::int64_t Database::number(const char* query) {
    Statement statement(*this, query);
    return statement.next() ? statement.integer(0) : 0;
}

std::string Database::text(const char* query) {
    Statement statement(*this, query);
    return statement.next() ? statement.text(0) : std::string();
}

std::string joinedLines(const std::vector<std::string>& all) {
    return fmt::format("{}", fmt::join(all, "\n"));
}
std::vector<std::string> partedLines(const std::string& text) {
    std::vector<std::string> all;
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t end = std::min(text.find('\n', from), text.size());
        all.push_back(text.substr(from, end - from));
        from = end + 1;
    }
    return all;
}

}  // namespace handpiece::school
