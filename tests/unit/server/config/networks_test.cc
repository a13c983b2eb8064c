#include "server/config/networks.h"

#include <cstring>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>

#include "tests/unit/server/config/minimal.h"

namespace uplink::config {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::uplink::config::testing::ParseWith;

sockaddr_storage AddressOf(const std::string& text) {
  sockaddr_storage address{};
  sockaddr_in ipv4{};
  sockaddr_in6 ipv6{};
  if (::inet_pton(AF_INET, text.c_str(), &ipv4.sin_addr) == 1) {
    ipv4.sin_family = AF_INET;
    std::memcpy(&address, &ipv4, sizeof(ipv4));
  } else {
    EXPECT_EQ(::inet_pton(AF_INET6, text.c_str(), &ipv6.sin6_addr), 1) << text;
    ipv6.sin6_family = AF_INET6;
    std::memcpy(&address, &ipv6, sizeof(ipv6));
  }
  return address;
}

bool Holds(const std::string& network, const std::string& address) {
  const absl::StatusOr<Network> parsed = Network::Parse(network);
  EXPECT_TRUE(parsed.ok()) << parsed.status();
  return parsed.ok() && parsed->Contains(AddressOf(address));
}

std::string Error(const std::string& network) {
  return std::string(Network::Parse(network).status().message());
}

TEST(Network, HoldsTheAddressesThatBeginAsItDoes) {
  EXPECT_TRUE(Holds("10.0.0.0/8", "10.0.0.0"));
  EXPECT_TRUE(Holds("10.0.0.0/8", "10.255.255.255"));
  EXPECT_FALSE(Holds("10.0.0.0/8", "11.0.0.0"));
  EXPECT_FALSE(Holds("10.0.0.0/8", "9.255.255.255"));
  EXPECT_TRUE(Holds("192.0.2.128/25", "192.0.2.255"));
  EXPECT_FALSE(Holds("192.0.2.128/25", "192.0.2.127"));
  EXPECT_TRUE(Holds("2001:db8::/33", "2001:db8:7fff::1"));
  EXPECT_FALSE(Holds("2001:db8::/33", "2001:db8:8000::1"));
}

TEST(Network, OfOneAddressHoldsNoOther) {
  for (const char* const network : {"192.0.2.7", "192.0.2.7/32"}) {
    EXPECT_TRUE(Holds(network, "192.0.2.7"));
    EXPECT_FALSE(Holds(network, "192.0.2.6"));
  }
  EXPECT_TRUE(Holds("2001:db8::1", "2001:db8::1"));
  EXPECT_FALSE(Holds("2001:db8::1/128", "2001:db8::2")) << "the same /64 is not the same address";
}

TEST(Network, IsOfOneFamily) {
  EXPECT_TRUE(Holds("0.0.0.0/0", "203.0.113.9"));
  EXPECT_FALSE(Holds("0.0.0.0/0", "2001:db8::1"));
  EXPECT_TRUE(Holds("::/0", "2001:db8::1"));
  EXPECT_FALSE(Holds("::/0", "203.0.113.9"));
}

TEST(Network, TakesIpv4InIpv6AsIpv4) {
  EXPECT_TRUE(Holds("10.0.0.0/8", "::ffff:10.1.2.3"));
  EXPECT_FALSE(Holds("::/0", "::ffff:10.1.2.3"));
  EXPECT_TRUE(Holds("::ffff:10.0.0.0/104", "10.1.2.3"));
  EXPECT_EQ(Network::Parse("::ffff:10.0.0.0/104")->ToText(), "10.0.0.0/8");
  EXPECT_EQ(*Network::Parse("::ffff:192.0.2.7"), *Network::Parse("192.0.2.7"));
}

TEST(Network, HoldsNoAddressOfAnotherFamily) {
  sockaddr_storage local{};
  local.ss_family = AF_UNIX;
  EXPECT_FALSE(Network::Parse("0.0.0.0/0")->Contains(local));
  EXPECT_FALSE(Network::Parse("::/0")->Contains(local));
}

TEST(Network, IsWrittenAsItIsRead) {
  for (const char* const text :
       {"10.0.0.0/8", "0.0.0.0/0", "192.0.2.7", "2001:db8::/32", "::/0", "::1"}) {
    EXPECT_EQ(Network::Parse(text)->ToText(), text);
  }
}

TEST(Network, RefusesWhatIsNone) {
  for (const char* const text :
       {"", "/", "/8", "10.0.0.0/", "10.0.0.0/33", "10.0.0.0/-1", "10.0.0.0/+8", "10.0.0.0/ 8",
        "10.0.0.0/8/8", "10.0.0.0/8x", "10.0.0.0/4294967304", "::/129", "10.0.0", "balancer",
        "10.0.0.1:80", "[::1]", "fe80::1%lo", " 10.0.0.1"}) {
    EXPECT_THAT(Error(text), HasSubstr("is no network")) << text;
  }
  EXPECT_THAT(Error(std::string("10.0.0.1\0", 9)), HasSubstr("is no network"));
  EXPECT_LT(Error(std::string(5000, 'x')).size(), 400U);
}

TEST(Network, SaysWhichBitsAreTooMany) {
  EXPECT_EQ(Error("10.1.2.3/8"),
            "\"10.1.2.3/8\" has bits set beyond its prefix; the network is \"10.0.0.0/8\", and the "
            "address alone \"10.1.2.3\"");
  EXPECT_THAT(Error("2001:db8::1/64"), HasSubstr("the network is \"2001:db8::/64\""));
  EXPECT_THAT(Error("::ffff:10.0.0.0/90"), HasSubstr("beyond its prefix"))
      << "the prefix is no network of IPv4";
}

// --- The setting ---

TEST(Networks, AreReadFromTheFileAndFromTheEnvironment) {
  const LoadResult file = ParseWith("[listen]\nproxy_protocol_from = [\"10.0.0.0/8\", \"::1\"]\n");
  const LoadResult environment =
      ParseWith("", {{"UPLINKD_LISTEN_PROXY_PROTOCOL_FROM", "10.0.0.0/8,::1"}});
  for (const LoadResult* each : {&file, &environment}) {
    ASSERT_TRUE(each->ok()) << ToText(each->problems.at(0));
    EXPECT_THAT(each->config->listen.proxy_protocol_from,
                ElementsAre(*Network::Parse("10.0.0.0/8"), *Network::Parse("::1")));
    EXPECT_THAT(PrintConfig(*each->config),
                HasSubstr("proxy_protocol_from = [\"10.0.0.0/8\", \"::1\"]\n"));
  }
  const LoadResult none = ParseWith("[listen]\nproxy_protocol_from = [\"10.0.0.0/8\"]\n",
                                    {{"UPLINKD_LISTEN_PROXY_PROTOCOL_FROM", ""}});
  ASSERT_TRUE(none.ok());
  EXPECT_THAT(none.config->listen.proxy_protocol_from, IsEmpty());
}

TEST(Networks, AnErrorNamesTheSettingAndTheEntry) {
  const auto error = [](const std::string& value) {
    const LoadResult result = ParseWith("[listen]\nproxy_protocol_from = " + value + "\n");
    EXPECT_THAT(result.problems, SizeIs(1)) << value;
    return result.problems.empty() ? std::string() : ToText(result.problems[0]);
  };
  EXPECT_THAT(error("[\"::1\", \"10.0.0.1/8\"]"),
              HasSubstr("u.toml:6: listen.proxy_protocol_from: \"10.0.0.1/8\" has bits set"));
  EXPECT_THAT(error("[\"balancer.example.org\"]"),
              HasSubstr("listen.proxy_protocol_from: \"balancer.example.org\" is no network"));
  EXPECT_THAT(error("[\"::1\", \"::1\"]"), HasSubstr("\"::1\" stands in it twice"));
  EXPECT_THAT(error("[\"\"]"), HasSubstr("a list of at most 256 networks"));
  EXPECT_THAT(error("[8]"), HasSubstr("a list of at most 256 networks"));
  EXPECT_THAT(error("\"10.0.0.0/8\""), HasSubstr("a list of at most 256 networks"));
}

TEST(Networks, AreBoundedInNumber) {
  const auto many = [](int count) {
    std::string list;
    for (int i = 0; i < count; ++i) {
      list += (i > 0 ? "," : "") + std::string("10.0.") + std::to_string(i / 256) + "." +
              std::to_string(i % 256);
    }
    return ParseWith("", {{"UPLINKD_LISTEN_PROXY_PROTOCOL_FROM", list}});
  };
  EXPECT_TRUE(many(256).ok());
  EXPECT_THAT(many(257).problems, SizeIs(1));
}

}  // namespace
}  // namespace uplink::config
