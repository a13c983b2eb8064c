#include "server/front/door/acceptor.h"

#include <atomic>
#include <cerrno>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/support/eventually.h"

// Where all descriptors are used up UBSan cannot look at memory, and takes good objects for none.
#if !defined(__SANITIZE_ADDRESS__)
namespace uplink::front {
namespace {

using testing::Eventually;

/// While it lives, the process gets no descriptor that it has not already.
class NoDescriptors final {
 public:
  NoDescriptors() {
    getrlimit(RLIMIT_NOFILE, &before_);
    const Descriptor next(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    rlimit now = before_;
    now.rlim_cur = static_cast<rlim_t>(next.get());
    setrlimit(RLIMIT_NOFILE, &now);
  }
  ~NoDescriptors() { setrlimit(RLIMIT_NOFILE, &before_); }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit before_{};
};

TEST(Acceptor, WithoutADescriptorItPausesSaysSoAndGoesOn) {
  std::atomic<int> accepted{0};
  std::atomic<int> pauses{0};
  std::atomic<int> why{0};
  auto acceptor = Acceptor::Listen({.host = "127.0.0.1", .port = 0});
  ASSERT_TRUE(acceptor.ok()) << acceptor.status();
  (*acceptor)->Start([&](const Accepted&) { ++accepted; }, {.tick = [] {},
                                                            .paused =
                                                                [&](std::error_code error) {
                                                                  why = error.value();
                                                                  ++pauses;
                                                                }});
  const Descriptor client(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons((*acceptor)->port());
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  {
    const NoDescriptors none;
    ASSERT_EQ(::connect(client.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_TRUE(Eventually([&] { return pauses >= 2; }));
    EXPECT_EQ(why, EMFILE);
    EXPECT_EQ(accepted, 0);
  }
  EXPECT_TRUE(Eventually([&] { return accepted == 1; }));
}

}  // namespace
}  // namespace uplink::front
#endif
