#include "server/transport/listenable.h"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

#include <gtest/gtest.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>

namespace uplink::transport {
namespace {

/// From now on this process is one of a machine without IPv6.
bool LoseIpv6() {
  std::array<sock_filter, 6> filter = {{
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_socket, 0, 3),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AF_INET6, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EAFNOSUPPORT),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  }};
  const sock_fprog program{filter.size(), filter.data()};
  return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

/// 0 if the address can be listened on without IPv6, 1 if not, 2 if the machine kept its IPv6.
[[noreturn]] void CheckWithoutIpv6(const config::ListenAddress& address) {
  if (!LoseIpv6() || ::socket(AF_INET6, SOCK_STREAM, 0) >= 0) std::_Exit(2);
  std::_Exit(CheckListenable(address).ok() ? 0 : 1);
}

class ListenableDeathTest : public ::testing::Test {
 protected:
  void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(ListenableDeathTest, WithoutIpv6TheAnyAddressIsThatOfIpv4) {
  EXPECT_EXIT(CheckWithoutIpv6({"::", 0}), ::testing::ExitedWithCode(0), "");
}

TEST_F(ListenableDeathTest, WithoutIpv6AnAddressOfItIsNone) {
  EXPECT_EXIT(CheckWithoutIpv6({"::1", 0}), ::testing::ExitedWithCode(1), "");
}

}  // namespace
}  // namespace uplink::transport
