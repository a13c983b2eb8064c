#include "tools/uplink-fleet/twin/account.h"

#include <algorithm>

#include "tools/uplink-fleet/twin/canonical.h"

namespace uplink::synthetic {

void TwinAccount::Live(Side side, const std::string& path, const boost::json::value& value) {
  live_.at(static_cast<std::size_t>(side))[path] = CanonicalText(value);
}

void TwinAccount::SignOfLife(Side side, std::int64_t now_us) {
  Silence& silence = silences_.at(static_cast<std::size_t>(side));
  if (silence.last_us != 0) {
    silence.longest_us = std::max(silence.longest_us, now_us - silence.last_us);
  }
  silence.last_us = now_us;
}

void TwinAccount::Acked(std::uint64_t number) {
  if (waiting_.erase(number) > 0) ++acked_;
}

void TwinAccount::Refused(std::uint64_t number) {
  if (waiting_.erase(number) > 0) refused_.insert(number);
}

Delivery TwinAccount::DeliveryOf(std::uint64_t number) const {
  if (waiting_.contains(number) || refused_.contains(number)) return Delivery::kUnknown;
  const auto wrong = wrongs_.find(number);
  const bool sure = wrong == wrongs_.end() || wrong->second.sure;
  if (unsure_.contains(number)) return sure ? Delivery::kOnceOrMore : Delivery::kUnknown;
  return sure ? Delivery::kOnce : Delivery::kAtMostOnce;
}

std::string EventContent(std::string_view kind, const boost::json::object& detail,
                         std::int64_t sampled_ms) {
  return CanonicalText(boost::json::object{
      {"kind", JsonText(kind)}, {"detail", detail}, {"sampledAtMs", sampled_ms}});
}

std::string MessageContent(std::string_view level, std::string_view message,
                           const boost::json::object& detail, std::int64_t sampled_ms) {
  return CanonicalText(boost::json::object{{"level", JsonText(level)},
                                           {"message", JsonText(message)},
                                           {"detail", detail},
                                           {"sampledAtMs", sampled_ms}});
}

std::string ScopeContent(std::string_view scope, std::string_view id, std::string_view type,
                         const boost::json::object& detail, std::int64_t sampled_ms) {
  return CanonicalText(boost::json::object{{"scope", JsonText(scope)},
                                           {"id", JsonText(id)},
                                           {"type", JsonText(type)},
                                           {"detail", detail},
                                           {"sampledAtMs", sampled_ms}});
}

}  // namespace uplink::synthetic
