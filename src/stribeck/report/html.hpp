#pragma once
/// A page of text, tables and figures in one file: styles, drawings and one script are inside, and nothing is downloaded. Without
/// scripts the figures stand still. Follows the reader's light or dark setting and can be printed.
/// Contents with links stand before the first section, if there are three or more.
///
/// Every text is escaped; markup cannot be passed in. Figures are drawn together when html() is called.
/// Real time: no.
/// Errors: those of render().

#include <functional>
#include <stribeck/report/plot/plot.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::report {

/// Text that is safe between tags and inside a quoted attribute. Control characters and broken UTF-8 become
/// U+FFFD.
std::string escape_html(std::string_view text);

struct Column {
  std::string head = {};
  std::string unit = {};  ///< shown below the head
  bool number = true;     ///< aligned to the right
};

struct Cell {
  std::string text = {};
  std::string spread = {};  ///< in small type after the text: "± 0.2"
  std::string note = {};    ///< in small type on a line below: a printed value
  bool best = false;        ///< bold
  std::string color = {};   ///< #rrggbb of a swatch before the text
};

struct Table {
  std::string caption = {};
  std::vector<Column> columns = {};
  std::vector<std::vector<Cell>> rows = {};
};

/// A number that is shown large.
struct KeyNumber {
  std::string name = {};
  std::string value = {};
  std::string unit = {};
};

/// A file that a result came from.
struct InputFile {
  std::string file = {};
  std::string sha256 = {};  ///< hexadecimal
};

/// What made a result.
struct Made {
  std::string command = {};
  std::string version = {};
  std::vector<InputFile> inputs = {};
};

class Page {
 public:
  explicit Page(std::string title, std::string subtitle = {});

  void section(std::string_view heading);
  void subsection(std::string_view heading);
  void paragraph(std::string_view text);
  /// A highlighted paragraph: the result in words.
  void lead(std::string_view text);
  /// The few numbers that matter, for the first screen.
  void numbers(const std::vector<KeyNumber>& numbers);
  /// A line that leads to another file beside the page.
  void link(std::string_view file, std::string_view words);
  /// A small remark, e.g. the source of numbers.
  void remark(std::string_view text);
  void code(std::string_view text);
  void table(const Table& table);
  void figure(const Plot& plot, std::string_view caption);
  /// Several drawings in a grid, up to `across` side by side, with one caption.
  void figures(const std::vector<Plot>& plots, int across, std::string_view caption);
  /// A list with a line above it; nothing when the list is empty.
  void list(std::string_view heading, const std::vector<std::string>& items);
  /// A box with items; nothing when the list is empty.
  void warnings(const std::vector<std::string>& list);
  /// A part that the reader can unfold; `fill` writes to this page.
  void details(std::string_view summary, const std::function<void()>& fill);

  /// The last section: how to make the page again, and the checksums of what it came from; nothing without a command.
  void made(const Made& made);

  [[nodiscard]] std::string html() const;
  [[nodiscard]] const std::vector<Plot>& plots() const { return plots_; }
  [[nodiscard]] const std::vector<Table>& tables() const { return tables_; }

 private:
  void add(std::string_view markup) { body_.back() += markup; }
  [[nodiscard]] std::string contents() const;

  std::string title_;
  std::string subtitle_;
  std::vector<std::string> body_{std::string()};  ///< a drawing goes between two parts
  std::vector<Plot> plots_;
  std::vector<Table> tables_;
  std::vector<std::string> sections_;
  std::size_t first_section_ = 0;  ///< part of the body
  std::size_t first_section_at_ = 0;
};

}  // namespace stribeck::report
