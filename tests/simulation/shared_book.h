#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "schema/base/clock.h"
#include "schema/nexus_command/command.h"
#include "storage/commit_record.h"

namespace uplink::simulation {

/// What a robot may know of another's item.
using SharedWhat = std::variant<nexus_command::Shape, model::Object>;

/// By what a receiver knows an item.
struct SharedKey {
  bool is_object = false;
  /// `<id>@<origin RURI>`.
  std::string id;

  friend auto operator<=>(const SharedKey&, const SharedKey&) = default;
};

/// What robots share, made of the records that were really committed and of nothing that the store
/// says of its items or changes.
///
/// Thread: confined to one thread.
class SharedBook final {
 public:
  /// A record was stored.
  void Note(const storage::CommitRecord& record);
  /// All items of the robot are gone.
  void NoteRemoval(const std::string& ruri);
  /// A life of the server begins.
  void BeginLife() { life_began_ = notes_; }

  /// Who receives.
  struct Receiver {
    std::string fleet;
    std::string ruri;
  };
  using Table = std::map<SharedKey, SharedWhat>;
  /// What the others of its fleet share.
  [[nodiscard]] Table PresentFor(const Receiver& receiver, SystemTime now) const;
  /// Of those, what was there when this life of the server began, did not change since and does not
  /// expire: it is in every snapshot. The key of one that `table` lacks; nothing if it lacks none.
  [[nodiscard]] std::optional<SharedKey> LackingOf(const Receiver& receiver,
                                                   const Table& table) const;
  /// The number of the item's first version from `from` on that is shared and was just that.
  [[nodiscard]] std::optional<std::size_t> VersionOf(const SharedKey& key, const SharedWhat& what,
                                                     std::size_t from) const;

 private:
  struct Version {
    std::uint64_t note = 0;
    std::string fleet;
    std::int64_t expires_ms = 0;
    SystemTime received_at;
    /// Nothing: it is not shared.
    std::optional<SharedWhat> what;
  };
  struct Item {
    std::string ruri;
    /// The last one holds.
    std::vector<Version> versions;
  };

  void Add(const model::RobotId& robot, const SharedKey& key, Version version);
  [[nodiscard]] static bool IsFor(const Receiver& receiver, const Item& item);

  std::map<SharedKey, Item> items_;
  std::uint64_t notes_ = 0;
  std::uint64_t life_began_ = 0;
};

/// For the message of a violation.
[[nodiscard]] std::string ToText(const SharedKey& key);

}  // namespace uplink::simulation
