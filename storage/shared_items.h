#pragma once

#include <array>
#include <chrono>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "schema/model/spatial.h"
#include "storage/present.h"
#include "storage/reader.h"
#include "storage/rows.h"

// Shapes and objects that robots share: those of scope fleet or world.
namespace uplink::storage {

/// Changes that one answer of SharedItems::ChangesSince covers at most.
inline constexpr std::size_t kChangesReadMax = 4'096;
/// Items that one answer of SharedItems::Page has at most.
inline constexpr std::size_t kSharedPageMax = 1'000;
/// Changes of each writer that Store::Sweep leaves: a reader further behind reads all anew.
inline constexpr std::size_t kChangesKept = 65'536;
/// Changes that one call of Store::Sweep deletes: it must not hold up a commit.
inline constexpr std::size_t kChangesSweptMax = 32'768;
/// A writer that changed nothing for so long, by the store's own clock, goes with its changes.
inline constexpr std::chrono::hours kChangeWriterKept{24};
/// A reader that paused for so long reads all anew: a writer may have come and gone meanwhile. An
/// hour less than writers are kept, since a change is noted a while before its commit.
inline constexpr std::chrono::hours kChangesReadWithin{23};

/// The kinds of items, in the order of their keys.
inline constexpr std::array kItemKinds = {PresentKind::kShape, PresentKind::kObject};
/// The number of a kind of items in a row of changes, as the triggers of both stores write it;
/// nothing for a kind that is not shared.
[[nodiscard]] constexpr std::optional<std::int64_t> ItemNumberOf(PresentKind kind) {
  switch (kind) {
    case PresentKind::kShape:
      return 1;
    case PresentKind::kObject:
      return 2;
    case PresentKind::kFault:
      break;
  }
  return std::nullopt;
}

/// What identifies a shape or an object. By kind, robot and id, as bytes compare. A value.
struct ItemKey {
  /// kShape or kObject.
  PresentKind kind = PresentKind::kShape;
  /// Of the robot whose item it is.
  std::string ruri;
  std::string id;

  friend auto operator<=>(const ItemKey&, const ItemKey&) = default;
};

/// The kind that stands in a row of changes; nothing for a number that no trigger of ours wrote.
[[nodiscard]] constexpr std::optional<PresentKind> ItemKindOf(std::int64_t number) {
  for (const PresentKind kind : kItemKinds) {
    if (ItemNumberOf(kind) == number) return kind;
  }
  return std::nullopt;
}
static_assert(
    [] {
      std::size_t items = 0;
      for (std::size_t kind = 0; kind < kPresentKinds; ++kind) {
        if (ItemNumberOf(static_cast<PresentKind>(kind))) ++items;
      }
      return items;
    }() == kItemKinds.size(),
    "kItemKinds names each kind that has a number");

/// SQL: the row is one of these. Word for word what the partial indexes of both stores have.
inline constexpr std::string_view kSharedIf = "scope IN (1, 2)";
static_assert(static_cast<int>(model::ScopeType::kFleet) == 1 &&
              static_cast<int>(model::ScopeType::kWorld) == 2);
[[nodiscard]] constexpr bool IsShared(model::ScopeType scope) {
  return scope == model::ScopeType::kFleet || scope == model::ScopeType::kWorld;
}

/// A shape or an object that is there. A value.
struct SharedItem {
  std::variant<ShapeRow, ObjectRow> row;

  [[nodiscard]] ItemKey Key() const;
  /// Whose item it is, with the fleet that the robot has.
  [[nodiscard]] const model::RobotId& robot() const;
  /// Unix milliseconds; 0: never.
  [[nodiscard]] std::int64_t expires_at_ms() const;
};

/// What writes changes one after the other: a session with the database. No two ever have one
/// id.
using WriterId = std::array<std::uint8_t, 16>;

/// A change of a writer.
struct ChangePosition {
  /// From 1 without a hole, in the order of the writer's commits; 0 is before the first.
  std::uint64_t number = 0;
  /// By the store's clock, where it keeps that.
  SystemTime noted_at;

  friend bool operator==(const ChangePosition&, const ChangePosition&) = default;
};

/// How far a reader has read. A value.
struct ChangePositions {
  /// The last change of each writer that was read; all before it were, too.
  std::map<WriterId, ChangePosition> writers;
  /// By the store's clock, where it keeps that.
  SystemTime read_at;
};

struct SharedChanges {
  /// What changed, each once, in the order of its first change. Whether an item is still there,
  /// SharedItems::Of tells.
  std::vector<ItemKey> keys;
  /// To go on from.
  ChangePositions positions;
  /// Changes after the positions went before they were read, or the store is an older copy of
  /// itself: take Positions and read all items anew. Nothing else is set.
  bool trimmed = false;
  /// The answer was full: further ones may be there at once.
  bool more = false;
};

struct SharedPage {
  /// Ascending by key.
  std::vector<SharedItem> items;
  /// Further ones may come after the last of these.
  bool more = false;
};

/// The shapes and objects of scope fleet or world, and what any process that shares the store, an
/// operator included, does to them.
///
/// How to follow them: take Positions, then read all pages, then again and again take ChangesSince
/// and look the keys up by Of. After each round the reader has exactly what was there when asked:
/// upserts, deletes, what was swept, what went with its robot or for a bound, and what was narrowed
/// to another scope are all changes. An item that only expires is not a change. A key may be named
/// without need, since a page may show already what a change names afterwards.
///
/// Errors: as in Store: a status means that nothing is known. Calling again is right.
/// Thread: confined to one thread.
class SharedItems {
 public:
  virtual ~SharedItems() = default;

  /// After the last change of all that has been committed.
  [[nodiscard]] virtual absl::StatusOr<ChangePositions> Positions() = 0;
  /// What was committed and lies after `positions`; at most kChangesReadMax changes.
  [[nodiscard]] virtual absl::StatusOr<SharedChanges> ChangesSince(
      const ChangePositions& positions) = 0;
  /// The items after `after`, or from the first one on; those that have expired and are not yet
  /// swept included. At most kSharedPageMax; ends early once their texts have passed kPageBytesMax.
  [[nodiscard]] virtual absl::StatusOr<SharedPage> Page(const std::optional<ItemKey>& after) = 0;
  /// Those of the keys that are there with such a scope, in any order; expired ones included. The
  /// answer is as large as they are: a caller with a bound asks for some at a time.
  [[nodiscard]] virtual absl::StatusOr<std::vector<SharedItem>> Of(
      std::span<const ItemKey> keys) = 0;
};

}  // namespace uplink::storage
