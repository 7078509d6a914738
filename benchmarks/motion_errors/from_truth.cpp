// The cost of a fit of stances that begins at their true parameters and at the true motion of the foot: a
// search that ends higher has missed a minimum. For search.py.
//
// usage: motion_from_truth WITH_ERRORS.h5 EXACT.h5 SETTINGS.yaml FIVE TRUE PARAMETERS
// The two files are the same synthetic stances, recorded with and without errors of the foot's motion.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>
#include <vector>

#include "base/yaml_reader.h"
#include "datasets/io/dataset_file.h"
#include "identify/solvers/local_fit.h"
#include "identify/solvers/marginal_cost.h"
#include "problems/contact/problem.h"
#include "problems/contact/stance.h"

namespace sinew {
namespace {

using Pose = Eigen::Matrix<double, 6, 1>;  // shift [m], rotation vector [rad]

// How closely the curves are to follow the true deviation along and about each axis, and its rate over that:
// a foot's height decides more than where it stands.
constexpr double kCloseness[] = {1e-4, 2e-5, 1e-4, 5e-4, 5e-4, 5e-4};  // [m, rad]
constexpr double kRate = 20;                                           // [1/s]

Result<std::unique_ptr<ContactProblem>> Load(const std::string& data, const std::string& settings) {
  std::ifstream file(settings);
  std::stringstream text;
  text << file.rdbuf();
  SINEW_ASSIGN(const YamlReader yaml, YamlReader::Parse(text.str(), settings));
  SINEW_ASSIGN(const YamlReader section, yaml.At("contact"));
  SINEW_ASSIGN(const Dataset set, ReadDataset(data));
  SINEW_ASSIGN(ContactSettings contact, ReadContactSettings(section, set.files));
  return ContactProblem::Make(set, std::move(contact));
}

// By which the recorded foot has to be turned about its centre and shifted to lie as the true one.
Pose Deviation(const Stance& recorded, const Stance& exact, std::size_t t) {
  const BodyMotion& from = recorded.foot.bodies.front().motion[t];
  const BodyMotion& to = exact.foot.bodies.front().motion[t];
  const Mat3 turn = to.rotation * from.rotation.transpose();
  const Eigen::AngleAxisd angle(turn);
  const Vec3 centre = recorded.foot.centre[t];
  Pose pose;
  pose << to.position - (centre + turn * (from.position - centre)), angle.angle() * angle.axis();
  return pose;
}

// Adds the normal equations of the weights of a stance's curves.
void AddStance(const Stance& recorded, const Stance& exact, const DeviationBases& bases, Matrix& normal,
               Vector& pull) {
  const auto add = [&](const Vector& row, double value, double closeness) {
    normal += row * row.transpose() / (closeness * closeness);
    pull += row * value / (closeness * closeness);
  };
  const std::size_t last = recorded.time.size() - 1;
  for (std::size_t t = 0; t <= last; ++t) {
    const Pose pose = Deviation(recorded, exact, t);
    const std::size_t before = std::max<std::size_t>(t, 1) - 1;
    const std::size_t after = std::min(t + 1, last);
    const Pose rate = (Deviation(recorded, exact, after) - Deviation(recorded, exact, before)) /
                      (recorded.time[after] - recorded.time[before]);
    for (int k = 0; k < 6; ++k) {
      Vector by_value = Vector::Zero(pull.size());
      Vector by_rate = Vector::Zero(pull.size());
      for (const PoseTerm& term : recorded.motion_errors.terms) {
        const auto row = static_cast<Eigen::Index>(t);
        by_value.segment(term.first, term.weights) += bases.Of(term).value.row(row) * term.direction[k];
        by_rate.segment(term.first, term.weights) += bases.Of(term).rate.row(row) * term.direction[k];
      }
      add(by_value, pose[k], kCloseness[k]);
      if (t > 0 && t < last) add(by_rate, rate[k], kRate * kCloseness[k]);
    }
  }
}

Status Run(int count, char** words) {
  if (count != 9) return Fail("usage: motion_from_truth WITH_ERRORS.h5 EXACT.h5 SETTINGS.yaml FIVE VALUES");
  SINEW_ASSIGN(const auto recorded, Load(words[1], words[3]));
  SINEW_ASSIGN(const auto exact, Load(words[2], words[3]));
  SINEW_ASSIGN(FitSetup setup, MakeFitSetup(*recorded, {}));
  const auto parameters = static_cast<Eigen::Index>(setup.parameters.size());
  Matrix normal = Matrix::Identity(parameters, parameters);  // of the priors
  Vector pull = Vector::Zero(parameters);
  for (const Stance& stance : recorded->data().stances) {
    const auto& others = exact->data().stances;
    const auto same = std::find_if(others.begin(), others.end(),
                                   [&](const Stance& other) { return other.trial == stance.trial; });
    if (same == others.end() || same->time != stance.time)
      return Fail("the two files differ in their stances");
    AddStance(stance, *same, stance.motion_errors.BasesAt(setup.rest), normal, pull);
  }
  const Vector weights = normal.ldlt().solve(pull);
  for (const int index : setup.free) {
    const Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
    setup.rest[index] = p.kind == ParameterKind::kNuisance ? std::clamp(weights[index], p.lower, p.upper)
                                                           : std::stod(words[4 + index]);
  }
  const LeastSquares fit(*recorded, setup);
  const auto end = solvers::LocalFit(fit).Minimize(fit.Start(), -1, {0, 1e-9}, 5000);
  if (!end.failure.empty()) return Fail("{}", end.failure);
  fmt::print("{{\"cost\": {:.10g}, \"marginal_cost\": {:.10g}}}\n", end.cost,
             solvers::MarginalCost(fit, end.x));
  return {};
}

}  // namespace
}  // namespace sinew

int main(int count, char** words) {
  const sinew::Status done = sinew::Run(count, words);
  if (!done) fmt::print(stderr, "motion_from_truth: {}\n", done.error().message);
  return done ? 0 : 1;
}
