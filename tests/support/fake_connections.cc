#include "tests/support/fake_connections.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <set>
#include <utility>

#include "storage/bounds.h"

namespace uplink::testing {
namespace {

using storage::ConnectionItem;
using storage::ConnectionRow;

ConnectionRow RowOf(const ConnectionItem& item) {
  ConnectionRow row{.robot = *item.robot,
                    .id = item.id,
                    .source = item.source,
                    .began_at = item.began_at,
                    .process = item.process,
                    .server = item.server,
                    .address = item.address,
                    .gateway = item.gateway,
                    .agent_version = item.agent_version,
                    .certificate = item.certificate,
                    .messages = item.messages,
                    .bytes = item.bytes,
                    .takeovers = item.takeovers,
                    .held_back_ms = item.held_back.count(),
                    .held_back_why = item.held_back_why,
                    .ended_at = {},
                    .why = {},
                    .code = {},
                    .detail = {}};
  if (!item.ended) return row;
  row.ended_at = item.ended->at;
  row.why = item.ended->why;
  row.code = item.ended->code;
  row.detail = item.ended->detail;
  return row;
}

}  // namespace

void FakeConnections::Write(const ConnectionItem& item, std::uint64_t entry) {
  const auto there = std::ranges::find_if(rows_, [&](const FakeEntry<ConnectionRow>& known) {
    return known.row.id == item.id && known.row.robot.ruri == item.robot->ruri;
  });
  if (there == rows_.end()) {
    rows_.push_back({item.began_at, entry, RowOf(item)});
    return;
  }
  const bool server_ended = there->row.why == model::ConnectionEnd::kServerEnded;
  const bool goes_on = server_ended && there->row.detail == storage::kServerEndedDetail &&
                       there->row.process == item.process;
  if (there->row.ended_at && !(item.ended ? server_ended : goes_on)) return;
  ConnectionRow row = RowOf(item);
  // What the first write said stays.
  row.robot = there->row.robot;
  row.began_at = there->row.began_at;
  row.source = there->row.source;
  row.process = there->row.process;
  row.server = there->row.server;
  row.address = there->row.address;
  row.gateway = there->row.gateway;
  there->row = std::move(row);
}

void FakeConnections::Trim(const std::string& ruri) {
  // Ended ones before open ones, and the last to go last.
  const auto place = [](const FakeEntry<ConnectionRow>& known) {
    return std::pair(!known.row.ended_at, known.entry);
  };
  std::vector<std::pair<bool, std::uint64_t>> places;
  for (const auto& known : rows_) {
    if (known.row.robot.ruri == ruri) places.push_back(place(known));
  }
  if (places.size() <= storage::kConnectionsPerRobotMax) return;
  std::ranges::sort(places, std::greater());
  const auto goes = places[storage::kConnectionsPerRobotMax];
  std::erase_if(rows_, [&](const auto& known) {
    return known.row.robot.ruri == ruri && place(known) <= goes;
  });
}

void FakeConnections::DeleteAll(const std::string& ruri) {
  std::erase_if(rows_, [&ruri](const auto& known) { return known.row.robot.ruri == ruri; });
}

std::vector<storage::ProcessId> FakeConnections::Processes(const storage::ProcessId& self) const {
  std::set<storage::ProcessId> processes;
  for (const auto& known : rows_) {
    if (!known.row.ended_at && known.row.process != self) processes.insert(known.row.process);
  }
  const auto count = std::min(processes.size(), storage::kOpenProcessesMax);
  return {processes.begin(), std::next(processes.begin(), static_cast<std::ptrdiff_t>(count))};
}

std::size_t FakeConnections::End(const storage::ProcessId& process, SystemTime at) {
  std::size_t ended = 0;
  for (auto& known : rows_) {
    if (known.row.ended_at || known.row.process != process) continue;
    if (ended == storage::kSweepRowsMax) break;
    known.row.ended_at = std::max(known.row.began_at, at);
    known.row.why = model::ConnectionEnd::kServerEnded;
    known.row.detail = storage::kServerEndedDetail;
    ++ended;
  }
  return ended;
}

std::size_t FakeConnections::EraseHistory(SystemTime until) {
  return std::erase_if(rows_, [until](const auto& known) {
    return known.at < until && known.row.ended_at && *known.row.ended_at < until;
  });
}

}  // namespace uplink::testing
