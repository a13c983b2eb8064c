// The WAL of a store while another connection reads an old state, and once that is over.
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/sqlite/reader.h"
#include "storage/sqlite/store_files.h"
#include "storage/sqlite/wal.h"
#include "tests/support/sqlite_shell.h"
#include "tests/unit/storage/fault_store.h"

namespace uplink::storage::sqlite {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr std::int64_t kPage = 4096;
constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

/// A WAL of `frames` frames; `moved` of them are in the database.
WalIndex IndexOf(std::uint32_t frames, std::uint32_t moved, std::uint32_t pages = 0) {
  WalIndex index;
  index.header[4] = frames;
  index.header[5] = pages;
  index.moved = moved;
  return index;
}

TEST(WalStateTest, AWalThatWasMovedWholeIsWrittenOver) {
  const WalState state = WalStateOf(IndexOf(10, 10, 50), {.wal = 90'000, .database = 50 * kPage});
  EXPECT_EQ(state.bytes, 90'000U);
  EXPECT_EQ(state.reusable_bytes, 90'000U);
  EXPECT_EQ(state.owed_bytes, 0U);
  EXPECT_EQ(state.unmoved, 0U);
}

TEST(WalStateTest, AFrameThatIsLeftKeepsAllFramesAndWhatIsBehindThemIsFree) {
  const WalSizes sizes{.wal = EndOfFrame(10, kPage) + 77, .database = 48 * kPage, .page = kPage};
  const WalState state = WalStateOf(IndexOf(10, 9, 50), sizes);
  EXPECT_EQ(state.unmoved, 1U);
  EXPECT_EQ(state.reusable_bytes, 77U);
  EXPECT_EQ(state.owed_bytes, std::uint64_t{2 * kPage});
}

TEST(WalStateTest, NothingIsNegativeWhileTheFilesChange) {
  const WalSizes sizes{.wal = 0, .database = 60 * kPage, .page = kPage};
  const WalState state = WalStateOf(IndexOf(10, 9, 50), sizes);
  EXPECT_EQ(state.reusable_bytes, 0U);
  EXPECT_EQ(state.owed_bytes, 0U);
}

TEST(WalStateTest, IsHeldOnceACommitShouldHaveMovedIt) {
  EXPECT_FALSE(WalStateOf(IndexOf(kMovedAtFrames + 4, 5), {}).held());
  EXPECT_TRUE(WalStateOf(IndexOf(kMovedAtFrames + 5, 5), {}).held());
}

TEST(WalHoldAgeTest, CountsWhileTheSameFrameIsHeld) {
  WalHoldAge age;
  const SteadyTime start{};
  const auto at = [&](int seconds) { return start + std::chrono::seconds(seconds); };
  const auto held = [](std::uint32_t moved) {
    return WalStateOf(IndexOf(moved + kMovedAtFrames, moved), {});
  };
  EXPECT_EQ(age.Note(held(7), at(0)), milliseconds(0));
  EXPECT_EQ(age.Note(held(7), at(10)), milliseconds(10'000));
  EXPECT_EQ(age.Note(held(8), at(20)), milliseconds(0)) << "another reader, of a later state";
  EXPECT_EQ(age.Note(held(8), at(25)), milliseconds(5'000));
  EXPECT_EQ(age.Note(WalStateOf(IndexOf(8, 8), {}), at(30)), milliseconds(0));
  EXPECT_EQ(age.Note(held(8), at(40)), milliseconds(0));
}

/// A store on a disk that has left what the test says.
class SqliteWal : public FaultStore {
 protected:
  void SetUp() override {
    FaultStore::SetUp();
    StoreOptions options;
    options.disk_space = [this](const std::string&) -> absl::StatusOr<DiskSpace> { return disk_; };
    OpenStore(path_, std::move(options));
  }

  /// About a MiB of rows that no later ones replace.
  absl::Status CommitMuch() {
    Batch batch;
    for (int i = 0; i < 100; ++i) {
      model::Message message;
      message.message = std::string(8000, 'm');
      batch.records.push_back(
          {robot_, {}, ++seq_, 1, FromUnixMs(1), test::RecordOf(message), "bytes", 5});
    }
    absl::Status status = store_->Commit(batch).status();
    if (!status.ok()) seq_ -= batch.records.size();
    return status;
  }
  void GrowTo(std::uint64_t bytes) {
    for (int i = 0; i < 100 && WalBytes() < bytes; ++i) ASSERT_TRUE(CommitMuch().ok());
    ASSERT_GE(WalBytes(), bytes);
  }
  [[nodiscard]] std::uint64_t WalBytes() const { return fs::file_size(path_ + "-wal"); }
  /// By how much the file grows once all of the WAL is in it.
  [[nodiscard]] std::uint64_t Owed() const {
    const auto pages = std::stoull(testing::SqliteShell(path_).Read("PRAGMA page_count"));
    return pages * kPage - fs::file_size(path_);
  }
  /// Another connection that reads the state of now until it is gone.
  [[nodiscard]] std::unique_ptr<testing::SqliteShell> Hold() const {
    auto holder = std::make_unique<testing::SqliteShell>(path_);
    holder->Run("BEGIN");
    static_cast<void>(holder->Read("SELECT COUNT(*) FROM messages"));
    return holder;
  }

  DiskSpace disk_{.free_bytes = 900 * kMiB, .total_bytes = 1000 * kMiB};
  model::Seq seq_ = 0;
};

TEST_F(SqliteWal, ThatGrewUnderAReaderIsCutByTheNextCommits) {
  auto holder = Hold();
  GrowTo(24 * kMiB);
  holder.reset();
  ASSERT_TRUE(CommitMuch().ok());
  ASSERT_TRUE(CommitMuch().ok()) << "the WAL begins anew";
  EXPECT_EQ(WalBytes(), 16 * kMiB);
}

TEST_F(SqliteWal, GivesItsRoomBackWhereTheDiskIsShortThoughNothingIsStored) {
  auto holder = Hold();
  GrowTo(12 * kMiB);
  const std::uint64_t grown = WalBytes();
  disk_.free_bytes = grown - 1;
  // A duty of the journal, without a row to write.
  ASSERT_FALSE(store_->Sweep(FromUnixMs(1)).ok());
  EXPECT_EQ(WalBytes(), grown) << "it is read";
  holder.reset();
  ASSERT_TRUE(store_->Sweep(FromUnixMs(1)).ok());
  EXPECT_EQ(WalBytes(), 0U);
  EXPECT_TRUE(CommitMuch().ok());
  EXPECT_EQ(Faults(path_), "0\n");
  EXPECT_EQ(Shell(path_, "SELECT COUNT(*) FROM messages"), std::to_string(seq_) + "\n");
}

TEST_F(SqliteWal, StaysWhereTheDiskHasAsMuchLeft) {
  auto holder = Hold();
  GrowTo(12 * kMiB);
  const std::uint64_t grown = WalBytes();
  holder.reset();
  ASSERT_TRUE(store_->Sweep(FromUnixMs(1)).ok());
  EXPECT_EQ(WalBytes(), grown) << "the next commits write over it";
}

TEST_F(SqliteWal, LeavesTheRoomThatMovingItTakes) {
  auto holder = Hold();
  GrowTo(10 * kMiB);
  const std::uint64_t room = RoomOfTransaction(disk_);
  EXPECT_EQ(room, 16 * kMiB);
  disk_.free_bytes = Owed() + room;
  EXPECT_TRUE(CommitMuch().ok()) << "exactly as much as is needed";
  const std::uint64_t grown = WalBytes();
  disk_.free_bytes = Owed() + room - 1;
  const absl::Status full = CommitMuch();
  EXPECT_EQ(full.code(), absl::StatusCode::kResourceExhausted) << full;
  EXPECT_THAT(std::string(full.message()), HasSubstr(path_));
  EXPECT_THAT(std::string(full.message()), HasSubstr("another program reads"));
  EXPECT_EQ(WalBytes(), grown);
  holder.reset();
  EXPECT_TRUE(CommitMuch().ok()) << "it was moved into the file";
}

TEST_F(SqliteWal, OfASmallDiskNeedsAnEighthOfIt) {
  EXPECT_EQ(RoomOfTransaction({.free_bytes = 0, .total_bytes = 40 * kMiB}), 5 * kMiB);
  EXPECT_EQ(RoomOfTransaction({.free_bytes = 0, .total_bytes = 128 * kMiB}), 16 * kMiB);
  EXPECT_EQ(RoomOfTransaction({.free_bytes = 0, .total_bytes = 129 * kMiB}), 16 * kMiB);
}

TEST_F(SqliteWal, WithFewFramesLeftNeedsNoRoomBesideIt) {
  auto holder = Hold();
  GrowTo(5 * kMiB);
  disk_.free_bytes = 0;
  EXPECT_TRUE(CommitMuch().ok());
}

TEST_F(SqliteWal, CountsAsFreeOnceItIsMovedAndAsTakenUntilThen) {
  const auto reader = SqliteReader::Open(path_);
  ASSERT_TRUE(reader.ok()) << reader.status();
  // More than the disk says, or less; others write to it meanwhile.
  const auto expect_beyond_disk = [&](std::int64_t bytes) {
    std::int64_t beyond = 0;
    for (int i = 0; i < 1'000; ++i) {
      const auto before = DiskSpaceOf(path_);
      const auto space = (*reader)->Space();
      const auto after = DiskSpaceOf(path_);
      ASSERT_TRUE(before.ok() && space.ok() && after.ok()) << space.status();
      EXPECT_EQ(space->wal_bytes, WalBytes());
      beyond = static_cast<std::int64_t>(space->free_bytes - before->free_bytes);
      if (before->free_bytes == after->free_bytes && beyond == bytes) return;
    }
    EXPECT_EQ(beyond, bytes);
  };
  auto holder = Hold();
  GrowTo(12 * kMiB);
  const auto free_pages = [&] {
    return std::stoll(testing::SqliteShell(path_).Read("PRAGMA freelist_count")) * kPage;
  };
  expect_beyond_disk(free_pages() - static_cast<std::int64_t>(Owed()));
  holder.reset();
  ASSERT_TRUE(store_->Sweep(FromUnixMs(1)).ok());
  expect_beyond_disk(free_pages() + static_cast<std::int64_t>(WalBytes() - kWalLargeBytes));
}

TEST_F(SqliteWal, AReaderThatKeepsItHasAnAge) {
  const auto reader = SqliteReader::Open(path_);
  ASSERT_TRUE(reader.ok()) << reader.status();
  const auto age = [&](int seconds) {
    return (*reader)->OldestSnapshot(SteadyTime() + std::chrono::seconds(seconds)).value();
  };
  auto holder = Hold();
  EXPECT_EQ(age(0), milliseconds(0));
  GrowTo(8 * kMiB);
  EXPECT_EQ(age(10), milliseconds(0));
  EXPECT_EQ(age(30), milliseconds(20'000));
  holder.reset();
  ASSERT_TRUE(store_->Sweep(FromUnixMs(1)).ok());
  EXPECT_EQ(age(40), milliseconds(0));
}

}  // namespace
}  // namespace uplink::storage::sqlite
