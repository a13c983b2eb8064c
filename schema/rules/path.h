#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::schema {

/// Where in a message we are: links on the stack, turned into text only when a violation is found.
/// A link must not outlive the one above it.
class Path {
 public:
  /// Bytes that are shown of a key of the sender's own.
  static constexpr std::size_t kKeyBytesMax = 64;

  /// The variant's own struct: an empty path.
  constexpr Path() = default;

  [[nodiscard]] constexpr Path Field(std::string_view name) const& {
    Path path;
    path.above_ = this;
    path.name_ = name;
    return path;
  }
  /// A member of an object whose keys are the sender's own: shown cut and printable.
  [[nodiscard]] constexpr Path Key(std::string_view name) const& {
    Path path = Field(name);
    path.foreign_ = true;
    return path;
  }
  [[nodiscard]] constexpr Path Item(std::size_t index) const& {
    Path path;
    path.above_ = this;
    path.index_ = index;
    return path;
  }
  // A link to a temporary would dangle unless it is used in the same expression; name it first.
  Path Field(std::string_view name) && = delete;
  Path Key(std::string_view name) && = delete;
  Path Item(std::size_t index) && = delete;

  /// Whether a text shows keys of the sender's own; where it does not, each is a `*`.
  enum class Keys : bool { kShown, kHidden };

  /// As the surface spells it: `kv[3].key`, `[3].key`.
  [[nodiscard]] std::string Text(Keys keys = Keys::kShown) const;

 private:
  const Path* above_ = nullptr;
  std::string_view name_;
  std::optional<std::size_t> index_;
  bool foreign_ = false;
};

}  // namespace uplink::schema
