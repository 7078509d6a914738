// Two tanks, one above the other: a pump fills the upper one, which drains into the lower one, whose level is
// measured. An example of a model outside of the library (docs/own_model.md), with what may be wrong with it.
#include "cli/run_command_line.h"
#include "problems/ode/ode_problem.h"

using namespace sinew;

class TwoTanks final : public OdeProblem<TwoTanks, 2> {  // levels, in volts of the lower tank's sensor
 public:
  explicit TwoTanks(const Dataset& data) : OdeProblem(data) {
    gain_ = parameter("pump_gain", "1/s").bounds(0.001, 0.5).start(0.03).log();
    upper_ = parameter("upper_outflow", "V^0.5/s").bounds(0.001, 0.5).start(0.04).log();
    lower_ = parameter("lower_outflow", "V^0.5/s").bounds(0.001, 0.5).start(0.04).log();
    upper_rate_ = effect("upper_overflow", Level::kRobot)
                      .description("water leaves over the upper tank's rim, a part of it into the lower tank")
                      .revealing_experiment("a trial that fills the upper tank to the rim")
                      .parameter("upper_rate", "1/s")
                      .bounds(0, 2)
                      .null(0);
    upper_rim_ = effect("upper_overflow").parameter("upper_rim", "V").bounds(2, 15).probes({5, 7, 9});
    caught_ = effect("upper_overflow").parameter("caught_share", "1").bounds(0, 1).probes({0, 0.5});
    lower_rate_ = effect("lower_overflow", Level::kRobot)
                      .description("water leaves over the lower tank's rim")
                      .revealing_experiment("a trial that fills the lower tank to the rim")
                      .parameter("lower_rate", "1/s")
                      .bounds(0, 2)
                      .null(0);
    lower_rim_ = effect("lower_overflow").parameter("lower_rim", "V").bounds(2, 15).probes({5, 7, 9});
    curve_ = effect("pump_curve", Level::kRobot)
                 .description("the pump delivers less per volt at high voltage")
                 .revealing_experiment("constant voltages, one after the other")
                 .parameter("pump_curve", "1/V")
                 .bounds(-0.15, 0.15)
                 .null(0);
    upper_power_ = effect("upper_exponent", Level::kRobot)
                       .description("the upper outflow grows with another power of the level than 0.5")
                       .revealing_experiment("emptying the full upper tank")
                       .parameter("upper_exponent", "1")
                       .bounds(-0.4, 0.5)
                       .null(0);
    lower_power_ = effect("lower_exponent", Level::kRobot)
                       .description("the lower outflow grows with another power of the level than 0.5")
                       .revealing_experiment("emptying the full lower tank")
                       .parameter("lower_exponent", "1")
                       .bounds(-0.4, 0.5)
                       .null(0);
    initial(0, "upper_level", "V").bounds(0, 15).start(4);
    pump_ = input("pump", "V");
    observe("level", state(1));
  }

  template <class T>
  void derivative(const Values<T>& p, double t, const State<T>& x, State<T>& dx) const {
    const double volts = p.input(pump_, t);
    const T through = p[upper_] * Power(x[0], 0.5 + p[upper_power_]);
    const T over = p[upper_rate_] * positive_part(x[0] - p[upper_rim_]);
    dx[0] = p[gain_] * volts * (1 - p[curve_] * volts) - through - over;
    dx[1] = through + p[caught_] * over - p[lower_] * Power(x[1], 0.5 + p[lower_power_]) -
            p[lower_rate_] * positive_part(x[1] - p[lower_rim_]);
  }

 private:
  // Without the infinite slope at 0.
  template <class T>
  static T Power(const T& level, const T& exponent) {
    return exp(exponent * log(positive_part(level) + 1e-6));
  }

  ParameterHandle gain_, upper_, lower_, upper_rate_, upper_rim_, caught_, lower_rate_, lower_rim_, curve_,
      upper_power_, lower_power_;
  InputHandle pump_;
};

int main(int argc, char** argv) {
  return RunCommandLine<TwoTanks>(argc, argv, "two_tanks");
}
