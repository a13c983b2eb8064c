#include "server/journal/claiming.h"

#include <utility>

#include "schema/base/check.h"
#include "server/journal/kept_out.h"
#include "server/robot/mutation.h"
#include "storage/store.h"

namespace uplink::journal {

Claiming::Claiming(const WriterContext& context, Holds& holds)
    : context_(context), holds_(holds), size_({.most = storage::kClaimsMax, .halved_from = 2}) {}

std::optional<Step> Claiming::Advance() {
  claiming_ = context_.inbox.TakeClaims(std::move(claiming_), size_.now());
  if (claiming_.empty()) return std::nullopt;
  const bool answered = TakeOutKeptOut();
  if (claiming_.empty()) return answered ? Step::kWorked : Step::kFailed;
  std::vector<storage::ClaimRequest> requests;
  requests.reserve(claiming_.size());
  for (const ClaimEntry& claim : claiming_) requests.push_back(claim.request);
  const auto results = context_.store.ClaimDrones(requests);
  context_.errors.NoteCall(results.status());
  if (!results.ok()) {
    if (size_.Failed(claiming_.size())) {
      context_.inbox.PutBackClaims(TakeRest(claiming_, size_.now()));
    }
    return Step::kFailed;
  }
  size_.Succeeded();
  UPLINK_CHECK(results->size() == claiming_.size(), "the store answers every claim");
  std::erase_if(claimed_, [](const auto& drone) { return drone.second.expired(); });
  const std::vector<ClaimEntry> claimed = std::exchange(claiming_, {});
  for (std::size_t i = 0; i < claimed.size(); ++i) Tell(claimed[i], (*results)[i]);
  context_.inbox.CountClaimed(claimed.size());
  return Step::kWorked;
}

bool Claiming::TakeOutKeptOut() {
  auto [wait, refused] =
      TakeKeptOut(claiming_, [](const ClaimEntry& entry) { return entry.robot->registration(); });
  // Without a claim; the calls that are woken find that their robot is refused.
  for (const ClaimEntry& entry : refused) entry.client->OnClaimed({}).Wake();
  context_.inbox.CountClaimed(refused.size());
  context_.inbox.PutBackClaims(std::move(wait));
  return !refused.empty();
}

void Claiming::Tell(const ClaimEntry& claim, const storage::ClaimResult& result) {
  const storage::RobotRef& robot = claim.request.robot;
  if (!result.other_fleet) {
    claimed_[robot->ruri] = claim.client->weak_from_this();
    TellMove(context_, *robot, result.moved_from, claim.gateway);
    if (result.held_since != 0) {
      holds_
          .Begin(*claim.robot, robot,
                 {.how = robot::HoldBegan::kOpened,
                  .since = result.held_since,
                  .presence = result.presence,
                  .was_known = result.was_known})
          .stream.Wake();
    } else if (holds_.robots().Since(*claim.robot) != 0) {
      holds_.Lose(*claim.robot, robot).Wake();
    } else {
      claim.robot->OnHeldElsewhere(result.presence);
    }
  }
  // Last, since the drone looks at what its robot was told.
  claim.client->OnClaimed(result).Wake();
}

void Claiming::DoubtAll() {
  if (robot::Planted(robot::Mutation::kReconnectTrusted)) return;
  for (const auto& [ruri, drone] : std::exchange(claimed_, {})) {
    if (const auto client = drone.lock()) client->OnDoubted().Wake();
  }
}

}  // namespace uplink::journal
