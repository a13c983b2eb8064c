#pragma once

#include <string_view>

#include "tools/uplink-fleet/twin/speech.h"

namespace uplink::synthetic {

/// What happens to a twin once and is stored: events, log lines, the marks of its clients, and
/// changes of its environment. All at QoS 1, each with a mark. Thread: confined to one thread.
class Happenings final {
 public:
  explicit Happenings(const Speech& speech) : speech_(speech) {}

  /// An event as its worker made it.
  [[nodiscard]] Publication Event();
  /// The same in the bridge's frame, which says the time.
  [[nodiscard]] Publication FramedEvent();
  /// Telemetry of a type that nobody knows.
  [[nodiscard]] Publication UnknownTelemetry();
  [[nodiscard]] Publication SimulatedTelemetry();
  /// A log line on its own topic, and one as telemetry.
  [[nodiscard]] Publication DriverLog();
  [[nodiscard]] Publication TelemetryLog();
  [[nodiscard]] Publication Environment();
  [[nodiscard]] Publication WorkflowRun();

  [[nodiscard]] Publication Connected(Speaker speaker);
  [[nodiscard]] Publication TelemetryStart(Speaker speaker);
  [[nodiscard]] Publication TelemetryEnd(Speaker speaker);
  [[nodiscard]] Publication Disconnected(Speaker speaker);
  /// Marks that change nothing: a stream's end, a recording's cut, an observation.
  [[nodiscard]] Publication IdleMark(Speaker speaker);

 private:
  [[nodiscard]] Publication Mark(Speaker speaker, std::string_view type, Draft draft);
  [[nodiscard]] SentSession& SessionOf(Speaker speaker);
  void NoteEvent(Side side, const Draft& draft, const std::string& type, std::int64_t sampled_ms);
  [[nodiscard]] boost::json::object LogBody(Draft& draft, std::string& message);
  void NoteLog(const Draft& draft, const std::string& message);

  Speech speech_;
};

}  // namespace uplink::synthetic
