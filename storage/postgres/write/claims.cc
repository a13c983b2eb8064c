#include "storage/postgres/write/claims.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "schema/base/check.h"
#include "storage/postgres/write/holds.h"
#include "storage/postgres/write/transaction.h"
#include "storage/read_row.h"

namespace uplink::storage::postgres {
namespace {

// A row that is there is locked, and not changed. A new one has epoch 0, which says that it is new.
constexpr std::string_view kLockRobots =
    "INSERT INTO uplinkd.robots AS r (ruri, fleet, epoch, held_since, owner, first_seen, last_seen)"
    " SELECT ruri, fleet, 0, 0, $4::uuid, seen_at, seen_at"
    " FROM unnest($1::text[], $2::text[], $3::timestamptz[]) AS u (ruri, fleet, seen_at)"
    " ON CONFLICT (ruri) DO UPDATE SET last_seen = r.last_seen WHERE false"
    " RETURNING ruri";
// A statement of its own, which sees what was committed until the locks were there. A robot is
// taken from a process that has a lease and did not release it only where its last presence is
// offline (model::Presence), and no stream was opened since. Epochs are drawn as in open_calls.cc.
constexpr std::string_view kTakeRobots =
    "UPDATE uplinkd.robots AS r SET fleet = u.fleet, (epoch, held_since) = (SELECT d.epoch,"
    " CASE WHEN r.owner = $4::uuid AND r.epoch <> 0 THEN r.held_since ELSE d.epoch END"
    " FROM (SELECT greatest(nextval('uplinkd.epochs'), r.epoch + 1) AS epoch) AS d),"
    " owner = $4::uuid, last_seen = greatest(r.last_seen, u.seen_at)"
    " FROM unnest($1::text[], $2::text[], $3::timestamptz[]) AS u (ruri, fleet, seen_at)"
    " WHERE r.ruri = u.ruri"
    // A word that moves nothing ($5) stands for no robot of another fleet.
    " AND NOT (r.fleet <> u.fleet AND r.ruri = ANY ($5::text[]))"
    " AND (r.owner = $4::uuid"
    " OR NOT EXISTS (SELECT 1 FROM uplinkd.processes AS p"
    " WHERE p.process = r.owner AND NOT p.released)"
    " OR EXISTS (SELECT 1 FROM uplinkd.presence_latest AS l"
    " WHERE l.ruri = r.ruri AND l.presence = 2 AND l.changed_at >= r.last_seen))"
    " RETURNING r.ruri, r.held_since,"
    " (SELECT o.fleet FROM uplinkd.robots AS o WHERE o.ruri = r.ruri)";
// Of robots that are of their requests' fleets by now.
constexpr std::string_view kClaim =
    "INSERT INTO uplinkd.drone_claims AS c (ruri, owner, epoch, last_used)"
    " SELECT r.ruri, $4::uuid, greatest(nextval('uplinkd.epochs'), r.epoch + 1), u.seen_at"
    " FROM unnest($1::text[], $2::text[], $3::timestamptz[]) AS u (ruri, fleet, seen_at)"
    " JOIN uplinkd.robots AS r ON r.ruri = u.ruri AND r.fleet = u.fleet"
    " ON CONFLICT (ruri) DO UPDATE SET owner = excluded.owner,"
    " epoch = greatest(excluded.epoch, c.epoch + 1),"
    " last_used = greatest(c.last_used, excluded.last_used)"
    " RETURNING c.ruri, c.epoch";
constexpr std::string_view kReadFleets =
    "SELECT ruri, fleet FROM uplinkd.robots WHERE ruri = ANY ($1::text[])";
constexpr std::string_view kReadLatestKinds =
    "SELECT ruri, kind FROM uplinkd.latest WHERE ruri = ANY ($1::text[])";
constexpr std::string_view kReadSamples =
    "SELECT ruri, type, digests, last FROM uplinkd.samples WHERE ruri = ANY ($1::text[])"
    " ORDER BY ruri, type";

/// The place of each statement's answer.
enum ClaimAnswer : std::size_t {
  kNewAnswer = 0,
  kTakenAnswer = 1,
  kClaimAnswer = 2,
  kFleetAnswer = 3,
  kPresenceAnswer = 4,
  kLatestAnswer = 5,
  kSamplesAnswer = 6,
};

/// Requests by RURI: their places.
using Places = std::map<std::string_view, std::size_t>;

std::vector<StoreCall> CallsOf(const Places& places, std::span<const ClaimRequest> requests,
                               const ProcessId& process) {
  std::vector<std::string_view> ruris;
  const auto column = [&](Type type, const auto& add) {
    Array array{type};
    for (const auto& [ruri, place] : places) add(array, requests[place]);
    return array;
  };
  const auto names = [&] {
    return column(Type::kText, [](Array& array, const ClaimRequest& request) {
      array.Text(request.robot->ruri);
    });
  };
  const auto fleets = [&] {
    return column(Type::kText, [](Array& array, const ClaimRequest& request) {
      array.Text(request.robot->fleet);
    });
  };
  const auto times = [&] {
    return column(Type::kTime,
                  [](Array& array, const ClaimRequest& request) { array.Time(request.at); });
  };
  const auto matched = [&] {
    return column(Type::kText, [](Array& array, const ClaimRequest& request) {
      if (request.fleet_word == FleetWord::kMatches) array.Text(request.robot->ruri);
    });
  };
  for (const auto& [ruri, place] : places) ruris.push_back(ruri);
  return PipelineOf(StoreCallOf(kLockRobots, names(), fleets(), times(), process),
                    StoreCallOf(kTakeRobots, names(), fleets(), times(), process, matched()),
                    StoreCallOf(kClaim, names(), fleets(), times(), process),
                    StoreCallOf(kReadFleets, names()), ReadPresenceCall(ruris),
                    StoreCallOf(kReadLatestKinds, names()), StoreCallOf(kReadSamples, names()));
}

/// Drones that are claimed have their claim, and of what fleet the others are.
void TakeClaims(std::span<const Result> answers, std::span<const ClaimRequest> requests,
                const Places& places, std::vector<ClaimResult>& results) {
  const auto place_of = [&](const ResultRow& row) {
    const auto place = places.find(row.Bytes(0));
    UPLINK_CHECK(place != places.end(), "an answer of a robot that was not asked for");
    return place->second;
  };
  for (ClaimResult& result : results) result.was_known = true;
  for (const ResultRow& row : answers[kNewAnswer]) results[place_of(row)].was_known = false;
  for (const ResultRow& row : answers[kTakenAnswer]) {
    const std::size_t place = place_of(row);
    results[place].held_since = NumberIn(row, 1);
    if (row.Bytes(2) != requests[place].robot->fleet) results[place].moved_from = TextIn(row, 2);
  }
  for (const ResultRow& row : answers[kClaimAnswer]) {
    results[place_of(row)].claim = NumberIn(row, 1);
  }
  for (const ResultRow& row : answers[kFleetAnswer]) {
    ClaimResult& result = results[place_of(row)];
    if (result.claim != 0) continue;
    result = {};
    result.other_fleet = TextIn(row, 1);
  }
}

void TakeRest(std::span<const Result> answers, const Places& places,
              std::vector<ClaimResult>& results) {
  /// Null for one that is not claimed.
  const auto claimed = [&](std::string_view ruri) {
    ClaimResult& result = results[places.at(ruri)];
    return result.claim != 0 ? &result : nullptr;
  };
  TakePresence(answers[kPresenceAnswer], [&](std::string_view ruri, StoredPresence presence) {
    if (ClaimResult* const result = claimed(ruri)) result->presence = presence;
  });
  for (const ResultRow& row : answers[kLatestAnswer]) {
    if (ClaimResult* const result = claimed(row.Bytes(0))) {
      result->latest_kinds |= BitOf(static_cast<LatestKind>(row.Int(1)));
    }
  }
  for (const ResultRow& row : answers[kSamplesAnswer]) {
    if (ClaimResult* const result = claimed(row.Bytes(0))) {
      result->samples.push_back(SamplesIn(row, 1));
    }
  }
}

}  // namespace

absl::StatusOr<std::vector<ClaimResult>> ClaimAll(
    Connection& connection, std::span<const ClaimRequest> requests, const ProcessId& process,
    const std::function<absl::Status()>& before_commit) {
  UPLINK_CHECK(requests.size() <= kClaimsMax, "a call claims more drones than it may");
  Places places;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const bool first = places.emplace(requests[i].robot->ruri, i).second;
    UPLINK_CHECK(first, "a drone is claimed once in a call");
  }
  std::vector<StoreCall> calls = BeginCalls();
  const std::size_t first = calls.size();
  std::ranges::move(CallsOf(places, requests, process), std::back_inserter(calls));
  const auto answers = RunAndCommitFor(connection, std::move(calls), "claim drones", before_commit);
  if (!answers.ok()) return Decisive(answers.status());
  std::vector<ClaimResult> results(requests.size());
  TakeClaims(std::span(*answers).subspan(first), requests, places, results);
  TakeRest(std::span(*answers).subspan(first), places, results);
  return results;
}

}  // namespace uplink::storage::postgres
