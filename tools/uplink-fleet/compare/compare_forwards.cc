#include "tools/uplink-fleet/compare/compare_forwards.h"

#include <map>
#include <memory>
#include <unordered_set>

#include <fmt/core.h>

#include "schema/model/enum_text.h"
#include "schema/model/spatial.h"

namespace uplink::synthetic {
namespace {

using nexus_command::ItemKind;

template <typename Row>
void Add(ItemKind kind, const std::vector<Row>& rows, SharedItems& shared) {
  for (const Row& row : rows) {
    if (row.scope() != model::EnumText(model::ScopeType::kFleet) &&
        row.scope() != model::EnumText(model::ScopeType::kWorld)) {
      continue;
    }
    ItemName name{kind, nexus_command::ForwardedId(row.id(), row.ruri())};
    shared.emplace(std::make_shared<const ItemName>(std::move(name)),
                   SharedItem{row.ruri(), FingerprintOf(row)});
  }
}

/// What the receiver should hold and does not.
void FindMissing(const SharedItems& shared, const ReceiverTable& table, Findings& findings) {
  std::unordered_set<ItemRef, ItemHash, ItemEqual> held;
  for (const auto& [item, fingerprint] : table.held) held.insert(item);
  for (const auto& [item, expected] : shared) {
    if (expected.origin == table.ruri || held.contains(item)) continue;
    findings.Differ(Thing::kForwardedItems, table.ruri, Shown(*item), "not held");
  }
}

void CompareTable(const SharedItems& shared, std::uint64_t expected, const ReceiverTable& table,
                  Findings& findings) {
  findings.Expect(Thing::kForwardedItems, expected);
  findings.Find(Thing::kForwardedItems, table.held.size());
  if (!table.whole) {
    findings.Differ(Thing::kForwardedItems, table.ruri, "a snapshot on its stream", "none");
  }
  std::uint64_t known = 0;
  for (const auto& [item, fingerprint] : table.held) {
    const auto place = shared.find(item);
    if (place == shared.end() || place->second.origin == table.ruri) {
      findings.Differ(Thing::kForwardedItems, table.ruri, "nothing that the others share",
                      Shown(*item));
      continue;
    }
    ++known;
    if (place->second.fingerprint != fingerprint) {
      findings.Differ(Thing::kForwardedItems, table.ruri, Shown(*item) + " as the server shows it",
                      "other contents");
    }
  }
  if (known != expected) FindMissing(shared, table, findings);
}

}  // namespace

SharedItems SharedOf(const std::vector<v1::Shape>& shapes,
                     const std::vector<v1::TrackedObject>& objects) {
  SharedItems shared;
  Add(ItemKind::kShape, shapes, shared);
  Add(ItemKind::kObject, objects, shared);
  return shared;
}

void CompareForwards(const SharedItems& shared, const std::vector<ReceiverTable>& tables,
                     Findings& findings) {
  std::map<std::string, std::uint64_t> own;
  for (const auto& [item, each] : shared) ++own[each.origin];
  for (const ReceiverTable& table : tables) {
    const auto mine = own.find(table.ruri);
    const std::uint64_t expected = shared.size() - (mine == own.end() ? 0 : mine->second);
    CompareTable(shared, expected, table, findings);
  }
}

void CompareViolations(const RobotOutcome& robot, Findings& findings) {
  if (robot.forward_violations == 0) return;
  findings.Find(Thing::kForwardViolations, robot.forward_violations);
  findings.Differ(
      Thing::kForwardViolations, robot.ruri, "none",
      fmt::format("{}; the first: {}", robot.forward_violations, robot.first_forward_violation));
}

void CompareOrigins(const std::set<std::string>& origins, const std::set<std::string>& fleet,
                    Findings& findings) {
  for (const std::string& origin : origins) {
    if (fleet.contains(origin)) continue;
    findings.Find(Thing::kForwardViolations);
    findings.Differ(Thing::kForwardViolations, origin, "nothing of another fleet",
                    "items of this robot were forwarded");
  }
}

}  // namespace uplink::synthetic
