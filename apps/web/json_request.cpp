#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include <apps/web/json_request.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::web {
namespace {

using Json = nlohmann::ordered_json;
constexpr int kDeepest = 16;
constexpr std::uint64_t kLargest = std::numeric_limits<std::int64_t>::max();

[[noreturn]] void refuse(const std::string& what) { throw io::InputError({"request", 0, {}, what}); }

io::Node converted(const Json& json) {
  using Kind = io::Node::Kind;
  io::Node node;
  switch (json.type()) {
    case Json::value_t::object:
      for (const auto& [key, value] : json.items()) {
        node.children.push_back(converted(value));
        node.children.back().key = key;
      }
      break;
    case Json::value_t::array:
      node.kind = Kind::kList;
      for (const Json& item : json) node.children.push_back(converted(item));
      break;
    case Json::value_t::string:
      node.kind = Kind::kText;
      node.text = json.get<std::string>();
      break;
    case Json::value_t::boolean:
      node.kind = Kind::kBool;
      node.flag = json.get<bool>();
      node.text = node.flag ? "true" : "false";
      break;
    case Json::value_t::number_integer:
    case Json::value_t::number_unsigned:
      // What no whole number of a file could be is judged as a number.
      node.kind =
          json.is_number_unsigned() && json.get<std::uint64_t>() > kLargest ? Kind::kNumber : Kind::kInteger;
      node.integer = json.get<std::int64_t>();
      node.number = json.get<double>();
      node.text = json.dump();
      break;
    case Json::value_t::number_float:
      node.kind = Kind::kNumber;
      node.number = json.get<double>();
      node.text = json.dump();
      break;
    default:
      refuse("got null, expected a value (leave the key out)");
  }
  return node;
}

}  // namespace

io::Node parse_json(std::string_view text) {
  const auto not_too_deep = [](int depth, Json::parse_event_t, Json&) {
    if (depth > kDeepest) refuse("is nested more than 16 levels deep");
    return true;
  };
  Json json;
  try {
    json = Json::parse(text, not_too_deep);
  } catch (const Json::exception& e) {
    refuse(std::string("is no JSON: ") + e.what());
  }
  if (!json.is_object()) refuse("expected a JSON object");
  return converted(json);
}

}  // namespace stribeck::web
