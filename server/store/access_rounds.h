#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/fleet/robot_settings.h"
#include "server/identity/deny_list.h"
#include "server/log/logger.h"
#include "server/loop/rounds.h"
#include "server/store/access_copy_file.h"
#include "server/store/access_probe.h"
#include "server/store/saved_access.h"
#include "storage/access_store.h"
#include "storage/change_signal.h"

namespace uplink::store {

/// How often the store is asked for changes: a revocation counts within a second on every server,
/// even if no signal reaches it.
inline constexpr milliseconds kLookAtAccessEvery{500};
/// The same after the store did not answer.
inline constexpr milliseconds kLookAtAccessAgainEvery{1'000};
/// Looks of signals do not follow each other faster.
inline constexpr milliseconds kLookAtAccessApart{10};
/// How often everything is read, whatever the version says: a store that was replaced by an older
/// state and written since may have a version that tells nothing.
inline constexpr std::chrono::minutes kWholeReadEvery{1};
/// How often the files of authorities are looked at, and a copy that could not be saved, or that is
/// another one since, is saved again.
inline constexpr std::chrono::seconds kLookAtAccessFilesEvery{5};

/// Follows what operators decide about who may come in: reads the store's changes, and the lists of
/// the authorities' files; sets the deny list and the robots' settings by them, and saves a copy,
/// which counts at a start while the store cannot be read.
///
/// Errors: of the store: logged when it begins to fail and when it works again; what was read last
///         counts meanwhile.
/// Thread: Begin on main before Start; unread and Wake from any; rounds on a thread of its own.
class AccessRounds final {
 public:
  /// The references outlive it.
  struct Context {
    storage::AccessStore& store;
    identity::DenyList& denied;
    fleet::RobotSettings& settings;
    const Clock& clock;
    const log::Logger& logger;
    AccessProbe& probe;
    /// What the log calls the store.
    std::string store_name;
    /// The saved copy; empty: none is kept.
    std::string saved_path;
    /// The deny list has changed. On the thread of the rounds.
    std::function<void()> denied_changed = [] {};
    /// What the authorities' files revoke, if that has changed since the last
    /// call; nothing: it has not.
    std::function<std::optional<std::vector<identity::SignedSerial>>()> file_lists = [] {
      return std::optional<std::vector<identity::SignedSerial>>();
    };
    /// Null: no server tells of changes.
    storage::ChangeSignal* signal = nullptr;
  };
  explicit AccessRounds(Context context);
  AccessRounds(const AccessRounds&) = delete;
  AccessRounds& operator=(const AccessRounds&) = delete;

  /// Reads everything before the first robot comes in: from the store, or, if `away` says why that
  /// cannot be, from the saved copy.
  void Begin(const absl::Status& away);
  void Start();
  /// Idempotent.
  void Stop();
  /// Something was written here: looks at once, and tells the other servers.
  void Wake();
  /// The store cannot be read, or neither it nor a copy could be yet: robots come in that may be
  /// revoked. Any thread.
  [[nodiscard]] bool unread() const { return unread_.load() || failing_.load(); }

  /// One look at the store. Returns when the next is due.
  milliseconds Round();

 private:
  using Name = std::pair<storage::RevokedBy, std::string>;

  /// Reads what is newer than what was read, or everything: after a look that failed, for the store
  /// may be another one since; if it went back; and each kWholeReadEvery.
  [[nodiscard]] absl::Status Look();
  [[nodiscard]] absl::Status Read();
  [[nodiscard]] absl::Status ReadAll(storage::AccessVersion version);
  [[nodiscard]] absl::Status ReadNewer(storage::AccessVersion version);
  void LookAtFiles();
  /// Those that were taken back leave what is known.
  void Merge(std::vector<storage::Revocation> revocations);
  void SetDenied();
  void UseSaved(const absl::Status& why);
  /// What decides, as it is known now.
  [[nodiscard]] AccessCopy Known() const;
  /// Warns if what is known, or at first what was saved, is of a later state than the store is, and
  /// keeps it.
  void NoticeWentBack(const AllAccess& all, storage::AccessVersion version);
  void Save();
  void NoteOutcome(const absl::Status& status);
  loop::Next Listen(const std::stop_token& stop);

  const Context context_;
  /// The version that was read; nothing: none of this store.
  std::optional<storage::AccessVersion> seen_;
  /// The last look failed.
  bool failed_ = false;
  SteadyTime read_all_at_;
  /// Those that are revoked.
  std::map<Name, storage::Revocation> revocations_;
  std::vector<identity::SignedSerial> of_files_;
  std::optional<SteadyTime> looked_at_files_;
  /// The copy on disk is not what is known.
  bool unsaved_ = false;
  AccessCopyFile saved_;
  std::atomic<bool> failing_{false};
  std::atomic<bool> unread_{true};
  loop::Rounds rounds_;
  loop::Rounds listener_;
};

}  // namespace uplink::store
