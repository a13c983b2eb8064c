#include <algorithm>
#include <mutex>
#include <optional>

#include "tests/support/fake_database.h"

namespace uplink::testing {

using storage::CommitRecord;
using storage::OutcomeKind;
using storage::ProcessId;

std::vector<storage::ClaimResult> FakeDatabase::ClaimDrones(
    const ProcessId& process, std::span<const storage::ClaimRequest> requests) {
  const std::lock_guard lock(mutex_);
  std::vector<storage::ClaimResult> results;
  results.reserve(requests.size());
  for (const storage::ClaimRequest& request : requests) {
    results.push_back(ClaimOne(process, request));
  }
  return results;
}

bool FakeDatabase::MayHold(const ProcessId& process, const Robot& robot) const {
  if (robot.epoch == 0 || robot.owner == process || !leases_.Stands(robot.owner)) return true;
  const std::optional<storage::StoredPresence> presence = presence_.Last(robot.id.ruri);
  return presence && presence->presence == model::Presence::kOffline &&
         presence->since >= robot.last_opened;
}

storage::ClaimResult FakeDatabase::ClaimOne(const ProcessId& process,
                                            const storage::ClaimRequest& request) {
  Robot& robot = robots_[request.robot->ruri];
  const bool was_known = robot.epoch != 0;
  const bool moves = was_known && robot.id.fleet != request.robot->fleet;
  const bool holds = MayHold(process, robot);
  storage::ClaimResult result;
  if (moves && (request.fleet_word == storage::FleetWord::kMatches || !holds)) {
    result.other_fleet = robot.id.fleet;
    return result;
  }
  if (!was_known) {
    robot.first_seen = robot.last_seen = request.at;
    robot.last_opened = {};
  }
  if (moves) result.moved_from = robot.id.fleet;
  if (moves) MoveItems(robot, *request.robot);
  robot.id = *request.robot;
  robot.last_seen = std::max(robot.last_seen, request.at);
  if (holds) {
    robot.last_opened = std::max(robot.last_opened, request.at);
    robot.epoch = DrawEpoch(robot);
    if (!was_known || robot.owner != process) {
      robot.owner = process;
      robot.held_since = robot.epoch;
    }
    result.held_since = robot.held_since;
  }
  if (forgets_samples_) {
    for (auto& [type, memory] : robot.samples) memory.digests.clear();
  }
  result.claim = ++epochs_;
  robot.claim = storage::RobotHold{process, result.claim};
  result.was_known = was_known;
  result.presence = presence_.Last(request.robot->ruri);
  result.latest_kinds = kinds_.LatestKinds(request.robot->ruri);
  for (const auto& [type, memory] : robot.samples) result.samples.push_back(memory);
  return result;
}

std::optional<OutcomeKind> FakeDatabase::LookAtSample(const Transaction& transaction,
                                                      const CommitRecord& record) {
  const storage::SampleMark& mark = *record.sample;
  Robot* const robot = FindRobot(record.robot->ruri);
  if (robot == nullptr) return OutcomeKind::kFenced;
  const bool is_claimed = robot->claim == storage::RobotHold{transaction.process, mark.claim};
  if (!is_claimed && !transaction.rules.samples_without_claim) return OutcomeKind::kFenced;
  if (mark.is_question) return OutcomeKind::kDuplicate;
  storage::SampleMemory& memory = robot->samples[mark.type];
  memory.type = mark.type;
  if (storage::IsDuplicate(mark, memory)) return OutcomeKind::kDuplicate;
  storage::Remember(mark, memory);
  return std::nullopt;
}

}  // namespace uplink::testing
