#include "server/session/pending_batch.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace uplink::session {
namespace {

TEST(PendingBatchTest, MessagesAreTakenInOrder) {
  const std::vector<UplinkView> uplinks = {{.seq = 1}, {.seq = 2}};
  PendingBatch batch;
  EXPECT_TRUE(batch.empty());
  batch.Begin(uplinks);
  EXPECT_EQ(batch.front().seq, 1U);
  batch.PopFront();
  EXPECT_EQ(batch.front().seq, 2U);
  batch.PopFront();
  EXPECT_TRUE(batch.empty());
}

TEST(PendingBatchTest, WhatIsKeptOutlivesTheFrame) {
  std::string frame = "onetwothree";
  const std::string_view bytes = frame;
  std::vector<UplinkView> uplinks = {{.seq = 1, .payload = bytes.substr(0, 3)},
                                     {.seq = 2, .payload = bytes.substr(3, 3)},
                                     {.seq = 3, .payload = bytes.substr(6)}};
  PendingBatch batch;
  batch.Begin(uplinks);
  batch.PopFront();
  batch.Keep();
  frame.assign(frame.size(), 'x');
  uplinks.clear();
  EXPECT_EQ(batch.front().payload, "two");
  batch.PopFront();
  batch.Keep();
  EXPECT_EQ(batch.front().seq, 3U);
  EXPECT_EQ(batch.front().payload, "three");
}

TEST(PendingBatchTest, WhatIsDroppedIsNotPending) {
  const std::vector<UplinkView> uplinks = {{.seq = 1}};
  PendingBatch batch;
  batch.Begin(uplinks);
  batch.Keep();
  batch.Drop();
  EXPECT_TRUE(batch.empty());
}

}  // namespace
}  // namespace uplink::session
