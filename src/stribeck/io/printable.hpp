#pragma once
/// Texts of users and of foreign files on their way to a terminal, a page, or a line of a file that another program obeys.
///
/// What printable() leaves out: control characters (U+0000 to U+001F, U+007F to U+009F), separators of lines and paragraphs, and the
/// characters that turn the direction of writing (Unicode Standard Annex 9, table 1).
/// Real time: no.

#include <cstddef>
#include <string>
#include <string_view>

namespace stribeck::io {

/// A text that a terminal only shows, on one line: what it would obey is a blank, bytes that are no UTF-8 (RFC 3629) are U+FFFD.
std::string printable(std::string_view text);

/// The same with its line feeds.
std::string printable_lines(std::string_view text);

/// Its begin and its end, where it has more bytes than `most`.
std::string shortened(std::string_view text, std::size_t most);

/// A text as part of one line of a file that another program obeys: printable, at most `most` bytes, and no backslash at its end,
/// which would continue the line.
std::string one_line(std::string_view text, std::size_t most = 120);

/// Lines of a comment that begin with "# ", each of at most 200 bytes: LinuxCNC reads lines of 255, and takes the rest of a longer one
/// for a line of its own.
std::string comment_lines(std::string_view text);

}  // namespace stribeck::io
