#include "tests/support/fake_connections.h"

#include <algorithm>
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
    return Trim(item.robot->ruri);
  }
  const bool presumed = there->row.why == model::ConnectionEnd::kServerEnded;
  if (there->row.ended_at && !(presumed && item.ended)) return;
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
  std::vector<std::pair<SystemTime, std::uint64_t>> places;
  for (const auto& known : rows_) {
    if (known.row.robot.ruri == ruri) places.emplace_back(known.at, known.entry);
  }
  if (places.size() <= storage::kConnectionsPerRobotMax) return;
  const std::uint64_t oldest = std::ranges::min_element(places)->second;
  std::erase_if(rows_, [oldest](const auto& known) { return known.entry == oldest; });
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
