#include "tools/uplinkctl/doctor/machine_check.h"

#include <algorithm>
#include <cerrno>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

namespace uplink::ctl {
namespace {

using ::testing::HasSubstr;

// As Linux writes them on a little-endian machine.
constexpr const char* kTables =
    "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout "
    "inode\n"
    "   0: 0100007F:1D38 00000000:0000 0A 00000000:00000000 00:00000000 00000000   997        0 "
    "4711 1 0000000000000000 100 0 0 10 0\n"
    "   1: 0100007F:1D38 0100007F:A2F4 01 00000000:00000000 00:00000000 00000000   997        0 "
    "4712 1 0000000000000000 20 4 30 10 -1\n"
    "   2: 00000000000000000000000000000000:1D13 00000000000000000000000000000000:0000 0A "
    "00000000:00000000 00:00000000 00000000   997        0 4713 1 0000000000000000 100 0 0 10 0\n"
    "a broken line\n"
    "   3: 00:1D13 00:0000 0A 0:0 0:0 0 0 0 1\n";

Listener Relay() { return {"listen.relay", {"::", 7443}}; }

/// uplinkd (pid 10, user 997) listens on [::]:7443.
MachineFacts Machine() {
  MachineFacts machine;
  machine.sockets.push_back({"::", 7443, 997, 4713});
  machine.holders[4713] = {10, "uplinkd", 997};
  machine.servers.push_back({{10, "uplinkd", 997}, 65'536});
  return machine;
}

/// The configuration's relay alone, which is in use.
Finding FindingOfRelay(const MachineFacts& machine) {
  const PortFacts port{Relay(), EADDRINUSE};
  return PortFinding(port, machine, {"uplinkd", OwnServer({port}, machine)});
}

/// As a configuration has them, with errors of TryToBind.
std::vector<PortFacts> Ports(int relay, int http) {
  return {{Relay(), relay}, {{"listen.http", {"127.0.0.1", 7480}}, http}};
}

TEST(MachineFacts, SocketsThatListenAreRead) {
  const auto sockets = ParseSockets(kTables);
  ASSERT_EQ(sockets.size(), 2U);
  EXPECT_EQ(sockets[0].host, "127.0.0.1");
  EXPECT_EQ(sockets[0].port, 7480);
  EXPECT_EQ(sockets[0].owner, 997U);
  EXPECT_EQ(sockets[0].inode, 4711U);
  EXPECT_EQ(sockets[1].host, "::");
  EXPECT_EQ(sockets[1].port, 7443);
}

TEST(MachineFacts, TheSoftLimitIsRead) {
  constexpr const char* kLimits =
      "Limit                     Soft Limit           Hard Limit           Units     \n"
      "Max open files            65536                524288               files     \n";
  EXPECT_EQ(ParseDescriptorsMax(kLimits), 65'536U);
  EXPECT_EQ(ParseDescriptorsMax("Max open files            unlimited  unlimited files"),
            kDescriptorsUnlimited);
  EXPECT_EQ(ParseDescriptorsMax(""), std::nullopt);
}

TEST(MachineFacts, ThisProcessIsSeen) {
  const MachineFacts machine = ReadMachine();
  EXPECT_TRUE(machine.own_descriptors_max.value_or(1) > 0);
  EXPECT_EQ(TryToBind({"127.0.0.1", 0}), 0);
  EXPECT_EQ(TryToBind({"no address", 0}), EINVAL);
  // RFC 5737: no machine has it.
  EXPECT_EQ(TryToBind({"192.0.2.1", 0}), EADDRNOTAVAIL);
}

TEST(PortCheck, AFreePortIsGood) {
  EXPECT_EQ(PortFinding({Relay(), 0}, {}, {"uplinkd", {}}),
            Ok("listen.relay", "[::]:7443 is free"));
}

TEST(PortCheck, OneThatTheServerHoldsIsGood) {
  EXPECT_EQ(FindingOfRelay(Machine()),
            Ok("listen.relay", "[::]:7443 is held by the running uplinkd (pid 10)"));
}

TEST(PortCheck, AServerWhoseSocketsAreHiddenIsKnownByItsUser) {
  MachineFacts machine = Machine();
  machine.holders.clear();
  EXPECT_EQ(FindingOfRelay(machine).severity, Severity::kOk);
  machine.sockets.front().owner = 33;
  EXPECT_THAT(FindingOfRelay(machine).what, HasSubstr("held by a program of user id 33"));
}

TEST(PortCheck, AnotherHolderIsNamed) {
  MachineFacts machine = Machine();
  // The server runs, on other ports.
  machine.holders[4713] = {20, "nginx", 33};
  const Finding finding = FindingOfRelay(machine);
  EXPECT_EQ(finding.severity, Severity::kError);
  EXPECT_EQ(finding.what, "[::]:7443 is held by nginx (pid 20)");
  EXPECT_THAT(finding.remedy, HasSubstr("listen.relay to another port"));
}

TEST(PortCheck, AnAddressOfIpv4IsHeldByASocketOnAllAddresses) {
  MachineFacts machine = Machine();
  const auto holder = [&machine](const char* host) {
    return PortFinding({{"listen.relay", {host, 7443}}, EADDRINUSE}, machine, {"uplinkd", {}}).what;
  };
  machine.holders[4713] = {20, "nginx", 33};
  EXPECT_EQ(holder("0.0.0.0"), "0.0.0.0:7443 is held by nginx (pid 20)");
  EXPECT_EQ(holder("127.0.0.1"), "127.0.0.1:7443 is held by nginx (pid 20)");
  // Then that on [::] is for IPv6 alone.
  machine.sockets.push_back({"0.0.0.0", 7443, 0, 4714});
  machine.holders[4714] = {30, "haproxy", 0};
  EXPECT_EQ(holder("0.0.0.0"), "0.0.0.0:7443 is held by haproxy (pid 30)");
}

TEST(PortCheck, AnotherFamilysAddressHoldsNothing) {
  MachineFacts machine;
  machine.sockets.push_back({"::1", 7443, 997, 4713});
  const PortFacts port{{"listen.relay", {"0.0.0.0", 7443}}, EADDRINUSE};
  EXPECT_EQ(PortFinding(port, machine, {"uplinkd", {}}).what,
            "0.0.0.0:7443 is held by another program");
}

TEST(PortCheck, AServerOfAnotherUserIsNotOurs) {
  EXPECT_EQ(FindingOfRelay(WithServersOf(997, Machine())).severity, Severity::kOk);
  MachineFacts others = Machine();
  others.holders[4713].owner = 65'534;
  others.servers.front().owner = 65'534;
  const Finding finding = FindingOfRelay(WithServersOf(997, others));
  EXPECT_EQ(finding.severity, Severity::kError);
  EXPECT_EQ(finding.what, "[::]:7443 is held by a program named uplinkd of user id 65534 (pid 10)");
}

TEST(OwnServerCheck, OneProcessHasEveryPort) {
  MachineFacts machine = Machine();
  EXPECT_EQ(OwnServer(Ports(EADDRINUSE, 0), machine), std::nullopt);
  machine.sockets.push_back({"127.0.0.1", 7480, 997, 4714});
  machine.holders[4714] = {10, "uplinkd", 997};
  const auto own = OwnServer(Ports(EADDRINUSE, EADDRINUSE), machine);
  ASSERT_TRUE(own.has_value());
  EXPECT_EQ(own->pid, 10);
  // Another server's.
  machine.holders[4714] = {11, "uplinkd", 997};
  machine.servers.push_back({{11, "uplinkd", 997}, 65'536});
  EXPECT_EQ(OwnServer(Ports(EADDRINUSE, EADDRINUSE), machine), std::nullopt);
}

TEST(OwnServerCheck, APortThatMayBeAnyDoesNotCount) {
  std::vector<PortFacts> ports = Ports(EADDRINUSE, 0);
  EXPECT_TRUE(FixesPort(ports));
  ports[1].listener.address.port = 0;
  EXPECT_TRUE(OwnServer(ports, Machine()).has_value());
  ports[0] = {{"listen.relay", {"::", 0}}, 0};
  EXPECT_EQ(OwnServer(ports, Machine()), std::nullopt);
  EXPECT_FALSE(FixesPort(ports));
}

TEST(OwnServerCheck, AServerThatStartsHasNoRelayYet) {
  MachineFacts machine;
  machine.sockets.push_back({"127.0.0.1", 7480, 997, 4714});
  machine.holders[4714] = {10, "uplinkd", 997};
  machine.servers.push_back({{10, "uplinkd", 997}, 65'536});
  EXPECT_TRUE(OwnServer(Ports(0, EADDRINUSE), machine).has_value());
  // Its relay is elsewhere.
  machine.sockets.push_back({"::", 7444, 997, 4715});
  machine.holders[4715] = {10, "uplinkd", 997};
  EXPECT_EQ(OwnServer(Ports(0, EADDRINUSE), machine), std::nullopt);
}

TEST(OwnServerCheck, AServerOfAnotherConfigurationIsNamed) {
  const PortFacts port{Relay(), EADDRINUSE};
  const Finding finding =
      PortFinding(port, Machine(), {"uplinkd", OwnServer(Ports(EADDRINUSE, 0), Machine())});
  EXPECT_EQ(finding.severity, Severity::kError);
  EXPECT_EQ(finding.what, "[::]:7443 is held by an uplinkd of another configuration (pid 10)");
  EXPECT_THAT(finding.remedy, HasSubstr("stop that server"));
}

TEST(PortCheck, AHolderThatCameLaterIsLookedUp) {
  EXPECT_FALSE(HasUnknownHolder(Ports(EADDRINUSE, 0), Machine()));
  EXPECT_FALSE(HasUnknownHolder(Ports(0, 0), {}));
  EXPECT_TRUE(HasUnknownHolder(Ports(0, EADDRINUSE), Machine()));
}

TEST(MachineFacts, AHolderThatWasKnownStaysKnown) {
  const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ASSERT_EQ(::listen(listener, 1), 0);
  MachineFacts before = ReadMachine();
  const auto own = std::find_if(before.holders.begin(), before.holders.end(),
                                [](const auto& each) { return each.second.pid == ::getpid(); });
  ASSERT_NE(own, before.holders.end());
  EXPECT_EQ(ReadMachineAgain({}).holders.at(own->first).pid, ::getpid());
  // A socket that is gone is forgotten.
  before.holders[1] = {1, "init", 0};
  EXPECT_FALSE(ReadMachineAgain(before).holders.contains(1));
  ::close(listener);
}

TEST(PortCheck, EachRefusalHasItsRemedy) {
  const auto finding = [](int error) {
    return PortFinding({{"listen.relay", {"::", 443}}, error}, {}, {"uplinkd", {}});
  };
  EXPECT_THAT(finding(EACCES).what, HasSubstr("uplinkd may not listen on [::]:443"));
  EXPECT_THAT(finding(EADDRNOTAVAIL).remedy, HasSubstr("ip address"));
  EXPECT_THAT(finding(EAFNOSUPPORT).remedy, HasSubstr("0.0.0.0:443"));
  EXPECT_EQ(finding(EADDRINUSE).what, "[::]:443 is held by another program");
  EXPECT_EQ(finding(ENOMEM).severity, Severity::kError);
}

TEST(DescriptorsCheck, TheNeedIsThatOfThePage) {
  config::Config config;
  EXPECT_EQ(DescriptorsWanted(config), 46'144U);
  config.listen.proxy_protocol_from.push_back(*config::Network::Parse("10.0.0.0/8"));
  config.http.connections_max += 100;
  EXPECT_EQ(DescriptorsWanted(config), 47'268U);
  config.listen.metrics = {"0.0.0.0", 9464};
  EXPECT_EQ(DescriptorsWanted(config), 47'300U);
}

TEST(DescriptorsCheck, TheRunningServersLimitComesFirst) {
  const config::Config config;
  MachineFacts machine;
  machine.own_descriptors_max = 1024;
  ServerProcess server{{10, "uplinkd", 997}, 46'144};
  EXPECT_EQ(DescriptorsFinding(config, server, machine).severity, Severity::kOk);
  server.descriptors_max = 46'143;
  EXPECT_EQ(DescriptorsFinding(config, server, machine).severity, Severity::kWarning);
  EXPECT_THAT(DescriptorsFinding(config, std::nullopt, machine).what,
              HasSubstr("this shell may open 1024 files"));
  machine.own_descriptors_max = kDescriptorsUnlimited;
  EXPECT_EQ(DescriptorsFinding(config, std::nullopt, machine).severity, Severity::kOk);
}

TEST(DescriptorsCheck, ALimitThatCannotBeReadIsAWarning) {
  const config::Config config;
  const Finding finding =
      DescriptorsFinding(config, ServerProcess{{10, "uplinkd", 997}, std::nullopt}, {});
  EXPECT_EQ(finding,
            Warning("descriptors",
                    "how many files the running uplinkd (pid 10) may open cannot be read, and "
                    "limits.robots_max = 20000 needs 46144",
                    "run doctor as root"));
}

TEST(ClockCheck, AKernelThatDoesNotKnowIsAWarning) {
  EXPECT_EQ(ClockFinding(true).severity, Severity::kOk);
  EXPECT_EQ(ClockFinding(false).severity, Severity::kWarning);
}

}  // namespace
}  // namespace uplink::ctl
