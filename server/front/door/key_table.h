#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <mutex>
#include <optional>
#include <string_view>
#include <unordered_map>

#include "schema/base/clock.h"
#include "server/front/door/source_address.h"

namespace uplink::front {

/// SHA-256 of a certificate's SubjectPublicKeyInfo.
using KeyDigest = std::array<std::uint8_t, 32>;

/// Stands for the key of those from this source that have shown none. No SHA-256 is known to be so.
[[nodiscard]] KeyDigest KeyOf(const SourceAddress& source);

/// The same for those that have shown the token of this name: the SHA-256 of that.
[[nodiscard]] KeyDigest KeyOfCaller(std::string_view name);

/// The open, proven connections of each public key.
///
/// Limits: bounded by the number of connections; the owner must Remove each.
/// Thread: thread-safe.
class KeyTable final {
 public:
  /// Adds a proven connection with an unused id. If its key now has more than `per_key_max`, the
  /// result is the connection to close, which is removed: the oldest one without a stream,
  /// otherwise the one heard least recently; the newcomer only if the maximum is 0. If the maximum
  /// has shrunk, the key keeps what it has, but gets no more.
  [[nodiscard]] std::optional<std::uint64_t> Add(const KeyDigest& digest, std::uint64_t connection,
                                                 std::size_t per_key_max, SteadyTime now);
  /// The connection counts under this key from now on, as if it had just come; the result as Add's.
  /// `per_key_max`: over 0.
  [[nodiscard]] std::optional<std::uint64_t> Move(std::uint64_t connection, const KeyDigest& digest,
                                                  std::size_t per_key_max);
  /// Its peer sent something. Here and below, unknown connections are ignored: they may have been
  /// evicted meanwhile.
  void NoteHeard(std::uint64_t connection, SteadyTime now);
  /// How many streams it has; none at first.
  void SetStreams(std::uint64_t connection, std::size_t streams);
  void Remove(std::uint64_t connection);
  /// Whether it is here: neither removed nor evicted.
  [[nodiscard]] bool Has(std::uint64_t connection) const;

  [[nodiscard]] std::size_t connections() const;
  /// Keys that have a connection.
  [[nodiscard]] std::size_t keys() const;

 private:
  /// A digest is uniform; an attacker who grinds for another one needs our certificates for it.
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

  /// Makes room for the newcomer of a key that has more than `per_key_max`.
  [[nodiscard]] std::optional<std::uint64_t> EvictPast(Key& key, std::size_t per_key_max);
  /// The connection to close so that the newcomer may stay; the key has at least two.
  [[nodiscard]] static Connections::iterator ChooseToEvict(Connections& connections);

  mutable std::mutex mutex_;
  std::unordered_map<KeyDigest, Key, DigestHash> keys_;
  std::unordered_map<std::uint64_t, Connections::iterator> connections_;
};

}  // namespace uplink::front
