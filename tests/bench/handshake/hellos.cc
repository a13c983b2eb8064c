#include "tests/bench/handshake/hellos.h"

#include <cstdint>

namespace uplink::bench {
namespace {

constexpr std::uint16_t kX25519 = 0x001D;
constexpr std::uint16_t kGroupsExtension = 10;
constexpr std::uint16_t kAlgorithmsExtension = 13;
constexpr std::uint16_t kAlpnExtension = 16;
constexpr std::uint16_t kSessionsExtension = 41;
constexpr std::uint16_t kVersionsExtension = 43;
constexpr std::uint16_t kSessionModesExtension = 45;
constexpr std::uint16_t kKeySharesExtension = 51;
/// From here on nothing has a number that the server knows.
constexpr std::uint16_t kUnknown = 0x4000;

std::string Number(std::size_t value, std::size_t bytes) {
  std::string text;
  for (std::size_t i = bytes; i > 0; --i) text += static_cast<char>(value >> (8 * (i - 1)));
  return text;
}

std::string Sized(const std::string& content, std::size_t length_bytes) {
  return Number(content.size(), length_bytes) + content;
}

std::string Extension(std::uint16_t type, const std::string& content) {
  return Number(type, 2) + Sized(content, 2);
}

/// Numbers that mean nothing, so many bytes of them.
std::string Numbers(std::size_t bytes) {
  std::string numbers;
  for (std::size_t i = 0; numbers.size() + 2 <= bytes; ++i) numbers += Number(kUnknown + i, 2);
  return numbers;
}

/// One byte of a share for each of these groups.
std::string SharesOf(const std::string& groups) {
  std::string shares;
  for (std::size_t i = 0; i < groups.size(); i += 2) {
    shares += groups.substr(i, 2) + Number(1, 2) + "x";
  }
  return shares;
}

/// A session that may be come back to: its name and age, and what proves it.
std::string Sessions(std::size_t bytes) {
  std::string names;
  std::string proofs;
  while (names.size() + proofs.size() + 80 <= bytes) {
    names += Sized(std::string(32, static_cast<char>(names.size() % 251)), 2) + Number(0, 4);
    proofs += Sized(std::string(32, 'x'), 1);
  }
  return Sized(names, 2) + Sized(proofs, 2);
}

}  // namespace

std::string HelloWith(Filler filler, std::size_t bytes) {
  constexpr std::size_t kRest = 250;
  const std::size_t room = bytes - kRest;
  std::string suites = Number(0x1301, 2);
  std::string groups = Number(kX25519, 2);
  std::string shares;
  std::string algorithms = Number(0x0403, 2) + Number(0x0804, 2);
  std::string others;
  std::string last;
  switch (filler) {
    case Filler::kKeyShares:
      groups = Numbers(2) + groups;
      for (std::size_t i = 0; i < room / 5; ++i) shares += SharesOf(Numbers(2));
      break;
    case Filler::kGroupsAndKeyShares: {
      // OpenSSL looks up each share's group among the groups, in their order.
      const std::string unknown = Numbers(room / 7 * 2);
      groups = unknown + groups;
      shares = SharesOf(unknown);
      break;
    }
    case Filler::kSessions:
      others = Extension(kSessionModesExtension, Sized(Number(1, 1), 1));
      last = Extension(kSessionsExtension, Sessions(room));
      break;
    case Filler::kSuites:
      suites = Numbers(room) + suites;
      break;
    case Filler::kAlgorithms:
      algorithms = Numbers(room) + algorithms;
      break;
    case Filler::kExtensions:
      for (std::size_t i = 0; i < room / 4; ++i) {
        others += Extension(static_cast<std::uint16_t>(kUnknown + i), "");
      }
      break;
  }
  shares += Number(kX25519, 2) + Sized("\x09" + std::string(31, '\0'), 2);
  const std::string extensions = Extension(kVersionsExtension, Sized(Number(0x0304, 2), 1)) +
                                 Extension(kGroupsExtension, Sized(groups, 2)) +
                                 Extension(kAlgorithmsExtension, Sized(algorithms, 2)) +
                                 Extension(kAlpnExtension, Sized(Sized("h2", 1), 2)) +
                                 Extension(kKeySharesExtension, Sized(shares, 2)) + others + last;
  const std::string body = Number(0x0303, 2) + std::string(32, 'r') + Sized("", 1) +
                           Sized(suites, 2) + Sized(std::string(1, '\0'), 1) + Sized(extensions, 2);
  return Number(22, 1) + Number(0x0301, 2) + Sized(Number(1, 1) + Sized(body, 3), 2);
}

}  // namespace uplink::bench
