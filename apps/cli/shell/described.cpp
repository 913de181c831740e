#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>

#include <apps/cli/shell/described.hpp>

namespace stribeck::cli {
namespace {

/// The value of an option: `{a,b}` for the library's TEXT:{a,b}, `COUNT from 1 to 9` for UINT:from 1 to 9.
std::string taken_by(const CLI::Option& o) {
  const std::string all = o.get_type_name();
  const auto colon = all.find(':');
  std::string type = all.substr(0, colon);
  if (type == "UINT" || type == "INT") type = "COUNT";
  if (type == "FLOAT") type = "NUMBER";
  if (colon == std::string::npos) return type;
  const std::string which = all.substr(colon + 1);
  return type == "TEXT" ? which : type + ' ' + which;
}

std::vector<std::string> words_in(std::string_view value) {
  std::vector<std::string> out;
  const auto open = value.find('{');
  if (open == std::string_view::npos || value.back() != '}') return out;
  std::string_view rest = value.substr(open + 1, value.size() - open - 2);
  while (!rest.empty()) {
    const auto comma = std::min(rest.find(','), rest.size());
    out.emplace_back(rest.substr(0, comma));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  return out;
}

Offers offered_for(const DescribedOption& o) {
  if (!o.words.empty()) return Offers::kWords;
  if (o.value == "DIR" || o.value == "FOLDER") return Offers::kFolders;
  for (const std::string_view file : {"FILE", "LOG", "MODEL", ".toml", ".csv", ".ngc", "TRACE"}) {
    // The unit of --gain is no file: FORCE/UNIT has none of these words.
    if (o.value.find(file) != std::string::npos) return Offers::kFiles;
  }
  return Offers::kNothing;
}

DescribedOption described(const CLI::Option& o, bool help) {
  DescribedOption out;
  out.positional = o.get_positional();
  if (out.positional) {
    out.names.push_back(o.get_name(true, false));
  } else {
    for (const std::string& name : o.get_snames()) out.names.push_back("-" + name);
    for (const std::string& name : o.get_lnames()) out.names.push_back("--" + name);
  }
  if (o.get_type_size() != 0 && !o.get_type_name().empty()) out.value = taken_by(o);
  out.words = words_in(out.value);
  out.offers = offered_for(out);
  out.repeatable = o.get_items_expected_max() > 1;
  out.required = o.get_required();
  out.help = help;
  out.initial = o.get_default_str();
  out.meaning = o.get_description();
  return out;
}

}  // namespace

std::vector<DescribedOption> options_of(const CLI::App& app) {
  std::vector<DescribedOption> out;
  for (const CLI::Option* o : app.get_options()) {
    if (!o->get_group().empty())
      out.push_back(described(*o, o == app.get_help_ptr() || o == app.get_version_ptr()));
  }
  return out;
}

std::vector<DescribedVerb> verbs_of(const CLI::App& app) {
  std::vector<DescribedVerb> out;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (verb->get_group().empty()) continue;
    out.push_back({verb->get_name(), verb->get_description(), options_of(*verb), verb->get_footer()});
  }
  return out;
}

std::string in_short(const std::string& meaning) {
  constexpr std::size_t kMost = 60;
  std::string text = meaning.substr(0, meaning.find(';'));
  if (text.size() <= kMost) return text;
  const auto blank = text.rfind(' ', kMost);
  text.resize(blank == std::string::npos ? 0 : blank);
  while (!text.empty() && std::string_view(",:(").find(text.back()) != std::string_view::npos)
    text.pop_back();
  return text + " \xe2\x80\xa6";
}

}  // namespace stribeck::cli
