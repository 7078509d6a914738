// A diagnosis with an entry in every list, whose values were not computed.
#pragma once

#include <string>
#include <utility>

#include "identify/diagnosis/diagnosis.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew::toy {

/// y = rate t + friction + delay on a training and a held-out trial; the null of friction and delay is 0.
inline ToyProblem JointProblem() {
  Parameter friction = MakeParameter("friction_level", 0, 5, 0, ParameterKind::kEffect);
  friction.effect = "friction";
  Parameter delay = MakeParameter("y.delay", -1, 1, 0, ParameterKind::kEffect);
  delay.effect = "y.delay";
  return {{MakeParameter("rate", -10, 10, 1), std::move(friction), std::move(delay)},
          {MakeBlock("slow", "y", 5, 1), MakeBlock("check", "y", 4, 1, BlockRole::kValidate)},
          [](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
            if (gradient != nullptr) *gradient << t, 1, 1;
            return p[0] * t + p[1] + p[2];
          }};
}

inline DiagnosedParameter Diagnosed(std::string name, double value, double std_error, double before) {
  return {std::move(name), "N", value, std_error, {value - 2 * std_error, value + 2 * std_error}, before};
}

inline EffectScore Scored(std::string effect, Level level) {
  EffectScore score;
  score.effect = std::move(effect);
  score.level = level;
  return score;
}

/// Friction is the cause, a delay an alternative; a gain was rejected, an offset ruled out, a drift not
/// judged, and a discrepancy term found.
inline Diagnosis JointDiagnosis(const ToyProblem& problem) {
  Diagnosis d;
  d.verdict = DiagnosisVerdict::kAmbiguous;
  d.has_held_out = true;
  d.warnings = {{WarningKind::kOther, {}, {}, "only one held-out trial"}};
  d.setup = MakeFitSetup(problem, {}).value();
  d.base.stop = {Termination::kCostChange, "relative cost change 1e-13 < 1e-12"};
  d.base.cost = 12.5;
  d.base_parameters = {Diagnosed("rate", 1.5, 0.1, 1.5)};
  d.base_fit = {{"", BlockRole::kTrain, "y", "N", 0.5, 0.9, 5},
                {"", BlockRole::kValidate, "y", "N", 0.6, 0.8, 4}};
  d.extended_fit = {{"", BlockRole::kTrain, "y", "N", 0.1, 0.99, 5}};
  d.noise = {{"y", "N", 0.1, 0.5, NoiseBasis::kStatedByData}};
  d.tests = {{"y", "Ljung-Box", 80, 1e-9}};
  d.structure = {{"y", "speed", "rad/s", 0.31, {ShapeKind::kStep, 0.9}, {-1, 0, 1}, {-0.2, 0, 0.2}}};
  d.threshold = 2.9;
  d.family_p_value = 1e-4;

  EffectScore friction = Scored("friction", Level::kRobot);
  friction.statistic = 90;
  friction.p_value = 1e-12;
  friction.refitted = true;
  friction.delta_lr = 80;
  friction.delta_bic = 75;
  EffectScore delay = Scored("y.delay", Level::kSensor);
  EffectScore gain = Scored("y.gain", Level::kSensor);
  EffectScore offset = Scored("y.offset", Level::kSensor);
  offset.p_value = 0.4;
  offset.smallest_detectable = 0.02;
  offset.detectable_parameter = "y.offset";
  offset.detectable_unit = "N";
  EffectScore drift = Scored("y.drift", Level::kSensor);
  drift.judged = false;
  drift.why_not = NotJudged::kNoDistinctChange;
  EffectScore term = Scored("torque(speed)", Level::kRobot);
  term.known = false;
  d.scores = {friction, delay, gain, term, offset, drift};

  Cause cause;
  cause.effect = "friction";
  cause.level = Level::kRobot;
  cause.description = "dry friction brakes the joint";
  cause.parameters = {Diagnosed("friction_level", 0.7, 0.05, 0)};
  cause.p_value = 1e-12;
  cause.delta_lr = 80;
  cause.delta_bic = 75;
  cause.size = 4.5;
  d.causes = {cause};
  Alternative alternative;
  alternative.instead_of = "friction";
  alternative.effect = "y.delay";
  alternative.description = "the sensor is late";
  alternative.parameters = {Diagnosed("y.delay", 0.01, 0.001, 0)};
  alternative.delta_lr = 3.1;
  alternative.separating_size = 2.5;
  alternative.separated_by = "a trial at two speeds";
  d.alternatives = {alternative};
  d.levels = {{Level::kRobot, LevelStanding::kBlamed, {"friction"}, 1, 80, 0, 0},
              {Level::kSensor, LevelStanding::kPossible, {"y.delay"}, 1, 76.9, 3.1, 0}};
  d.withdrawn = {{"y.gain", 30, 12, TraceErrors{"check", "y", "N", 0.6, 0.9}}};
  d.unknown_terms = {{UnknownKind::kCurve,
                      "torque(speed)",
                      "torque",
                      "speed",
                      "rad/s",
                      "N*m",
                      {ShapeKind::kStep, 0.9},
                      0,
                      0.001,
                      0.22,
                      {-1, 1},
                      {-0.1, 0.1},
                      {0.01, 0.02}}};
  d.gain = {{"y", "N", 0.6, 0.15, 0.75, {0.6, 0.8}, 0.9}};
  d.extended_parameters = {Diagnosed("rate", 1.2, 0.02, 1.5), Diagnosed("friction_level", 0.7, 0.05, 0)};
  d.base_point = Values({1.5, 0, 0});
  d.extended_point = Values({1.2, 0.7, 0});
  d.traces = {{"check", BlockRole::kValidate, "y", "N", {0, 1}, {0.7, 1.9}, {0, 1.5}, {0.7, 1.9}}};
  d.seconds = 1.5;
  return d;
}

}  // namespace sinew::toy
