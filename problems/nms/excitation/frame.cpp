#include "problems/nms/excitation/frame.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sinew {
namespace {

constexpr int kMaxIterations = 200;
constexpr double kEnough = 1e-12;    // of the objective
constexpr double kRounding = 1e-15;  // of the objective with no excitation at all
constexpr double kArmijo = 1e-4;     // of the promised descent
constexpr double kProbe = 1e-4;      // excitation over which a slope's change is measured
constexpr double kMinBend = 1e-9;    // of the curvature by the moments: what makes it positive definite
constexpr double kMinShare = 1e-3;   // of the curvature by the effort
constexpr double kTiny = 1e-30;
constexpr int kGrid = 16;             // steps of the excitation to which one may jump
constexpr double kWorthAJump = 1e-8;  // of the objective
constexpr int kMaxJumps = 20;
constexpr double kFirstDamping = 1e-4;  // of the largest curvature
constexpr double kMoreDamping = 10;

double Kink(const ExcitationFrame& frame, Eigen::Index m, double e) {
  return std::isnan(frame.measured[m]) ? 0 : std::abs(e - frame.measured[m]);
}

double KinkSum(const ExcitationFrame& frame, const Vector& e) {
  double sum = 0;
  for (Eigen::Index m = 0; m < e.size(); ++m) sum += Kink(frame, m, e[m]);
  return sum;
}

struct Evaluation {
  double objective = 0;
  Vector rest;   // [joints] of the moments
  Vector slope;  // [muscles] of the forces
};

Result<Evaluation> Evaluate(const ExcitationFrame& frame, const FrameMuscles& muscles, const Vector& at) {
  Evaluation out;
  out.rest = frame.moment;
  out.slope.resize(at.size());
  for (Eigen::Index m = 0; m < at.size(); ++m) {
    SINEW_ASSIGN(const ForceAt force, muscles.Force(static_cast<int>(m), at[m]));
    out.rest -= frame.arms.col(m) * force.force;
    out.slope[m] = force.slope;
  }
  const ExcitationWeights& w = frame.weights;
  out.objective = w.alpha * out.rest.squaredNorm() + w.beta * at.squaredNorm() + w.gamma * KinkSum(frame, at);
  return out;
}

Vector SmoothGradient(const ExcitationFrame& frame, const Evaluation& here, const Vector& at) {
  const Vector by_force = -2 * frame.weights.alpha * (frame.arms.transpose() * here.rest);
  return by_force.cwiseProduct(here.slope) + 2 * frame.weights.beta * at;
}

// Slopes of the kinked function on both sides of a place, given that of its smooth part.
struct Slopes {
  double left = 0;
  double right = 0;
};
Slopes AddKink(double smooth, double gamma, double measured, double at) {
  if (std::isnan(measured)) return {smooth, smooth};
  return {smooth + (at > measured ? gamma : -gamma), smooth + (at >= measured ? gamma : -gamma)};
}

// How much of the slopes leads down inside of 0..1.
double Descent(const Slopes& slopes, double at) {
  return std::max({0.0, at < 1 ? -slopes.right : 0.0, at > 0 ? slopes.left : 0.0});
}

// The piecewise quadratic problem: which excitations rest at a bound or a kink, and on which side of their
// kink the others are.
class KinkedQuadratic {
 public:
  KinkedQuadratic(const Matrix& hessian, const Vector& gradient, double gamma, const Vector& measured,
                  const Vector& at)
      : hessian_(hessian), gradient_(gradient), gamma_(gamma), measured_(measured), at_(at), now_(at) {
    for (Eigen::Index m = 0; m < at.size(); ++m) {
      rests_.push_back(at[m] <= 0 || at[m] >= 1 || at[m] == measured[m]);
      side_.push_back(at[m] > measured[m] ? 1 : -1);
    }
  }

  Vector Solve() {
    const auto most = 50 * static_cast<int>(now_.size()) + 50;
    for (int i = 0; i < most && convex_; ++i) {
      if (MoveFree()) continue;
      if (!Release()) break;
    }
    return now_.cwiseMax(0).cwiseMin(1);
  }
  [[nodiscard]] bool convex() const { return convex_; }

 private:
  // To the minimum over those that are free, or to the first bound or kink on the way. @return whether it was
  // stopped on the way
  bool MoveFree() {
    free_.clear();
    for (Eigen::Index m = 0; m < now_.size(); ++m) {
      if (!rests_[static_cast<std::size_t>(m)]) free_.push_back(m);
    }
    if (free_.empty()) return false;
    Vector slope = (gradient_ + hessian_ * (now_ - at_))(free_);
    for (std::size_t k = 0; k < free_.size(); ++k) {
      if (!std::isnan(measured_[free_[k]]))
        slope[static_cast<Eigen::Index>(k)] += gamma_ * side_[static_cast<std::size_t>(free_[k])];
    }
    const Eigen::LLT<Matrix> curvature(hessian_(free_, free_));
    if (curvature.info() != Eigen::Success) {
      convex_ = false;
      return false;
    }
    const Vector step = -curvature.solve(slope);
    double share = 1;
    for (std::size_t k = 0; k < free_.size(); ++k)
      share = std::min(share, ShareToBreak(free_[k], step[static_cast<Eigen::Index>(k)]));
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const double move = step[static_cast<Eigen::Index>(k)];
      if (share < 1 && ShareToBreak(free_[k], move) <= share) {
        now_[free_[k]] = BreakAhead(free_[k], move);
        rests_[static_cast<std::size_t>(free_[k])] = true;
      } else {
        now_[free_[k]] += share * move;
      }
    }
    return share < 1;
  }

  [[nodiscard]] double BreakAhead(Eigen::Index m, double move) const {
    const int side = side_[static_cast<std::size_t>(m)];
    const bool kink = !std::isnan(measured_[m]) && side * move < 0;
    const double bound = move > 0 ? 1 : 0;
    if (!kink) return bound;
    return move > 0 ? std::min(bound, measured_[m]) : std::max(bound, measured_[m]);
  }

  [[nodiscard]] double ShareToBreak(Eigen::Index m, double move) const {
    if (move == 0) return 1;
    return std::max((BreakAhead(m, move) - now_[m]) / move, 0.0);
  }

  // Lets go of the excitation that rests where the function falls the steepest. @return whether there is one
  bool Release() {
    const Vector smooth = gradient_ + hessian_ * (now_ - at_);
    const double nothing = 1e-13 * (smooth.cwiseAbs().maxCoeff() + gamma_ + gradient_.cwiseAbs().maxCoeff());
    Eigen::Index best = -1;
    double steepest = nothing;
    int direction = 0;
    for (Eigen::Index m = 0; m < now_.size(); ++m) {
      if (!rests_[static_cast<std::size_t>(m)]) continue;
      const Slopes slopes = AddKink(smooth[m], gamma_, measured_[m], now_[m]);
      const double descent = Descent(slopes, now_[m]);
      if (descent <= steepest) continue;
      steepest = descent;
      best = m;
      direction = now_[m] < 1 && -slopes.right == descent ? 1 : -1;
    }
    if (best < 0) return false;
    rests_[static_cast<std::size_t>(best)] = false;
    // From its kink it goes to the side it moves to; from a bound it stays on the side where it is.
    side_[static_cast<std::size_t>(best)] =
        now_[best] == measured_[best] ? direction : (now_[best] > measured_[best] ? 1 : -1);
    return true;
  }

  const Matrix& hessian_;
  const Vector& gradient_;
  double gamma_;
  const Vector& measured_;
  const Vector& at_;
  Vector now_;
  std::vector<bool> rests_;
  std::vector<int> side_;  // of the kink: +1 above, -1 below
  std::vector<Eigen::Index> free_;
  bool convex_ = true;  // where it came along
};

// Curvature of the forces, from the change of their slopes.
Result<Vector> Bends(const FrameMuscles& muscles, const Vector& at) {
  Vector bends(at.size());
  for (Eigen::Index m = 0; m < at.size(); ++m) {
    const double low = std::max(at[m] - kProbe, 0.0);
    const double high = std::min(at[m] + kProbe, 1.0);
    SINEW_ASSIGN(const ForceAt below, muscles.Force(static_cast<int>(m), low));
    SINEW_ASSIGN(const ForceAt above, muscles.Force(static_cast<int>(m), high));
    bends[m] = (above.slope - below.slope) / (high - low);
  }
  return bends;
}

// Second derivatives of the smooth part.
struct Curvature {
  Matrix full;
  Matrix convex;  // without what bends downwards
};
Result<Curvature> FindCurvature(const ExcitationFrame& frame, const FrameMuscles& muscles,
                                const Evaluation& here, const Vector& at) {
  const ExcitationWeights& w = frame.weights;
  SINEW_ASSIGN(const Vector bends, Bends(muscles, at));
  const Matrix by_excitation = frame.arms * here.slope.asDiagonal();
  Curvature out;
  out.full = 2 * w.alpha * by_excitation.transpose() * by_excitation;
  out.convex = out.full;
  const Vector by_force = -2 * w.alpha * (frame.arms.transpose() * here.rest);
  const double least = std::max(kMinShare * 2 * w.beta, kMinBend * (out.full.trace() + 2 * w.beta));
  for (Eigen::Index m = 0; m < at.size(); ++m) {
    const double own = 2 * w.beta + by_force[m] * bends[m];
    out.full(m, m) += own;
    out.convex(m, m) += std::max({own, least, kTiny});
  }
  return out;
}

}  // namespace

Vector SolveKinkedQuadratic(const Matrix& hessian, const Vector& gradient, double gamma,
                            const Vector& measured, const Vector& at) {
  return KinkedQuadratic(hessian, gradient, gamma, measured, at).Solve();
}

Result<double> FrameObjective(const ExcitationFrame& frame, const FrameMuscles& muscles, const Vector& at) {
  SINEW_ASSIGN(const Evaluation here, Evaluate(frame, muscles, at));
  return here.objective;
}

Result<FrameSolution> SolveFrame(const ExcitationFrame& frame, const FrameMuscles& muscles,
                                 const Vector& start) {
  const ExcitationWeights& w = frame.weights;
  const Eigen::Index count = start.size();
  FrameSolution out;
  out.excitation = start.cwiseMax(0).cwiseMin(1);
  SINEW_ASSIGN(Evaluation here, Evaluate(frame, muscles, out.excitation));
  const double rounding =
      kRounding * (w.alpha * frame.moment.squaredNorm() + (w.beta + w.gamma) * static_cast<double>(count));
  for (; out.iterations < kMaxIterations && !out.converged; ++out.iterations) {
    const Vector gradient = SmoothGradient(frame, here, out.excitation);
    SINEW_ASSIGN(Curvature curvature, FindCurvature(frame, muscles, here, out.excitation));
    const double first_damping = kFirstDamping * curvature.convex.diagonal().maxCoeff();
    // First with all of the curvature, then with the convex part, then with more and more damping.
    double damping = 0;
    for (int attempt = 0;; ++attempt) {
      if (attempt > 1) damping = std::max(kMoreDamping * damping, first_damping);
      curvature.convex.diagonal().array() += damping;
      const Matrix& hessian = attempt == 0 ? curvature.full : curvature.convex;
      KinkedQuadratic model(hessian, gradient, w.gamma, frame.measured, out.excitation);
      const Vector next = model.Solve();
      const Vector step = next - out.excitation;
      const double promised = -(gradient.dot(step) + 0.5 * step.dot(hessian * step) +
                                w.gamma * (KinkSum(frame, next) - KinkSum(frame, out.excitation)));
      if (attempt == 0 && (!model.convex() || !(promised >= 0))) continue;
      const bool last = !(promised > kEnough * here.objective + rounding);
      SINEW_ASSIGN(Evaluation there, Evaluate(frame, muscles, next));
      const bool descends = there.objective <= here.objective - (last ? 0 : kArmijo * promised);
      if (descends) {
        here = std::move(there);
        out.excitation = next;
      }
      // The predicted decrease of a damped step is no criterion.
      out.converged = last && damping == 0;
      if (last && damping > 0) out.iterations = kMaxIterations;
      if (last || descends) break;
    }
  }
  out.objective = here.objective;
  const Vector gradient = SmoothGradient(frame, here, out.excitation);
  for (Eigen::Index m = 0; m < count; ++m) {
    const Slopes slopes = AddKink(gradient[m], w.gamma, frame.measured[m], out.excitation[m]);
    out.slope = std::max(out.slope, Descent(slopes, out.excitation[m]));
  }
  return out;
}

namespace {

// One muscle's part of the objective, the moments replaced by their tangent at the solution: where each
// muscle is at the lowest place of its part, nothing is lower anywhere, since the squares are convex in the
// moments.
struct Jump {
  Eigen::Index muscle = 0;
  double to = 0;    // excitation
  double gain = 0;  // of the muscle's part
};

Result<std::vector<Jump>> FindJumps(const ExcitationFrame& frame, const FrameMuscles& muscles,
                                    const FrameSolution& from) {
  const ExcitationWeights& w = frame.weights;
  SINEW_ASSIGN(const Evaluation here, Evaluate(frame, muscles, from.excitation));
  const Vector by_force = -2 * w.alpha * (frame.arms.transpose() * here.rest);
  std::vector<Jump> jumps;
  for (Eigen::Index m = 0; m < from.excitation.size(); ++m) {
    const auto part = [&](double e) -> Result<double> {
      SINEW_ASSIGN(const ForceAt force, muscles.Force(static_cast<int>(m), e));
      return by_force[m] * force.force + w.beta * e * e + w.gamma * Kink(frame, m, e);
    };
    Jump jump{m, from.excitation[m], 0};
    SINEW_ASSIGN(const double now, part(from.excitation[m]));
    for (int k = 0; k <= kGrid + 1; ++k) {
      const double to = k <= kGrid ? static_cast<double>(k) / kGrid : frame.measured[m];
      if (std::isnan(to)) continue;
      SINEW_ASSIGN(const double there, part(to));
      if (now - there > jump.gain) jump = {m, to, now - there};
    }
    if (jump.gain > 0) jumps.push_back(jump);
  }
  return jumps;
}

}  // namespace

Result<FrameSolution> SearchFrame(const ExcitationFrame& frame, const FrameMuscles& muscles,
                                  const std::vector<Vector>& starts) {
  FrameSolution best;
  best.objective = std::numeric_limits<double>::infinity();
  for (const Vector& start : starts) {
    SINEW_ASSIGN(FrameSolution solved, SolveFrame(frame, muscles, start));
    if (solved.objective < best.objective) best = std::move(solved);
  }
  for (int i = 0;; ++i) {
    SINEW_ASSIGN(const std::vector<Jump> jumps, FindJumps(frame, muscles, best));
    best.gap = 0;
    for (const Jump& jump : jumps) best.gap += jump.gain;
    if (i == kMaxJumps || !(best.gap > kWorthAJump * best.objective)) return best;
    FrameSolution better = best;
    Vector all = best.excitation;
    for (std::size_t k = 0; k <= jumps.size(); ++k) {
      Vector start = best.excitation;
      if (k < jumps.size()) start[jumps[k].muscle] = all[jumps[k].muscle] = jumps[k].to;
      if (k < jumps.size() && jumps[k].gain < kWorthAJump * best.objective) continue;
      SINEW_ASSIGN(FrameSolution solved, SolveFrame(frame, muscles, k < jumps.size() ? start : all));
      if (solved.objective < better.objective) better = std::move(solved);
    }
    if (!(better.objective < best.objective * (1 - kWorthAJump))) return best;
    best = std::move(better);
  }
}

}  // namespace sinew
