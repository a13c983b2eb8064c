#include "server/cyberwave/twin_parts.h"

#include <numeric>

#include "schema/base/utf8.h"
#include "schema/limits.h"
#include "server/cyberwave/held_bytes.h"

namespace uplink::cyberwave {
namespace {

/// Overhead of a node of a map or a list.
constexpr std::size_t kNodeBytes = 32 + kAllocationBytes;

/// The most memory of a text of so many bytes: control characters were replaced by longer ones, and
/// a buffer doubles as it grows.
constexpr std::size_t TextBytes(std::size_t bytes_max) {
  return 2 * kReplacementBytes * bytes_max + kAllocationBytes;
}

// The most memory of a full twin, part by part.
constexpr std::size_t kJointBytes =
    sizeof(JointTable::ByName::value_type) + kNodeBytes + TextBytes(schema::kNameBytesMax);
constexpr std::size_t kJointsBytes =
    kJointGroups * kJointNamesMax * kJointBytes + kJointNamesMax * TextBytes(schema::kNameBytesMax);
constexpr std::size_t kTablesBytes = 3 * kTableBytesMax;
constexpr std::size_t kReportBytes = 2 * TextBytes(kMessageBytesMax);
constexpr std::size_t kSessionBytes =
    sizeof(SessionMarks::Sessions::value_type) + kNodeBytes +
    (kEndedStreamsMax + 1) * (TextBytes(schema::kIdBytesMax) + 2 * sizeof(std::string));
/// Held beside the parts (twin_state.h).
constexpr std::size_t kFaultsBytes =
    kMetricFaultsMax * (sizeof(std::string) + kNodeBytes + TextBytes(schema::kIdBytesMax));
constexpr std::size_t kHeadsBytes = 16 * TextBytes(schema::kNameBytesMax);
static_assert(sizeof(TwinParts) + kJointsBytes + kTablesBytes + kReportBytes +
                      kMarkedSessionsMax * kSessionBytes + kHeadsBytes + kFaultsBytes <=
                  kTwinBytesMax,
              "a full twin stays within its bound");

template <typename T>
std::size_t SourceBytes(const std::optional<Held<T>>& held) {
  return held ? HeldBytes(held->source.text) : 0;
}

std::size_t ReportBytes(const std::optional<HeldReport>& report) {
  return report ? HeldBytes(report->value) + HeldBytes(report->source.text) : 0;
}

std::size_t JointsBytes(const JointTable& joints) {
  std::size_t held = 0;
  for (std::size_t group = 0; group < kJointGroups; ++group) {
    for (const auto& [name, joint] : joints.Of(static_cast<JointGroup>(group))) {
      held += sizeof(JointTable::ByName::value_type) + kNodeBytes + HeldBytes(name) +
              HeldBytes(joint.other_source);
    }
  }
  return held;
}

std::size_t SessionsBytes(const SessionMarks& marks) {
  std::size_t held = 0;
  for (const auto& [id, session] : marks.sessions()) {
    held += sizeof(SessionMarks::Sessions::value_type) + kNodeBytes + HeldBytes(id) +
            session.ended_streams.capacity() * sizeof(std::string);
    for (const std::string& stream : session.ended_streams) held += HeldBytes(stream);
  }
  return held;
}

std::size_t CommandBytes(const std::optional<LastCommand>& command) {
  if (!command) return 0;
  return HeldBytes(command->head.command) + HeldBytes(command->head.status) +
         HeldBytes(command->head.action_id) + HeldBytes(command->source.text);
}

}  // namespace

TwinTableBytes TableBytes(const TwinParts& parts) {
  // By TwinTable.
  return {JointsBytes(parts.joints),    parts.metrics.bytes(),     parts.edges.bytes(),
          parts.reports.bytes(),        ReportBytes(parts.motors), ReportBytes(parts.driver_info),
          SessionsBytes(parts.sessions)};
}

std::size_t HeldBytes(const TwinParts& parts) {
  const TwinTableBytes tables = TableBytes(parts);
  return sizeof(TwinParts) + SourceBytes(parts.position) + SourceBytes(parts.rotation) +
         SourceBytes(parts.scale) + SourceBytes(parts.battery) + SourceBytes(parts.gps) +
         (parts.gps ? HeldBytes(parts.gps->value.fix_type) : 0) +
         std::accumulate(tables.begin(), tables.end(), std::size_t{0}) +
         CommandBytes(parts.observed.last_command());
}

}  // namespace uplink::cyberwave
