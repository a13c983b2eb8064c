// What the journal's writer tells a robot: streams opened, records settled, holds lost.
#include <utility>

#include "schema/base/check.h"
#include "server/robot/mutation.h"
#include "server/robot/robot_sessions.h"

namespace uplink::robot {

StreamRef RobotSessions::OnOpened(std::uint64_t open_id, const storage::OpenResult& result) {
  const std::lock_guard lock(mutex_);
  // After Welcome nobody asks for it any more.
  if (open_id == open_id_ && open_wanted_) opened_ = result;
  return current_;
}

void RobotSessions::Count(const Settled& settled, Numbering& numbering,
                          metrics::UplinkCounts& counts) {
  const auto reject = [&counts](model::RejectReason reason) {
    ++counts.rejected;
    ++counts.rejects[static_cast<std::size_t>(reason)];
  };
  switch (settled.outcome.kind) {
    case storage::OutcomeKind::kStored:
      if (settled.rejected_for) {
        reject(*settled.rejected_for);
      } else {
        ++counts.stored;
      }
      return;
    case storage::OutcomeKind::kDuplicate:
      ++counts.duplicate;
      return;
    case storage::OutcomeKind::kRefused:
      UPLINK_CHECK(settled.outcome.rejection.has_value(), "a refused record has its reason");
      reject(settled.rejected_for.value_or(settled.outcome.rejection->reason));
      // A rejection made at judgement was told and is remembered already.
      if (!settled.rejected_for) {
        RejectedSeq rejected{.seq = settled.seq, .rejection = *settled.outcome.rejection};
        RememberIn(numbering, rejected);
        numbering.untold.push_back(std::move(rejected));
      }
      return;
    case storage::OutcomeKind::kFenced:
      break;
  }
  UPLINK_CHECK(false, "fenced records are told by OnFenced");
}

StreamRef RobotSessions::OnSettled(std::span<const Settled> settled, metrics::Ledger& ledger) {
  metrics::UplinkCounts counts;
  StreamRef wake;
  {
    const std::lock_guard lock(mutex_);
    for (const Settled& one : settled) {
      Numbering* numbering = Find(one.session);
      if (numbering == nullptr) continue;
      const std::size_t before = numbering->window.waiting();
      if (!numbering->window.Settle(one.seq)) continue;
      const std::size_t shrank = before - numbering->window.waiting();
      in_flight_.fetch_sub(shrank);
      counts.in_flight -= static_cast<std::int64_t>(shrank);
      if (!Planted(Mutation::kSettleLost)) Count(one, *numbering, counts);
      if (current_ && current_session_ == one.session) numbering->released.push_back(one.arrived);
    }
    wake = current_;
  }
  ledger.Publish(counts);
  return wake;
}

StreamRef RobotSessions::OnGapsWritten(std::size_t count) {
  gaps_in_flight_.fetch_sub(count);
  const std::lock_guard lock(mutex_);
  return current_;
}

StreamRef RobotSessions::OnFenced(metrics::Ledger& ledger) {
  metrics::UplinkCounts counts;
  StreamRef wake;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, numbering] : sessions_) {
      const std::size_t waiting = numbering.window.waiting();
      counts.superseded += waiting;
      counts.in_flight -= static_cast<std::int64_t>(waiting);
      in_flight_.fetch_sub(waiting);
    }
    sessions_.clear();
    opened_.reset();
    generation_.fetch_add(1);
    if (current_) current_superseded_ = true;
    wake = current_;
  }
  ledger.Publish(counts);
  return wake;
}

}  // namespace uplink::robot
