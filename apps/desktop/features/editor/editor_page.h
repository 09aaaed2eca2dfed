// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the pages of the exercise editor are: they show a draft and ask for changes of it.

#include <QWidget>
#include <functional>

#include "handpiece/assess/draft/draft.h"

namespace handpiece::desktop {

class EditorPage : public QWidget {
    Q_OBJECT
  public:
    /// Makes the change in the draft, as a step of its own unless the last one had the same name.
    using Change = std::function<void(const char* step, const std::function<void(draft::Content&)>& how)>;
    explicit EditorPage(Change change) : change_(std::move(change)) {}
    /// Never asks for a change.
    virtual void show(const draft::Content& content) = 0;

  protected:
    Change change_;
    bool showing_ = false;  ///< what fields tell meanwhile is not a person's doing
};

}  // namespace handpiece::desktop
