#include "server/journal/adopting.h"

#include <utility>

#include "schema/base/check.h"
#include "storage/store.h"

namespace uplink::journal {

Adopting::Adopting(const WriterContext& context, Holds& holds)
    : context_(context), holds_(holds), size_({.most = kAdoptsPerCallMax, .halved_from = 2}) {}

std::optional<Step> Adopting::Advance() {
  LetGo();
  LetLeave();
  if (adopting_.empty()) adopting_ = context_.inbox.TakeAdopts(size_.now());
  if (adopting_.empty()) return std::nullopt;
  return Adopt();
}

void Adopting::LetGo() {
  for (const LossEntry& loss : context_.inbox.TakeLosses()) {
    const storage::Epoch held_since = holds_.robots().Since(*loss.client);
    if (held_since == 0 || held_since >= loss.since) continue;
    holds_.Lose(*loss.client, loss.robot).Wake();
  }
}

void Adopting::LetLeave() {
  for (const LeaveEntry& leave : context_.inbox.TakeLeaves()) {
    if (!leave.client->MayLeave() || context_.inbox.PresenceWaits(leave.robot->ruri)) continue;
    holds_.Lose(*leave.client, leave.robot).Wake();
    leave.client->OnLeft();
  }
}

Step Adopting::Adopt() {
  std::vector<storage::AdoptRequest> requests;
  requests.reserve(adopting_.size());
  for (const AdoptEntry& entry : adopting_) requests.push_back(entry.request);
  const auto results = context_.store.Adopt(requests);
  context_.errors.NoteDuty(results.status());
  if (!results.ok()) {
    if (size_.Failed(adopting_.size())) {
      for (AdoptEntry& entry : TakeRest(adopting_, size_.now())) {
        context_.inbox.AdoptLater(std::move(entry));
      }
    }
    return Step::kFailed;
  }
  size_.Succeeded();
  UPLINK_CHECK(results->size() == adopting_.size(), "the store answers for every robot");
  const std::vector<AdoptEntry> asked = std::exchange(adopting_, {});
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const storage::AdoptResult& result = (*results)[i];
    if (!result.held_since) continue;
    const Holds::BeginResult begun = holds_.Begin(*asked[i].client, asked[i].request.robot,
                                                  {.how = robot::HoldBegan::kAdopted,
                                                   .since = *result.held_since,
                                                   .presence = result.presence,
                                                   .was_known = true,
                                                   .end = result.end,
                                                   .grace = asked[i].grace.Of(result.end)});
    if (begun.begun) context_.probe.adopted.Add();
    if (begun.interrupted) begun.stream.Wake();
  }
  return Step::kWorked;
}

}  // namespace uplink::journal
