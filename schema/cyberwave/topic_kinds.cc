#include "schema/cyberwave/topic_kinds.h"

#include <array>
#include <cstddef>
#include <utility>

#include "schema/cyberwave/topic.h"

namespace uplink::cyberwave {
namespace {

using enum MessageClass;

struct Row {
  TopicRow topic;
  std::string_view text;
};

constexpr std::string_view kTwin = "twin";

constexpr std::array kRows = {
    Row{{TopicKind::kPosition, kTwin, "position", kLive, Connection::kLive}, "twin/position"},
    Row{{TopicKind::kRotation, kTwin, "rotation", kLive, Connection::kLive}, "twin/rotation"},
    Row{{TopicKind::kScale, kTwin, "scale", kLive, Connection::kLive}, "twin/scale"},
    Row{{TopicKind::kJointUpdate, "joint", "update", kLive, Connection::kLive}, "joint/update"},
    Row{{TopicKind::kMetrics, kTwin, "metrics", kLive, Connection::kDurable}, "twin/metrics"},
    Row{{TopicKind::kEdgeHealth, kTwin, "edge_health", kLive, Connection::kLive},
        "twin/edge_health"},
    Row{{TopicKind::kTelemetry, kTwin, "telemetry", kDurable, Connection::kDurable},
        "twin/telemetry"},
    Row{{TopicKind::kNavigateStatus, kTwin, "navigate/status", kDurable, Connection::kDurable},
        "twin/navigate/status"},
    Row{{TopicKind::kDriverLog, kTwin, "driverlog", kDurable, Connection::kDurable},
        "twin/driverlog"},
    Row{{TopicKind::kEvent, kTwin, "event", kDurable, Connection::kDurable}, "twin/event"},
    Row{{TopicKind::kMissionStatus, kTwin, "mission/status", kDurable, Connection::kDurable},
        "twin/mission/status"},
    Row{{TopicKind::kGps, kTwin, "gps", kLive, Connection::kLive}, "twin/gps"},
    Row{{TopicKind::kJointStates, kTwin, "joint_states", kLive, Connection::kLive},
        "twin/joint_states"},
    Row{{TopicKind::kBatteryStatus, kTwin, "battery/status", kLive, Connection::kLive},
        "twin/battery/status"},
    Row{{TopicKind::kCommand, kTwin, "command", kObserved, Connection::kLive}, "twin/command"},
    Row{{TopicKind::kNavigateCommand, kTwin, "navigate/command", kObserved, Connection::kLive},
        "twin/navigate/command"},
    Row{{TopicKind::kWebrtcOffer, kTwin, "webrtc-offer", kObserved, Connection::kLive},
        "twin/webrtc-offer"},
    Row{{TopicKind::kWebrtcAnswer, kTwin, "webrtc-answer", kObserved, Connection::kLive},
        "twin/webrtc-answer"},
    Row{{TopicKind::kWebrtcCandidate, kTwin, "webrtc-candidate", kObserved, Connection::kLive},
        "twin/webrtc-candidate"},
    Row{{TopicKind::kDepth, kTwin, "depth", kMedia, Connection::kMedia}, "twin/depth"},
    Row{{TopicKind::kPointcloud, kTwin, "pointcloud", kMedia, Connection::kMedia},
        "twin/pointcloud"},
    Row{{TopicKind::kEnvironment, "environment", "+", kDurable, Connection::kDurable},
        "environment/+"},
    Row{{TopicKind::kWorkflowRun, "workflow-run", "status", kDurable, Connection::kDurable},
        "workflow-run/status"},
    Row{{TopicKind::kPing, "ping", "request", MessageClass::kPing, Connection::kLive},
        "ping/request"},
};

constexpr std::size_t kKinds = kRows.size();

constexpr bool InOrder() {
  for (std::size_t i = 0; i < kKinds; ++i) {
    if (kRows.at(i).topic.kind != static_cast<TopicKind>(i)) return false;
  }
  return kKinds == static_cast<std::size_t>(TopicKind::kOther);
}
static_assert(InOrder(), "a row per kind, in the order of the kinds");

constexpr std::array<TopicRow, kKinds> Topics() {
  std::array<TopicRow, kKinds> topics;
  for (std::size_t i = 0; i < kKinds; ++i) topics.at(i) = kRows.at(i).topic;
  return topics;
}
constexpr std::array<TopicRow, kKinds> kTopics = Topics();

}  // namespace

std::span<const TopicRow> TopicRows() { return kTopics; }

std::string_view ToText(TopicKind kind) {
  const auto number = static_cast<std::size_t>(kind);
  return number < kKinds ? kRows.at(number).text : "other";
}

std::vector<std::string> Filters(std::string_view prefix, Connection connection) {
  std::vector<std::string> filters;
  for (const TopicRow& row : TopicRows()) {
    if (row.connection != connection) continue;
    std::string filter(prefix);
    filter.append(kRoot).append(row.scope).append("/+/").append(row.tail);
    filters.push_back(std::move(filter));
  }
  return filters;
}

}  // namespace uplink::cyberwave
