#include "schema/base/unread.h"

#include <cerrno>

#include <gtest/gtest.h>

namespace uplink {
namespace {

TEST(UnreadTextTest, SaysWhyAndWhatToDo) {
  EXPECT_EQ(UnreadText("/etc/x.toml", ENOENT),
            "cannot be read: No such file or directory; correct the path, or make the file");
  EXPECT_EQ(UnreadText("x.toml", ENOENT),
            "cannot be read: No such file or directory; correct the path, which starts at the "
            "working directory, or make the file");
  EXPECT_EQ(UnreadText("/etc/x.toml", EACCES),
            "cannot be read: Permission denied; let this user read it");
  EXPECT_EQ(UnreadText("/etc", EISDIR), "cannot be read: Is a directory; name a file");
  EXPECT_EQ(UnreadText("/etc/x.toml", EIO), "cannot be read: Input/output error");
}

}  // namespace
}  // namespace uplink
