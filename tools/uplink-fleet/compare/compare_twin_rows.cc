#include "tools/uplink-fleet/compare/compare_twin_rows.h"

#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include <boost/json.hpp>
#include <fmt/core.h>
#include <google/protobuf/util/json_util.h>

#include "schema/json/exact.h"
#include "tools/uplink-fleet/twin/canonical.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

js::object ObjectOf(const google::protobuf::Struct& detail) {
  std::string text;
  if (!google::protobuf::util::MessageToJsonString(detail, &text).ok()) return {};
  std::optional<js::value> value = json::ParseExact(text);
  return value && value->is_object() ? value->get_object() : js::object();
}

/// Rows of this run by their number, and what is found out about each at once.
class FoundRows final {
 public:
  FoundRows(const TwinScript& twin, Findings& findings) : twin_(twin), findings_(findings) {}

  void Add(Side side, RowKind kind, const std::string& text, const std::string& content) {
    const std::optional<std::uint64_t> number = MarkIn(twin_.options(), text);
    if (!number) return;
    findings_.Find(ThingOf(kind));
    const auto& rows = twin_.account().rows();
    const auto sent = rows.find(*number);
    if (sent == rows.end() || sent->second.kind != kind || sent->second.side != side) {
      findings_.Differ(ThingOf(kind), RuriOf(twin_, side),
                       fmt::format("number {} is no such row", *number), Shown(content));
      return;
    }
    ++counts_[*number];
    if (sent->second.content == FingerprintOf(content)) return;
    findings_.Differ(ThingOf(kind), RuriOf(twin_, side),
                     fmt::format("number {}, {}, as it was sent", *number, sent->second.type),
                     Shown(content));
  }

  void CheckCounts() {
    for (const auto& [number, row] : twin_.account().rows()) {
      const Delivery delivery = twin_.account().DeliveryOf(number);
      if (MustBeThere(delivery)) findings_.Expect(ThingOf(row.kind));
      const auto found = counts_.find(number);
      const std::string wrong = WrongCount(delivery, found == counts_.end() ? 0 : found->second);
      if (wrong.empty()) continue;
      findings_.Differ(ThingOf(row.kind), RuriOf(twin_, row.side),
                       fmt::format("number {}, {}: once", number, row.type), wrong);
    }
  }

 private:
  static Thing ThingOf(RowKind kind) {
    switch (kind) {
      case RowKind::kEvent:
        return Thing::kTwinEvents;
      case RowKind::kMessage:
        return Thing::kTwinMessages;
      case RowKind::kScope:
        return Thing::kTwinScopes;
    }
    return Thing::kTwinEvents;
  }
  static std::string Shown(const std::string& content) {
    constexpr std::size_t kShownBytes = 200;
    return content.substr(0, kShownBytes);
  }

  const TwinScript& twin_;
  Findings& findings_;
  std::map<std::uint64_t, std::size_t> counts_;
};

}  // namespace

std::string WrongCount(Delivery delivery, std::size_t found) {
  const std::string times = fmt::format("{} times", found);
  switch (delivery) {
    case Delivery::kOnce:
      return found == 1 ? std::string() : found == 0 ? "no such row" : times;
    case Delivery::kOnceOrMore:
      return found >= 1 ? std::string() : "no such row";
    case Delivery::kAtMostOnce:
      return found <= 1 ? std::string() : times;
    case Delivery::kUnknown:
      return {};
  }
  return {};
}

bool MustBeThere(Delivery delivery) {
  return delivery == Delivery::kOnce || delivery == Delivery::kOnceOrMore;
}

const std::string& RuriOf(const TwinScript& twin, Side side) {
  return side == Side::kReal ? twin.ids().ruri : twin.ids().sim_ruri;
}

void CompareTwinRows(const TwinScript& twin, const StoredTwin& stored,
                     std::vector<v1::Quarantined>& nobody, Findings& findings) {
  FoundRows rows(twin, findings);
  for (const Side side : {Side::kReal, Side::kSim}) {
    for (const v1::Event& event : stored.Of(side).events) {
      const js::object detail = ObjectOf(event.detail());
      rows.Add(side, RowKind::kEvent, js::serialize(detail),
               EventContent(event.kind(), detail, event.sampled_at_ms()));
    }
    for (const v1::RobotMessage& message : stored.Of(side).messages) {
      rows.Add(side, RowKind::kMessage, message.message(),
               MessageContent(message.level(), message.message(), ObjectOf(message.detail()),
                              message.sampled_at_ms()));
    }
  }
  for (const v1::ScopeUpdate& update : stored.scopes) {
    const js::object detail = ObjectOf(update.detail());
    rows.Add(
        Side::kReal, RowKind::kScope, js::serialize(detail),
        ScopeContent(update.scope(), update.id(), update.type(), detail, update.sampled_at_ms()));
  }
  rows.CheckCounts();
  CompareTwinRuns(twin, stored, findings);
  CompareTwinFaults(twin, stored, findings);
  CompareTwinQuarantine(twin, stored, nobody, findings);
}

void CompareTwinPresence(const TwinScript& twin, const StoredTwin& stored, const Span& run,
                         Findings& findings) {
  for (const Side side : {Side::kReal, Side::kSim}) {
    findings.Expect(Thing::kTwinPresence);
    const v1::PresenceChange* latest = nullptr;
    std::size_t offline = 0;
    for (const v1::PresenceChange& change : stored.Of(side).presence) {
      if (change.at_ms() > run.to_ms) continue;
      if (latest == nullptr) latest = &change;  // the newest comes first
      const bool within = change.at_ms() >= run.from_ms;
      if (within && change.presence() == v1::PRESENCE_OFFLINE) ++offline;
    }
    const std::int64_t silence_us = twin.account().longest_silence_us(side);
    const bool silent = silence_us > std::chrono::microseconds(kTwinSilence).count();
    const bool online = latest != nullptr && latest->presence() == v1::PRESENCE_ONLINE;
    if (online && (offline == 0 || silent)) {
      findings.Find(Thing::kTwinPresence);
      continue;
    }
    const std::string last =
        latest == nullptr ? "no change" : v1::Presence_Name(latest->presence());
    findings.Differ(Thing::kTwinPresence, RuriOf(twin, side), "online at last, never offline",
                    fmt::format("{} at last, offline {} times", last, offline));
  }
}

}  // namespace uplink::synthetic
