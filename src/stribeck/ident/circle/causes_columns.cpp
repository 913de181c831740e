#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/causes_parts.hpp>

namespace stribeck::ident::circle {

namespace {

/// Whether the rows hold the passage of an axis through both of its ends: on an arc of half a turn they do not, and play that differs
/// between the ends looks like lateral play of the other axis.
bool passes_both_ends(const CauseRows& rows, int axis) {
  constexpr double kBeside = 4.0 * kPi / 180.0;
  std::array<bool, 4> seen{};  // before and behind the positive end, the same of the negative one
  for (const CauseRow& row : rows.rows) {
    const double from_end = std::remainder(row.angle - (axis == 0 ? 0.0 : 0.5 * kPi), kPi);  // either end
    if (std::abs(from_end) < kBeside || std::abs(from_end) > 2.0 * kBeside) continue;
    const double at = axis == 0 ? std::cos(row.angle) : std::sin(row.angle);
    seen[(at > 0.0 ? 0U : 2U) + (from_end > 0.0 ? 0U : 1U)] = true;
  }
  return std::all_of(seen.begin(), seen.end(), [](bool s) { return s; });
}

}  // namespace

Columns columns_of(const CauseRows& rows, const std::vector<Pitch>& pitches) {
  Columns c;
  const auto add = [&](CauseKind kind, std::optional<int> axis, int count = 1, double pitch = 0.0,
                       int log = 0) {
    c.causes.push_back({kind, axis, c.count, count, pitch, log});
    c.count += count;
  };
  add(CauseKind::kRadius, std::nullopt);
  add(CauseKind::kScaleMismatch, std::nullopt);
  // In one direction both have one form, and an encoder of the axis sees no squareness.
  const bool square = rows.both_directions || !rows.own_encoder;
  if (square) add(CauseKind::kSquareness, std::nullopt);
  // On an arc a bow is too much like a centre and a scale.
  if (!rows.arcs) {
    add(CauseKind::kStraightness, 0);
    add(CauseKind::kStraightness, 1);
  }
  for (const int axis : {0, 1}) add(CauseKind::kBacklash, axis, passes_both_ends(rows, axis) ? 2 : 1);
  if (rows.both_directions || !square) add(CauseKind::kServoMismatch, std::nullopt);
  if (rows.both_directions) {
    add(CauseKind::kLateralPlay, 0);
    add(CauseKind::kLateralPlay, 1);
  }
  if (rows.feeds_differ) add(CauseKind::kLag, std::nullopt, 2);
  for (const Pitch& p : pitches) add(CauseKind::kCyclic, p.axis, 2, p.length);
  for (int log = 0; log < rows.logs; ++log) add(CauseKind::kCentre, std::nullopt, 2, 0.0, log);
  for (int log = 0; rows.drifts && log < rows.logs; ++log) add(CauseKind::kDrift, std::nullopt, 2, 0.0, log);
  return c;
}

Eigen::VectorXd column_values(const CauseRows& rows, const Columns& c, const CauseRow& at) {
  Eigen::VectorXd v = Eigen::VectorXd::Zero(c.count);
  const double co = std::cos(at.angle);
  const double si = std::sin(at.angle);
  // Sign of each axis' velocity: x = R·cos θ, y = R·sin θ.
  const double vx = -at.direction * sign(si);
  const double vy = at.direction * sign(co);
  const double speed = rows.feeds_known ? at.feed / rows.fastest : 1.0;
  for (const CauseColumns& cause : c.causes) {
    double* out = v.data() + cause.first;
    const bool x = cause.axis.value_or(0) == 0;
    switch (cause.kind) {
      case CauseKind::kRadius:
        *out = 1.0;
        break;
      case CauseKind::kScaleMismatch:
        *out = std::cos(2.0 * at.angle);
        break;
      case CauseKind::kSquareness:
        *out = std::sin(2.0 * at.angle);
        break;
      // A bow of x along y, and of y along x, as deep as the coefficient over the radius.
      case CauseKind::kStraightness:
        *out = x ? co * si * si : si * co * co;
        break;
      case CauseKind::kBacklash:
        out[0] = x ? -0.5 * vx * co : -0.5 * vy * si;
        if (cause.count > 1) out[1] = x ? -0.5 * vx * std::abs(co) : -0.5 * vy * std::abs(si);
        break;
      case CauseKind::kServoMismatch:
        *out = at.direction * speed * std::sin(2.0 * at.angle);
        break;
      case CauseKind::kLateralPlay:
        *out = x ? -0.5 * vx * si : -0.5 * vy * co;
        break;
      case CauseKind::kLag:
        out[0] = -speed * speed;
        out[1] = -speed * speed * std::cos(2.0 * at.angle);
        break;
      case CauseKind::kCyclic: {
        const double phase = 2.0 * kPi * rows.radius * (x ? co : si) / cause.pitch;
        out[0] = (x ? co : si) * std::cos(phase);
        out[1] = (x ? co : si) * std::sin(phase);
        break;
      }
      case CauseKind::kCentre:
        if (cause.log == at.log) {
          out[0] = co;
          out[1] = si;
        }
        break;
      case CauseKind::kDrift:
        if (cause.log == at.log) {
          out[0] = at.progress * co;
          out[1] = at.progress * si;
        }
        break;
      case CauseKind::kReversalSpike:
      case CauseKind::kVibration:
        break;
    }
  }
  return v;
}

Design design_of(const CauseRows& rows, const std::vector<Pitch>& pitches) {
  Design d{columns_of(rows, pitches), {}};
  d.X.resize(static_cast<Eigen::Index>(rows.rows.size()), d.columns.count);
  for (std::size_t i = 0; i < rows.rows.size(); ++i)
    d.X.row(static_cast<Eigen::Index>(i)) = column_values(rows, d.columns, rows.rows[i]).transpose();
  return d;
}

}  // namespace stribeck::ident::circle
