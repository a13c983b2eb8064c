#pragma once

#include <cstdint>
#include <unordered_map>

#include <fmt/core.h>

#include "schema/model/record.h"
#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/robot/account.h"
#include "tools/uplink-fleet/robot/rows.h"

namespace uplink::synthetic {

/// A history, one row per message: as many of each content as were sent.
template <typename Row>
class History {
 public:
  History(Thing thing, model::Variant variant, const RobotOutcome& robot, Findings& findings)
      : thing_(thing), robot_(robot), findings_(findings) {
    for (const SentMessage& message : robot.account.sent()) {
      if (message.variant != variant || message.row_hash == 0) continue;
      Expected& expected = expected_[message.row_hash];
      ++expected.sent;
      expected.acked += message.acked ? 1 : 0;
      expected.seq = message.seq;
      findings.Expect(thing, message.acked ? 1 : 0);
    }
  }

  void Check(const Row& row) {
    findings_.Find(thing_);
    if (row.ruri() != robot_.ruri) {
      findings_.Differ(thing_, robot_.ruri, "rows of this robot", Shown(row));
    }
    if (received_before_ != 0 && row.received_at_ms() > received_before_) {
      findings_.Differ(thing_, robot_.ruri, "the newest first", Shown(row));
    }
    received_before_ = row.received_at_ms();
    const auto expected = expected_.find(HashOf(Bare(row)));
    if (expected == expected_.end()) {
      findings_.Differ(thing_, robot_.ruri, "nothing like it", Shown(row));
    } else if (++expected->second.stored > expected->second.sent) {
      findings_.Differ(thing_, robot_.ruri, fmt::format("{} of it", expected->second.sent),
                       fmt::format("{}: {}", expected->second.stored, Shown(row)));
    }
  }

  void Finish() {
    for (const auto& [hash, expected] : expected_) {
      if (expected.stored >= expected.acked) continue;
      findings_.Differ(thing_, robot_.ruri, fmt::format("number {}, acked", expected.seq),
                       "no such row");
    }
  }

 private:
  struct Expected {
    std::uint64_t sent = 0;
    std::uint64_t acked = 0;
    std::uint64_t stored = 0;
    model::Seq seq = 0;
  };

  const Thing thing_;
  const RobotOutcome& robot_;
  Findings& findings_;
  std::int64_t received_before_ = 0;
  std::unordered_map<std::uint64_t, Expected> expected_;
};

template <typename Row, typename Rows>
void CompareHistory(Thing thing, model::Variant variant, const RobotOutcome& robot,
                    const Rows& rows, Findings& findings) {
  History<Row> history(thing, variant, robot, findings);
  for (const Row& row : rows) history.Check(row);
  history.Finish();
}

}  // namespace uplink::synthetic
