#pragma once

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/fake_store.h"

namespace uplink::store {

/// Opens a stream of the robot `ruri` at `store`, whose process holds it then.
inline void Know(storage::Store& store, const std::string& ruri, SystemTime at,
                 const std::string& fleet = "f") {
  const storage::OpenRequest request{
      std::make_shared<const model::RobotId>(model::RobotId{ruri, fleet}),
      model::SessionId({1}),
      0,
      at,
      {}};
  ASSERT_TRUE(store.OpenStreams({&request, 1}).ok());
}

}  // namespace uplink::store
