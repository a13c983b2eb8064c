#include "storage/postgres/compare.h"

#include <string_view>
#include <unordered_map>
#include <utility>

#include "storage/postgres/write/stored_presence.h"

namespace uplink::storage::postgres {
namespace {

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
  std::vector<StoreCall> calls;
  calls.push_back(StoreCallOf(kHolds, {&ruri, &held}));
  calls.back().parameters.Uuid(model::SessionId(process));
  calls.push_back(StoreCallOf(kBehind, {&session_ruri, &session, &told, &place}));
  calls.push_back(ReadPresenceCall(ruris));
  const auto answers = connection.Run(calls, "compare what was told");
  if (!answers.ok()) return answers.status();
  std::vector<bool> later(robots.size());
  for (int row = 0; row < (*answers)[0].rows(); ++row) {
    const Result& holds = (*answers)[0];
    const std::size_t at = static_cast<std::size_t>(holds.Int(row, 0)) - 1;
    FoundRobot& robot = found[at];
    later[at] = holds.Bool(row, 3);
    robot.held = holds.Bool(row, 1);
    robot.went_back = holds.Bool(row, 2);
  }
  for (int row = 0; row < (*answers)[1].rows(); ++row) {
    const auto at = static_cast<std::size_t>((*answers)[1].Int(row, 0));
    if (!later[at]) found[at].went_back = true;
  }
  TakePresence((*answers)[2], [&](std::string_view name, StoredPresence presence) {
    FoundRobot& robot = found[places.at(name)];
    if (robot.held) robot.presence = presence;
  });
  return found;
}

}  // namespace uplink::storage::postgres
