#include <algorithm>
#include <cmath>
#include <stribeck/io/keys.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>
#include <utility>

namespace stribeck::io {
namespace {

using detail::dotted;

std::string words_of(const Type& type) { return detail::joined(type.words, type.word_count, " | "); }

std::string default_text(const Value& value, const Quantity& q) {
  switch (value.kind()) {
    case Kind::kOptional:
      return value.size() > 0 ? default_text(value[0], q) : "none";
    case Kind::kNumber:
      return std::isfinite(value.number()) ? from_si(value.number(), q) : "none";
    case Kind::kText:
      return value.text().empty() ? "none" : std::string(value.text());
    case Kind::kChoice:
      return std::string(value.word());
    case Kind::kSwitch:
    case Kind::kCount:
      return detail::inline_value(value, q, {});
    case Kind::kList: {
      // As it is typed: ["20 1/s", "40 1/s"].
      std::string text;
      for (std::size_t i = 0; i < value.size(); ++i) {
        const bool number = value[i].kind() == Kind::kNumber && !q.unit.empty();
        const std::string one = default_text(value[i], q);
        text += (text.empty() ? "" : ", ") + (number ? '"' + one + '"' : one);
      }
      return text.empty() ? "none" : "[" + text + "]";
    }
    case Kind::kGroup:
    case Kind::kVariant:
    case Kind::kNamed:
      break;
  }
  return "see below";
}

void add_keys(KeyInfo info, const Value& initial, const Quantity& q, std::vector<KeyInfo>& out);

void add_members(const Value& initial, const std::string& path, const std::string& kind,
                 std::vector<KeyInfo>& out) {
  for_each_member(initial, [&](const Member& m) {
    KeyInfo info;
    info.key = dotted(path, m.info.name);
    info.kind = kind;
    info.required = m.required();
    if (!info.required) info.default_value = default_text(m.value, m.info.quantity);
    info.doc = m.info.doc;
    info.condition = m.info.condition;
    add_keys(std::move(info), m.value, m.info.quantity, out);
  });
}

/// Unit and range of one value.
void add_value(KeyInfo info, const Value& initial, const Quantity& q, std::vector<KeyInfo>& out) {
  switch (initial.kind()) {
    case Kind::kNumber:
      info.unit = q.unit.empty() && q.shown.empty() ? "number" : q.shown.empty() ? q.unit : q.shown;
      info.range = range_text(q);
      break;
    case Kind::kSwitch:
      info.unit = "true/false";
      break;
    case Kind::kCount:
      info.unit = "count";
      info.range = range_text(q);
      break;
    case Kind::kChoice:
      info.unit = "text";
      info.range = words_of(initial.type());
      break;
    default:
      info.unit = "text";
  }
  out.push_back(std::move(info));
}

void add_keys(KeyInfo info, const Value& initial, const Quantity& q, std::vector<KeyInfo>& out) {
  const Type& type = initial.type();
  const std::string key = info.key;
  switch (initial.kind()) {
    case Kind::kOptional:
      return add_keys(std::move(info), initial.size() > 0 ? initial[0] : initial_of(*type.inner), q, out);
    case Kind::kGroup: {
      const std::string kind = info.kind;
      info.unit = "table";
      if (!type.short_form.empty()) {
        info.unit = "text or table";
        info.range = "off | on, or the keys below";
        info.default_value = short_form(initial);
      }
      out.push_back(std::move(info));
      return add_members(initial, key, kind, out);
    }
    case Kind::kVariant:
      info.unit = "table";
      info.range = "kind = " + words_of(type);
      out.push_back(std::move(info));
      for (std::size_t i = 0; i < type.word_count; ++i)
        add_members(initial_of(*type.alternatives[i]), key, std::string(type.words[i]), out);
      return;
    case Kind::kNamed:
      info.key += ".<name>";
      return add_keys(std::move(info), initial_of(*type.inner), q, out);
    case Kind::kList:
      info.key += "[]";
      return add_keys(std::move(info), initial_of(*type.inner), q, out);
    case Kind::kSwitch:
    case Kind::kCount:
    case Kind::kNumber:
    case Kind::kText:
    case Kind::kChoice:
      return add_value(std::move(info), initial, q, out);
  }
}

}  // namespace

std::vector<KeyInfo> keys_of(const Value& initial) {
  std::vector<KeyInfo> keys;
  add_members(initial, {}, {}, keys);
  return keys;
}

namespace {

/// Text that can be part of a table cell.
std::string cell(std::string text) {
  for (auto at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) text.insert(at, "\\");
  return text;
}

/// The keys of one table of the file.
struct Section {
  std::string table;
  std::string kind;
  std::string about;
  std::string rows;
};

std::string heading(const Section& s, int level) {
  std::string out = '\n' + std::string(static_cast<std::size_t>(level), '#') + ' ';
  if (s.table.empty()) {
    out += "Top of the file";
  } else if (s.table.ends_with("[]")) {
    out += "`[[" + s.table.substr(0, s.table.size() - 2) + "]]`";
  } else {
    out += "`[" + s.table + "]`";
  }
  if (!s.kind.empty()) out += ", `kind = \"" + s.kind + "\"`";
  return out + "\n\n";
}

/// Text about a whole table, beside its keys.
std::string about_table(const KeyInfo& k) {
  std::string out = k.doc;
  if (!k.range.empty()) out += (out.empty() ? "" : "; ") + cell(k.range);
  if (!k.condition.empty()) out += (out.empty() ? "" : "; ") + k.condition;
  if (!k.required) out += out.empty() ? "may be left out" : " (may be left out)";
  if (!out.empty() && out[0] >= 'a' && out[0] <= 'z') out[0] = static_cast<char>(out[0] - 'a' + 'A');
  return out;
}

std::string row(const KeyInfo& k, std::size_t path) {
  std::string key = k.key.substr(path);
  std::string unit = k.unit;
  if (key.ends_with("[]")) {
    key.resize(key.size() - 2);
    unit = "list of " + unit;
  }
  return "| `" + key + "` | " + cell(unit) + " | " + (k.required ? "required" : cell(k.default_value)) +
         " | " + cell(k.range) + " | " + cell(k.doc) + " | " + cell(k.condition) + " |\n";
}

}  // namespace

std::string markdown_by_table(const std::vector<KeyInfo>& keys, int level) {
  std::vector<Section> sections;
  const auto section = [&](const std::string& table, const std::string& kind) -> Section& {
    for (Section& s : sections) {
      if (s.table == table && s.kind == kind) return s;
    }
    return sections.emplace_back(Section{table, kind, {}, {}});
  };
  for (const KeyInfo& k : keys) {
    const auto dot = k.key.rfind('.');
    const std::size_t path = dot == std::string::npos ? 0 : dot + 1;
    const std::string table = path == 0 ? "" : k.key.substr(0, dot);
    if (k.unit == "table") {
      // The keys of a variant are listed below its kinds.
      section(k.key, k.range.empty() ? k.kind : std::string()).about = about_table(k);
    } else {
      section(table, k.kind).rows += row(k, path);
      if (k.unit == "text or table") section(k.key, {}).about = about_table(k);
    }
  }
  // In a file, keys after a heading belong to that table: keys without a table must come first.
  std::stable_partition(sections.begin(), sections.end(), [](const Section& s) { return s.table.empty(); });
  std::string out;
  for (const Section& s : sections) {
    if (s.about.empty() && s.rows.empty()) continue;
    out += heading(s, level);
    if (!s.about.empty()) out += s.about + ".\n";
    if (!s.about.empty() && !s.rows.empty()) out += '\n';
    if (!s.rows.empty())
      out +=
          "| Key | Unit | Default | Range | Meaning | Has an effect |\n|---|---|---|---|---|---|\n" + s.rows;
  }
  return out;
}

std::string markdown(const std::vector<KeyInfo>& keys) {
  std::string out = "| Key | Unit | Range | Default | Meaning |\n|---|---|---|---|---|\n";
  for (const auto& k : keys) {
    const std::string when = k.kind.empty() ? std::string() : "kind " + k.kind + ": ";
    const std::string initial = k.required ? std::string("required") : k.default_value;
    const std::string condition = k.condition.empty() ? std::string() : "; " + k.condition;
    out += "| `" + cell(k.key) + "` | " + cell(k.unit) + " | " + cell(k.range) + " | " + cell(initial) +
           " | " + cell(when + k.doc + condition) + " |\n";
  }
  return out;
}

}  // namespace stribeck::io
