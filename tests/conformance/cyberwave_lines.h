#pragma once

#include <fstream>
#include <string>
#include <vector>

#include <boost/json.hpp>

#include "schema/cyberwave/judge.h"
#include "tests/conformance/base64.h"

/// What the vendor's client published, as it was captured.
namespace uplink::test {

inline constexpr auto kCyberwaveVectors = "tests/conformance/cyberwave/sdk-0.7.4.jsonl";

[[nodiscard]] inline std::vector<std::string> LinesOf(const char* path) {
  std::vector<std::string> lines;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

[[nodiscard]] inline std::string PayloadOf(const boost::json::object& line) {
  if (const boost::json::value* text = line.if_contains("payload")) {
    return std::string(text->as_string().c_str(), text->as_string().size());
  }
  const boost::json::string& coded = line.at("payload_base64").as_string();
  return FromBase64({coded.data(), coded.size()});
}

/// The judgement of one line, under the prefixes that were captured.
[[nodiscard]] inline cyberwave::Judgement JudgeLine(const boost::json::object& line) {
  const boost::json::string& topic = line.at("topic").as_string();
  return cyberwave::JudgeMessage({topic.data(), topic.size()}, PayloadOf(line),
                                 {.prefixes = {"", "local", "site/a/"}});
}

}  // namespace uplink::test
