#pragma once

#include <cstdint>
#include <vector>

#include "tools/uplink-fleet/twin/account.h"
#include "tools/uplink-fleet/twin/happenings.h"
#include "tools/uplink-fleet/twin/live_values.h"
#include "tools/uplink-fleet/twin/metrics.h"
#include "tools/uplink-fleet/twin/runs.h"
#include "tools/uplink-fleet/twin/voice.h"
#include "tools/uplink-fleet/twin/wrongs.h"

namespace uplink::synthetic {

/// All that one twin publishes, in order, and the account of it. The same options and times give
/// the same bytes. It knows no clock, broker or server.
///
/// Units:  `now_us` is Unix time; one that goes back counts as the last one.
/// Thread: confined to one thread at a time.
class TwinScript final {
 public:
  explicit TwinScript(const TwinOptions& options);
  TwinScript(const TwinScript&) = delete;
  TwinScript& operator=(const TwinScript&) = delete;

  /// How it begins: its clients' marks, and a retained message.
  [[nodiscard]] std::vector<Publication> First(std::int64_t now_us);
  /// What it says next.
  [[nodiscard]] Publication Next(std::int64_t now_us);
  /// How it ends: each live value once more, then what must change none of them. The broker's
  /// retained message is taken away.
  [[nodiscard]] std::vector<Publication> Last(std::int64_t now_us);

  [[nodiscard]] TwinAccount& account() { return account_; }
  [[nodiscard]] const TwinAccount& account() const { return account_; }
  [[nodiscard]] const TwinIds& ids() const { return voice_.ids(); }
  [[nodiscard]] const TwinOptions& options() const { return voice_.options(); }

 private:
  [[nodiscard]] Publication Stored();
  [[nodiscard]] Publication ViewerMark();

  Voice voice_;
  TwinAccount account_;
  LiveValues live_;
  Metrics metrics_;
  Happenings happenings_;
  Runs runs_;
  Wrongs wrongs_;
  bool viewer_there_ = false;
};

}  // namespace uplink::synthetic
