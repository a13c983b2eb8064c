#include "server/front/door/key_table.h"

#include <algorithm>
#include <cstring>
#include <iterator>

#include <openssl/sha.h>

#include "schema/base/check.h"

namespace uplink::front {

KeyDigest KeyOf(const SourceAddress& source) {
  KeyDigest key{};
  // The end of an address differs most, and tables look at the beginning of a key.
  std::reverse_copy(source.bytes().begin(), source.bytes().end(), key.begin());
  return key;
}

KeyDigest KeyOfCaller(std::string_view name) {
  KeyDigest key{};
  // The library's bytes are unsigned char; looking at chars as such is always allowed.
  SHA256(reinterpret_cast<const unsigned char*>(name.data()), name.size(), key.data());
  return key;
}

std::optional<std::uint64_t> KeyTable::Add(const KeyDigest& digest, std::uint64_t connection,
                                           std::size_t per_key_max, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  UPLINK_CHECK(!connections_.contains(connection), "two connections of one id");
  if (per_key_max == 0) return connection;
  Key& key = keys_[digest];
  key.connections.push_back({.id = connection, .digest = digest, .heard = now});
  connections_.emplace(connection, std::prev(key.connections.end()));
  return EvictPast(key, per_key_max);
}

std::optional<std::uint64_t> KeyTable::Move(std::uint64_t connection, const KeyDigest& digest,
                                            std::size_t per_key_max) {
  UPLINK_CHECK(per_key_max > 0, "who moves may stay");
  const std::lock_guard lock(mutex_);
  const auto found = connections_.find(connection);
  if (found == connections_.end() || found->second->digest == digest) return std::nullopt;
  Key& into = keys_[digest];
  const auto from = keys_.find(found->second->digest);
  UPLINK_CHECK(from != keys_.end(), "a connection of no key");
  into.connections.splice(into.connections.end(), from->second.connections, found->second);
  found->second->digest = digest;
  if (from->second.connections.empty()) keys_.erase(from);
  return EvictPast(into, per_key_max);
}

std::optional<std::uint64_t> KeyTable::EvictPast(Key& key, std::size_t per_key_max) {
  if (key.connections.size() <= per_key_max) return std::nullopt;
  const Connections::iterator evicted = ChooseToEvict(key.connections);
  const std::uint64_t evicted_id = evicted->id;
  connections_.erase(evicted_id);
  key.connections.erase(evicted);
  return evicted_id;
}

void KeyTable::NoteHeard(std::uint64_t connection, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  const auto found = connections_.find(connection);
  if (found == connections_.end()) return;
  found->second->heard = std::max(found->second->heard, now);
}

void KeyTable::SetStreams(std::uint64_t connection, std::size_t streams) {
  const std::lock_guard lock(mutex_);
  const auto found = connections_.find(connection);
  if (found != connections_.end()) found->second->streams = streams;
}

void KeyTable::Remove(std::uint64_t connection) {
  const std::lock_guard lock(mutex_);
  const auto found = connections_.find(connection);
  if (found == connections_.end()) return;
  const auto key = keys_.find(found->second->digest);
  UPLINK_CHECK(key != keys_.end(), "a connection of no key");
  key->second.connections.erase(found->second);
  if (key->second.connections.empty()) keys_.erase(key);
  connections_.erase(found);
}

bool KeyTable::Has(std::uint64_t connection) const {
  const std::lock_guard lock(mutex_);
  return connections_.contains(connection);
}

std::size_t KeyTable::connections() const {
  const std::lock_guard lock(mutex_);
  return connections_.size();
}

std::size_t KeyTable::keys() const {
  const std::lock_guard lock(mutex_);
  return keys_.size();
}

KeyTable::Connections::iterator KeyTable::ChooseToEvict(Connections& connections) {
  const auto newcomer = std::prev(connections.end());
  const auto idle = std::find_if(connections.begin(), newcomer,
                                 [](const Connection& one) { return one.streams == 0; });
  if (idle != newcomer) return idle;
  return std::min_element(
      connections.begin(), newcomer,
      [](const Connection& left, const Connection& right) { return left.heard < right.heard; });
}

std::size_t KeyTable::DigestHash::operator()(const KeyDigest& digest) const noexcept {
  std::size_t hash = 0;
  std::memcpy(&hash, digest.data(), sizeof(hash));
  return hash;
}

}  // namespace uplink::front
