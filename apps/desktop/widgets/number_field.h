// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The fields that numbers are typed into, all over the window.

#include <QDoubleSpinBox>
#include <QKeyEvent>
#include <QLineEdit>
#include <QSpinBox>
#include <QWheelEvent>
#include <optional>
#include <type_traits>
#include <utility>

namespace handpiece::desktop {

/// What was typed, with figures and signs as the locale has them: a Japanese keyboard may write them at full width, and
/// of two who write 1.7 one writes 1,7. Every character stays one.
[[nodiscard]] QString plainFigures(QString text, bool commaIsPoint);

/// Ctrl and Alt with a letter, or a function key; not what edits the text of a field.
[[nodiscard]] bool isOfCommand(const QKeyEvent& key);

/// A field that takes a number when it is whole: at Enter, or when one leaves it. Until then nothing writes into it:
/// what is set meanwhile waits, and gives way to what was typed.
template <class Spin>
class NumberField : public Spin {
  public:
    using Value = decltype(std::declval<const Spin&>().value());

    explicit NumberField(QWidget* parent = nullptr) : Spin(parent) {
        this->setKeyboardTracking(false);
        // The wheel that scrolls a panel changes no number on its way: only where one has clicked.
        this->setFocusPolicy(Qt::StrongFocus);
        QObject::connect(this->lineEdit(), &QLineEdit::textEdited, this, [this] { isTyped_ = true; });
        // First of all who hear of it: what they set in answer is shown.
        QObject::connect(this, &Spin::valueChanged, this, [this] { end(); });
        QObject::connect(this, &Spin::editingFinished, this, [this] {
            const bool isOther = waiting_ && *waiting_ != this->value();
            end();
            // What was typed is what stood there before; elsewhere it is another by now.
            if (isOther) emit this->valueChanged(this->value());
        });
    }

    /// Hides Spin's.
    void setValue(Value value) {
        if (isTyped_)
            waiting_ = value;
        else
            Spin::setValue(value);
    }
    /// Somebody types in it, and has not ended.
    [[nodiscard]] bool isTyped() const noexcept { return isTyped_; }

    void stepBy(int steps) override {
        end();
        Spin::stepBy(steps);
    }

    /// A command's key takes what stands there first: who saves with Ctrl+S has typed it.
    bool event(QEvent* event) override {
        if (event->type() == QEvent::ShortcutOverride && isTyped_ && isOfCommand(*static_cast<const QKeyEvent*>(event)))
            this->interpretText();
        return Spin::event(event);
    }

  protected:
    QValidator::State validate(QString& text, int& at) const override {
        text = plainFigures(std::move(text), kIsDecimal && !this->isGroupSeparatorShown());
        return Spin::validate(text, at);
    }
    void wheelEvent(QWheelEvent* event) override {
        if (this->hasFocus())
            Spin::wheelEvent(event);
        else
            event->ignore();
    }

  private:
    static constexpr bool kIsDecimal = std::is_same_v<Value, double>;

    void end() {
        isTyped_ = false;
        waiting_.reset();
    }

    bool isTyped_ = false;
    std::optional<Value> waiting_;
};

using WholeField = NumberField<QSpinBox>;
using DecimalField = NumberField<QDoubleSpinBox>;

}  // namespace handpiece::desktop
