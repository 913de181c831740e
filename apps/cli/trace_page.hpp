#pragma once
/// The page of a run that a verb has made: its columns over time.
/// Real time: no.

#include <string>

namespace stribeck::io {
struct Log;
}

namespace stribeck::cli {

/// Writes a page with a log's columns over time; does nothing when `directory` is empty.
void report_log(const std::string& directory, const io::Log& log, const std::string& title,
                const std::string& summary);

}  // namespace stribeck::cli
