// Pressures, slip and centre of pressure under every region, for the pictures of a report.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/constants.h"
#include "problems/contact/load/posed_load.h"
#include "problems/contact/problem.h"
#include "problems/contact/steps/body_rows.h"

namespace sinew {

namespace {

// Only what all stances have in common.
Vector WithoutOwn(const StanceMotionErrors& errors, const Vector& parameters) {
  Vector common = parameters;
  const auto [from, to] = errors.OwnRange();
  common.segment(from, to - from).setZero();
  return common;
}

// How far the pose moved, and what the markers say of that.
void WriteMotionErrors(const Stance& stance, const Vector& parameters, Hdf5Node& details) {
  const StanceMotionErrors& errors = stance.motion_errors;
  if (errors.terms.empty()) return;
  Hdf5Node& node = details.At("motion_errors/" + stance.trial + "/" + stance.plate);
  std::vector<std::string> names;
  std::vector<double> prior;
  for (const int c : errors.components) {
    names.emplace_back(ToString(static_cast<PoseComponent>(c)));
    prior.push_back(errors.deviation[static_cast<std::size_t>(c)]);
  }
  std::vector<double> values;
  std::vector<double> common;
  const Vector without_own = WithoutOwn(errors, parameters);
  std::vector<double> before;
  std::vector<double> after;
  for (std::size_t t = 0; t < stance.time.size(); ++t) {
    const PoseDeviation deviation = errors.At(parameters, static_cast<int>(t));
    const PoseDeviation shared = errors.At(without_own, static_cast<int>(t));
    for (const int c : errors.components) {
      values.push_back(deviation.value[static_cast<std::size_t>(c)]);
      common.push_back(shared.value[static_cast<std::size_t>(c)]);
    }
    const FootTurn turn(deviation);
    for (const FootMarkers::Marker& marker : stance.markers.markers) {
      const FootMotion::Body& body = stance.foot.bodies[marker.body];
      before.push_back(FootMarkers::Residual(marker, body.motion[t], t).norm());
      after.push_back(FootMarkers::Residual(
                          marker, DeviatedBody(stance.foot, marker.body, t, deviation, turn, nullptr), t)
                          .norm());
    }
  }
  std::vector<std::string> markers;
  for (const FootMarkers::Marker& marker : stance.markers.markers) markers.push_back(marker.name);
  const std::size_t instants = stance.time.size();
  node.At("time").SetVector(stance.time);
  node.At("prior").SetVector(std::move(prior));
  node.At("component").data = std::move(names);
  node.At("common").SetMatrix(instants, errors.components.size(), std::move(common));
  node.At("deviation").SetMatrix(instants, errors.components.size(), std::move(values));
  if (markers.empty()) return;
  node.At("marker_distance_recorded").SetMatrix(instants, markers.size(), std::move(before));
  node.At("marker_distance_deviated").SetMatrix(instants, markers.size(), std::move(after));
  node.At("marker").data = std::move(markers);
}

}  // namespace

Status ContactProblem::WriteDetails(const Vector& parameters, Hdf5Node& details) const {
  const auto groups = settings_.Groups();
  for (const Stance& stance : data_.stances) {
    WriteMotionErrors(stance, parameters, details);
    const ContactEffectValues effects = EffectsOn(stance.plate, parameters);
    // Where springs move, the kinematics of one instant after the other.
    std::optional<PosedFoot> posed;
    if (settings_.moves_springs()) posed.emplace(stance.kinematics);
    std::vector<Vec3> places(stance.parts.size(), Vec3::Zero());
    SolePlacesInto(stance, parameters, places);
    for (std::size_t r = 0; r < stance.regions.size(); ++r) {
      const EffectRegion& prepared = stance.kinematics.regions[r];
      const ContactKinematics& kinematics = prepared.kinematics;
      const ContactRegionSettings& settings = settings_.regions[static_cast<std::size_t>(stance.regions[r])];
      const ContactMesh& mesh = settings.region.mesh;
      const int group =
          static_cast<int>(std::find(groups.begin(), groups.end(), settings.group) - groups.begin());
      const ElasticFoundation foundation = Foundation(parameters, group);

      const std::vector<int> faces = settings.region.SpringFaceIndices();
      const auto in_body = [&](const Vec3& point) {
        return Vec3(settings.region.position + settings.region.rotation * point);
      };
      std::vector<double> outline;
      for (const int face : faces) {
        for (const int corner : mesh.faces[static_cast<std::size_t>(face)]) {
          const Vec3 point = in_body(mesh.vertices[static_cast<std::size_t>(corner)]);
          outline.push_back(point.x());
          outline.push_back(point.z());
        }
      }
      std::vector<double> pressure;
      std::vector<double> slip;
      std::vector<double> centre;
      std::vector<FaceLoad> loads;
      for (int t = 0; t < kinematics.instants; ++t) {
        if (posed) {
          posed->Place(stance.kinematics, stance.foot, settings_.floor.height, t,
                       stance.motion_errors.At(parameters, t), places, stance.side, false);
          ComputeFaceLoads(posed->kinematics(), posed->kinematics().regions[r], 0, foundation, effects,
                           loads);
        } else {
          ComputeFaceLoads(stance.kinematics, prepared, t, foundation, effects, loads);
        }
        double total = 0;
        Vec3 moment = Vec3::Zero();
        for (std::size_t i = 0; i < faces.size(); ++i) {
          const double force = loads[i].pressure * kinematics.area[i];
          pressure.push_back(loads[i].pressure);
          slip.push_back(loads[i].slip);
          total += force;
          moment += force * in_body(mesh.Centre(faces[i]));
        }
        centre.push_back(total > 0 ? moment.x() / total : std::numeric_limits<double>::quiet_NaN());
        centre.push_back(total > 0 ? moment.z() / total : std::numeric_limits<double>::quiet_NaN());
      }
      const auto instants = static_cast<std::size_t>(kinematics.instants);
      Hdf5Node& node = details.At("contact/" + stance.trial + "/" + settings.region.name);
      node.attributes["body"] = settings.body;
      node.attributes["plate"] = settings.plate;
      node.attributes["group"] = settings.group;
      node.At("time").SetVector(stance.time);
      node.At("outline").data = Hdf5Array{{faces.size(), 3, 2}, std::move(outline)};
      node.At("pressure").SetMatrix(instants, faces.size(), std::move(pressure));
      node.At("slip").SetMatrix(instants, faces.size(), std::move(slip));
      node.At("centre_of_pressure").SetMatrix(instants, 2, std::move(centre));
    }
  }
  return {};
}

std::vector<FigureOfMerit> ContactProblem::PriorFigures(const Vector& parameters) const {
  if (!settings_.motion_errors || data_.stances.empty()) return {};
  const StanceMotionErrors& errors = data_.stances.front().motion_errors;
  const auto figure = [&](int index, const char* name, const char* meaning,
                          const std::optional<double>& set) {
    constexpr double kSame = 1e-3;  // relative
    const int parameter = errors.spectrum + index;
    const Parameter& p = this->parameters()[static_cast<std::size_t>(parameter)];
    const double value = parameters[parameter];
    const std::string of_value = set && value == *set                         ? "; as set"
                                 : p.other_starts.empty() && value == p.start ? "; one stance does not tell"
                                 : value < (1 + kSame) * p.lower ? " (the least that is looked at)"
                                 : value > (1 - kSame) * p.upper ? " (the most that is looked at)"
                                                                 : "";
    return FigureOfMerit{name, meaning + of_value, value, parameter};
  };
  const MotionErrorSettings& set = *settings_.motion_errors;
  std::vector<FigureOfMerit> figures{
      figure(0, "correlation time", "s, standard deviation of the pose's errors over that of their rates",
             set.correlation_time),
      figure(1, "roughness", "share of the variance of the pose's errors whose rate may jump", set.roughness),
      figure(
          2, "between steps",
          "standard deviation of what of the pose's errors differs from step to step, over that of the rest",
          set.between_steps)};
  for (const PoseTerm& term : errors.terms) {
    if (term.of != DeviationOf::kFloor) continue;
    const bool along_x = term.component == kShiftX;
    const double stated = along_x ? settings_.floor.velocity_x : settings_.floor.velocity_z;
    figures.push_back({along_x ? "velocity of the floor along x" : "velocity of the floor along z",
                       fmt::format("m/s; stated as {:.3f} +-{:.3f} (standard deviation)", stated,
                                   settings_.FloorVelocityError()[along_x ? 0 : 1]),
                       stated + parameters[term.first]});
  }
  return figures;
}

std::vector<FigureOfMerit> ContactProblem::FiguresOfMerit(const Vector& parameters,
                                                          const std::vector<Vector>& /*predicted*/) const {
  std::vector<FigureOfMerit> figures = PriorFigures(parameters);
  for (const Stance& stance : data_.stances) {
    const StanceMotionErrors& errors = stance.motion_errors;
    if (errors.terms.empty()) continue;
    for (const bool turn : {false, true}) {
      const double scale = turn ? 180 / kPi : 1e3;
      double squares = 0;
      double largest = 0;
      for (std::size_t t = 0; t < stance.time.size(); ++t) {
        const PoseDeviation deviation = errors.At(parameters, static_cast<int>(t));
        const double* first = deviation.value.data() + (turn ? kTurnX : kShiftX);
        const Vec3 vector(first[0], first[1], first[2]);
        squares += vector.squaredNorm() / 3;
        largest = std::max(largest, vector.cwiseAbs().maxCoeff());
      }
      const auto component = static_cast<std::size_t>(turn ? kTurnX : kShiftX);
      figures.push_back(
          {(turn ? "rotation of the foot in " : "shift of the foot in ") + stance.trial,
           fmt::format("{}, root mean square {} an axis; largest {:.2g}, standard deviation of the "
                       "prior {:.2g}",
                       turn ? "degrees" : "mm", turn ? "about" : "along", scale * largest,
                       scale * errors.deviation[component]),
           scale * std::sqrt(squares / static_cast<double>(stance.time.size()))});
    }
  }
  const auto has_body = [](const Stance& stance) { return stance.body.has_value(); };
  if (std::none_of(data_.stances.begin(), data_.stances.end(), has_body)) return figures;
  const auto loads = FittedLoads(parameters);
  if (!loads) return figures;
  const BodyLoadErrors errors(StancesOf(BlockRole::kTrain), *loads);
  if (errors.vertical() > 0)
    figures.push_back({"error of the whole body's vertical force",
                       fmt::format("N, root mean square difference to the contact in single support of the "
                                   "fitted stances{}",
                                   errors.usable() ? ""
                                                   : ": no steps are predicted by it, since their means "
                                                     "differ by more than a quarter"),
                       errors.vertical()});
  return figures;
}

}  // namespace sinew
