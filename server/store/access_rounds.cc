#include "server/store/access_rounds.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include <absl/status/statusor.h>

#include "server/store/saved_access.h"
#include "storage/access_rules.h"

namespace uplink::store {
namespace {

using storage::AccessVersion;

/// All rows that are newer than a version, page by page.
template <typename Row, typename Read>
absl::StatusOr<std::vector<Row>> RowsAfter(AccessVersion after, const Read& read) {
  std::vector<Row> rows;
  while (true) {
    absl::StatusOr<std::vector<Row>> page = read(after);
    if (!page.ok()) return page.status();
    const bool is_last = page->size() < storage::kAccessPageMax;
    if (!page->empty()) after = page->back().version;
    rows.insert(rows.end(), std::make_move_iterator(page->begin()),
                std::make_move_iterator(page->end()));
    if (is_last) return rows;
  }
}

absl::StatusOr<AllAccess> ChangesAfter(storage::AccessStore& store, AccessVersion after) {
  auto revocations = RowsAfter<storage::Revocation>(
      after, [&store](AccessVersion from) { return store.RevocationsAfter(from); });
  if (!revocations.ok()) return revocations.status();
  auto settings = RowsAfter<storage::RobotSetting>(
      after, [&store](AccessVersion from) { return store.SettingsAfter(from); });
  if (!settings.ok()) return settings.status();
  return AllAccess{*std::move(revocations), *std::move(settings)};
}

std::vector<storage::RobotSetting> NewerThan(AccessVersion seen,
                                             const std::vector<storage::RobotSetting>& all) {
  std::vector<storage::RobotSetting> newer;
  std::ranges::copy_if(all, std::back_inserter(newer),
                       [seen](const storage::RobotSetting& each) { return each.version > seen; });
  return newer;
}

}  // namespace

AccessRounds::AccessRounds(Context context)
    : context_(std::move(context)),
      saved_(context_.saved_path, context_.store_name, context_.logger),
      rounds_("access",
              [this](const std::stop_token& /*stop*/) {
                return loop::Next{.within = Round(), .not_before = kLookAtAccessApart};
              }),
      listener_("access_listen", [this](const std::stop_token& stop) { return Listen(stop); }) {}

void AccessRounds::Begin(const absl::Status& away) {
  LookAtFiles();
  const absl::Status read = away.ok() ? Look() : away;
  if (read.ok()) return;
  NoteOutcome(read);
  UseSaved(read);
}

void AccessRounds::Start() {
  rounds_.Start();
  if (context_.signal != nullptr) listener_.Start();
}

void AccessRounds::Stop() {
  listener_.Stop();
  rounds_.Stop();
}

void AccessRounds::Wake() {
  rounds_.Wake();
  if (context_.signal != nullptr) context_.signal->Tell();
}

milliseconds AccessRounds::Round() {
  const SteadyTime now = context_.clock.Steady();
  absl::Status looked = Look();
  // Its connection may have died or stand still while the way is free: a new one is made at once.
  if (!looked.ok() && !failing_.load()) looked = Look();
  NoteOutcome(looked);
  if (!looked_at_files_ || now - *looked_at_files_ >= kLookAtAccessFilesEvery) {
    LookAtFiles();
    Save();
  }
  return looked.ok() ? kLookAtAccessEvery : kLookAtAccessAgainEvery;
}

absl::Status AccessRounds::Look() {
  absl::Status read = Read();
  failed_ = !read.ok();
  return read;
}

absl::Status AccessRounds::Read() {
  const absl::StatusOr<AccessVersion> version = context_.store.Version();
  if (!version.ok()) return version.status();
  // A store that was put back to an earlier state has counted less.
  if (!seen_ || failed_ || *version < *seen_ ||
      context_.clock.Steady() - read_all_at_ >= kWholeReadEvery) {
    return ReadAll(*version);
  }
  return seen_ == *version ? absl::OkStatus() : ReadNewer(*version);
}

absl::Status AccessRounds::ReadAll(AccessVersion version) {
  absl::StatusOr<AllAccess> all = ChangesAfter(context_.store, 0);
  if (!all.ok()) return all.status();
  read_all_at_ = context_.clock.Steady();
  const bool at_first = !seen_;
  NoticeWentBack(*all, version);
  const auto before = std::exchange(revocations_, {});
  Merge(std::move(all->revocations));
  const bool denies_others = at_first || before != revocations_;
  if (denies_others) SetDenied();
  // What is replaced asks no stream to end.
  if (!at_first) context_.settings.Apply(NewerThan(*seen_, all->settings));
  const bool sets_others = context_.settings.Replace(std::move(all->settings));
  unsaved_ = unsaved_ || denies_others || sets_others || seen_ != version;
  seen_ = version;
  unread_.store(false);
  context_.settings.SetRead();
  Save();
  if (at_first && revocations_.empty() && context_.settings.size() == 0) return absl::OkStatus();
  if (!denies_others && !sets_others) return absl::OkStatus();
  context_.logger.Info("access_read", {{"version", version},
                                       {"revocations", revocations_.size()},
                                       {"settings", context_.settings.size()}});
  return absl::OkStatus();
}

absl::Status AccessRounds::ReadNewer(AccessVersion version) {
  absl::StatusOr<AllAccess> newer = ChangesAfter(context_.store, *seen_);
  if (!newer.ok()) return newer.status();
  const bool revokes = !newer->revocations.empty();
  Merge(std::move(newer->revocations));
  if (revokes) SetDenied();
  context_.settings.Apply(std::move(newer->settings));
  // What came meanwhile is read once more.
  seen_ = version;
  unsaved_ = true;
  Save();
  return absl::OkStatus();
}

void AccessRounds::Merge(std::vector<storage::Revocation> revocations) {
  for (storage::Revocation& each : revocations) {
    Name name{each.by, each.value};
    if (each.revoked) {
      revocations_[std::move(name)] = std::move(each);
    } else {
      revocations_.erase(name);
    }
  }
}

void AccessRounds::LookAtFiles() {
  looked_at_files_ = context_.clock.Steady();
  std::optional<std::vector<identity::SignedSerial>> lists = context_.file_lists();
  if (!lists) return;
  of_files_ = *std::move(lists);
  SetDenied();
}

void AccessRounds::SetDenied() {
  auto denied = std::make_shared<identity::DeniedCertificates>();
  for (const auto& [name, revocation] : revocations_) {
    if (denied->Add(name.first, name.second)) continue;
    context_.logger.Warn("revocation_unreadable", {{"value", name.second}});
  }
  for (const identity::SignedSerial& each : of_files_) denied->Add(each);
  context_.probe.of_store.Set(static_cast<std::int64_t>(revocations_.size()));
  context_.probe.of_files.Set(static_cast<std::int64_t>(of_files_.size()));
  context_.denied.Set(std::move(denied));
  context_.denied_changed();
}

// --- The copy ---

void AccessRounds::UseSaved(const absl::Status& why) {
  if (context_.saved_path.empty()) {
    context_.logger.Warn("access_unread", {{"why", std::string(why.message())}});
    return;
  }
  absl::StatusOr<AccessCopy> copy = saved_.Read();
  if (!copy.ok()) {
    context_.logger.Warn("access_unread", {{"why", std::string(why.message())},
                                           {"saved_list", context_.saved_path},
                                           {"saved_why", std::string(copy.status().message())}});
    return;
  }
  Merge(std::move(copy->revocations));
  context_.settings.Replace(std::move(copy->settings));
  SetDenied();
  unread_.store(false);
  context_.logger.Warn("access_saved_list_used", {{"why", std::string(why.message())},
                                                  {"saved_list", context_.saved_path},
                                                  {"revocations", revocations_.size()},
                                                  {"settings", context_.settings.size()}});
}

AccessCopy AccessRounds::Known() const {
  AccessCopy copy;
  copy.version = seen_.value_or(0);
  for (const auto& [name, revocation] : revocations_) copy.revocations.push_back(revocation);
  for (const fleet::RobotSettingPtr& each : context_.settings.All()) {
    if (storage::DecidesEntry(*each)) copy.settings.push_back(*each);
  }
  return copy;
}

void AccessRounds::NoticeWentBack(const AllAccess& all, AccessVersion version) {
  absl::StatusOr<AccessCopy> known = seen_ ? Known() : saved_.Read();
  if (!known.ok()) return;
  const std::size_t lacks = LackedBy(all, *known);
  if (known->version <= version && lacks == 0) return;
  if (seen_) {
    context_.logger.Warn("access_went_back",
                         {{"version", version}, {"seen", *seen_}, {"lacks", lacks}});
  }
  saved_.KeepOld(*std::move(known), version, lacks);
}

void AccessRounds::Save() {
  if (context_.saved_path.empty() || (!unsaved_ && saved_.IsAsSaved())) return;
  unsaved_ = !saved_.Save(Known());
}

void AccessRounds::NoteOutcome(const absl::Status& status) {
  const bool fails = !status.ok();
  if (failing_.exchange(fails) == fails) return;
  if (fails) {
    context_.logger.Warn("access_fails", {{"why", std::string(status.message())}});
  } else {
    context_.logger.Info("access_works_again", {});
  }
}

loop::Next AccessRounds::Listen(const std::stop_token& stop) {
  const std::stop_callback end(stop, [this] { context_.signal->End(); });
  // Rounds come all the same, so a wait that fails costs half a second at most.
  const absl::StatusOr<bool> heard = context_.signal->Wait(kLookAtAccessAgainEvery);
  if (!heard.ok()) return {.within = kLookAtAccessAgainEvery};
  if (*heard) rounds_.Wake();
  return {};
}

}  // namespace uplink::store
