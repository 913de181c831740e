#pragma once
/// The head of a CSV table. Internal to io. Real time: no. Errors: InputError.

#include <stribeck/io/log/log.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::io::detail {

struct CsvDialect;

struct CsvHead {
  Log log;  ///< columns without values, metadata and notes
  char separator = ',';
  char decimal = '.';
  std::string_view header;                                 ///< the line of the names, where the file has one
  std::vector<std::pair<std::string, std::string>> twice;  ///< times that stand twice
};

/// Reads names and units, and removes them from the text: `body` begins with the first row then.
CsvHead read_csv_head(std::string_view& body, const std::string& source, const CsvDialect& dialect);

}  // namespace stribeck::io::detail
