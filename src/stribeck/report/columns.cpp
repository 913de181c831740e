#include <stribeck/report/columns.hpp>

namespace stribeck::report {

std::string lay_out(std::vector<TextColumn> columns) {
  std::size_t total = 0;
  for (const TextColumn& c : columns) total += c.width() + 2;
  // Where the table is too wide, the text columns are shortened, longest first.
  while (total > kTableWidth + 2) {
    auto longest = columns.end();
    for (auto c = columns.begin(); c != columns.end(); ++c) {
      if (!c->number && c->width() > c->least && (longest == columns.end() || c->width() > longest->width()))
        longest = c;
    }
    if (longest == columns.end()) break;
    longest->most = longest->width() - 1;
    --total;
  }
  const auto row = [&](auto&& entry) {
    std::string text;
    for (const TextColumn& c : columns) {
      if (!text.empty()) text += "  ";
      const std::string e = entry(c);
      text += c.number ? right_aligned(e, c.width()) : left_aligned(e, c.width());
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text + '\n';
  };
  std::string out;
  for (const auto member : {&TextColumn::group, &TextColumn::head, &TextColumn::unit}) {
    const bool needed = std::any_of(columns.begin(), columns.end(),
                                    [&](const TextColumn& c) { return !(c.*member).empty(); });
    if (needed) out += row([&](const TextColumn& c) { return c.*member; });
  }
  for (std::size_t i = 0; i < columns.front().entries.size(); ++i) {
    out += row([i](const TextColumn& c) { return c.entries[i]; });
  }
  return out;
}

}  // namespace stribeck::report
