#include "storage/postgres/write/holds.h"

#include <map>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "schema/base/check.h"
#include "storage/postgres/write/transaction.h"
#include "storage/read_row.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kReadPresence =
    "SELECT ruri, presence, changed_at, parked_until FROM uplinkd.presence_latest"
    " WHERE ruri = ANY($1::text[])";

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

constexpr std::string_view kHolds =
    "SELECT u.place, r.owner = $3::uuid AND r.held_since = u.held, r.held_since < u.held,"
    " r.held_since > u.held"
    " FROM unnest($1::text[], $2::bigint[]) WITH ORDINALITY AS u (ruri, held, place)"
    " JOIN uplinkd.robots AS r ON r.ruri = u.ruri";
// A session's row is looked for as in known.cc.
constexpr std::string_view kBehind =
    "SELECT u.place FROM unnest($1::text[], $2::uuid[], $3::bigint[], $4::bigint[])"
    " AS u (ruri, session, told, place) LEFT JOIN LATERAL (SELECT l.cursor_seq"
    " FROM uplinkd.sessions AS l WHERE l.ruri = u.ruri AND l.session = u.session"
    " ORDER BY l.part DESC LIMIT 1) AS s ON true WHERE coalesce(s.cursor_seq, 0) < u.told";

}  // namespace

StoreCall ReadPresenceCall(std::span<const std::string_view> ruris) {
  Array array{Type::kText};
  for (const std::string_view ruri : ruris) array.Text(ruri);
  return StoreCallOf(kReadPresence, &array);
}

void TakePresence(const Result& rows,
                  const std::function<void(std::string_view ruri, StoredPresence)>& take) {
  for (const ResultRow& row : rows) {
    take(row.Bytes(0), *PresenceIn(row, 1));
  }
}

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
  calls.push_back(StoreCallOf(kAdopt, &ruri, &holder, &counter, process, &silent));
  calls.push_back(ReadPresenceCall(ruris));
  const auto answers = RunAndCommitFor(connection, std::move(calls), "adopt robots", before_commit);
  if (!answers.ok()) return Decisive(answers.status());
  std::vector<AdoptResult> results(requests.size());
  const auto result_of = [&](std::string_view name) -> AdoptResult& {
    const auto place = places.find(name);
    UPLINK_CHECK(place != places.end(), "an answer of a robot that was not asked for");
    return results[place->second];
  };
  for (const ResultRow& row : (*answers)[first]) {
    AdoptResult& result = result_of(row.Bytes(0));
    result.held_since = static_cast<Epoch>(row.Int(1));
    result.end = row.Bool(2) ? HolderEnd::kSilent : HolderEnd::kEnded;
  }
  TakePresence((*answers)[first + 1], [&](std::string_view name, StoredPresence presence) {
    AdoptResult& result = result_of(name);
    if (result.held_since) result.presence = presence;
  });
  return results;
}

absl::StatusOr<std::vector<FoundRobot>> CompareAll(Connection& connection,
                                                   std::span<const ToldRobot> robots,
                                                   const ProcessId& process) {
  std::vector<FoundRobot> found(robots.size());
  if (robots.empty()) return found;
  Array ruri{Type::kText}, held{Type::kInt8};
  Array session_ruri{Type::kText}, session{Type::kUuid}, told{Type::kInt8}, place{Type::kInt8};
  std::vector<std::string_view> ruris;
  std::unordered_map<std::string_view, std::size_t> places;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    ruri.Text(robots[i].ruri);
    held.Int8(static_cast<std::int64_t>(robots[i].held_since));
    ruris.emplace_back(robots[i].ruri);
    places.emplace(robots[i].ruri, i);
    for (const CommittedSession& committed : robots[i].sessions) {
      session_ruri.Text(robots[i].ruri);
      session.Uuid(committed.session);
      told.Int8(static_cast<std::int64_t>(committed.cursor));
      place.Int8(static_cast<std::int64_t>(i));
    }
  }
  const auto answers =
      connection.Run(PipelineOf(StoreCallOf(kHolds, &ruri, &held, process),
                                StoreCallOf(kBehind, &session_ruri, &session, &told, &place),
                                ReadPresenceCall(ruris)),
                     "compare what was told");
  if (!answers.ok()) return answers.status();
  std::vector<bool> later(robots.size());
  for (const ResultRow& row : (*answers)[0]) {
    const std::size_t at = static_cast<std::size_t>(row.Int(0)) - 1;
    found[at].held = row.Bool(1);
    found[at].went_back = row.Bool(2);
    later[at] = row.Bool(3);
  }
  for (const ResultRow& row : (*answers)[1]) {
    const auto at = static_cast<std::size_t>(row.Int(0));
    if (!later[at]) found[at].went_back = true;
  }
  TakePresence((*answers)[2], [&](std::string_view name, StoredPresence presence) {
    FoundRobot& robot = found[places.at(name)];
    if (robot.held) robot.presence = presence;
  });
  return found;
}

}  // namespace uplink::storage::postgres
