#pragma once

#include <atomic>
#include <cstddef>
#include <list>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/connection.h"

namespace uplink::journal {

/// The connections of robots that are not in the store as they are now, each once, as it was noted
/// last; those that wait longest first.
///
/// Limits: so many connections as it was made for, taken ones included; one more is refused. So is
///         one more of a gateway whose connections that wait take half of the room.
/// Thread: confined to its owner's lock; uncommitted() and CountCommitted: any thread.
class ConnectionLog final {
 public:
  explicit ConnectionLog(std::size_t connections_max) : connections_max_(connections_max) {}

  /// Notes what is known of a connection now. False if there is no room for it.
  [[nodiscard]] bool Note(storage::ConnectionItem item);

  /// Hands over at most `items_max`. The caller commits them, or puts them back, before it takes
  /// more.
  [[nodiscard]] std::vector<storage::ConnectionItem> Take(std::size_t items_max);
  /// Puts taken connections back to the front; one that was noted since stays as it is.
  void PutBack(std::vector<storage::ConnectionItem> items);
  /// So many taken connections are committed.
  void CountCommitted(std::size_t count) { uncommitted_.fetch_sub(count); }

  [[nodiscard]] bool empty() const { return waiting_.empty(); }
  [[nodiscard]] std::size_t size() const { return waiting_.size(); }
  /// Connections that wait, and those handed over that are not committed yet.
  [[nodiscard]] std::size_t uncommitted() const { return uncommitted_.load(); }

 private:
  /// The RURI is the item's own.
  using Key = std::pair<std::string_view, storage::ConnectionId>;
  using Items = std::list<storage::ConnectionItem>;
  static Key KeyOf(const storage::ConnectionItem& item) { return {item.robot->ruri, item.id}; }
  [[nodiscard]] bool HasRoomFor(const storage::ConnectionItem& item) const;
  void CountIn(const storage::ConnectionItem& item);
  void CountOut(const storage::ConnectionItem& item);

  const std::size_t connections_max_;
  Items waiting_;
  std::map<Key, Items::iterator> places_;
  /// Those that wait, by gateway. All connections of one id have one gateway.
  std::map<std::string, std::size_t> shares_;
  std::atomic<std::size_t> uncommitted_{0};
};

}  // namespace uplink::journal
