#include "server/journal/opening.h"

#include <algorithm>
#include <utility>

#include "schema/base/check.h"
#include "server/journal/kept_out.h"
#include "server/robot/mutation.h"
#include "storage/store.h"

namespace uplink::journal {
namespace {

/// Whether the store has less of the session than it confirmed.
bool HasLess(const robot::CommitClient& client, const model::SessionId& session,
             model::Seq cursor) {
  if (robot::Planted(robot::Mutation::kReconnectTrusted)) return false;
  return std::ranges::any_of(client.Committed(), [&](const storage::CommittedSession& told) {
    return told.session == session && told.cursor > cursor;
  });
}

}  // namespace

Opening::Opening(const WriterContext& context, Holds& holds)
    : context_(context), holds_(holds), size_({.most = kOpensPerCallMax, .halved_from = 2}) {}

Opening::Gathered Opening::Gather() {
  WriterInbox::TakenOpens taken = context_.inbox.TakeOpens(std::move(opening_), size_.now());
  opening_ = std::move(taken.opens);
  return {.opens = !opening_.empty(), .records_wait = taken.records_wait};
}

bool Opening::TakeOutKeptOut() {
  auto [wait, refused] =
      TakeKeptOut(opening_, [](const OpenEntry& entry) { return entry.client->registration(); });
  for (const OpenEntry& entry : refused) {
    entry.client->OnRefused(context_.ledger).Wake();
    context_.inbox.LosePresence(entry.request.robot->ruri);
  }
  context_.inbox.CountOpened(refused.size());
  context_.inbox.PutBackOpens(std::move(wait));
  return !refused.empty();
}

Step Opening::Open() {
  const bool ended = TakeOutKeptOut();
  if (opening_.empty()) return ended ? Step::kWorked : Step::kFailed;
  std::vector<storage::OpenRequest> requests;
  requests.reserve(opening_.size());
  for (const OpenEntry& entry : opening_) {
    requests.push_back(entry.request);
    if (!entry.client->HasStream()) requests.back().stream = storage::StreamState::kEnded;
  }
  const auto results = context_.store.OpenStreams(requests);
  context_.errors.NoteCall(results.status());
  if (!results.ok()) {
    if (size_.Failed(opening_.size())) {
      context_.inbox.PutBackOpens(TakeRest(opening_, size_.now()));
    }
    return Step::kFailed;
  }
  size_.Succeeded();
  UPLINK_CHECK(results->size() == opening_.size(), "the store answers every OpenStream");
  const std::vector<OpenEntry> opened = std::exchange(opening_, {});
  std::vector<OpenEntry> again;
  for (std::size_t i = 0; i < opened.size(); ++i) {
    const storage::OpenResult& result = (*results)[i];
    // For a stream that came meanwhile and may not have asked for itself: records may wait.
    if (!result.taken && !result.other_fleet && opened[i].client->HasStream()) {
      again.push_back(opened[i]);
    } else {
      Tell(opened[i], result);
    }
  }
  context_.inbox.CountOpened(opened.size() - again.size());
  context_.inbox.PutBackOpens(std::move(again));
  return Step::kWorked;
}

void Opening::Tell(const OpenEntry& open, const storage::OpenResult& result) {
  if (result.other_fleet) {
    return open.client->OnOtherFleet(open.open_id, *result.other_fleet, context_.ledger).Wake();
  }
  TellMove(context_, *open.request.robot, result.moved_from, open.gateway);
  if (!result.taken) return holds_.Lose(*open.client, open.request.robot).Wake();
  const Holds::BeginResult begun = holds_.Begin(*open.client, open.request.robot,
                                                {.how = robot::HoldBegan::kOpened,
                                                 .since = result.held_since,
                                                 .presence = result.presence,
                                                 .was_known = result.was_known});
  if (begun.interrupted) return begun.stream.Wake();
  if (HasLess(*open.client, open.request.session, result.cursor)) {
    context_.went_back.Note(open.request.robot->ruri, context_.clock.Steady());
    return holds_.WentBack(open.request.robot->ruri).Wake();
  }
  open.client->OnOpened(open.open_id, result).Wake();
}

}  // namespace uplink::journal
