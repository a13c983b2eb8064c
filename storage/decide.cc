#include "storage/decide.h"

#include <algorithm>
#include <variant>

#include "schema/base/check.h"
#include "storage/bounds.h"
#include "storage/expiry.h"
#include "storage/refusal.h"

namespace uplink::storage {

bool RaiseCursor(KnownSession& session, model::Seq number, SystemTime at) {
  if (number <= session.cursor) return false;
  session.cursor = number;
  session.is_raised = true;
  session.last_used = std::max(session.last_used, at);
  return true;
}

absl::StatusOr<bool> Decider::IsFenced(const RobotRef& robot, Epoch held_since) {
  const absl::StatusOr<KnownRobot*> known = known_.Robot(robot->ruri);
  if (!known.ok()) return known.status();
  return *known == nullptr || held_since != (*known)->held_since;
}

absl::StatusOr<bool> Decider::IsLeaseOver(const TopicHold* hold) {
  if (hold == nullptr) return false;
  const absl::StatusOr<Epoch> epoch = known_.LeaseEpoch(hold->client_id);
  if (!epoch.ok()) return epoch.status();
  return *epoch != hold->epoch;
}

absl::StatusOr<DeliveryChanges> Decider::Remember(const Batch& batch,
                                                  std::span<const Outcome> outcomes) {
  return DeliveryChangesOf(batch, outcomes, [this](const TopicHold& hold) -> absl::StatusOr<bool> {
    const absl::StatusOr<bool> over = IsLeaseOver(&hold);
    if (!over.ok()) return over.status();
    return !*over;
  });
}

absl::StatusOr<std::optional<OutcomeKind>> Decider::LookAt(const CommitRecord& of_sample) {
  const SampleMark& mark = *of_sample.sample;
  UPLINK_CHECK(mark.type < kSampleTypesMax && mark.last.size() <= kSampleLastBytesMax,
               "a sample past its bounds reached the store");
  const absl::StatusOr<KnownRobot*> robot = known_.Robot(of_sample.robot->ruri);
  if (!robot.ok()) return robot.status();
  if (*robot == nullptr || (*robot)->claim != mark.claim) return OutcomeKind::kFenced;
  if (mark.is_question) return OutcomeKind::kDuplicate;
  const absl::StatusOr<KnownSamples*> samples = known_.Samples(of_sample);
  if (!samples.ok()) return samples.status();
  if (IsDuplicate(mark, (*samples)->memory)) return OutcomeKind::kDuplicate;
  storage::Remember(mark, (*samples)->memory);
  (*samples)->is_changed = true;
  (*samples)->stored_at = std::max((*samples)->stored_at, of_sample.received_at);
  return std::nullopt;
}

void Decider::ResumeSample(const CommitRecord& before, const Outcome& outcome) {
  const bool is_over =
      outcome.kind == OutcomeKind::kFenced || outcome.kind == OutcomeKind::kDuplicate;
  sample_ = before.sample.get();
  sample_outcome_ = is_over ? std::optional(outcome.kind) : std::nullopt;
}

absl::StatusOr<std::optional<Outcome>> Decider::Look(const CommitRecord& record) {
  UPLINK_CHECK(record.seq <= model::kSeqMax, "a number past the contract's reached the store");
  if (record.sample != nullptr) {
    if (record.sample.get() != sample_) {
      const absl::StatusOr<std::optional<OutcomeKind>> looked = LookAt(record);
      if (!looked.ok()) return looked.status();
      sample_ = record.sample.get();
      sample_outcome_ = *looked;
    }
    if (!sample_outcome_) return std::optional<Outcome>();
    return Outcome{*sample_outcome_, std::nullopt};
  }
  const absl::StatusOr<bool> over = IsLeaseOver(HoldOf(record.origin));
  if (!over.ok()) return over.status();
  if (*over) return Outcome{OutcomeKind::kFenced, std::nullopt};
  const absl::StatusOr<bool> fenced = IsFenced(record.robot, record.held_since);
  if (!fenced.ok()) return fenced.status();
  if (*fenced) return Outcome{OutcomeKind::kFenced, std::nullopt};
  const absl::StatusOr<KnownSession*> session = known_.Session(record);
  if (!session.ok()) return session.status();
  if (RaiseCursor(**session, record.seq, record.received_at)) return std::optional<Outcome>();

  if (record.seq == 0) return Outcome{OutcomeKind::kDuplicate, std::nullopt};
  absl::StatusOr<std::optional<model::Rejection>> why = known_.Rejected(record);
  if (!why.ok()) return why.status();
  if (!why->has_value()) return Outcome{OutcomeKind::kDuplicate, std::nullopt};
  return Outcome{OutcomeKind::kRefused, *std::move(why)};
}

absl::StatusOr<Ruling> Decider::JudgeRequest(const CommitRecord& record,
                                             const model::OperatorRequest& request) {
  const absl::StatusOr<KnownRobot*> robot = known_.Robot(record.robot->ruri);
  if (!robot.ok()) return robot.status();
  UPLINK_CHECK(*robot != nullptr, "a record of an unknown robot is fenced");
  std::optional<KnownRobot::RequestIds>& open = (*robot)->open_requests;
  if (!open) {
    absl::StatusOr<KnownRobot::RequestIds> read = known_.OpenRequests(record.robot->ruri);
    if (!read.ok()) return read.status();
    open = *std::move(read);
  }
  Ruling ruling;
  ruling.was_present = open->contains(request.request_id);
  if (!request.open) {
    open->erase(request.request_id);
  } else if (!ruling.was_present && open->size() >= kOpenRequestsPerRobotMax) {
    ruling.refusal = TooManyOpenRequests();
  } else {
    open->insert(request.request_id);
  }
  return ruling;
}

absl::StatusOr<Ruling> Decider::Judge(const CommitRecord& record) {
  if (const auto* request = std::get_if<model::OperatorRequest>(&record.content)) {
    return JudgeRequest(record, *request);
  }
  Ruling ruling;
  ruling.change = PresentChangeOf(record, rules_);
  if (!ruling.change) return ruling;
  const PresentKey& key = ruling.change->key;
  const absl::StatusOr<KnownRobot*> robot = known_.Robot(record.robot->ruri);
  if (!robot.ok()) return robot.status();
  UPLINK_CHECK(*robot != nullptr, "a record of an unknown robot is fenced");
  const absl::StatusOr<std::optional<std::int64_t>> there = known_.ExpiryOf(key);
  if (!there.ok()) return there.status();
  ruling.was_present = there->has_value();
  if (ruling.change->is_upsert) {
    const absl::StatusOr<bool> room = MakeRoom(*ruling.change, **robot, *there, record.received_at);
    if (!room.ok()) return room.status();
    if (!*room) ruling.refusal = BoundOf(key.kind).refusal();
    return ruling;
  }
  std::optional<std::size_t>& count = (*robot)->counts[static_cast<std::size_t>(key.kind)];
  if (ruling.was_present && count) --*count;
  return ruling;
}

absl::StatusOr<bool> Decider::MakeRoom(const PresentChange& change, KnownRobot& robot,
                                       const std::optional<std::int64_t>& there, SystemTime now) {
  const PresentKey& key = change.key;
  const PresentBound& bound = BoundOf(key.kind);
  const std::int64_t now_ms = bound.expires ? ExpiredByMs(now, rules_) : 0;
  if (there && !IsExpired(*there, now_ms)) return true;
  std::optional<std::size_t>& count = robot.counts[static_cast<std::size_t>(key.kind)];
  if (there) {
    absl::Status deleted = known_.Delete(key);
    if (!deleted.ok()) return deleted;
    if (count) --*count;
  }
  if (!count) {
    const absl::StatusOr<std::size_t> counted = known_.Count(key.kind, key.ruri);
    if (!counted.ok()) return counted.status();
    count = *counted;
  }
  if (*count >= bound.entries_max && bound.expires) {
    const absl::StatusOr<std::size_t> expired = known_.DeleteExpired(key.kind, key.ruri, now_ms);
    if (!expired.ok()) return expired.status();
    *count -= *expired;
  }
  if (*count >= bound.entries_max) return false;
  ++*count;
  return true;
}

absl::StatusOr<bool> Decider::Takes(const GapItem& gap) {
  const absl::StatusOr<bool> fenced = IsFenced(gap.robot, gap.held_since);
  if (!fenced.ok()) return fenced.status();
  return !*fenced;
}

absl::StatusOr<OutcomeKind> Decider::Decide(const PresenceItem& item, KnownSession& session) {
  const absl::StatusOr<bool> fenced = IsFenced(item.robot, item.held_since);
  if (!fenced.ok()) return fenced.status();
  if (*fenced) return OutcomeKind::kFenced;
  return RaiseCursor(session, item.number, item.at) ? OutcomeKind::kStored
                                                    : OutcomeKind::kDuplicate;
}

}  // namespace uplink::storage
