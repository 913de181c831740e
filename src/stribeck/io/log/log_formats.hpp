#pragma once
/// The formats that read_log knows. is_…(): recognises a format by its first lines. Internal to io. Real time: no. Errors: InputError.

#include <optional>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>
#include <string_view>

namespace stribeck::io::detail {

/// Treatment of text columns in a CSV table.
enum class TextColumns { kRefuse, kLeaveOut, kKeep };

struct CsvDialect {
  std::size_t skip_lines = 0;
  std::vector<std::string> names{};
  TextColumns text_columns = TextColumns::kRefuse;
  bool drop_unended_row = false;  ///< a last row without a line end may be cut inside a number
  bool unit_after_blank = false;  ///< "x mm" is "x [mm]"
  bool has_side_file = false;     ///< LOG.toml is read and may name the columns
  bool keep_blank_rows =
      false;  ///< a row of separators alone is an absent row where no column tells the time
};
/// Cells without a number: blank, NaN, n/a, null. Their values are NaN.
struct AbsentCells {
  std::optional<Problem> first;  ///< what to say where they cannot be left out
};
/// Absent cells are refused where `absent` is null.
Log read_csv_text(std::string_view text, const std::string& source, const CsvDialect& dialect,
                  AbsentCells* absent = nullptr);

/// Heidenhain TNCscope: header lines with %, one block per curve, rows with ;.
bool is_tncscope(std::string_view text);
Log read_tncscope(std::string_view text, const std::string& source);

/// Beckhoff TwinCAT 3 Scope text export: keys in rows, groups of channels with times of their own.
bool is_twincat(std::string_view text);
Log read_twincat(std::string_view text, const std::string& source);

/// maxon EPOS Studio data recorder, also after a spreadsheet has saved it.
bool is_epos(std::string_view text);
Log read_epos(std::string_view text, const std::string& source);

/// Mitsubishi MR Configurator2 graph.
bool is_mr_configurator(std::string_view text);
Log read_mr_configurator(std::string_view text, const std::string& source);

/// NI DAQ logger: pairs of time and value.
bool is_ni_daq(std::string_view text);
Log read_ni_daq(std::string_view text, const std::string& source);

/// LinuxCNC halsampler: only numbers, and "overrun" where samples were lost.
bool is_halsampler(std::string_view text);
Log read_halsampler(std::string_view text, const std::string& source, const ReadOptions& options);

/// SINUMERIK Edge capture, Analyze MyWorkpiece: JSON.
Log read_sinumerik_json(std::string_view text, const std::string& source, const ReadOptions& options);
/// Sets units and time of a CSV table whose columns are called SIGNAL|axis; false when it is no such table.
bool name_sinumerik_signals(Log& log, const ReadOptions& options);

/// SINUMERIK Operate trace: XML.
Log read_sinumerik_trace(std::string_view text, const std::string& source);

}  // namespace stribeck::io::detail
