#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "server/store/access_rounds.h"
#include "server/store/saved_access.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::store {

inline constexpr const char* kStore = "db:5432/fleet";
inline const absl::Status kAway = absl::UnavailableError("no route to the store");

/// Rows that a test sets, in the order of their versions.
class ListedAccess final : public storage::AccessStore {
 public:
  absl::StatusOr<storage::AccessVersion> Version() override {
    if (std::exchange(fails_once, false)) return kAway;
    if (!status.ok()) return status;
    return version;
  }
  absl::StatusOr<std::vector<storage::Revocation>> RevocationsAfter(
      storage::AccessVersion after) override {
    ++reads;
    if (!status.ok()) return status;
    return After(revocations, after);
  }
  absl::StatusOr<std::vector<storage::RobotSetting>> SettingsAfter(
      storage::AccessVersion after) override {
    if (!status.ok()) return status;
    return After(settings, after);
  }
  absl::StatusOr<bool> Revoke(const storage::Revocation& revocation,
                              const storage::AuditRow& /*audit*/) override {
    std::erase_if(revocations, [&](const storage::Revocation& each) {
      return each.by == revocation.by && each.value == revocation.value;
    });
    revocations.push_back(revocation);
    revocations.back().version = ++version;
    return true;
  }
  absl::StatusOr<storage::ChangedSetting> Change(const storage::SettingChange& change,
                                                 const storage::AuditRow& /*audit*/) override {
    storage::RobotSetting setting;
    setting.ruri = change.ruri;
    setting.blocked = change.blocked.value_or(false);
    setting.version = ++version;
    settings.push_back(setting);
    return storage::ChangedSetting{.setting = setting, .changed = true};
  }
  absl::Status Acknowledge(const storage::Acknowledgement& /*fault*/,
                           const storage::AuditRow& /*audit*/) override {
    return status;
  }
  absl::Status Append(const storage::AuditRow& /*audit*/) override { return status; }

  absl::Status status;
  /// The next call of Version fails.
  bool fails_once = false;
  storage::AccessVersion version = 0;
  std::vector<storage::Revocation> revocations;
  std::vector<storage::RobotSetting> settings;
  int reads = 0;

 private:
  template <typename Row>
  static std::vector<Row> After(const std::vector<Row>& all, storage::AccessVersion after) {
    std::vector<Row> rows;
    for (const Row& row : all) {
      if (row.version > after && rows.size() < storage::kAccessPageMax) rows.push_back(row);
    }
    return rows;
  }
};

inline std::string Key(int number) {
  const std::string text = std::to_string(number);
  return std::string(64 - text.size(), '0') + text;
}

inline storage::Revocation KeyRevocation(int number, bool revoked = true) {
  storage::Revocation revocation;
  revocation.by = storage::RevokedBy::kKey;
  revocation.value = Key(number);
  revocation.revoked = revoked;
  return revocation;
}

class AccessRoundsTest : public ::testing::Test {
 protected:
  ~AccessRoundsTest() override { std::filesystem::remove_all(folder_); }

  void Revoke(int number, bool revoked = true) {
    ASSERT_TRUE(store_.Revoke(KeyRevocation(number, revoked), {}).ok());
  }
  void Block(const std::string& ruri, bool blocked = true) {
    storage::SettingChange change;
    change.ruri = ruri;
    change.blocked = blocked;
    ASSERT_TRUE(store_.Change(change, {}).ok());
  }
  AccessRounds& rounds() {
    if (!rounds_) Restart();
    return *rounds_;
  }
  /// Another life of the server.
  void Restart() {
    rounds_.reset();
    denied_.Set(std::make_shared<identity::DeniedCertificates>());
    settings_ = std::make_unique<fleet::RobotSettings>(kSettingsMax);
    rounds_ = std::make_unique<AccessRounds>(AccessRounds::Context{
        .store = store_,
        .denied = denied_,
        .settings = *settings_,
        .clock = clock_,
        .logger = logger_,
        .probe = probe_,
        .store_name = kStore,
        .saved_path = saved_path_,
        .denied_changed = [this] { ++changes_; },
        .file_lists = [this] { return std::exchange(lists_, std::nullopt); }});
  }
  [[nodiscard]] bool Denies(int number) const {
    identity::ShownCertificate shown{.serial = "01"};
    identity::DeniedCertificates one;
    EXPECT_TRUE(one.Add(storage::RevokedBy::kKey, Key(number)));
    const std::string hex = Key(number);
    for (std::size_t i = 0; i < shown.key_sha256.size(); ++i) {
      shown.key_sha256[i] =
          static_cast<std::uint8_t>(std::strtoul(hex.substr(2 * i, 2).c_str(), nullptr, 16));
    }
    EXPECT_TRUE(one.NamesDigest(shown));
    return denied_.Get()->NamesDigest(shown);
  }
  /// The store has the first revocation alone, and got another since.
  void PutBack() {
    store_.revocations.resize(1);
    store_.settings.clear();
    Revoke(3);
  }
  void ExpectAsPutBack() {
    EXPECT_TRUE(Denies(1));
    EXPECT_FALSE(Denies(2));
    EXPECT_TRUE(Denies(3));
    EXPECT_FALSE(IsBlocked("rcan://a/1"));
    EXPECT_EQ(probe_.of_store.value(), 2);
  }
  [[nodiscard]] bool IsBlocked(const std::string& ruri) const {
    const fleet::RobotSettingPtr found = settings_->Find(ruri);
    return found != nullptr && found->blocked;
  }
  /// Of the copy in the file; nothing: none counts.
  static std::optional<storage::AccessVersion> SavedVersion(const std::string& path) {
    const auto text = ReadSavedAccess(path);
    const auto copy = text.ok() ? ParseAccess(*text, kStore) : text.status();
    return copy.ok() ? std::optional(copy->version) : std::nullopt;
  }
  static std::filesystem::path Make() {
    std::string name = ::testing::TempDir() + "roundsXXXXXX";
    EXPECT_NE(::mkdtemp(name.data()), nullptr);
    return name;
  }

  static constexpr std::size_t kSettingsMax = 100'000;
  const std::filesystem::path folder_ = Make();
  std::string saved_path_ = (folder_ / "access").string();
  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  ListedAccess store_;
  identity::DenyList denied_;
  std::unique_ptr<fleet::RobotSettings> settings_;
  AccessProbe probe_;
  int changes_ = 0;
  std::optional<std::vector<identity::SignedSerial>> lists_;
  std::unique_ptr<AccessRounds> rounds_;
};

}  // namespace uplink::store
