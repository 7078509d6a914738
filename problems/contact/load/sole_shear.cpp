#include "problems/contact/load/sole_shear.h"

namespace sinew {

void SoleShear::Begin(double compliance) {
  compliance_ = compliance;
  instants_ = 0;
  velocity_.setZero();
  accepted_.setZero();
  force_.fill(Horizontal::Zero());
  slope_.setZero();
  for (Matrix2X& slope : before_) slope.setZero();
}

void SoleShear::Next(double time) {
  const double before = step_;
  step_ = time - time_;
  time_ = time;
  force_[1] = force_[0];
  force_[0] = accepted_;
  before_[1].swap(before_[0]);
  before_[0].swap(slope_);
  now_ = once_ = twice_ = 0;
  if (instants_ == 1) {
    now_ = once_ = 1 / step_;
  } else if (instants_ > 1) {
    const double ratio = step_ / before;
    now_ = (1 + 2 * ratio) / ((1 + ratio) * step_);
    once_ = (1 + ratio) / step_;
    twice_ = ratio * ratio / ((1 + ratio) * step_);
  }
  ++instants_;
}

void SoleShear::Accept(const Horizontal& velocity, const Horizontal& force,
                       const HorizontalJacobian& by_slip) {
  velocity_ = velocity;
  accepted_ = force;
  by_slip_ = by_slip;
  felt_ = Inverse(HorizontalJacobian::Identity() - (compliance_ * now_) * by_slip);
}

Horizontal SoleShear::Slope(Eigen::Index column, const Horizontal& by_parameter) {
  // F' = P + W w', w' = C (now F' - past'): so w' = (1 - C now W)^-1 C (now P - past').
  const Horizontal past = once_ * before_[0].col(column) - twice_ * before_[1].col(column);
  const Horizontal velocity = felt_ * (compliance_ * (now_ * by_parameter - past));
  slope_.col(column) = by_parameter + by_slip_ * velocity;
  return velocity;
}

}  // namespace sinew
