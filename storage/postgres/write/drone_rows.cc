#include "storage/postgres/write/drone_rows.h"

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "storage/bounds.h"
#include "storage/postgres/tables/insert.h"
#include "storage/tables/samples.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kUseClaims =
    "UPDATE uplinkd.drone_claims AS c SET last_used = greatest(c.last_used, u.used)"
    " FROM unnest($1::text[], $2::timestamptz[]) AS u (ruri, used) WHERE c.ruri = u.ruri";
constexpr std::string_view kClose =
    "UPDATE uplinkd.operator_requests AS t SET is_open = false, closed_at = u.closed_at"
    " FROM unnest($1::text[], $2::text[], $3::timestamptz[]) AS u (ruri, request_id, closed_at)"
    " WHERE t.ruri = u.ruri AND t.request_id = u.request_id AND t.is_open";
// Of each robot the oldest closed ones over the bound.
constexpr std::string_view kTrim =
    "DELETE FROM uplinkd.operator_requests AS t USING unnest($1::text[]) AS u (ruri)"
    " CROSS JOIN LATERAL (SELECT p.opened_at, p.entry FROM uplinkd.operator_requests AS p"
    " WHERE p.ruri = u.ruri AND NOT p.is_open ORDER BY p.opened_at DESC, p.entry DESC"
    " OFFSET $2::bigint) AS old"
    " WHERE t.ruri = u.ruri AND t.opened_at = old.opened_at AND t.entry = old.entry";

std::string_view RuriOf(const OpenedRequest& change) { return change.record->robot->ruri; }

/// Changes that name each request once, in any order.
void AddChanges(std::span<const OpenedRequest> changes, std::vector<StoreCall>& calls) {
  std::vector<OpenedRequest> opened;
  Array ruri{Type::kText}, id{Type::kText}, at{Type::kTime};
  for (const OpenedRequest& change : changes) {
    if (change.body->open) {
      opened.push_back(change);
      continue;
    }
    ruri.Text(RuriOf(change));
    id.Text(change.body->request_id);
    at.Time(change.record->received_at);
  }
  if (ruri.size() > 0) calls.push_back(StoreCallOf(kClose, &ruri, &id, &at));
  AddInsert<kOperatorRequestsTable>(opened, calls);
}

}  // namespace

void DroneRows::AddSamples(std::vector<StoreCall>& calls) const {
  if (kept_.empty()) return;
  std::vector<KeptSamples> rows;
  rows.reserve(kept_.size());
  std::map<std::string_view, SystemTime> used;
  for (const auto& [ruri, samples] : kept_) {
    rows.emplace_back(ruri, samples->memory);
    used[ruri] = std::max(used[ruri], samples->stored_at);
  }
  AddInsert<kSamplesTable>(rows, calls);
  Array ruri{Type::kText}, at{Type::kTime};
  for (const auto& [name, time] : used) {
    ruri.Text(name);
    at.Time(time);
  }
  calls.push_back(StoreCallOf(kUseClaims, &ruri, &at));
}

void DroneRows::AddRequests(std::vector<StoreCall>& calls) const {
  if (requests_.empty()) return;
  // What changes twice in the batch does so in statements that follow one another.
  std::set<std::pair<std::string_view, std::string_view>> named;
  std::set<std::string_view> robots;
  std::size_t first = 0;
  for (std::size_t i = 0; i < requests_.size(); ++i) {
    const OpenedRequest& change = requests_[i];
    robots.insert(RuriOf(change));
    if (named.emplace(RuriOf(change), change.body->request_id).second) continue;
    AddChanges(std::span(requests_).subspan(first, i - first), calls);
    first = i;
    named.clear();
    named.emplace(RuriOf(change), change.body->request_id);
  }
  AddChanges(std::span(requests_).subspan(first), calls);
  Array ruri{Type::kText};
  for (const std::string_view robot : robots) ruri.Text(robot);
  calls.push_back(StoreCallOf(kTrim, &ruri, kClosedRequestsPerRobotMax));
}

void DroneRows::MoveInto(std::vector<StoreCall>& calls) const {
  AddSamples(calls);
  AddRequests(calls);
}

}  // namespace uplink::storage::postgres
