#pragma once
/// The verbs and options as the command declares them, as plain values: for the reference, man pages and completion.
/// Real time: no.

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace stribeck::cli {

/// What a shell can offer for a value.
enum class Offers { kNothing, kWords, kFiles, kFolders };

struct DescribedOption {
  std::vector<std::string> names;  ///< "-o", "--output"; of a positional argument its one name
  bool positional = false;
  std::string value;               ///< "FILE", "{a,b}", "COUNT from 1 to 9"; empty: a flag
  std::vector<std::string> words;  ///< the values that are allowed, where they are a list
  Offers offers = Offers::kNothing;
  bool repeatable = false;
  bool required = false;
  bool help = false;    ///< --help and --version, which every program has
  std::string initial;  ///< value when it is left out, as text
  std::string meaning;
};

struct DescribedVerb {
  std::string name;
  std::string meaning;
  std::vector<DescribedOption> options;
  std::string examples;
};

/// Options of the command itself or of one verb; hidden ones are left out.
std::vector<DescribedOption> options_of(const CLI::App& app);

/// The verbs, in the order of --help; hidden ones are left out.
std::vector<DescribedVerb> verbs_of(const CLI::App& app);

/// The meaning in at most 60 letters, for a list beside the cursor.
std::string in_short(const std::string& meaning);

}  // namespace stribeck::cli
