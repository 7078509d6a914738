#include "problems/drive/data/conventions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/decompositions.h"
#include "problems/drive/data/weak_form.h"

namespace sinew {
namespace {

constexpr double kTooLong = 0.5;  // [s] between samples
constexpr double kSlow = 0.05;    // of the highest speed: the direction is uncertain
constexpr Eigen::Index kFewRows = 40;
constexpr double kAgainst = -0.7;        // partial correlation of input and acceleration
constexpr double kRatherAgainst = -0.3;  // ... where the joint clearly gives energy back
constexpr double kFollows = 0.8;         // correlation of reference and motion
constexpr double kFarBetter = 0.25;      // of the squared residual
constexpr double kAsGood = 1.2;
// Of what follows a reference: it may lag behind, and overshoot a little.
constexpr double kLeastFollowed = 1.0 / 3;
constexpr double kMostFollowed = 1.5;
constexpr double kBetterThanSpring = 0.5;
constexpr double kLeastRange = 0.1;  // [rad] over which gravity has a shape
constexpr double kMostRange = 100;   // [rad] of a unit that makes angles larger
constexpr double kTurns = 3 * kPi;   // [rad] more than a joint that hangs and swings
constexpr double kOffUpright = 0.3;  // sine of the angle between down, or up, and position 0
// Of the product of the root mean squares of input and speed.
constexpr double kNoPower = 0.02;
constexpr double kGivesBack = -0.1;
constexpr double kDegree = kPi / 180;

using Columns = std::vector<Vector>;

// What is left of a vector beside columns.
Vector Left(const Columns& columns, const Vector& of) {
  if (columns.empty()) return of;
  Matrix a(of.size(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const double length = columns[k].norm();
    a.col(static_cast<Eigen::Index>(k)) = length > 0 ? Vector(columns[k] / length) : columns[k];
  }
  return of - a * Eigen::ColPivHouseholderQR<Matrix>(a).solve(of);
}

// The weak form of all trials, with gravity in some unit of the angle.
struct Equation {
  Vector command, acceleration, speed, gravity, across, direction, position, one;

  [[nodiscard]] Columns Base() const { return {acceleration, speed, direction, one}; }
  // Of the squared residual of the command.
  [[nodiscard]] double Residual(std::initializer_list<const Vector*> beside) const {
    Columns columns = Base();
    for (const Vector* column : beside) columns.push_back(*column);
    return Left(columns, command).squaredNorm();
  }
};

Equation WeakForm(const DriveJoint& joint, const DriveCommand& command,
                  const std::vector<DriveMotion>& motions, double angle_unit) {
  double most_speed = 0;
  for (const DriveMotion& motion : motions) {
    for (const double v : motion.speed) most_speed = std::max(most_speed, std::abs(v));
  }
  const std::vector<WeakRow> rows =
      WeakRows(command, joint.electric, motions, kSlow * std::max(most_speed, 1e-12), angle_unit);
  const auto column = [&](double WeakRow::*member) {
    Vector values(static_cast<Eigen::Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) values[static_cast<Eigen::Index>(i)] = rows[i].*member;
    return values;
  };
  return {column(&WeakRow::command),        column(&WeakRow::acceleration),
          column(&WeakRow::speed),          column(&WeakRow::gravity),
          column(&WeakRow::gravity_across), column(&WeakRow::direction),
          column(&WeakRow::position),       column(&WeakRow::one)};
}

// [rad or m] between the lowest and the highest position of all trials
double RangeOf(const std::vector<DriveMotion>& motions) {
  double low = INFINITY;
  double high = -INFINITY;
  for (const DriveMotion& motion : motions) {
    for (const double q : motion.position) {
      low = std::min(low, q);
      high = std::max(high, q);
    }
  }
  return high > low ? high - low : 0;
}

// The unit in which gravity explains the command, if it is not the radian.
void JudgeUnit(const DriveJoint& joint, const DriveCommand& command, const std::vector<DriveMotion>& motions,
               Equation& equation, DriveConventions& found) {
  const double range = RangeOf(motions);
  const double alone = equation.Residual({&equation.gravity, &equation.across});
  const double beside_spring = equation.Residual({&equation.gravity, &equation.across, &equation.position});
  double least = kFarBetter * beside_spring;
  Equation best = equation;
  for (const double unit : {kDegree, 2 * kPi, 1 / kDegree, 0.5 / kPi}) {
    if (unit * range < kLeastRange || (unit > 1 && unit * range > kMostRange)) continue;
    const Equation other = WeakForm(joint, command, motions, unit);
    const double left = other.Residual({&other.gravity, &other.across});
    const bool by_gravity = left < least;
    if (!by_gravity &&
        (unit != kDegree || range < kTurns || left > kFarBetter * alone || left > kAsGood * beside_spring))
      continue;
    if (by_gravity) least = left;
    found.angle_unit = unit;
    found.by_gravity = by_gravity;
    best = other;
  }
  equation = best;
}

void JudgeZero(const Equation& equation, DriveConventions& found) {
  const double sine = equation.Residual({&equation.gravity});
  const double with_spring = equation.Residual({&equation.gravity, &equation.position});
  const double both = equation.Residual({&equation.gravity, &equation.across});
  if (both > kFarBetter * sine || both > kAsGood * with_spring) return;
  // G sin(q - zero) = A sin q + B cos q with G > 0, each beside all other columns.
  Columns others = equation.Base();
  const Vector u = Left(others, equation.command);
  Matrix a(u.size(), 2);
  a.col(0) = Left(others, equation.gravity);
  a.col(1) = Left(others, equation.across);
  const Vector x = Eigen::ColPivHouseholderQR<Matrix>(a).solve(u);
  const double sign = found.opposite_input ? -1 : 1;
  const double zero = std::atan2(-sign * x[1], sign * x[0]);
  if (std::abs(std::sin(zero)) < kOffUpright) return;
  found.hangs_at = zero;
  found.by_gravity = both < kBetterThanSpring * with_spring;
}

void JudgeSign(const Equation& equation, bool rotary, DriveConventions& found) {
  Columns others = {equation.speed, equation.direction, equation.one, equation.position};
  if (rotary) others.insert(others.end(), {equation.gravity, equation.across});
  const Vector u = Left(others, equation.command);
  const Vector a = Left(others, equation.acceleration);
  const double scale = u.norm() * a.norm();
  if (!(scale > 0)) return;
  const double correlation = u.dot(a) / scale;
  // Over all trials a joint takes up energy: what its friction takes, and what was stored.
  const double power = equation.command.dot(equation.speed) /
                       std::max(equation.command.norm() * equation.speed.norm(), 1e-300);
  found.opposite_input =
      (correlation < kAgainst && power < kNoPower) || (correlation < kRatherAgainst && power < kGivesBack);
}

// @param angles the positions are measured angles
void JudgeReference(const DriveCommand& command, const std::vector<DriveMotion>& motions, bool angles,
                    DriveConventions& found) {
  const bool of_speed = command.controller == DriveControllerKind::kPidSpeed;
  double rr = 0;
  double rm = 0;
  double mm = 0;
  for (const DriveMotion& motion : motions) {
    const std::vector<double>& values = of_speed ? motion.speed : motion.position;
    const auto n = static_cast<Eigen::Index>(values.size());
    if (n == 0) continue;
    Vector reference(n);
    for (Eigen::Index i = 0; i < n; ++i)
      reference[i] = RecordedInput(*motion.run, motion.time[static_cast<std::size_t>(i)]);
    Vector measured = Eigen::Map<const Vector>(values.data(), n);
    reference.array() -= reference.mean();
    measured.array() -= measured.mean();
    rr += reference.squaredNorm();
    rm += reference.dot(measured);
    mm += measured.squaredNorm();
  }
  if (!(rr > 0) || !(mm > 0)) return;
  const double correlation = rm / std::sqrt(rr * mm);
  if (std::abs(correlation) < kFollows) return;
  found.opposite_input = correlation < 0;
  for (const double unit : {kDegree, 1 / kDegree}) {
    const double followed = unit * std::abs(rm / rr);
    if (angles && followed > kLeastFollowed && followed < kMostFollowed) found.angle_unit = unit;
  }
}

}  // namespace

DriveConventions JudgeConventions(const DriveJoint& joint, const DriveCommand& command,
                                  const std::vector<DriveMotion>& motions) {
  DriveConventions found;
  const double interval = UsualInterval(motions);
  if (interval >= kTooLong) found.interval = interval;
  const bool angles =
      joint.rotary && std::none_of(motions.begin(), motions.end(),
                                   [](const DriveMotion& motion) { return motion.speed_measured; });
  if (command.input == DriveInput::kReference) {
    JudgeReference(command, motions, angles, found);
    return found;
  }
  Equation equation = WeakForm(joint, command, motions, 1);
  if (equation.command.size() < kFewRows || !equation.command.allFinite()) return found;
  if (angles) JudgeUnit(joint, command, motions, equation, found);
  JudgeSign(equation, joint.rotary, found);
  if (angles && !found.angle_unit) JudgeZero(equation, found);
  return found;
}

std::vector<std::string> ConventionNotes(const DriveConventions& conventions, const std::string& input) {
  std::vector<std::string> notes;
  if (conventions.interval) {
    notes.push_back(
        fmt::format("a sample every {:.3g} s is too seldom for a joint: are the times in milliseconds? The "
                    "import map says so with time: {{unit: ms}}",
                    *conventions.interval));
  }
  if (conventions.opposite_input) {
    notes.push_back(
        fmt::format("the joint moves against '{}', as if one of the two had the opposite sign: scale: -1 in "
                    "the import map turns it",
                    input));
  }
  if (conventions.angle_unit) {
    const double unit = *conventions.angle_unit;
    const char* const meant = unit < 0.1  ? "degrees, which are read as radians"
                              : unit < 1  ? "radians, which are read as turns"
                              : unit < 10 ? "turns, which are read as radians"
                                          : "radians, which are read as degrees";
    notes.push_back(
        fmt::format("the position moves as if its numbers were {}{}: see unit in the import map", meant,
                    conventions.by_gravity ? "" : " (or a spring turns a joint by many radians)"));
  }
  if (conventions.hangs_at) {
    notes.push_back(fmt::format(
        "gravity_torque is that of a joint that hangs down at 0, and this one hangs at about {:.3g} rad{}",
        *conventions.hangs_at,
        conventions.by_gravity ? ": release position.offset"
                               : ", or a spring holds it: release position.offset or parallel_spring, or let "
                                 "diagnose tell them apart"));
  }
  return notes;
}

}  // namespace sinew
