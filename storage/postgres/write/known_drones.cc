#include "storage/postgres/write/known_drones.h"

#include <cstdint>
#include <set>
#include <string_view>
#include <utility>
#include <variant>

#include "storage/read_row.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kReadClaims =
    "SELECT ruri, epoch FROM uplinkd.drone_claims"
    " WHERE ruri = ANY($1::text[]) AND owner = $2::uuid";
constexpr std::string_view kReadSamples =
    "SELECT s.ruri, s.type, s.digests, s.last FROM unnest($1::text[], $2::int[]) AS u (ruri, type)"
    " JOIN uplinkd.samples AS s ON s.ruri = u.ruri AND s.type = u.type";
constexpr std::string_view kReadOpenRequests =
    "SELECT ruri, request_id FROM uplinkd.operator_requests"
    " WHERE ruri = ANY($1::text[]) AND is_open";

}  // namespace

void ReadDrones(const Slice& slice, const ProcessId& process, KnownRows& known, Reads& reads) {
  std::set<std::string_view> drones, asking;
  std::set<std::pair<std::string_view, std::uint32_t>> types;
  for (const CommitRecord& record : slice.records()) {
    const std::string_view ruri = record.robot->ruri;
    if (std::holds_alternative<model::OperatorRequest>(record.content)) asking.insert(ruri);
    if (record.sample == nullptr) continue;
    drones.insert(ruri);
    if (!record.sample->is_question) types.emplace(ruri, record.sample->type);
  }
  const auto names = [](const std::set<std::string_view>& ruris) {
    Array array{Type::kText};
    for (const std::string_view ruri : ruris) array.Text(ruri);
    return array;
  };
  if (!drones.empty()) {
    reads.Add(StoreCallOf(kReadClaims, names(drones), process), [&known](const Result& rows) {
      for (const ResultRow& row : rows) {
        const auto robot = known.robots.find(row.Bytes(0));
        if (robot != known.robots.end()) robot->second.claim = NumberIn(row, 1);
      }
    });
    Array ruris{Type::kText}, numbers{Type::kInt4};
    for (const auto& [ruri, type] : types) {
      ruris.Text(ruri);
      numbers.Int4(static_cast<std::int32_t>(type));
    }
    reads.Add(StoreCallOf(kReadSamples, &ruris, &numbers), [&known](const Result& rows) {
      for (const ResultRow& row : rows) {
        SampleMemory memory = SamplesIn(row, 1);
        known.samples[{TextIn(row, 0), memory.type}].memory = std::move(memory);
      }
    });
  }
  if (asking.empty()) return;
  reads.Add(StoreCallOf(kReadOpenRequests, names(asking)), [&known](const Result& rows) {
    for (const ResultRow& row : rows) known.open_requests[TextIn(row, 0)].insert(TextIn(row, 1));
  });
}

}  // namespace uplink::storage::postgres
