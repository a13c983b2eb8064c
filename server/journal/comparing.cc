#include "server/journal/comparing.h"

#include <algorithm>
#include <vector>

#include "schema/base/check.h"
#include "server/robot/mutation.h"
#include "storage/store.h"

namespace uplink::journal {

using robot::Mutation;
using robot::Planted;

bool Comparing::Due() {
  if (context_.store.InDoubt()) return true;
  if (server_run_.empty()) server_run_ = context_.store.ServerRun();
  return false;
}

std::optional<Step> Comparing::Do() {
  const absl::StatusOr<Reconnected> compared = CompareAll();
  context_.errors.NoteCompare(compared.status());
  if (!compared.ok()) return Step::kFailed;
  server_run_ = context_.store.ServerRun();
  // First: listeners that remember more of the store than its robots must forget that before the
  // next commit is reported.
  if (context_.store_reconnected) context_.store_reconnected(*compared);
  context_.store.EndDoubt();
  return std::nullopt;
}

Reconnected Comparing::ConnectedTo() const {
  const std::string now = context_.store.ServerRun();
  return !now.empty() && now == server_run_ ? Reconnected::kSameServer
                                            : Reconnected::kMayHaveGoneBack;
}

absl::StatusOr<Reconnected> Comparing::CompareAll() {
  const std::vector<storage::ToldRobot> told =
      Planted(Mutation::kReconnectTrusted) ? std::vector<storage::ToldRobot>() : holds_.ToldOfAll();
  std::size_t first = 0;
  Reconnected to = Reconnected::kMayHaveGoneBack;
  // At least once, since this call connects.
  do {
    const auto page =
        std::span(told).subspan(first, std::min(told.size() - first, storage::kComparedMax));
    const auto found = context_.store.Compare(page);
    if (!found.ok()) return found.status();
    UPLINK_CHECK(found->size() == page.size(), "the store answers for every robot");
    to = ConnectedTo();
    for (std::size_t i = 0; i < page.size(); ++i) Follow(page[i], (*found)[i], to);
    first += page.size();
  } while (first < told.size());
  return to;
}

void Comparing::Follow(const storage::ToldRobot& told, const storage::FoundRobot& found,
                       Reconnected to) {
  bool went_back = found.went_back;
  if (!found.held) {
    holds_.LoseSince(told.ruri, told.held_since).Wake();
  } else {
    went_back = holds_.FollowPresence(told.ruri, found.presence, to) || went_back;
    if (found.went_back) holds_.WentBack(told.ruri).Wake();
  }
  if (went_back) context_.went_back.Note(told.ruri, context_.clock.Steady());
}

}  // namespace uplink::journal
