#include <gtest/gtest.h>

#include "tools/link/http_client.h"

namespace uplink::link {
namespace {

TEST(HttpAnswer, AnErrorHasTheBeginningOfTheBodyAsATerminalMayHaveIt) {
  EXPECT_EQ(ErrorOf("/api", {500, "\x1b[2Jgone\r\n"}),
            absl::InternalError("GET /api: 500: \\x1b[2Jgone\\x0d\\x0a"));
  EXPECT_EQ(ErrorOf("/api", {404, std::string(400, 'x')}),
            absl::NotFoundError("GET /api: 404: " + std::string(300, 'x')));
}

}  // namespace
}  // namespace uplink::link
