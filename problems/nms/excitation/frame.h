// Excitations of one frame that follow the measured moments of joints without much effort and without leaving
// the measured excitations. SCIENCE section 3 (modes); Sartori, Farina, Lloyd 2014, J. Biomech. 47:3613,
// doi:10.1016/j.jbiomech.2014.10.009; Pizzolato et al. 2015, J. Biomech. 48:3929,
// doi:10.1016/j.jbiomech.2015.09.021.
//
//   alpha sum_j (M_j - sum_m r_jm F_m(e_m))^2 + beta sum_m e_m^2 + gamma sum_{m measured} |e_m -
//   e_m,measured| over e_m in 0..1
//
// A muscle's force F_m depends on its own excitation only. Where it grows ever slower with it (concave, as
// with a shape factor A <= 0) and gamma is 0, the problem is convex in the forces: there is one minimum.
#pragma once

#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"

namespace sinew {

struct ForceAt {
  double force = 0;  ///< along the tendon [N]
  double slope = 0;  ///< for the excitation [N]
};

/// The muscles of a frame, everything before it being fixed.
class FrameMuscles {
 public:
  virtual ~FrameMuscles() = default;
  /// @param excitation [0..1] Errors: no equilibrium of fibre and tendon.
  [[nodiscard]] virtual Result<ForceAt> Force(int muscle, double excitation) const = 0;

 protected:
  FrameMuscles() = default;
  FrameMuscles(const FrameMuscles&) = default;
  FrameMuscles& operator=(const FrameMuscles&) = default;
};

struct ExcitationWeights {
  double alpha = 1;  ///< of the squared errors of the moments [1/(N m)^2, > 0]
  double beta = 2;   ///< of the squared excitations [1, >= 0]
  double gamma = 3;  ///< of the distance to the measured excitations [1, >= 0]
};

struct ExcitationFrame {
  ExcitationWeights weights;
  Vector moment;    ///< [joints, N m] to follow
  Matrix arms;      ///< [joints, muscles] [m]; a row of zeros where the moment is not followed
  Vector measured;  ///< [muscles] [0..1]; NaN: not measured, and not followed
};

struct FrameSolution {
  Vector excitation;     ///< [muscles] [0..1]
  double objective = 0;  ///< there
  /// The steepest descent that the bounds leave, for one muscle's excitation; 0 at a minimum [1].
  double slope = 0;
  double gap = 0;  ///< of SearchFrame: no minimum is lower by more, as far as its grid shows
  int iterations = 0;
  bool converged = false;  ///< what a further step promises is below 1e-12 of the objective, or rounding
};

/// Errors: those of the muscles.
Result<double> FrameObjective(const ExcitationFrame& frame, const FrameMuscles& muscles, const Vector& at);

/// Newton steps on the squares, with the kinks at the measured excitations and the bounds kept as they are:
/// each step solves the piecewise quadratic model exactly, by active sets. Curvature that bends downwards is
/// left out of the model, and a step that does not descend is damped.
/// @param start [muscles]; moved into 0..1. Errors: those of the muscles.
Result<FrameSolution> SolveFrame(const ExcitationFrame& frame, const FrameMuscles& muscles,
                                 const Vector& start);

/// The best of SolveFrame from several starts. With gamma there may be several minima, one of which keeps an
/// excitation at its measured value. The moments' tangent at a minimum separates the muscles; those that
/// would be better off elsewhere on a grid jump there, one by one and all at once, and the search goes on
/// from there until none is left (then there is no lower minimum) or no jump helps.
/// @param starts at least one [muscles]. Errors: those of the muscles.
Result<FrameSolution> SearchFrame(const ExcitationFrame& frame, const FrameMuscles& muscles,
                                  const std::vector<Vector>& starts);

/// min 0.5 d'Hd + g'd + gamma sum_m |at_m + d_m - measured_m| over at + d in 0..1, exactly.
/// @param hessian [n, n] positive definite @param measured [n]; NaN: no kink @return at + d
Vector SolveKinkedQuadratic(const Matrix& hessian, const Vector& gradient, double gamma,
                            const Vector& measured, const Vector& at);

}  // namespace sinew
