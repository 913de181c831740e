#include <stribeck/io/error.hpp>
#include <stribeck/workflow/log/log_times.hpp>
#include <stribeck/workflow/log/names/proposed_maps.hpp>

namespace stribeck::workflow {

LogTimes::LogTimes(const AxisColumns& columns) : log_(columns.log()), axis_(columns.axis()) {
  if (const auto named = columns.mapped(LogQuantity::kTime)) {
    mapped_ = static_cast<int>(named->column - log_.columns.data());
    unit_ = named->unit;
  }
}

int LogTimes::index_of(const io::Column& column) const {
  // A channel of another rate keeps its own times, which came from the named column.
  const auto rows_of = [&](int index) { return log_.columns[static_cast<std::size_t>(index)].values.size(); };
  const bool own = column.time >= 0 && mapped_ >= 0 && rows_of(mapped_) != column.values.size();
  if (mapped_ >= 0 && !own) return mapped_;
  return column.time >= 0 ? column.time : io::time_column(log_);
}

const std::vector<double>& LogTimes::seconds(int index) {
  const auto known = converted_.find(index);
  if (known != converted_.end()) return known->second;
  io::Column column = log_.columns[static_cast<std::size_t>(index)];
  if (!unit_.empty() && (index == mapped_ || column.unit_text.empty())) column.unit_text = unit_;
  try {
    return converted_.emplace(index, io::in_si(column, quantity("s", "s"))).first->second;
  } catch (const io::InputError& e) {
    io::Problem p = e.problems().front();
    p.file = log_.source;
    if (column.unit_text.empty()) {
      const std::string all = proposed_maps(log_, axis_);
      p.message += all.empty() ? "; or give it with --map t=\"" + column.name + " s\""
                               : "; or give all that is missing, with your units: " + all;
    }
    throw io::InputError(p);
  }
}

}  // namespace stribeck::workflow
