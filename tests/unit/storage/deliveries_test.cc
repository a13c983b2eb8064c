#include "storage/deliveries.h"

#include <algorithm>
#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/remember.h"
#include "tests/support/fake_topics.h"

namespace uplink::storage {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Delivery Of(std::uint64_t number, std::uint16_t packet_id) {
  return {number, packet_id, DeliveryDigest{static_cast<std::uint8_t>(packet_id)}};
}

TEST(DeliveryMemory, EndsWithALostSessionAndWithEachPacketIdThatIsUsedAnew) {
  EXPECT_EQ(MemoryOf({}).last_number, 0U);
  const DeliveryMemory memory = MemoryOf({Of(1, 7),
                                          Of(2, 8),
                                          {3, 0, std::nullopt},
                                          Of(5, 8),
                                          Of(6, 9),
                                          Of(7, 10),
                                          {8, 9, std::nullopt},
                                          Of(9, 8)});
  EXPECT_EQ(memory.last_number, 9U);
  EXPECT_THAT(memory.known, ElementsAre(Of(7, 10), Of(9, 8)));
  EXPECT_THAT(MemoryOf({Of(1, 7), {3, 0, std::nullopt}}).known, IsEmpty());
}

TEST(DeliveryMemory, IsNumberedAnewAboveWhatWasGiven) {
  const DeliveryMemory anew = NumberedAnew({20, {Of(11, 1), Of(12, 2), Of(17, 3), Of(20, 4)}}, 8);
  EXPECT_THAT(anew.known, ElementsAre(Of(21, 3), Of(22, 4)));
  EXPECT_EQ(anew.last_number, 22U);
  EXPECT_EQ(NumberedAnew({3, {}}, 8).last_number, 3U);
}

TEST(DeliveryMemory, ReachesAsFarAsThereArePacketIds) {
  EXPECT_LE(kDeliveriesMax, 65'535U);
  EXPECT_EQ(kDeliveriesMax, DeliveriesKept(kUnackedMaxMax));
}

TEST(DeliveryChanges, AMessageThatDoesNotStandInOneBatchIsABugOfOurs) {
  Batch batch;
  batch.records.push_back({.content = QuarantineItem()});
  CommitRecord& record = batch.records.back();
  record.origin = OriginOf(model::MessageSource::kCyberwave, "t",
                           std::make_shared<const TopicHold>(TopicHold{"c", 1}));
  const std::vector<Outcome> stored(1);
  const auto changes = [&] {
    return DeliveryChangesOf(batch, stored, [](const TopicHold&) { return true; });
  };
  record.message_end = {{Of(1, 7)}, 1};
  EXPECT_EQ(changes()->added.size(), 1U);
  record.message_end->records = 2;
  EXPECT_DEATH(static_cast<void>(changes()), "stand in one batch");
  record.message_end->records = 0;
  EXPECT_DEATH(static_cast<void>(changes()), "stand in one batch");
}

/// A broker with a kept session, a server that is killed at any time, and what the store remembers.
class Redelivery {
 public:
  explicit Redelivery(std::uint32_t seed) : random_(seed) {}

  /// One process, from its lease to its end.
  void Live() {
    ++process_;
    TakeRequest request;
    request.client_id = "c";
    request.prefixes = {""};
    request.unacked_max = kUnackedMax;
    request.over = {{ProcessId{static_cast<std::uint8_t>(process_ - 1)}, 0}};
    const auto epoch = topics_.Take(
        request, ProcessId{static_cast<std::uint8_t>(process_)},
        [](const ProcessId&, std::uint64_t) { return false; }, [this] { return ++epochs_; });
    hold_ = std::make_shared<const TopicHold>(TopicHold{"c", *epoch, kUnackedMax});
    const DeliveryMemory memory = topics_.MemoryOf("c");
    number_ = memory.last_number;
    for (Message& message : unacked_) {
      const bool known = std::ranges::any_of(memory.known, [&](const Delivery& delivery) {
        return delivery.packet_id == message.packet_id && delivery.digest == message.digest;
      });
      if (known) {
        message.committed = true;
      } else {
        Arrive(message);
      }
    }
    acks_reach_ = true;
    for (auto steps = random_() % 40; steps > 0; --steps) Step();
  }

  /// The most that any message was stored.
  [[nodiscard]] std::uint32_t stored_max() const { return stored_max_; }
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  [[nodiscard]] std::uint64_t acked() const { return acked_; }

 private:
  static constexpr std::uint32_t kUnackedMax = 12;

  struct Message {
    std::uint16_t packet_id = 0;
    DeliveryDigest digest{};
    std::uint32_t stored = 0;
    /// By what the process that lives knows.
    bool committed = false;
    std::uint64_t number = 0;
  };

  void Arrive(Message& message) {
    message.committed = false;
    message.number = ++number_;
  }
  void Step() {
    while (unacked_.size() < kUnackedMax && acks_reach_) {
      Message& message = unacked_.emplace_back();
      message.packet_id = static_cast<std::uint16_t>(1 + published_ % 65'535);
      for (std::size_t i = 0; i < 8; ++i) {
        message.digest[i] = static_cast<std::uint8_t>(published_ >> (8 * i));
      }
      ++published_;
      Arrive(message);
    }
    // Mostly the last, as where a shard is stuck.
    std::vector<Message*> waiting;
    for (Message& message : unacked_) {
      if (!message.committed) waiting.push_back(&message);
    }
    if (!waiting.empty()) {
      Commit(random_() % 4 != 0 ? *waiting.back() : *waiting[random_() % waiting.size()]);
    }
    if (random_() % 16 == 0) acks_reach_ = false;
    while (acks_reach_ && !unacked_.empty() && unacked_.front().committed) {
      if (unacked_.front().stored == 0) ++lost_;
      ++acked_;
      unacked_.pop_front();
    }
  }
  void Commit(Message& message) {
    Batch batch;
    batch.deliveries = {{hold_, {{message.number, message.packet_id, message.digest}}}};
    topics_.Write(batch, ProcessId{static_cast<std::uint8_t>(process_)}, {});
    message.committed = true;
    stored_max_ = std::max(stored_max_, ++message.stored);
  }

  std::mt19937 random_;
  testing::FakeTopics topics_;
  TopicHoldRef hold_;
  Epoch epochs_ = 0;
  std::uint64_t process_ = 0;
  std::uint64_t number_ = 0;
  std::deque<Message> unacked_;
  std::uint64_t published_ = 0;
  bool acks_reach_ = true;
  std::uint32_t stored_max_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t acked_ = 0;
};

TEST(DeliveryMemory, NoNumberOfKillsMakesItForgetWhatTheBrokerMayDeliverAgain) {
  std::uint64_t acked = 0;
  for (std::uint32_t seed = 1; seed <= 300; ++seed) {
    Redelivery redelivery(seed);
    for (int life = 0; life < 60; ++life) redelivery.Live();
    EXPECT_EQ(redelivery.stored_max(), 1U) << "seed " << seed;
    EXPECT_EQ(redelivery.lost(), 0U) << "seed " << seed;
    acked += redelivery.acked();
  }
  EXPECT_GT(acked, 10'000U);
}

}  // namespace
}  // namespace uplink::storage
