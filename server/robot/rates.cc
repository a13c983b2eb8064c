#include "server/robot/rates.h"

#include <algorithm>
#include <functional>
#include <string>
#include <variant>

#include <fmt/format.h>

namespace uplink::robot {
namespace {

/// How often ids that are no longer limited are searched when there are too many: each search walks
/// over all.
constexpr std::chrono::seconds kForgetEvery{1};

/// The id by which an upsert is limited; empty for other messages.
std::optional<std::size_t> UpsertId(const model::Body& body) {
  const auto hash = std::hash<std::string>();
  if (const auto* shape = std::get_if<model::ShapeOp>(&body)) {
    if (shape->upsert() != nullptr) return hash(shape->id());
  } else if (const auto* object = std::get_if<model::ObjectOp>(&body)) {
    if (object->upsert() != nullptr) return hash(object->id());
  }
  return std::nullopt;
}

bool IsDeletion(const model::Body& body) {
  if (const auto* shape = std::get_if<model::ShapeOp>(&body)) return shape->deletion() != nullptr;
  const auto* object = std::get_if<model::ObjectOp>(&body);
  return object != nullptr && object->deletion() != nullptr;
}

/// Rounded up, so that a message that comes again after it is not limited.
milliseconds Until(SteadyTime time, SteadyTime now) {
  return std::chrono::ceil<milliseconds>(time - now);
}

}  // namespace

model::Rejection RateLimited(const limits::BucketSize& size) {
  return {
      .reason = model::RejectReason::kRateLimited,
      .field = "",
      .detail = fmt::format("more than {} per second, after {} at once", size.rate, size.burst)};
}

std::optional<SteadyTime> Rates::LimitedIds::Until(std::size_t id, SteadyTime now) {
  if (until_.empty()) return std::nullopt;
  if (last_ <= now) {
    until_.clear();
    return std::nullopt;
  }
  if (until_.size() >= kLimitedIdsMax && looks_.Take(now, kForgetEvery)) {
    std::erase_if(until_, [now](const auto& each) { return each.second <= now; });
  }
  if (until_.size() >= kLimitedIdsMax) return last_;
  const auto known = until_.find(id);
  if (known == until_.end()) return std::nullopt;
  if (known->second > now) return known->second;
  until_.erase(known);
  return std::nullopt;
}

void Rates::LimitedIds::Add(std::size_t id, SteadyTime until) {
  until_.insert_or_assign(id, until);
  last_ = std::max(last_, until);
}

std::optional<Rates::Limited> Rates::LimitedNow(const model::Body& body, const RateTable& table,
                                                SteadyTime now) {
  const std::size_t variant = body.index();
  const limits::BucketSize& size = table[variant];
  if (size.rate == 0) return std::nullopt;
  const std::optional<std::size_t> id = UpsertId(body);
  std::size_t waiting = 0;
  if (id && ids_ != nullptr) {
    LimitedIds& ids = (*ids_)[variant];
    if (const auto until = ids.Until(*id, now)) return Limited{.until = *until};
    waiting = ids.size();
  }
  const limits::TokenBucket& bucket = buckets_[variant];
  if (bucket.PassesAt(1, size, now) <= now || IsDeletion(body)) return std::nullopt;
  // Each of those that wait gets a token of its own.
  return Limited{.until = bucket.PassesAt(1 + waiting, size, now), .new_id = id};
}

std::optional<milliseconds> Rates::Limit(const model::Body& body, const RateTable& table,
                                         SteadyTime now) {
  const std::size_t variant = body.index();
  const limits::BucketSize& size = table[variant];
  if (size.rate == 0) return std::nullopt;
  const std::optional<Limited> limited = LimitedNow(body, table, now);
  if (!limited) {
    // A deletion takes a token if there is one.
    static_cast<void>(buckets_[variant].TryTake(1, size, now));
    return std::nullopt;
  }
  if (limited->new_id) {
    // No table: nothing was limited yet.
    if (ids_ == nullptr) ids_ = std::make_unique<IdsByVariant>();
    (*ids_)[variant].Add(*limited->new_id, limited->until);
  }
  limited_[variant].fetch_add(1, std::memory_order_relaxed);
  return Until(limited->until, now);
}

void Rates::BeginStream() {
  for (auto& count : limited_) count.store(0, std::memory_order_relaxed);
}

}  // namespace uplink::robot
