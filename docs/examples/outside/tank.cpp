// A tank that is filled by a pump and drains through a hole, and one thing that might be wrong with the
// model.
#include <sinew/sinew.h>

using namespace sinew;

constexpr double kGravity = 9.81;       // [m/s2]
constexpr double kCrossSection = 0.01;  // [m2] of the tank

class Tank final : public OdeProblem<Tank, 1> {  // one state: level [m]
 public:
  explicit Tank(const Dataset& data) : OdeProblem(data) {
    area_ = parameter("outflow_area", "m2").bounds(1e-6, 1e-3).start(5e-5).log();
    gain_ = parameter("pump_gain", "m3/s/V").bounds(0, 1e-4).start(1e-5);
    rate_ = effect("overflow", Level::kBoundary)
                .description("water leaves over the rim above some level")
                .revealing_experiment("a trial that fills the tank to the rim")
                .parameter("overflow_rate", "1/s")
                .bounds(0, 10)
                .null(0);
    rim_ = effect("overflow").parameter("rim_level", "m").bounds(0.05, 0.5).probes({0.1, 0.2, 0.3});
    pump_ = input("pump", "V");
    observe("level", state(0));  // like every measured channel it gets the effects of a sensor
  }
  template <class T>  // T is double or a dual number: sensitivities are exact
  void derivative(const Values<T>& p, double t, const State<T>& x, State<T>& dx) const {
    dx[0] =
        (p[gain_] * p.input(pump_, t) - p[area_] * sqrt(2 * kGravity * positive_part(x[0]))) / kCrossSection -
        p[rate_] * positive_part(x[0] - p[rim_]);
  }

 private:
  ParameterHandle area_, gain_, rate_, rim_;
  InputHandle pump_;
};

int main(int argc, char** argv) {
  return RunCommandLine<Tank>(argc, argv, "tank");
}
