#include "problems/contact/marker_blocks.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

namespace sinew {
namespace {

constexpr char kAxes[] = "xyz";

}  // namespace

void AddMarkerBlocks(Stance& stance, const std::vector<int>& columns, BlockRole role, double accuracy,
                     Layout& layout) {
  for (FootMarkers::Marker& marker : stance.markers.markers) {
    for (int axis = 0; axis < 3; ++axis) {
      Block block;
      block.trial = stance.trial;
      block.channel = fmt::format("{}_{}", marker.name, kAxes[axis]);
      block.quantity = "marker position";
      block.unit = "m";
      block.prediction_time = stance.time;
      block.columns = columns;
      for (int k = 0; k < 3; ++k) block.columns.push_back(marker.first_offset + k);
      for (std::size_t t = 0; t < stance.time.size(); ++t) {
        if (!std::isfinite(marker.measured[t][axis])) continue;
        block.sample.push_back(static_cast<int>(t));
        block.measured.push_back(marker.measured[t][axis]);
      }
      block.role = block.measured.empty() ? BlockRole::kPredicted : role;
      block.sigma = accuracy;
      block.weight = 1 / accuracy;
      marker.blocks[static_cast<std::size_t>(axis)] = static_cast<int>(layout.size());
      layout.push_back(std::move(block));
    }
  }
}

std::vector<Parameter> DeclareMarkerOffsets(const Stance& stance, const std::string& name) {
  constexpr double kPlacement = 0.01;  // [m] between a marker's place on a foot and on its model
  constexpr double kReach = 8;         // standard deviations
  std::vector<Parameter> declared;
  for (const FootMarkers::Marker& marker : stance.markers.markers) {
    for (int axis = 0; axis < 3; ++axis) {
      Parameter p = BaseParameter(fmt::format("{}.offset_{}@{}", marker.name, kAxes[axis], name), "m",
                                  "place of a marker on the foot, beside where the model has it",
                                  -kReach * kPlacement, kReach * kPlacement, 0);
      p.kind = ParameterKind::kNuisance;
      p.trial = stance.trial;
      p.prior = GaussianPrior{0, kPlacement};
      declared.push_back(std::move(p));
    }
  }
  return declared;
}

void PredictMarkers(const Stance& stance, int instant, const PoseDeviation& deviation, const Query& query,
                    Prediction& prediction) {
  const auto wanted = [&](const FootMarkers::Marker& marker) {
    return query.blocks[static_cast<std::size_t>(marker.blocks[0])] ||
           query.blocks[static_cast<std::size_t>(marker.blocks[1])] ||
           query.blocks[static_cast<std::size_t>(marker.blocks[2])];
  };
  const StanceMotionErrors& errors = stance.motion_errors;
  const FootTurn turn(deviation);
  for (const FootMarkers::Marker& marker : stance.markers.markers) {
    if (!wanted(marker)) continue;
    PoseJacobian jacobian;
    const BodyMotion body = DeviatedBody(stance.foot, marker.body, static_cast<std::size_t>(instant),
                                         deviation, turn, query.derivatives ? &jacobian : nullptr);
    const Vec3 place = marker.location + Vec3(query.parameters.segment<3>(marker.first_offset));
    const Vec3 arm = body.rotation * place;
    const Vec3 position = body.position + arm;
    for (int axis = 0; axis < 3; ++axis) {
      const int block = marker.blocks[static_cast<std::size_t>(axis)];
      if (!query.blocks[static_cast<std::size_t>(block)]) continue;
      prediction.values(block)[instant] = position[axis];
      if (!query.derivatives) continue;
      auto row = prediction.derivatives(block).row(instant);
      Eigen::Index at = 0;
      for (const PoseTerm& term : errors.terms) {
        const Eigen::Matrix<double, 6, 1> moved =
            jacobian.topLeftCorner<6, kPoseComponents>() * term.direction;
        const double slope = moved[axis] + Vec3(moved.tail<3>()).cross(arm)[axis];
        row.segment(at, term.weights()) = slope * term.basis.value.row(instant);
        at += term.weights();
      }
      row.segment(at, 3) = body.rotation.row(axis);
    }
  }
}

}  // namespace sinew
