#include "server/store/access_rounds.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/store/saved_access.h"
#include "tests/support/eventually.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::store {
namespace {

using storage::AccessVersion;
using storage::RevokedBy;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kStore = "db:5432/fleet";
const absl::Status kAway = absl::UnavailableError("no route to the store");

/// Rows that a test sets, in the order of their versions.
class ListedAccess final : public storage::AccessStore {
 public:
  absl::StatusOr<AccessVersion> Version() override {
    if (std::exchange(fails_once, false)) return kAway;
    if (!status.ok()) return status;
    return version;
  }
  absl::StatusOr<std::vector<storage::Revocation>> RevocationsAfter(AccessVersion after) override {
    ++reads;
    if (!status.ok()) return status;
    return After(revocations, after);
  }
  absl::StatusOr<std::vector<storage::RobotSetting>> SettingsAfter(AccessVersion after) override {
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
  AccessVersion version = 0;
  std::vector<storage::Revocation> revocations;
  std::vector<storage::RobotSetting> settings;
  int reads = 0;

 private:
  template <typename Row>
  static std::vector<Row> After(const std::vector<Row>& all, AccessVersion after) {
    std::vector<Row> rows;
    for (const Row& row : all) {
      if (row.version > after && rows.size() < storage::kAccessPageMax) rows.push_back(row);
    }
    return rows;
  }
};

std::string Key(int number) {
  const std::string text = std::to_string(number);
  return std::string(64 - text.size(), '0') + text;
}

storage::Revocation KeyRevocation(int number, bool revoked = true) {
  storage::Revocation revocation;
  revocation.by = RevokedBy::kKey;
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
    EXPECT_TRUE(one.Add(RevokedBy::kKey, Key(number)));
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

TEST_F(AccessRoundsTest, TheStartReadsAll) {
  Revoke(1);
  Revoke(2);
  Revoke(2, false);
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  EXPECT_TRUE(Denies(1));
  EXPECT_FALSE(Denies(2));
  EXPECT_TRUE(IsBlocked("rcan://a/1"));
  EXPECT_FALSE(rounds().unread());
  EXPECT_EQ(probe_.of_store.value(), 1);
}

TEST_F(AccessRoundsTest, AChangeIsReadOnceAndTold) {
  rounds().Begin(absl::OkStatus());
  const int before = changes_;
  Revoke(1);
  EXPECT_EQ(rounds().Round(), kLookAtAccessEvery);
  EXPECT_TRUE(Denies(1));
  EXPECT_EQ(changes_, before + 1);
  const int reads = store_.reads;
  rounds().Round();
  EXPECT_EQ(store_.reads, reads) << "the version alone is asked for";
  Revoke(1, false);
  rounds().Round();
  EXPECT_FALSE(Denies(1));
  EXPECT_EQ(changes_, before + 2);
}

TEST_F(AccessRoundsTest, ASettingAloneLooksAtNoConnection) {
  rounds().Begin(absl::OkStatus());
  const int before = changes_;
  Block("rcan://a/1");
  rounds().Round();
  EXPECT_TRUE(IsBlocked("rcan://a/1"));
  EXPECT_EQ(changes_, before);
}

TEST_F(AccessRoundsTest, MorePagesThanOneAreRead) {
  const int count = static_cast<int>(storage::kAccessPageMax) * 2 + 1;
  for (int i = 0; i < count; ++i) {
    store_.revocations.push_back(KeyRevocation(i));
    store_.revocations.back().version = ++store_.version;
  }
  rounds().Begin(absl::OkStatus());
  EXPECT_EQ(denied_.Get()->size(), static_cast<std::size_t>(count));
}

TEST_F(AccessRoundsTest, WhatWasReadCountsWhileTheStoreIsAway) {
  Revoke(1);
  rounds().Begin(absl::OkStatus());
  store_.status = kAway;
  EXPECT_EQ(rounds().Round(), kLookAtAccessAgainEvery);
  rounds().Round();
  EXPECT_TRUE(Denies(1));
  EXPECT_EQ(std::ranges::count_if(lines_,
                                  [](const std::string& line) {
                                    return line.find("access_fails") != std::string::npos;
                                  }),
            1);
  store_.status = absl::OkStatus();
  Revoke(2);
  rounds().Round();
  EXPECT_TRUE(Denies(2));
  EXPECT_THAT(lines_, Contains(HasSubstr("access_works_again")));
}

TEST_F(AccessRoundsTest, AStoreThatWentBackIsReadAnew) {
  Revoke(1);
  Revoke(2);
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  store_.revocations.resize(1);
  store_.settings.clear();
  store_.version = 1;
  rounds().Round();
  EXPECT_TRUE(Denies(1));
  EXPECT_FALSE(Denies(2));
  EXPECT_FALSE(IsBlocked("rcan://a/1"));
  EXPECT_THAT(lines_, Contains(HasSubstr("access_went_back")));
}

TEST_F(AccessRoundsTest, ARestoredStoreThatWasWrittenSinceIsReadAnew) {
  Revoke(1);
  Revoke(2);
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  store_.status = kAway;
  rounds().Round();
  PutBack();
  store_.status = absl::OkStatus();
  rounds().Round();
  ExpectAsPutBack();
  EXPECT_THAT(lines_, Contains(HasSubstr("access_went_back")));
}

TEST_F(AccessRoundsTest, ARestoreThatNoLookNoticesCountsWithinAMinute) {
  Revoke(1);
  Revoke(2);
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  PutBack();
  rounds().Round();
  EXPECT_TRUE(Denies(3));
  EXPECT_TRUE(Denies(2)) << "its version tells nothing of it";
  clock_.Advance(kWholeReadEvery);
  rounds().Round();
  ExpectAsPutBack();
}

TEST_F(AccessRoundsTest, AWholeReadThatFindsNothingNewTellsNobody) {
  Revoke(1);
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  const auto told = std::pair(changes_, lines_.size());
  const auto saved = std::filesystem::last_write_time(saved_path_);
  clock_.Advance(kWholeReadEvery);
  const int reads = store_.reads;
  rounds().Round();
  EXPECT_EQ(store_.reads, reads + 1);
  EXPECT_EQ(std::pair(changes_, lines_.size()), told);
  EXPECT_EQ(std::filesystem::last_write_time(saved_path_), saved);
  rounds().Round();
  EXPECT_EQ(store_.reads, reads + 1);
}

TEST_F(AccessRoundsTest, AWholeReadEndsStreamsAsOperatorsAskedSince) {
  rounds().Begin(absl::OkStatus());
  std::size_t asked = 0;
  settings_->OnChange([&asked](std::span<const fleet::RobotSettings::Change> changes) {
    asked += static_cast<std::size_t>(
        std::ranges::count_if(changes, [](const auto& each) { return each.disconnect; }));
  });
  store_.settings.push_back(
      {.ruri = "rcan://a/1", .disconnect_at = FromUnixMs(1), .version = ++store_.version});
  clock_.Advance(kWholeReadEvery);
  rounds().Round();
  EXPECT_EQ(asked, 1U);
  clock_.Advance(kWholeReadEvery);
  rounds().Round();
  EXPECT_EQ(asked, 1U);
}

TEST_F(AccessRoundsTest, ALookThatFailsIsRepeatedAtOnceAndReadsAll) {
  Revoke(1);
  Revoke(2);
  rounds().Begin(absl::OkStatus());
  PutBack();
  store_.fails_once = true;
  EXPECT_EQ(rounds().Round(), kLookAtAccessEvery);
  ExpectAsPutBack();
  EXPECT_FALSE(rounds().unread());
  EXPECT_THAT(lines_, Not(Contains(HasSubstr("access_fails"))));
}

TEST_F(AccessRoundsTest, ACopyThatIsNewerThanTheStoreIsKept) {
  Revoke(1);
  Revoke(2);
  rounds().Begin(absl::OkStatus());
  const auto text = ReadSavedAccess(saved_path_);
  store_.revocations.resize(1);
  store_.version = 1;
  Restart();
  rounds().Begin(absl::OkStatus());
  EXPECT_FALSE(Denies(2)) << "the store counts";
  EXPECT_THAT(lines_, Contains(AllOf(HasSubstr("access_saved_list_newer"), HasSubstr("version=1"),
                                     HasSubstr("saved_version=2"), HasSubstr(saved_path_))));
  EXPECT_EQ(ReadSavedAccess(saved_path_ + ".old").value(), *text);
  EXPECT_EQ(SavedAccessVersion(saved_path_, kStore), 1U);
  // So it is where a server that runs sees its store go back.
  Revoke(3);
  rounds().Round();
  const auto later = ReadSavedAccess(saved_path_);
  store_.revocations.resize(1);
  store_.version = 1;
  rounds().Round();
  EXPECT_EQ(ReadSavedAccess(saved_path_ + ".old").value(), *later);
}

TEST_F(AccessRoundsTest, ANewerCopyThatCannotBeKeptIsNotReplaced) {
  Revoke(1);
  rounds().Begin(absl::OkStatus());
  std::filesystem::create_directories(saved_path_ + ".old");
  store_.revocations.clear();
  store_.version = 0;
  Restart();
  rounds().Begin(absl::OkStatus());
  EXPECT_THAT(lines_, Contains(HasSubstr("access_not_saved")));
  EXPECT_EQ(SavedAccessVersion(saved_path_, kStore), 1U);
  std::filesystem::remove(saved_path_ + ".old");
  clock_.Advance(kLookAtAccessFilesEvery);
  rounds().Round();
  EXPECT_EQ(SavedAccessVersion(saved_path_, kStore), 0U);
  EXPECT_EQ(SavedAccessVersion(saved_path_ + ".old", kStore), 1U);
}

TEST_F(AccessRoundsTest, TheSavedCopyCountsWhileTheStoreIsAwayAtTheStart) {
  Revoke(1);
  rounds().Begin(absl::OkStatus());
  Block("rcan://a/1");
  rounds().Round();
  store_.status = kAway;
  Restart();
  rounds().Begin(kAway);
  EXPECT_TRUE(Denies(1));
  EXPECT_TRUE(IsBlocked("rcan://a/1"));
  EXPECT_FALSE(rounds().unread());
  EXPECT_THAT(lines_, Contains(HasSubstr("access_saved_list_used")));
  // The store has changed meanwhile.
  store_.status = absl::OkStatus();
  Revoke(1, false);
  Revoke(2);
  rounds().Round();
  EXPECT_FALSE(Denies(1));
  EXPECT_TRUE(Denies(2));
}

TEST_F(AccessRoundsTest, TheStartFallsBackIfTheStoreFailsWhileItIsRead) {
  Revoke(1);
  rounds().Begin(absl::OkStatus());
  store_.status = kAway;
  Restart();
  rounds().Begin(absl::OkStatus());
  EXPECT_TRUE(Denies(1));
}

TEST_F(AccessRoundsTest, WithoutACopyItSaysSoUntilTheStoreIsRead) {
  store_.status = kAway;
  rounds().Begin(kAway);
  EXPECT_TRUE(rounds().unread());
  EXPECT_THAT(lines_, Contains(HasSubstr("access_unread")));
  store_.status = absl::OkStatus();
  rounds().Round();
  EXPECT_FALSE(rounds().unread());
}

TEST_F(AccessRoundsTest, ACopyOfAnotherStoreIsNone) {
  ASSERT_TRUE(SaveAccess(saved_path_, TextOf({.revocations = {KeyRevocation(1)}, .settings = {}},
                                             "db:5432/other"))
                  .ok());
  store_.status = kAway;
  rounds().Begin(kAway);
  EXPECT_FALSE(Denies(1));
  EXPECT_TRUE(rounds().unread());
}

TEST_F(AccessRoundsTest, ACopyThatCannotBeSavedIsTriedAgain) {
  std::filesystem::remove_all(folder_);
  Revoke(1);
  rounds().Begin(absl::OkStatus());
  EXPECT_TRUE(Denies(1));
  EXPECT_THAT(lines_, Contains(HasSubstr("access_not_saved")));
  std::filesystem::create_directory(folder_);
  clock_.Advance(kLookAtAccessFilesEvery);
  rounds().Round();
  EXPECT_TRUE(std::filesystem::exists(saved_path_));
}

TEST_F(AccessRoundsTest, TheListsOfFilesCountBesideTheStore) {
  Revoke(1);
  lists_ = {{.serial = "0A"}};
  rounds().Begin(absl::OkStatus());
  EXPECT_TRUE(denied_.Get()->NamesSigned("0A", {}));
  EXPECT_TRUE(Denies(1));
  EXPECT_EQ(probe_.of_files.value(), 1);
  lists_ = {{.serial = "0B"}};
  rounds().Round();
  EXPECT_TRUE(denied_.Get()->NamesSigned("0A", {})) << "the next look is due later";
  clock_.Advance(kLookAtAccessFilesEvery);
  rounds().Round();
  EXPECT_FALSE(denied_.Get()->NamesSigned("0A", {}));
  EXPECT_TRUE(denied_.Get()->NamesSigned("0B", {}));
  EXPECT_TRUE(Denies(1));
}

TEST_F(AccessRoundsTest, AThreadFollowsTheStore) {
  rounds().Begin(absl::OkStatus());
  Revoke(1);
  rounds().Start();
  EXPECT_TRUE(testing::Eventually([this] { return Denies(1); }));
  rounds().Stop();
}

}  // namespace
}  // namespace uplink::store
