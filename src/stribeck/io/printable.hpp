#pragma once
/// Makes texts of users and of foreign files safe for terminals, pages, and lines of files that other programs obey.
///
/// Removed are control characters (U+0000 to U+001F, U+007F to U+009F), separators of lines and paragraphs, and the characters that
/// change the direction of writing (Unicode Standard Annex 9, table 1).
/// Real time: no.

#include <cstddef>
#include <string>
#include <string_view>

namespace stribeck::io {

/// A text that is safe to show in a terminal, on one line: removed characters become blanks, bytes that are not UTF-8 (RFC 3629) become
/// U+FFFD.
std::string printable(std::string_view text);

/// The same, but line feeds are kept.
std::string printable_lines(std::string_view text);

/// The text itself, or its start and its end if it has more bytes than `most`.
std::string shortened(std::string_view text, std::size_t most);

/// A text that is safe as part of one line of a file that another program obeys: printable, at most `most` bytes, and without a
/// backslash at its end, which would continue the line.
std::string one_line(std::string_view text, std::size_t most = 120);

/// A text as lines of a comment. Each begins with "# " and has at most 200 bytes: LinuxCNC reads at most 255 bytes of a line, and takes
/// the rest for a new line.
std::string comment_lines(std::string_view text);

}  // namespace stribeck::io
