// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A part of the books with a class of its own, on the same database and in the same transactions.

#include "handpiece/school/store/books.h"

namespace handpiece::school {

/// To be derived from; its sources include books_state.h. Lives no longer than the books.
class BooksRoom {
  protected:
    using State = Books::State;
    explicit BooksRoom(Books& books) : state_(*books.state_) {}
    State& state_;
};

}  // namespace handpiece::school
