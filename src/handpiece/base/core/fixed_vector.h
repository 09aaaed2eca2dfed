// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A vector of fixed capacity for the tick: never allocates; what does not fit is counted.

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

namespace handpiece::core {

/// Up to `Capacity` values in place. pushBack beyond that drops the value and counts it in dropped().
template <class T, std::size_t Capacity>
class FixedVector {
  public:
    bool pushBack(const T& value) noexcept {
        if (size_ == Capacity) {
            ++dropped_;
            return false;
        }
        items_[size_++] = value;
        return true;
    }
    void clear() noexcept {
        size_ = 0;
        dropped_ = 0;
    }
    void resize(std::size_t n) noexcept {
        assert(n <= Capacity);
        size_ = n;
    }
    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
    [[nodiscard]] std::uint32_t dropped() const noexcept { return dropped_; }
    [[nodiscard]] static constexpr std::size_t capacity() noexcept { return Capacity; }
    T& operator[](std::size_t i) noexcept { return items_[i]; }
    const T& operator[](std::size_t i) const noexcept { return items_[i]; }
    T* begin() noexcept { return items_.data(); }
    T* end() noexcept { return items_.data() + size_; }
    const T* begin() const noexcept { return items_.data(); }
    const T* end() const noexcept { return items_.data() + size_; }

  private:
    std::array<T, Capacity> items_{};
    std::size_t size_ = 0;
    std::uint32_t dropped_ = 0;
};

}  // namespace handpiece::core
