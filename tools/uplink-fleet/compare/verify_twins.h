#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/uplink-fleet/compare/conservation.h"
#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/verify.h"
#include "tools/uplink-fleet/twin/account.h"

namespace uplink::synthetic {

/// What all twins together published. A value.
struct TwinTotals {
  std::uint64_t twins = 0;
  std::uint64_t settled_twins = 0;
  std::uint64_t published = 0;
  std::uint64_t published_qos1 = 0;
  std::uint64_t acked = 0;
  std::uint64_t refused = 0;
  std::uint64_t pings = 0;
  std::uint64_t pongs = 0;

  void Add(const TwinAccount& account);
};

/// Each scrape of a run against the law of conservation. Confined to one thread.
class ConservationWatch final {
 public:
  void See(const std::optional<Conservation>& counts);
  [[nodiscard]] std::uint64_t scrapes() const { return scrapes_; }
  [[nodiscard]] std::uint64_t good() const { return good_; }
  /// The first one that did not hold.
  [[nodiscard]] const std::string& first_wrong() const { return first_wrong_; }

 private:
  std::uint64_t scrapes_ = 0;
  std::uint64_t good_ = 0;
  std::string first_wrong_;
};

/// What the server counted of one source of messages. A value.
struct SourceCounts {
  ConservationWatch watch;
  /// None: the page of metrics does not have them.
  std::optional<Conservation> before;
  std::optional<Conservation> after;
  /// The server was started anew in between: its counters began anew, too.
  bool restarted = false;

  /// How far they moved during the run; nothing if the page does not have them.
  [[nodiscard]] std::optional<Conservation> Moved() const;
};

/// The lines of the law of conservation, and one for each outcome. Pure; any thread.
void CheckCounts(const SourceCounts& counts, std::vector<CheckRow>& rows);

/// Everything that the table of a run with twins is made of. A value.
struct TwinEvidence : SourceCounts {
  TwinTotals totals;
  Findings findings;
  std::uint64_t twins_read = 0;
};

/// The table of such a run. Pure; any thread.
[[nodiscard]] std::vector<CheckRow> VerifyTwins(const TwinEvidence& evidence);

}  // namespace uplink::synthetic
