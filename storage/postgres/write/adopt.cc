#include "storage/postgres/write/adopt.h"

#include <map>
#include <string_view>
#include <utility>

#include "schema/base/check.h"
#include "storage/postgres/write/stored_presence.h"
#include "storage/postgres/write/transaction.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kDoing = "adopt robots";

// In order of the keys, as every transaction locks robots. A row that another changed while this
// waited for it is looked at again as it stands then, so one of several processes succeeds.
constexpr std::string_view kAdopt =
    "WITH over AS (SELECT r.ruri FROM unnest($1::text[], $2::uuid[], $3::bigint[])"
    " AS u (ruri, holder, counter) JOIN uplinkd.robots AS r ON r.ruri = u.ruri"
    " WHERE r.owner = $4::uuid OR (r.owner = u.holder AND NOT EXISTS (SELECT 1"
    " FROM uplinkd.processes AS p WHERE p.process = u.holder AND p.counter <> u.counter))"
    " ORDER BY r.ruri FOR NO KEY UPDATE OF r)"
    // The right sides see the row as it was, and the epoch is drawn as in open_streams.cc.
    " UPDATE uplinkd.robots AS r SET (epoch, held_since) = (SELECT"
    " CASE WHEN r.owner = $4::uuid THEN r.epoch ELSE d.epoch END,"
    " CASE WHEN r.owner = $4::uuid THEN r.held_since ELSE d.epoch END"
    " FROM (SELECT greatest(nextval('uplinkd.epochs'), r.epoch + 1) AS epoch) AS d),"
    " holder_silent = r.holder_silent OR (r.owner <> $4::uuid AND r.ruri = ANY ($5::text[])),"
    " owner = $4::uuid FROM over WHERE r.ruri = over.ruri"
    " RETURNING r.ruri, r.held_since, r.holder_silent";

}  // namespace

absl::StatusOr<std::vector<AdoptResult>> AdoptAll(
    Connection& connection, std::span<const AdoptRequest> requests, const ProcessId& process,
    const std::function<absl::Status()>& before_commit) {
  std::map<std::string_view, std::size_t> places;
  Array ruri{Type::kText}, holder{Type::kUuid}, counter{Type::kInt8}, silent{Type::kText};
  std::vector<std::string_view> ruris;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const std::string_view name = requests[i].robot->ruri;
    const bool first = places.emplace(name, i).second;
    UPLINK_CHECK(first, "a robot is adopted once in a call");
    ruri.Text(name);
    holder.Uuid(model::SessionId(requests[i].holder));
    counter.Int8(requests[i].lease_counter);
    if (requests[i].end == HolderEnd::kSilent) silent.Text(name);
    ruris.push_back(name);
  }
  std::vector<StoreCall> calls = BeginCalls();
  const std::size_t first = calls.size();
  calls.push_back(StoreCallOf(kAdopt, {&ruri, &holder, &counter}));
  calls.back().parameters.Uuid(model::SessionId(process));
  calls.back().parameters.Add(std::move(silent));
  calls.push_back(ReadPresenceCall(ruris));
  const auto answers = RunAndCommitFor(connection, std::move(calls), kDoing, before_commit);
  if (!answers.ok()) return Decisive(answers.status());
  std::vector<AdoptResult> results(requests.size());
  const auto result_of = [&](std::string_view name) -> AdoptResult& {
    const auto place = places.find(name);
    UPLINK_CHECK(place != places.end(), "an answer of a robot that was not asked for");
    return results[place->second];
  };
  const Result& adopted = (*answers)[first];
  for (int row = 0; row < adopted.rows(); ++row) {
    AdoptResult& result = result_of(adopted.Bytes(row, 0));
    result.held_since = static_cast<Epoch>(adopted.Int(row, 1));
    result.end = adopted.Bool(row, 2) ? HolderEnd::kSilent : HolderEnd::kEnded;
  }
  TakePresence((*answers)[first + 1], [&](std::string_view name, StoredPresence presence) {
    AdoptResult& result = result_of(name);
    if (result.held_since) result.presence = presence;
  });
  return results;
}

}  // namespace uplink::storage::postgres
