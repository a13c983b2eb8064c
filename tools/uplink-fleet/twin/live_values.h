#pragma once

#include <string_view>
#include <vector>

#include "tools/uplink-fleet/twin/voice.h"

namespace uplink::synthetic {

/// Stands in each text that must show nowhere.
inline constexpr std::string_view kSecret = "candidate:secret";

/// One row of the table.
struct LiveKind;

/// Messages of a twin whose last value is shown: where it is, its joints, the reports of its
/// computers and devices; and messages that must not change it: what comes late, is only wanted,
/// steers or carries a secret. By a table of its messages. Thread: confined to one thread.
class LiveValues final {
 public:
  explicit LiveValues(const Speech& speech) : speech_(speech) {}

  [[nodiscard]] Publication Next();
  /// The first one of the table that is shown there.
  [[nodiscard]] Publication Of(Side side, std::string_view path);
  /// Each one, those that must change nothing after the others.
  [[nodiscard]] std::vector<Publication> All();

 private:
  [[nodiscard]] Publication Say(const LiveKind& kind);
  void Expect(const LiveKind& kind, const Draft& draft);
  void ExpectJoints(const LiveKind& kind, const Draft& draft);

  Speech speech_;
};

}  // namespace uplink::synthetic
