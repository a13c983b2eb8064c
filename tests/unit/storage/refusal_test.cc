#include "storage/refusal.h"

#include <string>

#include <gtest/gtest.h>

#include "schema/model/ids.h"

namespace uplink::storage {
namespace {

TEST(StoreRefused, SaysTheCause) {
  const model::Rejection rejection = StoreRefused("too big");
  EXPECT_EQ(rejection.reason, model::RejectReason::kStoreRefused);
  EXPECT_EQ(rejection.field, "");
  EXPECT_NE(rejection.detail.find("too big"), std::string::npos);
}

TEST(StoreRefused, CutsALongCauseAtACharacter) {
  std::string cause;
  while (cause.size() < 2 * model::kDetailBytesMax) cause += "\xC3\xA9";
  const std::string detail = StoreRefused(cause).detail;
  EXPECT_LE(detail.size(), model::kDetailBytesMax);
  EXPECT_GE(detail.size(), model::kDetailBytesMax - 1);
  EXPECT_EQ(detail.back(), '\xA9');
}

TEST(StoreRefused, LeavesOutACauseThatIsNoText) {
  EXPECT_EQ(StoreRefused("\xFF").detail.find('\xFF'), std::string::npos);
}

TEST(TooMany, NamesTheFieldAndTheBound) {
  for (const model::Rejection& rejection :
       {TooManyActiveFaults(), TooManyShapes(), TooManyObjects()}) {
    EXPECT_EQ(rejection.reason, model::RejectReason::kTooManyItems);
    EXPECT_NE(rejection.detail.find(" 10000 "), std::string::npos) << rejection.detail;
    EXPECT_LE(rejection.detail.size(), model::kDetailBytesMax);
  }
  EXPECT_EQ(TooManyActiveFaults().field, "faultId");
  EXPECT_EQ(TooManyShapes().field, "upsert.identity.id");
  EXPECT_EQ(TooManyObjects().field, "upsert.id");
}

}  // namespace
}  // namespace uplink::storage
