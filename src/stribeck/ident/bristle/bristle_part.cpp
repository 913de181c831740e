#include <algorithm>
#include <cmath>
#include <numeric>
#include <stribeck/ident/bristle/bristle_parts.hpp>
#include <utility>

namespace stribeck::ident::bristle {
namespace {

constexpr std::size_t kPartRows = 1500;  // enough to tell the laws apart where they differ at all
constexpr std::size_t kManyRows = 4000;  // below it the whole costs less than half a second
constexpr std::size_t kFewPartPieces = 8;

/// The first `rows` rows of a piece, with all ticks that their window needs.
PathPiece begin_of(const PathPiece& piece, std::size_t rows, std::size_t half) {
  PathPiece out = piece;
  if (rows >= piece.rows.size()) return out;
  out.rows.resize(rows);
  const std::size_t ticks = std::min(piece.force.size(), out.rows.back() + half + 2);
  out.samples.resize(std::min(out.samples.size(), ticks - 1));
  for (std::vector<double>* column : {&out.acceleration, &out.force, &out.given, &out.speed, &out.at})
    column->resize(ticks);
  out.held.resize(ticks + 1);
  return out;
}

/// Of each piece the first `kept` rows, with their steps.
BristlePath pieces_of(const BristlePath& from, const std::vector<std::size_t>& kept) {
  BristlePath to;
  to.window = from.window;
  to.whitening = from.whitening;
  const std::size_t half = 3 * static_cast<std::size_t>(from.window) + kMostWhitening;
  std::size_t first = 0;
  int last = -1;
  for (std::size_t i = 0; i < from.pieces.size(); first += from.pieces[i++].rows.size()) {
    if (kept[i] == 0) continue;
    PathPiece copy = begin_of(from.pieces[i], kept[i], half);
    for (PathSample& sample : copy.samples) {
      const auto begin = from.steps.begin() + static_cast<std::ptrdiff_t>(sample.first);
      sample.first = to.steps.size();
      to.steps.insert(to.steps.end(), begin, begin + static_cast<std::ptrdiff_t>(sample.count));
    }
    for (std::size_t row = first; row < first + copy.rows.size(); ++row) {
      PathRow r = from.rows[row];
      // Stretches are counted anew: those that are left out in turn lie side by side.
      if (r.stretch != last) ++to.stretches;
      last = r.stretch;
      r.stretch = to.stretches - 1;
      to.rows.push_back(r);
    }
    if (copy.unknown_start) ++to.starts;
    to.pieces.push_back(std::move(copy));
  }
  return to;
}

/// The rows of a piece, or none of one whose start is unknown.
std::size_t all_rows(const PathPiece& piece) { return piece.unknown_start ? 0 : piece.rows.size(); }

}  // namespace

BristlePath part_of(const BristlePath& from, std::size_t most) {
  const std::size_t every = std::max<std::size_t>(1, (from.rows.size() + most - 1) / most);
  std::vector<std::size_t> kept(from.pieces.size(), 0);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (i / 2 % every == 0) kept[i] = all_rows(from.pieces[i]);
  }
  return pieces_of(from, kept);
}

BristlePath shortest_of(const BristlePath& from, std::size_t most, std::size_t least_pieces) {
  std::vector<std::size_t> pairs((from.pieces.size() + 1) / 2);
  std::iota(pairs.begin(), pairs.end(), std::size_t{0});
  const auto rows_of = [&](std::size_t pair) {
    std::size_t rows = 0;
    for (std::size_t i = 2 * pair; i < std::min(2 * pair + 2, from.pieces.size()); ++i)
      rows += from.pieces[i].rows.size();
    return rows;
  };
  std::stable_sort(pairs.begin(), pairs.end(),
                   [&](std::size_t a, std::size_t b) { return rows_of(a) < rows_of(b); });
  std::vector<std::size_t> kept(from.pieces.size(), 0);
  std::size_t rows = 0;
  std::size_t pieces = 0;
  for (const std::size_t pair : pairs) {
    rows += rows_of(pair);
    if (rows > most && pieces >= least_pieces) break;
    for (std::size_t i = 2 * pair; i < std::min(2 * pair + 2, from.pieces.size()); ++i) {
      kept[i] = all_rows(from.pieces[i]);
      pieces += from.pieces[i].unknown_start ? 0 : 1;
    }
  }
  return pieces_of(from, kept);
}

BristlePath shortened(const BristlePath& from, std::size_t most) {
  constexpr int kLeastStretches = 4;  // both directions, twice
  std::vector<std::size_t> kept;
  std::size_t first = 0;
  for (const PathPiece& piece : from.pieces) {
    const std::size_t end = first + piece.rows.size();
    const std::size_t share = piece.rows.size() * most / std::max<std::size_t>(1, from.rows.size());
    std::size_t row = first;
    int stretches = 0;
    for (int last = -1; row < end; ++row) {
      if (from.rows[row].stretch == last) continue;
      if (stretches >= kLeastStretches && row - first >= share) break;
      last = from.rows[row].stretch;
      ++stretches;
    }
    kept.push_back(row - first);
    first = end;
  }
  return pieces_of(from, kept);
}

bool lay_part(const Rows& rows, const Fitted& lugre, Rows& part, Fitted& few) {
  if (rows.path.rows.size() < kManyRows) return false;
  part.path = part_of(rows.path, kPartRows);
  part.setting = rows.setting;
  part.setting.path = &part.path;
  part.every_row.assign(part.path.rows.size(), 1);
  part.noise = rows.noise;
  few.own = lugre.own;
  const Index count = few.own + kCommon;
  few.prior = {lugre.prior.mean.head(count), lugre.prior.sd.head(count)};
  for (const Index i : lugre.free) {
    if (i < count) few.free.push_back(i);
  }
  return part.path.pieces.size() >= kFewPartPieces;
}

std::optional<Candidate> gms_refused(const Given& given, const Rows& rows, const Fitted& lugre) {
  Rows part;
  Fitted few;
  if (!lay_part(rows, lugre, part, few)) return {};
  few.solution.p = lugre.solution.p.head(few.own + kCommon);
  const std::optional<Fitted> gms = fit_gms(given, part, few);
  if (!gms) return {};
  const auto held = [&](const Model& model, const Fitted& f) {
    return hold_out(model, f.solution.p, f.free, f.prior, part.noise, part.path);
  };
  const HeldOut mine = held(*gms_model(part.setting, gms->own), *gms);
  const HeldOut best = held(*lugre_model(part.setting), few);
  const double error = error_of_difference(mine, best);
  // GMS is chosen only where it is clearly better. Where it is no better on a part of the reversals, it is not fitted to all of them.
  if (!(mine.rms() > best.rms())) return {};
  return Candidate{"GMS, " + std::to_string(given.options.elements) + " elements, on " +
                       std::to_string(part.path.stretches) + " of " + std::to_string(rows.path.stretches) +
                       " reversals",
                   0,
                   static_cast<int>(gms->free.size()),
                   mine.rms() / best.rms(),
                   error / best.rms(),
                   false};
}

}  // namespace stribeck::ident::bristle
