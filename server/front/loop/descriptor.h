#pragma once

#include <utility>

#include <unistd.h>

namespace uplink::front {

/// A descriptor that closes itself. Confined to its owner.
class Descriptor final {
 public:
  Descriptor() = default;
  /// Negative: none.
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() { Close(); }
  Descriptor(Descriptor&& other) noexcept : value_(other.Release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    if (this != &other) {
      Close();
      value_ = other.Release();
    }
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int get() const { return value_; }
  /// The caller must close it from now on.
  [[nodiscard]] int Release() { return std::exchange(value_, -1); }

 private:
  void Close() const {
    if (value_ >= 0) ::close(value_);
  }

  int value_ = -1;
};

}  // namespace uplink::front
