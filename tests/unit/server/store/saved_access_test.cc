#include "server/store/saved_access.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>

namespace uplink::store {
namespace {

constexpr const char* kStore = "db:5432/fleet";

storage::Revocation Revoked(storage::RevokedBy by, const std::string& value) {
  storage::Revocation revocation;
  revocation.by = by;
  revocation.value = value;
  return revocation;
}

storage::RobotSetting Setting(const std::string& ruri, bool blocked, bool registered) {
  storage::RobotSetting setting;
  setting.ruri = ruri;
  setting.blocked = blocked;
  setting.registered = registered;
  return setting;
}

AccessCopy Copy() {
  return {.revocations = {Revoked(storage::RevokedBy::kIssuerSerial, "0A CN=a b,O=c"),
                          Revoked(storage::RevokedBy::kKey, std::string(64, 'a'))},
          .settings = {Setting("rcan://a/1", true, false), Setting("rcan://a/2", false, true),
                       Setting("rcan://a/3", true, true)},
          .version = 1'764'441'210'123};
}

TEST(SavedAccess, ComesBackAsItWas) {
  const auto read = ParseAccess(TextOf(Copy(), kStore), kStore);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->revocations, Copy().revocations);
  EXPECT_EQ(read->settings, Copy().settings);
  EXPECT_EQ(read->version, Copy().version);
}

TEST(SavedAccess, KeepsEachKindOfRevocationAndTakesNoOther) {
  AccessCopy copy;
  for (const storage::RevokedBy by : storage::kAllRevokedBy) {
    copy.revocations.push_back(Revoked(by, "0A CN=a"));
  }
  std::string text = TextOf(copy, kStore);
  const auto read = ParseAccess(text, kStore);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->revocations, copy.revocations);
  const std::string last = "revoked 2 ";
  ASSERT_NE(text.find(last), std::string::npos);
  text.replace(text.find(last), last.size(), "revoked 3 ");
  EXPECT_FALSE(ParseAccess(text, kStore).ok());
}

TEST(SavedAccess, AnEmptyCopyIsWhole) {
  const auto read = ParseAccess(TextOf({}, kStore), kStore);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(read->revocations.empty());
}

TEST(SavedAccess, WhatWasTakenBackOrBreaksALineIsLeftOut) {
  AccessCopy copy = Copy();
  copy.revocations[0].revoked = false;
  copy.revocations[1].value = "a\nblocked rcan://a/9";
  copy.settings = {Setting("rcan://a/4\nadded rcan://a/5", true, true)};
  const auto read = ParseAccess(TextOf(copy, kStore), kStore);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(read->revocations.empty());
  EXPECT_TRUE(read->settings.empty());
}

TEST(SavedAccess, ACopyOfAnotherStoreDoesNotCount) {
  const auto read = ParseAccess(TextOf(Copy(), kStore), "db:5432/other");
  EXPECT_EQ(read.status().message(), "it is of another store: db:5432/fleet");
}

TEST(SavedAccess, ACopyThatIsCutAnywhereDoesNotCount) {
  const std::string whole = TextOf(Copy(), kStore);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(ParseAccess(whole.substr(0, size), kStore).ok()) << size;
  }
  EXPECT_FALSE(ParseAccess(whole + "blocked rcan://a/9\n", kStore).ok());
  std::string less = whole;
  less.erase(less.find("revoked 2"), less.find("blocked") - less.find("revoked 2"));
  EXPECT_FALSE(ParseAccess(less, kStore).ok()) << "a line is missing";
}

TEST(LackedBy, CountsWhatTheStoreNeverTookBack) {
  const AccessCopy known = Copy();
  const auto all = [&known](storage::AccessVersion version) {
    AllAccess rows{known.revocations, known.settings};
    for (storage::Revocation& each : rows.revocations) each.version = version;
    for (storage::RobotSetting& each : rows.settings) each.version = version;
    return rows;
  };
  const auto undone = [&all](storage::AccessVersion version) {
    AllAccess store = all(version);
    store.revocations[1].revoked = false;
    store.settings[0].blocked = false;
    store.settings[1].registered = false;
    return store;
  };
  EXPECT_EQ(LackedBy(all(1), known), 0U);
  EXPECT_EQ(LackedBy(undone(known.version + 1), known), 0U) << "operators did it since";
  EXPECT_EQ(LackedBy(undone(known.version), known), 3U) << "earlier rows, before the decisions";
  AllAccess store = all(known.version + 1);
  store.revocations.pop_back();
  store.settings.erase(store.settings.begin());
  EXPECT_EQ(LackedBy(store, known), 2U);
  EXPECT_EQ(LackedBy({}, known), 5U);
  EXPECT_EQ(LackedBy({}, {}), 0U);
}

class SavedAccessFile : public ::testing::Test {
 protected:
  ~SavedAccessFile() override { std::filesystem::remove_all(folder_); }
  static std::filesystem::path Make() {
    std::string name = ::testing::TempDir() + "accessXXXXXX";
    EXPECT_NE(::mkdtemp(name.data()), nullptr);
    return name;
  }
  const std::filesystem::path folder_ = Make();
  const std::string path_ = (folder_ / "access").string();
};

TEST_F(SavedAccessFile, OnlyItsOwnerReadsIt) {
  ASSERT_TRUE(SaveAccess(path_, "first").ok());
  ASSERT_TRUE(SaveAccess(path_, "second").ok());
  struct stat status {};
  ASSERT_EQ(::stat(path_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0600U);
  EXPECT_EQ(ReadSavedAccess(path_).value(), "second");
  EXPECT_FALSE(std::filesystem::exists(path_ + ".new"));
}

TEST_F(SavedAccessFile, OneThatOthersMayWriteDoesNotCount) {
  ASSERT_TRUE(SaveAccess(path_, "text").ok());
  ASSERT_EQ(::chmod(path_.c_str(), 0620), 0);
  EXPECT_EQ(ReadSavedAccess(path_).status().code(), absl::StatusCode::kFailedPrecondition);
}

TEST_F(SavedAccessFile, AFolderThatIsMissingIsSaid) {
  const std::string path = (folder_ / "none" / "access").string();
  const absl::Status saved = SaveAccess(path, "text");
  EXPECT_EQ(saved.message(), path + ".new: cannot be made: No such file or directory");
  EXPECT_EQ(ReadSavedAccess(path).status().code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace uplink::store
