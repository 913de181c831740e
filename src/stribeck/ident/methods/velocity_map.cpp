#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/methods/velocity_map.hpp>

namespace stribeck::ident::methods {

Result identify_velocity_map(const std::vector<log::Record>& records, const VelocityMapOptions& options) {
  drive::DriveFitOptions drive;
  drive.mass = options.mass;
  drive.shift = -0.5;
  drive.filter = false;
  drive.terms = options.terms;
  drive.most_terms = options.most_terms;
  drive.symmetric = false;
  drive.periodic = false;
  drive.dynamics = false;
  drive.bins = options.bins;
  drive.curve_points = options.curve_points;
  drive.map_points = options.map_points;
  Result result = drive::identify_drive(records, drive);
  result.method = Method::kVelocityMap;
  return result;
}

}  // namespace stribeck::ident::methods
