#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <list>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "schema/base/clock.h"
#include "schema/model/rcan.h"
#include "schema/model/record.h"

namespace uplink::robot {

/// Keys that a robot's live state keeps (validation rules: what is kept per robot).
inline constexpr std::size_t kExtrasMax = 1024;
inline constexpr std::size_t kHealthDevicesMax = 32;
inline constexpr std::size_t kConsumablesMax = 64;
inline constexpr std::size_t kDirectivesMax = 1024;

/// The latest value of each key, at most `kMax` of them: the least recently updated goes first.
template <typename Value, std::size_t kMax>
class LatestByKey {
 public:
  using Items = std::list<std::pair<std::string, Value>>;

  LatestByKey() = default;
  LatestByKey(const LatestByKey& other) : items_(other.items_) { Index(); }
  LatestByKey& operator=(const LatestByKey& other) {
    if (this != &other) {
      items_ = other.items_;
      Index();
    }
    return *this;
  }
  LatestByKey(LatestByKey&&) noexcept = default;
  LatestByKey& operator=(LatestByKey&&) noexcept = default;
  ~LatestByKey() = default;

  /// Returns the number of keys that had to go (0 or 1).
  std::size_t Put(std::string key, Value value) {
    if (const auto found = index_.find(key); found != index_.end()) {
      found->second->second = std::move(value);
      items_.splice(items_.end(), items_, found->second);
      return 0;
    }
    items_.emplace_back(std::move(key), std::move(value));
    index_.emplace(items_.back().first, std::prev(items_.end()));
    if (items_.size() <= kMax) return 0;
    index_.erase(items_.front().first);
    items_.pop_front();
    return 1;
  }

  void Erase(std::string_view key) {
    const auto found = index_.find(key);
    if (found == index_.end()) return;
    const auto item = found->second;
    index_.erase(found);
    items_.erase(item);
  }

  /// Puts these on top of older ones, which are kept as far as there is room.
  void PutOnTopOf(LatestByKey older) {
    for (auto& [key, value] : items_) older.Put(key, std::move(value));
    *this = std::move(older);
  }

  /// Null if the key is not kept.
  [[nodiscard]] const Value* Find(std::string_view key) const {
    const auto found = index_.find(key);
    return found == index_.end() ? nullptr : &found->second->second;
  }

  /// Least recently updated first.
  [[nodiscard]] const Items& items() const { return items_; }

 private:
  void Index() {
    index_.clear();
    for (auto it = items_.begin(); it != items_.end(); ++it) index_.emplace(it->first, it);
  }

  Items items_;
  // Keys are views of the list's own strings, which do not move.
  std::unordered_map<std::string_view, typename Items::iterator> index_;
};

/// One reading of extras: the reading's own time, else its message's.
struct Extra {
  model::Value value;
  std::int64_t sampled_at_ms = 0;
  /// In this life of the server; the epoch if it was restored.
  SteadyTime arrived{};
};

/// The latest of each live kind, in stream order; no robot clock decides anything. A value.
struct LiveParts {
  std::optional<model::MotionTelemetry> motion;
  std::optional<model::StatusTelemetry> status;
  LatestByKey<Extra, kExtrasMax> extras;
  LatestByKey<model::SystemHealth, kHealthDevicesMax> health;
  std::optional<model::UsageTelemetry> usage;
  LatestByKey<model::ConsumableStatus, kConsumablesMax> consumables;
  LatestByKey<model::SpatialDirectiveStatus, kDirectivesMax> directives;
  /// RCAN's Robot State.
  std::optional<model::RcanState> rcan;
};

/// Puts one live body into the parts; returns the number of keys that had to go. A body of a
/// durable kind is a mistake of ours.
std::size_t PutInto(LiveParts& parts, model::Body&& body, SteadyTime arrived = {});

}  // namespace uplink::robot
