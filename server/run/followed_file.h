#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace uplink::run {

/// Tells when a file was changed or replaced. One that is being written counts once it has stayed
/// as it is from one look to the next: half of it would be another configuration.
///
/// Thread: confined to one.
class FollowedFile final {
 public:
  /// What it is now is known.
  explicit FollowedFile(std::string path);

  /// Whether it has changed since what is known, which is what it is now then. A file that is away
  /// has not changed.
  [[nodiscard]] bool Look();
  /// Somebody has just read it.
  void NoteRead() { known_ = seen_ = LookNow(); }

 private:
  struct State {
    std::uint64_t inode = 0;
    std::int64_t size = 0;
    std::int64_t changed_s = 0;
    std::int64_t changed_ns = 0;

    friend bool operator==(const State&, const State&) = default;
  };
  /// Nothing: it is away.
  [[nodiscard]] std::optional<State> LookNow() const;

  const std::string path_;
  std::optional<State> known_;
  std::optional<State> seen_;
};

}  // namespace uplink::run
