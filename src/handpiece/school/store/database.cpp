// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/database.h"

namespace handpiece::school {

std::int64_t Database::number(const char* query) {
    Statement statement(*this, query);
    return statement.next() ? statement.integer(0) : 0;
}

std::string Database::text(const char* query) {
    Statement statement(*this, query);
    return statement.next() ? statement.text(0) : std::string();
}

}  // namespace handpiece::school
