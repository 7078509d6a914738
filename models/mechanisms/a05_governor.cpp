// A05: a flyball governor. A shaft that spins freely carries two rods with a ball each, and a slider that
// hangs on the rods by two stiff springs with dampers. Table 7 of the thesis, as corrected by the reference
// curve: shaft and rods 1 x 0.01 x 0.01 m, slider a cube of 0.1 m, density 3000 kg/m3, balls of 5 kg, rods
// hinged 0.1 m apart.
#include <utility>
#include <vector>

#include "models/mechanisms/mechanism_system.h"

namespace sinew {
namespace {

using SimTK::Vec3;

constexpr double kDensity = 3000;
constexpr double kBall = 5;
constexpr double kStiffness = 8e5;      // [N/m]
constexpr double kDamping = 4e4;        // [N s/m]
constexpr double kCouplerLength = 0.5;  // [m]
constexpr double kHalfGap = 0.05;       // [m] of the hinges from the axis
constexpr double kShaft = 1;            // [m]
constexpr double kSliderStart = 0.5;    // [m] above the foot of the shaft
const Vec3 kRodSize(1, 0.01, 0.01);
const Vec3 kShaftSize(0.01, kShaft, 0.01);
const Vec3 kSliderSize(0.1, 0.1, 0.1);

double MassOf(const Vec3& size) {
  return kDensity * size[0] * size[1] * size[2];
}

SimTK::Inertia BoxAt(const Vec3& size, const Vec3& centre) {
  return (MassOf(size) * SimTK::UnitInertia::brick(size / 2)).shiftFromMassCenter(centre, MassOf(size));
}

/// @param side -1 or 1
SimTK::MassProperties RodWithBall(double side) {
  const Vec3 middle(side * kRodSize[0] / 2, 0, 0);
  const Vec3 tip(side * kRodSize[0], 0, 0);
  const double rod = MassOf(kRodSize);
  return {rod + kBall, (rod * middle + kBall * tip) / (rod + kBall),
          BoxAt(kRodSize, middle) + SimTK::Inertia(tip, kBall)};
}

struct Damper {
  SimTK::MobilizedBody rod, slider;
  Vec3 of_rod, of_slider;
};

/// Power that the dampers put into the mechanism [W], at most 0.
class DampedPower final : public SimTK::Measure_<double>::Implementation {
 public:
  explicit DampedPower(std::vector<Damper> dampers) : dampers_(std::move(dampers)) {}
  DampedPower* cloneVirtual() const override { return new DampedPower(*this); }
  int getNumTimeDerivativesVirtual() const override { return 0; }
  SimTK::Stage getDependsOnStageVirtual(int /*order*/) const override { return SimTK::Stage::Velocity; }
  void calcCachedValueVirtual(const SimTK::State& state, int /*order*/, double& value) const override {
    value = 0;
    for (const Damper& d : dampers_) {
      const Vec3 along = d.rod.findStationLocationInGround(state, d.of_rod) -
                         d.slider.findStationLocationInGround(state, d.of_slider);
      const Vec3 apart = d.rod.findStationVelocityInGround(state, d.of_rod) -
                         d.slider.findStationVelocityInGround(state, d.of_slider);
      const double rate = SimTK::dot(apart, along) / along.norm();
      value -= kDamping * rate * rate;
    }
  }

 private:
  std::vector<Damper> dampers_;
};

/// Simbody lets only measures make measures.
struct Power : SimTK::Measure_<double> {
  Power(SimTK::Subsystem& subsystem, Implementation* what) : Measure_<double>(subsystem, what, SetHandle()) {}
};

}  // namespace

std::unique_ptr<MechanismSystem> BuildGovernor() {
  using SimTK::MobilizedBody;
  using SimTK::Vec3;
  auto m = std::make_unique<MechanismSystem>();
  SimTK::Force::UniformGravity(m->forces, m->matter, Vec3(0, -9.81, 0));
  const SimTK::Transform upright(SimTK::Rotation(-SimTK::Pi / 2, SimTK::XAxis));     // z is up
  const SimTK::Transform along_shaft(SimTK::Rotation(SimTK::Pi / 2, SimTK::ZAxis));  // x is up
  const Vec3 middle(0, kShaft / 2, 0);
  MobilizedBody::Pin shaft(
      m->matter.Ground(), upright,
      SimTK::Body::Rigid(SimTK::MassProperties(MassOf(kShaftSize), middle, BoxAt(kShaftSize, middle))),
      upright);
  MobilizedBody::Slider slider(
      shaft, along_shaft,
      SimTK::Body::Rigid(SimTK::MassProperties(MassOf(kSliderSize), Vec3(0), BoxAt(kSliderSize, Vec3(0)))),
      along_shaft);
  std::vector<MobilizedBody> rods;
  std::vector<Damper> dampers;
  for (const double side : {-1.0, 1.0}) {
    MobilizedBody::Pin rod(shaft, Vec3(side * kHalfGap, kShaft, 0), SimTK::Body::Rigid(RodWithBall(side)),
                           SimTK::Transform());
    const Vec3 of_rod(side * kRodSize[0] / 2, 0, 0);
    const Vec3 of_slider(side * kHalfGap, 0, 0);
    SimTK::Force::TwoPointLinearSpring(m->forces, rod, of_rod, slider, of_slider, kStiffness, kCouplerLength);
    SimTK::Force::TwoPointLinearDamper(m->forces, rod, of_rod, slider, of_slider, kDamping);
    rods.push_back(rod);
    dampers.push_back({rod, slider, of_rod, of_slider});
  }
  const Power power(m->forces, new DampedPower(dampers));
  const SimTK::Measure_<double>::Integrate work(m->forces, power, SimTK::Measure_<double>::Zero());
  m->state = m->system.realizeTopology();
  shaft.setRate(m->state, 2 * SimTK::Pi);
  slider.setLength(m->state, kSliderStart);
  // 30 degrees below level.
  for (std::size_t i = 0; i < rods.size(); ++i)
    rods[i].setOneQ(m->state, 0, (i == 0 ? 1 : -1) * SimTK::Pi / 6);
  m->work = [work](const SimTK::State& state) { return work.getValue(state); };
  m->coordinates = [slider](const SimTK::State& state) {
    return Vector(Vector::Constant(1, slider.getLength(state)));
  };
  return m;
}

}  // namespace sinew
