#pragma once

#include <cctype>
#include <cstddef>
#include <ostream>
#include <string>
#include <string_view>
#include <variant>

#include <gtest/gtest.h>

#include "schema/cyberwave/judge.h"

/// Messages of one twin under no prefix, judged.
namespace uplink::test {

inline constexpr std::string_view kTwin = "11111111-1111-4111-8111-111111111111";
inline constexpr std::string_view kEnvironment = "eeeeeeee-eeee-4eee-8eee-eeeeeeeeeeee";

/// The topic of a tail such as `position`; `joint/update`, `environment/TYPE` and `workflow-run`
/// name theirs.
[[nodiscard]] inline std::string TopicOf(std::string_view tail) {
  const std::string twin(kTwin);
  const std::string environment(kEnvironment);
  if (tail == "joint/update") return "cyberwave/joint/" + twin + "/update";
  if (tail == "workflow-run") return "cyberwave/workflow-run/" + environment + "/status";
  if (tail == "ping") return "cyberwave/ping/me/request";
  if (tail.starts_with("environment/")) {
    return "cyberwave/environment/" + environment + "/" +
           std::string(tail.substr(tail.find('/') + 1));
  }
  return "cyberwave/twin/" + twin + "/" + std::string(tail);
}

[[nodiscard]] inline cyberwave::Judgement JudgeOn(std::string_view tail, std::string_view payload,
                                                  const cyberwave::JudgeTerms& terms = {}) {
  return cyberwave::JudgeMessage(TopicOf(tail), payload, terms);
}

/// The body of a message that is good; a failure and an empty one otherwise.
template <typename T>
[[nodiscard]] T BodyOf(const cyberwave::Judgement& judgement) {
  if (const model::Rejection* rejection = judgement.rejection()) {
    ADD_FAILURE() << ToText(rejection->reason) << " " << rejection->field << ": "
                  << rejection->detail;
    return {};
  }
  const T* body = std::get_if<T>(judgement.body());
  EXPECT_NE(body, nullptr) << "another body: " << judgement.body()->index();
  return body == nullptr ? T() : *body;
}

/// A message with one thing at fault, beside the same one that is good.
struct Rule {
  std::string name;
  std::string tail;
  std::string good;
  std::string bad;
  model::RejectReason reason;
  std::string field;
};

inline void PrintTo(const Rule& rule, std::ostream* out) { *out << rule.name; }

/// What GoogleTest calls the case.
[[nodiscard]] inline std::string NameOf(const ::testing::TestParamInfo<Rule>& each) {
  std::string name = each.param.name;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

/// A JSON text of so many bytes.
[[nodiscard]] inline std::string Long(std::size_t bytes) {
  return "\"" + std::string(bytes, 'a') + "\"";
}

/// `count` members `"PREFIX0":VALUE`, parted by commas.
[[nodiscard]] inline std::string Members(std::size_t count, const std::string& prefix,
                                         const std::string& value) {
  std::string members;
  for (std::size_t i = 0; i < count; ++i) {
    members.append(i == 0 ? "\"" : ",\"").append(prefix).append(std::to_string(i)).append("\":");
    members.append(value);
  }
  return members;
}

/// `count` times the value, parted by commas.
[[nodiscard]] inline std::string Items(std::size_t count, const std::string& value) {
  std::string items;
  for (std::size_t i = 0; i < count; ++i) items.append(i == 0 ? "" : ",").append(value);
  return items;
}

}  // namespace uplink::test
