#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "schema/base/clock.h"

namespace uplink::front {

/// SHA-256 of a certificate's SubjectPublicKeyInfo.
using KeyDigest = std::array<std::uint8_t, 32>;

/// The open, proven connections of each public key.
///
/// Limits: its size is bounded by the number of connections, each of which must be Removed.
/// Thread: thread-safe.
class KeyTable final {
 public:
  /// A proven connection; no other one in here has its id. If its key then has more than
  /// `per_key_max`, the answer is which one has to be closed, and is no longer in here: the oldest
  /// of those without a stream, else the one heard least recently; the newcomer only if the maximum
  /// is 0. A maximum that has shrunk lets the key keep what it has, but have no more.
  [[nodiscard]] std::optional<std::uint64_t> Add(const KeyDigest& digest, std::uint64_t connection,
                                                 std::size_t per_key_max, SteadyTime now);
  /// Something came from its peer. Here and below, an unknown connection is passed over: it may
  /// have been evicted meanwhile.
  void NoteHeard(std::uint64_t connection, SteadyTime now);
  /// How many streams it has; none at first.
  void SetStreams(std::uint64_t connection, std::size_t streams);
  void Remove(std::uint64_t connection);
  /// Whether it is in here: neither removed nor evicted.
  [[nodiscard]] bool Has(std::uint64_t connection) const;

  [[nodiscard]] std::size_t connections() const;
  /// That have a connection.
  [[nodiscard]] std::size_t keys() const;

 private:
  /// A digest is uniform, and who grinds for one that is not needs certificates of ours for it.
  struct DigestHash {
    std::size_t operator()(const KeyDigest& digest) const noexcept;
  };
  struct Connection {
    std::uint64_t id = 0;
    KeyDigest digest{};
    std::size_t streams = 0;
    SteadyTime heard;
  };
  using Connections = std::list<Connection>;
  struct Key {
    /// From the oldest to the newest.
    Connections connections;
  };

  /// The one to be closed so that the newcomer may stay; the key has two connections at least.
  [[nodiscard]] static Connections::iterator ToEvict(Connections& connections);

  mutable std::mutex mutex_;
  std::unordered_map<KeyDigest, Key, DigestHash> keys_;
  std::unordered_map<std::uint64_t, Connections::iterator> connections_;
};

}  // namespace uplink::front
