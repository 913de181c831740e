#pragma once
/// Writes the files of a configuration to a folder; files that a user has edited are never overwritten.
/// Real time: no.
/// Errors: InputError naming the folder and the edited files.

#include <string>
#include <utility>
#include <vector>

namespace stribeck::targets::linuxcnc {

/// Names and texts of files.
using NamedTexts = std::vector<std::pair<std::string, std::string>>;

struct WrittenFolder {
  std::vector<std::string> files;  ///< all that belong to the configuration
  std::vector<std::string>
      kept;  ///< files that a user has edited, and whose text would be the same as before
};

/// Writes files to an existing folder, and a record of them, written.txt, which begins with the comment. A file that was edited since
/// the record was made, or that is in no record, is never overwritten: it is kept where the text to write equals the recorded one;
/// otherwise the call is refused (InputError) and nothing is written.
WrittenFolder write_folder(const std::string& folder, const std::string& comment, const NamedTexts& files);

}  // namespace stribeck::targets::linuxcnc
